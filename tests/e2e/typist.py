"""A person who types letter by letter, with brackets that the editor closes.

What that must not cause is counted at every letter: restarts, nodes that move, issues about half a word, keys
that go elsewhere.
"""

import json

from support.waiting import until

# A node is its kind and its path: a missing end that becomes a state is not a node that moves.
WATCH = """root => {
  const typed = window.typed = { moves: [], leaks: [], places: new Map() };
  const look = () => {
    const places = new Map();
    for (const node of root.querySelectorAll('[data-lrp-state].lrp-state')) {
      const { e: x, f: y } = node.transform.baseVal.consolidate().matrix;
      const path = `${node.getAttribute('class').split(' ').at(-1)} ${node.getAttribute('data-lrp-state')}`;
      const old = typed.places.get(path);
      const far = old ? Math.hypot(x - old[0], y - old[1]) : 0;
      if (far > node.getBBox().width) typed.moves.push(`${path} by ${Math.round(far)} px`);
      places.set(path, [x, y]);
    }
    typed.places = places;
  };
  look();
  new MutationObserver(look).observe(root, { subtree: true, childList: true, attributes: true });
  document.addEventListener('keydown', ({ key, target }) => {
    if (!target.closest('.lrp-editor') || !root.contains(target)) typed.leaks.push(key);
  }, true);
}"""


class Typist:
    """Types into a lab and counts what that must not cause."""

    def __init__(self, lab):
        self.lab, self.page, self.keyboard = lab, lab.page, lab.page.keyboard
        self.page.evaluate(WATCH, lab.root.element_handle())

    def kernel(self, expression):
        """Evaluate an expression in the kernel; `session` is the lab's."""
        return json.loads(
            self.lab.notebook.kernel(
                "import json\nfrom lrp_jupyter.widgets import registry\n"
                f"session = [*registry.running()][-1].session\nprint(json.dumps({expression}))",
            )
        )

    def after(self, text):
        """Put the cursor after a piece of the program."""
        self.lab.select(text)
        self.keyboard.press("ArrowRight")

    def types(self, *lines):
        """Type lines; brackets are typed where they are, although the editor has closed them already."""
        for index, line in enumerate(lines):
            if index:
                self.keyboard.press("Escape")  # no completion
                self.keyboard.press("Enter")
            for letter in line:
                self.keyboard.type(letter)

    def rests(self):
        """Wait until everything typed runs."""
        until(lambda: self.kernel("session.program.text") == self.lab.text)
        self.lab.sees('.lrp-verdict[data-state="runs"]')

    def sees_active(self, state):
        """Wait until a state is active, however briefly."""
        assert self.kernel(f"bool(session.wait_for({state!r}, 120))")

    def goes_on(self):
        """Wait until five more ticks of the run are over, of which the page may know later."""
        end = self.kernel("session.frame.tick") + 5
        until(lambda: self.kernel("session.frame.tick") >= end)

    @property
    def pose(self):
        """Where the robot is and where it points."""
        return self.kernel(
            "[round(getattr(session.bridge.robot.odom, each), 6) for each in ('x', 'y', 'theta')]"
        )

    @property
    def moves(self):
        """Whether the robot is commanded to move."""
        return self.kernel("session.bridge.in_motion")

    @property
    def visits(self):
        """How often each state was entered, by its name."""
        return self.kernel("{path[-1]: times for path, times in session.frame.visits.items()}")

    @property
    def restarts(self):
        return self.kernel("session.interpreter.restarts")

    @property
    def issues(self):
        """All issues of the run, resolved ones too."""
        return self.kernel("[each.message for each in session.issues]")

    @property
    def faults(self):
        """The red marks of the timeline."""
        return self.kernel("[each.text for each in session.timeline().happenings if each.kind == 'issue']")

    def has_disturbed_nothing(self, restarts=0):
        """Assert it."""
        assert self.page.evaluate("typed.moves") == []
        assert self.page.evaluate("typed.leaks") == []
        assert self.restarts == restarts
        assert set(self.faults) <= set(self.issues)

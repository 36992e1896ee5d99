"""Typing letter by letter, as people do, brackets closed by the editor: section 4 of the paper, notebook 00.

What must not happen is counted at every letter: restarts, nodes that move, issues about half a word, keys
that go elsewhere.
"""

import json

from e2e.programs import HELLO

STOPPED = """\
(var lightlim := [128])
(var maxlook := [300])
(var search := [0.2])

(machine follower
  (event outofline [robot.light.data > -1])
  (state moving)
  (state looking)
  (on outofline moving -> looking tlooking))

(spawn follower moving)
"""
# A node is its kind and its path: a missing end that becomes a state is not a node that moves.
WATCH = """root => {
  const typed = window.typed = { moves: [], waits: [], leaks: [], places: new Map() };
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
    const verdict = root.querySelector('.lrp-verdict').textContent;
    if (verdict.startsWith('waits') && typed.waits.at(-1) !== verdict) typed.waits.push(verdict);
  };
  look();
  new MutationObserver(look).observe(root, { subtree: true, childList: true, attributes: true });
  document.addEventListener('keydown', ({ key, target }) => {
    if (!target.closest('.lrp-editor') || !root.contains(target)) typed.leaks.push(key);
  }, true);
}"""
KERNEL = """async code => {
  const kernel = jupyterapp.shell.currentWidget.sessionContext.session.kernel;
  const future = kernel.requestExecute({ code, store_history: false });
  let text = "";
  future.onIOPub = ({ header, content }) => { if (header.msg_type === "stream") text += content.text; };
  await future.done;
  return text;
}"""


class Typist:
    """Types into a lab and counts what that must not cause."""

    def __init__(self, lab, name):
        self.lab, self.page, self.name = lab, lab.page, name
        self.page.evaluate(WATCH, lab.root.element_handle())

    def kernel(self, expression):
        """Evaluate an expression in the kernel; `session` is the lab's."""
        return json.loads(
            self.page.evaluate(
                KERNEL,
                "import json\nfrom lrp_jupyter.widgets import registry\n"
                f"session = registry.find({self.name!r}).session\nprint(json.dumps({expression}))",
            )
        )

    def after(self, text):
        """Put the cursor after a piece of the program."""
        self.lab.select(text)
        self.page.keyboard.press("ArrowRight")

    def types(self, *lines):
        """Type lines; brackets are typed where they are, although the editor has closed them already."""
        for index, line in enumerate(lines):
            if index:
                self.page.keyboard.press("Escape")  # no completion
                self.page.keyboard.press("Enter")
            for letter in line:
                self.page.keyboard.type(letter, delay=20)

    def rests(self):
        """Stop typing until everything typed is meant."""
        self.page.wait_for_timeout(900)
        self.lab.sees('.lrp-verdict[data-state="runs"]')

    def sees_active(self, state):
        """Wait until a state is active."""
        assert self.kernel(f"bool(session.wait_for({state!r}, 20))")

    @property
    def restarts(self):
        return self.kernel("session.interpreter.restarts")

    @property
    def issues(self):
        """All issues of the run, resolved ones too."""
        return self.kernel("[each.message for each in session.issues]")

    @property
    def seen(self):
        return {name: self.page.evaluate(f"typed.{name}") for name in ("moves", "waits", "leaks")}


def test_section_4_of_the_paper_restarts_once(open_lab):
    lab = open_lab(STOPPED, "follower --world line")
    typist = Typist(lab, "follower")
    typist.sees_active("looking")
    typist.after("(state looking")
    typist.types(
        " ",
        "(machine lookalgo",
        "(var time := [maxlook])",
        "(state lookleft (running [robot.move(angular=search)]))",
        "(state returnleft (running [robot.move(angular=-search)]))",
        "(ontime time lookleft -> returnleft treturnleft)",
        "(ontime time returnleft -> lookright tlookright))",
    )
    typist.rests()
    assert typist.restarts == 0
    assert typist.kernel("session.frame.is_active('looking')")
    typist.types("", "(onentry (spawn lookalgo lookleft))")
    typist.rests()
    assert typist.restarts == 1
    typist.sees_active("returnleft")
    lab.sees('[data-lrp-issue="LRP303"]')
    lab.pause()
    typist.after("angular=-search)]))")
    typist.types(
        "",
        "(state lookright (running [robot.move(angular=-search)]))",
        "(state returnright (running [robot.move(angular=search)]))",
    )
    typist.after("tlookright)")
    typist.types(
        "",
        "(ontime time lookright -> returnright treturnright)",
        "(ontime time returnright -> lookleft tlookleft)",
    )
    lab.do("run")
    lab.ready("running")
    typist.sees_active("lookright")
    typist.sees_active("lookleft")
    lab.pause()
    typist.after("maxlook := [300")
    lab.page.keyboard.press("Backspace")
    lab.page.keyboard.press("Backspace")
    lab.page.keyboard.press("Backspace")
    typist.types("450")
    typist.page.wait_for_timeout(900)
    assert typist.kernel("session.variables['maxlook']") == 450
    while typist.kernel("session.frame.is_active('returnright')"):
        lab.do("step")
    typist.after("(state returnright (running [robot.move(angular=search)])")
    typist.types(" (onexit [time = time * 2])")
    lab.do("run")
    typist.rests()
    assert typist.restarts == 1
    assert len(typist.issues) == 1
    assert "lookright" in typist.issues[0]
    assert typist.seen["moves"] == []
    assert typist.seen["leaks"] == []
    assert any(each.startswith("waits: lookalgo has no state l") for each in typist.seen["waits"])


def test_the_lines_of_the_first_notebook_disturb_nothing(open_lab):
    lab = open_lab(HELLO, "driver --world oval")
    lab.goes_on()
    typist = Typist(lab, "driver")
    lab.do("pause-on-issue")
    lab.select("0.2")
    typist.types("0.1")
    typist.rests()
    assert typist.kernel("session.variables['forward']") == 0.1
    typist.after("angular=-bend)]))")
    typist.types("", "(state resting (onentry [robot.stop()]))")
    lab.sees('[data-lrp-state="driver/resting"]')
    typist.types("", "(ontime 500 left -> resting)", "(ontime 1000 resting -> left)")
    typist.rests()
    lab.ready("running")
    lab.is_active("driver/resting")
    assert typist.restarts == 0
    assert typist.issues == []
    assert typist.seen["moves"] == []
    assert typist.seen["leaks"] == []
    assert lab.find('[data-lrp-issue^="LRP"]').count() == 0


def test_a_number_that_is_dragged_changes_the_robot_at_once_and_is_one_step_of_undo(open_lab):
    lab = open_lab(HELLO, "driver --world oval")
    lab.goes_on()
    typist = Typist(lab, "driver")
    lab.select("0.2")
    box = lab.page.evaluate("getSelection().getRangeAt(0).getBoundingClientRect().toJSON()")
    mouse, keyboard = lab.page.mouse, lab.page.keyboard
    mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    keyboard.down("Alt")
    mouse.down()
    mouse.move(box["x"] + box["width"] / 2 + 20, box["y"], steps=5)
    lab.has_value("forward", "0.25")
    mouse.move(box["x"] + box["width"] / 2 - 20, box["y"], steps=5)
    lab.has_value("forward", "0.15")
    mouse.up()
    assert "(var forward := [0.15])" in lab.text
    mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    mouse.down()
    mouse.move(box["x"] + box["width"] / 2 + 20, box["y"], steps=5)
    lab.has_value("forward", "0.2")
    keyboard.press("Escape")
    lab.has_value("forward", "0.15")
    mouse.move(box["x"] + box["width"] / 2 + 40, box["y"], steps=5)
    mouse.up()
    assert "(var forward := [0.15])" in lab.text
    keyboard.up("Alt")
    keyboard.press("Control+z")
    keyboard.press("Control+z")
    lab.has_value("forward", "0.2")
    assert lab.text.startswith(HELLO.splitlines()[0])
    keyboard.press("Alt+ArrowUp")
    keyboard.press("Alt+ArrowUp")
    lab.has_value("forward", "0.22")
    assert typist.restarts == 0
    assert typist.issues == []


def test_the_active_state_stays_marked_while_a_bracket_is_open(open_lab):
    lab = open_lab(STOPPED, "follower --world line")
    lab.is_active("follower/looking")
    lab.reads(".lrp-line-active", "(state looking)")
    lab.select("(state moving)")
    lab.page.keyboard.press("ArrowRight")
    lab.page.keyboard.press("Backspace")
    lab.sees('.lrp-verdict[data-state="broken"]')
    assert lab.find(".lrp-line-active").all_inner_texts() == ["  (state looking)"]

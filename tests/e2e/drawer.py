"""A person who draws in the state graph by mouse, and types only into the small fields that open there."""


class Drawer:
    """The state graph of a lab, drawn on by mouse, or by what does the same."""

    def __init__(self, lab, fingers=None):
        self.lab, self.page = lab, lab.page
        self.mouse = fingers or lab.page.mouse
        self.drag = (fingers or lab).drag

    def at(self, x, y):
        """A point of the graph, in parts of its width and height."""
        frame = self.lab.at_rest(".lrp-graph")  # and what it shows: the free space is that of a machine
        return frame["x"] + x * frame["width"], frame["y"] + y * frame["height"]

    def box(self, state):
        """The frame of a state that has come to rest."""
        self.lab.state(state)
        return self.lab.at_rest(f'[data-lrp-state="{state}"] .lrp-box')

    def middle(self, state):
        return middle(self.box(state))

    def fill(self, *values, check=False):
        """Fill in the field that is open, apply it, and wait until the program is drawn as it is then."""
        revision = self.lab.revision
        inputs = self.lab.sees(".lrp-field").locator("input[type=text]")
        for index, value in enumerate(values):
            inputs.nth(index).fill(value)
        if check:
            self.lab.find(".lrp-field input[type=checkbox]").check()
        self.lab.press(".lrp-field-apply")
        self.lab.misses(".lrp-field")
        self.lab.until("(root, before) => Number(root.dataset.lrpRevision) > before", argument=revision)

    # -- acts ------------------------------------------------------------------------------------

    def state(self, name, x, y):
        """A double click on free space makes a state."""
        self.mouse.dblclick(*self.at(x, y))
        self.fill(name)
        self.lab.sees(f'[data-lrp-state$="/{name}"]')

    def transition(self, source, target, trigger, check=False):
        """Drag from the border of a state to another one, or to itself."""
        box = self.box(source)
        self.drag((box["x"] + box["width"] * 0.3, box["y"] + 1), self.middle(target))
        self.fill(trigger, check=check)

    def choose(self, state, action, *values):
        """Choose an entry of a state's menu."""
        self.mouse.click(*self.middle(state), button="right")
        self.lab.choose(action)
        if values:
            self.fill(*values)

    def machine(self, x, y, name):
        """Draw a machine, which is shown from then on, with the menu of the free space."""
        self.choose_free(x, y, "draw-machine", name)
        self.lab.sees(f'[data-lrp-machine="{name}"]')

    def machine_inside(self, state, name):
        """Draw a machine in a state, which is shown from then on."""
        self.choose(state, "draw-inside", name)
        self.lab.sees(f'[data-lrp-machine="{state}/{name}"]')

    def show(self, machine):
        """Show another machine."""
        self.lab.sees(f'[data-lrp-machine="{machine}"]').click()

    def choose_free(self, x, y, action, *values, check=False):
        """Choose an entry of the menu of the free space."""
        self._choose_at(self.at(x, y), action, values, check)

    def choose_in(self, machine, action, *values, check=False):
        """Choose an entry of the menu of the free space of a machine, beside which others may be drawn."""
        frame = self.lab.at_rest(f'[data-drawing="{machine}"] > .lrp-layer-frame > .lrp-frame')
        place = frame["x"] + frame["width"] - 8, frame["y"] + frame["height"] - 8
        self._choose_at(place, action, values, check)

    def _choose_at(self, place, action, values, check):
        self.mouse.click(*place, button="right")
        self.lab.choose(action)
        if values:
            self.fill(*values, check=check)

    def edit(self, transition, text):
        """Write a transition in another way, in the field that a double click on its arrow opens."""
        label = self.lab.at_rest(f'.lrp-layer-labels [data-of="{transition}"]')
        self.mouse.dblclick(*middle(label))
        self.fill(text)


def middle(box):
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

"""The first hour, letter by letter: the README, the first notebook, and section 4 of the paper."""

import re
import shutil
from pathlib import Path

from support.waiting import until

from e2e.pages import NotebookPage
from e2e.typist import Typist

ROOT = Path(__file__).parents[2]
FIRST = "00-hello-live-robot.ipynb"
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


def test_the_first_behaviour_of_the_readme_is_typed_while_the_robot_drives(open_lab):
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    head, program = re.search(r"```lrp\n%%lrp (.*)\n((?:.*\n)*?)```", readme).groups()
    rows = re.findall(r"^\| `(.*)` \| [A-Z].* \|$", readme, re.MULTILINE)[:5]
    event, state, arrow, delay, number = rows
    lab = open_lab(program, head)
    typist = Typist(lab)
    typist.after("driving (running")
    lab.page.keyboard.press("ArrowDown")  # into the empty line

    def typed(line):
        typist.types(line)
        lab.page.keyboard.press("Enter")

    typed(event)
    lab.sees('[data-lrp-issue="LRP403"]')
    typed(state)
    lab.sees('[data-lrp-issue="LRP401"]')
    lab.state("rover/turning")
    until(lambda: typist.kernel("bool(session.bridge.robot.bumper.data)"), "the robot is at the wall")
    typist.types(arrow[:-9])
    for letter in arrow[-9:]:  # of the destination, each of which runs for some ticks
        typist.types(letter)
        lab.goes_on()
    lab.page.keyboard.press("Enter")
    lab.misses("[data-lrp-issue]")
    lab.is_active("rover/turning")  # at the wall
    typed(delay)
    lab.is_active("rover/driving")
    new, old = number.split("` instead of `")
    lab.replace(old, new)
    lab.has_value("pace", new)
    typist.has_disturbed_nothing()
    assert typist.faults == []
    lab.find('[data-lrp-transition="rover:bump:driving->turning"]').first.focus()
    lab.page.keyboard.press("?")
    lab.reads(".lrp-why-sentence", "did not fire")
    lab.misses(".lrp-note:visible")


def test_the_first_notebook_keeps_its_promises(page, server):
    shutil.copy(ROOT / "notebooks" / FIRST, server.root)
    notebook = NotebookPage(page, server, FIRST).show()
    notebook.begin_cell(1)
    notebook.begin_cell(2)
    lab = notebook.lab().ready()
    lab.goes_on()
    typist = Typist(lab)
    lab.do("pause-on-issue")
    lab.is_active("driver/left")

    lab.select("0.2")
    typist.types("0.1")  # slower, on the way
    lab.has_value("forward", "0.1")
    assert typist.kernel("session.variables['forward']") == 0.1
    typist.after("(on white right -> left)")
    typist.types("", "(state resting (onentry [robot.stop()]))")
    lab.sees('[data-lrp-state="driver/resting"]')
    typist.types("", "(ontime 300 left -> resting)")
    lab.is_active("driver/resting")
    typist.types("", "(ontime 1000 resting -> left)")
    lab.is_active("driver/left")
    typist.rests()
    lab.ready("running")
    assert typist.issues == []
    assert lab.find('[data-lrp-issue^="LRP"]').count() == 0
    typist.has_disturbed_nothing()
    a_number_is_dragged(lab)
    assert typist.issues == []
    assert typist.restarts == 0

    lab.type_after("(spawn driver left", "(")  # a mistake: the robot drives on
    lab.sees("[data-lrp-issue]")
    lab.goes_on()
    lab.pause()

    notebook.begin_cell(7)  # the first challenge
    other = notebook.lab(1).ready()
    other.do("check")
    other.sees(".lrp-progress:not([hidden])")
    other.sees(".lrp-result[data-state='failed']")
    other.do("hint")
    other.sees(".lrp-hint")
    other.replace("0.3", "0.15")
    other.has_value("speed", "0.15")
    other.sees(".lrp-criterion[data-state='met']")  # in the run that one watches, too
    other.do("check")
    other.sees(".lrp-result[data-state='met']")


def a_number_is_dragged(lab):
    """Drag it, which changes the robot at once and is one step of undo; then step it by keys."""
    lab.replace("0.1", "0.2")
    lab.has_value("forward", "0.2")
    lab.select("0.2")
    box = lab.page.evaluate("getSelection().getRangeAt(0).getBoundingClientRect().toJSON()")
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    mouse, keyboard = lab.page.mouse, lab.page.keyboard
    mouse.move(x, y)
    keyboard.down("Alt")
    mouse.down()
    mouse.move(x + 20, y, steps=5)
    lab.has_value("forward", "0.25")
    mouse.move(x - 20, y, steps=5)
    lab.has_value("forward", "0.15")
    mouse.up()
    assert "(var forward := [0.15])" in lab.text
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + 20, y, steps=5)
    lab.has_value("forward", "0.2")
    keyboard.press("Escape")
    lab.has_value("forward", "0.15")
    mouse.move(x + 40, y, steps=5)
    mouse.up()
    assert "(var forward := [0.15])" in lab.text
    keyboard.up("Alt")
    keyboard.press("Control+z")
    keyboard.press("Control+z")
    lab.has_value("forward", "0.2")
    keyboard.press("Alt+ArrowUp")
    keyboard.press("Alt+ArrowUp")
    lab.has_value("forward", "0.22")


def test_section_4_of_the_paper_restarts_once(open_lab):
    lab = open_lab(STOPPED, "follower --world line")
    keep_the_mark_beside_an_open_bracket(lab)
    typist = Typist(lab)
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
    until(lambda: typist.issues, "the transition to a state that is missing is no issue")
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
    for _ in range(3):
        lab.page.keyboard.press("Backspace")
    typist.types("450")
    lab.has_value("maxlook", "450")
    assert typist.kernel("session.variables['maxlook']") == 450
    while typist.kernel("session.frame.is_active('returnright')"):
        lab.do("step")
    typist.after("(state returnright (running [robot.move(angular=search)])")
    typist.types(" (onexit [time = time * 2])")
    lab.do("run")
    typist.rests()
    assert len(typist.issues) == 1
    assert "lookright" in typist.issues[0]
    typist.has_disturbed_nothing(restarts=1)


def keep_the_mark_beside_an_open_bracket(lab):
    """The line of the active state stays marked."""
    lab.is_active("follower/looking")
    lab.reads(".lrp-line-active", "(state looking)")
    lab.select("(state moving)")
    lab.page.keyboard.press("ArrowRight")
    lab.page.keyboard.press("Backspace")
    lab.sees('.lrp-verdict[data-state="broken"]')
    assert lab.find(".lrp-line-active").all_inner_texts() == ["  (state looking)"]
    lab.page.keyboard.type(")")
    lab.sees('.lrp-verdict[data-state="runs"]')

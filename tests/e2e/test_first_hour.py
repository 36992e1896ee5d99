"""The first hour, letter by letter: the README, the first notebook, and section 4 of the paper."""

import json
import re
import shutil
from pathlib import Path

from support.waiting import until

from e2e.conftest import WINDOW
from e2e.pages import NotebookPage
from e2e.typist import Typist

ROOT = Path(__file__).parents[2]
FIRST = "00-hello-live-robot.ipynb"
IN_SIGHT = (
    "selector => document.querySelector(selector).getBoundingClientRect().bottom"
    " < document.querySelector('.jp-WindowedPanel-outer').getBoundingClientRect().bottom"
)
PAPER = """\
(var lightlim := [128]) (var maxlook := [100]) (var forward := [0.2]) (var search := [0.2])

(machine follower
  (state moving (running [robot.move(linear=forward)]))
  (on outofline moving -> looking tlooking)
  (on intheline looking -> moving tmoving)
  (event outofline [robot.light.data > lightlim + 10])
  (event intheline [robot.light.data < lightlim - 10])
  (state looking)
)
(spawn follower moving)
"""
COURSE = {
    "version": 1,
    "name": "curves",
    "size": [3.4, 1.2],
    # Straight on, then a bend that a sweep of 100 ms finds, and two that it does not find.
    "floor": {
        "strokes": [{"path": [[0.1, 0.8], [1.01, 0.8], [1.6095, 0.776], [2.1752, 0.5759], [3.2, 0.535]]}]
    },
    "robots": [{"pose": [0.2, 0.788, -0.006], "light": [[0.06, 0]]}],
}


def test_the_first_behaviour_of_the_readme_is_typed_while_the_robot_drives(open_lab):
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    head, program = re.search(r"```lrp\n%%lrp (.*)\n((?:.*\n)*?)```", readme).groups()
    rows = re.findall(r"^\| `(.*)` \| [A-Z].* \|$", readme, re.MULTILINE)[:5]
    event, state, arrow, delay, number = rows
    lab = open_lab(program, head)
    typist = Typist(lab)
    typist.after("linear=pace)]))")
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
    page.set_viewport_size({"width": 1280, "height": 800})
    notebook = NotebookPage(page, server, FIRST).show()
    page.wait_for_function(IN_SIGHT, arg=".jp-CodeCell")  # something to run on the first screen
    page.set_viewport_size(WINDOW)
    notebook.begin_cell(1)
    notebook.begin_cell(3)
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
    typist.types("", "(ontime 200 left -> resting)")
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

    notebook.begin_cell(8)  # the first challenge
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


def test_section_4_of_the_paper_holds_sentence_by_sentence(open_lab, server, request):
    """With the constants of section 3.2: a sweep takes a tick, and turns the robot by 0.02 radians."""
    world = server.root / request.node.name / "curves.world.json"
    world.parent.mkdir(exist_ok=True)
    world.write_text(json.dumps(COURSE))
    lab = open_lab(PAPER, "follower --world curves.world.json")
    typist = Typist(lab)

    # The robot leaves the line, which is on its left, and stands: `looking` does nothing.
    keep_the_mark_beside_an_open_bracket(lab)
    until(lambda: typist.kernel("session.bridge.robot.light.data") > 138 and not typist.moves, "it stops")
    typist.goes_on()  # it comes to a stand within half a second of its own time
    place = typist.pose
    typist.after("(state looking")
    typist.types(" ", "(machine lookalgo", "(var time := [maxlook])")
    typist.types("", "(state lookleft (running [robot.move(angular=search)]))")
    lab.sees('[data-lrp-machine="follower/looking/lookalgo"]')
    lab.find('[data-lrp-machine="follower/looking/lookalgo"]').first.click()
    lab.sees('[data-lrp-state="follower/looking/lookalgo/lookleft"]')  # as soon as its definition is complete
    typist.after("(state lookleft (running [robot.move(angular=search)]))")
    typist.types(
        "",
        "(state returnleft (running [robot.move(angular=search * -1)]))",
        "(ontime time lookleft -> returnleft treturnleft)",
        "(ontime time returnleft -> lookright tlookright))",
    )
    typist.rests()
    assert typist.restarts == 0
    assert typist.kernel("session.frame.is_active('looking')")
    assert typist.pose == place

    # The spawn changes the active state: the program starts again in `moving`, which does not act, because
    # the robot is still out of the line. It sweeps to the left, finds the line and follows it.
    lab.do("pause-on-issue")
    typist.after("tlookright))")
    typist.types("", "(onentry (spawn lookalgo lookleft))")
    lab.ready("paused")
    assert typist.restarts == 1
    assert typist.visits == {"moving": 3, "looking": 3, "lookleft": 2, "returnleft": 1}
    assert "could leave it at once, so it did not act" in typist.kernel(
        "next(text for tick in range(session.frame.tick, 0, -1)"
        " if 'restarted' in (text := str(session.why('moving', at=tick))))"
    )

    # It leaves the line to the other side, and does not find it on the left: it returns, without an end.
    lab.reads('[data-lrp-issue="LRP303"]', "lookalgo has no state lookright")
    assert typist.kernel("session.frame.is_active('returnleft')")
    lab.sees('[data-lrp-state="follower/looking/lookalgo/returnleft"][data-active]')
    assert not typist.moves  # the pause has stopped it
    typist.after("(running [robot.move(angular=search * -1)]))")
    typist.types(
        "",
        "(state lookright (running [robot.move(angular=search * -1)]))",
        "(state returnright (running [robot.move(angular=search)]))",
    )
    typist.after("tlookright)")
    typist.types(
        "",
        "(ontime time lookright -> returnright treturnright)",
        "(ontime time returnright -> lookleft tlookleft)",
    )
    typist.rests()
    assert typist.kernel("[each.resolved for each in session.issues]") == [True]
    lab.do("pause-on-issue")
    found = lab.pause_when("'moving'")  # on the right
    lab.do("run")
    lab.is_paused_by(found)
    visits = typist.visits
    assert visits["lookright"] == 1
    assert "returnright" not in visits

    # The line curves so much that no sweep finds it: they go on without an end, by now and then a tick each.
    lab.do("run")
    typist.sees_active("returnright")
    typist.sees_active("lookleft")
    typist.sees_active("returnright")
    # A larger `maxlook` widens the sweep at once, within this visit of `looking`.
    lab.is_paused_by(lab.pause_when("'lookleft'"))
    looked = typist.visits["looking"]
    typist.after("maxlook := [100")
    typist.types("0")
    lab.has_value("follower/looking/lookalgo/time", "1000")
    found = lab.pause_when("'moving'")
    lab.do("run")
    lab.is_paused_by(found)
    assert typist.visits["looking"] == looked

    # The general solution: the sweeps grow from one to the next, from the exit of `returnright` on.
    typist.after("maxlook := [1000")
    lab.page.keyboard.press("Backspace")
    lab.has_value("maxlook", "100")
    lab.do("run")
    typist.sees_active("returnright")
    typist.sees_active("returnright")
    lab.is_paused_by(lab.pause_when("'lookleft'"))  # else it would start again
    typist.after("(state returnright (running [robot.move(angular=search)])")
    typist.types(" (onexit [time = time * 2])")
    typist.rests()
    for sweep in ("200", "400"):
        wider = lab.pause_when(f"condition='time == {sweep}', machine='follower/looking/lookalgo'")
        lab.do("run")
        lab.is_paused_by(wider)
        lab.has_value("follower/looking/lookalgo/time", sweep)
    lab.do("run")
    typist.sees_active("moving")
    typist.rests()
    assert {each for each in typist.issues if "lookright" not in each} == set()
    typist.has_disturbed_nothing(restarts=1)


def keep_the_mark_beside_an_open_bracket(lab):
    """The line of the active state stays marked."""
    lab.is_active("follower/looking")
    lab.reads(".lrp-line-active", "(state looking)")
    lab.select("(state moving (running [robot.move(linear=forward)]))")
    lab.page.keyboard.press("ArrowRight")
    lab.page.keyboard.press("Backspace")
    lab.sees('.lrp-verdict[data-state="broken"]')
    assert lab.find(".lrp-line-active").all_inner_texts() == ["  (state looking)"]
    lab.page.keyboard.type(")")
    lab.sees('.lrp-verdict[data-state="runs"]')

"""Exercises as a student does them: a wrong answer, a hint, the right one; the lab checks."""

import re

from e2e.test_layout import SCREENS, nothing_overlaps
from lrp_jupyter.grading.challenges import load as load_exam
from lrp_jupyter.grading.handing_in import code_of
from lrp_jupyter.grading.submissions import read_submission


def checked(lab, passed):
    """Press Check, wait for its result and return it."""
    lab.do("check")
    lab.sees(".lrp-progress:not([hidden])")
    lab.goes_on()  # the robot drives on while a check is made
    lab.sees(f".lrp-result[data-state='{'met' if passed else 'failed'}']")
    return lab.find(".lrp-result").inner_text()


def hint(lab):
    """Ask for a hint and return it."""
    known = lab.find(".lrp-hint").count()
    lab.do("hint")
    lab.until("(list, known) => list.children.length > known", ".lrp-hints", known)
    return lab.find(".lrp-hint").last.inner_text()


def test_two_challenges_are_passed_after_hints_and_a_look_at_a_failed_run(open_lab):
    lab = open_lab("", 'mine --challenge "square" --hints changes')  # the challenge has the text
    lab.sees(".lrp-criterion")
    search_and_keep(lab)
    drive_a_square(lab)
    lab = lab.notebook.open("", 'other --challenge "stop at the line"')
    lab.sees(".lrp-criterion")
    stop_at_the_line(lab)
    lab = lab.notebook.open("", 'wide --challenge "look left, look right"')
    lab.sees(".lrp-criterion")
    keep_the_head_in_its_panel(lab)


def search_and_keep(lab):
    """Search for a change, but for a moment only, and keep a run of the check."""
    checked(lab, False)
    see_the_goal_at_every_size(lab)
    lab.press('[data-lrp="goal"] [data-lrp-action="find-change"]')
    lab.sees('[data-lrp="runs"]:not([data-behind])')
    lab.do("stop-search")
    lab.reads(".lrp-found > p", "The search ended before")
    lab.do("keep-attempt")
    lab.reads(".lrp-run-expected", "meets square")
    lab.reads(".lrp-run-reason", "it never reached first corner")
    lab.do("start-over")
    lab.ready("running")


def drive_a_square(lab):
    checked(lab, False)
    first = hint(lab)
    lab.do("show-attempt")
    lab.ready("paused")
    lab.until("(root) => root.querySelector('.lrp-criterion[data-state=failed]') !== null")
    assert lab.find(".lrp-attempt .lrp-outline-path").first.get_attribute("d").startswith("M")
    lab.replace("1000 side", "3000 side")
    lab.replace("1000 corner", "1571 corner")
    lab.do("start-over")
    lab.ready("running")
    checked(lab, False)
    second = hint(lab)
    assert "Count the corners" in second
    assert second != first
    lab.type_after("[robot.move(angular=1)])", "\n(onexit [corners += 1])")
    assert "Passed" in checked(lab, True)
    lab.do("start-over")
    lab.ready("running")
    lab.sees(".lrp-criterion[data-state='met']")  # the first of them, while the robot drives


def see_the_goal_at_every_size(lab):
    """It is over the world, and nothing hides another."""
    for width, height in SCREENS:
        lab.page.set_viewport_size({"width": width, "height": height})
        lab.at_rest('[data-lrp="goal"]')
        goal, world, editor = (lab.box(f'[data-lrp="{part}"]') for part in ("goal", "world", "editor"))
        assert goal["height"] > 60
        assert world["height"] > 100
        if width >= 1280:
            nothing_overlaps(lab)
            assert goal["y"] < world["y"]
            assert world["x"] < editor["x"]


def keep_the_head_in_its_panel(lab):
    """The name of the goal can be read beside worlds with long names, and every button can be pressed."""
    lab.page.set_viewport_size({"width": 1280, "height": 800})
    panel = lab.at_rest('[data-lrp="goal"]')
    last = lab.box('[data-lrp="goal"] [data-lrp-action="enlarge"]')
    assert last["x"] + last["width"] <= panel["x"] + panel["width"]
    assert lab.box('[data-lrp="goal"] .lrp-title')["width"] > 60
    lab.do("start-over")
    lab.ready("running")


def stop_at_the_line(lab):
    result = checked(lab, False)
    passed, runs = map(int, re.search(r"(\d+) of (\d+) runs passed", result).groups())
    assert lab.find(".lrp-attempt[data-state='failed']").count() == runs - passed
    assert lab.find(".lrp-hint").count() == 0, "hints are given only when they are asked for"
    assert "let the sensor decide, not the time" in hint(lab)
    lab.type_after("(machine stopper", "\n(event online [robot.light.data < 128])")
    lab.replace("ontime 2500", "on online")
    lab.reads(".lrp-result", "The program has changed since.")
    assert checked(lab, True) == f"Passed: 10 of 10 points. All {runs} runs met all criteria."
    assert lab.find('[data-lrp-action="hint"]').is_hidden()


EXAM = """
from lrp_jupyter.grading import Challenge, drives, register

register(
    Challenge("exam 1", "Drive a metre.", "empty", [drives(1)], seconds=10, exam=True, hidden=["unseen.json"])
)
"""


def test_an_exam_gives_no_hints_and_a_code_for_what_is_saved(open_lab):
    lab = open_lab("", "m")
    notebook = lab.notebook
    (notebook.path.parent / "exam-1.py").write_text(EXAM, encoding="utf-8")
    lab = notebook.open("", "exam --challenge exam-1.py")
    assert checked(lab, False) == "Not yet: 0 of 1 runs passed."
    assert lab.find('[data-lrp-action="hint"]').is_hidden()
    first = lab.find(".lrp-code").inner_text()
    lab.type_after("(state waiting", "\n    (running [robot.move(linear=0.3)])")
    lab.until("(code, first) => code.textContent !== first", ".lrp-code", first)
    result = checked(lab, True)
    assert result.endswith("Your points also depend on a world that you do not see.")
    code = lab.find(".lrp-code").inner_text()
    notebook.save()
    assert code == code_of(read_submission(notebook.path, load_exam(notebook.path.parent / "exam-1.py")))

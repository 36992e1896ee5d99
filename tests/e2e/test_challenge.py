"""Three exercises, as a student does them: a wrong answer, a hint, the right one; the lab checks."""

import re

import pytest

from e2e.test_layout import SCREENS, nothing_overlaps


@pytest.fixture
def open_challenge(open_lab):
    """Open a cell that has the challenge's own text."""

    def open_challenge(name):
        lab = open_lab("", f'mine --challenge "{name}"')
        lab.sees(".lrp-criterion")
        return lab

    return open_challenge


def checked(lab, passed):
    """Press Check, wait for its result and return it."""
    lab.do("check")
    lab.sees(".lrp-progress:not([hidden])")
    lab.sees(f".lrp-result[data-state='{'met' if passed else 'failed'}']")
    return lab.find(".lrp-result").inner_text()


def hint(lab):
    """Ask for a hint and return it."""
    known = lab.find(".lrp-hint").count()
    lab.do("hint")
    lab.until("(list, known) => list.children.length > known", ".lrp-hints", known)
    return lab.find(".lrp-hint").last.inner_text()


def test_the_robot_stops_at_the_line_where_it_stopped_by_the_clock(open_challenge):
    lab = open_challenge("stop at the line")
    result = checked(lab, False)
    passed = int(re.search(r"(\d) of \d runs passed", result)[1])
    assert lab.find(".lrp-attempt[data-state='failed']").count() == 3 - passed
    assert lab.find(".lrp-hint").count() == 0, "hints are given only when they are asked for"
    assert "let the sensor decide, not the time" in hint(lab)
    lab.type_after("(machine stopper", "\n(event online [robot.light.data < 128])")
    lab.replace("ontime 2500", "on online")
    lab.reads(".lrp-result", "The program has changed since.")
    assert checked(lab, True) == "Passed: 10 of 10 points. All 3 runs met all criteria."
    assert lab.find('[data-lrp-action="hint"]').is_hidden()


def test_a_square_is_driven_after_two_hints_and_a_look_at_the_run_that_failed(open_challenge):
    lab = open_challenge("square")
    checked(lab, False)
    first = hint(lab)
    lab.do("show-attempt")
    lab.ready("paused")
    lab.until("(root) => root.querySelector('.lrp-criterion[data-state=failed]') !== null")
    assert lab.find(".lrp-attempt .lrp-outline-path").first.get_attribute("d").startswith("M")
    lab.replace("1000 side", "3000 side")
    lab.replace("1000 corner", "1571 corner")
    checked(lab, False)
    second = hint(lab)
    assert "Count the corners" in second
    assert second != first
    lab.type_after("[robot.move(angular=1)])", "\n(onexit [corners += 1])")
    assert "Passed" in checked(lab, True)
    lab.do("start-over")
    lab.ready("running")
    lab.sees(".lrp-criterion[data-state='met']")  # the first of them, while the robot drives


def test_half_the_speed_is_an_edit_of_the_robot_that_drives(open_challenge):
    lab = open_challenge("half the speed")
    checked(lab, False)
    assert hint(lab)
    lab.replace("[0.3]", "[0.15]")
    lab.has_value("speed", "0.15")
    lab.sees(".lrp-criterion[data-state='met']")  # in the run that one watches, too
    assert "Passed" in checked(lab, True)


def test_the_robot_drives_on_while_a_check_is_made(open_challenge):
    lab = open_challenge("there and back")
    lab.do("check")
    lab.sees(".lrp-progress:not([hidden])")
    lab.goes_on()
    lab.sees(".lrp-result[data-state='failed']")


@pytest.mark.parametrize("size", SCREENS, ids=str)
def test_the_goal_is_over_the_world_and_nothing_hides_another(open_challenge, page, size):
    page.set_viewport_size(dict(zip(("width", "height"), size, strict=True)))
    lab = open_challenge("square")
    goal, world, editor = (lab.box(f'[data-lrp="{part}"]') for part in ("goal", "world", "editor"))
    assert goal["height"] > 60
    assert world["height"] > 100
    if size[0] >= 1280:
        nothing_overlaps(lab)
        assert goal["y"] < world["y"]
        assert world["x"] < editor["x"]

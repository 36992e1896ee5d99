"""Points count above what one begins with, are the same everywhere, and are lost where a rule is broken."""

from dataclasses import replace

import pytest
from support.tables import every
from support.waiting import until

from lrp_jupyter.grading import grade as grading
from lrp_jupyter.grading.attempt import attempt
from lrp_jupyter.grading.batch import grade_all
from lrp_jupyter.grading.challenges import BUNDLED, Challenge
from lrp_jupyter.grading.criteria import drives, touches_nothing
from lrp_jupyter.grading.grade import grade, jobs_of
from lrp_jupyter.grading.sweep import sweep
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.views.goal import Goal


def driving(seconds, more=""):
    """Return a program that drives 20 cm in each of some seconds."""
    return f"""(var time := [{1000 * seconds}])
        (machine m {more}
          (state driving (running [robot.move(linear=0.2)]))
          (state stopped (onentry [robot.stop()]))
          (ontime time driving -> stopped))
        (spawn m driving)"""


WAY = Challenge("way", "Drive 2 m.", "line", drives(2), 12, seeds=2, starter=driving(5))


def test_points_count_above_what_one_begins_with_in_the_same_runs():
    result = grade(driving(7.5), WAY)
    assert result.start == pytest.approx(0.5, abs=0.02)
    assert result.share == pytest.approx(0.75, abs=0.02)
    assert result.points == pytest.approx(5, abs=0.2)
    above = "points count above the program that the challenge begins with, which meets 50% of the task"
    assert f"\n  {above}\n" in str(result)
    assert [grade(driving(seconds), WAY).points for seconds in (5, 2, 11)] == [0, 0, 10]


def test_where_no_program_is_given_points_count_above_a_robot_that_stands_still():
    own = Challenge("own", "Stay clear of the wall, and drive.", "line", (touches_nothing(), drives(2)), 6)
    result = grade(driving(5), own)
    assert "\n  points count above a robot that stands still, which meets 50% of the task\n" in str(result)


def test_what_one_begins_with_is_run_once_and_only_where_points_depend_on_it(monkeypatch):
    monkeypatch.setattr(grading, "_starters", [])
    assert grade(driving(11), WAY)
    assert not grade("(machine m (state a)) (spawn m a)", WAY).points
    assert grading.start_of(WAY) is None
    half = [grade(driving(7.5), WAY, seeds).points for seeds in (2, 2, 1)]
    assert half[0] == half[1]
    assert len(grading._starters) == 2


@pytest.mark.slow
def test_points_are_the_same_alone_in_a_class_in_a_sweep_and_in_a_lab(monkeypatch):
    text = driving(7.5)
    found = []
    for way in (
        lambda: grade(text, WAY).points,
        lambda: grade_all(["; nothing", text], WAY)[1].points,
        lambda: sweep(text, WAY, time=[7500], seeds=2).points[0].grade.points,
        lambda: checked(text),
    ):
        monkeypatch.setattr(grading, "_starters", [])
        found.append(way())
    assert found == [found[0]] * 4
    assert 4 < found[0] < 6


def checked(text):
    """Return the points that a lab shows after a check."""
    goal = Goal(WAY)
    with Session(text, "sim", world="line") as session:
        goal.attach(session, lambda: None)
        goal.check(session, text)
        until(lambda: not goal.view(session, text)["check"]["busy"])
        shown = goal.view(session, text)["check"]
    assert not shown["error"]
    return shown["points"]


def test_a_program_for_a_live_challenge_that_changes_nothing_earns_nothing():
    task = replace(WAY, name="live", live=1, starter=driving(7))
    assert grade(task.beginning, task).points == 0


@pytest.mark.slow
@every("each", [each for each in BUNDLED if each.needed == 1 and not each.series])
def test_what_one_begins_with_earns_nothing(each):
    assert grade(each.beginning, each, 1).points == 0


MISSPELT = "(state other (running [robot.stpo()]))"


def test_an_error_that_the_checks_find_costs_the_points_although_the_run_does_not_meet_it():
    result = grade(driving(11, MISSPELT), WAY)
    assert not result.passed
    assert result.points == 0
    (verdict,) = [each for each in result.attempts[0].verdicts if not each.passed]
    assert str(verdict) == (
        "✗ runs without issues: line 2: `robot` has no `stpo`. Did you mean `stop`?"
        " This costs all points of the run."
    )
    assert result.hint == "Line 2: `robot` has no `stpo`. Did you mean `stop`?"
    (made,) = grade([driving(11, MISSPELT), driving(11)], WAY, 1).attempts
    assert made.share, "only the last text counts"


def test_a_lab_shows_the_error_while_the_program_runs():
    goal = Goal(WAY)
    with Session(driving(11, MISSPELT), "sim", world="line") as session:
        goal.attach(session, lambda: None)
        goal.view(session, session.text)
        session.run(11)
        assert [each["state"] for each in goal.criteria()] == ["met", "open"]
        session.edit(driving(11))
        goal.view(session, session.text)
        session.run(0.2)
        assert [each["state"] for each in goal.criteria()] == ["met"]


def test_a_robot_that_was_carried_earns_nothing():
    text = driving(3).replace("robot.stop()", "robot._bridge.simulation.robot.body.position = (2, 1)")
    result = grade(text, WAY)
    made = attempt(jobs_of(text, WAY)[1][0])
    assert (result.points, made.share) == (0, 0)
    assert "is not carried: it was put down elsewhere after" in str(result)
    assert "This costs all points of the run." in str(result)

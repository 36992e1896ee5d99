"""Hints say what is true of a run."""

from dataclasses import replace

import pytest
from support.tables import every

from lrp_jupyter.grading.attempt import attempt
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.criteria import blinks, drives, enters
from lrp_jupyter.grading.grade import grade, jobs_of
from lrp_jupyter.grading.referee import Referee
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.worlds import load as load_world

DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)]))) (spawn m driving)"
SQUARE = """
(machine square
  (var corners := [0])
  (state side (running [robot.move(linear=0.2)]))
  (state corner (running [robot.move(angular=1)]) (onexit [corners += 1]))
  (state done (onentry [robot.stop()]))
  (on [corners == 4] side -> done)
  (ontime 3000 side -> corner)
  (ontime 1571 corner -> side))
(spawn square side)
"""


def hints(text, name):
    return " | ".join(attempt(jobs_of(text, name)[1][0]).hints)


@pytest.mark.parametrize(
    "text",
    [SQUARE.replace("(onexit [corners += 1])", ""), SQUARE.replace("angular=1", "angular=-1")],
    ids=["without a counter", "to the right"],
)
def test_a_robot_that_turns_is_not_said_to_drive_straight_on(text):
    found = hints(text, "square")
    assert "straight on" not in found
    assert "turned" in found


def test_turning_to_and_fro_is_turning():
    text = (
        "(machine m (state l (running [robot.move(angular=1)])) (state r (running [robot.move(angular=-1)]))"
    )
    text += "(ontime 1000 l -> r) (ontime 1000 r -> l)) (spawn m l)"
    assert "straight on" not in hints(text, "square")


def test_a_robot_that_was_told_to_move_is_not_said_never_to_have_been():
    found = hints(DRIVE.replace("linear=0.2", "angular=1"), "square")
    assert "never received" not in found
    assert "never told" not in found
    assert "never received" not in hints(DRIVE.replace("robot.move(linear=0.2)", "robot.stop()"), "square")


@pytest.mark.parametrize("name", ["first move", "stop at the line", "square", "bump and stay", "maze"])
def test_a_move_in_onentry_gets_the_hint_about_the_command_watchdog_first(name):
    made = attempt(jobs_of(DRIVE.replace("running", "onentry"), name)[1][0])
    assert made.hint.startswith("`driving` moves the robot in `onentry`, which runs only once")
    assert "stopped after 0.6 s" in made.hint


def test_a_command_that_holds_long_enough_is_not_blamed():
    text = """
        (machine m
          (state nudge (onentry [robot.move(linear=0.2)]))
          (state rest (onentry [robot.stop()]))
          (ontime 300 nudge -> rest)
          (ontime 300 rest -> nudge))
        (spawn m nudge)"""
    assert "onentry" not in hints(text, "bump and stay")


@pytest.mark.slow
def test_of_a_misspelt_name_the_hint_says_what_is_meant():
    assert "Did you mean `speed`?" in hints("(var speed := [1])" + DRIVE.replace("0.2", "sped"), "square")
    text = DRIVE.replace("(state driving", "(state bumped (running [robot.stpo()])) (state driving")
    assert "`robot` has no `stpo`" in hints(text, "square")


def test_the_robots_noise_is_no_turning():
    with Session(DRIVE, "sim", world="empty", seed=1, noise={"motor": 0.1}) as session:
        task = jobs_of(DRIVE, "first move")[0]
        referee = Referee(task, load_world("empty"))
        session.run(5, after_tick=lambda: referee.see(session.bridge, session.interpreter) and False)
    assert referee.run.turned == (0, 0)


def test_a_program_that_needs_no_robot_is_not_told_to_move_one():
    task = Challenge("sleep", "Sleep after a second.", "boxes", enters("asleep"), 5)
    result = grade("(machine m (state awake) (state asleep)) (spawn m awake)", task)
    assert not result.passed
    assert "never received a command" not in "\n".join(result.hints)


def rover(transitions, turning="", driving="robot.move(linear=0.2)"):
    """Return a program with three states, and transitions."""
    return f"""(machine rover
        (event bump [robot.bumper.data == 1])
        (state driving (running [{driving}]))
        (state backing (running [robot.move(linear=-0.2)]))
        (state turning {turning or "(running [robot.move(angular=1)])"})
        {transitions})
        (spawn rover driving)"""


BACKS = "(on bump driving -> backing) (ontime 1000 backing -> turning)"
WAITS = (
    "(machine m (state waiting {}) (state driving (running [robot.move(linear=0.2)])) {}) (spawn m waiting)"
)
SLOW = SQUARE.replace("0.2", "0.025").replace("3000", "24000")
FIRST_HINTS = {
    (
        "bump and turn",
        rover(BACKS),
    ): "and never stopped: no transition leads out of `turning`. Which",
    (
        "bump and turn",
        rover(f"{BACKS} (ontime 999999 turning -> driving)"),
    ): "never stopped. What does the transition that leads out of `turning` wait for?",
    (
        "bump and turn",
        rover(f"{BACKS} (on [robot.gyro.data == 3.14] turning -> driving)"),
    ): "Line 6: `robot.gyro.data == 3.14` asks for exactly 3.14, and a measured value",
    (
        "bump and turn",
        rover("(on bump driving -> backing)"),
    ): "`rover` never enters `turning`. Add a transition",
    (
        "bump and stay",
        WAITS.format("", "(on bump waiting -> driving) (event bump [robot.bumper.data == 1])"),
    ): "only `driving` commands it, and the run never entered that state. Which transition leads there",
    (
        "bump and stay",
        WAITS.format("(running [if robot.bumper.data == 1: robot.move(linear=0.1)])", ""),
    ): "`m` never enters `driving`",
    (
        "bump and stay",
        "(machine m (state waiting (running [if robot.bumper.data: robot.move()]))) (spawn m waiting)",
    ): "although `waiting` was entered: its block did not come to the command.",
    (
        "bump and stay",
        "(machine m (state a)) (spawn m a)",
    ): "Put `robot.move(linear=0.2)` into the `running` of",
    (
        "square",
        SLOW,
    ): "Time ran out after 90 s, and the robot was still on its way: it reached `third corner`",
    ("square", "(machine m (state a)) (spawn mm a)"): "There is no machine `mm`",
    ("square", "(machine m (state a))"): "Nothing was active. Write `(spawn machine state)`",
}


@pytest.mark.slow
@every(("case", "words"), FIRST_HINTS.items())
def test_the_most_certain_hint_comes_first(case, words):
    challenge, text = case
    assert words in attempt(jobs_of(text, challenge)[1][0]).hint


def test_a_state_that_is_meant_to_stand_is_not_told_to_move():
    as_told = rover(f"{BACKS} (on bump turning -> driving)", turning=" ")
    assert "Put `move`" not in hints(rover("(on bump driving -> turning)", turning=" "), "bump and turn")
    assert "`running`" not in hints(as_told, "bump and turn")
    text = (
        "(machine m (state a (running [robot.move(linear=0.2)])) (state b) (ontime 500 a -> b)) (spawn m a)"
    )
    task = Challenge("way", "Drive 2 m.", "empty", drives(2), 5)
    (hint,) = grade(text, task).hints
    assert hint == (
        "The robot got no more commands in `b`, and a command holds for half a second: it stopped after 1.0"
        " s. If it has to drive there, put `robot.move` into `running`."
    )


NOT_ON_ITS_WAY = {
    "stopped": SLOW.replace("corners == 4", "corners == 2"),
    "went to and fro": SLOW.replace("angular=1", "angular=2"),
    "went on": SQUARE.replace("(onexit [corners += 1])", ""),
}


@pytest.mark.slow
@every("text", NOT_ON_ITS_WAY.values())
def test_the_time_is_not_blamed_where_a_robot_would_not_have_come_to_the_end(text):
    assert "Time ran out" not in hints(text, "square")


def test_turning_errands_and_looking_around_are_no_endless_turns():
    text = """(machine m (state a (onentry [robot.turn_by(50)])) (state b (running [robot.move(linear=0.1)]))
        (on [robot.turn_by.succeeded] a -> b)) (spawn m a)"""
    assert "never stopped" not in hints(text, "square")


def test_a_push_is_told_with_the_state_that_pushes():
    assert "wall in `driving` for 1.1 s, from " in hints(DRIVE, "bump and turn")


@every("name", ["bump and stay", "stop at the line", "find the line"])
def test_of_a_robot_that_was_told_nothing_nothing_else_is_told(name):
    found = hints("(machine m (state a)) (spawn m a)", name)
    assert "never received a command" in found
    assert "0.00 m" not in found
    assert "never told to drive" not in found


LEFT = "(state c) (on [1 < 2] a -> c)"
ELSEWHERE = "(state b (running [robot.move(linear=0.1)])) (on [1 > 2] a -> b)"
NEVER_TOLD = {
    ("running [robot.stop()]", ""): "never told to drive. `robot.move",
    ("running [robot.stop()]", ELSEWHERE): "only `b` commands it, and the run never entered that state",
    ("running [robot.move(linear=0)]", ""): "although `a` was active",
    ("running [robot.move(linear=0.2)]) (onexit [robot.stop()]", LEFT): "`a` was left before its first",
}


@every("row", NEVER_TOLD.items())
def test_who_never_told_the_robot_to_drive_is_told_why(row):
    (actions, others), words = row
    task = Challenge("metre", "Drive a metre.", "empty", (drives(1),), 3)
    assert words in hints(f"(machine m (state a ({actions})) {others}) (spawn m a)", task)


def test_an_issue_silences_what_would_be_said_of_a_program_that_runs():
    found = hints(WAITS.format("(running [sped])", ""), "bump and stay")
    assert found.startswith("Line 1: `sped`")
    assert "never received" not in found


def test_what_was_not_decided_when_a_run_was_cut_short_is_not_called_failed():
    task = Challenge("lamp", "Blink, and drive 10 m.", "empty", (drives(10), blinks(1)), 30)
    result = grade("(machine m (state a (running [robot.move(linear=0.1)]))) (spawn m a)", task)
    drove, blinked = result.attempts[0].verdicts
    assert (drove.state, blinked.state) == ("open", "failed")
    assert str(drove) == "○ drives at least 10 m: not decided, because the run failed after 1.3 s"
    assert result.attempts[0].failure == blinked


@pytest.mark.slow
def test_of_a_line_that_a_follower_never_saw_the_hint_says_so():
    text = (
        "(machine m (state black (running [robot.move(linear=0.12, angular=0.8)]))"
        " (state white (running [robot.move(linear=0.12, angular=-0.8)]))"
        " (on [robot.light.data < 128] white -> black) (on [robot.light.data >= 128] black -> white))"
        " (spawn m black)"
    )
    beside = moves("robot", x=0.1, y=0.01, degrees=10)  # its sensor
    task = replace(challenge("follow the line"), vary=beside)
    assert "never saw the line" in grade(text, task, [2]).hint


CUT_SHORT = {  # what ended the run is told, and not what it has therefore not done
    "half the speed": ("linear=speed", "linear=0.1", "not at half"),
    "edit it live": ("linear=forward", "linear=0.1", "The edit has stopped"),
}


@every(("name", "row"), CUT_SHORT.items())
def test_of_a_program_that_restarted_nothing_else_is_told(name, row):
    old, new, words = row
    task = challenge(name)
    found = hints(task.starter.replace(old, new), name)
    assert "The program restarted" in found
    assert words not in found


def test_of_a_square_that_the_lamp_has_ended_no_missing_corner_is_told():
    found = hints(SQUARE + "(machine lamp (state dark)) (spawn lamp dark)", "lamp and legs")
    assert "never switched" in found
    assert "missed the square" not in found


def test_of_a_sensor_that_failed_before_a_near_wall_the_hint_says_so():
    text = DRIVE.replace("0.2", "min(0.3, robot.distance.data - 0.25)")
    _, jobs = jobs_of(text, "stop before the wall")
    near = [made for job in jobs if job.world_name == "near wall" and not (made := attempt(job)).passed]
    assert near
    assert all("its sensor had failed" in made.hint for made in near)

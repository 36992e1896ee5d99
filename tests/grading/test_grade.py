import re
import sys
from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location

import pytest
from support.tables import every

from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading.attempt import Job, attempt
from lrp_jupyter.grading.challenges import Challenge, challenge, challenges
from lrp_jupyter.grading.criteria import (
    Criterion,
    drives,
    enters,
    touches,
    touches_nothing,
    visits,
)
from lrp_jupyter.grading.grade import grade, jobs_of
from lrp_jupyter.grading.referee import Referee
from lrp_jupyter.grading.workers import close_workers
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse
from lrp_jupyter.live.session import Session
from lrp_jupyter.programs import load
from lrp_jupyter.sim.world import BoxSolid, CircleZone, RobotSpec, World
from lrp_jupyter.sim.worlds import load as load_world

DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)]))) (spawn m driving)"

FOLLOWER = load("follower")


def test_there_and_back_is_mastered_with_noise_of_many_seeds():
    result = grade(FOLLOWER, "there and back", seeds=2)
    assert result.passed, str(result)
    assert len({attempt.seconds for attempt in result.attempts}) > 1


@pytest.mark.slow
def test_two_gradings_are_equal():
    assert grade(DRIVE, "stop at the line", seeds=1) == grade(DRIVE, "stop at the line", seeds=1)


@pytest.mark.slow
@every("each", challenges()[::6])
def test_doing_nothing_masters_nothing_and_gets_a_hint(each):
    made = attempt(jobs_of("(machine m (state idle)) (spawn m idle)", each)[1][0])
    assert not made.passed
    assert made.hint


@pytest.mark.slow
def test_a_grade_prints_every_criterion_with_its_reason_and_has_a_small_repr():
    result = grade(DRIVE, "stop at the line", seeds=2)
    text = str(result)
    assert "✗ ends in `at the line`" in text
    assert re.search(r"✓ finds the line: it saw it after 2\.\d s", text)
    assert "not with seed 0, 1" in text
    assert repr(result) == "<Grade stop at the line: not yet, 0 of 6 runs>"


@pytest.mark.slow
def test_the_hints_of_all_runs_differ_in_more_than_their_figures():
    result = grade(DRIVE, "stop at the line", seeds=2)
    every = {hint for attempt in result.attempts for hint in attempt.hints}
    assert len(every) > 3, "the line is elsewhere in each run"
    assert all(hint.startswith("The robot crossed the line after ") for hint in every)
    assert result.hints == result.attempts[0].hints[:1]


def test_a_rule_of_every_challenge_is_shown_when_it_is_broken():
    text = str(grade(DRIVE.replace("0.2", "speed"), "first move"))
    assert "✗ runs without issues: line 1: `speed` is not defined here" in text
    assert "runs without issues" not in str(grade(DRIVE, "first move"))


def test_a_robot_that_is_put_into_the_goal_has_not_come_there():
    world = World(
        size=(3, 2), robots=(RobotSpec((0.5, 1, 0)),), zones={"goal": CircleZone((2.5, 1, 0.2))}, name="mine"
    )
    task = Challenge("way", "", (world,), (visits("goal"),), 20)
    with Session(DRIVE, "sim", world=world) as session:
        referee = Referee(task, session.bridge.world)
        session.run(1, after_tick=lambda: referee.see(session.bridge, session.interpreter))
        session.bridge.place_robot((2.4, 1, 0))
        session.run(2, after_tick=lambda: referee.see(session.bridge, session.interpreter))
    assert [verdict.sentence for verdict in referee.verdicts(True) if not verdict.passed] == [
        "is not carried"
    ]


@pytest.mark.slow
def test_as_many_runs_have_to_pass_as_the_challenge_needs():
    lucky = Criterion("has luck", lambda run: (run.samples[0].lights[0] > 255 * (1 - 0.5), ""), "once")
    task = Challenge(
        "luck", "", ("empty",), (drives(0.1), lucky), 3, noise={"light": 300}, seeds=20, needed=0.5
    )
    result = grade(DRIVE, task)
    good = sum(made.passed for made in result.attempts)
    assert 10 <= good < 20
    assert (result.passed, result.points) == (True, 10)
    assert "50% of the runs have to pass" in str(result)
    assert not grade(DRIVE, replace(task, needed=0.99))


def test_a_challenge_of_editing_live_begins_with_its_own_program():
    task = challenge("half the speed")
    _, jobs = jobs_of("(var a := [1])", task)
    assert jobs[0].texts == (task.beginning, "(var a := [1])")
    assert jobs[0].durations == (3, 117)
    _, jobs = jobs_of(["(var a := [1])", "(var a := [2])"], task)
    assert jobs[0].texts == ("(var a := [1])", "(var a := [2])")


def test_the_seeds_of_a_challenge_can_be_numbers_of_its_own():
    assert {seed for _, seed in challenge("robust follower").runs} == set(range(1000, 1025))


def test_a_world_of_ones_own_is_graded_by_criteria_of_ones_own():
    world = World(
        size=(3, 2), robots=(RobotSpec((0.5, 1, 0)),), zones={"goal": CircleZone((1.5, 1, 0.2))}, name="mine"
    )
    hurry = Criterion("is there in three seconds", lambda run: (run.seconds < 3, f"{run.seconds:.1f} s"))
    assert grade(DRIVE, world, criteria=[visits("goal"), drives(1), enters("driving")], seconds=8)
    assert not grade(DRIVE, world, criteria=[visits("goal"), hurry], seconds=8)


def test_the_functions_of_a_notebook_are_visible_in_a_graded_program():
    assert grade(DRIVE.replace("0.2", "speed()"), "first move", namespace={"speed": lambda: 0.3})


def test_a_program_a_session_and_a_text_are_graded_alike():
    program = parse(DRIVE)
    with Session(DRIVE) as session:
        assert grade(program, "first move") == grade(session, "first move") == grade(DRIVE, "first move")
    with pytest.raises(TypeError, match="not int"):
        grade(3, "first move")


def test_a_criterion_that_its_process_cannot_import_is_not_a_failing_grade(monkeypatch, tmp_path):
    (tmp_path / "nowhere.py").write_text("def judge(run): return run.driven > 0.1, 'is'")
    spec = spec_from_file_location("nowhere", tmp_path / "nowhere.py")
    nowhere = module_from_spec(spec)
    spec.loader.exec_module(nowhere)
    monkeypatch.setitem(sys.modules, "nowhere", nowhere)
    with pytest.raises(LRPError, match="No module named 'nowhere'"):
        grade(DRIVE, Challenge("odd", "", ("empty",), (Criterion("is judged", nowhere.judge),), 5), seeds=1)


def test_a_fault_of_our_own_is_not_a_failing_grade(monkeypatch):
    monkeypatch.setattr(Interpreter, "step", lambda *_: {}["our own mistake"])
    with pytest.raises(LRPError, match="our own mistake"):
        attempt(jobs_of(DRIVE, "first move")[1][0])


def test_a_challenge_is_found_by_name_and_a_wrong_name_is_answered_with_the_nearest():
    assert challenge("There and-back").name == "there and back"
    with pytest.raises(LRPError, match="Did you mean `follow the line`"):
        grade(DRIVE, "folow the lin")


def test_a_run_ends_when_every_criterion_is_met():
    long = Challenge("way", "", ("empty",), (drives(0.1), touches_nothing()), 1000)
    (attempt,) = grade(DRIVE, long).attempts
    assert attempt.passed
    assert attempt.seconds < 2


@pytest.mark.slow
def test_a_run_ends_when_a_criterion_is_broken_for_good():
    long = Challenge("way", "", ("empty",), (drives(10), touches_nothing()), 1000)
    (attempt,) = grade(DRIVE, long).attempts
    assert not attempt.passed
    assert attempt.seconds < 10
    assert attempt.failure.sentence == "touches nothing"


def test_what_a_criterion_has_seen_of_a_run_is_not_looked_at_again(monkeypatch):
    seen = []

    def step(so_far, now, before):
        seen.append(now.time)
        return so_far + 1

    counted = Criterion("counts", lambda run: (run.fold(step, 0) > 10**6, "counted"))
    attempt(Job((DRIVE,), Challenge("way", "", ("empty",), (counted,), 5), load_world("empty"), 0, 60))
    assert len(seen) == len(set(seen)) > 40


def test_what_is_missing_in_an_order_is_reported_with_the_time_of_the_one_before():
    world = World(
        size=(2, 1),
        robots=(RobotSpec((0.3, 0.5, 0)),),
        solids=(BoxSolid((1.5, 0.5, 0.2, 0.2), name="ball"),),
        zones={"start": CircleZone((0.3, 0.5, 0.05)), "near": CircleZone((0.8, 0.5, 0.05))},
        name="mine",
    )
    expected = {
        visits("start", "near"): "it reached `near` after 2.3 s",
        visits("near", "start"): "it reached `near` after 2.3 s, but never reached `start` after that",
        touches("ball"): "it touched the ball after 5.1 s",
        touches("ball", "edge"): "it touched the ball after 5.1 s, but never touched the edge after that",
        touches("edge"): "it never touched the edge",
    }
    result = grade(DRIVE, world, criteria=list(expected), seconds=8)
    reasons = [verdict.reason for verdict in result.attempts[0].verdicts]
    assert reasons == list(expected.values())


@pytest.mark.parametrize("block", ["while True: pass", "import threading; threading.Event().wait(1000)"])
def test_a_block_that_does_not_return_ends_the_grading_with_a_sentence(block):
    result = grade(DRIVE.replace("robot.move(linear=0.2)", block), "there and back", seeds=5, limit=1)
    assert len(result.attempts) < 5  # the other seeds would take as long
    attempt = result.attempts[0]
    assert not result.passed
    assert attempt.ended == "time"
    assert "`driving.running` (line 1) did not return" in str(result)
    assert "`ontime`" in str(result)


@pytest.mark.slow
def test_a_run_whose_blocks_compute_too_long_ends_with_a_sentence():
    result = grade(DRIVE.replace("robot", "sum(range(300_000)); robot"), "there and back", limit=0.9)
    attempt = result.attempts[0]
    assert attempt.ended == "time"
    assert "took longer than 0.9 s of computing" in str(result)


def test_a_number_of_seeds_means_the_first_ones_of_the_challenge():
    task = Challenge("few", "Drive.", "empty", drives(0.1), 5, seeds=(7, 8))
    assert [attempt.seed for attempt in grade(DRIVE, task, 1).attempts] == [7]
    assert [attempt.seed for attempt in grade(DRIVE, task, 4).attempts] == [7, 8, 9, 10]
    assert [attempt.seed for attempt in grade(DRIVE, task, [3]).attempts] == [3]


@pytest.mark.slow
def test_marks_are_the_same_whatever_the_hashes_of_the_process_that_grades(monkeypatch):
    text = DRIVE.replace("linear=0.2", "linear=0.02 * list({'a', 'b', 'c', 'd', 'e', 'f', 'g'}).index('a')")
    results = []
    for seed in ("1", "2", "3"):
        close_workers()
        monkeypatch.setenv("PYTHONHASHSEED", seed)
        results.append(grade(text, "first move", 1))
    assert results[0] == results[1] == results[2]
    close_workers()

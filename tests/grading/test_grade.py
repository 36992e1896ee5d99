import pytest

from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading.attempt import Job, attempt
from lrp_jupyter.grading.challenges import Challenge, challenge, challenges
from lrp_jupyter.grading.criteria import (
    Criterion,
    drives,
    enters,
    no_faults,
    touches,
    touches_nothing,
    visits,
)
from lrp_jupyter.grading.grade import grade, jobs_of
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.world import BoxSolid, CircleZone, RobotSpec, World

DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)]))) (spawn m driving)"

FOLLOWER = """
(var lightlim := [128]) (var maxlook := [200]) (var forward := [0.2])
(var search := [1.0]) (var back := [-0.2]) (var turn := [1])
(machine follower
  (state moving (running [robot.move(linear=forward)]))
  (on outofline moving -> looking tlooking)
  (on intheline looking -> moving tmoving)
  (event outofline [robot.light.data > lightlim + 10])
  (event intheline [robot.light.data < lightlim - 10])
  (state looking
    (machine lookalgo
      (var time := [maxlook])
      (state lookleft (running [robot.move(angular=search)]))
      (state returnleft (running [robot.move(angular=-search)]))
      (state lookright (running [robot.move(angular=-search)]))
      (state returnright (running [robot.move(angular=search)]) (onexit [time = time * 2]))
      (ontime time lookleft -> returnleft)
      (ontime time returnleft -> lookright)
      (ontime time lookright -> returnright)
      (ontime time returnright -> lookleft))
    (onentry [robot.stop()] (spawn lookalgo lookleft)))
  (var nobump := [True])
  (event bumping [robot.bumper.data == 1 and nobump])
  (event ending [robot.bumper.data == 1 and not nobump])
  (on bumping *-> bumpback)
  (on ending *-> end)
  (state bumpback (running [robot.move(linear=back)]))
  (ontime 1000 bumpback -> bumpturn)
  (state bumpturn (onentry [nobump = False]) (running [robot.move(angular=turn)]))
  (ontime 3000 bumpturn -> looking)
  (state end))
(spawn follower looking)
"""

SOLVED = {
    "first move": DRIVE,
    "stop at the line": """
        (machine m
          (state driving (running [robot.move(linear=0.2)]))
          (state stopped (onentry [robot.stop()]))
          (on line driving -> stopped) (event line [robot.light.data < 128]))
        (spawn m driving)""",
    "square": """
        (var corners := [0])
        (machine m
          (state side (running [robot.move(linear=0.2)]))
          (state corner (running [robot.move(angular=1)]) (onexit [corners = corners + 1]))
          (state home (onentry [robot.stop()]))
          (on [corners == 4] side -> home)
          (ontime 3000 side -> corner) (ontime 1571 corner -> side))
        (spawn m side)""",
    "bump and stay": """
        (machine m
          (state driving (running [robot.move(linear=0.2)]))
          (state staying (onentry [robot.stop()]))
          (on [robot.bumper.data == 1] driving -> staying))
        (spawn m driving)""",
    "follow the line": FOLLOWER,
    "find the line": """
        (machine m
          (state driving (running [robot.move(linear=0.2)]))
          (state stopped (onentry [robot.stop()]))
          (on line driving -> stopped) (event line [robot.light.data < 128]))
        (spawn m driving)""",
    "there and back": FOLLOWER,
    "debug the printed listing": FOLLOWER,
    "edge guard": """
        (machine m
          (state driving (running [robot.move(linear=0.15)]))
          (state backing (running [robot.move(linear=-0.15)]))
          (state turning (running [robot.move(angular=1)]))
          (on [robot.light.data < 128] driving -> backing)
          (ontime 600 backing -> turning) (ontime 1900 turning -> driving))
        (spawn m driving)""",
    "push the box": """
        (machine m
          (state pushing (running [robot.move(linear=0.2)]))
          (state done (onentry [robot.stop()]))
          (on [robot.odom.x > 1.75] pushing -> done))
        (spawn m pushing)""",
    "wall follower": """
        (var keep := [0.2])
        (event open [robot.distance.all[1] > 2 * keep])
        (event wall [robot.distance.all[1] < 2 * keep])
        (event close [robot.distance.data < keep])
        (machine follower
          (state along (running [robot.move(linear=0.1, angular=2 * (robot.distance.all[1] - keep))]))
          (state passing (running [robot.move(linear=0.1)]))
          (state round (running [robot.move(linear=0.1, angular=0.35)]))
          (state away (running [robot.move(angular=-0.8)]))
          (on close *-> away)
          (ontime 500 away -> along)
          (on open along -> passing)
          (ontime 1200 passing -> round)
          (on wall round -> along))
        (spawn follower along)""",
    "maze": """
        (var keep := [0.15])
        (machine mouse
          (event open [robot.distance.all[1] > 0.3])
          (event wall [robot.distance.all[1] < 0.25])
          (event blocked [robot.distance.data < 0.12])
          (event free [robot.distance.data > 0.3])
          (state along (running [robot.move(linear=0.15, angular=3 * (robot.distance.all[1] - keep))]))
          (state round (running [robot.move(linear=0.12, angular=0.6)]))
          (state away (running [robot.move(angular=-1)]))
          (on blocked {along round} -> away)
          (on open along -> round)
          (on wall round -> along)
          (on free away -> along))
        (spawn mouse along)""",
    "edit it live": [
        "(var v := [0.1])\n" + DRIVE.replace("0.2", "v"),
        "(var v := [0.2])\n" + DRIVE.replace("0.2", "v"),
    ],
}


@pytest.mark.parametrize("name", SOLVED)
def test_a_good_program_masters_its_challenge(name):
    result = grade(SOLVED[name], name)
    assert result.passed, str(result)
    assert bool(result) is True


def test_there_and_back_is_mastered_with_noise_of_many_seeds():
    result = grade(FOLLOWER, "there and back", seeds=5)
    assert result.passed, str(result)
    assert len({attempt.seconds for attempt in result.attempts}) > 1


def test_two_gradings_are_equal():
    assert grade(FOLLOWER, "there and back", seeds=1) == grade(FOLLOWER, "there and back", seeds=1)


@pytest.mark.parametrize("each", challenges(), ids=lambda each: each.name)
def test_doing_nothing_masters_nothing_and_gets_a_hint(each):
    result = grade("(machine m (state idle)) (spawn m idle)", each)
    assert not result
    assert "robot.move" in result.hint


@pytest.mark.parametrize(
    ("name", "text", "hint"),
    [
        ("first move", "(machine m (state a (running [robot.move(linear=0.2)])))", "(spawn machine state)"),
        ("first move", DRIVE.replace("linear=0.2", "linear=sped"), "`sped`"),
        ("first move", "(machine m (state a (onentry [robot.move(linear=0.2)]))) (spawn m a)", "Put `move`"),
        ("first move", "(machine m", "Correct the text"),
        ("stop at the line", DRIVE, "drove on"),
        ("square", DRIVE.replace("linear=0.2", "linear=0.1"), "quarter"),
        ("bump and stay", DRIVE, "keeps pushing"),
        ("follow the line", DRIVE, "lost the line"),
        ("there and back", FOLLOWER.replace("(onentry [nobump = False]) ", "").replace(
            "(state bumpback", "(state bumpback (onentry [nobump = False])"), "one tick later"),
        ("stop at the line", DRIVE.replace("0.2", "-0.1"), "never saw the line"),
        ("there and back", FOLLOWER.replace("(on bumping *-> bumpback)", ""), "pushing against the far wall"),
        ("wall follower", DRIVE.replace("linear=0.2", "linear=0.2, angular=0.3"), "too close to the wall"),
        ("edge guard", DRIVE, "Drive back first"),
        ("edit it live", [DRIVE, DRIVE.replace("0.2", "0.3")], "never restart"),
    ],
)  # fmt: skip
def test_a_typical_mistake_gets_its_hint(name, text, hint):
    result = grade(text, name)
    assert not result
    assert hint in result.hint, str(result)


def test_a_grade_prints_every_criterion_with_its_reason_and_has_a_small_repr():
    result = grade(DRIVE, "stop at the line", seeds=2)
    text = str(result)
    assert "✗ ends in `at the line`" in text
    assert "✓ runs without issues: no issue" in text
    assert "not with seed 0, 1" in text
    assert repr(result) == "<Grade stop at the line: not yet, 0 of 2 runs>"


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


def test_a_fault_of_our_own_is_not_a_failing_grade(monkeypatch):
    monkeypatch.setattr(Interpreter, "step", lambda *_: {}["our own mistake"])
    with pytest.raises(LRPError, match="our own mistake"):
        attempt(jobs_of(DRIVE, "first move")[1][0])


def test_a_challenge_is_found_by_name_and_a_wrong_name_is_answered_with_the_nearest():
    assert challenge("There and-back").name == "there and back"
    with pytest.raises(LRPError, match="Did you mean `follow the line`"):
        grade(DRIVE, "folow the lin")


def test_a_run_ends_when_every_criterion_is_met():
    long = Challenge("way", "", ("empty",), (drives(0.1), no_faults()), 1000)
    (attempt,) = grade(DRIVE, long).attempts
    assert attempt.passed
    assert attempt.seconds < 2


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
    attempt(Job((DRIVE,), Challenge("way", "", ("empty",), (counted,), 5), "empty", 0, 60))
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
        visits("start", "near"): "it was there after 2.4 s",
        visits("near", "start"): "it never came to `start` after 2.4 s",
        touches("ball"): "it touched it after 5.2 s",
        touches("ball", "wall"): "it never touched the wall after 5.2 s",
        touches("wall"): "it never touched the wall",
    }
    result = grade(DRIVE, world, criteria=list(expected), seconds=8)
    *reasons, _ = (verdict.reason for verdict in result.attempts[0].verdicts)  # without "no issue"
    assert reasons == list(expected.values())


@pytest.mark.parametrize("block", ["while True: pass", "import time; time.sleep(1000)"])
def test_a_block_that_does_not_return_ends_the_grading_with_a_sentence(block):
    result = grade(DRIVE.replace("robot.move(linear=0.2)", block), "there and back", seeds=5, limit=1)
    assert len(result.attempts) < 5  # the other seeds would take as long
    attempt = result.attempts[0]
    assert not result.passed
    assert attempt.ended == "time"
    assert "`driving.running` (line 1) did not return" in str(result)
    assert "`ontime`" in str(result)


def test_a_run_whose_blocks_compute_too_long_ends_with_a_sentence():
    result = grade(DRIVE.replace("robot", "sum(range(300_000)); robot"), "there and back", limit=0.3)
    attempt = result.attempts[0]
    assert attempt.ended == "time"
    assert "took longer than 0.3 s of computing" in str(result)

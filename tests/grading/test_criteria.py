"""Criteria, as functions of the samples of a run."""

import math

import pytest
from support.tables import every

from lrp_jupyter.grading.criteria import (
    avoids,
    backs_off,
    backs_off_at_bumps,
    blinks,
    bumps,
    bumps_in,
    drives_differently,
    drives_on,
    drives_smoothly,
    drives_straight,
    ends_near_line,
    finds_line,
    gets_away,
    keeps_distance,
    keeps_driving,
    lit_while,
    looks,
    moves_only_in,
    never_pushes,
    not_carried,
    pushes,
    reused,
    slows_to,
    stays_near,
    stops_at,
    stops_once,
    turns_at_bumps,
    visits,
    within,
    without,
)
from lrp_jupyter.grading.criteria.contact import gap_to
from lrp_jupyter.grading.run_record import RunRecord, at_start
from lrp_jupyter.language.parser import parse
from lrp_jupyter.sim.world import BoxSolid, BoxZone, FloorSpec, PathStroke, RobotSpec, World

WORLD = World(
    size=(4, 2),
    robots=(RobotSpec((0, 1, 0)),),
    floor=FloorSpec(strokes=(PathStroke(((2, 0), (2, 2))),)),
    solids=(BoxSolid((3, 1, 0.1, 1), push=0.3, name="box"), BoxSolid((3.5, 1, 0.1, 1), name="wall")),
    zones={"here": BoxZone((0.5, 1, 1, 2)), "there": BoxZone((3, 1, 1, 2))},
    name="mine",
)


def run(seconds, *, v=0.0, w=0.0, **changes):
    """Return a run of which each field is a constant, or a function of time; `v` and `w` are its speeds."""
    (first,) = at_start(WORLD).samples
    record = RunRecord(WORLD)
    x, heading = 0.0, 0.0
    for tick in range(round(seconds * 10) + 1):
        time = tick / 10
        now = {
            name: value(time) if callable(value) else value
            for name, value in {**changes, "v": v, "w": w}.items()
        }
        linear, angular = now.pop("v"), now.pop("w")
        sample = first._replace(time=time, x=x, heading=heading, command=(linear, angular))
        record.samples.append(sample._replace(**now))
        x, heading = x + linear / 10, heading + angular / 10
    return record


IN_A, IN_B = ((("m", state, "part", "on"),) for state in "ab")


def touching(*spans):
    return lambda time: frozenset({"wall"} if _is_in(time, spans) else ())


def pressing(*spans):
    return {"touched": touching(*spans), "bumper": lambda time: _is_in(time, spans)}


def _is_in(time, spans):
    return any(a <= time < b for a, b in spans)


def _swaying(seconds):
    return lambda time: 0.5 if time % (2 * seconds) < seconds else -0.5


def _bouncing(time):
    return -0.1 if 2.5 <= time < 3 else 0.1


def _pressed(time):
    return 2 <= time < 2.2


TABLE = [
    (gets_away(0.3), run(2, v=0.2), 1, "it was at most 40 cm away"),
    (gets_away(0.3), run(2, v=lambda t: 0.2 if int(t * 10) % 4 < 2 else -0.2), 0.13, "at most 4 cm"),
    (avoids("there"), run(5, v=0.2), 1, "it never entered it"),
    (avoids("there"), run(5, v=0.6), 0, "it entered it after 4.2 s"),
    (keeps_driving(1), run(5, v=0.2), 1, "it never stood still"),
    (keeps_driving(1), run(5, v=lambda t: 0.2 * (t < 2)), 0, "it stood still for 3.0 s"),
    (stops_once(4), run(9, v=lambda t: 0.2 * (t < 2)), 1, "it did not drive on after a stop"),
    (stops_once(4), run(9, v=lambda t: 0.2 * (t < 2 or t > 5)), 1, "it did not drive on after a stop"),
    (stops_once(4), run(9, v=lambda t: 0.2 * (t < 2 or t > 7)), 0, "it had stopped, and drove on after 7."),
    (stops_once(4), run(9, v=lambda t: 0.2 * (t > 5)), 1, "it did not drive on after a stop"),
    (drives_straight(0.8), run(5, v=0.2), 1, "100%"),
    (drives_straight(0.8), run(5, v=0.2, w=0.5), 0, "0%"),
    (drives_smoothly(0.1), run(4, v=lambda t: 0.1 * (t > 1)), 1, "its speed changed by 10 cm/s at most"),
    (drives_smoothly(0.1), run(4, v=lambda t: 0.2 * (t > 1)), 0, "changed by 20 cm/s after 1.1 s"),
    (keeps_distance("box", 1, 3), run(5, v=0.2), 1, "it was 187 to 287 cm away"),
    (keeps_distance("box", 1, 2.5), run(5, v=0.2), 0, "it was 287 cm away after 0.0 s"),
    (keeps_distance("box", 2, 3), run(5, v=0.2), 0, "it was 187 cm away after 5.0 s"),
    (backs_off(2), run(4, v=lambda t: -0.1 if t % 2 > 1 else 0.1), 1, "it backed off twice"),
    (backs_off(2), run(4, v=0.1), 0, "it never backed off"),
    (within(2, visits("here", "there")), run(6, v=0.6), 0.99, "not within 2 s"),
    (within(5, visits("here", "there")), run(4.5, v=0.6), 1, "it reached `there` after 4.2 s"),
    (bumps(2), run(5, v=0.1, touched=touching((1, 1.2), (3, 3.2))), 1, "it bumped twice"),
    (bumps(2), run(5, v=0.1, touched=touching((1, 1.2), (1.4, 4))), 0.5, "it bumped once"),
    (bumps(2, walls=2), run(5, touched=touching((1, 2), (3, 4))), 0.5, "into 1 of 2 walls"),
    (never_pushes(1), run(5, v=0.1, **pressing((1, 1.9))), 1, "it pushed for 0.9 s"),
    (never_pushes(1), run(5, v=0.1, **pressing((1, 3))), 0, "it pushed for 2.0 s"),
    (never_pushes(1), run(5, v=0.1, touched=touching((1, 3))), 1, "it never pushed"),
    (never_pushes(1), run(5, v=-0.1, **pressing((1, 3))), 1, "it never pushed"),
    (never_pushes(1), run(9, v=lambda t: 0.1 * (t % 2 < 0.6), **pressing((1, 9)), x=1), 0, "for 2.7 s"),
    (never_pushes(1), run(9, v=0.1, **pressing((1, 1.6), (3, 3.6), (5, 5.6))), 1, "pushed for 0.6 s"),
    (backs_off_at_bumps(1), run(6, v=_bouncing, touched=touching((2, 2.2)), bumper=_pressed), 1, "each time"),
    (
        backs_off_at_bumps(1),
        run(6, v=0.1, touched=touching((2, 2.2)), bumper=_pressed),
        0,
        "after 2.0 s",
    ),
    (
        turns_at_bumps(20),
        run(
            6, v=_bouncing, w=lambda t: 1 if 2.5 <= t < 3 else 0, touched=touching((2, 2.2)), bumper=_pressed
        ),
        1,
        "each time",
    ),
    (turns_at_bumps(20), run(6, v=_bouncing, touched=touching((2, 2.2)), bumper=_pressed), 0, "turning 0°"),
    (backs_off_at_bumps(1), run(6, v=_bouncing), 0, "after 2.5 s, and had not bumped"),
    (bumps_in("a", "b"), run(2, bumper=lambda t: t > 1, active=(("m", "a"),)), 0.5, "never bumped in `b`"),
    (
        bumps_in("a", "b"),
        run(2, bumper=lambda t: t > 1, active=lambda t: (("m", "a" if t < 1.2 else "b"),)),
        0.5,
        "`b`",
    ),
    (
        stops_at("wall", 1),
        run(5, v=lambda t: 0.1 * (t < 2.5), touched=touching((2, 5))),
        1,
        "it stopped 0.4 s",
    ),
    (stops_at("wall", 1), run(5, v=0.1, touched=touching((2, 5))), 0, "it was still driving"),
    (
        stops_at("wall", 1),
        run(5, v=lambda t: -0.2 * (2 <= t < 2.5), touched=touching((2, 2.2))),
        0,
        "10 cm away",
    ),
    (keeps_driving(1, until="wall"), run(5, v=lambda t: t < 2, touched=touching((2, 5))), 1, "never stood"),
    (keeps_driving(1, until="wall"), run(5, v=lambda t: t < 2, touched=touching((4, 5))), 0, "for 1.9 s"),
    (finds_line(), run(2, lights=lambda t: (0 if t > 1 else 255,)), 1, "after 1.1 s"),
    (finds_line(), run(2), 0, "it never saw it"),
    (ends_near_line(0.1), run(1, x=2.05), 1, "5 cm away"),
    (ends_near_line(0.1), run(1, x=2.5), 0, "50 cm away"),
    (
        looks("here", 60),
        run(6, w=lambda t: 0.7 if t < 2 else -0.7),
        1,
        "80° to the left and 80° to the right",
    ),
    (looks("here", 60), run(2, w=0.7), 0.5, "80° to the left and 0° to the right"),
    (blinks(1), run(6, lamp=lambda t: t % 2 >= 1), 1, "it was switched 6 times"),
    (blinks(1), run(6, lamp=lambda t: t % 4 >= 2), 0, "2.0 s"),
    (blinks(1), run(6, lamp=False), 0, "6.0 s"),
    (
        lit_while("drives", lambda now: now.command[0]),
        run(4, v=lambda t: t > 1, lamp=lambda t: t > 1.1),
        1,
        "",
    ),
    (lit_while("drives", lambda now: now.command[0]), run(4, v=0.1), 0, "it was dark"),
    (lit_while("drives", lambda now: now.command[0]), run(4, lamp=True), 0, "it was lit"),
    (lit_while("drives", lambda now: now.command[0]), run(4, v=lambda t: t % 1 < 0.15), 0, "it was dark"),
    (
        lit_while("drives", lambda now: now.command[0]),
        run(4, v=lambda t: t > 1, lamp=lambda t: t > 1 and round(t * 10) % 2),
        0,
        "after 1.8 s it was dark",
    ),
    (
        slows_to(0.5),
        run(6, v=lambda t: 0.2 if t < 3 else 0.1, version=lambda t: t > 3),
        1,
        "and then at 0.10 m/s",
    ),
    (slows_to(0.5), run(6, v=0.2, version=lambda t: t > 3), 0, "and then at 0.20 m/s"),
    (slows_to(0.5), run(6, v=lambda t: 0.2 if t < 3 else 0.1), 0, "it drives at 0.10 m/s"),
    (
        slows_to(0.5),
        run(6, v=lambda t: 0.2 if t < 3 or t % 0.4 < 0.2 else 0, version=lambda t: t > 3),
        0,
        "then at 0.1",
    ),
    (drives_differently(), run(9, w=_swaying(2), version=lambda t: t > 5), 0, "as before the edit"),
    (drives_differently(), run(9, w=_swaying(2)), 0, "no edit"),
    (drives_differently(), run(2, v=0.2, version=lambda t: t > 1), 0, "as before the edit"),
    (
        drives_differently(),
        run(9, v=lambda t: 0.2 if t < 5 else 0.205, w=_swaying(2), version=lambda t: t > 5),
        0,
        "as before",
    ),
    (
        drives_differently(),
        run(9, v=lambda t: 0.2 if t < 5 else 0.1, w=_swaying(2), version=lambda t: t > 5),
        1,
        "0.10 m/s",
    ),
    (
        drives_differently(),
        run(9, w=lambda t: _swaying(2 if t < 5 else 1)(t), version=lambda t: t > 5),
        1,
        "for 1.0 s",
    ),
    (
        drives_differently(),
        run(9, w=lambda t: _swaying(2)(min(t, 5)), version=lambda t: t > 5),
        1,
        "for 2.3 s",
    ),
    (drives_on(0.5), run(6, v=0.2, version=lambda t: t > 3), 1, "58 cm after the edit"),
    (drives_on(0.5), run(6, v=0.2), 0, "0 cm after the edit"),
    (reused("part"), run(1, active=lambda t: IN_A if t < 0.5 else IN_B), 1, "`part` ran in `a` and in `b`"),
    (reused("part"), run(1, active=IN_A), 0.5, "`part` ran in `a` only"),
    (reused("part"), run(1, active=(("part", "on"),)), 0, "`part` never ran"),
    (moves_only_in("part"), run(1, movers=frozenset({("m", "a", "part")})), 1, "no other machine"),
    (moves_only_in("part"), run(1, movers=frozenset({("m",)})), 0, "`m` moved it"),
    (stays_near("wall", 3.5), run(3, v=0.2), 1, "it was at most 345 cm away"),
    (stays_near("wall", 1), run(3, v=0.2), 0, "345 cm away after 0.0 s"),
    (pushes("box", "there", 2), run(3), 1, "still for 3.0 s"),
    (pushes("box", "here", 2), run(3), 0, "the box is at x = 3.00 m"),
    (not_carried(), run(3, v=0.5), 1, "it drove by itself"),
    (not_carried(), run(3, x=lambda t: 1.0 if t > 2 else 0.0), 0, "it was put down elsewhere after 2.1 s"),
]


@every(("criterion", "record", "share", "reason"), TABLE)
def test_a_criterion_measures_a_run(criterion, record, share, reason):
    found, told = criterion.judge(record)
    assert min(1.0, max(0.0, float(found))) == pytest.approx(share, abs=0.01), told
    assert reason in told


@every(("criterion", "record", "share", "reason"), TABLE)
def test_a_criterion_says_the_same_when_it_is_asked_after_every_tick(criterion, record, share, reason):
    growing = RunRecord(WORLD)
    for sample in record.samples:
        growing.samples.append(sample)
        last = criterion.judge(growing)
    assert last == criterion.judge(RunRecord(WORLD, record.samples))


def test_a_machine_that_is_written_twice_is_not_reused():
    record = run(1, active=lambda t: IN_A if t < 0.5 else IN_B)
    record.programs.append(parse("(machine m (state a) (state b)) (machine part (state on))"))
    assert reused("part").missing(record) is None
    part = "(machine part (state on))"
    record.programs.append(parse(f"(machine m (state a {part}) (state b {part}))"))
    assert reused("part").missing(record) == "there are 2 machines `part`"
    record.programs.append(parse("(machine m (state a))"))
    assert reused("part").missing(record) == "there is no machine `part`"


def test_a_program_that_must_do_without_a_task_may_name_it_in_a_comment():
    record = run(1)
    record.programs.append(parse("; not robot.drive_by\n(machine m (state a (running [robot.move()])))"))
    assert without("drive_by", "turn_by").missing(record) is None
    record.programs.append(
        parse("(machine m (state a) (state b) (on [robot.turn_by.succeeded and drive_by] a -> b))")
    )
    assert without("drive_by", "turn_by").missing(record) == "it uses `robot.turn_by`"


def test_a_task_that_a_program_reaches_by_another_name_is_used():
    record = run(1)
    record.programs.append(parse("(machine m (state a))"))
    record.samples[-1] = record.samples[-1]._replace(task="drive_to")
    assert without("drive_to").missing(record) == "it uses `robot.drive_to`"


@every(("angle", "gap"), [(0, 0.87), (math.pi / 2, 0.42)])
def test_the_gap_to_a_box_is_that_to_its_nearest_side(angle, gap):
    (sample,) = run(0).samples
    there = sample._replace(x=2.0, solids=((3.0, 1.0, angle), *sample.solids[1:]))
    assert gap_to(run(0), "box", there) == pytest.approx(gap)

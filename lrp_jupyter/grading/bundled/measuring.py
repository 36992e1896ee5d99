"""Challenges about measuring: where the robot is, how far away a thing is, and what if a sensor fails."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lrp_jupyter.grading.bundled.common_hints import ignores
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import (
    drives_smoothly,
    ends_in,
    ends_still,
    keeps_distance,
    keeps_to,
    lasts,
    touches_nothing,
    visits,
    without,
)
from lrp_jupyter.grading.criteria.contact import gap_to
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.grading.variation import moves, wears
from lrp_jupyter.sim.world import BoxSolid, BoxZone, CircleZone, Patrol, RobotSpec, World

_RADIUS = RobotSpec((0, 0, 0)).radius

# -- exact way -----------------------------------------------------------------------------------------

_LONG, _ACROSS, _NEAR = 1.2, 0.6, 0.2  # m


def _way(name: str, speed: float) -> World:
    """Return a world with zones at the corners of a way: straight on, to the left, and back.

    `speed`: of the wheels, as a share of that which they are told.
    """
    x, y = 0.7, 0.6
    corners = {
        "start": (x, y),
        "first corner": (x + _LONG, y),
        "second corner": (x + _LONG, y + _ACROSS),
        "goal": (x, y + _ACROSS),
    }
    zones = {name: CircleZone((*at, _NEAR)) for name, at in corners.items()}
    robot = RobotSpec((x, y, 0), wheels=(speed, speed))
    return World(name=name, size=(2.6, 1.8), robots=(robot,), zones=zones)


_TASKS = without("drive_by", "turn_by", "drive_to")
_ROUND = visits("first corner", "second corner", "goal")
_ON_ITS_WAY = keeps_to(_NEAR, "start", "first corner", "second corner", "goal")


def _lost_its_way(run: RunRecord) -> Iterator[str]:
    if reason := _TASKS.missing(run):
        yield (
            f"The program asks the robot for a task: {reason}. Here the program has to do the measuring:"
            " steer with `robot.move`, and let `robot.odom` and `robot.gyro` decide."
        )
    yield from ignores(
        run, "odom", "A speed and a time are not a distance: let `[robot.odom.x > 1.2]` end the first side."
    )
    yield from ignores(
        run,
        "gyro",
        "The gyro says how far the robot has turned: `[robot.gyro.data > degrees(90)]` ends a quarter turn.",
    )
    first, last = run.samples[0], run.samples[-1]
    turned = math.degrees(last.heading - first.heading)
    bend, _ = run.fold(_bend, (0.0, False))
    edge = run.touch("edge")
    if run.turned.left > 500:
        yield (
            f"The robot turned {run.turned.left:.0f}°. `robot.gyro.data` is in radians, and counts from the"
            " start: `[robot.gyro.data > degrees(90)]` ends the first corner."
        )
    elif turned < -45:
        yield (
            f"The robot turned {-turned:.0f}° to the right. To the left, `angular` is positive, and so is"
            " the gyro."
        )
    elif bend > 10:
        yield (
            f"On its first side the robot veered off course by {bend:.0f}°, because its wheels are uneven."
            " Steer against the error while it drives: `robot.move(linear=0.2, angular=2 * (0 -"
            " robot.gyro.data))`, on each side with its own angle instead of 0."
        )
    elif edge:
        yield (
            f"The robot drove into the edge after {edge.time:.1f} s{_state(edge)}, when it had turned"
            f" {math.degrees(edge.heading - first.heading):.0f}°. `robot.odom` and `robot.gyro` count from"
            " the start, not from the last corner: the sides end at `x` = 1.2, `y` = 0.6 and `x` = 0, the"
            " corners at 90° and 180°."
        )
    elif reason := _ROUND.missing(run) or _ON_ITS_WAY.missing(run):
        yield (
            f"The robot left its way: {reason}. `robot.odom.x` and `.y` count from the start: the first"
            " side ends at `x` = 1.2, the second at `y` = 0.6, and the way back at `x` = 0."
        )


def _state(sample: Sample) -> str:
    """Say which state was active, the innermost one."""
    return f", in the state `{sample.active[-1][-1]}`" if sample.active else ""


def _bend(so_far: tuple[float, bool], now: Sample, before: Sample) -> tuple[float, bool]:
    """Keep how far the robot veers off course, in degrees, as long as it is told to drive straight on."""
    bend, is_over = so_far
    is_over = is_over or bool(before.command[1]) or bool(now.command[1])
    return (bend if is_over else max(bend, abs(math.degrees(now.heading)))), is_over


EXACT_WAY = Challenge(
    "exact way",
    "Drive 1.2 m straight on, 60 cm to the left, and 1.2 m back, and stop there: never further than 20 cm"
    " from the exact way, although the wheels are uneven, and slower with a weak battery. The program has to"
    " do the measuring, with `robot.odom` and `robot.gyro`, and without tasks such as `drive_by`.",
    (_way("exact way", 1.35), _way("exact way, with a weak battery", 0.7)),  # no time fits both
    (_TASKS, _ROUND, _ON_ITS_WAY, ends_in("goal"), ends_still(1)),
    90,
    (_lost_its_way,),
    noise={"motor": 0.08, "odom": 0.02, "gyro": 0.01},
    seeds=3,
    starter=starter("exact way"),
    vary=(wears(speed=0.1, wheels=0.04),),
)


# -- keep your distance --------------------------------------------------------------------------------

_LEAST, _WANTED, _MOST = 0.2, 0.4, 0.6  # m
_STEP = 0.15  # m/s
_HALF = 0.1  # m, of the box


def _lane(name: str, speed: float, way: float) -> World:
    """Return a lane in which a box drives ahead of the robot, to and fro."""
    x, y = 0.6, 0.4
    middle = x + _RADIUS + _WANTED + _HALF
    box = BoxSolid((middle, y, 2 * _HALF, 0.4), name="box", patrol=Patrol(((way, 0.0),), speed))
    return World(name=name, size=(4, 0.8), solids=(box,), robots=(RobotSpec((x, y, 0)),))


_GAP, _SMOOTH = keeps_distance("box", _LEAST, _MOST), drives_smoothly(_STEP)


def _did_not_keep_its_distance(run: RunRecord) -> Iterator[str]:
    yield from ignores(
        run, "distance", "How fast the box is differs from world to world: let the sensor decide."
    )
    last = run.samples[-1]
    gap, speed = gap_to(run, "box", last), last.command[0]
    error = gap - _WANTED
    reason = _SMOOTH.missing(run)
    if len({sample.command[0] for sample in run.samples}) < 5:
        what = f"jerked: {reason}" if reason else f"lost its box: {_GAP.missing(run)}"
        yield (
            f"The robot {what}. A fixed speed is too fast for a small error and too slow for a large one. Let"
            " the speed follow the error: `robot.move(linear=gain * (robot.distance.data - 0.4))`."
        )
    elif reason:
        yield (
            f"The robot jerked: {reason}, when it was {abs(error) * 100:.0f} cm away from where it should be."
            " The gain is too large: it turns a small error into a high speed. Make it smaller."
        )
    elif _GAP.missing(run):
        told = f"After {last.time:.1f} s the box was {gap * 100:.0f} cm away, and the robot drove at"
        told += f" {speed:.2f} m/s"
        if not _follows_error(run):
            yield (
                f"{told}. Its speed does not depend on the present error alone,"
                " `robot.distance.data - 0.4`. What a program adds up or remembers is out of date, and makes"
                " the robot swing: let the present error count for more."
            )
        elif error * speed < 0:
            yield (
                f"{told}: the wrong way. The error is `robot.distance.data - 0.4`: too far is positive, and"
                " forward is too."
            )
        else:
            yield (
                f"{told} only: it lags behind, because the gain is too small. With a gain of 0.5, an error of"
                " 10 cm gives 0.05 m/s."
            )


def _follows_error(run: RunRecord) -> bool:
    """Return whether the speed was always the same multiple of the error that the sensor read."""
    last = run.samples[-1]
    off = last.distances[0] - _WANTED
    return all(
        abs(each.command[0] * off - last.command[0] * (each.distances[0] - _WANTED)) < 0.02 * abs(off)
        for each in run.samples[3:]
    )


KEEP_YOUR_DISTANCE = Challenge(
    "keep your distance",
    "A box drives ahead of the robot, to and fro. Stay 20 to 60 cm away from it for 40 seconds, and drive"
    " smoothly: from tick to tick the speed changes by 15 cm/s at most.",
    (_lane("slow box", 0.1, 1.0), _lane("box", 0.13, 1.5), _lane("fast box", 0.18, 2.2)),
    (_GAP, _SMOOTH, lasts(40)),
    45,
    (_did_not_keep_its_distance,),
    noise={"motor": 0.01, "distance": 0.003},
    seeds=2,
    starter=starter("keep your distance"),
    vary=(moves("robot", x=0.02, y=0.05), wears(speed=0.15)),
)

# -- stop before the wall ------------------------------------------------------------------------------

_NEAREST, _FURTHEST = 0.15, 0.35  # m
_FAILURE = 0.04  # chance that the sensor fails, in a tick


def _wall(name: str, metres: float) -> World:
    """Return a lane with a wall so many metres ahead of the robot's rim."""
    wall, y = 4.0, 0.5
    zone = BoxZone((wall - _RADIUS - (_NEAREST + _FURTHEST) / 2, y, _FURTHEST - _NEAREST, 1.0))
    return World(
        name=name,
        size=(wall, 1.0),
        robots=(RobotSpec((wall - _RADIUS - metres, y, 0)),),
        zones={"before the wall": zone},
    )


def _gap_ahead(run: RunRecord, sample: Sample) -> float:
    return run.world.size[0] - _RADIUS - sample.x


def _stopped_elsewhere(run: RunRecord) -> Iterator[str]:
    yield from ignores(
        run, "distance", "The wall is in a different place in each world: let the sensor decide."
    )
    first, last, touch = run.samples[0], run.samples[-1], run.touch()
    gap = _gap_ahead(run, last)
    lately = run.samples[-15:]
    seeing = [each for each in lately if each.distances[0] < _NEAREST and each.command[0] > 0]
    if touch and len(seeing) < 3 and any(math.isinf(sample.distances[0]) for sample in lately):
        yield (
            f"The robot touched the wall after {touch.time:.1f} s. Shortly before, its sensor had failed: it"
            " read `inf`, as if nothing were there. Drive slowly while it reads more than 1.9."
        )
    elif touch and _gap_ahead(run, first) < _NEAREST:
        yield (
            f"The robot began {_gap_ahead(run, first) * 100:.0f} cm before the wall, and touched it after"
            f" {touch.time:.1f} s. Try that start in your own test. It has to drive backward there."
        )
    elif touch:
        yield (
            f"The robot touched the {min(touch.touched)} after {touch.time:.1f} s, at"
            f" {abs(last.command[0]):.2f} m/s. Between two ticks it is blind: stop earlier, or drive more"
            " slowly."
        )
    elif run.stood < 1:
        yield (
            f"After {run.seconds:.0f} s the robot was {gap * 100:.0f} cm away from the wall and not at rest."
            " Leave a gap between the distance at which it drives backward and the one at which it stops."
        )
    elif math.isinf(last.distances[0]) and gap > 1.5:
        yield (
            f"The robot stood {gap:.1f} m away from the wall, where its sensor reads `inf`: the wall is out"
            " of its range. That is not the same as a sensor that fails for a second: drive on, slowly."
        )
    elif gap < _NEAREST:
        yield (
            f"The robot stood {gap * 100:.0f} cm before the wall, which is too near. Where it begins too"
            " near, or has come too near, it has to drive backward."
        )
    elif gap > _FURTHEST:
        yield (
            f"The robot stood {gap * 100:.0f} cm before the wall, which is too far away. Let it drive on"
            " until its sensor reads less than 0.3."
        )


STOP_BEFORE_THE_WALL = Challenge(
    "stop before the wall",
    "Stop 15 to 35 cm before the wall ahead, however far away it is, and touch nothing, although the distance"
    " sensor fails now and then: for a second, it reads `inf`.",
    (
        _wall("wall ahead", 1.2),
        _wall("near wall", 0.12),
        _wall("wall out of range", 2.8),
        _wall("another wall out of range", 2.4),
    ),
    (touches_nothing(), ends_in("before the wall"), ends_still(2)),
    60,
    (_stopped_elsewhere,),
    noise={"motor": 0.02, "distance": 0.005, "dropout": _FAILURE},
    seeds=6,
    starter=starter("stop before the wall"),
    vary=(moves("robot", x=0.02, y=0.1), wears(speed=0.15)),
)

"""What a robot of the world does by itself when it is asked to: drive a way, turn, drive to a point, say.

It has a controller in the steps of the world, as a real robot has: it knows where the wheels have driven
it, as the odometer says, and not where it is. It accelerates and brakes evenly, keeps to the straight line,
and gives up where it does not get on. The values are part of a robot's memory: a copy of that is a snapshot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

from lrp_jupyter.sim.world import Point, Pose
from lrp_jupyter.sim.world_inputs import DriveBy, DriveTo, Say, TurnBy

STEP = 0.01  # s
STEPS = 100  # per second
TURNING_SPEED = 1.0  # rad/s, towards a point
ENDED = "The robot was driven by `move`, or stopped, before that was done."

_ACCELERATION, _TURNING = 0.5, 5.0  # m/s², rad/s²
_BRAKING = 0.7  # share of them that is planned with; the rest corrects
_NEAR, _STRAIGHT = 0.0005, 0.0015  # m, rad: from there on it is done …
_SLOW, _SLOWLY = 0.05, 0.3  # m/s, rad/s: … if it is not faster
_THERE = 0.005  # m: how near to a point is there
_BESIDE = 0.1  # m: how far beside its way it may come
_KEEPING, _RETURNING, _ASLANT = 10.0, 3.0, 0.6  # 1/s, 1/m, rad: how it keeps to its line …
_STRAIGHTENING = 1.5  # rad/m: … and becomes parallel to it towards the goal
_STUCK = 0.05  # share of the speed: slower is not getting on
_SPARE, _SLACK = 3.0, 5.0  # times as long as it should take, and seconds more, until it gives up
_SAYING, _LETTER = 1.0, 0.08  # s, for a text, and for each letter of it

Command = tuple[float, float]
Errands = DriveBy | TurnBy | DriveTo


class Leg(NamedTuple):
    """A turn on the spot to a heading; with a `goal` the way there: `ahead` 1 forwards, -1 backwards."""

    heading: float
    goal: Point | None = None
    ahead: float = 1.0


@dataclass(frozen=True, slots=True)
class Errand:
    """A way or turn that a robot was asked for, in the coordinates of its odometer.

    `status`: ``active``, ``succeeded`` or ``aborted``, with the `reason` as a sentence.
    `origin`: where it counts from.
    `begun`, `until`: the step in which it began, and that in which it gives up.
    `mark`, `marked`: where it was when it had last got on, and in which step.
    """

    what: Errands
    origin: Pose
    leg: Leg
    begun: int
    until: int
    mark: Pose
    marked: int
    status: Literal["active", "succeeded", "aborted"] = "active"
    reason: str = ""

    @property
    def is_active(self) -> bool:
        """Whether the robot drives by it."""
        return self.status == "active"

    @property
    def speed(self) -> float:
        """Its speed now, in m/s or rad/s."""
        is_aiming = self.leg.goal is None and isinstance(self.what, DriveTo)
        return TURNING_SPEED if is_aiming else self.what.speed

    def ended(self, status: Literal["succeeded", "aborted"], reason: str = "") -> Errand:
        """Return it when it is over."""
        return replace(self, status=status, reason=reason)

    def left(self, pose: Pose) -> float:
        """Return what is left of it where the robot is, in metres or radians."""
        if isinstance(self.what, TurnBy):
            return abs(self.leg.heading - pose[2])
        goal = (self.what.x, self.what.y) if isinstance(self.what, DriveTo) else self.leg.goal
        return math.dist(pose[:2], goal or pose[:2])

    def rest(self, pose: Pose) -> tuple[float, float]:
        """Return how far to drive ahead and to turn until the leg is done."""
        turn = self.leg.heading - pose[2]
        return (0.0 if self.leg.goal is None else self.leg.ahead * _along(self.leg, pose)), turn


class Speech(NamedTuple):
    """A text that a robot says until a step."""

    what: Say
    until: int


def begun(what: Errands, pose: Pose, step: int, before: Errand | None = None) -> Errand:
    """Return an errand that begins where the robot is, or where that one `before` began which it corrects."""
    origin = pose
    if before is not None and before.is_active and not isinstance(what, DriveTo) and what.replaces:
        origin = before.origin if before.what.number == what.replaces else pose
    x, y, heading = origin
    match what:
        case TurnBy(radians, speed):
            leg, seconds = Leg(heading + radians), abs(radians) / speed
        case DriveBy(metres, speed):
            goal = x + metres * math.cos(heading), y + metres * math.sin(heading)
            leg, seconds = Leg(heading, goal, math.copysign(1.0, metres)), abs(metres) / speed
        case DriveTo(to_x, to_y, speed):
            leg = _towards((to_x, to_y), pose)
            seconds = math.dist((x, y), (to_x, to_y)) / speed + abs(leg.heading - heading) / TURNING_SPEED
    until = step + round(STEPS * (_SPARE * seconds + _SLACK))
    return Errand(what, origin, leg, step, until, pose, step)


def spoken(what: Say, step: int) -> Speech:
    """Return what a robot says from a step on; no text takes no time."""
    seconds = _SAYING + _LETTER * len(what.text) if what.text.strip() else 0.0
    return Speech(what, step + round(STEPS * seconds))


def guided(errand: Errand, pose: Pose, command: Command, step: int) -> tuple[Errand, Command]:
    """Return an errand and the speeds of a step, after those of the step before.

    `pose`: by the odometer.
    """
    leg = errand.leg  # in each step the speed of the one before still moves it
    if leg.goal is None:
        left = leg.heading - pose[2] - command[1] * STEP
        is_done = abs(left) <= _STRAIGHT and abs(command[1]) <= _SLOWLY
    else:
        left = _along(leg, pose) - leg.ahead * command[0] * STEP
        is_done = abs(left) <= _NEAR and abs(command[0]) <= _SLOW
    errand = after_leg(errand, pose, step) if is_done else judged(errand, pose, step)
    if not errand.is_active:
        return errand, (0.0, 0.0)
    if errand.leg is not leg:
        return errand, command
    if leg.goal is None:
        return errand, (
            _approached(command[0], 0.0, _ACCELERATION),
            _approached(command[1], _planned(left, errand.speed, _TURNING), _TURNING),
        )
    most = min(_ASLANT, _STRAIGHTENING * abs(left))
    slant = max(-most, min(most, _RETURNING * _beside(leg, pose)))
    turn = _KEEPING * (leg.heading - leg.ahead * slant - pose[2])
    linear = leg.ahead * _planned(left, errand.speed, _ACCELERATION)
    return errand, (
        _approached(command[0], linear, _ACCELERATION),
        _approached(command[1], max(-TURNING_SPEED, min(TURNING_SPEED, turn)), 4 * _TURNING),
    )


def after_leg(errand: Errand, pose: Pose, step: int) -> Errand:
    """Return an errand whose leg is done: it is over, or has another one."""
    leg, what = errand.leg, errand.what
    if isinstance(what, DriveTo):
        if math.dist(pose[:2], (what.x, what.y)) <= _THERE:
            return errand.ended("succeeded")
        leg = _towards((what.x, what.y), pose)
        if errand.leg.goal is None:  # it faces the point
            leg = leg._replace(goal=(what.x, what.y))
        return replace(errand, leg=leg, mark=pose, marked=step)
    return errand.ended("succeeded")


def judged(errand: Errand, pose: Pose, step: int) -> Errand:
    """Return an errand that goes on, or is given up."""
    if errand.leg.goal is None:
        way = abs(pose[2] - errand.mark[2])
    else:
        way = math.dist(pose[:2], errand.mark[:2])
        if isinstance(errand.what, DriveBy) and abs(_beside(errand.leg, pose)) > _BESIDE:
            return errand.ended("aborted", f"The robot came off its way, {_before(errand, pose)}.")
    if way > _STUCK * errand.speed:
        errand = replace(errand, mark=pose, marked=step)
    elif step - errand.marked > STEPS:
        return errand.ended("aborted", f"The robot has not moved for 1 s, {_before(errand, pose)}.")
    if step > errand.until:
        seconds = (step - errand.begun) / STEPS
        return errand.ended("aborted", f"Not there after {seconds:.0f} s, {_before(errand, pose)}.")
    return errand


def _before(errand: Errand, pose: Pose) -> str:
    left = errand.left(pose)
    is_turn = isinstance(errand.what, TurnBy)
    return f"{math.degrees(left):.0f}° before the goal" if is_turn else f"{left:.2f} m before the goal"


def _towards(point: Point, pose: Pose) -> Leg:
    """Return the turn that faces a point, the shorter way."""
    bearing = math.atan2(point[1] - pose[1], point[0] - pose[0])
    return Leg(pose[2] + math.remainder(bearing - pose[2], math.tau))


def _along(leg: Leg, pose: Pose) -> float:
    """Return how far a straight way still is; negative beyond its goal."""
    assert leg.goal is not None
    ahead = (leg.goal[0] - pose[0]) * math.cos(leg.heading) + (leg.goal[1] - pose[1]) * math.sin(leg.heading)
    return leg.ahead * ahead


def _beside(leg: Leg, pose: Pose) -> float:
    """Return how far to the left of its straight way the robot is."""
    assert leg.goal is not None
    return (leg.goal[0] - pose[0]) * math.sin(leg.heading) - (leg.goal[1] - pose[1]) * math.cos(leg.heading)


def _planned(left: float, most: float, rate: float) -> float:
    """Return the speed from which the robot can still brake within what is left, which may be behind it."""
    return math.copysign(min(most, math.sqrt(2 * _BRAKING * rate * abs(left)), abs(left) / STEP), left)


def _approached(speed: float, wanted: float, rate: float) -> float:
    return min(speed + rate * STEP, max(speed - rate * STEP, wanted))

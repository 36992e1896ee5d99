"""The record of a graded run: a sample for each tick, the faults, and what was counted on the way."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeGuard, TypeVar

from lrp_jupyter.bridges.guarding.safety import CommandRecord, Notice
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.bridges.wheel_tasks import ERRANDS
from lrp_jupyter.errors import Finding
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.program import Path, Program
from lrp_jupyter.live.running.frame import is_active
from lrp_jupyter.sim.world import World, middle_of

_STILL = 0.002  # m; a robot at rest may drift this far in one period
_MOVING = {"move", *ERRANDS.values()}
_T = TypeVar("_T")


class Sample(NamedTuple):
    """The robot at one tick.

    `time`: seconds since the run began.
    `x`, `y`, `heading`: metres, metres, radians.
    `lights`: 0 black … 255 white.
    `distances`: metres; ``inf`` where nothing is in reach.
    `touched`: names of the solids touched since the tick before; `edge` is the edge of the world.
    `command`: the commanded speeds: m/s, rad/s.
    `lamp`: whether the lamp is lit.
    `version`: of the program that ran: how many edits there were before that changed what it says.
    `task`: the name of the one for which the robot drives, such as ``"drive_by"``; may be empty.
    `movers`: the machines, as spawned, that have told it to move in this tick.
    `numbers`: the variables that are numbers or truth values, by name.
    """

    time: float
    x: float
    y: float
    heading: float
    lights: tuple[int, ...]
    distances: tuple[float, ...]
    bumper: bool
    touched: frozenset[str]
    solids: tuple[tuple[float, float, float], ...]
    active: tuple[Path, ...]
    command: tuple[float, float]
    lamp: bool
    version: int
    task: str = ""
    movers: frozenset[Path] = frozenset()
    numbers: tuple[tuple[str, float], ...] = ()

    def distance(self, other: Sample) -> float:
        """Return the distance between the robot in two samples, in metres."""
        return math.hypot(self.x - other.x, self.y - other.y)

    def moved(self, before: Sample) -> bool:
        """Return whether the robot has moved since another sample."""
        return before.distance(self) > _STILL or abs(before.heading - self.heading) > 0.02


class Turned(NamedTuple):
    """Angles to the left and to the right, added up: degrees, each 0 or more."""

    left: float
    right: float

    @property
    def total(self) -> float:
        """Both angles together."""
        return self.left + self.right


def angle_between(first: Sample, second: Sample) -> float:
    """Return the angle turned from one sample to the next, in radians; positive to the left."""
    return (second.heading - first.heading + math.pi) % (2 * math.pi) - math.pi


@dataclass
class RunRecord:
    """One run of a program in a world: what criteria and hints are functions of.

    `programs`: the programs that ran, one after the other: edits while it ran add to them, unless they only
        change comments or layout.
    `issues`: the open ones.
    `notices`: what the robot's safety has done, such as stopping a robot that got no commands.
    `commands`: number of commands that the robot got.
    `findings`: what the checks find in the program.
    `steps`: the times at which more of what is asked for was done than ever before.
    """

    world: World
    samples: list[Sample] = field(default_factory=list)
    programs: list[Program] = field(default_factory=list)
    issues: tuple[Issue, ...] = ()
    notices: tuple[Notice, ...] = ()
    commands: int = 0
    restarts: int = 0
    restart_reason: str = ""
    findings: tuple[Finding, ...] = ()
    steps: list[float] = field(default_factory=list)
    _program: Program | None = None
    _folds: dict[Any, tuple[int, Any]] = field(default_factory=dict)  # up to which sample, and the result

    def sample(self, bridge: SimBridge, interpreter: Interpreter) -> None:
        """Record the tick that has just ended; on the loop's thread."""
        robot = bridge.simulation.robot
        self._note(interpreter.program)
        x, y, heading = robot.pose
        self.samples.append(
            Sample(
                bridge.simulation.time_since_start,
                x,
                y,
                heading,
                robot.readings.lights,
                robot.readings.distances,
                bool(robot.readings.bumper),
                bridge.touched,
                tuple(thing.pose for thing in bridge.simulation.solids),
                interpreter.active,
                robot.command,
                robot.memory.lamp,
                len(self.programs) - 1,
                "" if robot.memory.errand is None else ERRANDS[type(robot.memory.errand.what)],
                frozenset(map(_mover, filter(_moves, bridge.safety.given_in(interpreter.tick)))),
                tuple(
                    (path[-1], value) for path, value in interpreter.variables.pairs() if _is_number(value)
                ),
            )
        )
        self.issues = tuple(issue for issue in interpreter.issues if not issue.resolved)
        self.notices, self.commands = bridge.safety.notices, bridge.safety.command_count

    def _note(self, program: Program) -> None:
        if program is not self._program:
            self._program = program
            if not self.programs or program != self.programs[-1]:
                self.programs.append(program)

    def cut(self, time: float) -> None:
        """Forget the samples from a time on: the run has gone back."""
        del self.samples[bisect_right(self.samples, time - 1e-9, key=lambda sample: sample.time) :]
        self._folds.clear()
        self.steps = [each for each in self.steps if each < time - 1e-9]
        if not self.samples:
            self.programs.clear()
            self._program = None

    def fold(self, step: Callable[[_T, Sample, Sample], _T], start: _T, key: object = None) -> _T:
        """Combine all pairs of consecutive samples, from left to right; the first one is paired with itself.

        What was combined is remembered, so that asking at every tick costs one step each time.

        `step`: takes the result so far, a sample, and the sample before it. Must not change the result in
            place, unless every call gets a new `start`.
        `key`: under which the result is remembered; by default the function `step` itself.
        """
        key = step if key is None else key
        done: int
        result: _T
        done, result = self._folds.get(key, (0, start))
        samples = self.samples
        for index in range(done, len(samples)):
            result = step(result, samples[index], samples[max(0, index - 1)])
        self._folds[key] = len(samples), result
        return result

    def first(self, condition: Callable[[Sample], object], key: object = None) -> Sample | None:
        """Return the first sample of which a condition holds; with a key, each is asked once."""
        if key is None:
            return next(filter(condition, self.samples), None)
        nothing: Sample | None = None
        return self.fold(lambda found, now, _: found or (now if condition(now) else None), nothing, key)

    def last(self, condition: Callable[[Sample], object]) -> Sample | None:
        """Return the last sample of which a condition holds."""
        return next(filter(condition, reversed(self.samples)), None)

    def entered(self, state: str | Path) -> Sample | None:
        """Return the first sample in which a state, given by name or path, was active."""
        return self.first(lambda now: is_active(state, now.active), ("entered", state))

    @property
    def seconds(self) -> float:
        """Length of the run, in seconds of its own time."""
        return self.samples[-1].time if self.samples else 0.0

    @property
    def driven(self) -> float:
        """Length of the path driven, in metres."""
        return self.fold(_driven, 0.0)

    @property
    def turned(self) -> Turned:
        """The angles that the robot has turned on command; what noise and collisions turn does not count."""
        return self.fold(_turned, Turned(0.0, 0.0))

    @property
    def still_since(self) -> float:
        """The time since which the robot has stood still without trying to move."""
        return self.fold(_still, 0.0)

    @property
    def stood(self) -> float:
        """How long the robot has stood still at the end without trying to move, in seconds."""
        return self.seconds - self.still_since

    def inside(self, zone: str) -> Iterator[Sample]:
        """Yield the samples at which the middle of the robot was in a zone."""
        region = self.world.zones[zone]
        return (sample for sample in self.samples if region.contains(sample.x, sample.y))

    def touches(self, solid: str) -> Iterator[Sample]:
        """Yield the samples at which a solid was touched."""
        return (sample for sample in self.samples if solid in sample.touched)

    def entry(self, zone: str) -> Sample | None:
        """Return the first sample at which the middle of the robot was in a zone."""
        return next(self.inside(zone), None)

    def touch(self, solid: str = "") -> Sample | None:
        """Return the first sample at which a solid was touched; without a name, anything."""
        return self.first(lambda now: solid in now.touched if solid else now.touched)


def _moves(command: CommandRecord) -> bool:
    return command.name in _MOVING and any(command.arguments.values())


def _mover(command: CommandRecord) -> Path:
    return command.origin.machine


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, (int, float))


def at_start(world: World) -> RunRecord:
    """Return the record of a run that has just begun."""
    robot = world.robots[0]
    solids = tuple((*middle_of(solid), solid.angle) for solid in world.solids)
    lights, distances = (255,) * len(robot.light), (math.inf,) * len(robot.distance)
    sample = Sample(0.0, *robot.pose, lights, distances, False, frozenset(), solids, (), (0.0, 0.0), False, 0)
    return RunRecord(world, [sample])


def _driven(so_far: float, now: Sample, before: Sample) -> float:
    return so_far + now.distance(before)


def _turned(so_far: Turned, now: Sample, before: Sample) -> Turned:
    degrees = math.degrees(angle_between(before, now)) if before.command[1] else 0.0
    return Turned(so_far.left + max(0.0, degrees), so_far.right + max(0.0, -degrees))


def _still(since: float, now: Sample, before: Sample) -> float:
    return now.time if now is before or any(now.command) or now.moved(before) else since

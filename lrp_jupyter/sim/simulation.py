"""A running world: steps of physics, inputs with the step at which they are applied, and exact rewinding.

A run is a function of the world, its seed and the inputs with their steps. Everything from outside,
the reading of the sensors included, is an input and is recorded. A pymunk space can be neither
copied nor rebuilt exactly once things touch (contacts remember impulses), so every ten seconds, and
at every reset, the *live* run itself continues in a new space built from a checkpoint: replaying
the inputs from there gives the same run, bit for bit.

Owned by one thread. Only :meth:`Simulation.submit` may be called from others.
"""

from __future__ import annotations

import math
import os
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from random import Random

from lrp_jupyter.sim.errands import ENDED, begun, spoken
from lrp_jupyter.sim.floor import LiveFloor, Paint
from lrp_jupyter.sim.input_log import Checkpoint, InputLog, WorldMoment, packed, unpack
from lrp_jupyter.sim.rest import Rest
from lrp_jupyter.sim.sensors import Readings, light_spots
from lrp_jupyter.sim.sim_robot import STEP, Motion, SimRobot, SimSolid, StepCount, clear, edge, fresh_space
from lrp_jupyter.sim.world import Point, Pose, Solid, World, middle_of, put_at
from lrp_jupyter.sim.world_edits import Become, Draw, Edition, WorldEdit, WorldHistory
from lrp_jupyter.sim.world_inputs import (
    ByProgram,
    Cancel,
    Drive,
    DriveBy,
    DriveTo,
    Input,
    Lamp,
    Latch,
    Pen,
    PlaceRobot,
    PlaceSolid,
    ResetWorld,
    Say,
    TurnBy,
    check_input,
)
from lrp_jupyter.sim.worlds import load

__all__ = ["STEP", "Simulation", "WorldMoment"]

STEPS_PER_SECOND = 100
CHECKPOINT_STEPS = 1000
MOST_MARKS = 20_000  # pieces of trails; later ones are not drawn
PEN_PIECE = 0.005  # m
TRACK_STEPS = 10
TRACK_POINTS = 3_000


class Simulation:
    """A running world.

    Parameters
    ----------
    world : str, path, mapping or World
        An argument of :func:`~lrp_jupyter.sim.worlds.load`.
    seed : int, optional
        Of all noise; the world's own by default.
    history : WorldHistory, optional
        Where edits are recorded; an empty one by default.
    original : World, optional
        The description that was loaded, if `world` is an edit of it.

    Attributes
    ----------
    world : World
        The description that a reset returns to: the original with all edits since.
    original : World
        The description that was loaded.
    robots : tuple of SimRobot
    solids : tuple of SimSolid
    floor : LiveFloor
    history : WorldHistory
        The earlier descriptions.
    revision : int
        Increases when a solid is moved by hand, and with every edit, reset and rewinding: a view has to draw
        the world again. Motion and trails do not change it.
    """

    def __init__(
        self,
        world: str | os.PathLike[str] | Mapping[str, object] | World = "line",
        seed: int | None = None,
        history: WorldHistory | None = None,
        original: World | None = None,
    ) -> None:
        self.world = load(world) if seed is None else replace(load(world), seed=seed)
        self.original = self.world if original is None else original
        self.history = WorldHistory() if history is None else history
        self.robots = tuple(SimRobot(spec, index) for index, spec in enumerate(self.world.robots))
        self._place_solids()
        self.floor = LiveFloor(self.world.floor)
        self.revision = 0
        self.track: deque[tuple[int, int, float, float]] = deque(maxlen=TRACK_POINTS)
        self._clock = StepCount()
        self._random = Random(self.world.seed)
        self._queue: deque[Input] = deque()
        self._cancels: deque[Cancel] = deque()  # they come before what the program does next
        self.drained: Callable[[Input], object] | None = None  # called with each queued input when applied
        self._inputs = 0
        self._base = 0
        self._is_fresh = True  # whether nothing has moved, placed or switched anything since the last reset
        self._log = InputLog()
        self._space = fresh_space(self._clock)
        self.is_closed = False
        self._start()
        self._checkpoint()

    def close(self) -> None:
        """End the physics; what was last known of the world can still be read. A second call does nothing."""
        self.is_closed = True
        clear(self._space)

    @property
    def edition(self) -> Edition:
        """The description, and the one that was loaded."""
        return Edition(self.world, self.original)

    # -- time ---------------------------------------------------------------------------------

    @property
    def steps(self) -> int:
        """Number of steps made."""
        return self._clock.steps

    @property
    def time(self) -> float:
        """Seconds since the beginning, exactly the number of steps by a hundred."""
        return self._clock.steps / STEPS_PER_SECOND

    @property
    def time_since_start(self) -> float:
        """Seconds of the world since its last reset."""
        return (self.steps - self._base) * STEP

    @property
    def is_at_start(self) -> bool:
        """Whether the world is as after a reset: a new one of its description would go on in the same way."""
        return self._is_fresh and self.steps == self._base

    @property
    def robot(self) -> SimRobot:
        """The robot that programs drive: the first."""
        return self.robots[0]

    def step(self, count: int = 1) -> None:
        """Make `count` steps of 10 ms."""
        self._drain()
        self._advance_to(self.steps + count)

    def _advance_to(self, step: int) -> None:
        clock = self._clock
        while (now := clock.steps) < step:
            checkpoint = now + CHECKPOINT_STEPS - (now - self._base) % CHECKPOINT_STEPS
            self._advance(min(step, checkpoint, now + TRACK_STEPS - now % TRACK_STEPS) - now)
            if clock.steps % TRACK_STEPS == 0:
                for robot in self.robots:
                    self.track.append((clock.steps, robot.index, *robot.body.position))
            if clock.steps == checkpoint:
                self._checkpoint()

    def _advance(self, count: int) -> None:
        """Make `count` steps between which nothing but physics happens."""
        clock, make_step, writing = self._clock, self._space.step, self._writing
        guided = [robot for robot in self.robots if robot.is_on_errand]
        halted = not guided and all(robot.body.target == (0.0, 0.0) for robot in self.robots)
        if not halted:
            self._rest.disturb()
        for left in range(count, 0, -1):
            if self._rest.is_certain:
                clock.steps += left
                self._rest.go_on(clock.steps)
                return
            for thing in self._moving:
                thing.go(clock.steps + 1 - self._base)
            for robot in guided:
                if robot.is_on_errand:
                    robot.guide(clock.steps + 1)
            make_step(STEP)
            clock.steps += 1
            for robot in writing:
                self._write(robot)
            if halted:
                self._rest.observe(clock.steps)

    # -- inputs -------------------------------------------------------------------------------

    def latch(self) -> Readings:
        """Read the sensors of all robots, once per tick; return the readings of the first."""
        self._drain()
        self._apply_now(Latch())
        return self.robot.memory.readings

    def drive(self, linear: float = 0.0, angular: float = 0.0, robot: int = 0) -> tuple[float, float]:
        """Command the speeds of a robot; return them clamped to its limits.

        Raises
        ------
        ValueError
            A speed is not finite, or there is no such robot.
        """
        self.apply(Drive(linear, angular, robot))
        return self.robots[robot].memory.command

    def pen(self, down: bool = True, grey: float = 200, width: float = 0.006, robot: int = 0) -> None:
        """Lower or lift a robot's pen. Its ink darkens the floor, and light sensors see it."""
        self.apply(Pen(down, grey, width, robot))

    def lamp(self, on: bool = True, robot: int = 0) -> None:
        """Switch a robot's lamp on or off. Sensors do not see it."""
        self.apply(Lamp(on, robot))

    def place(self, pose: Pose, robot: int = 0) -> None:
        """Move a robot by hand; it is at rest there."""
        self.apply(PlaceRobot(pose, robot))

    def place_solid(self, solid: int, pose: Pose) -> None:
        """Move a solid by hand; it is at rest there."""
        self.apply(PlaceSolid(pose, solid))

    def draw(self, path: tuple[Point, ...], width: float = 0.03, grey: float | None = 0) -> None:
        """Paint a line on the floor; ``grey=None`` erases."""
        self.apply(Draw(path, width, grey))

    def reset(self, drawings: bool = False) -> None:
        """Reset the world to its start, sensors and noise included; time continues.

        Trails are erased; what was drawn and placed by hand stays unless `drawings`.
        """
        if drawings:
            self.apply(Become(self.original))
        self.apply(ResetWorld())

    def apply(self, what: Input) -> None:
        """Apply an input now; an edit can be undone by the :attr:`history`.

        Raises
        ------
        ValueError
            It names no robot or solid of this world, or a number is not finite.
        """
        if not isinstance(what, ByProgram):
            self._drain()
        self._drain_cancels()
        self._apply_new(check_input(what, self.world))

    def replay(self, what: Input) -> None:
        """Apply an input now, without an entry in the :attr:`history`."""
        self._drain()
        self._apply_now(what)

    def submit(self, what: Input) -> None:
        """Queue an input, which is applied before the next step or latch. Any thread.

        A `Cancel` is applied before the next command, too: what it ends does not go on into that.

        Raises
        ------
        ValueError
            As :meth:`apply`; raised at once.
        """
        checked = check_input(what, self.world)
        if isinstance(checked, Cancel):
            self._cancels.append(checked)
        else:
            self._queue.append(checked)

    def _drain_cancels(self) -> None:
        while self._cancels:
            self._apply_now(self._cancels.popleft())

    def _drain(self) -> None:
        self._drain_cancels()
        while self._queue:
            with suppress(ValueError):  # an edit has removed what it is about since it was queued
                what = check_input(self._queue.popleft(), self.world)
                self._apply_new(what)
                if self.drained is not None:
                    self.drained(what)

    def _apply_new(self, what: Input) -> None:
        if isinstance(what, WorldEdit):
            if what.edited(self.world) == self.world:
                return
            self.history.note(self.edition)
        self._apply_now(what)

    def _apply_now(self, what: Input) -> None:
        """Record and apply an input; a replay applies recorded inputs here, too."""
        self._log.record(self.steps, what)
        self._inputs += 1
        is_halt = isinstance(what, Cancel) or (isinstance(what, Drive) and not (what.linear or what.angular))
        if not (is_halt or isinstance(what, (Latch, WorldEdit, ResetWorld))):
            self._is_fresh = False
        match what:
            case Latch():
                self._latch()
            case Drive(linear, angular, index):
                self._drive(self.robots[index], linear, angular)
            case DriveBy() | TurnBy() | DriveTo():
                robot = self.robots[what.robot]
                robot.memory.errand = begun(what, robot.reckoned, self.steps, robot.memory.errand)
            case Cancel():
                self._cancel(what)
            case Say():
                self.robots[what.robot].memory.speech = spoken(what, self.steps)
            case Pen():
                self._lower(what)
            case Lamp(on, index):
                self.robots[index].memory.lamp = on
            case PlaceRobot(pose, index):
                robot = self.robots[index]
                robot.memory.odometer = robot.memory.odometer.lifted(robot.pose, pose)
                robot.memory.pen_at = (pose[0], pose[1])
                robot.body.move((*pose, 0.0, 0.0, 0.0))
                self._space.reindex_shapes_for_body(robot.body)
                self._rest.disturb()
            case PlaceSolid(pose, index):
                body = self.solids[index].body
                body.move((*pose, 0.0, 0.0, 0.0))
                self.solids[index].lead(self.steps - self._base)
                self._space.reindex_shapes_for_body(body)
                self._rest.disturb()
                self.revision += 1
            case WorldEdit():
                self._edit(what.edited(self.world))
            case ResetWorld():
                self._reset()
        if self._log.wants_checkpoint:
            self._checkpoint(between_inputs=True)

    def _latch(self) -> None:
        for robot in self.robots:
            memory = robot.memory
            motor = robot.spec.noise.motor
            if motor:
                left, right = robot.spec.wheels
                memory.slip = (
                    left * (1.0 + self._random.gauss(0.0, motor)),
                    right * (1.0 + self._random.gauss(0.0, motor)),
                )
                robot.steer()
            bumped = memory.pressed_at > memory.latched_at or memory.pressed_at == self.steps
            robot.sense(self.floor, self._space, self._random, bumped, memory.take_bumps(self.steps))
            if memory.latched_at < self.steps:
                memory.touched, memory.touching = memory.touching, frozenset()
            memory.latched_at = self.steps

    def _drive(self, robot: SimRobot, linear: float = 0.0, angular: float = 0.0) -> None:
        """Command the speeds of a robot, which ends the errand that it is on."""
        robot.memory.command = (linear, angular)
        robot.steer()
        if (errand := robot.memory.errand) is not None and errand.is_active:
            robot.memory.errand = errand.ended("aborted", ENDED)

    def _cancel(self, cancel: Cancel) -> None:
        robot = self.robots[cancel.robot]
        errand, speech = robot.memory.errand, robot.memory.speech
        if errand is not None and errand.is_active and errand.what.number == cancel.number:
            self._drive(robot)
        if speech is not None and speech.what.number == cancel.number:
            robot.memory.speech = None

    def _lower(self, pen: Pen) -> None:
        robot = self.robots[pen.robot]
        robot.memory.pen = Paint(pen.width / 2, pen.grey, True) if pen.down else None
        robot.memory.pen_at = robot.pose[:2]
        self._writing = self._pens_down()

    def _pens_down(self) -> list[SimRobot]:
        return [robot for robot in self.robots if robot.memory.pen is not None]

    def _write(self, robot: SimRobot) -> None:
        memory = robot.memory
        x, y = robot.body.position
        if memory.pen is None or math.hypot(x - memory.pen_at[0], y - memory.pen_at[1]) < PEN_PIECE:
            return
        if len(self.floor.marks) < MOST_MARKS:
            self.floor.ink(memory.pen, memory.pen_at, (x, y), self.steps)
        memory.pen_at = (x, y)

    # -- queries -------------------------------------------------------------------------------

    def said(self, robot: int = 0) -> str:
        """Return what a robot says now; nothing if it is silent."""
        speech = self.robots[robot].memory.speech
        return speech.what.text if speech is not None and self.steps < speech.until else ""

    def zones(self, robot: int = 0) -> frozenset[str]:
        """Return the names of the zones in which the middle of a robot is."""
        x, y, _ = self.robots[robot].pose
        return frozenset(name for name, zone in self.world.zones.items() if zone.contains(x, y))

    def greys(self, robot: int = 0) -> tuple[float, ...]:
        """Return the present values of a robot's light sensors without noise."""
        mover = self.robots[robot]
        return tuple(self.floor.light(*spot) for spot in light_spots(mover.pose, mover.spec.light))

    def continued(self, solid: Solid, index: int) -> Solid:
        """Return a solid that is given where it is to be now, with the patrol of the one that it replaces."""
        thing = self.solids[index] if 0 <= index < len(self.solids) else None
        if thing is None or thing.spec.patrol is None or solid.push is not None:
            return solid
        (x, y), (dx, dy) = middle_of(solid), thing.displacement(self.steps - self._base)
        return put_at(replace(solid, patrol=thing.spec.patrol), (x - dx, y - dy))

    def _edit(self, world: World) -> None:
        """Continue with another description: solids that are in both stay where they are."""
        former, self.world = self.world, world
        self.revision += 1
        for robot, spec in zip(self.robots, world.robots, strict=True):
            robot.spec = spec
        if world.floor != former.floor:
            self.floor.paint(world.floor)
        if world.solids == former.solids:
            return
        there: dict[Solid, deque[Motion]] = {}
        for thing in self.solids:
            there.setdefault(thing.spec, deque()).append(thing.body.motion())
        self._place_solids()
        motions = [
            there[thing.spec].popleft()
            if there.get(thing.spec)
            else thing.start_motion(self.steps - self._base)
            for thing in self.solids
        ]
        self._checkpoint(between_inputs=True, solids=motions)

    def _place_solids(self) -> None:
        self.solids = tuple(SimSolid(spec, index) for index, spec in enumerate(self.world.solids))

    def _reset(self) -> None:
        self.floor = LiveFloor(self.world.floor)
        self.track.clear()
        self.revision += 1
        self._base = self.steps
        self._random.seed(self.world.seed)
        self._start()
        self._latch()  # as when a bridge is opened: the noise goes on as in a new world
        self._checkpoint(between_inputs=True)

    # -- rewinding ----------------------------------------------------------------------------

    @property
    def moment(self) -> WorldMoment:
        """The present moment of the run, for :meth:`rewind`."""
        return WorldMoment(self.steps, self._inputs)

    @property
    def earliest(self) -> int:
        """The first step that can still be rewound to."""
        return self._log.earliest

    def rewind(self, to: WorldMoment | int) -> None:
        """Rewind, exactly: the same inputs give the same continuation.

        Parameters
        ----------
        to : WorldMoment or int
            An earlier :attr:`moment`; or a step: then the inputs applied at this step are undone.

        Raises
        ------
        ValueError
            The moment is in the future or too long ago (see :attr:`earliest`).
        """
        step = to if isinstance(to, int) else to.step
        most = None if isinstance(to, int) else to.inputs
        if not self.earliest <= step <= self.steps or (most is not None and most > self._inputs):
            raise ValueError(
                f"Cannot rewind to step {step}: only steps {self.earliest} to {self.steps} can be reached."
            )
        checkpoint, inputs = self._log.cut(step, most)
        self._queue.clear()
        self._cancels.clear()
        self._restore(checkpoint, inputs, step)
        self.revision += 1

    def forget(self, before: WorldMoment) -> None:
        """Drop what only :meth:`rewind` and :meth:`fork` to earlier moments need."""
        self._log.begin(*before)

    def fork(self, to: WorldMoment) -> Simulation:
        """Return an independent simulation at a moment of this run, also of one that has ended.

        Raises
        ------
        ValueError
            The moment is too long ago (see :attr:`earliest`).
        """
        checkpoint, inputs = self._log.find(*to)
        marks = checkpoint.marks[: checkpoint.mark_count]
        fork = Simulation(checkpoint.world, history=WorldHistory(), original=self.original)
        fork._log = InputLog()
        fork._log.add(replace(checkpoint, marks=marks, inputs=[]))
        fork._restore(fork._log.last, inputs, to.step)
        return fork

    def repeated(self, first: WorldMoment, last: WorldMoment, every: int) -> Iterator[Simulation]:
        """Return an independent simulation again and again while it repeats a part of this run.

        Parameters
        ----------
        first, last : WorldMoment
        every : int
            Steps between two times; what is put elsewhere in between is shown before and after.

        Raises
        ------
        ValueError
            The first moment is too long ago (see :attr:`earliest`).
        """
        return self.fork(first)._through(self._log.between(first, last), last.step, every)

    def _through(self, inputs: list[tuple[int, Input]], end: int, every: int) -> Iterator[Simulation]:
        is_due = True
        for at, what in [*inputs, (end, None)]:
            while self.steps < at:
                if is_due:
                    yield self  # with what was done at this step
                self._advance_to(min(at, self.steps - self.steps % every + every))
                is_due = self.steps % every == 0
            if what is not None:
                is_moved = not isinstance(what, (Latch, ByProgram)) or isinstance(what, Lamp)
                if is_moved:
                    yield self
                self._apply_now(what)
                is_due = is_due or is_moved
        yield self
        self.close()

    def _checkpoint(self, between_inputs: bool = False, solids: list[Motion] | None = None) -> None:
        """Record the state, with solids moved to new places if given, and continue from the record."""
        checkpoint = Checkpoint(
            moment=self.moment,
            world=self.world,
            base=self._base,
            robots=[(robot.body.motion(), replace(robot.memory)) for robot in self.robots],
            solids=[thing.body.motion() for thing in self.solids] if solids is None else solids,
            random=packed(self._random),
            marks=self.floor.marks,
            mark_count=len(self.floor.marks),
            between_inputs=between_inputs,
        )
        self._log.add(checkpoint)
        self._build([motion for motion, _ in checkpoint.robots], checkpoint.solids)

    def _restore(self, checkpoint: Checkpoint, inputs: list[tuple[int, Input]], step: int) -> None:
        """Return to a checkpoint, and repeat the run from there to a step, with its inputs."""
        self._clock.steps, self._inputs = checkpoint.moment
        self._base = checkpoint.base
        self._is_fresh = False  # or it is not known
        self.world = checkpoint.world
        self._place_solids()
        del checkpoint.marks[checkpoint.mark_count :]
        self.floor = LiveFloor(self.world.floor, checkpoint.marks)
        unpack(self._random, checkpoint.random)
        for robot, spec, (_, memory) in zip(self.robots, self.world.robots, checkpoint.robots, strict=True):
            robot.spec, robot.memory = spec, replace(memory)
        while self.track and self.track[-1][0] > self.steps:
            self.track.pop()
        self._build([motion for motion, _ in checkpoint.robots], checkpoint.solids)
        for at, what in inputs:
            self._advance_to(at)
            self._apply_now(what)
        self._advance_to(step)

    def _start(self) -> None:
        self._is_fresh = True
        for robot in self.robots:
            robot.start()
        robots = [robot.start_motion for robot in self.robots]
        self._build(robots, [thing.start_motion(0) for thing in self.solids])

    def _build(self, robots: list[Motion], solids: list[Motion]) -> None:
        """Continue in a new space."""
        clear(self._space)
        self._space = space = fresh_space(self._clock)
        if not self.world.open:
            edge(space, self.world.size)
        for thing, motion in zip(self.solids, solids, strict=True):
            thing.embody(space, motion, self.steps - self._base)
        self._moving = [thing for thing in self.solids if thing.spec.patrol is not None]
        self._writing = self._pens_down()
        for robot, motion in zip(self.robots, robots, strict=True):
            robot.embody(space, motion)
        self._rest = Rest(self.robots, self.solids)

"""The simulated robot as a bridge: the default. Further robots of a world are its parts: ``robot.NAME``.

Owner: the interpreter's thread, like that of every bridge. What a person does to the world from
another thread (`reset_world`, `place_robot`, `place_solid`, `draw`, `erase`) is queued and applied
between two ticks; `stop` only sets a flag. Commands are applied at once, and the world moves in `advance`
only, by whole steps of 10 ms: program and world live in one time.

Paper: §3.2, §4 (the world that the line follower drives in).
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import partial
from types import NoneType
from typing import Any, NamedTuple, cast

from lrp_jupyter.arguments import check_number, check_type
from lrp_jupyter.bridges.bridge import Bridge, Panel, SimulatedWorld
from lrp_jupyter.bridges.guarding.safety import Motion
from lrp_jupyter.bridges.interventions import WorldLoaded
from lrp_jupyter.bridges.member_tree import RobotVariable, companion_path
from lrp_jupyter.bridges.message import Message, Twist
from lrp_jupyter.bridges.scans import RayScan
from lrp_jupyter.bridges.tasks import Task, TaskState
from lrp_jupyter.bridges.wheel_tasks import ERRANDS, add_errands
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.sim.animation import EVERY, animated
from lrp_jupyter.sim.errands import Speech
from lrp_jupyter.sim.sensors import Readings, light_directions, ray_directions
from lrp_jupyter.sim.sim_robot import SimRobot
from lrp_jupyter.sim.simulation import STEP, Simulation, WorldMoment
from lrp_jupyter.sim.world import Noise, Solid, World, WorldError, can_move
from lrp_jupyter.sim.world_edits import Become, Draw, Edition, PutSolid, WorldEdit, WorldHistory, is_edit
from lrp_jupyter.sim.world_inputs import ByItself, Cancel, Input, PlaceRobot, PlaceSolid, ResetWorld
from lrp_jupyter.sim.worlds import load

__all__ = ["RobotPicture", "SimBridge", "SimPicture"]

WorldSource = str | os.PathLike[str] | Mapping[str, object] | World


@dataclass(frozen=True, slots=True)
class RobotPicture:
    """The visible state of a robot, with its last sensor readings.

    `pose`: x, y (metres), heading (radians).
    `command`: the speeds commanded, in m/s and rad/s.
    `lights`: 0 black ... 255 white.
    `bumper`: 1 pressed, 0 free.
    `distances`: in metres; ``inf`` where nothing is in reach.
    `pen`: whether it leaves a trail.
    `says`: the text that it says.
    """

    pose: tuple[float, float, float]
    command: tuple[float, float]
    lights: tuple[int, ...]
    bumper: int
    distances: tuple[float, ...]
    pen: bool
    lamp: bool = False
    says: str = ""


@dataclass(frozen=True, slots=True)
class SimPicture:
    """The world at one moment.

    `time`: in seconds of the world.
    `solids`: x, y and angle of each.
    `patrols`: the points of the patrol of every solid; empty for those that do not move by themselves.
    `revision`: increases when the world changes other than by motion and trails.
    `marks`: number of pieces of trails on the floor.
    """

    world: World
    time: float
    robots: tuple[RobotPicture, ...]
    solids: tuple[tuple[float, float, float], ...]
    patrols: tuple[tuple[tuple[float, float], ...], ...]
    revision: int
    marks: int


class _SimMoment(NamedTuple):
    simulation: Simulation
    world: WorldMoment
    motion: Motion  # the command watchdog is part of the run too
    stopping: bool


class SimBridge(Bridge, SimulatedWorld):
    """A robot in a simulated world.

    Parameters
    ----------
    world : str, path, mapping or World
        A bundled world's name, a JSON file, or a world.
    seed : int, optional
        Of all noise. Default: the world's own.
    noise : Noise or mapping, optional
        Of all robots: ``{"motor": 0.2, "light": 20}``. Default: the world's own.

    Raises
    ------
    BridgeError
        There is no such world, or it has a mistake; the message names the place.
    """

    name = "sim"
    hardware = False
    time_step = STEP
    complete = True
    stop_timeout = None

    def __init__(
        self,
        world: WorldSource = "line",
        seed: int | None = None,
        noise: Noise | Mapping[str, float] | None = None,
    ) -> None:
        try:
            self._noise = _checked_noise(noise)
            check_type("seed", seed, (int, NoneType), "a whole number")
        except (TypeError, ValueError) as error:
            raise BridgeError(str(error)) from None
        self._stopping = False
        self._sensors: dict[str, tuple[int, Callable[[Readings], object]]] = {}
        self._history = WorldHistory()
        self.simulation = self._simulate(world, seed)

    def _simulate(self, world: WorldSource, seed: int | None) -> Simulation:
        try:
            description = load(world)
            if self._noise is not None:
                robots = tuple(replace(robot, noise=self._noise) for robot in description.robots)
                description = replace(description, robots=robots)
            simulation = Simulation(description, seed, self._history)
        except (WorldError, TypeError) as error:
            raise BridgeError(str(error)) from error
        simulation.drained = self._note
        return simulation

    def _note(self, what: object) -> None:
        self.outside(what, True)

    # -- the robot --------------------------------------------------------------------------------

    def add_members(self) -> None:
        """Register the members of this world's robots: of the first, and of the others below their names."""
        self._sensors = {}
        for index, name in enumerate(self.world.robot_names):
            self._add_robot(index, f"{name}." if index else "")

    def _add_robot(self, index: int, prefix: str) -> None:
        spec = self.simulation.robots[index].spec
        add = partial(self._add, index, prefix)
        method = partial(self.add_method, mover=prefix)
        if spec.light:
            doc = "brightness of the floor: 0 black ... 255 white"
            add("light.data", partial(_nth_light, 0), doc, kind=int, limits=_GREYS)
        if len(spec.light) > 1:
            doc = "brightness below each sensor: " + ", ".join(map(_place, spec.light))
            add("light.all", lambda seen: seen.lights, doc, kind=tuple)
            for side, number in light_directions(spec.light).items():
                doc = f"brightness of the floor at {_place(spec.light[number])}: 0 black ... 255 white"
                add(f"{side}.light", partial(_nth_light, number), doc, kind=int, limits=_GREYS)
        if spec.bumper:
            doc = "True pressed, False free"
            add("bumper.data", lambda seen: bool(seen.bumper), doc, kind=bool, new=lambda seen: seen.bumps)
        if spec.distance:
            doc = f"to the next solid {_bearing(spec.distance[0][0])}; inf: nothing in reach"
            add("distance.data", partial(_nth_distance, 0), doc, "m", float, (0.0, spec.distance[0][1]))
        if len(spec.distance) > 1:
            bearings = ", ".join(_bearing(angle) for angle, _ in spec.distance)
            doc = f"to the next solid along each ray: {bearings}"
            add("distance.all", lambda seen: seen.distances, doc, "m", tuple)
        for side, number in ray_directions(spec.distance).items():
            doc = f"to the next solid {_bearing(spec.distance[number][0])}; inf: nothing in reach"
            limits = 0.0, spec.distance[number][1]
            add(f"{side}.distance", partial(_nth_distance, number), doc, "m", float, limits)
        if spec.distance:
            scans = partial(_scans, tuple(angle for angle, _ in spec.distance))
            doc = "what all rays see; `scan.nearest(-30, 30)`: the nearest from 30° right to 30° left, in m"
            add("scan", lambda seen: next(iter(scans(seen)), None), doc, kind=RayScan, new=scans)
        add("gyro.data", lambda seen: seen.gyro, "angle turned since the start", "rad", float)
        for axis, (name, unit, doc) in enumerate(_ODOM):
            add(f"odom.{name}", partial(_odom, axis), doc, unit, float)
        method(
            f"{prefix}move",
            partial(self._move, index),
            "drive: linear in m/s, angular in rad/s; what is not given is 0",
            message=Twist,
            limits={"linear": spec.limits[0], "angular": spec.limits[1]},
        )
        method(f"{prefix}stop", partial(self._stand, index, prefix), "stand still", velocity=True)
        doc = "lower the pen (True) or lift it (False): it leaves a trail"
        self.add_method(f"{prefix}pen", lambda down=True: self.simulation.pen(bool(down), robot=index), doc)
        doc = "switch the lamp on (True) or off (False)"
        self.add_method(f"{prefix}lamp", lambda on=True: self.simulation.lamp(bool(on), robot=index), doc)
        cancel, farthest = partial(self._cancel, index), max(10.0, 2 * math.hypot(*self.world.size))
        add_errands(self, self._begin, cancel, spec.limits, index, prefix, farthest=farthest)

    def open_interface(self) -> Panel | None:
        """Read the sensors, so that there is something to see before the first tick."""
        if self.simulation.is_closed:
            self.simulation = self._edition(self.simulation.edition)
        self.simulation.latch()
        return None

    def close_interface(self) -> None:
        """End the physics; a bridge that is opened again starts its world again."""
        self.simulation.close()

    def _add(
        self,
        index: int,
        prefix: str,
        name: str,
        read: Callable[[Readings], object],
        doc: str,
        unit: str = "",
        kind: type = object,
        limits: tuple[float, float] | None = None,
        new: Callable[[Readings], tuple[object, ...]] | None = None,
    ) -> None:
        """Add a reading; a function of what a robot's sensors read gives it, now or for an earlier tick.

        `limits`: its least and greatest value, besides ``inf``.
        `new`: returns what came since the last tick, where that is more than the reading.
        """

        def now(of: Callable[[Readings], Any]) -> Callable[[], Any]:
            return lambda: of(self.simulation.robots[index].readings)

        path = prefix + name
        self._sensors[path] = index, read
        if new is not None:
            self._sensors[companion_path(path, "new")] = index, new
        reading = RobotVariable(self, path, now(read), doc, unit, kind, None)
        reading.limits = limits
        self._add_reading(reading, None if new is None else now(new))

    def sensed(self) -> object:
        """Return what all sensors of all robots read in this tick; then the states of their tasks, if any."""
        read = [robot.memory.readings for robot in self.simulation.robots]
        states = self.requested.states
        return (*read, states) if states else tuple(read)

    def readings_of(self, sensed: object) -> Mapping[str, object]:
        """See :class:`SimulatedWorld`; here all readings are known."""
        if not isinstance(sensed, tuple):
            return {}
        states = sensed[-1] if isinstance(sensed[-1], dict) else {}
        robots = sensed[:-1] if states else sensed
        sensors = self._sensors.copy()  # another thread may ask while a world is loaded
        known = {name: each for name, each in sensors.items() if each[0] < len(robots)}
        values = {name: read(robots[index]) for name, (index, read) in known.items()}
        return {name: value for name, value in values.items() if value is not None} | states

    def _move(self, index: int, message: Message) -> None:
        linear, angular = message.linear, message.angular
        if linear.y or linear.z or angular.x or angular.y:
            raise BridgeError("This robot has two wheels. Set only `linear.x` and `angular.z`.")
        self._stop_if_asked()  # before this command, and not after it
        self.simulation.drive(linear.x, angular.z, index)

    def _stand(self, index: int, prefix: str) -> None:
        self.requested.stop([f"{prefix}{name}" for name in ERRANDS.values()])
        self.simulation.drive(robot=index)

    def _begin(self, _task: Task, what: ByItself) -> None:
        self._stop_if_asked()  # before it begins, and not after that
        self.simulation.apply(what)

    def _cancel(self, robot: int, task: Task) -> None:
        with suppress(ValueError):  # another world has fewer robots
            self.simulation.submit(Cancel(task.number, robot))  # on any thread

    def _report(self) -> None:
        """Report what has become of the tasks of the robots."""
        robots = dict(zip(["", *self.world.robot_names[1:]], self.simulation.robots, strict=True))
        for task in self.requested.under_way:
            owner, _, name = task.name.rpartition(".")
            self.requested.tell(task, self._state(robots.get(owner), name, task.number))

    def _state(self, robot: SimRobot | None, name: str, number: int) -> TaskState:
        doing = None if robot is None else robot.memory.speech if name == "say" else robot.memory.errand
        if robot is None or doing is None:
            return TaskState("aborted", reason="The world has begun again.")
        if doing.what.number != number:
            other = ERRANDS[type(doing.what)]
            return TaskState("aborted", reason=f"The robot was asked for `{other}` meanwhile.")
        if isinstance(doing, Speech):
            return TaskState("active" if self.simulation.steps < doing.until else "succeeded")
        return TaskState(doing.status, doing.left(robot.readings.odom), reason=doing.reason)

    def stop_mover(self, mover: str) -> None:
        """Stop one of the robots; `mover` is what its members begin with."""
        names = ["", *(f"{name}." for name in self.world.robot_names[1:])]
        if len(names) == 1:
            super().stop_mover(mover)
            return
        self.safety.moving("move", False, mover)
        self.simulation.drive(robot=names.index(mover))

    def stop(self) -> None:
        """Stop the robot before the next step of the world; only sets a flag."""
        self._stopping = True

    def sense(self, now: float) -> None:
        """Read all sensors, once for the tick."""
        self._stop_if_asked()
        self.simulation.latch()
        if self.requested.under_way:
            self._report()

    def _stop_if_asked(self) -> None:
        if self._stopping:
            self._stopping = False
            for robot in self.simulation.robots:
                self.simulation.drive(robot=robot.index)

    # -- time -------------------------------------------------------------------------------------

    def advance(self, seconds: float) -> None:
        """Advance the world by `seconds`, a whole number of steps."""
        self._stop_if_asked()
        self.simulation.step(round(seconds / STEP))

    def moment(self) -> object:
        """Return a token for the present moment of the world, with all queued inputs applied."""
        self.simulation.step(0)
        world, safety = self.simulation.moment, self.safety
        return _SimMoment(self.simulation, world, safety.motion, self._stopping)

    def rewind(self, moment: object) -> None:
        """Rewind the world to a moment, exactly: the same inputs give the same continuation.

        What was drawn and placed by hand since stays, as the text of the program does.

        Raises
        ------
        BridgeError
            It is not a moment of this world, or it is too long ago.
        """
        if not isinstance(moment, _SimMoment):
            raise BridgeError(f"{moment!r} is not a moment of the simulated world.")
        if moment.simulation is not self.simulation:
            raise BridgeError(
                "That moment belongs to another world, and a change of worlds cannot be rewound."
            )
        present = self.world
        try:
            self.simulation.rewind(moment.world)
        except ValueError as error:
            raise BridgeError(str(error)) from error
        self._continue_with(present)
        self.safety.motion = moment.motion
        self._stopping = moment.stopping

    def has_come_to(self, moment: object) -> bool:
        """See :class:`SimulatedWorld`."""
        done = (self.simulation.moment, self._stopping)
        return not isinstance(moment, _SimMoment) or done == (moment.world, moment.stopping)

    def forget(self, moment: object) -> None:
        """See :class:`SimulatedWorld`."""
        if isinstance(moment, _SimMoment) and moment.simulation is self.simulation:
            self.simulation.forget(moment.world)

    def fork(self, moment: object) -> SimBridge:
        """See :class:`SimulatedWorld`."""
        if not isinstance(moment, _SimMoment):
            raise BridgeError(f"{moment!r} is not a moment of the simulated world.")
        try:
            simulation = moment.simulation.fork(moment.world)
        except ValueError as error:
            raise BridgeError(str(error)) from error
        fork = SimBridge(simulation.world)
        fork.open()  # reads the sensors of a world that is not needed
        fork.simulation.close()
        fork.simulation = simulation
        simulation.drained = fork._note
        fork.safety.armed = self.safety.armed
        fork.safety.motion = moment.motion
        fork._stopping = moment.stopping
        return fork

    # -- the world, for views ---------------------------------------------------------------------

    @property
    def simulated(self) -> SimBridge:
        """The bridge itself: robot and world are one simulation."""
        return self

    @property
    def world(self) -> World:
        """The description that a reset of the world returns to: the one loaded, with all edits since."""
        return self.simulation.world

    @property
    def is_edited(self) -> bool:
        """Whether the world is another than the one loaded."""
        return self.simulation.world != self.simulation.original

    @property
    def can_undo(self) -> bool:
        """Whether there is an edit of the world to undo."""
        return self._history.can_undo

    @property
    def can_redo(self) -> bool:
        """Whether an edit of the world was undone."""
        return self._history.can_redo

    @property
    def picture(self) -> SimPicture:
        """The world now, with all queued inputs applied. On the interpreter's thread."""
        self.simulation.step(0)
        return _picture(self.simulation)

    @property
    def pose(self) -> tuple[float, float, float]:
        """The middle of the robot, in metres, and its heading in radians."""
        return self.simulation.robot.pose

    @property
    def others(self) -> Mapping[str, tuple[float, float, float]]:
        """See :class:`SimulatedWorld`."""
        if len(self.simulation.robots) == 1:
            return {}
        pairs = zip(self.world.robot_names, self.simulation.robots, strict=True)
        return {name: robot.pose for name, robot in pairs if robot.index}

    @property
    def movable(self) -> tuple[tuple[int, tuple[float, float, float]], ...]:
        """See :class:`SimulatedWorld`."""
        return tuple((thing.index, thing.pose) for thing in self.simulation.solids if can_move(thing.spec))

    @property
    def touched(self) -> frozenset[str]:
        """See :class:`SimulatedWorld`; ``edge`` is the edge of the world; another robot has its name."""
        solids = self.world.solids
        names = {-1: "edge"} | {index: solid.name or f"solid {index}" for index, solid in enumerate(solids)}
        names |= {-2 - index: name for index, name in enumerate(self.world.robot_names)}
        return frozenset(names[index] for index in self.simulation.robot.memory.touched)

    def picture_after(self, moment: object, next_moment: object) -> SimPicture | None:
        """See :class:`SimulatedWorld`."""
        if not (isinstance(moment, _SimMoment) and isinstance(next_moment, _SimMoment)):
            return None
        same = moment.simulation is next_moment.simulation
        try:
            fork = moment.simulation.fork(
                WorldMoment(moment.world.step, (next_moment if same else moment).world.inputs)
            )
        except ValueError:
            return None
        picture = _picture(fork)
        fork.close()
        return picture

    def animation(self, moments: Sequence[object], end: object) -> Callable[[], str]:
        """See :class:`SimulatedWorld`."""
        assert isinstance(end, _SimMoment)
        simulation = end.simulation
        known = (each for each in moments if isinstance(each, _SimMoment) and each.simulation is simulation)
        begin = next(known, None)
        if begin is None:
            raise BridgeError("Another world was loaded meanwhile. Begin the animation after that.")
        try:
            run = simulation.repeated(begin.world, end.world, EVERY)
        except ValueError as error:
            raise BridgeError(str(error)) from error
        return lambda: animated(run)

    def load_world(self, world: WorldSource, seed: int | None = None) -> None:
        """Load another world. On the interpreter's thread, between two ticks.

        Raises
        ------
        BridgeError
            There is no such world, or it has a mistake; the old world stays.
        """
        simulation = self._simulate(world, seed)
        self._history.note(self.simulation.edition)
        self._use(simulation)

    def _use(self, simulation: Simulation) -> None:
        former, self.simulation = self.simulation, simulation
        former.close()
        self.outside(WorldLoaded(simulation.world.to_dict()), False)
        if self.is_open:
            self.nodes.clear()
            self.add_members()
            self.open_interface()

    def edit_world(self, edit: WorldEdit) -> None:
        """Edit the description while the world runs. On the interpreter's thread, between two ticks.

        Robots and untouched solids stay where they are. A reset of the world returns to the edited
        description.

        Raises
        ------
        BridgeError
            The edit is about something that is not in the world.
        """
        try:
            self.simulation.apply(edit)
        except ValueError as error:
            raise BridgeError(str(error)) from error
        self.outside(edit, False)

    def replace_solid(self, index: int, solid: Solid) -> None:
        """Replace a solid by one that is given where it is to be now. On the interpreter's thread.

        What moves by itself keeps its patrol, unless the new one can be pushed.

        Raises
        ------
        BridgeError
            There is no such solid.
        """
        self.edit_world(PutSolid(self.simulation.continued(solid, index), index))

    def apply(self, what: Input) -> None:
        """Apply an input of the world now. On the interpreter's thread, between two ticks."""
        self.simulation.apply(what)
        self._note(what)

    @property
    def is_at_start(self) -> bool:
        """See :class:`SimulatedWorld`."""
        return self.simulation.is_at_start

    def world_form(self) -> Mapping[str, Any]:
        """See :class:`SimulatedWorld`."""
        return self.world.to_dict()

    def repeat(self, what: object) -> None:
        """See :class:`SimulatedWorld`."""
        if isinstance(what, WorldLoaded):
            self.load_world(what.world)
        else:
            self.apply(cast(Input, what))

    def undo_world(self) -> None:
        """Undo the last edit of the world, or the change of worlds. On the interpreter's thread.

        Raises
        ------
        BridgeError
            Nothing was edited.
        """
        self._return_to(self._history.undo(self.simulation.edition), "undone")

    def redo_world(self) -> None:
        """Redo the edit that was undone last. On the interpreter's thread.

        Raises
        ------
        BridgeError
            Nothing was undone, or something was edited since.
        """
        self._return_to(self._history.redo(self.simulation.edition), "redone")

    def _return_to(self, edition: Edition | None, done: str) -> None:
        if edition is None:
            raise BridgeError(f"There is no edit of the world that could be {done}.")
        if is_edit(self.world, edition.world):
            self._continue_with(edition.world)
        else:
            self._use(self._edition(edition))

    def _edition(self, edition: Edition) -> Simulation:
        simulation = Simulation(edition.world, history=self._history, original=edition.original)
        simulation.drained = self._note
        return simulation

    def _continue_with(self, world: World) -> None:
        if world != self.world:
            self.simulation.replay(Become(world))
            self.outside(Become(world), False)

    def reset_world(self, drawings: bool = False) -> None:
        """Reset the world to its start and erase trails. Any thread.

        What was drawn and placed by hand stays, unless `drawings`; that can be undone.
        """
        if drawings:
            self._submit(Become(self.simulation.original))
        self._submit(ResetWorld())

    def place_robot(self, pose: tuple[float, float, float], robot: int = 0) -> None:
        """Put a robot down elsewhere: x, y (metres), heading (radians). Any thread.

        Raises
        ------
        BridgeError
            There is no such robot, or a number is not finite.
        """
        self._submit(PlaceRobot(pose, robot))

    def place_solid(self, solid: int, pose: tuple[float, float, float]) -> None:
        """Put a solid down elsewhere: x, y (metres), angle (radians). Any thread.

        Raises
        ------
        BridgeError
            There is no such solid, or a number is not finite.
        """
        self._submit(PlaceSolid(pose, solid))

    def draw(self, path: tuple[tuple[float, float], ...], width: float = 0.03, grey: float = 0) -> None:
        """Paint a line through points (metres) on the floor; `grey` is 0 black ... 255 white. Any thread.

        Raises
        ------
        BridgeError
            There is no point, or a number is not finite.
        """
        self._submit(Draw(tuple(path), width, grey))

    def erase(self, path: tuple[tuple[float, float], ...], width: float = 0.06) -> None:
        """Paint with the floor's own grey. Any thread.

        Raises
        ------
        BridgeError
            There is no point, or a number is not finite.
        """
        self._submit(Draw(tuple(path), width, None))

    def _submit(self, what: Input) -> None:
        try:
            self.simulation.submit(what)
        except (TypeError, ValueError) as error:
            raise BridgeError(str(error)) from error


_GREYS = 0.0, 255.0
_ODOM = (
    ("x", "m", "way driven along the heading at the start, by the wheels"),
    ("y", "m", "way driven to the left of the heading at the start, by the wheels"),
    ("theta", "rad", "angle turned since the start, by the wheels"),
)


def _picture(simulation: Simulation) -> SimPicture:
    robots = tuple(
        RobotPicture(
            robot.pose,
            robot.command,
            robot.readings.lights,
            robot.readings.bumper,
            robot.readings.distances,
            robot.memory.pen is not None,
            robot.memory.lamp,
            simulation.said(robot.index),
        )
        for robot in simulation.robots
    )
    return SimPicture(
        simulation.world,
        simulation.time,
        robots,
        tuple(thing.pose for thing in simulation.solids),
        tuple(thing.patrol for thing in simulation.solids),
        simulation.revision,
        len(simulation.floor.marks),
    )


def _nth_light(index: int, seen: Readings) -> int | None:
    return seen.lights[index] if index < len(seen.lights) else None


def _nth_distance(index: int, seen: Readings) -> float | None:
    return seen.distances[index] if index < len(seen.distances) else None


def _scans(angles: tuple[float, ...], seen: Readings) -> tuple[RayScan, ...]:
    return (RayScan(angles, seen.distances),) if len(seen.distances) == len(angles) else ()


def _odom(index: int, seen: Readings) -> float:
    return seen.odom[index]


def _bearing(angle: float) -> str:
    degrees = round(math.degrees(angle))
    return f"{abs(degrees)}° {'left' if degrees > 0 else 'right'}" if degrees else "ahead"


def _place(place: tuple[float, float]) -> str:
    return f"({place[0]:g}, {place[1]:g})"


def _checked_noise(noise: Noise | Mapping[str, float] | None) -> Noise | None:
    if noise is None or isinstance(noise, Noise):
        return noise
    check_type("noise", noise, Mapping, 'a mapping such as `{"light": 4}`')
    known = [field.name for field in fields(Noise)]
    unknown = [name for name in noise if name not in known]
    if unknown:
        listed = ", ".join(f"`{name}`" for name in known)
        raise BridgeError(f"There is no noise `{unknown[0]}`. Choose one of {listed}.")
    for name, value in noise.items():
        check_number(name, value, "a standard deviation", least=0)
    return replace(Noise(), **noise)

"""Robots on two wheels and solids, fixed, pushable or moving, as pymunk bodies.

Seen from above no gravity presses things to the ground. The floor brakes a pushable solid through
two joints with bounded force, which is Coulomb's friction. It moves a robot through `_roll`, a
`velocity_func`, which pymunk calls in every step; it is module-level, because bound ones break
copying, and costs three times the rest of a step. A robot whose velocity it would not change, because
it stands, turns or drives straight and touches nothing, therefore sleeps: its function is removed
until a command or a contact wakes it. The result is the same, bit for bit.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from random import Random

import pymunk

from lrp_jupyter.sim.errands import Errand, Speech, guided
from lrp_jupyter.sim.floor import LiveFloor, Paint
from lrp_jupyter.sim.sensors import Odometer, Readings, read_distances, read_lights
from lrp_jupyter.sim.world import BoxSolid, Point, Pose, RobotSpec, Solid, middle_of

STEP = 0.01  # s: one step of physics
GRAVITY = 9.81  # m/s²
GRIP = 0.8  # coefficient of friction of the wheels: pushing harder, they slip
TURNING_GRIP = 150.0  # rad/s²
WHEELBASE = 1.4  # distance between the wheels, in radii of the robot
MASS = 1.0  # kg, of a robot
DENSITY = 25.0  # kg per m² of floor covered, of pushable solids
BAR = 0.004  # m: how far the bumper bar stands off the body
BAR_HALF = math.radians(55)
_DROPOUT = 10  # ticks

SOLID, BODY, BUMPER = 1, 2, 4  # categories, for contacts and rays
_ROLLING, _PRESSING = 1, 2  # types of contact; 0 is not watched

Motion = tuple[float, float, float, float, float, float]  # x, y, angle; their velocities


class Body(pymunk.Body):
    """A body that knows its owner."""

    def __init__(self, mass: float = 0, moment: float = 0, body_type: int = pymunk.Body.DYNAMIC) -> None:
        super().__init__(mass, moment, body_type)
        self.contacts: set[int] = set()  # solids touched since this was cleared

    # pymunk's, a function in Python for type checkers only, is called twice in every step
    __setattr__ = object.__setattr__  # type: ignore[assignment]

    solid = -1  # number of the solid; -1: the edge of the world; -2 and below: a robot
    wheels: SimRobot | None = None
    touched = False  # by anything, in this step
    awake = False
    target = (0.0, 0.0)  # of wheels: m/s, rad/s

    def wake(self) -> None:
        """Make the floor act on the body again."""
        if not self.awake and self.wheels is not None:
            self.awake = True
            self.velocity_func = _roll

    def sleep(self) -> None:
        """Leave the body to inertia."""
        self.awake = False
        self.velocity_func = pymunk.Body.update_velocity

    def motion(self) -> Motion:
        """Return its position, angle and velocities."""
        return (*self.position, self.angle, *self.velocity, self.angular_velocity)

    @property
    def is_loaded(self) -> bool:
        """Whether contacts or joints remember impulses, with which they begin the next step."""
        impulses: list[Point] = []
        self.each_arbiter(lambda arbiter: impulses.append(arbiter.total_impulse))
        return any(x or y for x, y in impulses) or any(joint.impulse for joint in self.constraints)

    def move(self, motion: Motion) -> None:
        """Set its position, angle and velocities."""
        x, y, angle, vx, vy, spin = motion
        self.position = (x, y)
        self.angle = angle
        if self.body_type == pymunk.Body.DYNAMIC:
            self.velocity = (vx, vy)
            self.angular_velocity = spin
        self.wake()


def _roll(body: pymunk.Body, gravity: Point, damping: float, dt: float) -> None:
    """Accelerate a robot to its target speeds, as far as the wheels grip; they do not slip sideways."""
    assert isinstance(body, Body)
    cos, sin = body.rotation_vector
    vx, vy = body.velocity
    linear, angular = body.target
    dx, dy = cos * linear - vx, sin * linear - vy
    turn = angular - body.angular_velocity
    if body.touched:
        body.touched = False
    elif dx == 0.0 == dy and turn == 0.0 and (linear == 0.0 or angular == 0.0):
        body.sleep()
        return
    slip, most = math.hypot(dx, dy), GRIP * GRAVITY * dt
    if slip <= most:
        body.velocity = (cos * linear, sin * linear)
    else:
        body.velocity = (vx + dx * most / slip, vy + dy * most / slip)
    most = TURNING_GRIP * dt
    body.angular_velocity = angular if abs(turn) <= most else angular - math.copysign(abs(turn) - most, turn)


@dataclass(slots=True)
class Memory:
    """The state of a robot besides its body; every field is a value, so that a copy is a snapshot."""

    odometer: Odometer
    first_heading: float = 0.0  # rad: the gyro counts from here
    command: tuple[float, float] = (0.0, 0.0)
    slip: tuple[float, float] = (1.0, 1.0)  # factor on each wheel's speed in this tick, noise included
    readings: Readings = field(default_factory=Readings)
    latched_at: int = -1
    pressed_at: int = -1
    is_pressed: bool = False  # whether its press was not yet followed by a release …
    bumps: tuple[bool, ...] = ()  # … among what the bumper did since the last latch
    touching: frozenset[int] = frozenset()  # what was touched since the last latch, as `Body.solid`
    touched: frozenset[int] = frozenset()  # the same, in the tick before the last latch
    pen: Paint | None = None
    pen_at: Point = (0.0, 0.0)
    lamp: bool = False
    blind: int = 0  # ticks for which the distance sensors still see nothing
    errand: Errand | None = None  # the last way or turn that it was asked for
    speech: Speech | None = None  # the last text that it was asked to say

    def press(self, step: int) -> None:
        """Note that the bumper is pressed in a step."""
        if not self.is_pressed:
            self.bumps += (True,)
        elif self.pressed_at < step - 1:
            self.bumps += (False, True)
        self.is_pressed, self.pressed_at = True, step

    def take_bumps(self, step: int) -> tuple[bool, ...]:
        """Return what the bumper did since the last latch; another latch in the same step finds it again."""
        if self.latched_at == step:
            return self.readings.bumps
        if self.is_pressed and self.pressed_at < step:
            self.is_pressed = False
            self.bumps += (False,)
        bumps, self.bumps = self.bumps, ()
        return bumps


class SimRobot:
    """One robot of a running world."""

    def __init__(self, spec: RobotSpec, index: int) -> None:
        self.spec = spec
        self.index = index
        self.sight = pymunk.ShapeFilter(group=index + 1, categories=BODY, mask=SOLID | BODY)
        self.body = Body()
        self.start()

    def start(self) -> None:
        """Reset the memory."""
        self.memory = Memory(Odometer(self.spec.pose), self.spec.pose[2], slip=self.spec.wheels)

    @property
    def start_motion(self) -> Motion:
        """The position and velocities at the start."""
        return (*self.spec.pose, 0.0, 0.0, 0.0)

    @property
    def pose(self) -> Pose:
        """The true pose: x, y (metres), heading (radians)."""
        return (*self.body.position, self.body.angle)

    @property
    def readings(self) -> Readings:
        """The sensor values of the last latch."""
        return self.memory.readings

    @property
    def command(self) -> tuple[float, float]:
        """The commanded speeds, in m/s and rad/s, within its limits."""
        return self.memory.command

    @property
    def reckoned(self) -> Pose:
        """Where it is by its wheels: as the odometer said last, and the way since then."""
        return self.memory.odometer.advanced(self.pose).pose

    @property
    def is_on_errand(self) -> bool:
        """Whether it drives by itself."""
        return self.memory.errand is not None and self.memory.errand.is_active

    def guide(self, step: int) -> None:
        """Compute the speeds of a step that is to be made, for the errand that it is on."""
        memory = self.memory
        assert memory.errand is not None
        memory.errand, memory.command = guided(memory.errand, self.reckoned, memory.command, step)
        self.steer()

    def steer(self) -> None:
        """Compute the target speeds from the command, the wheels, and the motor noise of this tick."""
        linear, angular = self.memory.command
        left_slip, right_slip = self.memory.slip
        if left_slip != 1.0 or right_slip != 1.0:
            base = WHEELBASE * self.spec.radius
            left = (linear - angular * base / 2) * left_slip
            right = (linear + angular * base / 2) * right_slip
            linear, angular = (left + right) / 2, (right - left) / base
        if self.body.target != (linear, angular):
            self.body.target = (linear, angular)
            self.body.wake()

    def sense(
        self, floor: LiveFloor, space: pymunk.Space, random: Random, bumped: bool, bumps: tuple[bool, ...]
    ) -> None:
        """Read all sensors, drawing the noise that they have, and advance the odometer."""
        spec, memory, pose = self.spec, self.memory, self.pose
        lights = read_lights(spec, pose, floor, random)
        distances = read_distances(spec, pose, space, self.sight, random)
        if spec.noise.dropout:
            memory.blind = (
                memory.blind - 1 if memory.blind else _DROPOUT * (random.random() < spec.noise.dropout)
            )
            distances = (math.inf,) * len(distances) if memory.blind else distances
        gyro = pose[2] - memory.first_heading
        if spec.noise.gyro:
            gyro += random.gauss(0.0, spec.noise.gyro)
        memory.odometer = memory.odometer.advanced(pose, spec.noise.odom, random)
        odom = memory.odometer.pose
        memory.readings = Readings(lights, int(bumped), distances, gyro, odom, bumps)

    def embody(self, space: pymunk.Space, motion: Motion) -> None:
        """Create the body in a new space."""
        radius = self.spec.radius
        self.body = Body(MASS, pymunk.moment_for_circle(MASS, 0, radius))
        self.body.wheels = self
        self.body.solid = -2 - self.index
        self.body.move(motion)
        hull = pymunk.Circle(self.body, radius)
        hull.friction = 0.3
        hull.collision_type = _ROLLING
        hull.filter = pymunk.ShapeFilter(self.index + 1, BODY, SOLID | BODY | BUMPER)
        space.add(self.body, hull)
        if self.spec.bumper:
            angles = [BAR_HALF * step / 4 for step in range(-4, 5)]
            rim = [((radius + BAR) * math.cos(angle), (radius + BAR) * math.sin(angle)) for angle in angles]
            bar = pymunk.Poly(self.body, rim)
            bar.sensor = True
            bar.collision_type = _PRESSING
            bar.filter = pymunk.ShapeFilter(group=self.index + 1, categories=BUMPER, mask=SOLID | BODY)
            space.add(bar)
        self.steer()


class SimSolid:
    """One solid of a running world."""

    def __init__(self, spec: Solid, index: int) -> None:
        self.spec = spec
        self.index = index
        self.body = Body()
        self._origin: Point = (0.0, 0.0)

    def start_motion(self, steps: int) -> Motion:
        """Return the position and velocities of a solid that is where its description says.

        `steps`: since the start of the world: one on a patrol is as far on its patrol.
        """
        x, y = middle_of(self.spec)
        dx, dy = self.displacement(steps)
        return (x + dx, y + dy, self.spec.angle, 0.0, 0.0, 0.0)

    def displacement(self, steps: int) -> Point:
        """Return how far a patrol has moved it, so many steps after the start of the world."""
        return self.spec.patrol.at(steps * STEP) if self.spec.patrol is not None else (0.0, 0.0)

    @property
    def patrol(self) -> tuple[Point, ...]:
        """The points of its patrol, in metres; empty without one."""
        return () if self.spec.patrol is None else self.spec.patrol.points(self._origin)

    def lead(self, steps: int) -> None:
        """Let its patrol lead through its present place, so many steps after the start of the world."""
        (x, y), (dx, dy) = self.body.position, self.displacement(steps)
        self._origin = (x - dx, y - dy)

    def go(self, steps: int) -> None:
        """Set the velocity with which the next step takes it to its place so many steps after the start."""
        (x, y), (dx, dy) = self.body.position, self.displacement(steps)
        self.body.velocity = (self._origin[0] + dx - x) / STEP, (self._origin[1] + dy - y) / STEP

    @property
    def pose(self) -> Pose:
        """The present pose: x, y (metres), angle (radians)."""
        return (*self.body.position, self.body.angle)

    def embody(self, space: pymunk.Space, motion: Motion, steps: int) -> None:
        """Create the body in a new space, so many steps after the start of the world."""
        shape: pymunk.Shape
        if isinstance(self.spec, BoxSolid):
            _, _, width, height = self.spec.box
            area, reach = width * height, math.hypot(width, height) / 2
        else:
            radius = self.spec.circle[2]
            area, reach = math.pi * radius**2, radius
        if self.spec.patrol is not None:
            body = Body(body_type=pymunk.Body.KINEMATIC)
        elif self.spec.push is None:
            body = Body(body_type=pymunk.Body.STATIC)
        else:
            mass = area * DENSITY
            body = Body(mass, mass * reach**2 / 2)
        if isinstance(self.spec, BoxSolid):
            shape = pymunk.Poly.create_box(body, (width, height))
        else:
            shape = pymunk.Circle(body, radius)
        body.solid = self.index
        body.move(motion)
        shape.friction = 0.3
        shape.filter = pymunk.ShapeFilter(categories=SOLID)
        self.body = body
        self.lead(steps)
        space.add(body, shape)
        if self.spec.push is not None:
            force = self.spec.push * body.mass * GRAVITY
            sliding = pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0))
            turning = pymunk.GearJoint(space.static_body, body, 0, 1)
            sliding.max_force = force
            turning.max_force = force * reach * 2 / 3  # friction acts there, on average over the area
            for joint in (sliding, turning):
                joint.max_bias = 0.0  # to brake, not to pull back
                space.add(joint)


@dataclass(slots=True)
class StepCount:
    """Counts the steps of a world."""

    steps: int = 0


def fresh_space(clock: StepCount) -> pymunk.Space:
    """Return an empty space that records contacts."""
    space = pymunk.Space()
    space.collision_slop = 0.0005
    space.on_collision(_ROLLING, None, pre_solve=_touch)
    space.on_collision(_PRESSING, None, pre_solve=_press, data=clock)
    return space


def clear(space: pymunk.Space) -> None:
    """Remove everything from a space that is no longer used, so that Python can free the parts in any order.

    Python's garbage collector may run inside a block. If the block is interrupted just then, the exception is
    raised in pymunk's finalizers, and one that has not removed all parts of a space crashes the process.
    """
    space.remove(*space.constraints, *space.shapes, *space.bodies)


def edge(space: pymunk.Space, size: Point) -> None:
    """Add walls around a world, outside of it."""
    width, height = size
    body = Body(body_type=pymunk.Body.STATIC)
    thick = 0.1
    left, bottom, right, top = -thick, -thick, width + thick, height + thick
    space.add(body)
    for start, end in pairwise([(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]):
        wall = pymunk.Segment(body, start, end, thick)
        wall.friction = 0.3
        wall.filter = pymunk.ShapeFilter(categories=SOLID)
        space.add(wall)


def _bodies(arbiter: pymunk.Arbiter) -> Iterator[Body]:
    for shape in arbiter.shapes:
        if isinstance(shape.body, Body):
            yield shape.body


def _touch(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
    if any(shape.sensor for shape in arbiter.shapes):
        return  # the bumper of another robot, which stands off its body
    first, second = _bodies(arbiter)
    for body, other in ((first, second), (second, first)):
        body.touched = True
        body.wake()
        _note(body, other)


def _press(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
    first, second = _bodies(arbiter)
    if not arbiter.shapes[0].sensor:
        first, second = second, first
    robot = first.wheels
    assert robot is not None
    assert isinstance(data, StepCount)
    robot.memory.press(data.steps + 1)  # the step that is being made
    _note(first, second)


def _note(body: Body, other: Body) -> None:
    if body.wheels is not None:
        body.contacts.add(other.solid)
        memory = body.wheels.memory
        if other.solid not in memory.touching:
            memory.touching |= {other.solid}

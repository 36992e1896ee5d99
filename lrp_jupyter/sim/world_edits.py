"""Edits of a world's description: values that turn one description into another, and the history of them.

An edit is an input of a running world: robots and untouched solids stay where they are, and a reset
returns to the edited description.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import NamedTuple

from lrp_jupyter.sim.world import PathStroke, Point, Pose, Solid, World, WorldError, Zone, middle_of, put_at

MOST_POINTS = 20_000  # of drawn lines; later ones are not drawn
_MOST_STEPS = 500  # that can be undone


class WorldEdit(ABC):
    """Base class of the edits."""

    __slots__ = ()

    @abstractmethod
    def edited(self, world: World) -> World:
        """Return the world with this edit.

        Raises WorldError: it is about something that is not in the world.
        """


@dataclass(frozen=True, slots=True)
class Draw(WorldEdit):
    """Paint a stroke on the floor; one with ``grey=None`` has the floor's own grey and erases."""

    path: tuple[Point, ...]
    width: float = 0.03
    grey: float | None = 0

    def edited(self, world: World) -> World:
        """Return the world with another stroke above the others, below the trails of pens."""
        floor = world.floor
        points = sum(len(stroke.path) for stroke in floor.strokes if isinstance(stroke, PathStroke))
        if points + len(self.path) > MOST_POINTS:
            return world
        stroke = PathStroke(self.path, self.width, floor.grey if self.grey is None else self.grey)
        return replace(world, floor=replace(floor, strokes=(*floor.strokes, stroke)))


@dataclass(frozen=True, slots=True)
class PutSolid(WorldEdit):
    """Add a solid, or replace the one with the number `index`."""

    solid: Solid
    index: int | None = None

    def edited(self, world: World) -> World:
        """Return the world with the solid; its middle is inside of it."""
        solid = put_at(self.solid, _inside(middle_of(self.solid), world.size))
        solids = list(world.solids)
        if self.index is None:
            solids.append(solid)
        else:
            solids[_known(self.index, world)] = solid
        return replace(world, solids=tuple(solids))


@dataclass(frozen=True, slots=True)
class RemoveSolid(WorldEdit):
    """Remove the solid with the number `index`."""

    index: int

    def edited(self, world: World) -> World:
        """Return the world without the solid; the numbers of later ones decrease."""
        index = _known(self.index, world)
        return replace(world, solids=world.solids[:index] + world.solids[index + 1 :])


@dataclass(frozen=True, slots=True)
class PutZone(WorldEdit):
    """Add a zone, or replace the one that is called `former`, by default like the new one."""

    name: str
    zone: Zone
    former: str = ""

    def edited(self, world: World) -> World:
        """Return the world with the zone, in the place of the former one."""
        if not self.name:
            raise WorldError("A zone needs a name.")
        former = self.former or self.name
        if former != self.name and self.name in world.zones:
            raise WorldError(f"There is a zone `{self.name}` already. Choose another name.")
        zone = put_at(self.zone, _inside(middle_of(self.zone), world.size))
        zones = {
            self.name if name == former else name: zone if name == former else other
            for name, other in world.zones.items()
        }
        return replace(world, zones={**zones, self.name: zone})


@dataclass(frozen=True, slots=True)
class RemoveZone(WorldEdit):
    """Remove a zone."""

    name: str

    def edited(self, world: World) -> World:
        """Return the world without the zone."""
        if self.name not in world.zones:
            raise WorldError(f"There is no zone `{self.name}`.")
        return replace(world, zones={name: zone for name, zone in world.zones.items() if name != self.name})


@dataclass(frozen=True, slots=True)
class SetStart(WorldEdit):
    """Set the pose in which a robot starts."""

    pose: Pose
    robot: int = 0

    def edited(self, world: World) -> World:
        """Return the world with the start of the robot; its middle is inside of the world."""
        if self.robot >= len(world.robots):
            raise WorldError(f"There is no robot {self.robot}.")
        robots = list(world.robots)
        x, y, heading = self.pose
        pose = (*_inside((x, y), world.size), heading)
        robots[self.robot] = replace(robots[self.robot], pose=pose)
        return replace(world, robots=tuple(robots))


@dataclass(frozen=True, slots=True)
class Become(WorldEdit):
    """Replace the description by an earlier or later one of the same world."""

    world: World

    def edited(self, world: World) -> World:
        """Return the other description."""
        return self.world


def is_edit(before: World, after: World) -> bool:
    """Return whether edits lead from one description to the other, so that a run can continue with it."""
    starts = (
        replace(robot, pose=start.pose) for robot, start in zip(before.robots, after.robots, strict=False)
    )
    return (*starts, *before.robots[len(after.robots) :]) == after.robots and before == replace(
        after, robots=before.robots, floor=before.floor, solids=before.solids, zones=before.zones
    )


class Edition(NamedTuple):
    """A description, and the one that was loaded, from which edits led to it."""

    world: World
    original: World


class WorldHistory:
    """The editions that edits and changes of worlds have led through: undo and redo."""

    def __init__(self) -> None:
        self._earlier: list[Edition] = []
        self._later: list[Edition] = []

    def note(self, now: Edition) -> None:
        """Record the edition that is about to be edited; what was undone before is forgotten."""
        self._earlier = [*self._earlier[-_MOST_STEPS:], now]
        self._later = []

    @property
    def can_undo(self) -> bool:
        """Whether there is an earlier edition."""
        return bool(self._earlier)

    @property
    def can_redo(self) -> bool:
        """Whether an edit was undone."""
        return bool(self._later)

    def undo(self, now: Edition) -> Edition | None:
        """Return the edition before the last edit, None if there was no edit."""
        return _step(self._earlier, self._later, now)

    def redo(self, now: Edition) -> Edition | None:
        """Return the edition before the last undo, None if nothing was undone."""
        return _step(self._later, self._earlier, now)


def _step(source: list[Edition], target: list[Edition], now: Edition) -> Edition | None:
    if not source:
        return None
    target.append(now)
    return source.pop()


def _known(index: int, world: World) -> int:
    if not 0 <= index < len(world.solids):
        raise WorldError(f"There is no solid {index}: the world has {len(world.solids)}.")
    return index


def _inside(point: Point, size: Point) -> Point:
    (x, y), (width, height) = point, size
    return min(width, max(0.0, x)), min(height, max(0.0, y))

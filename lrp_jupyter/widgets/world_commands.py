"""The commands of a page about the world of the simulated robot, and its requests for files and pictures."""

from __future__ import annotations

import os
from abc import ABC
from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, ClassVar

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError, LRPError
from lrp_jupyter.files import write_file
from lrp_jupyter.live import commands as do
from lrp_jupyter.sim.edits import PutSolid, PutZone, RemoveSolid, RemoveZone, SetStart, WorldEdit
from lrp_jupyter.sim.reading import read_solid, read_text, read_zone
from lrp_jupyter.sim.svg import svg
from lrp_jupyter.sim.world import Point, Pose
from lrp_jupyter.widgets.messages import Between, OpenProgram, PageCommand, PageRequest

Applied = Future[Any]
Index = Annotated[int, Between(0, 10_000)]
Grey = Annotated[int, Between(0, 255)]
Width = Annotated[float, Between(0, 10)]  # m
Box = tuple[float, float, float, float]

WORLD_FILE = ".world.json"
"""The end of the names of files that the page offers as worlds."""


def _world(opened: OpenProgram) -> SimBridge:
    bridge = opened.session.bridge
    if not isinstance(bridge, SimBridge):
        raise BridgeError(f"`{bridge.name}` has no world that could be changed.")
    return bridge


def _publish(opened: OpenProgram) -> Applied:
    """Publish a frame of the changed world, also while nothing ticks."""
    return opened.session.ask(do.Call(lambda: None, "publish"))


def _edit(opened: OpenProgram, edit: WorldEdit) -> Applied:
    return opened.session.ask(do.Call(partial(_world(opened).edit_world, edit), "edit the world"))


# -- acts that a reset undoes ------------------------------------------------------------------------


class WorldChange(PageCommand, ABC):
    """Base class of commands that change the world, which is the present one."""

    is_present: ClassVar[bool] = True
    changes_world: ClassVar[bool] = True


@dataclass(frozen=True)
class DragRobotCommand(WorldChange, do="drag_robot"):
    """Move a robot; sent while it is dragged."""

    index: Index
    pose: Pose

    def apply(self, opened: OpenProgram) -> Applied:
        _world(opened).place_robot(self.pose, self.index)
        return _publish(opened)


@dataclass(frozen=True)
class DragSolidCommand(WorldChange, do="drag_solid"):
    """Move a solid; sent while it is dragged, before a `put_solid` at its new place."""

    index: Index
    pose: Pose

    def apply(self, opened: OpenProgram) -> Applied:
        _world(opened).place_solid(self.index, self.pose)
        return _publish(opened)


@dataclass(frozen=True)
class ResetPoseCommand(WorldChange, do="reset_pose"):
    """Return a robot to its start."""

    index: Index

    def apply(self, opened: OpenProgram) -> Applied:
        bridge = _world(opened)
        if self.index >= len(bridge.world.robots):
            raise BridgeError(f"There is no robot {self.index}.")
        bridge.place_robot(bridge.world.robots[self.index].pose, self.index)
        return _publish(opened)


@dataclass(frozen=True)
class ResetWorldCommand(WorldChange, do="reset_world"):
    """Reset the world to its start, without trails; with `drawings` also without what was edited."""

    drawings: bool = False

    def apply(self, opened: OpenProgram) -> Applied:
        _world(opened).reset_world(self.drawings)
        return _publish(opened)


# -- edits -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class StrokeCommand(WorldChange, do="stroke"):
    """Draw a line on the floor, in metres."""

    points: list[Point]
    width: Width = 0.03
    grey: Grey = 0

    def apply(self, opened: OpenProgram) -> Applied:
        _world(opened).draw(tuple(self.points), self.width, self.grey)
        return _publish(opened)


@dataclass(frozen=True)
class EraseCommand(WorldChange, do="erase"):
    """Paint with the floor's own grey."""

    points: list[Point]
    width: Width = 0.06

    def apply(self, opened: OpenProgram) -> Applied:
        _world(opened).erase(tuple(self.points), self.width)
        return _publish(opened)


@dataclass(frozen=True)
class PutSolidCommand(WorldChange, do="put_solid"):
    """Add a solid, a `box` or a `circle`, or replace the one with this index."""

    index: int | None = None
    box: Box | None = None
    circle: Pose | None = None
    angle: float = 0.0
    push: float | None = None
    name: str = ""

    def apply(self, opened: OpenProgram) -> Applied:
        described = {"angle": self.angle, "push": self.push, "name": self.name} | _shape(
            self.box, self.circle
        )
        solid = read_solid(described, "solid")
        if self.index is None:
            return _edit(opened, PutSolid(solid))
        replacing = partial(_world(opened).replace_solid, self.index, solid)
        return opened.session.ask(do.Call(replacing, "edit the world"))


@dataclass(frozen=True)
class RemoveSolidCommand(WorldChange, do="remove_solid"):
    """Remove a solid."""

    index: Index

    def apply(self, opened: OpenProgram) -> Applied:
        return _edit(opened, RemoveSolid(self.index))


@dataclass(frozen=True)
class PutZoneCommand(WorldChange, do="put_zone"):
    """Add a zone, a `box` or a `circle`, or replace the one called `former`, by default of the same name."""

    name: str
    former: str = ""
    box: Box | None = None
    circle: Pose | None = None

    def apply(self, opened: OpenProgram) -> Applied:
        zone = read_zone(_shape(self.box, self.circle), "zone")
        return _edit(opened, PutZone(self.name.strip(), zone, self.former))


@dataclass(frozen=True)
class RemoveZoneCommand(WorldChange, do="remove_zone"):
    """Remove a zone."""

    name: str

    def apply(self, opened: OpenProgram) -> Applied:
        return _edit(opened, RemoveZone(self.name))


@dataclass(frozen=True)
class SetStartCommand(WorldChange, do="set_start"):
    """Set the pose in which a robot starts."""

    index: Index
    pose: Pose

    def apply(self, opened: OpenProgram) -> Applied:
        return _edit(opened, SetStart(self.pose, self.index))


@dataclass(frozen=True)
class UndoWorldCommand(WorldChange, do="undo_world"):
    """Undo the last edit of the world."""

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.session.ask(do.Call(_world(opened).undo_world, "undo"))


@dataclass(frozen=True)
class RedoWorldCommand(WorldChange, do="redo_world"):
    """Redo the edit of the world that was undone last."""

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.session.ask(do.Call(_world(opened).redo_world, "redo"))


def _shape(box: Box | None, circle: Pose | None) -> dict[str, Any]:
    return {name: shape for name, shape in (("box", box), ("circle", circle)) if shape is not None}


# -- worlds as files and pictures --------------------------------------------------------------------


@dataclass(frozen=True)
class WorldCommand(WorldChange, do="world"):
    """Continue in another world: a bundled one, or that of a file."""

    name: str

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.session.ask(do.Call(partial(_world(opened).load_world, self.name), "world"))


@dataclass(frozen=True)
class WorldTextCommand(WorldChange, do="world_text"):
    """Continue in the world that a JSON text describes."""

    text: str

    def apply(self, opened: OpenProgram) -> Applied:
        world = read_text(self.text, "The file")
        return opened.session.ask(do.Call(partial(_world(opened).load_world, world), "world"))


@dataclass(frozen=True)
class SaveWorldRequest(PageRequest, type="save_world"):
    """Write the world to a JSON file. Answered by `exists`: a file is there; it was not replaced."""

    name: str
    replace: bool

    def answer(self, opened: OpenProgram) -> Mapping[str, Any]:
        """Return whether another file is in the way."""
        file = Path(os.path.expanduser(self.name.strip()))
        if not file.name:
            raise LRPError("Enter a name for the file.")
        if file.suffix != ".json":
            file = file.with_name(f"{file.name}{WORLD_FILE}")
        if not self.replace and os.path.lexists(file):
            return {"exists": True}
        world = replace(_world(opened).world, name=file.name.removesuffix(".json").removesuffix(".world"))
        write_file(file, world.to_json(indent=1) + "\n")
        return {"exists": False}


@dataclass(frozen=True)
class WorldPictureRequest(PageRequest, type="world_picture"):
    """Draw the world as it is now. Answered by `svg`."""

    def answer(self, opened: OpenProgram) -> Mapping[str, Any]:
        """Return the picture."""
        bridge = _world(opened)
        return {"svg": opened.session.call(lambda: svg(bridge.simulation))}


@dataclass(frozen=True)
class WorldAnimationRequest(PageRequest, type="world_animation"):
    """Draw how the world moved, as far as it is remembered. Answered by `svg`."""

    def answer(self, opened: OpenProgram) -> Mapping[str, Any]:
        """Return the moving picture."""
        _world(opened)
        return {"svg": opened.session.animation()}


def saved_worlds(folder: str | os.PathLike[str] = ".") -> list[str]:
    """Return the names of the files of a folder that the page offers as worlds."""
    try:
        return sorted(name for name in os.listdir(folder) if name.endswith(WORLD_FILE))
    except OSError:
        return []

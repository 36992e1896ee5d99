"""What a page can do to the world of the simulated robot, and its questions for files and pictures of it."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace as renamed
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError, LRPError
from lrp_jupyter.files import write_file
from lrp_jupyter.live import commands as do
from lrp_jupyter.sim.edits import PutSolid, PutZone, RemoveSolid, RemoveZone, SetStart, WorldEdit
from lrp_jupyter.sim.reading import read_solid, read_text, read_zone
from lrp_jupyter.sim.svg import svg
from lrp_jupyter.sim.world import Point, Pose
from lrp_jupyter.widgets.codec import Between
from lrp_jupyter.widgets.messages import OpenProgram, act, question

Applied = Future[Any]
Index = Annotated[int, Between(0, 10_000)]
Grey = Annotated[int, Between(0, 255)]
Width = Annotated[float, Between(0, 10)]  # m
Box = tuple[float, float, float, float]

WORLD_FILE = ".world.json"
"""The end of the names of files that the page offers as worlds."""

world_act = partial(act, is_present=True, changes_world=True)


def _world(opened: OpenProgram) -> SimBridge:
    bridge = opened.session.bridge
    if not isinstance(bridge, SimBridge):
        raise BridgeError(f"`{bridge.name}` has no world that could be changed.")
    return bridge


def _publish(opened: OpenProgram) -> Applied:
    """Publish a frame of the changed world, also while nothing ticks."""
    return opened.session.ask(do.Call(lambda: None))


def _change(opened: OpenProgram, change: Callable[[], object]) -> Applied:
    """Change the world between two ticks."""
    return opened.session.ask(do.Call(change))


def _edit(opened: OpenProgram, edit: WorldEdit) -> Applied:
    return _change(opened, partial(_world(opened).edit_world, edit))


# -- acts that a reset undoes ------------------------------------------------------------------------


@world_act()
def drag_robot(opened: OpenProgram, index: Index, pose: Pose) -> Applied:
    """Move a robot; sent while it is dragged."""
    _world(opened).place_robot(pose, index)
    return _publish(opened)


@world_act()
def drag_solid(opened: OpenProgram, index: Index, pose: Pose) -> Applied:
    """Move a solid; sent while it is dragged, before a `put_solid` at its new place."""
    _world(opened).place_solid(index, pose)
    return _publish(opened)


@world_act()
def reset_pose(opened: OpenProgram, index: Index) -> Applied:
    """Return a robot to its start."""
    bridge = _world(opened)
    if index >= len(bridge.world.robots):
        raise BridgeError(f"There is no robot {index}.")
    bridge.place_robot(bridge.world.robots[index].pose, index)
    return _publish(opened)


@world_act()
def reset_world(opened: OpenProgram, drawings: bool = False) -> Applied:
    """Reset the world to its start, without trails; with `drawings` also without what was edited."""
    _world(opened).reset_world(drawings)
    return _publish(opened)


# -- edits -------------------------------------------------------------------------------------------


@world_act()
def stroke(opened: OpenProgram, points: list[Point], width: Width = 0.03, grey: Grey = 0) -> Applied:
    """Draw a line on the floor, in metres."""
    _world(opened).draw(tuple(points), width, grey)
    return _publish(opened)


@world_act()
def erase(opened: OpenProgram, points: list[Point], width: Width = 0.06) -> Applied:
    """Paint with the floor's own grey."""
    _world(opened).erase(tuple(points), width)
    return _publish(opened)


@world_act()
def put_solid(
    opened: OpenProgram,
    index: int | None = None,
    box: Box | None = None,
    circle: Pose | None = None,
    angle: float = 0.0,
    push: float | None = None,
    name: str = "",
) -> Applied:
    """Add a solid, a `box` or a `circle`, or replace the one with this index."""
    solid = read_solid({"angle": angle, "push": push, "name": name} | _shape(box, circle), "solid")
    if index is None:
        return _edit(opened, PutSolid(solid))
    return _change(opened, partial(_world(opened).replace_solid, index, solid))


@world_act()
def remove_solid(opened: OpenProgram, index: Index) -> Applied:
    """Remove a solid."""
    return _edit(opened, RemoveSolid(index))


@world_act()
def put_zone(
    opened: OpenProgram, name: str, former: str = "", box: Box | None = None, circle: Pose | None = None
) -> Applied:
    """Add a zone, a `box` or a `circle`, or replace the one called `former`, by default of the same name."""
    return _edit(opened, PutZone(name.strip(), read_zone(_shape(box, circle), "zone"), former))


@world_act()
def remove_zone(opened: OpenProgram, name: str) -> Applied:
    """Remove a zone."""
    return _edit(opened, RemoveZone(name))


@world_act()
def set_start(opened: OpenProgram, index: Index, pose: Pose) -> Applied:
    """Set the pose in which a robot starts."""
    return _edit(opened, SetStart(pose, index))


@world_act()
def undo_world(opened: OpenProgram) -> Applied:
    """Undo the last edit of the world."""
    return _change(opened, _world(opened).undo_world)


@world_act()
def redo_world(opened: OpenProgram) -> Applied:
    """Redo the edit of the world that was undone last."""
    return _change(opened, _world(opened).redo_world)


def _shape(box: Box | None, circle: Pose | None) -> dict[str, Any]:
    return {name: shape for name, shape in (("box", box), ("circle", circle)) if shape is not None}


# -- worlds as files and pictures --------------------------------------------------------------------


@world_act()
def world(opened: OpenProgram, name: str) -> Applied:
    """Continue in another world: a bundled one, or that of a file."""
    return _change(opened, partial(_world(opened).load_world, name))


@world_act()
def world_text(opened: OpenProgram, text: str) -> Applied:
    """Continue in the world that a JSON text describes."""
    return _change(opened, partial(_world(opened).load_world, read_text(text, "The file")))


@question("exists")
def save_world(opened: OpenProgram, name: str, replace: bool) -> bool:
    """Write the world to a JSON file; return whether another file is there, and nothing was written."""
    file = Path(os.path.expanduser(name.strip()))
    if not file.name:
        raise LRPError("Enter a name for the file.")
    if file.suffix != ".json":
        file = file.with_name(f"{file.name}{WORLD_FILE}")
    if not replace and os.path.lexists(file):
        return True
    described = renamed(_world(opened).world, name=file.name.removesuffix(".json").removesuffix(".world"))
    write_file(file, described.to_json(indent=1) + "\n")
    return False


@question("svg")
def world_picture(opened: OpenProgram) -> str:
    """Draw the world as it is now."""
    bridge = _world(opened)
    picture: str = opened.session.call(lambda: svg(bridge.simulation))
    return picture


@question("svg")
def world_animation(opened: OpenProgram) -> str:
    """Draw how the world moved in what is remembered of the run."""
    _world(opened)
    return opened.session.animation()


def saved_worlds(folder: str | os.PathLike[str] = ".") -> list[str]:
    """Return the names of the files of a folder that the page offers as worlds."""
    try:
        return sorted(name for name in os.listdir(folder) if name.endswith(WORLD_FILE))
    except OSError:
        return []

"""What a page can do to the world of the simulated robot, and its questions for files and pictures of it."""

from __future__ import annotations

import os
from concurrent.futures import Future
from dataclasses import replace as renamed
from functools import partial, wraps
from pathlib import Path
from typing import Annotated, Any

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError, LRPError
from lrp_jupyter.files import write_file
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.sim.svg import svg
from lrp_jupyter.sim.world import Point, Pose
from lrp_jupyter.sim.world_edits import PutSolid, PutZone, RemoveSolid, RemoveZone, SetStart
from lrp_jupyter.sim.world_reading import read_solid, read_text, read_zone
from lrp_jupyter.sim.worlds import BUNDLED
from lrp_jupyter.widgets.acts.messages import Function, OpenProgram, act, question
from lrp_jupyter.widgets.wire.codec import Between

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


def world_act(function: Function) -> Function:
    """Register an act of a page on the world; it is carried out between two ticks, and then shown."""

    @wraps(function)
    def change(opened: OpenProgram, **given: Any) -> Future[Any]:
        return opened.session.ask(do.Call(partial(function, _world(opened), **given)))

    act(is_present=True, changes_world=True)(change)
    return function


# -- acts that a reset undoes ------------------------------------------------------------------------


@world_act
def drag_robot(bridge: SimBridge, index: Index, pose: Pose) -> None:
    """Move a robot; sent while it is dragged."""
    bridge.place_robot(pose, index)


@world_act
def drag_solid(bridge: SimBridge, index: Index, pose: Pose) -> None:
    """Move a solid; sent while it is dragged, before a `put_solid` at its new place."""
    bridge.place_solid(index, pose)


@world_act
def reset_pose(bridge: SimBridge, index: Index) -> None:
    """Return a robot to its start."""
    if index >= len(bridge.world.robots):
        raise BridgeError(f"There is no robot {index}.")
    bridge.place_robot(bridge.world.robots[index].pose, index)


@world_act
def reset_world(bridge: SimBridge, drawings: bool = False) -> None:
    """Reset the world to its start, without trails; with `drawings` also without edits."""
    bridge.reset_world(drawings)


# -- edits -------------------------------------------------------------------------------------------


@world_act
def stroke(bridge: SimBridge, points: list[Point], width: Width = 0.03, grey: Grey = 0) -> None:
    """Draw a line on the floor, in metres."""
    bridge.draw(tuple(points), width, grey)


@world_act
def erase(bridge: SimBridge, points: list[Point], width: Width = 0.06) -> None:
    """Paint with the floor's own grey."""
    bridge.erase(tuple(points), width)


@world_act
def put_solid(
    bridge: SimBridge,
    index: int | None = None,
    box: Box | None = None,
    circle: Pose | None = None,
    angle: float = 0.0,
    push: float | None = None,
    name: str = "",
) -> None:
    """Add a solid, a `box` or a `circle`, or replace the one with this index."""
    solid = read_solid({"angle": angle, "push": push, "name": name} | _shape(box, circle), "solid")
    if index is None:
        bridge.edit_world(PutSolid(solid))
    else:
        bridge.replace_solid(index, solid)


@world_act
def remove_solid(bridge: SimBridge, index: Index) -> None:
    """Remove a solid."""
    bridge.edit_world(RemoveSolid(index))


@world_act
def put_zone(
    bridge: SimBridge, name: str, former: str = "", box: Box | None = None, circle: Pose | None = None
) -> None:
    """Add a zone, a `box` or a `circle`, or replace the one called `former`, by default of the same name."""
    bridge.edit_world(PutZone(name.strip(), read_zone(_shape(box, circle), "zone"), former))


@world_act
def remove_zone(bridge: SimBridge, name: str) -> None:
    """Remove a zone."""
    bridge.edit_world(RemoveZone(name))


@world_act
def set_start(bridge: SimBridge, index: Index, pose: Pose) -> None:
    """Set the pose in which a robot starts."""
    bridge.edit_world(SetStart(pose, index))


@world_act
def undo_world(bridge: SimBridge) -> None:
    """Undo the last edit of the world."""
    bridge.undo_world()


@world_act
def redo_world(bridge: SimBridge) -> None:
    """Redo the edit of the world that was undone last."""
    bridge.redo_world()


def _shape(box: Box | None, circle: Pose | None) -> dict[str, Any]:
    return {name: shape for name, shape in (("box", box), ("circle", circle)) if shape is not None}


# -- worlds as files and pictures --------------------------------------------------------------------


@world_act
def world(bridge: SimBridge, name: str) -> None:
    """Continue in another world: a bundled one, or that of a file."""
    bridge.load_world(name)


@world_act
def world_text(bridge: SimBridge, text: str) -> None:
    """Continue in the world that a JSON text describes."""
    bridge.load_world(read_text(text, "The file"))


@question("exists", only_looks=False)
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
    return opened.session.call(lambda: svg(bridge.simulation))


@question("svg")
def world_animation(opened: OpenProgram) -> str:
    """Draw the motion in the world over the remembered part of the run."""
    _world(opened)
    return opened.session.animation()


@question("worlds")
def worlds(opened: OpenProgram) -> list[str]:
    """List the worlds that there are to choose from now."""
    return offered_worlds()


def offered_worlds() -> list[str]:
    """Return the names of the bundled worlds, and of the files with worlds in the current folder."""
    try:
        saved = sorted(name for name in os.listdir() if name.endswith(WORLD_FILE))
    except OSError:
        saved = []
    return [*BUNDLED, *saved]

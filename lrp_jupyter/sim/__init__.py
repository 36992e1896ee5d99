"""The simulated robot: a two-dimensional world seen from above, on pymunk.

Knows nothing of LRP. :class:`World` describes, :func:`load` finds, :class:`Simulation` runs. Worlds, and what
is done to them, are plain values; pymunk is imported when one runs.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from lrp_jupyter.sim.world import World, WorldError
from lrp_jupyter.sim.world_edits import Draw, PutSolid, PutZone, RemoveSolid, RemoveZone, SetStart, WorldEdit
from lrp_jupyter.sim.world_inputs import (
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
)
from lrp_jupyter.sim.worlds import BUNDLED, load

if TYPE_CHECKING:
    from lrp_jupyter.sim.sensors import Readings as Readings
    from lrp_jupyter.sim.simulation import STEP as STEP
    from lrp_jupyter.sim.simulation import Simulation as Simulation
    from lrp_jupyter.sim.simulation import WorldMoment as WorldMoment

__all__ = [
    "BUNDLED",
    "STEP",
    "Cancel",
    "Draw",
    "Drive",
    "DriveBy",
    "DriveTo",
    "Input",
    "Lamp",
    "Latch",
    "Pen",
    "PlaceRobot",
    "PlaceSolid",
    "PutSolid",
    "PutZone",
    "Readings",
    "RemoveSolid",
    "RemoveZone",
    "ResetWorld",
    "Say",
    "SetStart",
    "Simulation",
    "TurnBy",
    "World",
    "WorldEdit",
    "WorldError",
    "WorldMoment",
    "load",
]

_RUNS = {"Readings": "sensors", "STEP": "simulation", "Simulation": "simulation", "WorldMoment": "simulation"}


def __getattr__(name: str) -> Any:
    if name not in _RUNS:
        raise AttributeError(f"module `{__name__}` has no attribute `{name}`")
    return getattr(import_module(f"{__name__}.{_RUNS[name]}"), name)

"""The simulated robot: a two-dimensional world seen from above, on pymunk.

Knows nothing of LRP. :class:`World` describes, :func:`load` finds, :class:`Simulation` runs.
"""

from lrp_jupyter.sim.edits import Draw, PutSolid, PutZone, RemoveSolid, RemoveZone, SetStart, WorldEdit
from lrp_jupyter.sim.inputs import Drive, Input, Latch, Pen, PlaceRobot, PlaceSolid, ResetWorld
from lrp_jupyter.sim.sensors import Readings
from lrp_jupyter.sim.simulation import STEP, Simulation, WorldMoment
from lrp_jupyter.sim.world import World, WorldError
from lrp_jupyter.sim.worlds import BUNDLED, load

__all__ = [
    "BUNDLED",
    "STEP",
    "Draw",
    "Drive",
    "Input",
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
    "SetStart",
    "Simulation",
    "World",
    "WorldEdit",
    "WorldError",
    "WorldMoment",
    "load",
]

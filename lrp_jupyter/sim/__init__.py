"""The simulated robot: a two-dimensional world seen from above, on pymunk.

Knows nothing of LRP. :class:`World` describes, :func:`load` finds, :class:`Simulation` runs.
"""

from lrp_jupyter.sim.inputs import Draw, Drive, Input, Latch, Pen, PlaceRobot, PlaceSolid, Reset
from lrp_jupyter.sim.sensors import Readings
from lrp_jupyter.sim.simulation import STEP, Moment, Simulation
from lrp_jupyter.sim.world import World, WorldError
from lrp_jupyter.sim.worlds import BUNDLED, load

__all__ = [
    "BUNDLED",
    "STEP",
    "Draw",
    "Drive",
    "Input",
    "Latch",
    "Moment",
    "Pen",
    "PlaceRobot",
    "PlaceSolid",
    "Readings",
    "Reset",
    "Simulation",
    "World",
    "WorldError",
    "load",
]

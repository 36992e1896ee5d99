"""Nested machines drawn inside their state: beside each other, below its name.

Paper: §3.1, the figures that show a machine inside a state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from lrp_jupyter.graph.geometry import Point, Rect
from lrp_jupyter.graph.layout_parts import Inside, Layout

NAME = 26.0  # px: height of the state's name, above the machines
BORDER = 8.0  # px: room around the machines and between them


@dataclass(frozen=True)
class Nested:
    """Machines inside one state, whose size is `width` by `height` px."""

    layouts: Sequence[Layout]  # at least one
    width: float
    height: float
    centre: Point  # px: of that state, in the coordinates of the first machine

    def placed(self, box: Rect) -> list[Inside]:
        """Return where each machine is drawn in a state of this size or a wider one."""
        shapes = []
        across = -self.width / 2 + BORDER
        for drawing in self.layouts:
            left, top, width, _ = drawing["view"]
            x, y = across - left, NAME - box.height / 2 - top
            shapes.append(Inside(machine=drawing["machine"], x=round(x, 1), y=round(y, 1)))
            across += width + BORDER
        return shapes


def beside_each_other(layouts: Sequence[Layout], below: float = 0.0) -> Nested | None:
    """Return the arrangement of some machines in their state; None if there are none.

    `below`: height of what is below them in the state, px.
    """
    if not layouts:
        return None
    width = sum(drawing["view"][2] + BORDER for drawing in layouts) + BORDER
    height = NAME + max(drawing["view"][3] for drawing in layouts) + BORDER + below
    left, top = layouts[0]["view"][:2]
    centre = (round(left - BORDER + width / 2, 1), round(top - NAME + height / 2, 1))
    return Nested(layouts, width, height, centre)

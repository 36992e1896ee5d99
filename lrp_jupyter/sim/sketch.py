"""A map of a world in characters, for terminals."""

from __future__ import annotations

import math

from lrp_jupyter.sim.sim_robot import SimSolid
from lrp_jupyter.sim.simulation import Simulation
from lrp_jupyter.sim.world import BoxSolid, Solid, World

_ARROWS = "→↗↑↖←↙↓↘"
_DARK = 160  # greys below this are a line
_GRAIN = 0.025  # m: distance between samples of the floor, a little less than the width of a line


def sketch(world: Simulation | World, columns: int = 60, rows: int = 0) -> list[str]:
    """Return a map of a world, a string for each row.

    ``#`` is a solid, ``▒`` one that can be pushed, ``▓`` one that moves by itself, ``·`` line on the floor,
    an arrow a robot with its heading, ``*`` a robot whose bumper is pressed.

    `columns`, `rows`: size in characters; ``rows=0`` keeps the shape, with characters twice as high as wide.
    """
    simulation = world if isinstance(world, Simulation) else Simulation(world)
    length, depth = simulation.world.size
    columns = max(1, columns)
    rows = rows if rows > 0 else max(1, round(columns * depth / length / 2))
    cell_x, cell_y = length / columns, depth / rows
    picture = [["·" if dark else " " for dark in row] for row in _lines(simulation, columns, rows)]
    cell = (cell_x, cell_y)
    for thing in simulation.solids:
        (x, y, _), spec = thing.pose, thing.spec
        sign = "▓" if spec.patrol is not None else "#" if spec.push is None else "▒"
        reach = _reach(spec) + max(cell) / 2
        for row in range(max(0, math.floor((depth - y - reach) / cell_y)), rows):
            up = (rows - row - 0.5) * cell_y
            if up < y - reach:
                break
            for column in range(max(0, math.floor((x - reach) / cell_x)), columns):
                across = (column + 0.5) * cell_x
                if across > x + reach:
                    break
                if _covers(thing, across, up, cell):
                    picture[row][column] = sign
    for robot in simulation.robots:
        x, y, heading = robot.pose
        row, column = rows - 1 - math.floor(y / cell_y), math.floor(x / cell_x)
        if 0 <= row < rows and 0 <= column < columns:
            arrow = _ARROWS[round(heading / (math.pi / 4)) % 8]
            picture[row][column] = "*" if robot.readings.bumper else arrow
    return ["".join(row) for row in picture]


def _lines(simulation: Simulation, columns: int, rows: int) -> list[list[bool]]:
    """Return which cells of the floor are dark; cached with the floor until something is drawn."""
    floor = simulation.floor
    key = (columns, rows, len(floor.marks))
    if floor.raster is None or floor.raster[0] != key:
        length, depth = simulation.world.size
        cell_x, cell_y = length / columns, depth / rows
        across, up = _samples(cell_x), _samples(cell_y)
        dark = [
            [
                any(
                    floor.light(column * cell_x + dx, (rows - 1 - row) * cell_y + dy) < _DARK
                    for dx in across
                    for dy in up
                )
                for column in range(columns)
            ]
            for row in range(rows)
        ]
        floor.raster = (key, dark)
    return floor.raster[1]


def _samples(cell: float) -> list[float]:
    count = math.ceil(cell / _GRAIN)
    return [(index + 0.5) * cell / count for index in range(count)]


def _reach(solid: Solid) -> float:
    return math.hypot(*solid.box[2:]) / 2 if isinstance(solid, BoxSolid) else solid.circle[2]


def _covers(thing: SimSolid, x: float, y: float, cell: tuple[float, float]) -> bool:
    """Return whether a solid covers the middle of a character's cell, however thin it is."""
    centre_x, centre_y, angle = thing.pose
    x, y = x - centre_x, y - centre_y
    half_x, half_y = 0.49 * cell[0], 0.49 * cell[1]
    if not isinstance(thing.spec, BoxSolid):
        return math.hypot(x, y) <= thing.spec.circle[2] + min(half_x, half_y)
    cos, sin = math.cos(angle), math.sin(angle)
    _, _, width, height = thing.spec.box
    wide = width / 2 + abs(cos) * half_x + abs(sin) * half_y
    high = height / 2 + abs(sin) * half_x + abs(cos) * half_y
    return abs(cos * x + sin * y) <= wide and abs(cos * y - sin * x) <= high

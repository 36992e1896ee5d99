"""The map of a world in a terminal: the sketch of the simulator, framed and coloured."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rich.text import Text

if TYPE_CHECKING:
    from lrp_jupyter.sim.simulation import Simulation

_STYLES = {"#": "bright_black", "▒": "yellow", "·": "blue", ".": "magenta", "*": "bold red"} | dict.fromkeys(
    "→↗↑↖←↙↓↘", "bold green"
)


def framed(rows: Iterable[str]) -> list[Text]:
    """Return a sketch with colours and a frame for the edge of the world."""
    rows = list(rows)
    width = max(map(len, rows), default=0)
    return [
        Text("┌" + "─" * width + "┐", "bright_black"),
        *(Text.assemble(("│", "bright_black"), _coloured(row), ("│", "bright_black")) for row in rows),
        Text("└" + "─" * width + "┘", "bright_black"),
    ]


def _coloured(row: str) -> Text:
    text = Text(row)
    for place, character in enumerate(row):
        if (style := _STYLES.get(character)) is not None:
            text.stylize(style, place, place + 1)
    return text


def columns_for(size: tuple[float, float], columns: int, rows: int) -> int:
    """Return the greatest width of a sketch, in characters, that fits into `columns` x `rows`."""
    length, depth = size
    return max(1, min(columns, int(2 * rows * length / depth)))


class Map:
    """A sketch of a running world, with the trails of its robots (``.``); for the thread that advances it."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._seen = 0  # marks on the floor already drawn
        self._columns = 0
        self._trail: set[tuple[int, int]] = set()  # row, column

    @property
    def size(self) -> tuple[float, float]:
        """Length and depth of the world, in metres."""
        return self._simulation.world.size

    def draw(self, columns: int) -> list[str]:
        """Return the rows of the map as it is now."""
        from lrp_jupyter.sim.sketch import sketch

        rows = sketch(self._simulation, columns)
        marks = self._simulation.floor.marks
        if columns != self._columns or len(marks) < self._seen:
            self._columns, self._seen, self._trail = columns, 0, set()
        length, depth = self._simulation.world.size
        for _, paint, piece in marks[self._seen :]:
            if paint.ink:
                row = int((depth - piece.y) / depth * len(rows))
                self._trail.add((row, int(piece.x / length * columns)))
        self._seen = len(marks)
        cells = [list(row) for row in rows]
        for row, column in self._trail:
            if 0 <= row < len(cells) and 0 <= column < columns and cells[row][column] == " ":
                cells[row][column] = "."
        return ["".join(row) for row in cells]

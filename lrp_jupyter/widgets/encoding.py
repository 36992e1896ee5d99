"""Places and poses as the wire has them."""

from __future__ import annotations

import struct
from bisect import bisect_right
from collections.abc import Iterable, Sequence

from lrp_jupyter.language.program import line_starts
from lrp_jupyter.widgets.nouns import Range

__all__ = ["offset_of", "pack_poses", "range_of"]


def range_of(text: str, start: int, end: int) -> Range:
    """Turn the characters ``text[start:end]`` into lines and columns."""
    starts = line_starts(text)
    line, end_line = bisect_right(starts, start), bisect_right(starts, end)
    return {
        "line": line,
        "column": start - starts[line - 1] + 1,
        "end_line": end_line,
        "end_column": end - starts[end_line - 1] + 1,
    }


def offset_of(text: str, line: int, column: int) -> int:
    """Turn a line and a column into a character offset; what lies outside the text becomes its end."""
    starts = line_starts(text)
    if line > len(starts):
        return len(text)
    return min(starts[line - 1] + column - 1, len(text))


def pack_poses(
    time: float,
    robots: Iterable[tuple[float, float, float, bool, bool, float, Sequence[float], Sequence[float]]],
    solids: Iterable[tuple[float, float, float]] = (),
) -> bytes:
    """Write the buffer of a `Frame` message.

    Little endian: the world's time as float64, then float32: for each robot x, y (m), theta (rad), flags,
    speed (m/s), its light values, its distances (m, inf for nothing); then for each solid with `push`, in
    the order of the world, x, y, theta. How many there are the page knows from the world.

    Parameters
    ----------
    time : float
        Seconds of the world.
    robots : iterable of tuple
        ``(x, y, theta, bumper, pen, speed, lights, distances)`` for each robot.
    solids : iterable of tuple
        ``(x, y, theta)`` of each solid that can be pushed.
    """
    numbers: list[float] = []
    for x, y, theta, bumper, pen, speed, lights, distances in robots:
        numbers += [x, y, theta, float(bumper | pen << 1), speed, *lights, *distances]
    for solid in solids:
        numbers += solid
    return struct.pack(f"<d{len(numbers)}f", time, *numbers)

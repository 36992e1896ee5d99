"""How wide a text will be, without a font at hand.

The widths are those of DejaVu Sans, wider than the fonts that most systems choose: a text never
needs more room than estimated here.
"""

from __future__ import annotations

import unicodedata

__all__ = ["shorten", "text_width"]

_WIDTHS = {  # in thousandths of the font size
    300: "ijlIJ'",
    330: " !,./:;\\|f",
    410: '()[]-rt"`',
    530: "?_^*s",
    590: "Fcvxyzk",
    640: "abdeghnopquLEPTY0123456789${}",
    700: "ABCKSVXZR",
    790: "DGHNOQUw+<=>~&#",
    870: "M",
    990: "mW%@",
}
_WIDTH = {character: width for width, characters in _WIDTHS.items() for character in characters}
ELLIPSIS = "…"


def text_width(text: str, size: float) -> float:
    """Estimate the width of a line of text.

    Parameters
    ----------
    text : str
    size : float
        Font size in px.

    Returns
    -------
    float
        Width in px.
    """
    return sum(map(_character_width, text)) * size / 1000


def _character_width(character: str) -> int:
    known = _WIDTH.get(character)
    if known is not None:
        return known
    if unicodedata.combining(character):
        return 0
    return 1000 if unicodedata.east_asian_width(character) in "WF" else 790


def shorten(text: str, size: float, width: float) -> str:
    """Return the text in one line; if it is wider than `width` px its end becomes an ellipsis."""
    line = " ".join(text.split())
    if text_width(line, size) <= width:
        return line
    room = width - text_width(ELLIPSIS, size)
    end = 0
    while room > 0 and end < len(line):
        room -= text_width(line[end], size)
        end += room >= 0
    return line[:end].rstrip() + ELLIPSIS

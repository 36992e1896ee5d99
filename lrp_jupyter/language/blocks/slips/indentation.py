"""Lines that begin in the wrong column."""

from __future__ import annotations

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.slips.code import Guess, Guesses, PythonToken, WrongBlock
from lrp_jupyter.language.blocks.slips.wordings import PARTNERS

_Margin = tuple[int, str, PythonToken, PythonToken]
"""The offset of a line, the white space at its beginning, its first token and its last."""


def indentation(code: WrongBlock) -> Guesses:
    """Lines that begin in the wrong column; of several remedies, the smallest move."""
    lines = [(code.tokens[line[0]], code.tokens[line[-1]]) for line in code.lines()]
    margins: list[_Margin] = []
    for head, last in lines:
        start = code.starts[min(head.line, len(code.starts) - 1)]
        white = code.text[start : head.start] if head.line else " " * code.column
        margins.append((start, white, head, last))
    tabs = [row for row in margins if "\t" in row[1] and row[2].line]
    if tabs and ("tab" in code.problem or "indent" in code.problem):
        yield from _tabs(code, tabs)
    here = [head.text for head, _ in lines if head.line == code.at]
    if "indent" not in code.problem and not PARTNERS.keys() & here:
        return
    around = [row for row in range(len(margins)) if abs(margins[row][2].line - code.at) <= 6]
    first = next((row for row in around if margins[row][2].line >= code.at), len(margins) - 1)
    widths = {len(white) for _, white, head, _ in margins if head.line or code.column}
    moves: list[tuple[tuple[int, int, int], Guess]] = []
    for row in around:
        start, white, head, _ = margins[row]
        if head.line == 0:
            continue
        wanted = set(widths)
        if row:
            outer = len(margins[row - 1][1])
            if margins[row - 1][3].text == ":":
                wanted |= {outer + 2, outer + 4}
            following = [len(each[1]) for each in margins[row + 1 : row + 2]]
            if margins[row - 1][3].text == ":" and following and following[0] > outer:
                wanted = {following[0]}
        for width in wanted - {len(white)}:
            edit = Edit(start, start + len(white), " " * width)
            if row and margins[row - 1][3].text == ":" and width > len(white):
                keyword = margins[row - 1][2].text
                message = f"This line belongs to the `{keyword}` above. Start it further right."
            else:
                side = "right" if width < len(white) else "left"
                message = f"This line begins too far {side}. Move it {_columns(width - len(white))}."
            rank = (abs(row - first), abs(width - len(white)), -width)
            moves.append((rank, Guess("LRP515", message, head.start, head.end, (edit,))))
    ranks = [rank[:2] for rank, _ in moves]
    for rank, fault in sorted(moves, key=lambda move: move[0]):
        if ranks.count(rank[:2]) > 1:  # as far from one line above as from another
            message = "This line begins between two others. Start it below the line to which it belongs."
            fault = fault._replace(message=message, is_certain=False)
        yield fault


def _tabs(code: WrongBlock, tabs: list[_Margin]) -> Guesses:
    message = "This line begins with tabs and spaces. Use spaces only."
    for size in (8, 4, 2):
        edits = tuple(Edit(start, start + len(white), white.expandtabs(size)) for start, white, _, _ in tabs)
        head = tabs[0][2]
        yield Guess("LRP515", message, head.start, head.end, edits)


def _columns(change: int) -> str:
    columns = "column" if abs(change) == 1 else "columns"
    return f"{abs(change)} {columns} to the {'right' if change > 0 else 'left'}"

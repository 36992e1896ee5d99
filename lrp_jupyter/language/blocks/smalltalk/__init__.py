"""Smalltalk in a block: the programs of the paper, and of whoever copies from it.

The paper's blocks hold Smalltalk, which Python rejects at its second word, with an error for each sign that
it does not know. So a block that Python rejects is read once more, as Smalltalk. If all of it can be read so,
and something in it is nothing but Smalltalk, that is its one error, with the same in Python.

Paper: §3.2, §7.1, §7.2.
"""

from __future__ import annotations

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.smalltalk.syntax import read
from lrp_jupyter.language.blocks.smalltalk.translation import UntranslatableError, written
from lrp_jupyter.language.python.block_suite import parse_block
from lrp_jupyter.language.python.scanner import LINE_END
from lrp_jupyter.language.source import Diagnosis

__all__ = ["smalltalk"]

_SHOWN = 90
"""Characters of a translation that a message shows."""


def smalltalk(text: str, column: int = 0, is_condition: bool = False) -> Diagnosis | None:
    """Return the one error of a block in Smalltalk that begins in a column, from 0; None for any other."""
    found = read(text)
    if found is None:
        return None
    start, end = found.start, found.end
    *above, before = LINE_END.split(text[:start])
    try:
        python, is_certain = written(found, text, len(before) + (0 if above else column), is_condition)
        parse_block(f"{text[:start]}{python}{text[end:]}")
    except (UntranslatableError, SyntaxError):
        message = "This is Smalltalk. Write it in Python, as in `robot.move(linear=0.2)`."
        return Diagnosis(start, end, "LRP519", message)
    lines = map(str.strip, python.replace("`", "'").split("\n"))
    code = [line for line in lines if not line.startswith("#")]
    shown = code[0] if len(code) == 1 else f"{code[0]} …"
    shown = shown if len(shown) <= _SHOWN else f"{shown[: _SHOWN - 1]}…"
    message = f"This is Smalltalk. In Python{'' if is_certain else ', probably'}: `{shown}`."
    return Diagnosis(start, end, "LRP519", message, (Edit(start, end, python),) if is_certain else ())

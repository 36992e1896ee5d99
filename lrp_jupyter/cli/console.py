"""What the commands print: texts of strangers are in it, and none of them commands the terminal.

Names of files, messages of programs and what these print are shown with the number of every character that a
terminal obeys. Whatever else is printed, such as an error of the command line, passes `Colours`.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from typing import Any, TextIO

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from lrp_jupyter.errors import printable

_HARMLESS = re.compile(r"(\r?\n|\t|\x1b\[[\d;]*m|\x1b\(B)")  # line ends, and colours


def plain_console(stderr: bool = False, soft_wrap: bool = True) -> Console:
    """Return a console that prints text as it is: no markup and, by default, no wrapping."""
    return _Console(
        file=getattr(sys.stderr if stderr else sys.stdout, "terminal", None),
        stderr=stderr,
        markup=False,
        emoji=False,
        highlight=False,
        soft_wrap=soft_wrap,
    )


class _Console(Console):
    """A console on which only its own styles and movements command the terminal."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text, "\n\t"))


class Colours:
    """A stream to a terminal that lets through text and its colours."""

    def __init__(self, terminal: TextIO) -> None:
        self.terminal = terminal

    def write(self, text: str) -> int:
        """Write a text."""
        parts = _HARMLESS.split(text)
        parts[::2] = map(printable, parts[::2])
        self.terminal.write("".join(parts))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Write several texts."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.terminal, name)

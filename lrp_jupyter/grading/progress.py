"""How far a batch of runs is: a bar on a terminal and in a notebook, else a line for each tenth on stderr."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console


@contextmanager
def shown_progress(what: str, lines: bool = False) -> Iterator[Callable[[int, int], object]]:
    """Yield a function that shows how many runs of how many are done.

    `what`: what is being done: ``grading``.
    `lines`: whether lines are printed where there can be no bar.
    """
    if sys.platform == "emscripten":  # without rich, and nothing is shown before the batch ends
        yield lambda done, of: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    terminal = getattr(sys.stderr, "terminal", None)  # where this is a stream that only prints
    console = Console(file=terminal, stderr=True, markup=False, emoji=False, highlight=False, soft_wrap=True)
    if not (console.is_terminal or console.is_jupyter):
        yield _Lines(console, what) if lines else lambda done, of: None
        return
    columns = (TextColumn(what), BarColumn(), MofNCompleteColumn(), TextColumn("runs"), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, of: bar.update(task, completed=done, total=of)


class _Lines:
    """Prints a line for each tenth."""

    def __init__(self, console: Console, what: str) -> None:
        self._console, self._what, self._tenth = console, what, 0

    def __call__(self, done: int, of: int) -> None:
        tenth = 10 * done // of if of else 0
        if tenth > self._tenth:
            self._tenth = tenth
            self._console.print(f"{self._what}: {done} of {of} runs")

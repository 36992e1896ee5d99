"""How far a batch of runs is: a bar on a terminal, else a line for each tenth; always on stderr."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

__all__ = ["shown_progress"]


@contextmanager
def shown_progress(what: str) -> Iterator[Callable[[int, int], None]]:
    """Yield a function that shows how many runs of how many are done."""
    console = Console(stderr=True, markup=False, emoji=False, highlight=False, soft_wrap=True)
    if not console.is_terminal:
        yield _Lines(console, what)
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

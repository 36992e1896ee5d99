"""Stepping back: inverse records at the few places that mutate a run.

One entry per tick, holding what undoes it in reverse; nothing in it when nothing changed. What
happens between two ticks (an edit, a forced state) is rare and takes a whole snapshot. Objects
changed in place are not recorded: exact replay is a new run from recorded inputs.
"""

from __future__ import annotations

from collections import deque
from types import CellType
from typing import TYPE_CHECKING, Any

from lrp_jupyter.interpreter.events import UNSET
from lrp_jupyter.interpreter.tree import Activation, content

if TYPE_CHECKING:
    from lrp_jupyter.interpreter.run import Run

__all__ = ["Journal"]


Record = tuple[Any, ...]
"""``(activation, state, entered, children)`` or ``(cell, value)`` before, or ``(snapshot,)``."""


EDITS = 300
"""Snapshots that are kept: each holds on to a whole program, and people type for hours."""


class Journal:
    """Whole ticks, the last `bound` of them, and no more than the last :data:`EDITS` with a snapshot.

    ``log`` collects what was done since the end of the last tick, whose time is `now`; at the end of
    a tick it is closed together with that time.
    """

    def __init__(self, bound: int) -> None:
        self._entries: deque[tuple[float, list[Record]]] = deque(maxlen=bound)
        self.log: list[Record] = []
        self.now = 0.0
        self._closed = 0
        self._snapshots: deque[int] = deque()  # numbers of the entries that hold one
        self._has_snapshot = False

    def __len__(self) -> int:
        """How many ticks can be undone."""
        return len(self._entries)

    def remember(self, run: Run) -> None:
        """Remember everything, before a change that is not one of a tick."""
        if not any(isinstance(record[0], Snapshot) for record in self.log):  # one undoes all that follows
            self.log.append((Snapshot(run),))
            self._has_snapshot = True

    def close(self, now: float) -> None:
        """End a tick."""
        self._entries.append((self.now, self.log))
        self.log = []
        self.now = now
        self._closed += 1
        if self._has_snapshot:
            self._has_snapshot = False
            self._snapshots.append(self._closed)
            if len(self._snapshots) > EDITS:
                kept = self._closed - self._snapshots.popleft()
                while len(self._entries) > kept:
                    self._entries.popleft()

    def undo(self, run: Run, ticks: int) -> None:
        """Undo what came after the last tick, then `ticks` ticks, then what came before those.

        Raises
        ------
        ValueError
            If the journal does not reach back so far.
        """
        if not 0 <= ticks <= len(self._entries):
            have = len(self._entries)
            raise ValueError(f"the journal holds {have} ticks: cannot go back {ticks}")
        self._undo_log(run)
        for _ in range(ticks):
            self.now, self.log = self._entries.pop()
            run.ticks -= 1
            self._closed -= 1
            while self._snapshots and self._snapshots[-1] > self._closed:
                self._snapshots.pop()
            self._undo_log(run)
        run.now = self.now
        run.live = {(): run.globals, **{act.machine.path: act for root in run.roots for act in root.walk()}}
        for scope in run.live.values():
            scope.sync()

    def _undo_log(self, run: Run) -> None:
        for what, *before in reversed(self.log):
            if isinstance(what, Activation):
                what.state, what.entered, what.children = before
            elif isinstance(what, Snapshot):
                what.restore(run)
            else:
                put(what, before[0])
        self.log = []
        self._has_snapshot = False


def put(cell: CellType, value: object) -> None:
    """Put a value into a cell, or empty it."""
    if value is not UNSET:
        cell.cell_contents = value
    elif content(cell) is not UNSET:
        del cell.cell_contents


FIELDS = ("machine", "path", "outer", "spawn", "cells", "state", "entered", "children")


class Snapshot:
    """A whole run: the plan, the tree of activations and every variable."""

    __slots__ = ("_acts", "_globals", "_run", "_values")

    def __init__(self, run: Run) -> None:
        self._run = (run.plan, run.roots, run.pending, run.started)
        self._globals = (run.globals, dict(run.globals.own), run.globals.cells)
        self._acts = [
            (act, {name: getattr(act, name) for name in FIELDS} | {"own": dict(act.own)})
            for root in run.roots
            for act in root.walk()
        ]
        scopes = (run.globals, *(act for act, _ in self._acts))
        self._values = [(cell, content(cell)) for scope in scopes for cell in scope.own.values()]

    def restore(self, run: Run) -> None:
        """Put everything back."""
        run.plan, run.roots, run.pending, run.started = self._run
        run.globals, run.globals.own, run.globals.cells = self._globals
        for act, fields in self._acts:
            for name, value in fields.items():
                setattr(act, name, value)
        for cell, value in self._values:
            put(cell, value)

"""Stepping back: inverse records at the few places that mutate a run.

One entry per tick, holding what undoes it in reverse; nothing in it when nothing changed. What
happens between two ticks (an edit, a forced state) is rare and takes a whole snapshot. Objects
changed in place are not recorded: exact replay is a new run from recorded inputs.
"""

from __future__ import annotations

from collections import deque
from types import CellType
from typing import TYPE_CHECKING

from lrp_jupyter.interpreter.events import UNSET
from lrp_jupyter.interpreter.tree import Activation, content

if TYPE_CHECKING:
    from lrp_jupyter.interpreter.linker import StatePlan
    from lrp_jupyter.interpreter.run import Run

__all__ = ["Journal"]


class Journal:
    """Whole ticks, the last `bound` of them.

    ``log`` collects what was done since the end of the last tick; at the end of a tick it is
    closed together with the time at which the tick before ended.
    """

    def __init__(self, bound: int) -> None:
        self._entries: deque[tuple[float, list[Record]]] = deque(maxlen=bound)
        self._log: list[Record] = []

    def __len__(self) -> int:
        """How many ticks can be undone."""
        return len(self._entries)

    def note(self, act: Activation) -> None:
        """Remember an activation before its active state or its children change."""
        self._log.append(ActivationRecord(act))

    def note_cell(self, cell: CellType, old: object) -> None:
        """Remember what a cell held."""
        self._log.append(CellRecord(cell, old))

    def remember(self, run: Run) -> None:
        """Remember everything, before a change that is not one of a tick."""
        self._log.append(Snapshot(run))

    def close(self, before: float) -> None:
        """End a tick; `before` is the time of the one before it."""
        self._entries.append((before, self._log))
        self._log = []

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
            run.now, self._log = self._entries.pop()
            run.ticks -= 1
            self._undo_log(run)

    def _undo_log(self, run: Run) -> None:
        for record in reversed(self._log):
            record.undo(run)
        self._log = []


class ActivationRecord:
    """Active state, time of entry and children of one activation."""

    __slots__ = ("_act", "_children", "_entered", "_state")

    def __init__(self, act: Activation) -> None:
        self._act = act
        self._state: StatePlan = act.state
        self._entered = act.entered
        self._children = act.children

    def undo(self, run: Run) -> None:
        """Put them back."""
        act = self._act
        act.state, act.entered, act.children = self._state, self._entered, self._children


class CellRecord:
    """What one variable held."""

    __slots__ = ("_cell", "_old")

    def __init__(self, cell: CellType, old: object) -> None:
        self._cell = cell
        self._old = old

    def undo(self, run: Run) -> None:
        """Put it back."""
        if self._old is not UNSET:
            self._cell.cell_contents = self._old
        elif content(self._cell) is not UNSET:
            del self._cell.cell_contents


class Snapshot:
    """A whole run: the plan, the tree of activations and every variable."""

    __slots__ = ("_acts", "_globals", "_run", "_values")

    def __init__(self, run: Run) -> None:
        self._run = (run.plan, run.roots, run.pending, run.started)
        self._globals = (run.globals, dict(run.globals.own), run.globals.cells)
        acts = [act for root in run.roots for act in root.walk()]
        self._acts = [
            (
                ActivationRecord(act),
                act,
                (act.machine, act.path, act.outer, act.spawn, dict(act.own), act.cells),
            )
            for act in acts
        ]
        self._values = [
            CellRecord(cell, content(cell))
            for scope in (run.globals, *acts)
            for cell in scope.own.values()
        ]

    def undo(self, run: Run) -> None:
        """Put everything back."""
        run.plan, run.roots, run.pending, run.started = self._run
        run.globals, run.globals.own, run.globals.cells = self._globals
        for record, act, fields in self._acts:
            record.undo(run)
            act.machine, act.path, act.outer, act.spawn, act.own, act.cells = fields
        for value in self._values:
            value.undo(run)


Record = ActivationRecord | CellRecord | Snapshot

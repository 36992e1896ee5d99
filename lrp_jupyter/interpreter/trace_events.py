"""Trace events: one small frozen value for each thing that happens in a run."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from lrp_jupyter.language.program import Path

EVENT_KINDS = (
    "started",
    "entered",
    "left",
    "fired",
    "spawned",
    "discarded",
    "changed",
    "issue",
    "patched",
    "restarted",
    "forced",
    "paused",
    "resumed",
    "ended",
    "commanded",
    "task",
    "printed",
)


class _Unset:
    def __repr__(self) -> str:
        return "<unset>"


UNSET = _Unset()  # stands for the missing value of a variable


class TraceEvent(NamedTuple):
    """One event of a run.

    `kind`: one of :data:`EVENT_KINDS`.
    `path`: the element, as spawned: a state (entered, left, forced), a machine (spawned, discarded), a
        transition (fired: the machine's path and the id), a variable (changed); empty for the program as a
        whole.
    `tick`: the tick in which it happened; the first is 1. Between two ticks, the last one.
    `now`: seconds.
    `data`: fired: a ``Fired`` fact; changed: the new value, which is not a copy, or :data:`UNSET`; issue: the
        :class:`Issue`; patched: the :class:`Patch`; restarted: the reason, a sentence; forced:
        ``"transition"``, ``"teleport"`` or ``"fire"``; commanded: the command of the robot; task: its name
        and its new state; printed: the text; else None.
    """

    kind: str
    path: Path
    tick: int
    now: float
    data: object = None


Observer = Callable[[TraceEvent], None]

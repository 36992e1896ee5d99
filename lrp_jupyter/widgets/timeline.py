"""The messages of the timeline: what happened, looking at an earlier moment, running on from there, what if."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from lrp_jupyter.widgets.commands import Applied, InterruptingCommand
from lrp_jupyter.widgets.messages import OpenProgram, PageCommand, PageRequest

__all__ = ["LookCommand", "RunFromCommand", "TimelineRequest", "WhatIfRequest"]


@dataclass(frozen=True)
class TimelineRequest(PageRequest, type="timeline"):
    """Ask what happened since a tick that the page knows, in the run of this `epoch`, 0 for none.

    `plots` are the names to plot, such as ``robot.light.data`` or ``follower/lightlim``, each with the tick up
    to which the page has its samples. Answered by `timeline`.
    """

    epoch: int
    tick: int
    plots: dict[str, int] = field(default_factory=dict)

    def answer(self, opened: OpenProgram) -> Mapping[str, Any]:
        """Return what happened."""
        raise NotImplementedError


@dataclass(frozen=True)
class LookCommand(PageCommand, do="look"):
    """Show an earlier moment, by its tick or its time in seconds; without both, show the present again."""

    tick: int | None = None
    time: float | None = None

    def apply(self, opened: OpenProgram) -> Applied:
        raise NotImplementedError


@dataclass(frozen=True)
class RunFromCommand(InterruptingCommand, do="run_from"):
    """Go back to the moment looked at, and run on from there; with the edited program, if it was edited."""

    def apply(self, opened: OpenProgram) -> Applied:
        raise NotImplementedError


@dataclass(frozen=True)
class WhatIfRequest(PageRequest, type="what_if"):
    """Ask how the present program would go on, from the moment looked at, or from now, for some seconds.

    Answered by `what_if`.
    """

    seconds: float

    def answer(self, opened: OpenProgram) -> Mapping[str, Any]:
        """Return both courses."""
        raise NotImplementedError

"""The commands of a page about breakpoints: add one, switch it on or off, remove it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from lrp_jupyter.live import commands as do
from lrp_jupyter.live.breakpoint import BreakpointKind
from lrp_jupyter.live.breakpoints import breakpoint_of, noun_of
from lrp_jupyter.widgets.commands import Applied
from lrp_jupyter.widgets.messages import Between, OpenProgram, PageCommand
from lrp_jupyter.widgets.places import path_of

Hits = Annotated[int, Between(1, 1_000_000)]


@dataclass(frozen=True)
class AddBreakpointCommand(PageCommand, do="add_breakpoint"):
    """Pause from now on when something happens to the element with this path, or a condition becomes True.

    `expression` is the condition.
    """

    kind: BreakpointKind
    path: str = ""
    expression: str = ""
    after: Hits = 1

    def apply(self, opened: OpenProgram) -> Applied:
        """See the base class."""
        session, noun = opened.session, noun_of(self.kind)
        wanted = path_of(noun, self.path) if noun else self.expression
        return session.ask(
            do.AddBreakpoint(breakpoint_of(session.program, self.kind, wanted, after=self.after))
        )


@dataclass(frozen=True)
class ChangeBreakpointCommand(PageCommand, do="change_breakpoint"):
    """Switch a breakpoint on or off, or set the hit from which on it pauses; 0 keeps that."""

    number: int
    on: bool | None = None
    after: Annotated[int, Between(0, 1_000_000)] = 0

    def apply(self, opened: OpenProgram) -> Applied:
        """See the base class."""
        return opened.session.ask(do.ChangeBreakpoint(self.number, self.on, self.after or None))


@dataclass(frozen=True)
class RemoveBreakpointCommand(PageCommand, do="remove_breakpoint"):
    """Remove a breakpoint."""

    number: int

    def apply(self, opened: OpenProgram) -> Applied:
        """See the base class."""
        return opened.session.ask(do.RemoveBreakpoint(self.number))

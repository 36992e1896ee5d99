"""What a page can do with breakpoints: add one, switch it on or off, remove it."""

from __future__ import annotations

from typing import Annotated

from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.breakpoint import BreakpointKind
from lrp_jupyter.live.running.breakpoints import breakpoint_of, noun_of
from lrp_jupyter.widgets.acts.messages import OpenProgram, act
from lrp_jupyter.widgets.acts.program_acts import Applied
from lrp_jupyter.widgets.wire.codec import Between
from lrp_jupyter.widgets.wire.page_places import path_of

Hits = Annotated[int, Between(1, 1_000_000)]


@act()
def add_breakpoint(
    opened: OpenProgram,
    kind: BreakpointKind,
    path: str = "",
    expression: str = "",
    after: Hits = 1,
    instance: str = "",
) -> Applied:
    """Pause from now on when something happens to the element with this path, or a condition becomes True.

    `instance`: the path, as spawned, of the one instance of its machine that is meant.
    """
    session, noun = opened.session, noun_of(kind)
    wanted = path_of(noun, path) if noun else expression
    new = breakpoint_of(session.program, kind, wanted, instance=instance, after=after)
    return session.ask(do.AddBreakpoint(new))


@act()
def change_breakpoint(
    opened: OpenProgram, number: int, on: bool | None = None, after: Annotated[int, Between(0, 1_000_000)] = 0
) -> Applied:
    """Switch a breakpoint on or off, or set the first hit at which it pauses; 0 keeps that."""
    return opened.session.ask(do.ChangeBreakpoint(number, on, after or None))


@act()
def remove_breakpoint(opened: OpenProgram, number: int) -> Applied:
    """Remove a breakpoint."""
    return opened.session.ask(do.RemoveBreakpoint(number))

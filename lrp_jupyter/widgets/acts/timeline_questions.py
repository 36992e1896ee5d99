"""The messages of the timeline: what happened, look at an earlier moment, run on from there, what if."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from lrp_jupyter.live.past.plots import Plot
from lrp_jupyter.live.past.timeline import Timeline, TimelineCursor
from lrp_jupyter.live.past.what_if import WhatIf
from lrp_jupyter.widgets.acts.messages import OpenProgram, act, question
from lrp_jupyter.widgets.acts.program_acts import INTERRUPTING, Applied
from lrp_jupyter.widgets.wire.codec import Between


@question("timeline")
def timeline(
    opened: OpenProgram, epoch: int | None, tick: int, plots: dict[str, int] | None = None
) -> Timeline:
    """Ask what happened since a tick that the page knows, in the run of this `epoch`, None for none.

    `plots` are the names to plot, such as ``robot.light.data`` or ``follower/lightlim``, each with the tick
    up to which the page has its samples.
    """
    return opened.session.timeline(None if epoch is None else TimelineCursor(epoch, tick), plots)


@question("plots")
def plots(
    opened: OpenProgram, names: list[str], event: str, seconds: Annotated[float, Between(0.1, 700)]
) -> list[Plot]:
    """Ask for the last seconds of variables and readings, or of what the condition of an event reads."""
    return opened.session.plots(names, event or None, seconds)


@act(is_noted=False, only_looks=True)
def look(opened: OpenProgram, tick: int | None = None, time: float | None = None) -> Applied:
    """Show an earlier moment, by its tick or its time in seconds; without either, show the present again."""
    session, looking = opened.session, opened.looking
    at: int | float | None = tick
    if tick is not None:
        session.looked("playhead", f"tick {tick}")
    elif time is not None:
        at = float(time)  # a page writes whole numbers without a point
        session.looked("playhead", f"{time:g} s")
    else:
        session.looked("playhead", "now")

    def show() -> None:
        if at is None:
            resumed = looking.back(session)
            if resumed is not None:
                resumed.result()
        else:
            looking.look(session, at)

    return opened.work(show)


@act(INTERRUPTING)
def run_from(opened: OpenProgram) -> Applied:
    """Go back to the moment looked at, and run on from there; with the edited program, if it was edited."""
    return opened.work(partial(opened.looking.run_on, opened.session))


@question("what_if", 30.0)  # a long run is repeated up to that moment, and the page asks once
def what_if(opened: OpenProgram, seconds: Annotated[float, Between(0.1, 600)]) -> WhatIf:
    """Ask how the present program goes on from the moment looked at, or from now, for some seconds."""
    session = opened.session
    return session.what_if(opened.looking.tick(session), seconds=seconds)


@question("what_ifs", 30.0, only_looks=False)
def try_programs(
    opened: OpenProgram, programs: list[str], seconds: Annotated[float, Between(0.1, 600)]
) -> list[WhatIf]:
    """Ask how each of some programs goes on from now for some seconds, beside how the first does."""
    return opened.session.try_programs(programs, seconds)

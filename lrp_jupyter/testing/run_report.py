"""What a run did, as a text for the reader of a failed test."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from lrp_jupyter.interpreter.facts import Fired
from lrp_jupyter.language.program import path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.questions import test_again
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.session import Session
from lrp_jupyter.live.why.answers import element_reason
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.wording import listed, time_text

_LAST = 10  # transitions that are listed


def report(session: Session) -> str:
    """Return what a session did: its last transitions, what is active, and why no other transition fired.

    Parameters
    ----------
    session : Session
        Open or closed.

    Returns
    -------
    str
        The lines that the pytest plugin adds to a failed test.
    """

    def told(loop: Loop) -> str:
        return "\n".join(_lines(session, loop))

    return told(session._loop) if session.status == "closed" else session._value("report", told)


def _lines(session: Session, loop: Loop) -> Iterator[str]:
    frame = session.frame
    active = listed([f"`{path_text(path)}`" for path in frame.active] or ["nothing"], "and")
    are = "were" if len(frame.active) > 1 else "was"
    yield f"At {time_text(frame.time)}, after {frame.tick} ticks, {active} {are} active."
    run = RecordedRun(loop, partial(test_again, session))
    ticks = run.history.ticks
    fired = [(when, fact) for when, fact in run.history.told() if isinstance(fact, Fired)]
    yield "The last transitions:" if fired else "No transition has fired."
    for when, fact in fired[-_LAST:]:
        program = run.program(int(when))
        arrow = resolve(program).arrow(fact.transition)
        span = arrow.noun.span if arrow is not None else None
        text = f"  {' '.join(program.text[span.start : span.end].split())}" if span else ""
        way = f"{fact.source} → {fact.destination}"
        yield f"{time_text(run.time(when)):>8}  {path_text(fact.machine)}: {way}{text}"
    reasons = list(_reasons(run)) if ticks else []
    yield from ["In the last tick:", *reasons] if reasons else []
    for issue in frame.issues:
        if not issue.resolved:
            yield f"{issue.code} in line {issue.line}: {issue.message}"


def _reasons(run: RecordedRun) -> Iterator[str]:
    """Yield why each transition did not fire in the last tick that leaves a state that is active after it."""
    last = run.history.ticks.stop - 1
    for machine in run.history.state(last).walk():
        names = resolve(run.loop.interpreter.program)
        for arrow in () if machine.is_around else names.arrows[names.by_path[machine.state[:-1]]]:
            if arrow.noun.leaves(machine.state[-1]):
                path = (*machine.path, arrow.element.path[-1])
                yield f"  {element_reason(run, 'why_not', path, last)}"

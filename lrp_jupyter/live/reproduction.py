"""Reproduce a recorded session: run it again, and report the first difference."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Any

from lrp_jupyter.errors import FileError, sentence_of
from lrp_jupyter.interpreter.journal import TICKS
from lrp_jupyter.interpreter.trace_events import Observer
from lrp_jupyter.language.program import Program
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.comparison import Comparison, FirstDifference
from lrp_jupyter.live.past.fork import private_namespace
from lrp_jupyter.live.past.replay import Entry, Ticked, repeat, without_edits
from lrp_jupyter.live.recorder import Recorder
from lrp_jupyter.live.recording import Recording, random_of
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.session import Session
from lrp_jupyter.logs import at_line

__all__ = ["FirstDifference", "Reproduction", "reproduce"]

_LIMIT = 10.0  # maximum wall seconds for a block


@dataclass(frozen=True, slots=True)
class Reproduction:
    """A session that was run again, and its first difference from the recording, if there is one.

    `session`: as it is after the last repeated entry; paused, in virtual time.
    """

    session: Session
    difference: FirstDifference | None


def reproduce(
    recording: Recording,
    until: float | None = None,
    program: str | Program | None = None,
    observer: Observer | None = None,
    *,
    namespace: dict[str, Any] | None = None,
) -> Reproduction:
    """Run a recorded session again, including its blocks, which are Python and can do anything you can do.

    No command of `robot` reaches a robot, but anything that a block does directly, over a socket or with
    `rospy`, happens again. Check ``is_own`` first if someone else may have made the recording.

    Parameters
    ----------
    recording : Recording
    until : float, optional
        Seconds of the run at which to end, by default at the end of the recording.
    program : str or Program, optional
        Another program to compare with the recorded one; recorded edits are left out.
    observer : callable, optional
        Receives every event.
    namespace : dict, optional
        The names that the blocks of the recorded session used, if it ran in a notebook; recorded values take
        precedence.

    Returns
    -------
    Reproduction

    Raises
    ------
    LRPSyntaxError
        The other text is not a valid program.
    FileError
        An input cannot be repeated; the message names its line.
    SessionTimeoutError
        A block does not return.
    """
    start, entries = recording.start, deque(recording.entries)
    first = start.program(start.text if program is None else program)
    if program is not None:
        entries = deque(without_edits(entries))
    session = Session(
        first,
        start.make_bridge(),
        VirtualClock(),
        start.rate,
        namespace=private_namespace(
            {**(namespace or {}), **start.namespace()}, random_of(start.random).getstate()
        ),
        on_active_edit=start.on_active_edit,  # type: ignore[arg-type]
        on_issue=start.on_issue,  # type: ignore[arg-type]
        name="replay",
        journal=recording.reach if recording.reach > TICKS else None,
        start=start.start or None,
    )
    session._loop.is_copy = True
    with session._closed_on_error():
        if observer is not None:
            session.observe(observer)
        return Reproduction(session, _repeated(session, recording, entries, until, program is not None))


def _repeated(
    session: Session, recording: Recording, entries: deque[Entry], until: float | None, other: bool
) -> FirstDifference | None:
    """Repeat entries up to a time, or up to the first difference from a run of the same program; return it.

    For another program, a difference in what it does comes before a difference in its variables.
    """
    comparisons = [
        Comparison(recording.followed, other, has_values)
        for has_values in ([False, True] if other else [True])
    ]
    session.open()
    loop = session._loop

    def write(text: str) -> None:
        for comparison in comparisons:
            comparison.write(text)

    recorder = Recorder(loop, write)
    failed: FileError | None = None

    def is_due() -> bool:
        return bool(entries) and (until is None or entries[0].time <= until + 1e-9)

    while is_due() and failed is None and (other or comparisons[-1].difference is None):
        with session.driving(_LIMIT):
            for _ in range(1000):
                if not is_due() or failed is not None:
                    break
                failed = _repeat(loop, entries.popleft(), recording.name)
                failed = None if other else failed  # an input may be impossible in another program
    for comparison in comparisons:
        if entries or failed is not None:
            comparison.end_of_tick(is_whole=False)
        else:
            comparison.end()
    difference = next((each.difference for each in comparisons if each.difference is not None), None)
    if failed is not None and difference is None:
        raise failed
    recorder.end()
    with session.driving(_LIMIT):
        loop.rest()
        loop.publish()
    return difference


def _repeat(loop: Loop, entry: Entry, name: str) -> FileError | None:
    """Repeat an entry; return the error if an input fails (each succeeded when it was recorded)."""
    try:
        repeat(loop, entry)
    except Exception as error:
        if isinstance(entry, Ticked):
            raise
        return at_line(name, entry.number, f"This input cannot be repeated: {sentence_of(error)}")
    return None

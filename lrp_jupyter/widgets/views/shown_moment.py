"""The earlier moment that all views of a session show while a person looks at it.

A simulated robot pauses meanwhile, unless pages only look; a real one is not affected, and its program
continues. Any command that makes a simulated robot move again returns the views to the present.
"""

from __future__ import annotations

from concurrent.futures import Future
from dataclasses import dataclass, replace
from typing import NamedTuple

from lrp_jupyter.language.program import Program
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.frame import Frame
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.wire.protocol import LookingView


class MomentShown(NamedTuple):
    """A frame that views show, and its moment; None for the present."""

    frame: Frame
    looking: LookingView | None


@dataclass(frozen=True)
class _Moment:
    session: Session
    past: Frame
    present: int  # the tick at which the session has been paused
    program: Program  # that ran when the person began to look
    resumes: bool

    def is_edited(self, program: Program) -> bool:
        """Return whether this program differs; an edit that was undone does not count."""
        return program.text != self.program.text


class Looking:
    """See the module's docstring. Its moment is one reference, so that any thread may read it."""

    def __init__(self) -> None:
        self.pauses = True  # whether a simulated robot pauses meanwhile
        self._moment: _Moment | None = None

    # -- what is shown -------------------------------------------------------------------------------

    def shown(self, session: Session) -> MomentShown:
        """Return what views show: the frame of the moment looked at, or the newest frame."""
        moment, now = self._of(session), session.frame
        if moment is None:
            return MomentShown(now, None)
        past = moment.past
        view: LookingView = {
            "tick": past.tick,
            "time": round(past.time, 3),
            "ago": round(max(0.0, now.time - past.time), 1),
            "edited": moment.is_edited(now.program),
        }
        return MomentShown(replace(past, status=now.status, hung=now.hung), view)

    def tick(self, session: Session) -> int | None:
        """Return the tick looked at, or None for the present."""
        moment = self._of(session)
        return None if moment is None else moment.past.tick

    def _of(self, session: Session) -> _Moment | None:
        """Return the moment, unless the session shows that it is over."""
        moment = self._moment
        if moment is None or moment.session is not session:
            return None
        frame = session.frame
        goes_on = frame.tick != moment.present or frame.status not in ("paused", "ready", "hung")
        return None if goes_on and self._pauses(session) else moment

    def _pauses(self, session: Session) -> bool:
        return self.pauses and not session.bridge.hardware

    # -- what a person does: on the worker's thread, unless said -----------------------------------------

    def look(self, session: Session, at: int | float) -> None:
        """Show the moment after a tick, or at a time in seconds."""
        before, past = self._of(session), session.at(at)
        running = session.status == "running" and self._pauses(session)
        if running:
            session.ask(do.Pause()).result()
        if before is None:
            self._moment = _Moment(session, past, session.frame.tick, session.program, running)
        else:
            self._moment = replace(before, past=past)

    def back(self, session: Session) -> Future[None] | None:
        """Show the present again, from any thread; the future is done when a robot so paused drives on."""
        moment, self._moment = self._of(session), None
        return session.ask(do.Resume()) if moment is not None and moment.resumes else None

    def run_on(self, session: Session) -> None:
        """Go back to the moment looked at, and run on from there, with the edits made meanwhile."""
        moment = self._of(session)
        if moment is None:
            raise ValueError("The lab shows the present. Look at an earlier moment first.")
        program = session.program
        session.rewind(session.frame.tick - moment.past.tick)
        self._moment = None
        if moment.is_edited(program):
            session.edit(program.text)
        session.start()

"""What goes out: everything that the views of a session are told, sent by one thread.

The publisher sends answers and replies as soon as they are known, and then to each view what changed since
the last frame *sent to that view*, while the view has credit. It is woken by a new frame of the session,
and never waits for anybody: a view that is slow, hidden or gone costs the others nothing.

*Pacing.* What a person did or must see at once is urgent and goes out with the next round. What comes with
every tick is calm: its frames keep a distance, for each of them costs the page a picture.
"""

from __future__ import annotations

import contextvars
import threading
import traceback
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from time import monotonic
from typing import Any

from lrp_jupyter.errors import SessionClosedError
from lrp_jupyter.live import commands as do
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.choices import choices
from lrp_jupyter.widgets.replies import Reply
from lrp_jupyter.widgets.scene import world_view
from lrp_jupyter.widgets.sight import PRINTED, Sight, changes, is_urgent
from lrp_jupyter.widgets.texts import Texts, Written
from lrp_jupyter.widgets.view import Send, View
from lrp_jupyter.widgets.world_feed import has_moved, movement, scene_of, send_world

__all__ = ["Publisher"]

_HEARTBEAT = 1.0
_URGENT, _CALM = 0.015, 0.08  # s between two frames, at least: ten ticks a second come through
_ROUND, _REST = 0.01, 0.1  # s until the next look if something urgent is owed, and if nobody calls
_REFRESH, _REFRESH_HARDWARE = 0.2, 1.0  # s between two readings of what no program reads


class Publisher:
    """See the head of this module. May be called from any thread.

    Parameters
    ----------
    session : Session
    texts : Texts
    report : callable
        Gets the traceback of a fault of the lab itself.
    clock : callable
        Seconds on the wall.
    """

    def __init__(
        self,
        session: Session,
        texts: Texts,
        report: Callable[[str], None],
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self._texts = texts
        self._report = report
        self._clock = clock
        self._lock = threading.RLock()  # of the views and what was sent to them
        self._views: dict[str, View] = {}
        self._replies: deque[Reply] = deque()
        self._wake = threading.Event()
        self._thread: threading.Thread | None = None
        self._ended = False
        self._refreshed: tuple[float, Future[Any] | None] = (float("-inf"), None)
        self._left = False  # whether a view may be owed something urgent
        self._unlisten: Callable[[], None] = lambda: None
        self.follow(session)

    def follow(self, session: Session) -> None:
        """Show this session from now on; views get everything anew."""
        with self._lock:
            self._unlisten()
            self.session = session
            self._unlisten = session.listen(self._wake.set)
            with suppress(SessionClosedError):
                session.ask(do.Call(session.interpreter.watch_events))
            self._refreshed = float("-inf"), None  # what was asked of another may never be answered
            self._sight = Sight(session)
            self._texts.follow(session)
            for view in self._views.values():
                self._snapshot(view)

    # -- the views -----------------------------------------------------------------------------------

    def welcome(self, name: str, part: str, send: Send) -> None:
        """Tell a view that said hello everything; it hears news from now on."""
        with self._lock:
            view = View(name, part, send, self._clock())
            if not self._ended:
                self._views[name] = view
            self._snapshot(view)
        self.wake()

    def knows(self, name: str) -> bool:
        """Whether a view said hello, and is not forgotten since."""
        with self._lock:
            return name in self._views

    def forget(self, name: str) -> None:
        """Tell a view nothing more."""
        with self._lock:
            self._views.pop(name, None)

    def credit(self, name: str, number: int) -> None:
        """Take back a view's credit for a frame, and for all before it."""
        with self._lock:
            if name in self._views:
                self._views[name].credit(number, self._clock())

    def owe(self, reply: Reply) -> None:
        """Send a reply as soon as its answer is known, or the deadline is over."""
        self._replies.append(reply)
        reply.answer.add_done_callback(lambda _: self.wake())

    def look(self) -> dict[str, Any]:
        """Everything that a view may see now."""
        with self._lock:
            return self._look()

    # -- the thread ----------------------------------------------------------------------------------

    def start(self) -> None:
        """Start the thread, once."""
        with self._lock:
            if self._thread is not None or self._ended:
                return
            context = contextvars.copy_context()  # or messages would go to the cell run last, or nowhere
            self._thread = threading.Thread(
                target=context.run, args=(self._run,), name=f"lrp {self.session.name} publisher", daemon=True
            )
            self._thread.start()

    def wake(self) -> None:
        """Look at once."""
        self._wake.set()

    def end(self) -> None:
        """End the thread, tell every view how it ended, and save what is not saved."""
        with self._lock:
            self._unlisten()
            self._ended = True
            thread = self._thread
        self.wake()
        if thread is not None and thread is not threading.current_thread():
            thread.join(2)
        try:
            self._say_goodbye()
        except Exception:
            self._report(traceback.format_exc())

    def _run(self) -> None:
        while not self._ended:
            self._wake.wait(self._pace())
            self._wake.clear()
            try:
                self.publish()
            except Exception:
                self._report(traceback.format_exc())

    def _pace(self) -> float:
        if not self._views:
            return _HEARTBEAT
        return _ROUND if self._left or self._replies or self._texts.waiting else _REST

    # -- a round -------------------------------------------------------------------------------------

    def publish(self) -> None:
        """Send what there is to send; never waits."""
        now = self._clock()
        with self._lock:
            for written in self._texts.settle(now):
                self._answer(written)
            self._answer_commands(now)
            self._drop_the_gone(now)
            for view in self._views.values():
                send_world(view, self.session, now)
            self._send_frames(now)
        self._texts.save()
        self._refresh(now)

    def _answer(self, written: Written) -> None:
        for view in self._views.values():
            mine = bool(written.view) and view.name == written.view
            view.send(
                {
                    "type": "answer",
                    "seq": written.seq if mine else 0,
                    "revision": written.revision,
                    "text": None if mine or not written.is_news else written.text,
                    "findings": written.findings,
                    "accepted": written.accepted,
                    "applied": written.applied,
                    "reason": written.reason,
                    "program": written.program,
                    "layouts": written.layouts,
                    "pending": written.pending,
                }
            )

    def _answer_commands(self, now: float) -> None:
        for _ in range(len(self._replies)):  # others may append meanwhile
            reply = self._replies.popleft()
            done = reply.answer.done()
            if not done and now < reply.deadline:
                self._replies.append(reply)
                continue
            view = self._views.get(reply.view)
            if view is None:
                continue
            error, told = reply.outcome() if done else (self._what_blocks(), {})
            view.send({"type": "reply", "id": reply.id, "error": error, **told})

    def _what_blocks(self) -> str:
        frame = self.session.frame
        why = frame.reason if frame.status == "hung" else "the session is busy"
        return f"This waits: {why or 'the session is busy'}."

    def _drop_the_gone(self, now: float) -> None:
        for view in [view for view in self._views.values() if view.is_gone(now)]:
            del self._views[view.name]
            if view.fault:
                self._report(view.fault)

    def _look(self) -> dict[str, Any]:
        texts = self._texts
        return self._sight.look(
            texts.running_revision,
            settings={
                "hold": texts.hold,
                "on_active_edit": self.session.on_active_edit,
                "pause_on_issue": self.session.on_issue == "pause",
            },
            conflict=texts.conflict,
            layouts=texts.drawings.layouts,
        )

    def _lines_since(self, count: int) -> dict[str, Any]:
        total, lines = self.session.output.since(count)
        lines = lines[-PRINTED:]
        return {"first": total - len(lines), "lines": list(lines)}

    def _send_frames(self, now: float) -> None:
        due = [view for view in self._views.values() if view.may(now) and now - view.framed >= _URGENT]
        self._left = len(due) < len(self._views)
        look = self._look() if due else {}
        for view in due:
            told, buffers = changes(view.sent, look, self._lines_since), None
            moved = has_moved(view, self.session)
            news = bool(told or moved)
            urgent = is_urgent(told) or (moved and self.session.status != "running")  # it is dragged
            if not urgent and now - view.framed < (_CALM if news else _HEARTBEAT):
                continue  # what is calm comes with the next tick
            if moved:
                ink, buffers = movement(view, self.session)
                told |= ink
            view.sent, view.framed = look, now
            view.send({"type": "frame", "frame": view.number(), **told}, buffers)

    def _snapshot(self, view: View) -> None:
        """Send everything; the view then knows the present look."""
        view.sent = look = self._look()
        view.framed = self._clock()
        view.forget_world()
        picture = self.session.frame.robot
        view.scene = scene_of(self.session)
        view.send(
            {
                "type": "snapshot",
                "name": self.session.name,
                **self._texts.everything(),
                "choices": choices(),
                "world": world_view(self.session.bridge, picture),
                "frame": {
                    "type": "frame",
                    "view": view.name,
                    "frame": view.number(),
                    **changes({}, look, self._lines_since),
                },
            }
        )

    def _refresh(self, now: float) -> None:
        """Have the robot's members read, also those that no program reads."""
        session, (when, running) = self.session, self._refreshed
        pause = _REFRESH_HARDWARE if session.bridge.hardware else _REFRESH
        if not self._views or now - when < pause or (running is not None and not running.done()):
            return
        if session.bridge.is_open and session.status in ("running", "paused"):
            with suppress(SessionClosedError):  # since we looked
                self._refreshed = now, session.ask(do.Call(session.bridge.refresh))

    def _say_goodbye(self) -> None:
        """Tell every view how it ended, whether it has credit or not, and save what is not saved."""
        self.publish()
        with self._lock:
            look = self._look()
            for view in self._views.values():
                told = changes(view.sent, look, self._lines_since)
                if told:
                    view.send({"type": "frame", "frame": view.number(), **told})
            self._views.clear()

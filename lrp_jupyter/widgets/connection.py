"""The way between one session and its views in pages.

*In.* A message of a page is handled on whatever thread the kernel delivers it: with subshells that is not
the main one, and it comes while a cell runs. A handler only queues: commands go to the session, texts are
read and offered to it, what has to wait is left to one worker.

*Out.* One thread, the publisher, sends everything: answers and replies as soon as they are known, and then
to each view what changed since the last frame *sent to that view*, while the view has credit. It never
waits for anybody: a view that is slow, hidden or gone costs the others nothing.

Every handler and both threads are guarded. A fault of the lab is reported in the lab.
"""

from __future__ import annotations

import contextvars
import threading
import traceback
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from time import monotonic
from typing import Any

from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live import commands as do
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.acts import carry_out
from lrp_jupyter.widgets.choices import choices
from lrp_jupyter.widgets.protocol import FromPage
from lrp_jupyter.widgets.replies import Reply
from lrp_jupyter.widgets.requests import answer_request
from lrp_jupyter.widgets.scene import world_view
from lrp_jupyter.widgets.sight import PRINTED, Sight, changes, is_urgent
from lrp_jupyter.widgets.texts import Texts, Written
from lrp_jupyter.widgets.view import Send, View
from lrp_jupyter.widgets.world_feed import has_moved, movement, scene_of, send_world

__all__ = ["Connection"]

PATIENCE = 1.0
"""Wall seconds after which a command that is not carried out is answered with the reason."""
_SLOW_PATIENCE = 20.0  # for what talks to a robot first
_SLOW = ("bridge", "panel", "run")
_LATE = 0.25  # s after which a text is answered though it is not applied yet
_HEARTBEAT = 1.0
_URGENT, _CALM = 0.015, 0.08  # s between two frames, at least: ten ticks a second come through
_ROUND, _REST = 0.01, 0.1  # s until the next look if something urgent is owed, and if nobody calls
_REFRESH, _REFRESH_HARDWARE = 0.2, 1.0  # s between two readings of what no program reads


class Connection:
    """A session and the views that show it.

    Parameters
    ----------
    session : Session
    texts : Texts
        What was typed, and what became of it.
    reopen : callable, optional
        Makes a session of the same program with another bridge, given its name and options.
    options : mapping, optional
        Those of the bridge.
    clock : callable
        Seconds on the wall.
    """

    def __init__(
        self,
        session: Session,
        texts: Texts,
        reopen: Callable[..., Session] | None = None,
        options: Mapping[str, Any] | None = None,
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self.texts = texts
        self.options = dict(options or {})
        self._reopen = reopen
        self.fault = ""
        """The last traceback of the lab itself; empty while all is well."""
        self.closed = False
        self._clock = clock
        self._lock = threading.RLock()  # of the views and what was sent to them
        self._views: dict[str, View] = {}
        self._replies: deque[Reply] = deque()
        self._wake = threading.Event()
        self._worker: ThreadPoolExecutor | None = None
        self._publisher: threading.Thread | None = None
        self._refreshed: tuple[float, Future[Any] | None] = (float("-inf"), None)
        self._left = False  # whether a view may be owed something urgent
        self._unlisten: Callable[[], None] = lambda: None
        self.use(session)

    @property
    def name(self) -> str:
        """Of the session."""
        return self.session.name

    def use(self, session: Session) -> None:
        """Show another session from now on; views get everything anew."""
        with self._lock:
            self._unlisten()
            self.session = session
            self._unlisten = session.listen(self._wake.set)
            if session.status != "closed":
                session.ask(do.Call(session.interpreter.watch_events))
            self._sight = Sight(session)
            self.texts.follow(session)
            for view in self._views.values():
                self._snapshot(view)

    # -- in: any thread ----------------------------------------------------------------------------

    def receive(self, send: Send, message: FromPage) -> None:
        """Take a message of a page; never raises."""
        try:
            self._receive(send, message)
        except Exception:
            self.report(traceback.format_exc())

    def _receive(self, send: Send, message: FromPage) -> None:
        name = message["view"]
        if message["type"] == "hello":
            self._hello(send, name, message["part"])
            return
        with self._lock:
            view = self._views.get(name)
        if view is None:  # it was forgotten, or never said hello: it will when it hears nothing
            return
        if message["type"] == "bye":
            with self._lock:
                self._views.pop(name, None)
        elif message["type"] == "credit":
            with self._lock:
                view.credit(message["frame"], self._clock())
            self.session.seen()
        elif message["type"] == "text":
            self.write(message["text"], name, message["seq"])
        elif message["type"] == "command":
            self._begin(message, lambda: carry_out(self, message))
        else:
            self._begin(message, partial(self.work, partial(answer_request, self, message)), dict)

    def _hello(self, send: Send, name: str, part: str) -> None:
        with self._lock:
            view = View(name, part, send, self._clock())
            self._views[name] = view
            self._snapshot(view)
        self.start()
        self._wake.set()

    def _begin(
        self,
        message: Any,
        begin: Callable[[], Future[Any] | None],
        tell: Callable[[Any], Mapping[str, Any]] = lambda _: {},
    ) -> None:
        """Begin a command; it is answered when its future is done, or cannot be begun."""
        try:
            answer = begin()
        except Exception as error:
            answer = Future()
            answer.set_exception(error)
        if answer is None:
            answer = Future()
            answer.set_result(None)
        if message["id"] == 0:
            return
        patience = _SLOW_PATIENCE if message.get("do") in _SLOW else PATIENCE
        self._replies.append(Reply(message["view"], message["id"], answer, self._clock() + patience, tell))
        answer.add_done_callback(lambda _: self._wake.set())

    def write(self, text: str, view: str = "", seq: int = 0) -> None:
        """Take a text: typed in a view, or brought by a cell, a program of the package, a file."""
        written = self.texts.write(text, view, seq, self._clock() + _LATE)
        written.answer.add_done_callback(lambda _: self._wake.set())

    def apply(self) -> None:
        """Let the held text run."""
        self.texts.apply(self._clock() + _LATE).answer.add_done_callback(lambda _: self._wake.set())

    def change_bridge(self, bridge: str, **options: Any) -> None:
        """Go on with another bridge: the same program begins anew in another session.

        Raises
        ------
        BridgeError
            There is no such bridge, or its robot cannot be reached; the old one stays.
        """
        if self._reopen is None:
            raise BridgeError("This session was made elsewhere: its bridge cannot be changed here.")
        old, text = self.session, self.texts.text
        if old.bridge.hardware and old.bridge.name == bridge:
            old.close()  # a robot lets nobody in while somebody is connected
        self.use(self._reopen(old, bridge, **options))
        self.options = options
        old.close()
        if text != self.texts.text:  # it was held, or no program
            self.write(text)

    def look(self) -> dict[str, Any]:
        """Everything that a view may see now."""
        with self._lock:
            return self._look()

    def lit(self) -> list[str]:
        """Paths of all active states."""
        lit: list[str] = self.look()["lit"]
        return lit

    def work(self, job: Callable[[], Any]) -> Future[Any]:
        """Have something done that may have to wait, in turn, on the worker's thread."""
        with self._lock:
            if self._worker is None:
                self._worker = ThreadPoolExecutor(1, f"lrp {self.name} worker")
        return self._worker.submit(contextvars.copy_context().run, job)

    def wake(self) -> None:
        """Let the publisher look at once."""
        self._wake.set()

    def report(self, fault: str) -> None:
        """Tell of a fault of the lab, in the lab."""
        self.fault = fault
        self.session.output.print("The lab itself failed; the program is not at fault.\n" + fault)

    # -- out: the publisher's thread -----------------------------------------------------------------

    def start(self) -> None:
        """Start the publisher, once."""
        with self._lock:
            if self._publisher is not None or self.closed:
                return
            context = contextvars.copy_context()  # or messages would go to the cell run last, or nowhere
            self._publisher = threading.Thread(
                target=context.run, args=(self._run,), name=f"lrp {self.name} publisher", daemon=True
            )
            self._publisher.start()

    def _run(self) -> None:
        while not self.closed:
            self._wake.wait(self._pace())
            self._wake.clear()
            self._guarded_round()

    def _pace(self) -> float:
        if not self._views:
            return _HEARTBEAT
        return _ROUND if self._left or self._replies or self.texts.waiting else _REST

    def _guarded_round(self) -> None:
        try:
            self.publish()
        except Exception:
            self.report(traceback.format_exc())

    def publish(self) -> None:
        """Send what there is to send; never waits."""
        now = self._clock()
        with self._lock:
            for written in self.texts.settle(now):
                self._answer(written)
            self._answer_commands(now)
            self._drop_the_gone(now)
            for view in self._views.values():
                send_world(view, self.session, now)
            self._send_frames(now)
        self.texts.save()
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
        for reply in list(self._replies):
            done = reply.answer.done()
            if not done and now < reply.deadline:
                continue
            self._replies.remove(reply)
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
        for name in [view.name for view in self._views.values() if view.is_gone(now)]:
            del self._views[name]

    def _look(self) -> dict[str, Any]:
        texts = self.texts
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
                "name": self.name,
                **self.texts.everything(),
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
            self._refreshed = now, session.ask(do.Call(session.bridge.refresh))

    # -- the end -------------------------------------------------------------------------------------

    def close(self) -> None:
        """Close the session, tell the views, and end the threads; doing it twice does nothing."""
        if self.closed:
            return
        self.session.close()
        self._unlisten()
        self.closed = True
        self._wake.set()
        if self._publisher is not None and self._publisher is not threading.current_thread():
            self._publisher.join(2)
        try:
            self._say_goodbye()
        except Exception:
            self.report(traceback.format_exc())
        if self._worker is not None:
            self._worker.shutdown(wait=False, cancel_futures=True)

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

"""The connection between one session and its views in pages.

*In.* A message of a page is handled on the thread on which the kernel delivers it: with subshells that is not
the main one, and messages arrive while a cell runs. A message is decoded and only queued: commands go to the
session, texts are parsed and offered to it, and whatever has to wait is left to one worker.

*Out.* The session's :class:`~lrp_jupyter.widgets.publisher.Publisher` sends everything.

Every handler and both threads are guarded. A fault of the lab is reported in the lab.
"""

from __future__ import annotations

import contextvars
import threading
import traceback
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path as FilePath
from time import monotonic
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.errors import BridgeError, LRPError, SessionClosedError
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.session import Session
from lrp_jupyter.live.stored.run_files import runs_folder
from lrp_jupyter.widgets.acts import breakpoint_acts as breakpoint_acts
from lrp_jupyter.widgets.acts import drawing_questions as drawing_questions
from lrp_jupyter.widgets.acts import editor_questions as editor_questions
from lrp_jupyter.widgets.acts import goal_acts as goal_acts
from lrp_jupyter.widgets.acts import inspection as inspection
from lrp_jupyter.widgets.acts import program_acts as program_acts
from lrp_jupyter.widgets.acts import run_acts as run_acts
from lrp_jupyter.widgets.acts import timeline_questions as timeline_questions
from lrp_jupyter.widgets.acts import world_acts as world_acts
from lrp_jupyter.widgets.acts.messages import (
    AskedMessage,
    ByeMessage,
    CursorMessage,
    HelloMessage,
    LookedMessage,
    TextMessage,
    decode_message,
)
from lrp_jupyter.widgets.publisher import PendingReply, Publisher, Send
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Rename
from lrp_jupyter.widgets.views.goal import Goal
from lrp_jupyter.widgets.views.layouts import Layouts
from lrp_jupyter.widgets.views.shown_moment import Looking
from lrp_jupyter.widgets.views.shown_runs import ShownRuns
from lrp_jupyter.widgets.views.shown_search import ShownSearch
from lrp_jupyter.widgets.wire.changes import TextChanges
from lrp_jupyter.widgets.wire.codec import DecodeError
from lrp_jupyter.widgets.wire.packing import plain
from lrp_jupyter.widgets.wire.page_places import path_of
from lrp_jupyter.widgets.wire.protocol import ViewState


class PageConnection:
    """A session and the views that show it.

    `reopen`: creates a session of the same program with another bridge, given its name and options.
    `free_name`: returns a name that no other open program has, given a wanted one.
    `beside`: the folder of the notebook, in which the program's runs are kept.
    """

    def __init__(
        self,
        session: Session,
        saver: Saver,
        reopen: Callable[..., Session] | None = None,
        options: Mapping[str, Any] | None = None,
        clock: Callable[[], float] = monotonic,
        free_name: Callable[[str], str] = lambda name: name,
        beside: FilePath = FilePath(),
    ) -> None:
        self.name = session.name
        self.texts = saver.texts
        self.saver = saver
        self.layouts = Layouts()
        self.looking = Looking()
        self._beside = beside
        self.runs = ShownRuns(runs_folder(beside / session.name))
        self.search = ShownSearch()
        self.log: FilePath | None = None  # that was named for the recording of its sessions
        self.options = dict(options or {})
        self._reopen = reopen
        self._free_name = free_name
        self.fault = ""  # the last traceback of the lab itself
        self.closed = False
        self.read_only = ""  # why pages may only look, a sentence; empty: they may change everything
        self._clock = clock
        self._lock = threading.RLock()  # of `closed` and the worker, and of which session it is
        self._changing = threading.Lock()  # held while another bridge is opened, which may take long
        self._worker: ThreadPoolExecutor | None = None
        self._publisher = Publisher(
            session, saver, self.layouts, self.looking, self.runs, self.search, self.report, clock
        )

    @property
    def session(self) -> Session:
        """The session that is shown."""
        return self._publisher.session

    @property
    def goal(self) -> Goal | None:
        """The challenge that the program is written for."""
        return self._publisher.goal

    @goal.setter
    def goal(self, goal: Goal | None) -> None:
        self._publisher.set_goal(goal)

    # -- in: any thread ----------------------------------------------------------------------------

    def receive(self, send: Send, content: object, waits: bool = False) -> None:
        """Handle a message of a page; never raises. `waits`: whether a running cell would have held it up."""
        try:
            message = decode_message(content)
            if self._publisher.hear(message.view, message.frame, waits):
                self.session.seen()
            if isinstance(message, HelloMessage):
                known = message.revision if message.document == self.texts.document.name else None
                self._publisher.welcome(message.view, message.part, send, known, message.seq)
                self.start()
            elif isinstance(message, AskedMessage):  # also of a view that was forgotten: stop means stop
                self._do(message)
            elif not self._publisher.knows(message.view):
                return  # forgotten, or never opened: it sends hello when it gets no message for a while
            elif isinstance(message, ByeMessage):
                self._publisher.forget(message.view)
            elif isinstance(message, LookedMessage):
                self.session.looked(message.what, message.about, message.on)
            elif isinstance(message, TextMessage):
                self._type(message)
            elif isinstance(message, CursorMessage) and not self.read_only:  # an edit would wait for it
                self.texts.move_cursor(
                    message.view,
                    message.seq,
                    message.revision,
                    message.selection,
                    message.meant,
                    message.cursors,
                )
        except DecodeError as error:
            self._refuse(content, error)
        except Exception:
            self.report(traceback.format_exc())

    def _type(self, message: TextMessage) -> None:
        """Merge what was typed; a view that does not know the text gets it, and keeps what it has."""
        if self.read_only:
            self.texts.enter(message.view, message.seq)
            self._publisher.begin_again(message.view)
            return
        rename: Rename | None = None
        if message.rename is not None:
            kind, path, name = message.rename
            rename = kind, path_of(kind, path), name
        try:
            updates = [TextChanges.from_json(each) for each in message.updates]
            self.texts.type(
                message.view,
                message.seq,
                message.base,
                updates,
                message.selection,
                message.meant,
                rename,
                message.cursors,
            )
        except ValueError:
            self._publisher.begin_again(message.view)

    def _refuse(self, content: object, error: DecodeError) -> None:
        """Reply to a message that cannot be decoded; one that expects no reply is a fault of the page."""
        view, id_ = (content.get("view"), content.get("id")) if isinstance(content, dict) else ("", 0)
        if isinstance(view, str) and isinstance(id_, int) and id_ > 0:
            answer: Future[Any] = Future()
            answer.set_exception(error)
            self._publisher.reply_later(PendingReply(view, id_, answer, self._clock()))
        else:
            self.report(f"A message from the page was refused. {error}")

    def _do(self, asked: AskedMessage) -> None:
        """Carry out the request of a page; reply when it is done, or at once if it cannot begin."""
        handler = asked.handler
        if self.read_only and not handler.only_looks:
            refused: Future[Any] = Future()
            refused.set_exception(LRPError(self.read_only))
            self._publisher.reply_later(PendingReply(asked.view, asked.id, refused, self._clock()))
            return
        if handler.is_noted:
            self.session.looked("command", handler.name)
        if handler.is_present:
            self.looking.back(self.session)
        job = partial(handler.function, self, **asked.given)
        # an answer may be long, and the publisher, which packs it, holds a lock that messages need
        answer = _done(partial(self.work, lambda: plain(job())) if handler.answer else job)
        if answer.exception() is None and answer.result() is not None:
            answer = answer.result()
        if asked.id:
            deadline = self._clock() + handler.patience
            self._publisher.reply_later(
                PendingReply(asked.view, asked.id, answer, deadline, handler.answer, handler.changes_world)
            )
        else:
            answer.add_done_callback(lambda _: self.wake())

    def change_bridge(self, bridge: str | Bridge, **options: Any) -> None:
        """Start the program again in a session with another bridge; if that fails, the old one stays."""
        if self._reopen is None:
            raise BridgeError("This session was created elsewhere, so its bridge cannot be changed here.")
        with self._changing:
            old = self.session
            if old.bridge.hardware and bridge == old.bridge.name:
                old.close()  # a robot accepts one connection at a time
            session = self._reopen(old, bridge, **options)
            for each in old.frame.breakpoints:
                session.ask(do.AddBreakpoint(replace(each, hits=0)))
            text = self.texts.text
            self.use(session)
            self.options = options
            old.close()
            if text != self.texts.text:  # it was held, not a valid program, or typed meanwhile
                self.texts.write(text)

    def load(self, name: str, text: str) -> None:
        """Continue with another program under its name; the texts kept under the old name stay there."""
        if name != self.name:
            self.name = self._free_name(name)
            self.saver.move(self.name)
            self.runs.move(runs_folder(self._beside / self.name))
            self.session.name = self.name
            self._publisher.send_snapshots()  # views keep things under the name of the session
        self.texts.write(text)

    def use(self, session: Session) -> None:
        """Show another session from now on; if this connection is closed, close that one, too, and raise."""
        self.layouts.update(session.frame)  # before the lock, which a command may need
        with self._lock:
            if not self.closed:
                self._publisher.attach(session)
                return
        session.close()  # nothing else holds it
        raise SessionClosedError(f"`{session.name}` has been closed in the meantime.")

    def work(self, job: Callable[[], Any]) -> Future[Any]:
        """Queue a job that may have to wait, for the worker's thread; without threads, do it now."""
        with self._lock:
            if self.closed:
                raise SessionClosedError(f"`{self.name}` is closed.")
            if self.session.driver == "asyncio":
                return _done(job)
            if self._worker is None:
                self._worker = ThreadPoolExecutor(1, f"lrp {self.name} worker")
            return self._worker.submit(contextvars.copy_context().run, job)

    def report(self, fault: str) -> None:
        """Report a fault of the lab, in the lab."""
        self.fault = fault
        self.session.output.print("The lab itself failed; the program is not at fault.\n" + fault)

    # -- out -----------------------------------------------------------------------------------------

    def view_state(self) -> ViewState:
        """Return everything that a view may show now."""
        return self._publisher.view_state()

    def start(self) -> None:
        """Start the publisher's thread, once."""
        self._publisher.start()

    def wake(self) -> None:
        """Update the views at once."""
        self._publisher.wake()

    def publish(self) -> None:
        """Send everything that is due, on this thread; waits for no view."""
        self._publisher.publish()

    def close(self) -> None:
        """Close the session, notify the views, and end the threads; a second call does nothing."""
        with self._lock:
            if self.closed:
                return
            self.closed = True  # from now on it stays with this session
        if self.goal is not None:
            self.goal.close()
        self.runs.close()
        self.search.stop()
        self.session.close()
        self._publisher.end()
        if self._worker is not None:
            self._worker.shutdown(wait=False, cancel_futures=True)


def _done(job: Callable[[], Any]) -> Future[Any]:
    """Do a job; return the future of its result, or of the exception that it raised."""
    answer: Future[Any] = Future()
    try:
        answer.set_result(job())
    except Exception as error:
        answer.set_exception(error)
    return answer

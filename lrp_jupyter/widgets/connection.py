"""The way between one session and its views in pages.

*In.* A message of a page is handled on whatever thread the kernel delivers it: with subshells that is not
the main one, and it comes while a cell runs. A handler only queues: commands go to the session, texts are
read and offered to it, what has to wait is left to one worker.

*Out.* The session's :class:`~lrp_jupyter.widgets.publisher.Publisher` sends everything.

Every handler and both threads are guarded. A fault of the lab is reported in the lab.
"""

from __future__ import annotations

import contextvars
import threading
import traceback
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from time import monotonic
from typing import Any

from lrp_jupyter.errors import BridgeError, SessionClosedError
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.acts import carry_out
from lrp_jupyter.widgets.protocol import FromPage
from lrp_jupyter.widgets.publisher import Publisher
from lrp_jupyter.widgets.replies import Reply
from lrp_jupyter.widgets.requests import answer_request
from lrp_jupyter.widgets.texts import Texts
from lrp_jupyter.widgets.view import Send

__all__ = ["Connection"]

PATIENCE = 1.0
"""Wall seconds after which a command that is not carried out is answered with the reason."""
_SLOW_PATIENCE = 20.0  # for what talks to a robot first
_SLOW = ("bridge", "panel", "run")
_LATE = 0.25  # s after which a text is answered though it is not applied yet


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
        self._lock = threading.RLock()  # of `closed` and the worker, and of which session it is
        self._changing = threading.Lock()  # held while another bridge is opened, which may take long
        self._worker: ThreadPoolExecutor | None = None
        self._publisher = Publisher(session, texts, self.report, clock)

    @property
    def session(self) -> Session:
        """The one that is shown."""
        return self._publisher.session

    @property
    def name(self) -> str:
        """Of the session."""
        return self.session.name

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
            self._publisher.welcome(name, message["part"], send)
            self.start()
            return
        if not self._publisher.knows(name):  # forgotten, or never said hello: it will when it hears nothing
            return
        if message["type"] == "bye":
            self._publisher.forget(name)
        elif message["type"] == "credit":
            self._publisher.credit(name, message["frame"])
            self.session.seen()
        elif message["type"] == "text":
            self.write(message["text"], name, message["seq"])
        elif message["type"] == "command":
            self._begin(message, lambda: carry_out(self, message))
        else:
            self._begin(message, partial(self.work, partial(answer_request, self, message)), dict)

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
        self._publisher.owe(Reply(message["view"], message["id"], answer, self._clock() + patience, tell))

    def write(self, text: str, view: str = "", seq: int = 0) -> None:
        """Take a text: typed in a view, or brought by a cell, a program of the package, a file."""
        written = self.texts.write(text, view, seq, self._clock() + _LATE)
        written.answer.add_done_callback(lambda _: self.wake())

    def apply(self) -> None:
        """Let the held text run."""
        self.texts.apply(self._clock() + _LATE).answer.add_done_callback(lambda _: self.wake())

    def change_bridge(self, bridge: str, **options: Any) -> None:
        """Go on with another bridge: the same program begins anew in another session.

        Raises
        ------
        BridgeError
            There is no such bridge, or its robot cannot be reached; the old one stays.
        SessionClosedError
            It was closed meanwhile.
        """
        if self._reopen is None:
            raise BridgeError("This session was made elsewhere: its bridge cannot be changed here.")
        with self._changing:
            old = self.session
            if old.bridge.hardware and old.bridge.name == bridge:
                old.close()  # a robot lets nobody in while somebody is connected
            session = self._reopen(old, bridge, **options)
            text = self.texts.text
            self.use(session)
            self.options = options
            old.close()
            if text != self.texts.text:  # it was held, or no program, or typed meanwhile
                self.write(text)

    def use(self, session: Session) -> None:
        """Show another session from now on; views get everything anew.

        Raises
        ------
        SessionClosedError
            It is too late: the other session is closed, too.
        """
        with self._lock:
            if not self.closed:
                self._publisher.follow(session)
                return
        session.close()  # nobody else would
        raise SessionClosedError(f"`{session.name}` was closed meanwhile.")

    def work(self, job: Callable[[], Any]) -> Future[Any]:
        """Have something done that may have to wait, in turn, on the worker's thread."""
        with self._lock:
            if self.closed:
                raise SessionClosedError(f"`{self.name}` is closed.")
            if self._worker is None:
                self._worker = ThreadPoolExecutor(1, f"lrp {self.name} worker")
            return self._worker.submit(contextvars.copy_context().run, job)

    def report(self, fault: str) -> None:
        """Tell of a fault of the lab, in the lab."""
        self.fault = fault
        self.session.output.print("The lab itself failed; the program is not at fault.\n" + fault)

    # -- out -----------------------------------------------------------------------------------------

    def look(self) -> dict[str, Any]:
        """Everything that a view may see now."""
        return self._publisher.look()

    def lit(self) -> list[str]:
        """Paths of all active states."""
        lit: list[str] = self.look()["lit"]
        return lit

    def start(self) -> None:
        """Start the publisher's thread, once."""
        self._publisher.start()

    def wake(self) -> None:
        """Let the publisher look at once."""
        self._publisher.wake()

    def publish(self) -> None:
        """Send what there is to send, here and now; never waits."""
        self._publisher.publish()

    def close(self) -> None:
        """Close the session, tell the views, and end the threads; doing it twice does nothing."""
        with self._lock:
            if self.closed:
                return
            self.closed = True  # from now on it stays with this session
        self.session.close()
        self._publisher.end()
        if self._worker is not None:
            self._worker.shutdown(wait=False, cancel_futures=True)

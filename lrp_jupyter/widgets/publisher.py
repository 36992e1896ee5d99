"""Publish a session to its views: one thread (where there are none, one task) sends them everything.

The publisher sends answers and replies as soon as they are known, and then to each view what changed since
the last frame *sent to that view*, while the view has credit. It is woken by a new frame of the session,
and never waits for a view: one that is slow, hidden or gone costs the others nothing. Layouts, which may
take long, are computed between the answers and the frames with no lock held: messages of the page, a stop
among them, go through meanwhile.

*Pacing.* What the user did or must see at once is urgent and is sent in the next round. What changes with
every tick is calm: its frames are spaced out, because each of them costs the page a repaint; where only the
time goes on, further. A message of the page costs three: the kernel reports to every page that it is busy
with it, and idle again. So the page acknowledges frames with what it says anyway, and else only where it is
asked to.
"""

from __future__ import annotations

import asyncio
import contextvars
import math
import threading
import traceback
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass
from time import monotonic
from typing import Any

from lrp_jupyter import programs
from lrp_jupyter.bridges.discovery import find_bridges
from lrp_jupyter.errors import SessionClosedError, sentence_of
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.waking import TaskEvent
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.acts.world_acts import offered_worlds
from lrp_jupyter.widgets.hosts import by_hand, debugger
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Written
from lrp_jupyter.widgets.views.goal import Goal
from lrp_jupyter.widgets.views.layouts import Layouts
from lrp_jupyter.widgets.views.shown_moment import Looking, MomentShown
from lrp_jupyter.widgets.views.shown_runs import ShownRuns
from lrp_jupyter.widgets.views.shown_search import ShownSearch
from lrp_jupyter.widgets.views.view_state import ViewStates, difference, is_time, is_urgent
from lrp_jupyter.widgets.views.world_state import WorldCursor
from lrp_jupyter.widgets.wire.protocol import ViewState

_HEARTBEAT = 1.0
_URGENT, _CALM = 0.015, 0.08  # s between two frames, at least: ten ticks a second come through
_CLOCK = 0.25  # s between two frames in which nothing is new but the time
_ROUND, _REST = 0.01, 0.1  # s until the next round if something urgent is owed, and if nothing wakes it
_REFRESH, _REFRESH_HARDWARE = 0.2, 1.0  # s between two readings of what no program reads

_PER_SECOND, _BURST = 30.0, 3.0  # frames
_FEWEST, _MOST = 3, 24  # frames that may be in flight to a view
_QUICK, _TO_QUICK = 0.1, 16  # s that a frame takes to a quick page, and how many may be in flight to it
_ASKS, _ASKS_QUICK = 2, 12  # after how many frames one asks to be acknowledged at once
_PRESENT = 1.5  # s after which a silent view is asked to acknowledge, however little is in flight
_RECENT = 10.0  # s that a round trip is remembered
_SLOWER = 1.4, 0.01  # a frame that takes longer than this, as a factor and s, has waited in a queue
_SLOWEST = 1.0  # s that a link takes
_GONE_AFTER = 15.0  # s without a credit while the window is full

Send = Callable[[Any, "list[bytes] | None"], None]


class Window:
    """How many frames may be in flight to a view: more over a slow link, and few to a slow page.

    From both, credit comes late. The least time until then, while few frames are in flight, is that of the
    link. With more frames it stays the same over a slow link, while a slow page takes longer, because it has
    them in its queue. So the window grows frame by frame for as long as frames take no longer than that.

    The view acknowledges frames with whatever it sends. Some frames ask for that at once, and only these tell
    how long frames take. A quick page near by is asked less often, and may owe more.
    """

    def __init__(self) -> None:
        self.size = _FEWEST
        self._asks = _ASKS
        self._sent: dict[int, tuple[float, int, bool]] = {}  # by number: when, as which in flight, if it asks
        self._known = float("-inf"), 0  # when credit was asked for or came last, and for which frame
        self._trips: deque[tuple[float, float]] = deque()  # when, and how long, with few in flight

    @property
    def is_open(self) -> bool:
        """Whether another frame may be sent: one more than fit in, too, if none of the others asks."""
        return len(self._sent) < self.size or not any(asks for _, _, asks in self._sent.values())

    def send(self, number: int, now: float) -> bool:
        """Count a frame as sent; return whether it asks to be acknowledged at once."""
        place = len(self._sent) + 1
        when, known = self._known
        asks = number - known >= self._asks or place > self.size or now - when >= _PRESENT
        if asks:
            self._known = now, number
        self._sent[number] = now, place, asks
        return asks

    def credit(self, number: int, now: float) -> None:
        """Count a frame as arrived, and all before it: they come in order."""
        found = self._sent.get(number)
        self._known = now, max(self._known[1], number)
        self._sent = {other: each for other, each in self._sent.items() if other > number}
        if found is None or not found[2]:
            return
        when, place, _ = found
        trip = now - when
        if place <= _FEWEST:
            self._trips.append((now, trip))
            while now - self._trips[0][0] > _RECENT:
                self._trips.popleft()
        least = min((each for _, each in self._trips), default=0.0)
        if trip <= _QUICK:
            self.size, self._asks = _TO_QUICK, _ASKS_QUICK
            return
        factor, more = _SLOWER
        step = 1 if trip <= min(least * factor + more, _SLOWEST) else -1
        self.size = max(_FEWEST, min(self.size + step, _FEWEST + int(least * _PER_SECOND), _MOST))
        self._asks = _ASKS


class View:
    """One view of a lab in a page: what has been sent to it, and its credit."""

    def __init__(self, name: str, part: str, send: Send, now: float) -> None:
        self.name = name  # a random one, chosen by the page
        self.waits = False  # whether its messages wait for a cell that runs
        self.sent: ViewState | None = None
        self.world = WorldCursor() if part in ("lab", "world") else None
        self.framed = float("-inf")  # when the last frame was sent
        self.revision: int | None = None  # of the text that it has been sent
        self.fault = ""  # the traceback of a message that could not be sent
        self._send = send
        self._number = 0
        self._window = Window()
        self._heard = now
        self._tokens = (_BURST, now)

    @property
    def has_credit(self) -> bool:
        """Whether frames may be sent."""
        return self._window.is_open

    def credit(self, number: int, now: float) -> None:
        """Return the credit for a frame, and for all before it."""
        self._window.credit(number, now)
        self._heard = now

    def is_gone(self, now: float) -> bool:
        """Return whether it cannot be reached, or has been silent for so long that it must be closed."""
        return bool(self.fault) or (not self.has_credit and now - self._heard > _GONE_AFTER)

    def may(self, now: float) -> bool:
        """Return whether a frame may be sent now: there is credit, and not too many were sent just before."""
        tokens, since = self._tokens
        self._tokens = min(_BURST, tokens + (now - since) * _PER_SECOND), now
        return self.has_credit and self._tokens[0] >= 1.0

    def frame(self, now: float, changes: Mapping[str, Any]) -> dict[str, Any]:
        """Return the next frame, and count it as sent."""
        self._number += 1
        asks = {"asks": True} if self._window.send(self._number, now) else {}
        tokens, since = self._tokens
        self._tokens = tokens - 1.0, since
        return {"type": "frame", "frame": self._number, **asks, **changes}

    def send(self, message: Any, buffers: list[bytes] | None = None) -> None:
        """Send a message to this view; a failure does not affect other views."""
        message = {**message, "view": self.name}
        try:
            self._send(message, buffers)
        except Exception:
            self.fault = traceback.format_exc()


@dataclass(eq=False)
class PendingReply:
    """A command or request that is not answered yet."""

    view: str  # that sent it
    id: int
    answer: Future[Any]
    deadline: float  # when it is answered with the reason for the delay
    field: str = ""  # of the reply, for the result; empty for none
    describes: bool = False  # whether a changed world is described before the reply

    def outcome(self) -> tuple[str | None, Mapping[str, Any]]:
        """Return the error, a sentence or None, and the other fields."""
        if self.answer.cancelled():
            return "A newer request replaced this one.", {}
        error = self.answer.exception()
        if error is None:
            return None, {self.field: self.answer.result()} if self.field else {}
        if isinstance(error, (ValueError, OSError)) and str(error):
            return str(error), {}
        return sentence_of(error), {}


class Publisher:
    """See the head of this module. May be called from any thread; `report` gets tracebacks of the lab."""

    def __init__(
        self,
        session: Session,
        saver: Saver,
        layouts: Layouts,
        looking: Looking,
        runs: ShownRuns,
        search: ShownSearch,
        report: Callable[[str], None],
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self._texts = saver.texts
        self._saver = saver
        self._layouts = layouts
        self._looking = looking
        self._runs = runs
        self._search = search
        self._report = report
        self._clock = clock
        self._lock = threading.RLock()  # of the views and what was sent to them
        self._views: dict[str, View] = {}
        self._replies: deque[PendingReply] = deque()
        self._wake: threading.Event | TaskEvent = threading.Event()
        self._motor: threading.Thread | asyncio.Task[None] | None = None
        self._ended = False
        self._refreshed: tuple[float, Future[Any] | None] = (float("-inf"), None)
        self._left = False  # whether a view may be owed something urgent
        self._unlisten: Callable[[], None] = lambda: None
        self.goal: Goal | None = None
        self.attach(session)

    def attach(self, session: Session) -> None:
        """Publish this session from now on; views get a snapshot of it."""
        self._layouts.update(session.frame)
        with self._lock:
            self._unlisten()
            self.session = session
            self._unlisten = session.listen(self.wake)
            with suppress(SessionClosedError):
                session.ask(do.Call(session.interpreter.watch_events))
            self._refreshed = float("-inf"), None  # a request to another session may never be answered
            self._texts.attach(session, self.wake, self._clock)
            self._begin_states()
            if self.goal is not None:
                self.goal.attach(session, self.wake)
            self._runs.attach(self.wake)
            self._search.attach(self.wake)
            self.send_snapshots()

    def _begin_states(self) -> None:
        self._view_states = ViewStates(
            self.session, self._saver, self._layouts, self._runs, self._search, self.goal
        )

    def set_goal(self, goal: Goal | None) -> None:
        """Show a challenge from now on."""
        with self._lock:
            if self.goal is not None:
                self.goal.close()
            self.goal = goal
            if goal is not None:
                goal.attach(self.session, self.wake)
            self._begin_states()
            self.send_snapshots()

    def send_snapshots(self) -> None:
        """Send every view everything."""
        with self._lock:
            for view in self._views.values():
                self._snapshot(view)

    # -- the views -----------------------------------------------------------------------------------

    def welcome(self, name: str, part: str, send: Send, revision: int | None = None, seq: int = 0) -> None:
        """Send a snapshot to a view that opened, or came back knowing a revision, and then what changes."""
        with self._lock:
            view = View(name, part, send, self._clock())
            view.revision = revision
            if not self._ended:
                self._views[name] = view
                if part in ("lab", "editor"):
                    self._texts.enter(name, seq)
            self._snapshot(view)
        self.wake()

    def begin_again(self, name: str) -> None:
        """Send a view the whole text, because it knows none that can be continued."""
        with self._lock:
            if name in self._views:
                self._views[name].revision = None
                self._snapshot(self._views[name])

    def knows(self, name: str) -> bool:
        """Return whether a view has said hello and has not been forgotten since."""
        with self._lock:
            return name in self._views

    def forget(self, name: str) -> None:
        """Remove a view; nothing more is sent to it, and what waits for its cursor is applied."""
        with self._lock:
            self._views.pop(name, None)
        self._texts.leave(name)

    def hear(self, name: str, number: int, waits: bool) -> bool:
        """Take note of a message of a view; return whether it acknowledges frames, up to this number."""
        with self._lock:
            view = self._views.get(name)
            if view is not None:
                view.waits = waits and self.session.driver != "asyncio"  # there the program waits as well
                if number:
                    view.credit(number, self._clock())
        return view is not None and number > 0

    def reply_later(self, reply: PendingReply) -> None:
        """Send a reply as soon as its answer is known, or the deadline is over."""
        self._replies.append(reply)
        reply.answer.add_done_callback(lambda _: self.wake())

    def view_state(self) -> ViewState:
        """Return everything that a view may show now."""
        with self._lock:
            return self._state(self._shown())

    def _state(self, shown: MomentShown) -> ViewState:
        return self._view_states.current(shown, any(view.waits for view in self._views.values()))

    # -- the thread ----------------------------------------------------------------------------------

    def start(self) -> None:
        """Start the thread, once; for a session without threads, a task of the running event loop."""
        with self._lock:
            if self._motor is not None or self._ended:
                return
            if self.session.driver == "asyncio":
                self._wake = wake = TaskEvent()
                self._motor = asyncio.get_running_loop().create_task(self._run_task(wake))
                return
            context = contextvars.copy_context()  # or messages would go to the cell run last, or nowhere
            self._motor = threading.Thread(
                target=context.run, args=(self._run,), name=f"lrp {self.session.name} publisher", daemon=True
            )
            self._motor.start()

    def wake(self) -> None:
        """Start a round at once."""
        self._wake.set()

    def end(self) -> None:
        """End the thread, send every view the session's end, and save unsaved texts."""
        with self._lock:
            self._unlisten()
            self._ended = True
            motor = self._motor
        self.wake()
        if isinstance(motor, threading.Thread) and motor is not threading.current_thread():
            motor.join(2)
        try:
            self._send_end()
        except Exception:
            self._report(traceback.format_exc())

    def _run(self) -> None:
        while not self._ended:
            self._wake.wait(self._pace())
            self._round()

    async def _run_task(self, wake: TaskEvent) -> None:
        while not self._ended:
            await wake.wait(self._pace())
            self._round()

    def _round(self) -> None:
        self._wake.clear()
        try:
            self.publish()
        except BaseException:
            self._report(traceback.format_exc())

    def _pace(self) -> float:
        if not self._views:
            return _HEARTBEAT
        return _ROUND if self._left or self._replies or self._texts.waiting else _REST

    # -- a round -------------------------------------------------------------------------------------

    def publish(self) -> None:
        """Send everything that is due; waits for no view."""
        now = self._clock()
        with self._lock:
            for written in self._texts.answers(now):
                self._answer(written)
            self._answer_commands(now)
            session = self.session
        self._layouts.update(session.frame)
        with self._lock:
            self._drop_the_gone(now)
            for view in self._views.values():
                if view.has_credit:
                    self._send_world(view, now)
            self._send_frames(now)
        self._saver.save()
        self._refresh(now)

    def _answer(self, written: Written) -> None:
        for view in self._views.values():
            view.revision = max(view.revision or 0, written.revision)
            view.send(
                {
                    "type": "answer",
                    "number": written.number,
                    "seq": written.seq if view.name == written.view else 0,
                    "revision": written.revision,
                    "updates": written.updates,
                    "findings": written.findings,
                    "accepted": written.judgement.program is not None,
                    "applied": written.applied,
                    "reason": written.reason,
                    "half_typed": written.judgement.half_typed,
                    "running": written.running,
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
                if now < reply.deadline + _GONE_AFTER:  # it was forgotten, and will say hello
                    self._replies.append(reply)
                continue
            if reply.describes:
                self._send_world(view, now, at_once=True)
            error, fields = reply.outcome() if done else (self._what_blocks(), {})
            view.send({"type": "reply", "id": reply.id, "error": error, **fields})

    def _what_blocks(self) -> str:
        frame = self.session.frame
        why = frame.reason if frame.status == "hung" else ""
        return f"This waits: {why or 'the session is busy.'}"

    def _drop_the_gone(self, now: float) -> None:
        for view in [view for view in self._views.values() if view.is_gone(now)]:
            self.forget(view.name)
            if view.fault:
                self._report(view.fault)

    def _send_world(self, view: View, now: float, at_once: bool = False) -> None:
        bridge, picture = self.session.bridge, self._shown().frame.robot
        due = math.inf if at_once else now
        if view.world is not None and view.world.must_describe(bridge, picture, due):
            view.send({"type": "world", "world": view.world.describe(bridge, picture, now)})

    def _shown(self) -> MomentShown:
        return self._looking.shown(self.session)

    def _send_frames(self, now: float) -> None:
        due = [view for view in self._views.values() if view.may(now) and now - view.framed >= _URGENT]
        self._left = len(due) < len(self._views)
        if not due:
            return
        shown = self._shown()  # read once: state and picture are of one moment
        state = self._state(shown)
        bridge, picture = self.session.bridge, shown.frame.robot
        for view in due:
            changes, buffers = difference(view.sent or {}, state), None
            world = view.world if view.world is not None and view.world.has_moved(picture) else None
            urgent = is_urgent(changes) or (world and self.session.status != "running")  # it is dragged
            if not urgent and now - view.framed < _distance(changes, world is not None):
                continue  # what is calm comes with the next tick
            if world is not None:
                seen, buffers = world.advance(bridge, picture)
                changes |= seen
            view.sent, view.framed = state, now
            view.send(view.frame(now, changes), buffers)

    def _snapshot(self, view: View) -> None:
        """Send everything; the view then knows the present view state."""
        view.sent = state = self.view_state()
        view.framed = self._clock()
        texts = self._texts.everything(view.name, view.revision)
        view.revision = texts["revision"]
        world = None
        if view.world is not None:
            world = view.world.describe(self.session.bridge, self._shown().frame.robot, float("-inf"))
        view.send(
            {
                "type": "snapshot",
                "name": self.session.name,
                "home": self._saver.home or self.session.name,
                "tab_only": self._saver.kept is None,
                "debugger": debugger(),
                "by_hand": by_hand(self.session.name),
                **texts,
                "choices": {
                    "bridges": list(find_bridges()),
                    "worlds": offered_worlds(),
                    "programs": list(programs.names()),
                },
                "world": world,
                "frame": {**view.frame(view.framed, state), "view": view.name},
            }
        )

    def _refresh(self, now: float) -> None:
        """Request a reading of the robot's members, including those that no program reads."""
        session, (when, running) = self.session, self._refreshed
        pause = _REFRESH_HARDWARE if session.bridge.hardware else _REFRESH
        if not self._views or now - when < pause or (running is not None and not running.done()):
            return
        if session.bridge.is_open and session.status in ("running", "paused"):
            with suppress(SessionClosedError):  # closed meanwhile
                self._refreshed = now, session.ask(do.Call(session.bridge.refresh))

    def _send_end(self) -> None:
        """Send every view the end of the session, with or without credit, and save unsaved texts."""
        self.publish()
        self._saver.save(at_once=True)
        with self._lock:
            state = self.view_state()
            for view in self._views.values():
                changes = difference(view.sent or {}, state)
                if changes:
                    view.send(view.frame(self._clock(), changes))
            self._views.clear()


def _distance(changes: Mapping[str, Any], moves: bool) -> float:
    """Return the wall seconds between two frames of calm news, at least."""
    if moves or not is_time(changes):
        return _CALM
    return _CLOCK if changes else _HEARTBEAT

"""A program that runs: its loop, time, robot and thread, from the first tick to the last."""

from __future__ import annotations

import atexit
import inspect
import math
import os
import sys
import threading
import warnings
import weakref
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path as FilePath
from time import monotonic
from types import NoneType, TracebackType
from typing import Any, Literal, Self, TypeVar

from lrp_jupyter import programs
from lrp_jupyter.arguments import check_callable, check_choice, check_number, check_type
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import check_options, make_bridge
from lrp_jupyter.errors import FileError, LRPError, SessionClosedError, SessionTimeoutError
from lrp_jupyter.files import read_text
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.interpreter.trace_events import Observer
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.lookup import means
from lrp_jupyter.language.parser import parse, scan
from lrp_jupyter.language.program import Finding, Path, Program, path_text
from lrp_jupyter.language.robot_members import RobotMembers
from lrp_jupyter.live.clock import Clock, MonotonicClock
from lrp_jupyter.live.past.replay import Entry, play
from lrp_jupyter.live.recorder import Recorder
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.checking import members_of
from lrp_jupyter.live.running.driver import Driver
from lrp_jupyter.live.running.foreign_code import surviving
from lrp_jupyter.live.running.frame import Frame, Status, missing_state
from lrp_jupyter.live.running.live_variables import LiveVariables
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.running.output import Output
from lrp_jupyter.live.teller import make_teller

_GLANCE = 1.0  # wall seconds of one wait, which Ctrl-C does not end if another thread gets the signal

Value = TypeVar("Value")
Until = str | Path | Callable[[Frame], object]
"""The end of a run or a wait: a state, by bare name or path, or a condition on a frame."""

sessions: weakref.WeakSet[Runner] = weakref.WeakSet()
"""All that exist, open or closed."""
_ending: weakref.WeakSet[threading.Thread] = weakref.WeakSet()
"""The threads that end sessions which were dropped."""
_LEAVING = 15.0  # s that the end of Python waits for one of them


class Runner:
    """What a session is apart from what is asked and changed: it is opened, runs, is waited for, and ends."""

    def __init__(
        self,
        program: Program | str = "",
        bridge: str | type[Bridge] | Bridge | None = "none",
        clock: Clock | None = None,
        rate: float = 10,
        *,
        namespace: dict[str, Any] | None = None,
        on_active_edit: Literal["restart", "keep"] = "restart",
        on_issue: Literal["record", "pause"] = "record",
        name: str = "lrp",
        journal: int | None = None,
        speed: float = 1.0,
        driver: Literal["thread", "asyncio"] | None = None,
        hung_after: float = 2.0,
        dead_man: float | None = None,
        start: str | Path | None = None,
        **options: Any,
    ) -> None:
        check_type("program", program, (str, Program), "a text or a Program")
        check_type("name", name, str, "a text")
        check_type("namespace", namespace, (dict, NoneType), "a dict")
        check_type("clock", clock, (Clock, NoneType), "a clock, such as `VirtualClock()`")
        if clock is not None and speed != 1:
            raise ValueError("Pass either `clock` or `speed`: a clock has a speed of its own.")
        if driver is None:
            driver = "asyncio" if sys.platform == "emscripten" else "thread"
        check_choice("driver", driver, ("thread", "asyncio"))
        check_number("hung_after", hung_after, "a number of seconds", above=0)
        if dead_man is not None:
            check_number("dead_man", dead_man, "a number of seconds", above=0)
        check_options(bridge, options, _KEYWORDS)
        if isinstance(program, str):
            program = parse(program, f"<lrp {name}>")
        self.name = name
        self.namespace = {} if namespace is None else namespace
        self.driver: Literal["thread", "asyncio"] = driver
        """The kind of driver: a thread of its own, or a task of the running event loop."""
        self.output = Output()
        self.findings: tuple[Finding, ...] = ()
        """The findings of the checks about the last text."""
        self._checked: tuple[Program | None, RobotMembers | None, tuple[Finding, ...]] = None, None, ()
        self._text = program.text
        self._journal = journal
        self.log = ""
        """The file into which a recording writes what a person looks at; empty: none does."""
        self._watched_by: Recorder | None = None
        self._until_closed = ExitStack()
        self._script: deque[Entry] = deque()  # what was recorded, and is repeated when it runs
        self.bridge = make_bridge(bridge, **options)
        self._members: tuple[object, RobotMembers] = self.bridge.nodes.table, members_of(self.bridge)
        interpreter = Interpreter(
            program,
            robot=self.bridge.robot,
            namespace=self.namespace,
            on_active_edit=on_active_edit,
            on_issue=on_issue,
            journal=journal,
            output=self.output.print,
            start=start,
        )
        self._changed = threading.Condition()
        self._warned = False
        self._version = 0  # incremented whenever waiting callers must check again
        self._listeners: tuple[Callable[[], None], ...] = ()
        self._loop = Loop(
            interpreter,
            self.bridge,
            MonotonicClock(speed) if clock is None else clock,
            rate,
            self._notifier(),
            journal != 0,
            partial(getattr, self.output, "count"),
        )
        self._loop.timing.follows = clock is None
        self.output.written = partial(self._loop.emit, "printed")
        self._teller = make_teller(self._loop, name)
        self._driver = Driver(self._loop, name)
        self.ask, self.submit = self._driver.ask, self._driver.submit  # internal, not in `help`, `dir`
        self.dead_man = dead_man
        """Wall seconds without a view after which the program pauses; None: it never does for that."""
        self._start_driver = partial(self._driver.start, driver, hung_after, dead_man)
        sessions.add(self)
        self._dropped = weakref.finalize(self, _drop, name, self._driver, self._loop, self.bridge)
        self._dropped.atexit = False

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], *arguments: Any, **keywords: Any) -> Self:
        """Create a session of a file's text; other arguments are those of :class:`Session`.

        The name is that of the file, unless it is given. The simulator loads the world that the text names
        (``; world: line``), unless it is given.

        Raises
        ------
        FileError
            The file cannot be read.
        LRPSyntaxError
            The text is not a valid program.
        """
        file = FilePath(path)
        text = read_text(file)
        bridge = keywords.get("bridge", arguments[0] if arguments else "none")
        if bridge == "sim" and (world := programs.world_of(text, file.parent)) not in (None, "none"):
            keywords.setdefault("world", world)
        return cls(text, *arguments, **{"name": file.stem, **keywords})

    def __repr__(self) -> str:
        frame = self.frame
        active = ", ".join(map(path_text, frame.active)) or "nothing"
        return f"<{type(self).__name__} {self.name}: {frame.status}, tick {frame.tick}, {active} active>"

    def __dir__(self) -> list[str]:
        return [name for name in super().__dir__() if name not in ("ask", "submit")]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- the state of the run --------------------------------------------------------------------

    @property
    def frame(self) -> Frame:
        """The newest frame, with the status as it is now; from any thread."""
        loop = self._loop
        frame, status, hung = loop.frame, loop.status, loop.hung
        if status in ("stopped", "closed", "broken"):
            if frame.status == status:
                return frame
            return replace(frame, status=status, reason=loop.reason, achieved_rate=0.0, achieved_speed=0.0)
        if hung is None:
            return frame
        return replace(frame, status="hung", reason=str(hung), hung=hung)

    @property
    def status(self) -> Status:
        """See :attr:`Frame.status <lrp_jupyter.live.running.frame.Frame>`."""
        return self.frame.status

    @property
    def issues(self) -> Sequence[Issue]:
        """The faults of the program so far."""
        return self._loop.frame.issues

    def clear_issues(self) -> None:
        """Forget the issues so far; a fault that is still there is an issue again when it occurs.

        What was noted about commands of the program is forgotten, too: that they were limited, or ended by a
        stop of the robot.
        """
        self._driver.do(do.ClearIssues())

    def traceback_of(self, issue: Issue | None = None) -> TracebackType | None:
        """Return the traceback of an issue's last occurrence, for a debugger: ``pdb.post_mortem(…)``.

        It begins at the block. Each of its frames shows all variables in scope as they are now, and can
        assign them; `robot` is the robot, and `state` the path of the state that was active. Pause the
        program first, or it runs on meanwhile.

        Parameters
        ----------
        issue : Issue, optional
            By default the one that occurred last.

        Returns
        -------
        traceback or None
            None if the issue is not listed any more, or has not occurred in this session.

        Paper: §6.2.
        """
        check_type("issue", issue, (Issue, NoneType), "an issue, one of `session.issues`")
        wanted = issue or self.interpreter.issues.newest
        return self.interpreter.traceback_of(wanted, self.variables.__setitem__) if wanted else None

    @property
    def program(self) -> Program:
        """The program that runs."""
        return self._loop.frame.program

    @property
    def variables(self) -> LiveVariables:
        """The existing variables and their values, by path or by an unambiguous name.

        Assigning sets the value between two ticks: ``session.variables["nobump"] = True``. To read values
        and texts of one moment, use :attr:`frame`.
        """
        return LiveVariables(lambda: self.frame, lambda path, value: self._driver.do(do.Assign(path, value)))

    @property
    def text(self) -> str:
        """The last text, whether it is a valid program or not."""
        return self._text

    @property
    def fault(self) -> str:
        """The traceback of the fault that broke the session, or an empty text."""
        return self._loop.fault

    @property
    def interpreter(self) -> Interpreter:
        """The interpreter: for observers and tests. It belongs to the thread that drives the loop."""
        return self._loop.interpreter

    # -- running ---------------------------------------------------------------------------------

    def open(self) -> None:
        """Connect the robot, once; :meth:`start`, :meth:`step` and :meth:`run` do it too."""
        self._driver.check_open()
        self.bridge.open()

    def start(self, paused: bool = False) -> None:
        """Start or resume; after :meth:`stop`, from the beginning. Does nothing while the program runs.

        A broken session starts again, with the last text.
        """
        self.open()
        if self._loop.fault:
            self.reset()
        if not self._driver.running:
            self._leave_stop()
            self._start_driver()
        if not paused:
            self.resume()

    def _leave_stop(self) -> None:
        """After a stop, reset the program, so that it starts from the beginning."""
        if self._loop.status == "stopped":
            with self._driver.exclusive("start"):
                self._loop.status = "ready"
                self.reset()

    def pause(self, reason: str = "") -> None:
        """Pause program, time and robot. Paper: §6.3."""
        check_type("reason", reason, str, "a sentence")
        self._driver.do(do.Pause(reason))

    def resume(self) -> None:
        """Continue after a pause. Paper: §6.3."""
        self._driver.do(do.Resume())

    def step(self) -> None:
        """Run one tick and one period of time; a running program is paused first. Paper: §6.3."""
        self.open()
        self._driver.do(do.Step())

    def reset(self) -> None:
        """Restart the program at the next tick; the robot stops, its world stays.

        A broken session becomes whole: it is ready to start, with the last text.
        """
        if self._loop.fault:
            program, _ = scan(self._text, f"<lrp {self.name}>")
            self._driver.do(do.Renew(self.program if program is None else program))
        else:
            self._driver.do(do.Reset())

    def stop_robot(self) -> None:
        """Stop the robot at once, whatever the program does, then pause."""
        self.bridge.stop_all()
        self.submit(do.Pause("The robot was stopped."))

    def stop(self) -> None:
        """End the run: stop the robot, end the threads; :meth:`start` then starts from the beginning.

        The robot stands when the ``onend`` actions of the program run, and is stopped again after them. They
        have a second, as a block that is still running has.
        """
        self._end("stopped")

    def close(self) -> None:
        """Stop, and disconnect the robot. A second call does nothing."""
        self._end("closed")
        try:
            self._until_closed.close()
        except FileError as error:
            self.output.print(f"{error}\n")
        self.bridge.close()
        self._dropped.detach()

    def _end(self, status: Literal["stopped", "closed"]) -> None:
        bridge = self.bridge
        self._driver.leave()  # first: a stop takes time, in which no tick may begin
        if bridge.is_open:
            bridge.stop_all()
        over = self._driver.end()
        stuck = "" if over else self._driver.left_running
        self._loop.halt(status)
        if over and self._loop.must_end:
            try:
                self._driver.leave_program()
            except SessionTimeoutError as error:
                last = self.interpreter.issues.newest
                stuck = "" if last is not None and last.kind == "did not return" else str(error)
        if stuck:
            bridge.safety.notice("fault", stuck)
        if bridge.is_open and (bridge.unstopped or bridge.safety.motion or not over):
            bridge.stop_all()
        if over:
            self._loop.publish()
        self._notify()

    def interrupt(self) -> bool:
        """Interrupt the block that runs now, which becomes an issue; return whether there is one.

        The tick continues after the block. A block that does not return is interrupted without this call
        when an edit, a pause, a step, a reset or a rewind has waited for it for a second.
        """
        return self._driver.interrupt()

    def seen(self) -> None:
        """Reset the dead man's switch: the robot is being watched."""
        self._driver.seen()

    def run(
        self,
        seconds: float | None = None,
        until: Until | None = None,
        after_tick: Callable[[], object] | None = None,
        *,
        limit: float = 10.0,
    ) -> bool:
        """Run on the caller's thread, in virtual time, without waiting.

        The session's own thread is suspended meanwhile. A pause of the program ends the run.

        Parameters
        ----------
        seconds : float, optional
            The longest duration, in seconds of the session.
        until : str, path or callable, optional
            A state to be entered, or a condition on the frame; checked after every tick.
        after_tick : callable, optional
            Called after every tick instead of `until`; a true result ends the run. It is cheaper, because
            no frame is created.
        limit : float, optional
            Wall seconds that one block may take; may be infinite.

        Returns
        -------
        bool
            Whether `until` (or `after_tick`) ended the run; without them, whether the time has passed.

        Raises
        ------
        UnknownElementError
            The program has no such state.
        LRPError
            A block of the program itself is the caller.
        SessionTimeoutError
            A block has exceeded the limit. It was interrupted, and the program is paused.
        Exception
            Whatever `until` or `after_tick` raises; the program is paused.

        Warns
        -----
        UserWarning
            Once, if commands were not sent because the robot was not armed.
        """
        if seconds is None and until is None and after_tick is None:
            raise ValueError("How long should it run? Pass `seconds`, `until`, or both.")
        if seconds is not None:
            check_number("seconds", seconds, "a number", least=0)
        if after_tick is not None:
            check_callable("after_tick", after_tick)
        check_number("limit", limit, "a number of seconds", above=0)
        self._driver.refuse_inside("run")
        self.open()
        with self.driving(limit):
            ends = after_tick if until is None else self._watch(until)
            self._leave_stop()
            self._loop.apply_queued()
            span = math.inf if seconds is None else seconds
            end = self._loop.timing.now + span
            if self._script and play(self._loop, self._script, end, ends):
                return True
            ended = self._loop.run(end - self._loop.timing.now, ends)
            self._warn_of_disarmed()
            return ended if ends is not None else self._loop.timing.now >= end - 1e-6

    def _warn_of_disarmed(self) -> None:
        """Warn, once, that commands were not sent because the robot was not armed."""
        bridge = self.bridge
        kinds = {notice.kind for notice in bridge.safety.notices}
        if self._warned or not bridge.hardware or "armed" in kinds or "disarmed" not in kinds:
            return
        self._warned = True
        message = (
            f"The bridge `{bridge.name}` is disarmed: commands are recorded, and not sent. Call "
            f"`session.bridge.arm()` before the run, or set `hardware = False` in `{type(bridge).__name__}` "
            "if nothing real moves."
        )
        warnings.warn(message, stacklevel=3)

    @contextmanager
    def driving(self, limit: float) -> Iterator[None]:
        """Drive the loop on the calling thread; a block that takes longer than `limit` is interrupted."""
        with self._driver.exclusive("run"), self._driver.limited(limit):
            yield

    def _watch(self, until: Until) -> Callable[[], bool]:
        """Return the check that :meth:`run` calls after every tick."""
        loop = self._loop
        if callable(until):
            return lambda: bool(until(loop.make_frame()))
        state, interpreter = until, loop.interpreter
        if (missing := missing_state(state, interpreter.program)) is not None:
            raise missing
        before = _count(interpreter, state)
        return lambda: _count(interpreter, state) > before or loop.is_active(state)

    def wait_for(self, condition: Until, timeout: float | None = None) -> Frame:
        """Wait, in wall time, until a state is active (or was, however shortly) or a condition holds.

        Returns
        -------
        Frame
            The frame in which that was the case.

        Raises
        ------
        SessionTimeoutError
            It did not happen within `timeout` seconds.
        LRPError
            It cannot happen: the session was not started, is stopped, broken or closed, or is driven by
            this very thread.
        """
        if timeout is not None:
            check_number("timeout", timeout, "a number of seconds", least=0)
        self._driver.refuse_inside("wait_for")
        end = math.inf if timeout is None else monotonic() + timeout
        before = 0 if callable(condition) else self._loop.frame.count_of(condition)
        runs = self._driver.runs_elsewhere
        while True:
            version, frame = self._version, self.frame
            if callable(condition):
                if condition(frame):
                    return frame
            elif frame.is_active(condition) or frame.count_of(condition) > before:
                return frame
            if frame.status in ("stopped", "broken", "closed"):
                raise LRPError(f"The session is {frame.status}. {frame.reason}".strip())
            if not runs:
                why = "is driven by this very thread" if self._driver.running else "was not started"
                raise LRPError(f"The session {why}. Call `start` first, or use `run(until=…)`.")
            if (left := end - monotonic()) <= 0:
                what, missing = "The condition was not met", ""
                if not callable(condition):
                    what = f"`{path_text(as_path(condition))}` was not entered"
                    missing = str(missing_state(condition, frame.program) or "")
                raise SessionTimeoutError(f"{what} within {timeout:g} s: {self!r}. {missing}".rstrip())
            with self._changed:
                self._changed.wait_for(lambda old=version: self._version != old, min(left, _GLANCE))  # type: ignore[misc]

    @contextmanager
    def _closed_on_error(self) -> Iterator[None]:
        try:
            yield
        except BaseException:
            self.close()
            raise

    # -- commands, events and frames -------------------------------------------------------------

    def call(self, function: Callable[[], Value]) -> Value:
        """Call a function between two ticks, when the robot's world may be changed, and return its value."""
        check_callable("function", function)
        value: Value = self._driver.do(do.Call(function))
        return value

    def _value(self, what: str, function: Callable[[Loop], Value]) -> Value:
        """Return what a function returns for the loop between two ticks, unless a block calls this method."""
        self._driver.refuse_inside(what)
        return self.call(partial(function, self._loop))

    def observe(self, observer: Observer) -> Callable[[], None]:
        """Subscribe a function to every event of the interpreter; return a function that ends this.

        It is called on the thread that drives the loop, when a tick or a command is over. One that raises an
        exception is not called again.
        """
        ends: list[Callable[[], None]] = []

        def end() -> None:
            while ends:
                ends.pop()()

        def unsubscribe() -> None:
            with suppress(SessionClosedError):
                self._driver.do(do.Call(end))

        check_callable("observer", observer)
        guarded = surviving(observer, end)
        self._driver.do(do.Call(lambda: ends.append(self.interpreter.observe(guarded))))
        return unsubscribe

    def on_tick(self, callback: Callable[[], None]) -> Callable[[], None]:
        """Call a function after every tick, soon; return a function that ends this.

        It is called on the thread that drives the loop, where robot and interpreter may be read. One that
        raises an exception is not called again.
        """
        calls = self._loop.after_tick

        def end() -> None:
            if guarded in calls:
                calls.remove(guarded)

        def end_soon() -> None:
            with suppress(SessionClosedError):
                self._driver.ask(do.Call(end))

        check_callable("callback", callback)
        guarded = surviving(callback, end)
        self._driver.ask(do.Call(lambda: calls.append(guarded)))
        return end_soon

    def listen(self, callback: Callable[[], None]) -> Callable[[], None]:
        """Subscribe a function to new frames; return a function that ends this.

        It is called on the thread that publishes the frame, and must not wait there. One that raises an
        exception is not called again.
        """

        def unlisten() -> None:
            self._listeners = tuple(other for other in self._listeners if other is not guarded)

        check_callable("callback", callback)
        guarded = surviving(callback, unlisten)
        self._listeners = (*self._listeners, guarded)
        return unlisten

    def _notifier(self) -> Callable[[], None]:
        """Return :meth:`_notify` for the loop, whose thread must not keep a dropped session alive."""
        method = weakref.WeakMethod(self._notify)

        def notify() -> None:
            if (call := method()) is not None:
                call()

        return notify

    def _notify(self) -> None:
        with self._changed:
            self._version += 1
            self._changed.notify_all()
        if self._teller is not None:
            self._teller.published(self.name)
        for listener in self._listeners:
            listener()


def _count(interpreter: Interpreter, state: str | Path) -> int:
    program, visits = interpreter.program, interpreter.visits
    return sum(count.times for path, count in visits.items() if means(program, state, path))


def _drop(name: str, driver: Driver, loop: Loop, bridge: Bridge) -> None:
    """End what a session has started that was dropped without :meth:`Session.close`."""
    if not driver.running:
        return

    def end() -> None:
        driver.leave()
        bridge.stop_all()
        driver.end()
        loop.halt("closed")
        bridge.close()

    # The collector may run on any thread, with any lock held; only a thread of its own may wait.
    thread = threading.Thread(target=end, name=f"lrp {name} end", daemon=True)
    _ending.add(thread)
    thread.start()
    message = f"The session `{name}` was dropped while it ran, and ended. Call `close`, or use `with`."
    warnings.warn(message, ResourceWarning, stacklevel=2)


_KEYWORDS = tuple(inspect.signature(Runner).parameters)[:-1]
"""The keywords of a session, one of which may be meant by an unknown option."""


@atexit.register
def _close_all() -> None:
    for session in tuple(sessions):
        if session.status != "closed":
            session.close()
    for thread in tuple(_ending):
        thread.join(_LEAVING)

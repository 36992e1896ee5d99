"""Sessions: running programs that can be changed while they run.

The interpreter is a function of time: it has no clock, no thread and no robot. A session adds them, in
three parts:

* the :class:`~lrp_jupyter.live.loop.Loop` ticks, advances the time, and applies commands between
  two ticks;
* the :class:`~lrp_jupyter.live.driver.Driver` decides which thread may run the loop (a thread of its
  own, asyncio, the caller of :meth:`Session.run`), and a monitor watches it;
* the :class:`Session`, this file, may be called from any thread.

*In.* A call of a session becomes a command, a frozen value in a queue; the loop applies it between
two ticks, as a whole. A block that does not return is interrupted for an edit and for most commands.
The caller waits for that, a few seconds at most: then an error names the block that is in the way,
and the command stays in the queue. ``submit`` does not wait. A call from inside a
block of the program itself does not wait either, because the block would wait for its own end. If
no driver is active, the caller applies the command itself.

*Out.* After a tick the loop makes a frozen frame, and stores it by one assignment.
Readers get the newest one; what must not be missed is counted in it. No view ever touches the
interpreter.

*Edits.* The caller's thread checks a text, so that a keystroke costs the robot nothing. A text
that is not a valid program is kept, and the last program continues to run. :attr:`Session.program` is
the running program, :attr:`Session.text` the typed text.

*Faults.* Faults of the program are issues, and nothing stops. A fault of this package stops the robot
and the session, which then is ``broken`` and keeps the traceback; it never looks like a fault of the
program. ``reset`` or ``start`` make it whole again, with the last text. A bridge that fails is ``lost``,
and the loop continues. No exception ends the loop's thread.

*The end.* ``close`` stops the robot first, then ends and joins the threads; it may be called
twice. Sessions that are still open when Python exits are closed then.

Paper: §5.1 (the loop and its rate), §6 (live programming), §6.3 (pause), §6.4 (forcing states).
"""

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
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError, Future
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path as FilePath
from time import monotonic
from types import NoneType, TracebackType
from typing import Any, Literal, Self, cast

from lrp_jupyter import programs
from lrp_jupyter.arguments import check_callable, check_choice, check_number, check_type
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import check_options, make_bridge
from lrp_jupyter.bridges.recorded import RecordedBridge
from lrp_jupyter.errors import (
    BridgeError,
    FileError,
    LRPError,
    SessionClosedError,
    SessionTimeoutError,
    sentence_of,
)
from lrp_jupyter.files import read_text, shown, write_file
from lrp_jupyter.interpreter.events import Observer
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.expressions import Evaluation
from lrp_jupyter.language.lookup import find, means
from lrp_jupyter.language.names import as_path
from lrp_jupyter.language.parser import parse, scan
from lrp_jupyter.language.program import Element, Finding, Path, Program, path_text
from lrp_jupyter.language.rename import rename as renamed_text
from lrp_jupyter.language.robot import RobotMembers
from lrp_jupyter.language.unmeant import Cursor, Judgement, judge
from lrp_jupyter.live import commands as do
from lrp_jupyter.live.breakpoint import Breakpoint, BreakpointKind
from lrp_jupyter.live.breakpoints import breakpoint_of
from lrp_jupyter.live.checking import members_of
from lrp_jupyter.live.checkpoints import names_of
from lrp_jupyter.live.clock import Clock, MonotonicClock, VirtualClock
from lrp_jupyter.live.driver import Driver
from lrp_jupyter.live.foreign import surviving
from lrp_jupyter.live.fork import ForkStart, check_repeated, fork_start, private_namespace
from lrp_jupyter.live.frame import Frame, Status, missing_state
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.output import Output
from lrp_jupyter.live.past import animation_of, frame_at, tick_of
from lrp_jupyter.live.plots import Plot, plotting_named
from lrp_jupyter.live.reason import Reason
from lrp_jupyter.live.recorder import Recorder, start_of
from lrp_jupyter.live.replay import Entry, Ticked, play, repeat, tested_again, without_edits
from lrp_jupyter.live.timeline import Timeline, TimelineCursor, timeline_of
from lrp_jupyter.live.trials import Trial, Trials
from lrp_jupyter.live.variables import LiveVariables
from lrp_jupyter.live.what_if import Course, Observation, WhatIf, divergence
from lrp_jupyter.live.why.answers import Answers
from lrp_jupyter.logs import open_log, unused

__all__ = ["Session", "Until"]

_ABSENT = object()
_GLANCE = 1.0  # wall seconds of one wait, which Ctrl-C does not end if another thread gets the signal
_REPEATING = 2.0  # wall seconds that a block may take in a fork that others wait for

Until = str | Path | Callable[[Frame], object]
"""The end of a run or a wait: a state, by bare name or path, or a condition on a frame."""

_open_sessions: weakref.WeakSet[Session] = weakref.WeakSet()
_ending: weakref.WeakSet[threading.Thread] = weakref.WeakSet()
"""The threads that end sessions which were dropped."""
_LEAVING = 15.0  # s that the end of Python waits for one of them


class Session:
    """A running program with its loop, time, robot and thread.

    Parameters
    ----------
    program : Program or str
        A text that is not a valid program raises; to start from one, create an empty session and pass the
        text to :meth:`edit`.
    bridge : str, Bridge or subclass of Bridge
        A name (``"none"``, ``"sim"``, …) or a class, to which `options` are passed, or an existing bridge.
    clock : Clock, optional
        A :class:`~lrp_jupyter.live.clock.VirtualClock` never waits; by default wall time at this `speed`.
    rate : float
        Ticks per second; 0 for as many as possible.
    namespace : dict, optional
        Names that blocks can read (a notebook's ``user_ns``); never written, except for `__builtins__`, as by
        ``exec``.
    on_active_edit : {"restart", "keep"}
    on_issue : {"record", "pause"}
    name : str
        Appears in tracebacks and names the threads.
    journal : int, optional
        How many ticks are remembered, and can be rewound; by default 10,000 or those of 10 minutes, whichever
        are more, and fewer if they take more than about 100 MB.
    speed : float
        Seconds of the session per wall second; ``math.inf``: never wait.
    driver : {"thread", "asyncio"}, optional
        The kind of driver after :meth:`start`; default: a thread, and in a browser, where there are none, a
        task of the running event loop.
    hung_after : float
        Wall seconds after which a block that does not return is reported.
    dead_man : float, optional
        Wall seconds without :meth:`seen` after which the program pauses.
    **options
        For the bridge: ``world="line"``.

    Raises
    ------
    LRPSyntaxError
        The text is not a valid program.
    BridgeError
        There is no such bridge, or it does not take these options.
    TypeError, ValueError
        Another argument has a wrong type or value.

    Examples
    --------
    >>> program = "(machine m (state a) (state b) (ontime 300 a -> b)) (spawn m a)"
    >>> with Session(program) as session:
    ...     session.run(until="b", seconds=5)
    True
    """

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
        self.output.written = partial(self._loop.emit, "printed")
        self._driver = Driver(self._loop, name)
        self.ask, self.submit = (
            self._driver.ask,
            self._driver.submit,
        )  # of commands: internal, not in `help`, `dir`
        self.dead_man = dead_man
        """Wall seconds without a view after which the program pauses; None: it never does for that."""
        self._start_driver = partial(self._driver.start, driver, hung_after, dead_man)
        _open_sessions.add(self)
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
        active = ", ".join("/".join(path) for path in frame.active) or "nothing"
        return f"<Session {self.name}: {frame.status}, tick {frame.tick}, {active} active>"

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
        """See :attr:`Frame.status <lrp_jupyter.live.frame.Frame>`."""
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
        """End the run: stop the robot, end the threads; :meth:`start` then starts from the beginning."""
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
        _open_sessions.discard(self)

    def _end(self, status: Literal["stopped", "closed"]) -> None:
        bridge = self.bridge
        self._driver.leave()  # first: a stop takes time, in which no tick may begin
        if bridge.is_open:
            bridge.stop_all()
        over = self._driver.end()
        if bridge.is_open and (bridge.unstopped or bridge.safety.motion):
            bridge.stop_all()
        self._loop.halt(status)
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
        with self._driver.exclusive("run"), self._driver.limited(limit):
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

    # -- changing the program --------------------------------------------------------------------

    def edit(self, text: str) -> tuple[Finding, ...]:
        """Continue with another text; never raises because of the text. Paper: §6.1.

        Returns
        -------
        tuple of Finding
            The findings of the checks. If the text is not a valid program, the last program keeps running.
        """
        _, answer = self.offer(text)
        try:
            self._driver.wait(answer, do.ReplaceProgram)
        except CancelledError:  # a newer edit came before this one was applied
            pass
        except LRPError as error:  # the text is kept, and applied when the block returns
            late = Finding("LRP690", "warning", str(error), 1, 1, 1, 1)
            self.findings = (*self.findings, late)
        return self.findings

    def offer(self, text: str, *cursors: Cursor) -> tuple[Judgement, Future[Any]]:
        """Continue with another text as :meth:`edit` does, without waiting until it is applied.

        Parameters
        ----------
        text : str
        *cursors : Cursor
            Where the text is being edited: what is only half typed there waits.

        Returns
        -------
        Judgement
            Its program is None if the text is not a valid program.
        Future
            Its result is the :class:`~lrp_jupyter.interpreter.patching.Patch`, or None without a program.
        """
        check_type("text", text, str, "the text of a program")
        self._driver.check_open()
        judgement = self.judge(text, *cursors)
        program, self.findings, unmeant, _ = judgement
        self._text = text
        if program is None:
            nothing: Future[Any] = Future()
            nothing.set_result(None)
            return judgement, nothing
        names_of(link(program))  # here and now, so that the loop stands still only for the swap of plans
        if unmeant is not None:
            link(unmeant.instead)
        return judgement, self._driver.ask(do.ReplaceProgram(program, unmeant))

    def offer_rename(self, kind: str, path: Path, new_name: str) -> tuple[Judgement, Future[Any]]:
        """Rename as :meth:`rename` does, without waiting until it is applied.

        Returns
        -------
        Judgement
            Of the new text.
        Future
            Its result is the new text.

        Raises
        ------
        UnknownElementError
            There is no such element.
        ValueError
            The name cannot be used.
        """
        self._driver.check_open()
        judgement = self.judge(renamed_text(self.program, kind, path, new_name))
        assert judgement.program is not None
        self._text, self.findings = judgement.program.text, judgement.findings
        return judgement, self._driver.ask(do.Rename(kind, path, new_name))

    def judge(self, text: str, *cursors: Cursor) -> Judgement:
        """Return what a text means, for the robot and the namespace of this session; nothing changes."""
        program, findings = scan(text, f"<lrp {self.name}>")
        if program is not None:
            findings = self.check(program)
        return judge(text, program, findings, cursors, self.program, self._check_again)

    def _check_again(self, program: Program) -> tuple[Finding, ...]:
        """Return the findings about a program, which probably is the one checked before."""
        members = self._robot_members()
        checked, known, findings = self._checked
        if checked is not program or known is not members:
            findings = self.check(program)
            self._checked = program, members, findings
        return findings

    def check(self, program: Program | str) -> tuple[Finding, ...]:
        """Return the findings about a program, for the robot and the namespace of this session."""
        check_type("program", program, (str, Program), "a text or a Program")
        try:
            return check(program, self.namespace, self._robot_members())
        except Exception as error:  # a fault of the checks is reported as such and does not block the edit
            message = f"The checks themselves failed, not the program: {sentence_of(error)}"
            return (Finding("LRP699", "warning", message, 1, 1, 1, 1),)

    def _robot_members(self) -> RobotMembers:
        table, members = self._members
        if self.bridge.is_open and table is not self.bridge.nodes.table:  # a new table after every change
            table = self.bridge.nodes.table
            members = members_of(self.bridge)
            self._members = table, members
        return members

    def save(self, path: str | FilePath) -> None:
        """Write the text to a file, with its own line ends: as a whole or not at all.

        Raises
        ------
        FileError
            It cannot be written.
        """
        write_file(path, self._text)

    def rename(self, kind: str, path: str | Path, new_name: str) -> str:
        """Rename an element with all its references; nothing restarts. Return the new text.

        Raises
        ------
        UnknownElementError
            There is no such element.
        ValueError
            The name cannot be used, or the text is not the running program.
        """
        check_type("kind", kind, str, "the kind of an element, such as `state`")
        check_type("new_name", new_name, str, "a name")
        if self._text != self.program.text:
            raise ValueError(
                "The text is not the running program, so nothing can be renamed now. Correct it first."
            )
        text: str = self._driver.do(do.Rename(kind, as_path(path), new_name))
        if text:
            self._text = text
        return text

    # -- settings --------------------------------------------------------------------------------

    @property
    def rate(self) -> float:
        """Ticks per second, 0 for as many as possible; may be set at any time. Paper: §5.1."""
        return self._loop.timing.rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._driver.do(do.SetRate(rate))

    @property
    def speed(self) -> float:
        """Seconds of the session per wall second; may be set at any time."""
        return self._loop.timing.clock.speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._driver.do(do.SetSpeed(speed))

    @property
    def on_active_edit(self) -> str:
        """The effect of a change to an active state, ``restart`` or ``keep``; may be set at any time."""
        return self.interpreter.on_active_edit

    @on_active_edit.setter
    def on_active_edit(self, policy: Literal["restart", "keep"]) -> None:
        self._driver.do(do.SetPolicy("on_active_edit", policy))

    @property
    def on_issue(self) -> str:
        """The effect of an issue, whenever it occurs: ``record`` or ``pause``; may be set at any time."""
        return self.interpreter.on_issue

    @on_issue.setter
    def on_issue(self, policy: Literal["record", "pause"]) -> None:
        self._driver.do(do.SetPolicy("on_issue", policy))

    # -- forcing ---------------------------------------------------------------------------------

    def transition_to(self, state: str | Path) -> None:
        """Go to a state as if a transition led there. An unknown one is an issue. Paper: §6.4."""
        self._driver.do(do.Force(as_path(state)))

    def teleport_to(self, state: str | Path) -> None:
        """Make a state active without any action. An unknown one is an issue. Paper: §6.4."""
        self._driver.do(do.Force(as_path(state), teleport=True))

    def fire(self, transition: str | Path) -> None:
        """Go where a transition leads, whatever its condition: one of its source states must be active.

        The actions of the states on the way run, as in :meth:`transition_to`. Paper: §6.4.

        Parameters
        ----------
        transition : str or path
            Its name, label or id if that is unambiguous, else its path: ``"follower/tlooking"``.

        Raises
        ------
        UnknownElementError
            There is no such transition, or there are several.
        ValueError
            No state that it leaves is active, or it leads nowhere.
        """
        self._driver.do(do.Fire(find(self.program, "transition", transition).path))

    def set_variable(self, variable: str | Path, value: object = _ABSENT, *, evaluate: str = "") -> None:
        """Assign a value to a variable, or the value of a Python expression.

        Parameters
        ----------
        variable : str or path
            Its name if that is unambiguous, else its path: ``"follower/nobump"``.
        value : object
            The value. A text is evaluated like `evaluate`; to assign a text itself, write
            ``session.variables["name"] = "text"``.
        evaluate : str
            A Python expression, evaluated in the variable's scope.

        Raises
        ------
        UnknownElementError
            There is no such variable now, or there are several.
        """
        check_type("evaluate", evaluate, str, "a text, a Python expression")
        if (value is _ABSENT) == (not evaluate):
            raise TypeError("Pass either a value or `evaluate`, an expression.")
        expression = evaluate or value
        if isinstance(expression, str):
            self._driver.do(do.SetVariable(as_path(variable), expression))
        else:
            self._driver.do(do.Assign(as_path(variable), value))

    def rewind(self, ticks: int = 1) -> None:
        """Go back by so many ticks: program, variables, simulated world, time. What came later is gone.

        Objects that were changed in place stay as they are, and so do issues, counts, settings and the state
        of the random numbers.

        Parameters
        ----------
        ticks : int
            0 or more; with 0, what came after the last tick is undone.

        Raises
        ------
        ValueError
            Fewer ticks can be undone.
        BridgeError
            A real robot is armed.
        """
        check_type("ticks", ticks, int, "a number of ticks")
        check_number("ticks", ticks, "a number of ticks", least=0)
        before = self.program
        self._driver.do(do.Rewind(ticks))
        if self.program is not before:  # edits were undone, too
            self._text = self.program.text

    # -- breakpoints -----------------------------------------------------------------------------

    @property
    def breakpoints(self) -> tuple[Breakpoint, ...]:
        """The breakpoints, by number."""
        known = self._loop.breakpoints
        return () if known is None else self._value("breakpoints", lambda: known.all)

    def pause_when(
        self,
        entered: str | Path | None = None,
        *,
        left: str | Path | None = None,
        fires: str | Path | None = None,
        event: str | Path | None = None,
        condition: str = "",
        machine: str | Path = (),
        after: int = 1,
        once: bool = False,
    ) -> Breakpoint:
        """Pause the program, after the tick, whenever something happens.

        Parameters
        ----------
        entered, left : str or path, optional
            A state, by bare name or path.
        fires : str or path, optional
            A transition, by its name, label or path.
        event : str or path, optional
            An event that becomes True, whether a transition waits for it or not. Its block is run once more
            in each tick, so it should only read.
        condition : str, optional
            A Python expression over the variables and ``robot`` that becomes True.
        machine : str or path
            The machine in whose scope the condition is evaluated, while it runs; by default the top level.
        after : int
            The first hit at which it pauses: 1 or more.
        once : bool
            Whether it is switched off when it has paused.

        Returns
        -------
        Breakpoint

        Raises
        ------
        UnknownElementError
            There is no such element, or there are several.
        SyntaxError
            The condition is not an expression.
        TypeError
            None of these is given, or several are; `machine` is given without `condition`.
        ValueError
            `after` is less than 1.
        """
        check_type("after", after, int, "a number of hits")
        check_number("after", after, "a number of hits", least=1)
        check_type("condition", condition, str, "a text, a Python expression")
        given: dict[BreakpointKind, str | Path | None] = {
            "entered": entered,
            "left": left,
            "fired": fires,
            "event": event,
            "condition": condition or None,
        }
        chosen = [(kind, what) for kind, what in given.items() if what is not None]
        if len(chosen) != 1:
            raise TypeError("Pass one of a state, `left`, `fires`, `event` and `condition`.")
        if machine and not condition:
            raise TypeError("`machine` is the scope of a `condition`. To name an element, pass its path.")
        new = breakpoint_of(self.program, *chosen[0], machine or (), after=after, once=once)
        added: Breakpoint = self._driver.do(do.AddBreakpoint(new))
        return added

    def set_breakpoint(self, number: int, enabled: bool | None = None, after: int | None = None) -> None:
        """Switch a breakpoint on or off, or set the first hit at which it pauses; hits are always counted.

        Parameters
        ----------
        number : int
            As :attr:`breakpoints` lists it; the first is 1.
        enabled : bool, optional
            Whether it pauses; by default as before.
        after : int, optional
            The first hit at which it pauses: 1 or more; by default as before.

        Raises
        ------
        ValueError
            There is no such breakpoint.
        """
        if after is not None:
            check_type("after", after, int, "a number of hits")
            check_number("after", after, "a number of hits", least=1)
        self._driver.do(do.ChangeBreakpoint(number, enabled if enabled is None else bool(enabled), after))

    def remove_breakpoint(self, number: int) -> None:
        """Remove a breakpoint.

        Parameters
        ----------
        number : int
            As :attr:`breakpoints` lists it.

        Raises
        ------
        ValueError
            There is no such breakpoint.
        """
        self._driver.do(do.RemoveBreakpoint(number))

    # -- recording -------------------------------------------------------------------------------

    @contextmanager
    def record(self, path: str | os.PathLike[str], *, looking: bool = False) -> Iterator[None]:
        """Write a recording of this session into a file, as long as the ``with`` block lasts.

        The session can be reproduced from it in another process: see
        :func:`~lrp_jupyter.live.reproduction.reproduce` and ``lrp replay``.

        Parameters
        ----------
        path : str or path
            ``run.lrplog``; compressed as ``run.lrplog.gz``.
        looking : bool
            Whether the recording also has what a person looks at in the pages that show the session, and the
            wall time of that and of inputs.

        Raises
        ------
        ValueError
            The session has run already.
        FileError
            The file cannot be written.
        """
        self._driver.refuse_inside("record")
        self._refuse_late_recording()  # before it would overwrite the file
        with open_log(path) as stream:
            recorder: Recorder = self.call(lambda: self.recorder(stream.write, looking=looking))
            if looking:
                self._watched_by, self.log = recorder, shown(path)
            try:
                yield
            finally:
                self._watched_by, self.log = None, ""
                if self.status == "closed":
                    recorder.end()  # nothing ticks any more
                else:
                    self.call(recorder.end)

    def record_until_closed(self, path: str | os.PathLike[str]) -> None:
        """Write a recording, with what a person looks at, until the session is closed: see `record`.

        If the file exists, the name of the recording gets a number.
        """
        self._until_closed.enter_context(self.record(unused(path), looking=True))

    def looked(self, what: str, about: str = "", on: bool = True) -> None:
        """Write into the recording that a person looks at something, or does something, if that is wanted.

        Parameters
        ----------
        what, about : str
            Its kind and subject.
        on : bool
            Whether that begins.
        """
        recorder = self._watched_by
        if recorder is not None:
            recorder.look(what, about, on)
            with suppress(SessionClosedError):
                self.ask(do.Call(recorder.write_looks))

    def recorder(
        self,
        write: Callable[[str], object],
        seed: int | None = None,
        initials: Mapping[str, str] | None = None,
        looking: bool = False,
    ) -> Recorder:
        """Begin a recording; on the loop's thread, or before it is started.

        Parameters
        ----------
        write : callable
            Receives every line.
        seed : int, optional
            That of Python's random numbers, if the caller has seeded them.
        initials : mapping of str to str, optional
            The expressions that replace initial values of the text.
        looking : bool
            See `record`.
        """
        self._refuse_late_recording()
        self.bridge.open()
        return Recorder(self._loop, write, start_of(self._loop, self.bridge, seed, initials), looking)

    def _refuse_late_recording(self) -> None:
        if self._loop.interpreter.tick or self._loop.record.inputs:
            raise ValueError("The session has run already. A recording begins before the first tick.")

    # -- the past, and what if -------------------------------------------------------------------

    def at(self, tick: int | float) -> Frame:
        """Return the frame of an earlier moment: active states, variables, readings, counts, the robot.

        A value that was changed in place is shown as it is now.

        Parameters
        ----------
        tick : int or float
            A tick; or a time in seconds, as a float: then the last tick that was not after it.

        Raises
        ------
        ValueError
            The tick is not, or no longer, recorded; or the time is negative.
        """
        _check_moment("tick", tick)
        return cast(Frame, self._value("at", lambda: frame_at(self._loop, _tick_of(self._loop, tick))))

    def animation(self, begin: int | float | None = None, end: int | float | None = None) -> str:
        """Return how the simulated world moved, as an animated SVG that repeats by itself.

        Parameters
        ----------
        begin, end : int or float, optional
            Ticks; or times in seconds, as floats. By default all that is remembered of the run in this world.

        Returns
        -------
        str
            A text for a file ``NAME.svg``, which any browser plays. Positions are true within 2 mm.

        Raises
        ------
        BridgeError
            The robot is not a simulated one, or another world was loaded in between.
        ValueError
            A tick is not, or no longer, recorded; or the end is before the beginning.
        """
        for name, at in (("begin", begin), ("end", end)):
            if at is not None:
                _check_moment(name, at)

        def start() -> Callable[[], str] | None:
            ticks = [None if at is None else _tick_of(self._loop, at) for at in (begin, end)]
            return animation_of(self._loop, *ticks)

        draw = self._value("animation", start)
        if draw is None:
            raise BridgeError(f"`{self.bridge.name}` has no simulated world that could be drawn.")
        return cast(str, draw())

    def timeline(
        self, since: TimelineCursor | None = None, plots: Mapping[str, int] | None = None
    ) -> Timeline:
        """Return what happened, in order: states entered, edits, issues, pauses, commands, interventions.

        Parameters
        ----------
        since : TimelineCursor, optional
            The `cursor` of an earlier answer: only what came after it is returned.
        plots : mapping of str to int, optional
            Names to plot, by their whole paths, each with the tick up to which its samples are known.

        Returns
        -------
        Timeline
            Its ``happenings`` are in order; times are in seconds of the run.
        """
        check_type("since", since, (TimelineCursor, NoneType), "the `cursor` of a timeline")
        check_type("plots", plots, (Mapping, NoneType), "a mapping of names to ticks")
        timeline: Callable[[], Timeline] = self._value(
            "timeline", partial(timeline_of, self._loop, since, plots)
        )
        return timeline()

    def plots(self, names: Iterable[str]) -> list[Plot]:
        """Return the recorded samples of variables and readings, with what conditions compare them with.

        Parameters
        ----------
        names : iterable of str
            Variables by path as spawned, or by name where only one has it now; ``robot.`` and the names of
            readings.

        Returns
        -------
        list of Plot
            One for each name.

        Raises
        ------
        UnknownElementError
            There is no such variable or reading, or several variables have that name.
        """
        wanted = _listed("names", names, '["robot.light.data"]')
        for name in wanted:
            check_type("names", name, str, "a list of texts")
        plot: Callable[[], list[Plot]] = self._value("plots", partial(plotting_named, self._loop, wanted))
        return plot()

    def why_not(self, transition: str | Path, at: int | float | None = None) -> Reason:
        """Return why a transition did not fire in a tick, or that it did.

        Parameters
        ----------
        transition : str or path
            Its name, its label (``condition:from->to``) or its path.
        at : int or float, optional
            A tick; or a time in seconds, as a float: then the last tick that was not after it. By default
            the last tick.

        Returns
        -------
        Reason
            Printed, it is a sentence or two.

        Raises
        ------
        UnknownElementError
            There is no such transition, or there are several.
        ValueError
            The tick is not, or no longer, recorded.
        """
        return self._answer("why_not", transition, at)

    def why(self, what: str | Path, at: int | float | None = None) -> Reason:
        """Return why a state is active, or why the robot got its last command.

        Parameters
        ----------
        what : str or path
            A state (``"looking"``) or a command of the robot (``"robot.move"``).
        at : int or float, optional
            A tick; or a time in seconds, as a float: then the last tick that was not after it. By default
            the last tick.

        Returns
        -------
        Reason
            How the state was entered last, or which block gave the command and what became of it.

        Raises
        ------
        UnknownElementError
            There is no such state or command, or there are several.
        ValueError
            The tick is not, or no longer, recorded.
        """
        return self._answer("why", what, at)

    def explain(self, name: str | Path, at: int | float | None = None) -> Reason:
        """Return :meth:`why_not` for a transition, :meth:`why` for a state or a command of the robot.

        Parameters
        ----------
        name : str or path
            A transition; if there is none of that name, a state or ``robot.`` and a command.
        at : int or float, optional
            A tick; or a time in seconds, as a float. By default the last tick.

        Returns
        -------
        Reason

        Raises
        ------
        UnknownElementError
            There is no such transition, state or command, or there are several.
        ValueError
            The tick is not, or no longer, recorded.
        """
        return self._answer("explain", name, at)

    def _answer(
        self, question: Literal["why", "why_not", "explain"], name: str | Path, at: int | float | None
    ) -> Reason:
        if at is not None:
            _check_moment("at", at)

        def answer() -> Reason:
            tick = None if at is None else _tick_of(self._loop, at)
            answers = Answers(self._loop, self._test_again)
            reason: Reason = getattr(answers, question)(name, tick)
            return reason

        return cast(Reason, self._value(question, answer))

    def _test_again(self, tick: int, element: Element) -> Evaluation | Exception | None:
        """Run a tick again in a fork, and return what the test of a transition was there."""
        try:
            start = fork_start(self._loop, tick - 1)
            if isinstance(start.bridge, RecordedBridge):
                return None
            with self._forked(start) as copy, copy.driving(_REPEATING):
                return tested_again(copy._loop, copy._script, element)
        except (ValueError, BridgeError, SessionTimeoutError):
            return None

    def fork(
        self, at: int | float | None = None, program: str | Program | None = None, *, inputs: bool = False
    ) -> Self:
        """Return an independent copy of this session, now or after an earlier tick.

        It is paused, runs in virtual time only (:meth:`run`, :meth:`step`), and nothing that it does is
        noticed here, except what its blocks do to objects of the namespace other than numbers, texts and
        collections. With a simulated robot, or none, it goes on exactly as this session did or will, as far
        as that follows from the program and what came from outside; with any other robot it is fed the
        recorded readings. What its blocks do by themselves, past `robot`, they do once more.

        Parameters
        ----------
        at : int or float, optional
            A tick; or a time in seconds, as a float. By default now.
        program : str or Program, optional
            Another program, applied at once as an edit is.
        inputs : bool
            Whether what came from outside later is repeated when it runs, at the same times, as far as that
            is possible there; edits only if there is no other program.

        Raises
        ------
        ValueError
            The tick is not, or no longer, recorded. :meth:`run` raises it where the session went back to a
            tick while something stayed as it was, such as a list that was changed in place.
        SessionTimeoutError
            A tick before it cannot be repeated, because a block does not return.
        LRPSyntaxError
            The other text is not a valid program.
        """
        if at is not None:
            _check_moment("at", at)
        check_type("program", program, (str, Program, NoneType), "a text or a Program")
        if isinstance(program, str):
            program = parse(program, self.program.filename)

        def start() -> ForkStart:
            return fork_start(self._loop, None if at is None else _tick_of(self._loop, at))

        copy = self._forked(self._value("fork", start))
        with copy._closed_on_error(), copy._driver.exclusive("fork"):
            if program is not None:
                copy._loop.apply(do.ReplaceProgram(program))
                copy._text = program.text
                copy._script = deque(without_edits(copy._script))
            if not inputs:
                copy._script.clear()
            if not copy._script:
                copy._loop.rest()
            copy._loop.publish()
        return copy

    def what_if(
        self, at: int | float | None = None, program: str | Program | None = None, seconds: float = 60.0
    ) -> WhatIf:
        """Return how another program would go on from a moment, beside how it went; nothing changes here.

        What came from outside later is repeated in both, as far as that is possible there; edits only in the
        recorded course. What blocks do by themselves, past `robot`, they do again in each.

        Parameters
        ----------
        at : int or float, optional
            A tick; or a time in seconds, as a float. By default now.
        program : str or Program, optional
            By default the one that runs now.
        seconds : float
            How long, in seconds of the run; not infinite.

        Returns
        -------
        WhatIf
            Both courses and their first difference; ``str()`` is that difference in a sentence.

        Raises
        ------
        ValueError
            The tick is not, or no longer, recorded; or what came later cannot be repeated, see :meth:`fork`.
        LRPSyntaxError
            The text is not a valid program.
        """
        check_number("seconds", seconds, "a number of seconds", above=0)
        if math.isinf(seconds):
            raise ValueError("Both runs last so many `seconds`. Pass a number that is not infinite.")
        self._driver.refuse_inside("what_if")
        if program is None and at is not None:
            program = self.program
        with self.fork(at, program, inputs=True) as fork:
            tick, begin = fork.frame.tick, fork.frame.time
            changed, end, open_loop = fork._observed(tick, seconds)
        if at is None and program is None:
            recorded = changed
        else:
            with self.fork(at, inputs=True) as fork:
                recorded, _, _ = fork._observed(tick, seconds)
        return WhatIf(tick, begin, end, recorded, changed, divergence(recorded, changed), open_loop)

    def _observed(self, tick: int, seconds: float) -> tuple[Course, float, bool]:
        """Run a fork, and return its course, its end in seconds, and whether readings were fed."""
        observation = Observation(self._loop, tick)
        self.run(seconds, limit=_REPEATING, after_tick=observation.watch)
        open_loop = isinstance(self.bridge, RecordedBridge)
        return observation.course(), self._loop.timing.now, open_loop

    def try_values(
        self,
        variable: str | Path,
        values: Iterable[object],
        seconds: float = 60.0,
        until: Until | None = None,
        outcome: Callable[[Session], object] | None = None,
        *,
        at: int | float | None = None,
    ) -> Trials:
        """Run on from one moment with different values of a variable, each in a fork; nothing changes here.

        What blocks do by themselves, past `robot`, they do again in each fork.

        Parameters
        ----------
        variable : str or path
            A variable that exists at that moment.
        values : iterable
        seconds : float
            How long each run lasts at most, in seconds of the run; infinite only with `until`.
        until : str, path or callable, optional
            A state, or a condition on the frame, that ends a run; the time until then is part of the result.
        outcome : callable, optional
            Called with the fork at the end of its run; the result is shown.
        at : int or float, optional
            A tick; or a time in seconds, as a float. By default now.

        Returns
        -------
        Trials
            One :class:`~lrp_jupyter.live.trials.Trial` for each value; a notebook shows a table.

        Raises
        ------
        UnknownElementError
            There is no such variable, or the program has no such state.
        ValueError
            The tick is not, or no longer, recorded.
        """
        check_number("seconds", seconds, "a number of seconds", least=0)
        if math.isinf(seconds) and until is None:
            raise ValueError("A run without `until` never ends. Pass `until`, or other `seconds`.")
        if outcome is not None:
            check_callable("outcome", outcome)
        self._driver.refuse_inside("try_values")
        trials = []
        for value in _listed("values", values, "[0.2, 0.3]"):
            with self.fork(at) as fork:
                fork.variables[variable] = value
                trials.append(_tried(fork, value, seconds, until, outcome))
        awaited = "" if until is None else "the condition" if callable(until) else path_text(as_path(until))
        return Trials(path_text(as_path(variable)), tuple(trials), awaited)

    def _forked(self, start: ForkStart) -> Self:
        """Return a copy of this session, at the moment for which it was prepared."""
        checkpoint = start.checkpoint
        copy = type(self)(
            checkpoint.snapshot.program,
            start.bridge,
            VirtualClock(),
            namespace=private_namespace(start.namespace, checkpoint.random),
            name=f"{self.name} fork",
            journal=self._journal,
        )
        with copy._closed_on_error():
            copy._loop.begin(checkpoint)
            if start.entries:
                copy._repeat(start.entries)
            if start.recorded is not None:
                check_repeated(start.recorded, copy.interpreter)
        copy._text = copy.interpreter.program.text
        copy._script.extend(start.later)
        return copy

    @contextmanager
    def _closed_on_error(self) -> Iterator[None]:
        try:
            yield
        except BaseException:
            self.close()
            raise

    def _repeat(self, entries: Iterable[Entry]) -> None:
        """Repeat ticks and inputs.

        Raises SessionTimeoutError: a block did not return.
        Raises ValueError: an input cannot be applied again.
        """
        queued, what = self._loop.inbox.queued, ""
        try:
            with self.driving(_REPEATING):
                for entry in entries:
                    noun = "Tick" if isinstance(entry, Ticked) else "What was done after tick"
                    what = f"{noun} {entry.tick}"
                    repeat(self._loop, entry)
                    if queued:  # the limit is exceeded
                        break
        except SessionTimeoutError:
            raise SessionTimeoutError(f"{what} cannot be repeated: a block did not return.") from None
        except Exception as error:
            raise ValueError(f"{what} cannot be repeated: {sentence_of(error)}") from error

    # -- commands, events and frames -------------------------------------------------------------

    def call(self, function: Callable[[], Any]) -> Any:
        """Call a function between two ticks, when the robot's world may be changed."""
        check_callable("function", function)
        return self._driver.do(do.Call(function))

    def _value(self, what: str, function: Callable[[], Any]) -> Any:
        """Return what a function returns between two ticks, for a method of this name.

        Raises LRPError: a block of the program itself is the caller.
        """
        self._driver.refuse_inside(what)
        return self._driver.do(do.Call(function))

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
        for listener in self._listeners:
            listener()


def _listed(name: str, values: Iterable[Any], example: str) -> list[Any]:
    """Return the values of an argument that is a list, for which a text is taken by mistake."""
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        kind = type(values).__name__
        raise TypeError(f"`{name}` must be a list, such as `{example}`, not {kind}.")
    return list(values)


def _check_moment(name: str, at: object) -> None:
    """Raise an error if an argument is neither a tick nor a time."""
    check_type(name, at, (int, float), "the number of a tick, or a time in seconds")
    if isinstance(at, float):
        check_number(name, at, "a time in seconds", least=0)


def _tick_of(loop: Loop, at: int | float) -> int:
    """Return the tick that is meant by its number, or by a time in seconds."""
    return at if isinstance(at, int) else tick_of(loop, at)


def _tried(
    fork: Session,
    value: object,
    seconds: float,
    until: Until | None,
    outcome: Callable[[Session], object] | None,
) -> Trial:
    """Run a fork, and return what came of it."""
    begin, way = fork.frame.time, []
    ends = None if until is None else fork._watch(until)

    def after_tick() -> bool:
        if (world := fork.bridge.simulated) is not None:
            way.append(world.pose[:2])
        return ends is not None and ends()

    reached = fork.run(seconds, after_tick=after_tick)
    frame = fork.frame
    return Trial(
        value,
        round(frame.time - begin, 9),
        round(frame.time - begin, 9) if reached and until is not None else None,
        None if outcome is None else outcome(fork),
        frame.active,
        sum(not issue.resolved for issue in frame.issues),
        tuple(way),
    )


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


_KEYWORDS = tuple(inspect.signature(Session).parameters)[:-1]
"""The keywords of :class:`Session` itself, one of which may be meant by an unknown option."""


@atexit.register
def _close_all() -> None:
    for session in tuple(_open_sessions):
        session.close()
    for thread in tuple(_ending):
        thread.join(_LEAVING)

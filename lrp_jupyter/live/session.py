"""A program that runs, and can be talked to.

The interpreter is a function of time: no clock, no thread, no robot. All of these are here, in
four parts that know little of each other:

* the :class:`~lrp_jupyter.live.loop.Loop` ticks, lets time pass, and carries out commands between
  two ticks;
* a driver turns the loop: a thread, asyncio, or the caller of :meth:`Session.run`; a second
  thread, the :class:`~lrp_jupyter.live.monitor.Monitor`, watches the first;
* :class:`~lrp_jupyter.live.turns.Turns` settles who may turn the loop, and waits for commands;
* the :class:`Session`, this file, is what everyone else holds. It may be called from any thread.

*In.* A call on a session becomes a command, a frozen value in a queue; the loop carries it out
between two ticks, as a whole. The caller waits for that, a second at most: then an error says
which block holds things up, and the command stays in the queue. ``submit`` does not wait. Who
calls from inside a block of the program itself does not wait either, for the block would wait for
its own end. With no driver at work the caller carries the command out itself.

*Out.* After a tick the loop makes a frozen frame and the session stores it by one assignment.
Whoever looks gets the newest; what must not be missed is counted in it. No view ever touches the
interpreter.

*Edits.* Checking a text is the caller's work, so that a keystroke costs the robot nothing. A text
that is no program is kept, and the last program runs on. What runs is :attr:`Session.program`,
what was typed is :attr:`Session.text`.

*Whose fault.* Faults of the program are issues, and nothing stops. A fault of this package stops
the robot and the session, which then is ``broken`` and keeps the traceback; it never looks like a
fault of the program. A bridge that fails is ``lost``, and the loop goes on.

*The end.* ``close`` stops the robot first, then ends and joins the threads; it may be called
twice. What is still open when Python exits is closed then.

Paper: §5.1 (the loop and its rate), §6 (live programming), §6.3 (pause), §6.4 (forcing states).
"""

from __future__ import annotations

import atexit
import math
import threading
import weakref
from collections.abc import Callable, Sequence
from concurrent.futures import CancelledError, Future
from dataclasses import replace
from pathlib import Path as FilePath
from time import monotonic
from typing import TYPE_CHECKING, Any, Literal

from lrp_jupyter.errors import LRPError, SessionClosedError, SessionTimeoutError
from lrp_jupyter.interpreter.frame import Frame, Status, matches
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.program import Finding, Path, Program
from lrp_jupyter.live import commands as do
from lrp_jupyter.live.clock import Clock, MonotonicClock
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.output import Output
from lrp_jupyter.live.turns import Turns

if TYPE_CHECKING:
    from lrp_jupyter.bridges.bridge import Bridge
    from lrp_jupyter.interpreter.events import Observer

__all__ = ["Condition", "Session"]

Condition = str | Path | Callable[[Frame], object]
"""A state, by bare name or path, or a function of a frame."""

_open_sessions: weakref.WeakSet[Session] = weakref.WeakSet()


class Session:
    """A running program with its loop, time, robot and thread.

    Parameters
    ----------
    program : Program or str
        A text that is no program raises; a session that shall begin with one starts empty and is
        given the text by :meth:`edit`.
    bridge : str or Bridge
        By name (``"none"``, ``"sim"``, …; `options` go to it), or one that was made.
    clock : Clock, optional
        A :class:`~lrp_jupyter.live.clock.VirtualClock` never waits; unless given, wall time.
    rate : float
        Ticks per second; 0 for as many as possible.
    namespace : dict, optional
        Names that blocks see (a notebook's ``user_ns``), used as it is, never written into.
    on_active_edit : {"restart", "keep"}
    on_issue : {"record", "pause"}
    name : str
        Appears in tracebacks and names the threads.
    journal : int
        Ticks that can be taken back.
    speed : float
        Seconds of the session per second of the wall; ``math.inf``: never wait.
    driver : {"thread", "asyncio"}
        Who turns the loop after :meth:`start`.
    hung_after : float
        Wall seconds after which a block that does not return is reported.
    dead_man : float, optional
        Wall seconds without :meth:`seen` after which the program pauses.
    **options
        For the bridge: ``world="line"``.

    Raises
    ------
    LRPSyntaxError
        The text is no program.
    BridgeError
        There is no such bridge.
    """

    def __init__(
        self,
        program: Program | str = "",
        bridge: str | Bridge = "none",
        clock: Clock | None = None,
        rate: float = 10,
        *,
        namespace: dict[str, Any] | None = None,
        on_active_edit: Literal["restart", "keep"] = "restart",
        on_issue: Literal["record", "pause"] = "record",
        name: str = "lrp",
        journal: int = 10_000,
        speed: float = 1.0,
        driver: Literal["thread", "asyncio"] = "thread",
        hung_after: float = 2.0,
        dead_man: float | None = None,
        **options: Any,
    ) -> None:
        from lrp_jupyter.bridges.discovery import make_bridge
        from lrp_jupyter.language.parser import parse

        self.name = name
        self.namespace = {} if namespace is None else namespace
        self.output = Output()
        self._text = program.text if isinstance(program, Program) else program
        self.findings: tuple[Finding, ...] = ()
        first = program if isinstance(program, Program) else parse(program, self.filename)
        self.bridge = make_bridge(bridge, **options) if isinstance(bridge, str) else bridge
        interpreter = Interpreter(
            first,
            robot=self.bridge.robot,
            namespace=self.namespace,
            on_active_edit=on_active_edit,
            on_issue=on_issue,
            journal=journal,
            output=self.output.print,
        )
        self._changed = threading.Condition()
        self._waiting = 0
        self._frame = Frame(program=first, rate=rate)
        self._loop = Loop(
            interpreter,
            self.bridge,
            MonotonicClock(speed) if clock is None else clock,
            rate,
            self._store,
            journal,
            lambda: self.output.count,
        )
        self._turns = Turns(self._loop, name)
        self._driver_kind: Literal["thread", "asyncio"] = driver
        self._hung_after = hung_after
        self._dead_man = dead_man
        self._ended: Status | None = None
        self._loop.show()
        _open_sessions.add(self)

    # -- what it is ------------------------------------------------------------------------------

    @property
    def filename(self) -> str:
        """The name of the program's text in tracebacks."""
        return f"<lrp {self.name}>"

    @property
    def frame(self) -> Frame:
        """The newest look at the run; from any thread."""
        frame = self._frame
        if self._ended is not None:
            return replace(frame, status=self._ended, achieved_rate=0.0, achieved_speed=0.0)
        hung = self._turns.hung
        return replace(frame, status="hung", reason=hung) if hung else frame

    @property
    def status(self) -> Status:
        """See :attr:`Frame.status <lrp_jupyter.interpreter.frame.Frame>`."""
        return self.frame.status

    @property
    def issues(self) -> Sequence[Issue]:
        """The faults of the program so far."""
        return self._frame.issues

    @property
    def program(self) -> Program:
        """The program that runs."""
        return self._frame.program

    @property
    def text(self) -> str:
        """The text as it was last given, whether it is a program or not."""
        return self._text

    @property
    def fault(self) -> str:
        """The traceback of what broke the session; empty while it is whole."""
        return self._loop.fault

    @property
    def interpreter(self) -> Interpreter:
        """The interpreter: for observers and tests. It belongs to the driver's thread."""
        return self._loop.interpreter

    @property
    def rate(self) -> float:
        """Ticks per second, 0 for as many as possible; may be set at any time. Paper: §5.1."""
        return self._loop.rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._do(do.SetRate(rate))

    @property
    def speed(self) -> float:
        """Seconds of the session per second of the wall; may be set at any time."""
        return self._loop.clock.speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._do(do.SetSpeed(speed))

    def __repr__(self) -> str:
        frame = self.frame
        active = ", ".join("/".join(path) for path in frame.active) or "nothing"
        return f"<Session {self.name}: {frame.status}, tick {frame.tick}, {active} active>"

    # -- running ---------------------------------------------------------------------------------

    def open(self) -> None:
        """Connect the robot, once; :meth:`start`, :meth:`step` and :meth:`run` do it too."""
        self._check_open()
        self.bridge.open()

    def start(self, paused: bool = False) -> None:
        """Run; after :meth:`stop`, from the beginning. What runs already runs on."""
        self.open()
        if not self._turns.driven:
            self._begin_anew()
            self._turns.start(self._driver_kind, self._notify, self._hung_after, self._dead_man)
        if not paused:
            self.resume()

    def _begin_anew(self) -> None:
        """After a stop: the program starts from the beginning."""
        if self._ended == "stopped":
            with self._turns.own("start"):
                self._ended = None
                self._loop.carry_out(do.Reset())

    def pause(self, reason: str = "") -> None:
        """Stand still: program, time, robot. Paper: §6.3."""
        self._do(do.Pause(reason))

    def resume(self) -> None:
        """Go on after a pause."""
        self._do(do.Resume())

    def step(self) -> None:
        """One tick and one period of time; a running program is paused first. Paper: §6.3."""
        self.open()
        self._do(do.Step())

    def reset(self) -> None:
        """Start the program anew at the next tick; the robot stops, its world stays."""
        self._do(do.Reset())

    def stop_robot(self) -> None:
        """Stop the robot, at once, whatever the program does; then pause."""
        self.bridge.stop_all()
        self.submit(do.Pause("the robot was stopped"))

    def stop(self) -> None:
        """End the run: the robot stops, the threads are gone; :meth:`start` begins anew."""
        self._end("stopped")

    def close(self) -> None:
        """Stop, and let the robot's connection go. Doing it twice does nothing."""
        self._end("closed")
        self.bridge.close()
        _open_sessions.discard(self)

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _end(self, status: Literal["stopped", "closed"]) -> None:
        if self.bridge.is_open:
            self.bridge.stop_all()
        if self._turns.end() and self._ended is None:
            self._loop.halt()
        self._ended = "closed" if self._ended == "closed" else status
        self._notify()

    def interrupt(self) -> bool:
        """Make the block that runs fail at its next bytecode; whether one runs.

        It becomes an issue of that block, and the tick goes on.
        """
        return self._turns.interrupt()

    def seen(self) -> None:
        """Somebody watches the robot: resets the dead man's switch."""
        self._turns.seen()

    def run(self, seconds: float | None = None, until: Condition | None = None) -> bool:
        """Run on the caller's thread, in virtual time: nothing waits.

        A thread of the session stands by meanwhile. A pause of the program ends the run.

        Parameters
        ----------
        seconds : float, optional
            At most so long, in seconds of the session.
        until : str, path or callable, optional
            A state to be entered, or a condition on the frame; looked at after every tick.

        Returns
        -------
        bool
            Whether `until` was reached; without it, whether the time was run to its end.
        """
        if seconds is None and until is None:
            raise ValueError("run for how long? Give `seconds`, `until`, or both")
        self.open()
        reached = self._watch(until)
        with self._turns.own("run"):
            self._begin_anew()
            self._loop.carry_out_waiting()
            span = math.inf if seconds is None else seconds
            end = self._loop.now + span
            found = self._loop.run(span, reached)
            return found if until is not None else self._loop.now >= end - 1e-6

    def _watch(self, until: Condition | None) -> Callable[[], bool]:
        """Make the question that `run` asks after every tick, cheap where it can be."""
        if until is None:
            return lambda: False
        loop = self._loop
        if callable(until):
            return lambda: bool(until(loop.make_frame()))
        state, visits = until, loop.tally.visits
        before = _count(visits, state)

        def entered() -> bool:
            return _count(visits, state) > before or loop.is_active(state)

        return entered

    def wait_for(self, condition: Condition, timeout: float | None = None) -> Frame:
        """Wait, in wall time, until a state is active (or was, however shortly) or a condition holds.

        Returns
        -------
        Frame
            The one in which it was so.

        Raises
        ------
        SessionTimeoutError
            It did not happen in `timeout` seconds.
        LRPError
            It cannot happen: the session is stopped, broken or closed, or nothing turns its loop.
        """
        if not self._turns.waits_elsewhere and (timeout is None or self._turns.driven):
            raise LRPError("nothing would run meanwhile: `start` it before, or use `run(until=…)`")
        end = None if timeout is None else monotonic() + timeout
        before = 0 if callable(condition) else self._frame.count_of(condition)
        with self._changed:
            self._waiting += 1
            try:
                while True:
                    frame = self.frame
                    if callable(condition):
                        if condition(frame):
                            return frame
                    elif frame.is_active(condition) or frame.count_of(condition) > before:
                        return frame
                    if frame.status in ("stopped", "broken", "closed"):
                        raise LRPError(f"the session is {frame.status}: {frame.reason or 'nothing runs'}")
                    left = None if end is None else end - monotonic()
                    if left is not None and left <= 0:
                        what = "the condition" if callable(condition) else f"`{_text(condition)}`"
                        raise SessionTimeoutError(f"{what} did not come in {timeout:g} s; {self!r}")
                    self._changed.wait(left)
            finally:
                self._waiting -= 1

    # -- changing the program --------------------------------------------------------------------

    def edit(self, text: str) -> tuple[Finding, ...]:
        """Go on with another text; never raises on account of it. Paper: §6.1.

        Returns
        -------
        tuple of Finding
            What the checks have to say. If the text is no program, the last program runs on.
        """
        from lrp_jupyter.language.checks import check
        from lrp_jupyter.language.parser import scan

        self._check_open()
        self._text = text
        program, findings = scan(text, self.filename)
        if program is not None:
            findings = check(program, self.namespace)
            try:
                self._do(do.Edit(program))
            except CancelledError:  # a newer edit came before this one was looked at
                pass
            except LRPError as error:  # the text is kept, and applied when the block returns
                findings = (*findings, Finding("LRP690", "warning", str(error), 1, 1, 1, 1))
        self.findings = findings
        return findings

    def save(self, path: str | FilePath) -> None:
        """Write the text to a file, line ends as they are."""
        FilePath(path).write_bytes(self._text.encode())

    def rename(self, kind: str, path: str | Path, new_name: str) -> str:
        """Rename an element with all its references; nothing restarts. Return the new text.

        Raises
        ------
        UnknownElementError
            There is no such element.
        ValueError
            The name cannot be had, or the text is no program at the moment.
        """
        if self._text != self.program.text and any(f.severity == "error" for f in self.findings):
            raise ValueError("the text is not a program at the moment: nothing can be renamed in it")
        text: str = self._do(do.Rename(kind, _path(path), new_name))
        if text:
            self._text = text
        return text

    @property
    def on_active_edit(self) -> str:
        """``restart`` or ``keep``: what a change to an active state does; may be set at any time."""
        return self.interpreter.on_active_edit

    @on_active_edit.setter
    def on_active_edit(self, policy: Literal["restart", "keep"]) -> None:
        self._do(do.SetPolicy("on_active_edit", policy))

    @property
    def on_issue(self) -> str:
        """``record`` or ``pause``: what a new issue does; may be set at any time."""
        return self.interpreter.on_issue

    @on_issue.setter
    def on_issue(self, policy: Literal["record", "pause"]) -> None:
        self._do(do.SetPolicy("on_issue", policy))

    # -- forcing ---------------------------------------------------------------------------------

    def transition_to(self, state: str | Path) -> None:
        """Go to a state as if a transition led there. An unknown one is an issue. Paper: §6.4."""
        self._do(do.Force(_path(state)))

    def teleport_to(self, state: str | Path) -> None:
        """Be in a state; no action runs. An unknown one is an issue. Paper: §6.4."""
        self._do(do.Force(_path(state), teleport=True))

    def set_variable(self, variable: str | Path, expression: str) -> None:
        """Assign the value of a Python expression, evaluated in the variable's scope.

        Raises
        ------
        UnknownElementError
            The variable does not live now.
        """
        self._do(do.SetVariable(_path(variable), expression))

    def rewind(self, ticks: int = 1) -> None:
        """Go back by so many ticks: program, simulated world, time.

        Raises
        ------
        ValueError
            There are not so many.
        BridgeError
            A real robot is armed.
        """
        before = self.program
        self._do(do.Rewind(ticks))
        if self.program is not before:  # edits were taken back, too
            self._text = self.program.text

    def call(self, function: Callable[[], Any]) -> Any:
        """Call a function between two ticks, where the robot's world may be touched."""
        return self._do(do.Call(function))

    def observe(self, observer: Observer) -> Callable[[], None]:
        """Have every event told to a function, on the driver's thread; returns how to end it."""
        unsubscribe: Callable[[], None] = self._do(do.Call(lambda: self.interpreter.observe(observer)))
        return unsubscribe

    def submit(self, command: do.Command) -> Future[Any]:
        """Queue a command and do not wait."""
        self._check_open()
        return self._turns.submit(command)

    # -- inside ----------------------------------------------------------------------------------

    def _do(self, command: do.Command) -> Any:
        self._check_open()
        return self._turns.do(command)

    def _check_open(self) -> None:
        if self._ended == "closed":
            raise SessionClosedError(f"the session `{self.name}` is closed")

    def _store(self, frame: Frame) -> None:
        self._frame = frame
        if self._waiting:
            self._notify()

    def _notify(self) -> None:
        with self._changed:
            self._changed.notify_all()


def _count(visits: dict[Path, int], state: str | Path) -> int:
    return sum(count for path, count in visits.items() if matches(state, path))


def _path(path: str | Path) -> Path:
    return tuple(path.split("/")) if isinstance(path, str) else tuple(path)


def _text(path: str | Path) -> str:
    return path if isinstance(path, str) else "/".join(path)


@atexit.register
def _close_all() -> None:
    for session in tuple(_open_sessions):
        session.close()

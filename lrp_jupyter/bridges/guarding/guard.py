"""The guard: a process that stops the robot when this one cannot do it any more.

While hardware is armed, a thread sends beats through a pipe, ten in a second. The process at its other end
(:mod:`~lrp_jupyter.bridges.guard_process`) stops the robot by the bridge's `Stopper` when the pipe closes or
no beat comes for a second: after ``kill -9``, a crash, a call of C that keeps the interpreter lock, or while
this process is suspended. When it wakes up, it finds that its last beat is old *before* it sends a command,
stops the robot itself, and sends nothing until a person goes on. Only a command that was on its way when the
process was suspended may still arrive; the stop comes right after it.

The process acts only where something may move: it is told so before the first command that moves the robot,
and that it stands after a stop. So it does not disturb another driver of the same robot.

It answers each beat with whether it reaches the robot, so one that is dead or suspended is noticed here, and
another one takes its place. A robot that was guarded and is not for some seconds is disarmed.
"""

from __future__ import annotations

import base64
import contextlib
import json
import os
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from lrp_jupyter.bridges.guarding.safety import Safety
from lrp_jupyter.errors import BridgeError, ended, sentence_of
from lrp_jupyter.process import python_of

SILENCE = 1.0
"""Seconds without a beat after which the process stops the robot."""
UNGUARDED = (
    "Nothing stops the robot when this program or this computer dies: it goes on with its last command."
)

_BEAT = 0.1  # s between two beats
_LAPSE = 0.8 * SILENCE  # s after which this side takes itself for suspended: sooner than the other side does
_CONNECT = 10.0  # s that the process may take to reach the robot
_AGAIN = 1.0  # s between two starts of a process
_UNANSWERED = 30  # beats after which a process is taken for suspended
_JOIN = 1.0  # s that ending the thread may take
_REPORT = 0.3  # s to wait for the report of what happened meanwhile
_HELP = 2.0  # s that the process may take to stop a robot that this one cannot stop
# on Windows a process in the console of this one would end with its window
_DETACHED = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0) | getattr(subprocess, "CREATE_NO_WINDOW", 0)


def now() -> float:
    """Return seconds of a clock that goes on while the computer sleeps, where it has one."""
    for clock in ("CLOCK_BOOTTIME", "CLOCK_MONOTONIC"):
        with contextlib.suppress(AttributeError, OSError):  # a system may name a clock and not have it
            return time.clock_gettime(getattr(time, clock))
    return time.monotonic()


@dataclass(frozen=True, slots=True)
class Stopper:
    """How another process can stop a robot.

    `target`: ``"module:Class"`` or ``"module:function"``, or the object itself, also one of a notebook. A
        class connects in its constructor and has the methods ``stop()`` and, where wanted, ``close()``. A
        subclass of `Bridge` is opened, and its ``stop`` is called; a function is called for every stop.
    `arguments`: keyword arguments of the class or the function, with a JSON form.
    """

    target: str | Callable[..., object]
    arguments: Mapping[str, Any] = field(default_factory=dict)

    def as_json(self) -> str:
        """Return a text in one line, with what else the process needs to know."""
        try:
            if isinstance(self.target, str):
                target = {"name": self.target}
            else:
                import cloudpickle

                target = {"pickled": base64.b64encode(cloudpickle.dumps(self.target)).decode()}
            order = {"arguments": dict(self.arguments), "parent": os.getpid(), "silence": SILENCE}
            return json.dumps({**target, **order})
        except Exception as error:  # whatever the objects to be pickled raise
            raise BridgeError(
                f"The stopper cannot be sent to another process. {sentence_of(error)}"
            ) from error


class Guarded(Protocol):
    """What a guard needs to know of its bridge."""

    safety: Safety

    @property
    def is_open(self) -> bool:
        """Whether it is connected."""

    @property
    def in_motion(self) -> bool:
        """Whether the robot may move by a command."""

    @property
    def failsafe(self) -> str:
        """Who stops the robot when this program or this computer dies."""

    def stopper(self) -> Stopper | None:
        """Return how another process can stop the robot."""

    def lapse(self, what: Callable[[], str]) -> None:
        """Stop the robot and send nothing more: this process was suspended. `what` returns a sentence."""

    def unguarded(self, why: str) -> None:
        """React to the loss of the guard, which was promised: `why` is a sentence."""


class Guard:
    """The near end of the guard of one bridge.

    Owner: its thread. `check` and `moves` are called on the thread that commands the robot, before it does;
    `stop` on any thread.
    """

    def __init__(self, bridge: Guarded) -> None:
        self._bridge = weakref.ref(bridge)
        self.is_on = False
        self.trouble = ""  # why the robot is not guarded; empty if it is, or if the bridge has no stopper
        self._beat = 0.0  # the last one
        self._moved = False  # whether the robot might move then; a watchdog may have stopped it since
        self._stopper: Stopper | None = None
        self._process: _Process | None = None
        self._next = 0.0  # when a process may be started again
        self._guarded: float | None = None  # when a process last reached the robot; None before
        self._end = threading.Event()
        self._thread: threading.Thread | None = None
        self._changing = threading.Lock()
        self._lapsing = threading.Lock()

    def start(self) -> None:
        """Guard the robot from now on; idempotent.

        When this returns, the process has reached the robot, or `trouble` is why it has not.
        """
        with self._changing:
            if self.is_on:
                return
            if sys.platform == "emscripten":
                self.trouble = "A page of a browser has neither processes nor threads."
                return
            self.is_on, self.trouble, self._stopper = True, "", None
            self._next, self._guarded, self._beat = 0.0, None, now()
            self._end = over = threading.Event()
        self._turn(over)
        if self._process is not None:
            self._process.known.wait(_CONNECT)
            self._turn(over)
        self._thread = threading.Thread(target=self._run, args=(over,), name="guard", daemon=True)
        self._thread.start()

    def end(self, stands: bool = True) -> None:
        """End the process, which does nothing more to the robot; idempotent.

        `stands`: whether the robot was stopped, if it moved; if not, the process stops it first.
        """
        with self._changing:
            self.is_on, self.trouble = False, ""
            self._end.set()
            process, self._process = self._process, None
            thread, self._thread = self._thread, None
        if process is not None:
            process.end(stands)
        if thread is not None and thread is not threading.current_thread():
            thread.join(_JOIN)

    def stop(self) -> bool:
        """Have the process stop the robot, because this one could not; return whether it has."""
        process = self._process
        return process is not None and process.stop()

    def check(self) -> None:
        """Have the bridge stop if this process was suspended, or the other one has taken it for suspended.

        Of two threads that notice it, the second one waits until the first one has stopped the robot.
        """
        if self._overslept() is not None:
            with self._lapsing:
                silence, bridge = self._overslept(), self._bridge()
                if silence is not None and bridge is not None:
                    self._moved = False
                    bridge.lapse(lambda: self._lapsed(silence))

    def _overslept(self) -> float | None:
        """Return for how many seconds this process was suspended while the robot moved, if it was."""
        silence, process = now() - self._beat, self._process
        if silence > _LAPSE and self._moved:
            return silence
        return SILENCE if process is not None and process.stopped.is_set() else None

    def moves(self) -> None:
        """Tell the process, before the command that moves the robot is sent."""
        self._beat = now()  # first: the thread may have to wake up yet, and the robot stood until now
        self._moved, process = True, self._process
        if process is not None:
            process.beat(lambda: True)

    # -- on its thread --------------------------------------------------------------------------------

    def _run(self, over: threading.Event) -> None:
        while not over.wait(_BEAT):
            if not self._turn(over):
                self.end(stands=not self._moved)  # the bridge was dropped, maybe while the robot drove

    def _turn(self, over: threading.Event) -> bool:
        """Send a beat to a process for the present stopper; return whether there is still a bridge."""
        bridge = self._bridge()
        if bridge is None:
            return False
        began = now()  # a suspension after the check is found by the next one
        self.check()
        self._beat, self._moved = began, bridge.in_motion
        try:
            self._attend(bridge, over)
        except BaseException as error:  # also the bridge's own, in `stopper`
            if issubclass(type(error), KeyboardInterrupt) and threading.current_thread() is not self._thread:
                raise  # Ctrl-C while the robot is armed
            self._report(bridge, sentence_of(error))
        process = self._process
        if process is not None:
            process.unanswered += 1
            process.beat(lambda: bridge.in_motion)
        if self._stopper is None:
            self._guarded = None
        elif process is not None and process.reaches:
            if self._guarded is None and threading.current_thread() is self._thread:
                bridge.safety.notice("guard", bridge.failsafe)  # at arming it was another one
            self._guarded = time.monotonic()
        elif self._guarded is not None and time.monotonic() - self._guarded > _CONNECT:
            self._guarded = time.monotonic()
            bridge.unguarded(self.trouble)
        return True

    def _lapsed(self, silence: float) -> str:
        """Return what happened meanwhile, as the process reports it."""
        process = self._process
        by_guard = process is not None and process.stopped.wait(_REPORT)
        if process is not None:
            process.stopped.clear()
        return (
            f"This program was suspended for {silence:.1f} s"
            f"{', and the guard stopped the robot' if by_guard else ': the robot was stopped'}. "
            "Resume it when the way is clear."
        )

    def _attend(self, bridge: Guarded, over: threading.Event) -> None:
        """Start a process where there is none, or one for another stopper; report what is wrong with it."""
        stopper = bridge.stopper() if bridge.is_open else None
        process = self._process
        changed = stopper != self._stopper
        if changed and stopper is not None and process is not None:
            changed = stopper.as_json() != process.order  # a function made for each call equals no other
        self._stopper = stopper
        if process is not None and (changed or process.fate):
            with self._changing:
                self._process = None
            process.end()
            self.trouble = "The stopper has changed." if changed else process.fate
            if not changed:
                bridge.safety.notice("guard", f"{process.fate} Another one is started.")
        if stopper is not None and self._process is None and time.monotonic() >= self._next:
            self._next = time.monotonic() + _AGAIN
            process = _Process(stopper)
            with self._changing:
                if not over.is_set():
                    self._process = process
            if over.is_set():
                process.end()
        process = self._process
        if process is not None and (process.known.is_set() or process.problem()):
            self._report(bridge, process.problem())

    def _report(self, bridge: Guarded, problem: str) -> None:
        before, self.trouble = self.trouble, problem
        if problem and problem != before:
            bridge.safety.notice("guard", f"The robot is not guarded. {ended(problem)}")
        elif before and not problem:
            bridge.safety.notice("guard", "The robot is guarded again.")


class _Process:
    """One guard process, with a thread that listens to it until it has ended."""

    def __init__(self, stopper: Stopper) -> None:
        self.order = stopper.as_json()  # as it is sent
        first = self.order.encode() + b"\n"
        self._began = time.monotonic()
        self.known = threading.Event()  # set as soon as it is known whether it reaches the robot
        self.stopped = threading.Event()
        self.is_gone = False
        self._halted, self._refusal = threading.Event(), ""
        self._exit_code: int | None = None
        self._reaches = False
        self._failure = ""
        self.unanswered = 0  # beats of the guard's thread since it was heard last
        self._writing = threading.Lock()
        try:
            self._process = subprocess.Popen(
                **python_of("lrp_jupyter.bridges.guard_process"),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                bufsize=0,
                start_new_session=True,  # neither Ctrl-C in the terminal nor the end of a kernel's group
                creationflags=_DETACHED,
            )
        except OSError as error:
            raise BridgeError(f"The guard process cannot be started: {error.strerror or error}.") from error
        threading.Thread(target=self._listen, name="guard's reports", daemon=True).start()
        assert self._process.stdin is not None
        self._pipe = self._process.stdin
        with contextlib.suppress(OSError):  # it has ended: `_listen` finds out
            while first:
                first = first[self._pipe.write(first) or 0 :]
            if os.name == "posix":  # a process that hangs must not hold up a tick
                os.set_blocking(self._pipe.fileno(), False)

    @property
    def fate(self) -> str:
        """Why it is of no use any more: a sentence; empty while it lives and answers."""
        if self.is_gone:
            return f"The guard process ended by itself (exit code {self._exit_code})."
        return "The guard process does not answer." if self._is_silent else ""

    @property
    def reaches(self) -> bool:
        """Whether it can stop the robot."""
        return self._reaches and not (self.is_gone or self._is_silent)

    @property
    def _is_silent(self) -> bool:
        return self._reaches and self.unanswered > _UNANSWERED

    def problem(self) -> str:
        """Return why it cannot stop the robot; empty if it can, or may still be connecting."""
        if self._failure or self._reaches or time.monotonic() - self._began < _CONNECT:
            return self._failure
        return f"The guard process has not reached the robot within {_CONNECT:g} s."

    def beat(self, moves: Callable[[], bool]) -> None:
        """Send a beat: whether the robot may move, which is asked at the last moment."""
        self._tell(lambda: b"m" if moves() else b"s")

    def stop(self) -> bool:
        """Have it stop the robot; return whether it has, in bounded time."""
        self._halted.clear()
        self._tell(lambda: b"x")
        return self._reaches and self._halted.wait(_HELP) and not self._refusal

    def end(self, stands: bool = True) -> None:
        """Have it end: without touching the robot, or after having stopped it.

        One that does not answer any more could only act at a wrong time: it is killed.
        """
        self._tell(lambda: b"e" if stands else b"m")
        with self._writing, contextlib.suppress(OSError):
            self._pipe.close()
        if self._is_silent:
            self._process.kill()

    def _tell(self, what: Callable[[], bytes]) -> None:
        with self._writing, contextlib.suppress(OSError):
            if not self._pipe.closed:
                self._pipe.write(what())

    def _listen(self) -> None:
        process = self._process
        assert process.stdout is not None
        with process.stdout as reports:
            for line in iter(reports.readline, b""):
                what, _, text = line.decode(errors="replace").strip().partition(" ")
                self.unanswered = 0
                if what == "stopped":
                    self.stopped.set()
                elif what == "halted":
                    self._refusal = text
                    self._halted.set()
                else:
                    self._reaches, self._failure = what == "ready", text
                    self.known.set()
        self._exit_code = process.wait()
        self.is_gone = True
        self.known.set()

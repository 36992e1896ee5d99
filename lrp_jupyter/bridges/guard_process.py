"""The guard process, which stops a robot whose program is dead or suspended: see `guarding/guard.py`.

Its standard input has an order in a line: a `Stopper` as JSON, its parent, and how long that may be silent.
Then a byte for each beat: ``m``, the robot may move; ``s``, it stands; ``x``, stop it, which the parent could
not; ``e``, the end. On its standard output it answers beats with ``ready``, or ``failed`` and a sentence; an
``x`` with ``halted``, and a sentence if it could not. When it has stopped the robot because there were no
beats, it reports ``stopped``. It ends with its parent.
"""

from __future__ import annotations

import base64
import importlib
import inspect
import json
import os
import pickle
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from io import BufferedReader
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge, ConnectionState
from lrp_jupyter.bridges.guarding.guard import now
from lrp_jupyter.errors import BridgeError, sentence_of

_EVERY = 0.1  # s between two stops
_STOPPING = 1.0  # s of stops that succeed: a single one may be lost
_TRYING = 5.0  # s of stops that fail
_AGAIN = 2.0  # s until it tries again to reach the robot
_LAST = 10.0  # s that it may take to end when its parent is gone
_LOOK = 0.25  # s between two looks at the parent and the connection


class _Robot:
    """What a stopper makes: a class, a bridge or a function."""

    def __init__(self, target: Any, arguments: dict[str, Any]) -> None:
        self._bridge: Bridge | None = None
        self.close: Callable[[], object] = lambda: None
        if not inspect.isclass(target):
            self._stop: Callable[[], object] = lambda: target(**arguments)
            return
        made: Any = target(**arguments)
        self.close = getattr(made, "close", self.close)
        self._stop = made.stop
        if isinstance(made, Bridge):
            made.open()
            self._bridge, self._stop = made, made.stop_all
            self.close = made.close_interface  # `Bridge.close` would stop a robot that another one may drive

    def trouble(self) -> str:
        """Return why the robot cannot be reached now, as far as that is known."""
        bridge = self._bridge
        if bridge is None or bridge.status.state is not ConnectionState.LOST:
            return ""
        return bridge.status.sentence

    def stop(self) -> None:
        """Stop the robot; raise what went wrong."""
        if trouble := self.trouble():
            raise BridgeError(trouble)
        if self._stop() is False and self._bridge is not None:
            raise BridgeError(self._bridge.safety.notices[-1].text)


class _Watch:
    """The beats, as they come; on a thread of its own."""

    def __init__(self, pipe: BufferedReader, parent: int, silence: float) -> None:
        self.silence = silence  # s without a beat after which the parent is taken for suspended
        self.moves = False  # whether the robot may move
        self.asked = False  # whether the parent wants the robot stopped now
        self.ended = self.over = False  # whether the end was announced; whether there will be no more beats
        self.last = now()
        self.wake = threading.Event()  # set with every beat
        self._pipe, self._parent = pipe, parent
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        while beats := self._pipe.read1(4096):
            self.ended |= b"e" in beats
            self.asked |= b"x" in beats
            self.moves = beats[-1:] in (b"m", b"x")
            self.last = now()
            self.wake.set()
        self.finish()
        self.wake.set()

    def finish(self, *_: object) -> None:
        """Expect no more beats; also a handler of signals, which may not set an event."""
        self.over = True
        end = threading.Timer(_LAST, os._exit, (1,))  # a stopper may hang: nothing lingers
        end.daemon = True
        end.start()

    @property
    def silent(self) -> bool:
        """Whether the parent is dead or suspended; a pipe that a child of it holds open does not close."""
        if not self.over and os.name == "posix" and os.getppid() != self._parent:
            self.finish()
        return self.over or now() - self.last > self.silence


def main() -> None:
    """Guard the robot until the end."""
    pipe, reports = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "w", buffering=1, encoding="utf-8")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):  # what libraries print goes nowhere
        os.dup2(nothing, stream)

    def report(what: str, sentence: str = "") -> None:
        with suppress(OSError):  # there may be no parent any more
            reports.write(f"{what} {' '.join(sentence.split())}\n")

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    line = pipe.readline()
    if line.endswith(b"\n"):  # else the parent has ended already
        stopper = json.loads(line)
        watch = _Watch(pipe, stopper["parent"], stopper["silence"])
        signal.signal(signal.SIGTERM, watch.finish)
        _guard(stopper, watch, report)


def _guard(stopper: dict[str, Any], watch: _Watch, report: Callable[..., None]) -> None:
    """Stop the robot when there are no beats, until the end."""
    robot: _Robot | None = None
    reported, tried, heard = "", -_AGAIN, True
    while not (watch.ended or (watch.over and not watch.moves)):
        trouble = reported if robot is None else robot.trouble()
        if robot is None and now() - tried >= _AGAIN:
            tried = now()
            try:
                robot, trouble = _Robot(_target(stopper), stopper["arguments"]), ""
            except BaseException as error:  # of the stopper's class
                trouble = sentence_of(error)
        asked, watch.asked = watch.asked, False
        if robot is not None and asked:
            report("halted", _halt(robot))
        if robot is not None and watch.moves and watch.silent:
            trouble = _stop(robot, watch, report)
        if heard or trouble != reported:
            reported = trouble
            report("failed" if trouble else "ready", trouble)
        overdue = watch.last + watch.silence - now()
        heard = watch.wake.wait(min(_LOOK, overdue) if overdue > 0 else _LOOK)
        watch.wake.clear()
    if robot is not None:
        robot.close()


def _target(stopper: dict[str, Any]) -> Any:
    if "pickled" in stopper:
        return pickle.loads(base64.b64decode(stopper["pickled"]))
    module, _, name = stopper["name"].partition(":")
    target: Any = importlib.import_module(module)
    for part in name.split("."):
        target = getattr(target, part)
    return target


def _halt(robot: _Robot) -> str:
    """Stop the robot once, for a parent that lives; return what went wrong."""
    try:
        robot.stop()
    except BaseException as error:
        return sentence_of(error)
    return ""


def _stop(robot: _Robot, watch: _Watch, report: Callable[..., None]) -> str:
    """Stop the robot again and again, until there are beats again; return what went wrong."""
    watch.moves = False
    began, succeeded, failure = now(), 0, ""
    while watch.silent and not watch.ended and succeeded * _EVERY < _STOPPING and now() - began < _TRYING:
        try:
            robot.stop()
            succeeded += 1
            if succeeded == 1:
                report("stopped")
        except BaseException as error:
            failure = sentence_of(error)
        watch.wake.wait(_EVERY)
        watch.wake.clear()
    if succeeded:
        return ""
    watch.moves = watch.silent  # to be stopped as soon as it can be reached
    return failure


if __name__ == "__main__":
    main()

"""The safety of a bridge, the same for every bridge: arming, limits, two watchdogs.

Nothing here reads a clock: times are arguments, in seconds of the session's clock, so that the same
rules hold in virtual time.

Owner: the interpreter's thread feeds it; the monitor's thread reads the times and may stop.
Every field that both touch is one reference, replaced by one assignment; the log has a lock.
"""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, takewhile
from typing import Any, Literal, NamedTuple

from lrp_jupyter.bridges.argument_values import are_same
from lrp_jupyter.bridges.guarding.bounded import failure_of
from lrp_jupyter.bridges.interventions import CommandsHeld
from lrp_jupyter.errors import BridgeError

NoticeKind = Literal[
    "armed",
    "disarmed",
    "limited",
    "command watchdog",
    "tick watchdog",
    "held",
    "stopped",
    "stale",
    "dropped",
    "guard",
    "fault",
]

OF_COMMANDS: tuple[NoticeKind, ...] = ("limited", "stopped")
"""The kinds of notices that are about a command of the program, which a person may change."""

Hindrance = Literal["disarmed", "lost", "held", "blind"]
"""Why a command is not sent: a lost robot gets none, one whose data are too old none that moves it."""

Motion = dict[str, tuple[str, float]]
"""What moves, robots or their motors, by name, with the last command and its time; never changed in place.

The time is infinite if the command does not expire.
"""

COMMANDS = 60_000
"""How many commands the log holds at most; one that is repeated counts as one."""

_NOTICES = 100  # that the log holds at most
_CIRCULAR = "Its `stop` calls what calls `stop` (`stop_all`, `disarm`, `close`, or `robot.stop`)."
_SHORTEST = 0.5  # s; a robot at walking pace moves 10 cm in it
_ROUNDING = 1e-9  # s; 5 periods of 0.1 s are half a second


def patience(period: float) -> float:
    """Return the seconds without a tick or velocity command after which the robot is stopped."""
    return max(_SHORTEST, 3 * period)


class Origin(NamedTuple):
    """Where a command came from: the tick, and the block of the program with its line (from 1).

    A command that was given by hand has no block. `machine` is the one whose state acted, as spawned.
    """

    tick: int = 0
    block: str = ""
    line: int = 0
    machine: tuple[str, ...] = ()


BY_HAND = Origin()


@dataclass(frozen=True, slots=True)
class Notice:
    """An entry of the safety log: what was done, and why.

    `count` is how often it happened: in a row, or anywhere with the same `about`. `now` is the last time, in
    seconds; `first` and `last` are the origins of the commands that it is about.
    """

    kind: NoticeKind
    text: str
    now: float
    count: int = 1
    about: str = ""
    first: Origin = BY_HAND
    last: Origin = BY_HAND

    def as_dict(self) -> dict[str, Any]:
        """Return a JSON form."""
        return {"kind": self.kind, "text": self.text, "now": self.now, "count": self.count}


@dataclass(frozen=True, slots=True)
class CommandRecord:
    """A command as it was after limits; `sent` is False when it was only recorded.

    A command that is repeated in the same way is one record: `first` is the origin of the first time, `now`
    and `origin` are those of the last one.
    """

    name: str
    arguments: dict[str, Any]
    now: float
    sent: bool
    limited: tuple[str, ...] = ()
    origin: Origin = BY_HAND
    first: Origin = BY_HAND

    def repeats(self, last: CommandRecord) -> bool:
        """Return whether it is the same as the one before, from the same line."""
        return (
            self.name == last.name
            and are_same(self.arguments, last.arguments)
            and self.sent is last.sent
            and self.limited == last.limited
            and self.origin[1:] == last.origin[1:]
        )

    def as_dict(self) -> dict[str, Any]:
        """Return a JSON form; an argument without one becomes a text."""
        arguments = {
            k: v if isinstance(v, (bool, int, float, str, dict)) else repr(v)
            for k, v in self.arguments.items()
        }
        return {
            "name": self.name,
            "arguments": arguments,
            "now": self.now,
            "sent": self.sent,
            "limited": list(self.limited),
        }


class Safety:
    """The state of a bridge's safety, and its log."""

    def __init__(self, armed: bool) -> None:
        self.armed = armed  # whether commands go out; a disarmed bridge records and shows them only
        self.now = 0.0
        self.period = 0.0
        self.held = False
        self.blocked = False  # whether nothing is sent until a person goes on …
        self.suspended = ""  # … and why: a sentence, as soon as it is known
        self.driven: frozenset[str] = frozenset()  # commands sent since the last stop that may move the robot
        self.sent = 0  # how many commands, in this tick
        self.stops = 0  # how many times the robot was stopped, whatever the program did
        self.again: CommandsHeld | None = None  # in the tick that this one repeats, if not all were sent
        self.blind = ""  # why no command may move the robot now: its data are too old; empty if it may
        self.lost = ""  # why no command can be sent now: the robot does not answer; empty if it does
        self.why = ""  # why the last command was not sent that was refused or held because of these two
        self.has_commanded = False  # whether anything was sent since the robot was known to stand
        self._refused = ""  # why commands of this tick were refused
        self._looking = 0  # the thread that only looks
        self._stopping: dict[int, bool] = {}  # threads that run `stop`, and whether that has called itself
        self._drives = 0  # how many commands that may move it were registered
        self.command_count = 0
        self._last_tick: float | None = None
        self._overdue_reported = False
        self._moving: Motion = {}
        self.halted: Motion = {}  # what moved when the robot was stopped, and has not been commanded since
        self._notices: deque[Notice] = deque(maxlen=_NOTICES)
        self.recorded: Callable[[CommandRecord], object] | None = None  # called with every command
        self.noticed: Callable[[Notice], object] | None = None  # called with every new notice, on any thread
        self._commands: deque[CommandRecord] = deque(maxlen=COMMANDS)
        self._last: CommandRecord | None = None
        self._begun = BY_HAND
        self._log_lock = threading.Lock()

    @property
    def notices(self) -> tuple[Notice, ...]:
        """The last notices, oldest first."""
        with self._log_lock:
            return tuple(self._notices)

    @property
    def commands(self) -> tuple[CommandRecord, ...]:
        """The last commands, oldest first, sent or not; a repeated one is listed once."""
        with self._log_lock:
            return self._all()

    def notice(
        self, kind: NoticeKind, text: str, about: str = "", origin: Origin = BY_HAND, *, renews: bool = False
    ) -> Notice:
        """Log a notice; a repeated one increments its count.

        `about`: what it is about, if it is logged only once, however often it happens and whatever its text.
        `renews`: whether it then has the text of the last time.
        """
        with self._log_lock:
            known = range(len(self._notices)) if about else range(len(self._notices))[-1:]
            for index in known:
                each = self._notices[index]
                if each.kind == kind and (each.about == about if about else each.text == text):
                    entry = replace(each, now=self.now, count=each.count + 1, last=origin)
                    if renews:
                        entry = replace(entry, text=text)
                    self._notices[index] = entry
                    return entry
            entry = Notice(kind, text, self.now, 1, about, origin, origin)
            self._notices.append(entry)
        if self.noticed is not None:
            self.noticed(entry)
        return entry

    def forget_notices(self, *kinds: NoticeKind) -> None:
        """Drop the notices of some kinds: the user has read them."""
        with self._log_lock:
            kept = [notice for notice in self._notices if notice.kind not in kinds]
            self._notices = deque(kept, maxlen=_NOTICES)

    def given_in(self, tick: int) -> list[CommandRecord]:
        """Return the commands of the last tick, the last one first; none if it has not given any.

        `tick`: its number.
        """
        with self._log_lock:
            last = () if self._last is None else (self._last,)
            latest = chain(last, reversed(self._commands))
            return list(takewhile(lambda command: command.origin.tick == tick, latest))

    def record(self, command: CommandRecord) -> None:
        """Log a command."""
        with self._log_lock:
            self.command_count += 1
            last = self._last
            if last is None or not command.repeats(last):
                if last is not None:
                    self._commands.append(replace(last, first=self._begun))
                self._begun = command.origin
            self._last = command
        if self.recorded is not None:
            self.recorded(command)

    def begin(self, tick: int) -> None:
        """Drop the commands that no longer held at a tick."""
        with self._log_lock:
            while len(self._commands) > 1 and self._commands[1].first.tick <= tick:
                self._commands.popleft()

    def go_back(self, tick: int, now: float) -> None:
        """Return to the time after a tick: drop the later commands, and hold none for a later stop."""
        self.now, self.held = now, self.blocked
        with self._log_lock:
            kept = [command for command in self._all() if command.first.tick <= tick]
            self._commands = deque(kept, maxlen=COMMANDS)
            self._last = None

    def _all(self) -> tuple[CommandRecord, ...]:
        last = self._last
        return (*self._commands, *(() if last is None else (replace(last, first=self._begun),)))

    def tick(self, now: float, period: float) -> None:
        """Register the beginning of a tick: commands held by a stop are allowed again."""
        self.now, self.period = now, period
        self._last_tick = now
        self._overdue_reported = False
        self.held = self.blocked
        self.sent = 0
        self._refused = ""

    def hindrance(self, moves: bool) -> Hindrance | None:
        """Return why a command, which `moves` the robot or not, may not be sent now; count one that may."""
        if not self.armed:
            return "disarmed"
        again = self.again
        is_last = again is not None and self.sent == again.sent
        if lost := self.lost or (again.lost if again is not None and is_last else ""):
            self.why = self._refused = lost
            return "lost"
        if self.held:
            return "held"
        if moves and (blind := self.blind or (again.blind if again is not None else "")):
            self.why = blind
            return "blind"
        if is_last:
            return "held"
        self.sent += 1
        self.has_commanded = True
        return None

    def hindered(self) -> CommandsHeld | None:
        """Return what became of the commands of this tick, if not all of them could be sent."""
        blind, lost = self.blind, self._refused
        if self.again is not None:
            blind = blind or self.again.blind
        elif not (self.held or blind or lost):
            return None
        return CommandsHeld(self.sent, blind, lost)

    @property
    def ticking(self) -> bool:
        """Whether a loop drives the bridge; a person who drives by hand is not blocked by a stop."""
        return self._last_tick is not None

    @property
    def motion(self) -> Motion:
        """What moves, with the commands that it moves by; a bridge that rewinds sets it."""
        return self._moving

    @motion.setter
    def motion(self, motion: Motion) -> None:
        self._moving, self.halted = motion, {}

    def may_move(self, name: str, mover: str = "") -> None:
        """Register a velocity command that is to be sent: one of the robots may move from now on."""
        if mover not in self._moving:
            self.moving(name, True, mover)

    def moving(self, name: str, is_moving: bool, mover: str = "", is_limited: bool = True) -> None:
        """Register a command that was sent to what moves, and whether the command has a limit in time."""
        others = {other: motion for other, motion in self._moving.items() if other != mover}
        since = self.now if is_limited else math.inf
        self._moving = {**others, mover: (name, since)} if is_moving else others
        if mover in self.halted:
            self.halted = {other: motion for other, motion in self.halted.items() if other != mover}

    def left_halted(self) -> list[CommandRecord]:
        """Return the commands that had set in motion what is :attr:`halted`; the next call returns none."""
        halted, self.halted = self.halted, {}
        last = {command.name: command for command in self.commands if command.sent}
        return [last[name] for name, _ in halted.values() if name in last]

    def drive(self, name: str, moves: bool) -> None:
        """Register whether the robot may move by a command: before it is sent, if it may, and after that."""
        self._drives += moves
        if moves is not (name in self.driven):
            self.driven = self.driven | {name} if moves else self.driven - {name}

    def suspend(self, sentence: str = "") -> None:
        """Send nothing until a person goes on."""
        self.blocked, self.held, self.suspended = True, True, sentence

    def go_on(self) -> None:
        """Send commands again: a person has seen why they were held."""
        if self.blocked:
            self.blocked, self.held, self.suspended = False, False, ""

    def stopped(self) -> None:
        """Register a stop: nothing more is sent in this tick."""
        self.stops += 1
        self.held = self.ticking or self.blocked

    @contextmanager
    def looking(self) -> Iterator[None]:
        """Refuse what this thread commands in this context: a condition that is tested changes nothing."""
        self._looking = threading.get_ident()
        try:
            yield
        finally:
            self._looking = 0

    @property
    def only_looks(self) -> bool:
        """Whether the caller may command nothing."""
        return threading.get_ident() == self._looking

    @property
    def is_stopping(self) -> bool:
        """Whether a bridge's `stop` is the caller."""
        return threading.get_ident() in self._stopping

    def run_stop(
        self, stop: Callable[[], None], timeout: float | None, instead: Callable[[], bool] = bool
    ) -> bool:
        """Call a bridge's `stop`, on a separate thread if it may block; return whether it succeeded in time.

        It never raises; a failure is logged as a notice.

        `timeout`: in seconds; None: it does not block.
        `instead`: called if `stop` has failed and the robot may move; returns whether it has stopped it.
        """
        if self.is_stopping:
            self._stopping[threading.get_ident()] = True
            self.notice("fault", f"The robot may not have stopped: {_CIRCULAR}")
            return False
        moving, self._moving = self._moving, Motion()
        drives = self._drives
        failure = failure_of(partial(self._stop_once, stop), timeout, "stop the robot")
        if failure and self.driven and instead():
            self.notice("guard", f"The guard process has stopped the robot. This one could not: {failure}")
            failure = ""
        if failure:
            again = {mover: (name, max(self.now, since)) for mover, (name, since) in moving.items()}
            self._moving = {**again, **self._moving}  # the watchdog stops it once more
            self.notice("fault", f"The robot may not have stopped: {failure}")
        elif self._drives == drives:  # else another command came meanwhile, in the next tick
            self.driven = frozenset()
        return not failure

    def _stop_once(self, stop: Callable[[], None]) -> None:
        thread = threading.get_ident()
        self._stopping[thread] = False
        try:
            stop()
        finally:
            is_circular = self._stopping.pop(thread)
        if is_circular:
            raise BridgeError(_CIRCULAR)

    def rest(self) -> None:
        """Expect no ticks for now: the program is paused or has ended."""
        self._last_tick = None
        self.held = self.blocked

    def commands_overdue(self, now: float) -> dict[str, str]:
        """Return the notices for the robots that move without new commands."""
        limit = patience(self.period)
        overdue = [each for each in self._moving.items() if now - each[1][1] >= limit - _ROUNDING]
        if not overdue:
            return {}
        last = {command.name: command.now for command in self.commands if command.sent}
        return {
            mover: f"No `{name}` has succeeded for {limit:g} s."
            if last.get(name, since) > since
            else f"No command for {limit:g} s. If it has to go on, put `{name}` into `running`."
            for mover, (name, since) in overdue
        }

    def tick_overdue(self, now: float) -> str | None:
        """Return the beginning of the notice for a loop that hangs, once for each silence, or None."""
        last, limit = self._last_tick, patience(self.period)
        if last is None or self._overdue_reported or now - last < limit - _ROUNDING:
            return None
        self._overdue_reported = True
        return f"No tick for {now - last:.1f} s"

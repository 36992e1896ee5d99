"""The record of a run: the data kept to rewind it, or to continue elsewhere from one of its moments.

For each tick there is a moment: the time at which it begins, and the state of the robot then. Whatever comes
from outside is an input with a number; from time to time a snapshot is taken as a checkpoint. The journal of
the interpreter, by which a rewind restores it, bounds all of them.

A record belongs to the thread that drives the loop. Other threads also add inputs, under the lock of the
inputs; when they stop or arm the robot, the loop records this before the next tick, step of the world, or
input.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from itertools import islice
from typing import Any, NamedTuple, cast

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.interventions import CommandsHeld
from lrp_jupyter.bridges.member_tree import RobotMethod
from lrp_jupyter.bridges.robot import part_name
from lrp_jupyter.bridges.tasks import TasksMoment
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.interpreter.copies import Packed, pack, unpack
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.live.running.checkpoints import (
    COPIED,
    PLAIN,
    Checkpoints,
    SessionCheckpoint,
    messages_heard,
    names_of,
)
from lrp_jupyter.live.running.inbox import Command
from lrp_jupyter.live.running.inputs import Input, Inputs, Rewound
from lrp_jupyter.live.running.notebook_names import ChangeNames, WatchedNames, random_module
from lrp_jupyter.live.running.timing import Timing


class Moment(NamedTuple):
    """The beginning of a tick: its time in seconds, the bridge's moment, its token for the readings.

    `tasks`: what was known then of what the robot had been asked for.
    """

    time: float
    world: object
    sensed: object
    tasks: TasksMoment


class Moments:
    """The moments of the last ticks, in order; or of the last tick only."""

    def __init__(self, *, only_last: bool) -> None:
        # Their parts are in one list: the garbage collector would have to visit a tuple for each tick.
        self.flat: list[Any] | deque[Any] = deque(maxlen=4) if only_last else []
        self.add = self.flat.extend

    def __len__(self) -> int:
        return len(self.flat) // 4

    def __getitem__(self, index: int) -> Moment:
        flat, place = self.flat, 4 * index
        return Moment(flat[place], flat[place + 1], flat[place + 2], flat[place + 3])

    def __iter__(self) -> Iterator[Moment]:
        parts = iter(self.flat)
        return map(Moment, parts, parts, parts, parts)

    def last(self, ticks: int) -> Iterator[Moment]:
        """Return the moments of at most this number of ticks, newest first; copied now, for any thread."""
        parts = iter([*islice(reversed(self.flat), 4 * ticks)])
        return (Moment(*reversed(each)) for each in zip(parts, parts, parts, parts, strict=True))

    def drop(self, ticks: int) -> None:
        """Drop the first moments."""
        if ticks > 0:
            del self.flat[: 4 * ticks]  # type: ignore[arg-type]

    def undo(self, ticks: int) -> None:
        """Drop the last moments."""
        if ticks > 0:
            del self.flat[-4 * ticks :]  # type: ignore[arg-type]

    def clear(self) -> None:
        """Drop all."""
        self.flat.clear()


class Record:
    """The data kept of a run, for as long as the interpreter's journal; see the module docstring."""

    def __init__(self, interpreter: Interpreter, bridge: Bridge, timing: Timing, remembers: bool) -> None:
        self._interpreter = interpreter
        self._bridge = bridge
        self._timing = timing
        self._remembers = remembers
        self.moments = Moments(only_last=not remembers)
        self.inputs = Inputs()
        """The inputs from outside, except those undone by a rewind."""
        self.checkpoints = Checkpoints()
        self.names = WatchedNames(interpreter.namespace)
        self.watch()
        self.begun: SessionCheckpoint | None = None
        """The last beginning of the program in a world that was at its start, too."""
        self.pending_at = 0.0
        """The earliest time with something to do before a tick: take a checkpoint, record a stop."""
        self.written: Callable[[Input], object] | None = None
        """Called with every input, even if a rewind undoes it later."""
        self._stops: deque[object] = deque()  # and armings, by other threads, not yet recorded
        self._replayed = False  # whether current events follow from a recorded input
        self._kept: list[object] | None = None  # inputs of the world that are kept during a rewind

    # -- inputs ----------------------------------------------------------------------------------

    def note(self, what: object) -> None:
        """Record an input, after the stops of other threads."""
        with self.inputs.lock:
            self.note_stops()
            self.add(what)

    def note_names(self) -> None:
        """Record changes of names of the namespace since a tick that may have read them."""
        change = self.names.change()
        if change is not None and self._interpreter.tick:
            self.note(change)

    def note_stops(self) -> None:
        """Record the stops of other threads."""
        if not self._stops:  # the usual case needs no lock
            return
        with self.inputs.lock:  # otherwise another thread could take the last one between these two lines
            while self._stops:
                self.add(self._stops.popleft())

    def note_later(self, what: object) -> None:
        """Have the loop record that another thread has stopped or armed the robot."""
        self._stops.append(what)
        self.pending_at = 0.0

    def note_outside(self, what: object, surely: bool) -> None:
        """Record an action on the robot, unless it came from a recorded input."""
        if self._kept is not None:
            self._kept.append(what)
        elif surely or not self._replayed:
            self.note(what)

    def add(self, what: object, tick: int | None = None) -> None:
        """Give an input its number, keep it and pass it on; it came after a tick, by default the last one."""
        with self.inputs.lock:  # held while the tick is read, so that ticks and numbers are in order
            entry = self.inputs.next(self._interpreter.tick if tick is None else tick, self._timing.now, what)
            if self._remembers and not (isinstance(what, Command) and what.undoes):
                kept, letters = what.kept(self) if isinstance(what, Command) else (what, 0)
                self.inputs.keep(entry._replace(what=kept), letters)
            if self.written is not None:
                self.written(entry)

    @contextmanager
    def deriving(self, derived: bool = True) -> Iterator[None]:
        """Mark everything that happens in this context as following from a recorded input."""
        outer, self._replayed = self._replayed, derived or self._replayed
        try:
            yield
        finally:
            self._replayed = outer

    # -- values ----------------------------------------------------------------------------------

    def watch(self) -> None:
        """Watch what the program, which may be another one, uses of what is outside."""
        self.names.watch(self.names_used())
        self._bridge.take_messages(messages_heard(link(self._interpreter.program)))

    def names_used(self) -> frozenset[str]:
        """Return the global names that the blocks of the program use."""
        return names_of(link(self._interpreter.program))

    def kept(self, value: object) -> object:
        """Return the form in which a value is kept: a packed copy if it is mutable."""
        return value if type(value) in PLAIN else pack([value], {}, self._token)

    def restored(self, value: object) -> object:
        """Return a value that was :meth:`kept`."""
        return unpack(value, [], self._find)[0] if isinstance(value, Packed) else value

    def _token(self, value: object) -> object:
        """Return the token of an object that is specific to each session; None for any other object."""
        if value is self._interpreter.namespace:
            return "namespace"
        return value.path if isinstance(value, RobotMethod) else part_name(value)

    def _find(self, token: object) -> object:
        return self._interpreter.namespace if token == "namespace" else self._bridge.nodes.table[str(token)]

    def moment(self, tick: int) -> Moment:
        """Return the beginning of a remembered tick."""
        return self.moments[tick - self._interpreter.tick - 1]

    @property
    def readings(self) -> Mapping[str, object]:
        """The readings of the last tick; none before the first."""
        return self.readings_of(self.moments[-1].sensed) if self.moments else {}

    def readings_of(self, sensed: object) -> Mapping[str, object]:
        """Return the readings of a tick by path, for their token in a moment; a failed one is its error."""
        world = self._bridge.simulated
        return cast(Mapping[str, object], sensed) if world is None else world.readings_of(sensed)

    # -- checkpoints -----------------------------------------------------------------------------

    def checkpoint(self, running: bool) -> SessionCheckpoint:
        """Return the checkpoint from which a copy of this session can continue; called between two ticks."""
        interpreter, timing, namespace = self._interpreter, self._timing, self._interpreter.namespace
        used = {name: namespace.get(name, self) for name in self.names_used()}
        beside = {name: value for name, value in used.items() if type(value) in COPIED}
        snapshot = interpreter.snapshot(self._token, beside)
        moment = self._bridge.moment()
        tasks = self._bridge.requested.moment
        return SessionCheckpoint(
            snapshot,
            timing.now,
            timing.due,
            timing.rate,
            running,
            self.inputs.count,
            moment,
            tasks,
            random_module(namespace).getstate(),
            self._bridge.safety.armed,
        )

    def begin(self, checkpoint: SessionCheckpoint) -> None:
        """Continue from a checkpoint of another session, whose bridge was forked there."""
        interpreter, timing, safety = self._interpreter, self._timing, self._bridge.safety
        self.names.begin(interpreter.begin(checkpoint.snapshot, self._find))
        timing.set_rate(checkpoint.rate)
        timing.jump(checkpoint.time, checkpoint.due)
        self.checkpoints.clear()
        self.pending_at = 0.0
        safety.tick(interpreter.now, timing.period)
        safety.armed = checkpoint.armed

    def prepare(self, running: bool) -> None:
        """Record the stops of other threads, and take a checkpoint if one is due."""
        self.note_stops()
        self.pending_at = math.inf
        if self._remembers:
            self._remember(running)
        if self._stops:  # added since then by a thread whose `pending_at` has been overwritten
            self.pending_at = 0.0

    def _remember(self, running: bool) -> None:
        """Take a checkpoint if one is due, and keep that of a beginning; see when the next one is due."""
        tick, timing, world = self._interpreter.tick, self._timing, self._bridge.simulated
        taken: SessionCheckpoint | None = None
        if tick >= self.checkpoints.due:
            taken = self.checkpoints.add(lambda: self.checkpoint(running))
            self._forget()
        if not self._interpreter.is_started and (world is None or world.is_at_start):
            self.begun = taken or self.checkpoint(running)
        period = 0.0 if timing.free else timing.period
        self.pending_at = timing.now + (self.checkpoints.due - tick) * period

    def _forget(self) -> None:
        """Drop everything that no tick of the journal needs: the journal bounds the whole record."""
        tick = self._interpreter.tick
        first = self.checkpoints.begin(tick - self._interpreter.journal)
        if first is None:
            return
        self.moments.drop(first.tick - (tick - len(self.moments)))
        self.inputs.begin(first.inputs)
        self._bridge.safety.begin(first.tick)
        if (world := self._bridge.simulated) is not None:
            world.forget(first.moment)

    def clear(self) -> None:
        """Drop all: a new run begins."""
        self.moments.clear()
        self.inputs.clear()
        self.checkpoints.clear()
        self.begun = None
        self.pending_at = 0.0

    # -- going back ------------------------------------------------------------------------------

    def rewind(self, ticks: int, running: bool) -> None:
        """Step back by this number of ticks: program, world and time.

        The world returns to the moment before the first undone tick, so that the next step repeats it.

        Raises BridgeError: a real robot is armed, or the world cannot go back that far.
        Raises ValueError: not that many ticks can be undone.
        """
        bridge, interpreter, timing = self._bridge, self._interpreter, self._timing
        if bridge.hardware and bridge.safety.armed:
            raise BridgeError(f"`{bridge.name}` is armed: a real robot cannot go back. Disarm it first.")
        have = min(interpreter.journal, len(self.moments))
        if not 0 <= ticks <= have:
            many = "1 tick" if ticks == 1 else f"{ticks} ticks"
            raise ValueError(f"Cannot go back {many}: only {have} can be undone.")
        kept: list[object] = []
        if ticks:
            then = self.moments[-ticks]
            self._kept = []
            try:
                bridge.rewind(then.world)  # the world may refuse; nothing has been changed yet
            finally:
                kept, self._kept = self._kept, None
            self.moments.undo(ticks)
            timing.jump(then.time, due=then.time)
            bridge.requested.go_back(then.tasks)
        interpreter.rewind(ticks)
        bridge.safety.go_back(interpreter.tick, interpreter.now)
        undone = self.inputs.undo(interpreter.tick, _is_of_the_world)
        self.names.undo(entry.what for entry in undone if isinstance(entry.what, ChangeNames))
        self.checkpoints.cut(interpreter.tick)
        if self.begun is not None and self.begun.tick > interpreter.tick:
            self.begun = None
        self.pending_at = 0.0
        for what in kept:
            self.inputs.keep(self.inputs.next(interpreter.tick, timing.now, what))
        self.note_names()  # they keep their values
        if self._remembers:  # the rate and the policies stay, though their inputs are dropped
            is_first, entry = not self.checkpoints.all, self.inputs.next(interpreter.tick, timing.now, None)
            taken = self.checkpoints.add(lambda: self.checkpoint(running), rewound=True)
            if taken is not None and not is_first:  # an earlier run may reach it
                self.inputs.keep(entry._replace(what=Rewound(taken)), len(taken.snapshot.values.data))


def _is_of_the_world(what: object) -> bool:
    """Return whether an input is an action on the robot or its world, not on the program or in a tick."""
    return not isinstance(what, (Command, Rewound, CommandsHeld))

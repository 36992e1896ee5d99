"""Forks: independent copies of a session at a moment of its past, in virtual time, with no effect outside.

A fork begins at the last checkpoint before the moment and repeats the recorded ticks and inputs up to it. Its
blocks have no effect outside: variables are copied, as are numbers, texts and collections that blocks read
from the namespace, with their values at the checkpoint. A simulated robot is copied, random numbers are drawn
from a copy of Python's generator, and printed text goes to the fork's own output. A real robot is replaced by
its recorded readings.

Everything else is shared with the session: other objects in the namespace, such as instances and open files,
and anything that cannot be copied. A fork is refused if its repeated ticks lead to a state that differs from
the recorded one, unless the robot is real: then only its readings are known.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType, ModuleType
from typing import Any, NamedTuple

from lrp_jupyter.bridges.bridge import Bridge, NullBridge
from lrp_jupyter.bridges.recorded import RecordedBridge
from lrp_jupyter.bridges.tasks import TasksMoment
from lrp_jupyter.interpreter.history import PastState
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.issues import IssueLog
from lrp_jupyter.language.program import path_text
from lrp_jupyter.live.past.leftovers import differ
from lrp_jupyter.live.past.replay import Entry, Ticked, merged
from lrp_jupyter.live.running.checkpoints import SessionCheckpoint
from lrp_jupyter.live.running.inputs import EndRun, Input, Resume
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.running.notebook_names import ChangeNames, random_module, with_modules


class ForkStart(NamedTuple):
    """The parts from which a copy of a session is made; robot and namespace are those of the checkpoint.

    `entries`: the entries repeated up to the moment of the copy; `later` are those after it.
    `recorded`: the recorded state at that moment; None if there is none to which the copy must have come.
    """

    checkpoint: SessionCheckpoint
    entries: tuple[Entry, ...]
    later: tuple[Entry, ...]
    bridge: Bridge
    recorded: PastState | None = None
    namespace: Mapping[str, Any] = MappingProxyType({})


def run_start(loop: Loop) -> ForkStart:
    """Return the parts of a copy now, made from the last beginning of the program in a world at its start.

    Raises ValueError: there was none, or it is no longer remembered.
    """
    loop.settle()
    begun, reason = loop.record.begun, unkept(loop)
    if begun is None or reason:
        raise ValueError(reason)
    tick, settings = loop.interpreter.tick, {**begun.snapshot.settings, "paused": False}
    new = replace(begun.snapshot, issues=IssueLog(), unmeant=None, settings=settings)  # of no run before
    start = _start_from(loop, begun._replace(snapshot=new, running=False), tick)
    resumed = (Input(0, begun.tick, begun.time, Resume()),) if begun.running else ()
    ended = Input(0, tick, loop.timing.now, EndRun())
    return start._replace(entries=(*resumed, *start.entries), later=(*start.later, ended))


def unkept(loop: Loop) -> str:
    """Return why the run cannot be repeated from its beginning; empty if it can. From any thread."""
    begun, record = loop.record.begun, loop.record
    if not loop.interpreter.tick:
        return "No tick has run yet. Run the program first."
    if begun is None:
        return "This run did not begin at the start of its world, so it cannot be kept. Begin a new run."
    if begun.tick < loop.interpreter.tick - len(record.moments) or begun.inputs < record.inputs.lost:
        ago = loop.timing.now - begun.time
        many = f"{ago:.0f} s" if ago < 90 else f"{ago / 60:.0f} minutes"
        return f"This run began {many} ago, and its beginning is no longer remembered. Begin a new run."
    return "" if begun.tick < loop.interpreter.tick else "This run has just begun: no tick has run yet."


def fork_start(loop: Loop, at: int | None) -> ForkStart:
    """Return the parts of a copy, now or after an earlier tick; called between two ticks.

    Raises ValueError: the tick is not, or no longer, recorded.
    Raises BridgeError: the world cannot be reproduced so long ago.
    """
    loop.settle()
    now, record = loop.interpreter.tick, loop.record
    if at is None:
        checkpoint = record.checkpoint(loop.status == "running")
        bridge = _forked(loop.bridge, checkpoint.moment, checkpoint.tasks)
        return ForkStart(checkpoint, (), (), bridge, namespace=record.names.namespace_before(()))
    record.checkpoints.drop(record.inputs.lost)
    after = record.inputs.since(at)
    found = record.checkpoints.before(at, after[0].number if after else math.inf)
    first = now - loop.interpreter.journal
    if found is None or not max(found.tick, first) <= at <= now:
        if not now:
            raise ValueError("No tick has run yet. Run the program first.")
        every = record.checkpoints.all
        known = f"Choose one from {max(every[0].tick, first)} to {now}." if every else "None is."
        raise ValueError(f"Tick {at} is not remembered. {known}")
    return _start_from(loop, found, at)


def _start_from(loop: Loop, found: SessionCheckpoint, at: int) -> ForkStart:
    """Return the parts of a copy after a tick, made from a checkpoint before it."""
    now, record = loop.interpreter.tick, loop.record
    bridge = _forked(loop.bridge, found.moment, found.tasks)
    feeds = isinstance(bridge, RecordedBridge)
    moments = [record.moment(tick) for tick in range(found.tick + 1, now + 1)]
    ticks = [
        Ticked(found.tick + number, time, record.readings_of(sensed) if feeds else None)
        for number, (time, _, sensed, _) in enumerate(moments, 1)
    ]
    inputs = [entry for entry in record.inputs if entry.number > found.inputs]
    whole = list(merged(ticks, inputs))
    count = next((index for index, entry in enumerate(whole) if _is_after(entry, at)), len(whole))
    history = loop.interpreter.history
    is_exact = not feeds and found.tick < at and at in history.ticks
    recorded = history.state(at) if is_exact else None
    changes = [entry.what for entry in inputs if isinstance(entry.what, ChangeNames)]
    namespace = record.names.namespace_before(changes)
    return ForkStart(found, tuple(whole[:count]), tuple(whole[count:]), bridge, recorded, namespace)


def started_again(start: ForkStart) -> ForkStart:
    """Return the parts of another copy from the same moment, where the robot of these still has to be."""
    return start._replace(bridge=_forked(start.bridge, start.bridge.moment(), start.bridge.requested.moment))


def check_repeated(recorded: PastState, copy: Interpreter) -> None:
    """Raise ValueError if the ticks that were repeated in a copy have not led to the recorded state."""
    repeated = copy.history.state(copy.tick)  # an `onpause` caused by an issue of this tick came after it
    variables = repeated.variables
    other = [path for path, value in recorded.variables.items() if differ(value, variables.get(path))]
    if not other and recorded.active == repeated.active:
        return
    what = f"`{path_text(other[0])}` had another value" if other else "other states were active"
    raise ValueError(
        f"Tick {copy.tick} cannot be repeated exactly: {what}. The program may depend on something that is "
        "not recorded, such as a clock, a file, or a variable that a function of the notebook reads."
    )


def _is_after(entry: Entry, tick: int) -> bool:
    return entry.tick > tick if isinstance(entry, Ticked) else entry.tick >= tick


def _forked(bridge: Bridge, moment: object, tasks: TasksMoment) -> Bridge:
    """Return an open copy of a robot or, if it cannot be copied, a robot that repeats its readings."""
    fork: Bridge
    if bridge.simulated is not None:
        fork = bridge.simulated.fork(moment)
    else:
        fork = NullBridge() if isinstance(bridge, NullBridge) else RecordedBridge(bridge.nodes.members())
        fork.open()
    fork.requested.moment = tasks
    return fork


def private_namespace(namespace: Mapping[str, Any], state: tuple[Any, ...]) -> dict[str, Any]:
    """Return a copy of a namespace in which `random` and its functions use a generator with this state."""
    generator = random.Random()
    generator.setstate(state)
    current = random_module(namespace)
    shared = vars(current)["_inst"]
    module = ModuleType("random", random.__doc__)
    vars(module).update(vars(current), _inst=generator)
    for name, value in vars(current).items():
        if getattr(value, "__self__", None) is shared:
            setattr(module, name, getattr(generator, name))
    return with_modules(namespace, module)

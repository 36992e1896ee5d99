"""Forks: independent copies of a session at a moment of its past, in virtual time, with no effect outside.

A fork begins at the last checkpoint before the moment and repeats the recorded ticks and inputs up to it.
What its blocks do stays inside: variables and the objects of the namespace that they change are copies, the
robot is a copy of the simulated one, random numbers are drawn from a copy of Python's generator, and what is
printed is kept in the fork's own output. Where the robot is a real one, its recorded readings are fed.
"""

from __future__ import annotations

import builtins
import random
from types import BuiltinMethodType, MethodType, ModuleType
from typing import Any, NamedTuple

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.recorded import RecordedBridge
from lrp_jupyter.live.checkpoints import SessionCheckpoint
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.replay import Entry, Ticked, merged

__all__ = ["ForkStart", "fork_start", "private_namespace"]


class ForkStart(NamedTuple):
    """What a copy of a session is made of.

    Parameters
    ----------
    checkpoint : SessionCheckpoint
        Where it begins.
    entries : tuple
        What is repeated up to the moment of the copy.
    later : tuple
        What came after that.
    bridge : Bridge
        The copy of the robot at the checkpoint.
    """

    checkpoint: SessionCheckpoint
    entries: tuple[Entry, ...]
    later: tuple[Entry, ...]
    bridge: Bridge


def fork_start(loop: Loop, at: int | None) -> ForkStart:
    """Return what a copy is made of, now or after an earlier tick; between two ticks.

    Raises
    ------
    ValueError
        The tick is not recorded (any more).
    BridgeError
        The world cannot be reproduced so long ago.
    """
    loop.settle()
    now = loop.interpreter.tick
    if at is None:
        checkpoint = loop.checkpoint()
        return ForkStart(checkpoint, (), (), _forked(loop.bridge, checkpoint.moment))
    loop.checkpoints.drop(loop.inputs.lost)
    found = loop.checkpoints.before(at)
    first = now - loop.interpreter.journal
    if found is None or not max(found.tick, first) <= at <= now:
        least = loop.checkpoints.all[0].tick if loop.checkpoints.all else now
        raise ValueError(f"Tick {at} is not recorded: only {max(least, first)} to {now} are.")
    bridge = _forked(loop.bridge, found.moment)
    feeds = isinstance(bridge, RecordedBridge)
    moments = [loop.moments[tick - now - 1] for tick in range(found.tick + 1, now + 1)]
    ticks = [
        Ticked(found.tick + number, time, loop.bridge.readings_of(sensed) if feeds else None)
        for number, (time, _, sensed) in enumerate(moments, 1)
    ]
    inputs = [entry for entry in loop.inputs if entry.number > found.inputs]
    whole = list(merged(ticks, inputs))
    count = next((index for index, entry in enumerate(whole) if _is_after(entry, at)), len(whole))
    return ForkStart(found, tuple(whole[:count]), tuple(whole[count:]), bridge)


def _is_after(entry: Entry, tick: int) -> bool:
    """Return whether an entry comes after the end of a tick."""
    return entry.tick > tick if isinstance(entry, Ticked) else entry.tick >= tick


def _forked(bridge: Bridge, moment: object) -> Bridge:
    fork = bridge.fork(moment)
    if fork is None:
        fork = RecordedBridge(bridge.name, bridge.nodes.members())
        fork.open()
    return fork


def private_namespace(namespace: dict[str, Any], state: tuple[Any, ...]) -> dict[str, Any]:
    """Return a copy of a namespace in which `random` and its functions draw numbers of their own.

    Parameters
    ----------
    namespace : dict
    state : tuple
        The state in which the generator begins.
    """
    generator = random.Random()
    generator.setstate(state)
    module = ModuleType("random", random.__doc__)
    vars(module).update(vars(random))
    shared = random._inst
    for name, value in vars(random).items():
        if getattr(value, "__self__", None) is shared:
            setattr(module, name, getattr(generator, name))

    def own_import(name: str, *arguments: Any, **keywords: Any) -> Any:
        return module if name == "random" else builtins.__import__(name, *arguments, **keywords)

    private: dict[str, Any] = {}
    for name, value in namespace.copy().items():  # other threads may write it
        if value is random:
            value = module
        elif isinstance(value, (MethodType, BuiltinMethodType)) and value.__self__ is shared:
            value = getattr(generator, value.__name__)
        private[name] = value
    private["__builtins__"] = {**vars(builtins), "__import__": own_import}
    return private

"""Repeat recorded ticks and inputs: the only way in which a run is reproduced.

A loop is advanced to the time of each entry and repeats the entry there. With a simulated robot, or none, the
run is the same bit for bit; with the readings of a real robot, if the program depends only on them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import nullcontext, suppress
from typing import NamedTuple

from lrp_jupyter.bridges.interventions import (
    CommandsHeld,
    MembersChanged,
    RobotArmed,
    RobotCommanded,
    RobotStopped,
)
from lrp_jupyter.bridges.recorded import RecordedBridge, recorded_members
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.language.blocks.expressions import Evaluation
from lrp_jupyter.language.program import Element, Path
from lrp_jupyter.live.past.leftovers import leftover
from lrp_jupyter.live.running.checkpoints import SessionCheckpoint
from lrp_jupyter.live.running.commands import Rename, ReplaceProgram, SetPolicy, SetRate
from lrp_jupyter.live.running.inbox import Command
from lrp_jupyter.live.running.inputs import EndRun, Input, Resume, Rewound
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.stored.json_values import unplain


class WentBackError(ValueError):
    """What came after a tick cannot be repeated from an earlier one: the session went back to it.

    `left`: what was no longer as before.
    """

    def __init__(self, tick: int, left: str) -> None:
        super().__init__(
            f"What came after tick {tick} cannot be repeated from an earlier tick: the session went back to "
            f"it, and {left} was no longer as before. Begin at tick {tick} or later."
        )
        self.left = left


class Ticked(NamedTuple):
    """A tick of a recorded run, with the values that were read if the robot cannot be reproduced."""

    tick: int
    time: float
    readings: object = None


Entry = Ticked | Input


def merged(ticks: Iterable[Ticked], inputs: Iterable[Input]) -> Iterator[Entry]:
    """Yield ticks and inputs in the order in which they happened."""
    waiting = list(reversed(list(inputs)))
    for tick in ticks:
        while waiting and waiting[-1].tick < tick.tick:
            yield waiting.pop()
        yield tick
    yield from reversed(waiting)


def without_edits(entries: Iterable[Entry]) -> Iterator[Entry]:
    """Leave out the inputs that change the program, and entries valid only for the recorded program."""
    return (
        entry
        for entry in entries
        if not (isinstance(entry, Input) and isinstance(entry.what, (ReplaceProgram, Rename, Rewound)))
    )


def play(
    loop: Loop, script: deque[Entry], end: float, after_tick: Callable[[], object] | None = None
) -> bool:
    """Repeat the entries up to a time, in seconds of the run; return whether `after_tick` ended the run.

    The run may diverge from the recorded one: inputs that are impossible in it are left out.
    """
    while script and script[0].time <= end + 1e-9:
        entry = script.popleft()
        is_left_out = isinstance(entry, Input) and not isinstance(entry.what, Rewound)
        with suppress(Exception) if is_left_out else nullcontext():
            repeat(loop, entry)
        if isinstance(entry, Ticked) and after_tick is not None and after_tick():
            return True
    if script:
        due = script[0].time
        loop.timing.go_to(min(end, due))
        loop.timing.due = due
    else:
        loop.rest()
    return False


def repeat(loop: Loop, entry: Entry) -> None:
    """Repeat an entry in a loop, at its recorded time."""
    loop.timing.go_to(entry.time)
    if isinstance(entry, Ticked):
        if isinstance(loop.bridge, RecordedBridge) and isinstance(entry.readings, dict):
            loop.bridge.given = entry.readings
        loop.tick()
    else:
        _apply(loop, entry.what)


def _apply(loop: Loop, what: object) -> None:
    bridge = loop.bridge
    match what:
        case Command():
            loop.apply(what)
        case RobotStopped():
            bridge.stop_all()
        case RobotArmed(armed):
            (bridge.arm if armed else bridge.disarm)()
        case Rewound(checkpoint):
            _check_rewound(loop, checkpoint)
            _write_settled(loop, checkpoint)
            loop.settle_as(checkpoint)
        case CommandsHeld():
            bridge.safety.again = what
        case MembersChanged(members):
            if isinstance(bridge, RecordedBridge):
                bridge.become(recorded_members(members, unplain))
        case RobotCommanded(name, arguments):
            bridge.nodes.table[name](**arguments)  # type: ignore[operator]
        case _ if bridge.simulated is not None:
            bridge.simulated.repeat(what)
        case _:
            raise BridgeError(f"`{bridge.name}` has no world to which {what!r} could be done.")


def _check_rewound(loop: Loop, checkpoint: SessionCheckpoint) -> None:
    """Raise WentBackError if undone ticks left an effect behind: the run continued from another state."""
    world = loop.bridge.simulated
    other = "" if world is None or world.has_come_to(checkpoint.moment) else "the world"
    if loop.record.written is not None and loop.interpreter.paused != checkpoint.snapshot.settings["paused"]:
        other = "a pause"  # which no input of a recording says
    if left := other or leftover(checkpoint, loop.record.checkpoint(loop.status == "running")):
        raise WentBackError(checkpoint.tick, left)


def _write_settled(loop: Loop, checkpoint: SessionCheckpoint) -> None:
    """Write what a rewind has left as it was, if the run is recorded: its own inputs are undone."""
    written, settings = loop.record.written, checkpoint.snapshot.settings
    if written is None:
        return
    interpreter, tick, now = loop.interpreter, loop.interpreter.tick, loop.timing.now
    left: list[Command] = [
        SetPolicy(name, settings[name])
        for name in ("on_active_edit", "on_issue")
        if getattr(interpreter, name) != settings[name]
    ]
    if loop.timing.rate != checkpoint.rate:
        left.append(SetRate(checkpoint.rate))
    if (loop.status == "running") != checkpoint.running:
        left.append(Resume() if checkpoint.running else EndRun())
    for what in left:
        written(Input(0, tick, now, what))


def tested_again(
    loop: Loop, script: deque[Entry], element: Element, machine: Path
) -> Evaluation | Exception | None:
    """Repeat the entries up to the end of the next tick; return how a transition was tested in it, if it was.

    Return None also if its test is not a single expression.

    `machine`: that of the transition, by path as spawned.
    """
    while script and not isinstance(script[0], Ticked):
        repeat(loop, script.popleft())
    seen: list[Evaluation | Exception] = []
    loop.interpreter.watch_test(element, machine, seen.append)
    if script:
        repeat(loop, script.popleft())
    return seen[-1] if seen else None

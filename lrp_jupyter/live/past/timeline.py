"""The timeline: the events of a run in order, read on demand from journal, inputs and the log of commands."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from lrp_jupyter.bridges.guarding.safety import CommandRecord
from lrp_jupyter.bridges.interventions import RobotCommanded, WorldLoaded
from lrp_jupyter.interpreter.facts import Commanded, Discarded, Entered, Fact, Faulted, Fired
from lrp_jupyter.interpreter.history import History, PastState
from lrp_jupyter.interpreter.rendering import is_scalar, short
from lrp_jupyter.language.program import Element, Path, path_text
from lrp_jupyter.live.past.plots import Plot, plottable, plotting
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.running.notebook_names import ChangeNames
from lrp_jupyter.live.why.earlier_names import Names
from lrp_jupyter.live.why.wording import call_text, time_text
from lrp_jupyter.sim.world_edits import WorldEdit
from lrp_jupyter.sim.world_inputs import PlaceRobot, PlaceSolid, ResetWorld

HappeningKind = Literal["entered", "ended", "edit", "restart", "issue", "pause", "command", "hand"]


@dataclass(frozen=True, slots=True)
class Happening:
    """Something that happened in a run.

    `tick`: the tick in which, or after which, it happened.
    `time`: the time of the tick, in seconds.
    `kind`: ``entered`` (a state), ``ended`` (a machine), ``edit``, ``restart``, ``issue``, ``pause``,
        ``command`` (of the robot) or ``hand`` (something was done by hand).
    `lane`: the machine, as spawned.
    `state`: the state that was entered, by path of definition.
    `by`: the transition that entered it; or the name of the command.
    `text`: a description.
    `call`: for a command, the call as written in a program, in backticks.
    """

    tick: int
    time: float
    kind: HappeningKind
    lane: Path = ()
    state: Path = ()
    by: Path = ()
    text: str = ""
    call: str = field(default="", repr=False)


class TimelineCursor(NamedTuple):
    """The part of a timeline that a caller has: the last tick, and the epoch of the run."""

    epoch: int = -1
    tick: int = -1


@dataclass(frozen=True, slots=True, repr=False)
class Timeline:
    """The happenings since a moment; printed with one line for each.

    `epoch`: changes when ticks are undone, or elements are renamed.
    `first`, `last`: the first and the last recorded tick.
    `begin`, `end`: their times in seconds.
    `kept`: the happenings up to this tick, known to the caller, stay valid; later ones are in `happenings`.
    `happenings`: the happenings, in order.
    `plots`: the plots of the requested names.
    `names`: the names that can be plotted now.
    """

    epoch: int
    first: int
    last: int
    begin: float
    end: float
    kept: int
    happenings: tuple[Happening, ...]
    plots: tuple[Plot, ...]
    names: tuple[str, ...]

    @property
    def cursor(self) -> TimelineCursor:
        """The cursor of a caller that has received this timeline."""
        return TimelineCursor(self.epoch, self.last)

    def __repr__(self) -> str:
        return f"<Timeline: {self.begin:g} to {self.end:g} s, {len(self.happenings)} happenings>"

    def __str__(self) -> str:
        shared = lanes_of_shared(self.happenings)
        return "\n".join(f"{time_text(each.time)}: {_sentence(each, shared)}" for each in self.happenings)


def lanes_of_shared(happenings: Iterable[Happening]) -> set[Path]:
    """Return the lanes of the machines that have several, because they ran in several places."""
    lanes: dict[Path, set[Path]] = {}  # by path of definition
    for each in happenings:
        if each.state:
            lanes.setdefault(each.state[:-1], set()).add(each.lane)
    return {lane for several in lanes.values() if len(several) > 1 for lane in several}


def _sentence(each: Happening, shared: AbstractSet[Path]) -> str:
    """Return a happening as a sentence; a state of a machine that runs in several places as spawned."""
    match each.kind:
        case "entered":
            state = (*each.lane, each.state[-1]) if each.lane in shared else each.state
            return f"`{path_text(state)}` was entered. {each.text}".rstrip()
        case "ended":
            return f"`{path_text(each.lane)}` ended."
        case "issue" if each.lane in shared:
            return f"In `{path_text(each.lane)}`: {each.text}"
    return each.text


def timeline_of(
    loop: Loop, cursor: TimelineCursor | None = None, plots: Mapping[str, int] | None = None
) -> Callable[[], Timeline]:
    """Return, between two ticks, a function that gives the timeline on any thread: it computes the plots.

    `plots`: the names to plot, each with the tick up to which its samples are known.
    """
    interpreter, history = loop.interpreter, loop.interpreter.history
    renamed = interpreter.moved[-1][0] if interpreter.moved else 0  # at which revision
    epoch = history.run.epoch + renamed  # both only increase
    ticks = history.ticks
    known = cursor is not None and cursor.epoch == epoch and ticks.start <= cursor.tick < ticks.stop
    kept = cursor.tick - 1 if known and cursor is not None else -1
    begin = history.time(ticks.start) if ticks else loop.timing.now
    told = Timeline(
        epoch,
        ticks.start,
        ticks.stop - 1,
        begin,
        loop.timing.now,
        kept,
        tuple(happenings(loop, kept if known else None)),
        (),
        tuple(plottable(loop)),
    )
    plot = plotting(loop, (plots or {}) if known else dict.fromkeys(plots or {}, 0))
    return lambda: replace(told, plots=tuple(plot()))


def happenings(loop: Loop, after: int | None = None, *, gap: bool = False) -> list[Happening]:
    """Return what happened after a tick, in order; by default with the states active at the beginning.

    `gap`: whether to include what was done between this tick and the next.
    """
    history = loop.interpreter.history
    ticks = history.ticks
    found: list[Happening] = []
    if after is None:
        after = ticks.start - 1
        time = history.time(ticks.start) if ticks else loop.timing.now
        found += present(history.state(after), after, time)
    first = max(after + 1, ticks.start)
    if ticks:
        told = history.told(first - 1)
        faults = [(when, fact) for when, fact in told if isinstance(fact, Faulted) and when == int(when)]
        failed = {(when, *_fault(fact)) for when, fact in faults}
        for when, fact in told:
            if when < first - (0.5 if gap else 0):
                continue
            if isinstance(fact, Faulted) and (when - 1, *_fault(fact)) in failed:
                continue
            tick = int(when)  # events between two ticks belong to the first
            happened = _of(fact, tick, history.time(max(tick, ticks.start)))
            if happened is not None:
                found.append(happened)
    if moves := loop.interpreter.moves:
        names = Names(moves, math.inf)
        found = [_renamed(each, names) for each in found]
    if ticks:
        found += _commands(history, loop.bridge.safety.commands, first)
        found += _by_hand(loop, first)
    return sorted(found, key=lambda each: each.tick)  # stable: within a tick as listed


def _fault(fact: Faulted) -> tuple[Element, str, Path]:
    """Return what is the same in every tick in which a fault persists."""
    return fact.element, fact.kind, fact.machine


def _renamed(each: Happening, names: Names) -> Happening:
    if not each.lane:
        return each
    return replace(
        each,
        lane=names.of("machine", each.lane, each.tick),
        state=names.of("state", each.state, each.tick) if each.state else (),
        by=names.of("transition", each.by, each.tick) if each.by else (),
    )


def present(state: PastState, tick: int, time: float) -> list[Happening]:
    """Return the entries of the states that are already active at a time, in seconds."""
    return [
        Happening(tick, min(machine.entered, time), "entered", machine.path, machine.state)
        for machine in state.walk()
    ]


def _of(fact: Fact, tick: int, time: float) -> Happening | None:
    match fact:
        case Fired():
            by, text = fact.transition.path, f"`{fact.label}` fired."
            return Happening(tick, time, "entered", fact.path[:-1], fact.state, by, text)
        case Entered():
            return Happening(tick, time, "entered", fact.path[:-1], fact.state)
        case Discarded():
            return Happening(tick, time, "ended", fact.machine)
        case Faulted():
            return Happening(tick, time, "issue", fact.machine, text=fact.message)
        case Commanded("patched" | "renamed"):
            return Happening(tick, time, "edit", text=_EDITED[fact.kind])
        case Commanded("restarted", "" | "reset"):
            return Happening(tick, time, "restart", text="The program was reset.")
        case Commanded("restarted", reason):
            return Happening(tick, time, "restart", text=f"The program restarted: {reason}")
        case Commanded("paused", reason) if reason:
            return Happening(tick, time, "pause", text=reason)
        case Commanded("forced", how, state):
            return Happening(tick, time, "hand", text=f"`{state[-1]}` was entered by hand {_FORCED[how]}.")
        case Commanded("assigned", name):
            return Happening(tick, time, "hand", text=f"`{name}` was set.")
    return None


_EDITED = {"patched": "The program was edited.", "renamed": "An element was renamed."}
_FORCED = {
    "transition": "(Transition here)",
    "teleport": "(Teleport here), without running actions",
    "fire": "(Fire now)",
}


def _commands(history: History, commands: Sequence[CommandRecord], first: int) -> Iterator[Happening]:
    """Yield the commands of the robot that differ from the previous ones."""
    for command in commands[bisect_left(commands, first, key=lambda each: each.first.tick) :]:
        origin = command.first
        if origin.tick not in history.ticks:
            continue
        said = call_text(command.name, command.arguments)
        where = f", line {origin.line}" if origin.line else ""
        sent = "" if command.sent else ", not sent"
        by, text = tuple(command.name.split(".")), f"{said}{where}{sent}."
        yield Happening(origin.tick, history.time(origin.tick), "command", by=by, text=text, call=said)


def _by_hand(loop: Loop, first: int) -> Iterator[Happening]:
    """Yield actions from outside on the robot, its world, and names that the program reads."""
    history = loop.interpreter.history
    changed: dict[str, int] = {}
    for entry in loop.record.inputs.since(first - _STREAM):
        if isinstance(entry.what, ChangeNames):
            new = [name for name in entry.what.names if entry.tick - changed.get(name, -_STREAM) >= _STREAM]
            changed.update(dict.fromkeys(entry.what.names, entry.tick))
            text = _renewed(entry.what.after, new)
        else:
            text = _hand(entry.what)
        if text and entry.tick >= first and entry.tick in history.ticks:
            yield Happening(entry.tick, history.time(entry.tick), "hand", text=text)


_STREAM = 5
"""A name that changes again within fewer ticks is a stream of values, and is reported once."""


def _renewed(values: Mapping[str, object], names: Sequence[str]) -> str:
    changes = [f"`{name}` was {_changed(values[name]) if name in values else 'deleted'}" for name in names]
    return f"{' and '.join(changes)} outside the program." if changes else ""


def _changed(value: object) -> str:
    return f"set to `{short(value)}`" if is_scalar(value) else "changed"


def _hand(what: object) -> str:
    match what:
        case PlaceRobot():
            return "The robot was moved by hand."
        case PlaceSolid():
            return "A solid was moved by hand."
        case ResetWorld():
            return "The world was reset."
        case WorldEdit():
            return "The world was edited."
        case WorldLoaded():
            return "Another world was loaded."
        case RobotCommanded(name):
            return f"`robot.{path_text((name,))}` was commanded by hand."
    return ""

r"""Recordings: a session in a file, from which it is reproduced in another process.

A recording (``.lrplog``; compressed if its name ends with ``.gz``) is a JSON Lines file. The first line
describes the start of the run::

    {"lrplog":3,"text":"(var n := …","filename":"follower.lrp","bridge":"sim","world":{…},"rate":10,…}

The inputs and their effects follow in the order in which they happened. Every line has ``tick`` and ``time``
(seconds). For an input, ``tick`` is the number of ticks completed before it::

    {"tick":12,"time":1.13,"input":"edit","text":"…"}
    {"tick":12,"time":1.13,"input":"place","pose":[0.5,1.0,0.0],"robot":0}

``recorded`` in the first line is when that was, with the zone: ``2026-11-29T06:16:33.250+01:00``.

Every tick has its readings; effects are the lines of a trace (``trace.py``), each with ``event``::

    {"tick":13,"time":1.2,"event":"entered","state":"follower/looking"}
    {"tick":13,"time":1.2,"event":"commanded","command":"move","arguments":{…},"sent":true,
     "block":"looking.running","line":12}
    {"tick":13,"time":1.2,"readings":{"light.data":255}}

Where the robot has a clock (ROS: that of its nodes, bags and messages), the first tick has what it showed, in
seconds, and so has every tick after a pause or a leap of that clock; in between, both times pass alike. So a
recording can be laid beside a bag::

    {"tick":1,"time":0.0,"readings":{"light.data":255},"clock":1764393393.25}

On request, inputs also have the wall time, in seconds since the recording began (pauses included), and
further lines describe what a person looked at and did. A replay ignores both::

    {"tick":12,"time":1.13,"wall":71.4,"look":"why","about":"transition follower:tlooking","on":true}

With a simulated robot, or none, the inputs reproduce the run bit for bit (the order of a set of strings
differs in another process, unless ``PYTHONHASHSEED`` is the same number); the effects are compared, and the
first difference is reported. The readings of a real robot are fed to the program again, and what its methods
have returned or raised in the tick, call by call: ``"battery()":[null,97]``. The effects of a tick or an
input are written before it, so in a truncated file everything after the last complete tick or input is
ignored.
"""

from __future__ import annotations

import ast
import json
import os
import random
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import datetime
from functools import lru_cache
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.bridges.interventions import CommandsHeld, MembersChanged
from lrp_jupyter.bridges.member_tree import RobotMethod, RobotVariable
from lrp_jupyter.bridges.recorded import RecordedBridge, recorded_members
from lrp_jupyter.errors import FileError, UnknownElementError, sentence_of
from lrp_jupyter.files import shown
from lrp_jupyter.interpreter.alone import alone
from lrp_jupyter.interpreter.rendering import short
from lrp_jupyter.language.edits.initials import with_initialiser
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Program
from lrp_jupyter.live.past.replay import Entry, Ticked
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.inputs import Input
from lrp_jupyter.live.running.timing import FASTEST, SLOWEST
from lrp_jupyter.live.stored.input_lines import input_of
from lrp_jupyter.live.stored.json_values import unplain
from lrp_jupyter.live.stored.looked_at import Look, look_of
from lrp_jupyter.live.stored.recorded_code import RecordedCode
from lrp_jupyter.live.trace import check_line
from lrp_jupyter.logs import at_line, read_log
from lrp_jupyter.sim.worlds import load

__all__ = ["VERSION", "Recording", "RunStart", "random_of", "read_recording", "recording_of"]

VERSION = 3
_LATEST = 1e7  # seconds of a run
_MAKE = "`lrp run FILE --record run.lrplog` makes one."
_LONGEST_WAIT = 1.5 / SLOWEST  # seconds between two lines of a simulated run

_MOST = 2_000_000_000  # bytes of memory of a recording: a day of a simulated robot
_PARSED = 60  # bytes of memory per character of a program
_LONGEST_PROGRAM = 1_000_000  # characters

Line = dict[str, Any]

_OF_THE_RUN = ("rest", "hold", "members")
"""Inputs that no person has made: the run ended, commands were held back, the robot has other members."""


@dataclass(frozen=True, slots=True)
class RunStart:
    """The start of a recorded session.

    `text`, `filename`: the program.
    `bridge`: the name of the bridge.
    `world`: the simulated world in its JSON form, including noise and seed.
    `members`: the members of `robot`, unless it was simulated.
    `names`: the names used by the blocks that neither the program nor Python defines: a notebook's.
    `random`: the seed of Python's random numbers, if they were seeded for the recording; else their state.
    `initials`: initial values that differ from those in the text.
    `values`: the values of the `names` that can be written, as Python expressions.
    `armed`: whether commands were sent to the robot.
    `recorded`: when it was recorded, as ISO 8601 with the zone; empty if that is not known.
    `start`: the machine, or state, that was started instead of what the program spawns; empty: none was.
    """

    text: str
    filename: str
    bridge: str
    world: Mapping[str, Any] | None = None
    members: Sequence[Mapping[str, Any]] = field(default_factory=list)
    rate: float = 10.0
    on_active_edit: str = "restart"
    on_issue: str = "record"
    names: list[str] = field(default_factory=list)
    random: int | Sequence[Any] | None = None
    initials: Mapping[str, str] = field(default_factory=dict)
    values: Mapping[str, str] = field(default_factory=dict)
    armed: bool = True
    recorded: str = ""
    start: str = ""

    def program(self, wanted: str | Program) -> Program:
        """Return a program, or that of a text, with the initial values of the run.

        Raises LRPSyntaxError: it is not a valid program.
        Raises UnknownElementError: it has no such variable.
        """
        if isinstance(wanted, str) and len(wanted) > _LONGEST_PROGRAM:
            raise FileError(f"Its program has more than {_LONGEST_PROGRAM:,} characters.")
        program = parse(wanted, self.filename) if isinstance(wanted, str) else wanted
        for variable, expression in self.initials.items():
            program = with_initialiser(program, variable, expression)
        return program

    def namespace(self) -> dict[str, Any]:
        """Return the recorded values of names."""
        return {name: ast.literal_eval(text) for name, text in self.values.items()}

    def make_bridge(self) -> Bridge:
        """Return a robot for a replay: simulated as before, or one that repeats the recorded readings."""
        if self.bridge == "none":
            return Bridge.registry["none"]()
        if self.world is not None:
            return make_bridge("sim", world=self.world)
        bridge = RecordedBridge(self.recorded_members())
        bridge.safety.armed = self.armed
        bridge.open()
        return bridge

    def recorded_members(self) -> list[RobotVariable | RobotMethod]:
        """Return stand-ins for the members of `robot`."""
        return [*recorded_members(self.members, unplain)]


@dataclass(frozen=True, slots=True)
class Recording:
    """A recorded session.

    `name`: the name of the file.
    `entries`: its ticks and inputs, in order; an input is numbered by its line.
    `followed`: the trace lines that followed from them.
    `cut`: whether the file ended in the middle of a line, or of its compressed data.
    `looks`: what a person looked at, if that was recorded, and the inputs, in order.
    `clock`: pairs of a time of the run and what the robot's clock showed, where that began, and after each
        pause and leap.
    `is_own`: whether this user recorded its programs and expressions, which :func:`reproduce
        <lrp_jupyter.live.reproduction.reproduce>` runs.
    """

    name: str
    start: RunStart
    entries: tuple[Entry, ...]
    followed: tuple[Line, ...]
    cut: bool = False
    is_own: bool = False
    looks: tuple[Look, ...] = ()
    clock: tuple[tuple[float, float], ...] = ()

    @property
    def ticks(self) -> int:
        """The number of its ticks, including those that were undone."""
        return sum(isinstance(entry, Ticked) for entry in self.entries)

    @property
    def reach(self) -> int:
        """The largest number of ticks by which it was rewound from its latest tick."""
        most = latest = 0
        for entry in self.entries:
            latest = max(latest, entry.tick)
            if isinstance(entry, Input) and isinstance(entry.what, do.Rewind):
                most = max(most, latest - entry.tick)
        return most

    @property
    def seconds(self) -> float:
        """The time of its last entry."""
        return max((entry.time for entry in self.entries), default=0.0)


def read_recording(path: str | os.PathLike[str]) -> Recording:
    """Read a recording without running any of it.

    Parameters
    ----------
    path : str or path

    Raises
    ------
    FileError
        It cannot be read, is not a recording, or contains an error; the message names the line.
    """
    name = shown(path)
    start: RunStart | None = None
    entries: list[Entry] = []
    followed: list[Line] = []
    looks: list[Look] = []
    clock: list[tuple[float, float]] = []
    complete, latest, memory, cut, code = 0, 0.0, 0, False, RecordedCode()
    for number, raw in enumerate(read_log(path), 1):
        if not raw.endswith(b"\n"):
            cut = True
            break
        try:
            memory += _memory_of(raw)
            if memory > _MOST:
                raise FileError(f"Up to here, this recording takes more than {_MOST / 1e9:g} GB of memory.")
            line = _line(raw)
            memory += _PARSED * code.add(line)
            if start is None:
                start = _start(line)
                continue
            tick, time = _moment(line)
            if start.world is not None and time > latest + _LONGEST_WAIT:
                raise FileError(f"`time` is {time:g}, and it is {latest:g} in the line before.")
            latest = time
            if "look" in line:
                looks.append(look_of(line, tick, time))
                continue
            if "input" in line:
                if "wall" in line and line["input"] not in _OF_THE_RUN:
                    looks.append(Look(tick, time, float(line["wall"]), "input", str(line["input"])))
                what = input_of(line, start.program)
                entries.append(Input(number, tick, time, what))
                if not isinstance(what, (CommandsHeld, MembersChanged)):  # they are written in their tick
                    complete = len(followed)
                continue
            if "clock" in line:
                clock.append((time, float(line.pop("clock"))))  # a replay has no robot
            check_line(line)
            followed.append(line)
            if "readings" in line:
                readings = {name: unplain(value) for name, value in line["readings"].items()}
                entries.append(Ticked(tick, time, readings))
                complete = len(followed)
        except Exception as error:  # raised by the parser, or by an input, for an invalid value
            raise at_line(name, number, _mistake(error)) from None
    if start is None:
        raise FileError(f"`{name}` is not a recording: it contains no complete line.")
    lines = tuple(followed[:complete])
    return Recording(name, start, tuple(entries), lines, cut, code.is_own(), tuple(looks), tuple(clock))


def recording_of(path: str | os.PathLike[str]) -> Recording:
    """Return a recording as `read_recording` does, and remember it as long as the file stays the same.

    For workers, which run a few recordings many times: those that are remembered take memory.
    """
    try:
        known = os.stat(path)
        return _recording_of(os.path.abspath(path), known.st_mtime_ns, known.st_size)
    except OSError:
        return read_recording(path)  # which says what is wrong


@lru_cache(maxsize=64)
def _recording_of(path: str, _changed: int, _size: int) -> Recording:
    return read_recording(path)


def _memory_of(raw: bytes) -> int:
    """Estimate from its content how many bytes a line takes in memory once it is read."""
    return 500 + len(raw) + 100 * raw.count(b":") + 50 * sum(map(raw.count, (b",", b"[", b"{")))


def _mistake(error: Exception) -> str:
    match error:
        case FileError():
            return str(error)
        case KeyError() if not isinstance(error, UnknownElementError):
            return f"The field `{error.args[0]}` is missing."
    return f"A field is wrong: {sentence_of(error)}"


def _line(raw: bytes) -> Line:
    try:
        line = json.loads(raw)
    except (ValueError, RecursionError):
        raise FileError(
            f"This line is not JSON, so the file is damaged or is not a recording. {_MAKE}"
        ) from None
    if not isinstance(line, dict):
        raise FileError("This line is not a JSON object.")
    return line


def _moment(line: Line) -> tuple[int, float]:
    tick, time = line["tick"], float(line["time"])
    if type(tick) is not int or tick < 0:
        raise FileError(f"`tick` is {short(tick)} instead of a number of ticks.")
    if not 0 <= time < _LATEST:
        raise FileError(f"`time` is {time:g} instead of seconds of a run.")
    return tick, time


def _start(line: Line) -> RunStart:
    found = line.get("lrplog")
    if found != VERSION:
        if found is None:
            raise FileError(f"This is not a recording. One begins with a line that has `lrplog`. {_MAKE}")
        raise FileError(
            f"This recording is of version {found!r}, and this release reads version {VERSION}: "
            "record the run again, or install the release that recorded it."
        )
    missing = [name for name in ("text", "filename", "bridge") if name not in line]
    if missing:
        listed = " and no ".join(f"`{name}`" for name in missing)
        raise FileError(f"This line has no {listed}, so the run cannot be repeated. Record it again.")
    known = {name: line[name] for name in RunStart.__dataclass_fields__ if name in line}
    for name, value in known.items():
        if not _STARTS[name](value):
            raise FileError(f"The field `{name}` is wrong: it is {short(value)}.")
    start = RunStart(**known)
    program = start.program(start.text)
    if start.start:
        alone(program, start.start)
    start.recorded_members()
    start.namespace()
    if start.world is not None:
        load(start.world)
    return start


def _are_texts(values: object) -> bool:
    return isinstance(values, list) and all(isinstance(value, str) for value in values)


def _is_state_of_random(value: object) -> bool:
    """Return whether a value is a state that `random.setstate` accepts, in its JSON form."""
    try:
        random_of(value)
    except (TypeError, ValueError):
        return False
    return True


def _is_date(text: str) -> bool:
    with suppress(ValueError):
        return bool(not text or datetime.fromisoformat(text))
    return False


def random_of(seed: object) -> random.Random:
    """Return the generator that a run began with, from its seed, or its state in JSON form."""
    generator = random.Random()
    if isinstance(seed, (list, tuple)):
        version, numbers, gauss = seed
        generator.setstate((version, tuple(numbers), gauss))
    elif seed is None or type(seed) is int:
        generator.seed(seed)
    else:
        raise TypeError("A seed is a whole number.")
    return generator


_STARTS: dict[str, Callable[[Any], bool]] = {
    "text": lambda value: isinstance(value, str),
    "filename": lambda value: isinstance(value, str),
    "bridge": lambda value: isinstance(value, str),
    "world": lambda value: value is None or isinstance(value, dict),
    "members": lambda value: isinstance(value, list) and all(isinstance(each, dict) for each in value),
    "rate": lambda value: type(value) in (int, float) and (value == 0 or SLOWEST <= value <= FASTEST),
    "on_active_edit": lambda value: value in ("restart", "keep"),
    "on_issue": lambda value: value in ("record", "pause"),
    "names": _are_texts,
    "random": _is_state_of_random,
    "armed": lambda value: isinstance(value, bool),
    "recorded": lambda value: isinstance(value, str) and _is_date(value),
    "start": lambda value: isinstance(value, str),
    "initials": lambda value: isinstance(value, dict) and _are_texts(list(value.values())),
    "values": lambda value: isinstance(value, dict) and _are_texts(list(value.values())),
}
"""Whether a field of the first line can have a value."""

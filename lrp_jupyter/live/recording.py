r"""Recordings: a session in a file, from which it is reproduced in another process.

A recording (``.lrplog``; compressed if its name ends with ``.gz``) is JSON Lines. The first line says where
the run began::

    {"lrplog":2,"text":"(var n := …","filename":"follower.lrp","bridge":"sim","world":{…},"rate":10,…}

Then come, as they happened, what came from outside, and what followed. Every line has ``tick`` and ``time``
(seconds). Inputs say how many ticks were completed before them::

    {"tick":12,"time":1.13,"input":"edit","text":"…"}
    {"tick":12,"time":1.13,"input":"place","pose":[0.5,1.0,0.0],"robot":0}

Every tick has its readings, and what followed are the lines of a trace (``trace.py``), each with ``event``::

    {"tick":13,"time":1.2,"event":"entered","state":"follower/looking"}
    {"tick":13,"time":1.2,"event":"commanded","command":"move","arguments":{…},"sent":true,
     "block":"looking.running","line":12}
    {"tick":13,"time":1.2,"readings":{"light.data":255}}

With a simulated robot, or none, the inputs reproduce the run bit for bit; what followed is compared, and the
first difference is told. The readings of a real robot are fed to the program again. What follows from a tick
or an input stands before it, so of a file that was cut off, what comes after its last whole tick or input is
left out.
"""

from __future__ import annotations

import ast
import gzip
import io
import json
import math
import os
import random
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from inspect import Parameter
from pathlib import Path as FilePath
from typing import Any, NamedTuple

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.bridges.message import Message, Plain
from lrp_jupyter.bridges.nodes import RobotMethod, RobotVariable
from lrp_jupyter.bridges.outside import RobotCommanded, RobotStopped, WorldLoaded
from lrp_jupyter.bridges.recorded import RecordedBridge, recorded_members
from lrp_jupyter.errors import (
    BridgeError,
    FileError,
    LRPError,
    NoDataYet,
    UnknownElementError,
    ended,
    sentence_of,
)
from lrp_jupyter.files import shown
from lrp_jupyter.interpreter.events import TraceEvent
from lrp_jupyter.interpreter.rendering import render, short
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element, Program
from lrp_jupyter.language.unmeant import Unmeant
from lrp_jupyter.live import commands as do
from lrp_jupyter.live.inputs import Input, Paused, Resumed, RunEnded
from lrp_jupyter.live.loop import FASTEST, SLOWEST, Loop
from lrp_jupyter.live.randomness import random_module
from lrp_jupyter.live.replay import Entry, Ticked
from lrp_jupyter.live.trace import Trace, as_dict, plain
from lrp_jupyter.sim.edits import Become, Draw, WorldEdit
from lrp_jupyter.sim.inputs import PlaceRobot, PlaceSolid, ResetWorld
from lrp_jupyter.sim.worlds import load

__all__ = ["FileLine", "Recorder", "Recording", "RunStart", "random_of", "read_recording", "start_of"]

VERSION = 2
_OLD = 1  # in it, commands were no events, and what is printed was not recorded
_GZIP = b"\x1f\x8b"
_LARGEST = 500_000_000  # bytes of the content of a compressed file
_PART = 1_000_000  # bytes that are decompressed at a time
_LATEST = 1e7  # s of a run
_LONGEST = 1.5 / SLOWEST  # s between two lines of a simulated run
_BEYOND = "beyond"  # in the place of a value that no file can hold

Line = dict[str, Any]

_FIELDS: dict[object, dict[str, type]] = {
    "entered": {"state": str},
    "left": {"state": str},
    "forced": {"state": str},
    "spawned": {"machine": str},
    "discarded": {"machine": str},
    "changed": {"variable": str},
    "restarted": {"reason": str},
    "fired": {"machine": str, "transition": str, "source": str, "destination": str},
    "issue": {"element": str, "line": int, "message": str},
    "commanded": {"command": str, "arguments": dict, "sent": bool, "block": str, "line": int},
    "printed": {"text": str},
}
"""The fields that the line of an event must have, beside `tick`, `time` and `event`, and their types."""


@dataclass(frozen=True, slots=True)
class RunStart:
    """Where a recorded session began.

    Parameters
    ----------
    text, filename : str
        The program.
    bridge : str
        The name of the bridge.
    world : mapping or None
        The simulated world in its JSON form, noise and seed included.
    members : sequence of mapping
        What `robot` offered, if it was not a simulated one.
    rate : float
    on_active_edit, on_issue : str
    names : list of str
        The names that the blocks use and that neither the program nor Python defines: a notebook's.
    random : int, sequence or None
        The seed of Python's own random numbers, if they were seeded for the recording; else their state.
    initials : mapping of str to str
        Other initial values than those of the text.
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

    def make_bridge(self) -> Bridge:
        """Return a robot for a replay: simulated as before, or made of recorded readings."""
        if self.bridge == "none":
            return Bridge.registry["none"]()
        if self.world is not None:
            return make_bridge("sim", world=self.world)
        bridge = RecordedBridge(self.bridge, self.recorded_members())
        bridge.open()
        return bridge

    def recorded_members(self) -> list[RobotVariable | RobotMethod]:
        """Return stand-ins for what `robot` offered."""
        return [*recorded_members(self.members, unplain)]


class Recorder(Trace):
    """Writes the recording of a session: its inputs, and its trace. It belongs to the thread that ticks.

    A recording that fails, because a disk is full or a value cannot be written, ends; the session goes on.

    Parameters
    ----------
    loop : Loop
        Before its first tick.
    write : callable
        Receives every line, with its newline.
    start : RunStart
    """

    def __init__(self, loop: Loop, write: Callable[[str], object], start: RunStart | None = None) -> None:
        super().__init__(write)
        self._loop = loop
        self._failure: Exception | None = None
        if start is not None:
            parts = {name: getattr(start, name) for name in RunStart.__dataclass_fields__}
            self.line({"lrplog": VERSION, **parts})
        loop.record = self._input
        loop.after_tick.append(self._tick)
        self._unobserve = loop.interpreter.observe(self)

    def end(self) -> None:
        """Write the time of the end, and nothing more.

        Raises
        ------
        FileError
            The recording failed before.
        """
        self._unobserve()
        loop = self._loop
        self._input(Input(0, loop.interpreter.tick, loop.now, RunEnded()))
        loop.record = None
        loop.after_tick.remove(self._tick)
        if self._failure is not None:
            raise FileError(f"The recording ended early: {sentence_of(self._failure)}")

    def __call__(self, event: TraceEvent) -> None:
        """Write one event."""
        self._keep(lambda: as_dict(event))

    def _input(self, entry: Input) -> None:
        self._keep(lambda: {"tick": entry.tick, "time": entry.time, **_encoded(entry.what, self._loop)})

    def _tick(self) -> None:
        self._keep(self._readings)

    def _readings(self) -> Line:
        time, _, sensed = self._loop.moments[-1]
        readings = {name: plain(value) for name, value in self._loop.bridge.readings_of(sensed).items()}
        return {"tick": self._loop.interpreter.tick, "time": time, "readings": readings}

    def _keep(self, made: Callable[[], Line]) -> None:
        if self._failure is not None:
            return
        try:
            self.line(made())
        except RecursionError:
            self._failure = LRPError("A value contains itself, or is nested too deeply for a file.")
        except Exception as error:
            self._failure = error


def start_of(
    loop: Loop, bridge: Bridge, seed: int | None = None, initials: Mapping[str, str] | None = None
) -> RunStart:
    """Return where a session begins that has not ticked yet."""
    interpreter = loop.interpreter
    world = bridge.world_form()
    members = [] if world is not None else [_member(node) for node in bridge.nodes.members()]
    return RunStart(
        interpreter.program.text,
        interpreter.program.filename,
        bridge.name,
        world,
        members,
        loop.rate,
        interpreter.on_active_edit,
        interpreter.on_issue,
        sorted(name for name in loop.names_used() if name in interpreter.namespace),
        random_module(interpreter.namespace).getstate() if seed is None else seed,
        dict(initials or {}),
    )


def _member(node: RobotVariable | RobotMethod) -> Line:
    if isinstance(node, RobotVariable):
        return {"name": node.path, "kind": "variable", "unit": node.unit, "doc": node.doc}
    return {
        "name": node.path,
        "kind": "method",
        "doc": node.doc,
        "command": node.command,
        "velocity": node.velocity,
        "message": None if node.message is None else _message(node.message),
        "limits": {name: list(limit) for name, limit in node.limits.items()},
        **({} if node.message else {"parameters": [_parameter(each) for each in node.parameters]}),
    }


def _message(kind: type[Message]) -> Line:
    fields = {
        name: {"type": part.type, "default": plain(part.default)}
        if isinstance(part, Plain)
        else _message(part)
        for name, part in kind.FIELDS.items()
    }
    return {"name": kind.__name__, "words": dict(kind.WORDS), "fields": fields}


def _parameter(parameter: Parameter) -> Line:
    default = {} if parameter.default is parameter.empty else {"default": plain(parameter.default)}
    return {"name": parameter.name, "kind": parameter.kind.name, **default}


# -- reading -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Recording:
    """A recorded session.

    Parameters
    ----------
    name : str
        Of the file.
    start : RunStart
    entries : tuple
        Its ticks and inputs, in order; the number of an input is that of its line.
    followed : tuple of dict
        What followed from them.
    cut : bool
        Whether the file ended in the middle of a line, or of its compressed data.
    has_printed : bool
        Whether what was printed is recorded.
    """

    name: str
    start: RunStart
    entries: tuple[Entry, ...]
    followed: tuple[Line, ...]
    cut: bool = False
    has_printed: bool = True

    @property
    def ticks(self) -> int:
        """The number of its ticks, those that were undone included."""
        return sum(isinstance(entry, Ticked) for entry in self.entries)

    @property
    def reach(self) -> int:
        """How many ticks back from its latest one it was rewound at most."""
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


class FileLine(NamedTuple):
    """A line of a recording.

    Parameters
    ----------
    name : str
        Of the file.
    line : int
    """

    name: str
    line: int

    def error(self, what: str) -> FileError:
        """Return an error that begins with the place."""
        return FileError(f"`{self.name}`, line {self.line}: {what}")


def read_recording(
    path: str | os.PathLike[str], prepared: Callable[[Program, Mapping[str, str]], Program] | None = None
) -> Recording:
    """Read a recording.

    Parameters
    ----------
    path : str or path
    prepared : callable, optional
        Returns a program with other initial values.

    Raises
    ------
    FileError
        It cannot be read, is no recording, or has a mistake; the message names the line.
    """
    name = shown(path)
    try:
        data = FilePath(path).read_bytes()
        data, is_whole = _gunzipped(data) if FilePath(path).suffix == ".gz" else (data, True)
    except OSError as error:
        raise FileError(f"`{name}` cannot be read: {ended(error.strerror or str(error))}") from None
    *whole, rest = data.split(b"\n")
    if not whole:
        raise FileError(f"`{name}` is not a recording: it contains no complete line.")
    start: RunStart | None = None
    entries: list[Entry] = []
    followed: list[Line] = []
    complete, latest = 0, 0.0
    for index, raw in enumerate(whole, 1):
        at = FileLine(name, index)
        try:
            line = json.loads(raw)
        except (ValueError, RecursionError):
            raise at.error("This line is not JSON, so the file is damaged or is not a recording.") from None
        if not isinstance(line, dict):
            raise at.error("This line is not a JSON object.")
        try:
            if start is None:
                start = _start(line, at, prepared)
                continue
            tick, time = _moment(line, at)
            if start.world is not None and time > latest + _LONGEST:
                raise at.error(f"`time` is {time:g}, and it is {latest:g} in the line before.")
            latest = time
            if "input" in line:
                entries.append(Input(index, tick, time, _decoded(line, start, at, prepared)))
                complete = len(followed)
                continue
            followed.append(_event(line, at))
            if "readings" in line:
                readings = {name: unplain(value) for name, value in line["readings"].items()}
                entries.append(Ticked(tick, time, readings))
                complete = len(followed)
        except FileError:
            raise
        except UnknownElementError as error:
            raise at.error(f"A field is wrong: {error}") from None
        except KeyError as error:
            raise at.error(f"The field `{error.args[0]}` is missing.") from None
        except Exception as error:  # whatever the parser, or an input that is made of it, says of a value
            raise at.error(f"A field is wrong: {sentence_of(error)}") from None
    assert start is not None
    has_printed = json.loads(whole[0])["lrplog"] != _OLD
    return Recording(
        name, start, tuple(entries), tuple(followed[:complete]), bool(rest) or not is_whole, has_printed
    )


def _moment(line: Line, at: FileLine) -> tuple[int, float]:
    """Return the tick and the time of a line."""
    tick, time = line["tick"], float(line["time"])
    if type(tick) is not int or tick < 0:
        raise at.error(f"`tick` is {short(tick)} instead of a number of ticks.")
    if not 0 <= time < _LATEST:
        raise at.error(f"`time` is {time:g} instead of seconds of a run.")
    return tick, time


def _event(line: Line, at: FileLine) -> Line:
    """Return what followed; every kind of it has its fields."""
    event = {**line, "event": "commanded"} if "command" in line else line  # as version 1 has it
    if not {"event", "readings"} & event.keys():
        raise at.error("This line has no `input`, `event` or `readings`.")
    for name, kind in _FIELDS.get(event.get("event"), {}).items():
        if not isinstance(event[name], kind):
            raise at.error(f"The field `{name}` is wrong: it is {short(event[name])}.")
    dict(unplain(event.get("arguments", {"dict": {}})))
    return event


def _gunzipped(data: bytes) -> tuple[bytes, bool]:
    """Return the content of a compressed file, or what is there of it, and whether that is all.

    Raises
    ------
    OSError
        It is not compressed, damaged, or too large.
    """
    content = bytearray()
    try:
        with gzip.open(io.BytesIO(data)) as stream:
            while part := stream.read1(_PART):
                content += part
                if len(content) > _LARGEST:
                    break
    except EOFError:
        return bytes(content), False
    except (OSError, zlib.error) as error:
        damaged = data.startswith(_GZIP)
        raise OSError(
            "its compressed data is damaged"
            if damaged
            else "its name ends with `.gz`, but it is not a gzip file"
        ) from error
    if len(content) > _LARGEST:
        raise OSError(f"It contains more than {_LARGEST / 1e6:,.0f} MB.")
    return bytes(content), True


def _start(
    line: Line, at: FileLine, prepared: Callable[[Program, Mapping[str, str]], Program] | None
) -> RunStart:
    if line.get("lrplog") not in (VERSION, _OLD):
        found = line.get("lrplog")
        if found is None:
            raise at.error("This is not a recording. One begins with a line that has `lrplog`.")
        raise at.error(
            f"This recording is of version {found!r}. This release reads versions {_OLD} and {VERSION}: "
            "install a newer lrp-jupyter."
        )
    missing = [name for name in ("text", "filename", "bridge") if name not in line]
    if missing:
        listed = " and no ".join(f"`{name}`" for name in missing)
        raise at.error(f"This line has no {listed}, so the run cannot be repeated. Record it again.")
    known = {name: line[name] for name in RunStart.__dataclass_fields__ if name in line}
    for name, value in known.items():
        if not _STARTS[name](value):
            raise at.error(f"The field `{name}` is wrong: it is {short(value)}.")
    start = RunStart(**known)
    _program(start.text, start, prepared)
    start.recorded_members()
    if start.world is not None:
        load(start.world)
    return start


def _program(
    text: str, start: RunStart, prepared: Callable[[Program, Mapping[str, str]], Program] | None
) -> Program:
    """Return a recorded program with the initial values of the run."""
    parsed = parse(text, start.filename)
    return prepared(parsed, start.initials) if prepared is not None and start.initials else parsed


def _are_texts(values: object) -> bool:
    return isinstance(values, list) and all(isinstance(value, str) for value in values)


def _is_state_of_random(value: object) -> bool:
    """Return whether a value is what `random.setstate` accepts, as JSON has it."""
    try:
        random_of(value)
    except (TypeError, ValueError):
        return False
    return True


def random_of(seed: object) -> random.Random:
    """Return the generator that a run began with: its seed, or its state, as JSON has it."""
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
    "rate": lambda value: isinstance(value, (int, float)) and (value == 0 or SLOWEST <= value <= FASTEST),
    "on_active_edit": lambda value: value in ("restart", "keep"),
    "on_issue": lambda value: value in ("record", "pause"),
    "names": _are_texts,
    "random": _is_state_of_random,
    "initials": lambda value: isinstance(value, dict) and _are_texts(list(value.values())),
}
"""Whether a value of a field of the first line is possible."""


# -- inputs as lines -----------------------------------------------------------------------------


def _encoded(what: object, loop: Loop) -> Line:
    match what:
        case Paused(reason):
            return {"input": "pause", "reason": reason}
        case Resumed():
            return {"input": "resume"}
        case RunEnded():
            return {"input": "rest"}
        case do.ReplaceProgram(program, unmeant):
            return {
                "input": "edit",
                "text": program.text,
                **({} if unmeant is None else {"unmeant": _unmeant(unmeant)}),
            }
        case do.Rename(kind, path, new_name):
            return {"input": "rename", "kind": kind, "path": path, "name": new_name}
        case do.Force(path, teleport):
            return {"input": "force", "path": path, "teleport": teleport}
        case do.SetVariable(path, expression):
            return {"input": "set", "path": path, "expression": expression}
        case do.Assign(path, value) if (literal := _literal(value)) is not None:
            return {"input": "assign", "path": path, "value": literal}
        case do.Rewind(ticks):
            return {"input": "rewind", "ticks": ticks}
        case do.Reset():
            return {"input": "reset"}
        case do.Renew(program):
            return {"input": "renew", "text": program.text}
        case do.SetRate(rate):
            return {"input": "rate", "rate": rate}
        case do.SetPolicy(name, value):
            return {"input": "policy", "name": name, "value": value}
        case RobotStopped():
            return {"input": "stop"}
        case RobotCommanded(name, arguments):
            return {"input": "command", "name": name, "arguments": plain(arguments)}
        case WorldLoaded(world):
            return {"input": "world", "world": world}
        case PlaceRobot(pose, robot):
            return {"input": "place", "pose": pose, "robot": robot}
        case PlaceSolid(pose, solid):
            return {"input": "place solid", "pose": pose, "solid": solid}
        case ResetWorld():
            return {"input": "reset world"}
        case Draw(path, width, grey):
            return {"input": "draw", "path": path, "width": width, "grey": grey}
        case WorldEdit():
            return {"input": "edit world", "world": loop.bridge.world_form()}
    return {"input": _BEYOND, "what": render(what)}


def _decoded(
    line: Line,
    start: RunStart,
    at: FileLine,
    prepared: Callable[[Program, Mapping[str, str]], Program] | None,
) -> object:
    def program(text: str) -> Program:
        return _program(text, start, prepared)

    match line["input"]:
        case "pause":
            return Paused(line["reason"])
        case "resume":
            return Resumed()
        case "rest":
            return RunEnded()
        case "edit":
            found = line.get("unmeant")
            unmeant = found and Unmeant(
                program(found["instead"]),
                found["reason"],
                found["always"],
                found["element"] and Element(found["element"][0], tuple(found["element"][1])),
            )
            return do.ReplaceProgram(program(line["text"]), unmeant)
        case "rename":
            return do.Rename(line["kind"], tuple(line["path"]), line["name"])
        case "force":
            return do.Force(tuple(line["path"]), line["teleport"])
        case "set":
            return do.SetVariable(tuple(line["path"]), line["expression"])
        case "assign":
            return do.Assign(tuple(line["path"]), ast.literal_eval(line["value"]))
        case "rewind":
            return do.Rewind(line["ticks"])
        case "reset":
            return do.Reset()
        case "renew":
            return do.Renew(program(line["text"]))
        case "rate":
            return do.SetRate(line["rate"])
        case "policy":
            return do.SetPolicy(line["name"], line["value"])
        case "stop":
            return RobotStopped()
        case "command":
            return RobotCommanded(line["name"], unplain(line["arguments"]))
        case "world":
            return WorldLoaded(line["world"])
        case "place":
            x, y, angle = line["pose"]
            return PlaceRobot((x, y, angle), line["robot"])
        case "place solid":
            x, y, angle = line["pose"]
            return PlaceSolid((x, y, angle), line["solid"])
        case "reset world":
            return ResetWorld()
        case "draw":
            return Draw(tuple((x, y) for x, y in line["path"]), line["width"], line["grey"])
        case "edit world":
            return Become(load(line["world"]))
        case "beyond":
            raise at.error("This input cannot be stored in a file, so the recording cannot be replayed.")
    raise at.error(f"There is no input {short(line['input'])}.")


def _unmeant(unmeant: Unmeant) -> Line:
    element = unmeant.element
    return {
        "instead": unmeant.instead.text,
        "reason": unmeant.reason,
        "always": unmeant.always,
        "element": None if element is None else [element.kind, element.path],
    }


class _Infinite(ast.NodeTransformer):
    """Turns the name `inf` into a number."""

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """See `ast.NodeTransformer`."""
        return ast.Constant(math.inf) if node.id == "inf" else node


def _literal(value: object) -> str | None:
    """Return a value as an expression of Python; None where that is not possible."""
    try:
        text = ast.unparse(_Infinite().visit(ast.parse(repr(value), mode="eval")))
        return text if ast.literal_eval(text) == value else None
    except Exception:  # `repr` and `==` may run code of anyone
        return None


# -- values as JSON ------------------------------------------------------------------------------


class Fields:
    """An object of a reading, with the fields that were recorded."""

    def __init__(self, fields: Mapping[str, Any]) -> None:
        vars(self).update(fields)

    def __repr__(self) -> str:
        return f"({', '.join(f'{name}={value!r}' for name, value in vars(self).items())})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Fields) and vars(self) == vars(other)

    def __hash__(self) -> int:
        return hash(tuple(vars(self)))


def unplain(value: Any) -> Any:
    """Return what :func:`plain` had made of a value; an object has only its fields."""
    if isinstance(value, list):
        return [unplain(part) for part in value]
    if not isinstance(value, dict):
        return value
    ((kind, content),) = value.items()
    match kind:
        case "float":
            return float(content)
        case "no data":
            return NoDataYet(content)
        case "error":
            return BridgeError(content)
        case "tuple":
            return tuple(unplain(part) for part in content)
        case "dict":
            return {key: unplain(part) for key, part in content.items()}
        case "fields":
            return Fields({name: unplain(part) for name, part in content.items()})
    return content

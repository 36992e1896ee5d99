"""The recorder of a session."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Mapping
from datetime import datetime
from inspect import Parameter
from time import monotonic
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.interventions import MembersChanged
from lrp_jupyter.bridges.member_tree import RobotMethod, RobotVariable
from lrp_jupyter.bridges.message import Message, Plain
from lrp_jupyter.bridges.tasks import RobotTask
from lrp_jupyter.errors import FileError, LRPError, sentence_of
from lrp_jupyter.interpreter.trace_events import TraceEvent
from lrp_jupyter.language.program import path_text
from lrp_jupyter.live.recording import VERSION, RunStart
from lrp_jupyter.live.running.checkpoints import COPIED
from lrp_jupyter.live.running.inputs import EndRun, Input
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.running.notebook_names import random_module
from lrp_jupyter.live.stored.input_lines import input_line, literal
from lrp_jupyter.live.stored.json_values import plain
from lrp_jupyter.live.stored.looked_at import Look
from lrp_jupyter.live.stored.recorded_code import RecordedCode
from lrp_jupyter.live.trace import Trace, as_dict

Line = dict[str, Any]

_LEAP = 0.01  # seconds by which the robot's clock must have leapt to be written again


class Recorder(Trace):
    """Writes the recording of a session: its inputs and its trace. It belongs to the thread that ticks.

    If the recording fails, because the disk is full or a value cannot be written, it ends; the session
    continues.

    `start`: without it, only lines are written, and nothing is registered as this user's own.
    `looking`: whether it also contains what a person looked at, and the wall time of that and of inputs.
    """

    def __init__(
        self,
        loop: Loop,
        write: Callable[[str], object],
        start: RunStart | None = None,
        looking: bool = False,
    ) -> None:
        super().__init__(write)
        self._begun = monotonic()
        self._looking = looking
        self._looks: deque[Look] = deque()
        self._loop = loop
        self._failure: Exception | None = None
        self._ahead = math.inf  # the seconds by which the robot's clock is ahead of the time of the run
        self._table = loop.bridge.nodes.table
        self._members = [] if start is None else start.members  # as they were written last
        self._code = None if start is None else RecordedCode()
        ticks, seconds = loop.interpreter.tick, loop.timing.now
        self._before = (ticks, seconds) if start is not None and ticks else (0, 0.0)  # what is not recorded
        if start is not None:
            parts = {name: getattr(start, name) for name in RunStart.__dataclass_fields__}
            self.line({"lrplog": VERSION, **parts})
        loop.record.written = self._input
        loop.after_tick.append(self._tick)
        self._unobserve = loop.interpreter.observe(self)

    def line(self, entry: Mapping[str, Any]) -> None:
        """Write a line; register its code as this user's own."""
        super().line(entry)
        if self._code is not None:
            self._code.note(entry)

    def end(self) -> None:
        """Write the time of the end, and stop writing; raise FileError if the recording failed earlier."""
        self._unobserve()
        self.write_looks()
        loop = self._loop
        self._input(Input(0, loop.interpreter.tick, loop.timing.now, EndRun()))
        loop.record.written = None
        loop.after_tick.remove(self._tick)
        if self._failure is not None:
            raise FileError(f"The recording ended early: {sentence_of(self._failure)}")

    def __call__(self, event: TraceEvent) -> None:
        """Write one event."""
        tick, now = self._since(event.tick, event.now)
        self._keep(lambda: as_dict(event._replace(tick=tick, now=now)))

    def _since(self, tick: int, time: float) -> tuple[int, float]:
        """Return a tick and a time of the run as they are counted in the recording."""
        ticks, seconds = self._before
        return tick - ticks, round(time - seconds, 12) if ticks else time

    @property
    def _wall(self) -> float:
        """The seconds since the recording began."""
        return round(monotonic() - self._begun, 3)

    def look(self, what: str, about: str, on: bool) -> None:
        """Store what a person looks at, to be written later. From any thread."""
        loop = self._loop
        when = self._since(loop.interpreter.tick, loop.timing.now)
        self._looks.append(Look(*when, self._wall, what, about, on))

    def write_looks(self) -> None:
        """Write the stored looks."""
        while self._looks:
            self._keep(self._looks.popleft().line)

    def _input(self, entry: Input) -> None:
        self._write_members(entry.tick, entry.time)
        wall = {"wall": self._wall} if self._looking else {}
        tick, time = self._since(entry.tick, entry.time)
        self._keep(lambda: {"tick": tick, "time": time, **wall, **input_line(entry.what, self._loop)})

    def _tick(self) -> None:
        self._write_members(self._loop.interpreter.tick - 1, self._loop.record.moments[-1].time)
        self._keep(self._readings)

    def _write_members(self, tick: int, time: float) -> None:
        """Write which members the robot has, if they are others than before."""
        table, bridge = self._loop.bridge.nodes.table, self._loop.bridge
        if self._code is None or table is self._table or bridge.simulated is not None:
            return
        self._table, before, self._members = table, self._members, described_members(bridge)
        if self._members != before:
            changed = MembersChanged(tuple(self._members))
            tick, time = self._since(tick, time)
            self._keep(lambda: {"tick": tick, "time": time, **input_line(changed, self._loop)})

    def _readings(self) -> Line:
        record, bridge = self._loop.record, self._loop.bridge
        known = record.readings
        if bridge.simulated is not None:  # what accompanies the readings follows from the world, too
            nodes = [node for node in bridge.nodes.members() if isinstance(node, RobotVariable)]
            known = {node.path: known[node.path] for node in nodes if node.path in known and not node.of}
        readings = {name: plain(value) for name, value in known.items()}
        now = record.moments[-1].time
        tick, time = self._since(self._loop.interpreter.tick, now)
        return {"tick": tick, "time": time, "readings": readings, **self._clock(now)}

    def _clock(self, time: float) -> Line:
        """Return what the robot's clock showed at a time of the run, if that does not follow from before."""
        now, shown = self._loop.timing.clock.now(), self._loop.bridge.world_time()
        if shown is None or abs(shown - now - self._ahead) < _LEAP:
            return {}
        self._ahead = shown - now
        return {"clock": round(time + self._ahead, 6)}

    def _keep(self, made: Callable[[], Line]) -> None:
        if self._failure is not None:
            return
        try:
            self.line(made())
        except RecursionError:
            self._failure = LRPError("A value contains itself, or is nested too deeply for a file.")
        except Exception as error:
            self._failure = error


def start_of(loop: Loop, seed: int | None = None, initials: Mapping[str, str] | None = None) -> RunStart:
    """Return the start of a session that has not ticked yet."""
    interpreter, bridge = loop.interpreter, loop.bridge
    world = None if bridge.simulated is None else bridge.simulated.world_form()
    members = [] if world is not None else described_members(bridge)
    namespace = interpreter.namespace
    names = sorted(name for name in loop.record.names_used() if name in namespace)
    values = {name: literal(namespace[name]) for name in names if type(namespace[name]) in COPIED}
    return RunStart(
        interpreter.program.text,
        interpreter.program.filename,
        bridge.name,
        world,
        members,
        loop.timing.rate,
        interpreter.on_active_edit,
        interpreter.on_issue,
        names,
        random_module(namespace).getstate() if seed is None else seed,
        dict(initials or {}),
        {name: text for name, text in values.items() if text is not None},
        bridge.safety.armed,
        datetime.now().astimezone().isoformat(timespec="milliseconds"),
        path_text(interpreter.start or ()),
    )


def described_members(bridge: Bridge) -> list[Line]:
    """Describe the members of a robot."""
    return [_member(node) for node in bridge.nodes.members()]


def _member(node: RobotVariable | RobotMethod) -> Line:
    if isinstance(node, RobotVariable):
        of = {"of": node.of} if node.of else {}
        return {"name": node.path, "kind": "variable", "unit": node.unit, "doc": node.doc, **of}
    return {
        "name": node.path,
        **(
            {"kind": "task", "moves": node.work.moves}
            if isinstance(node, RobotTask)
            else {"kind": "method", "command": node.command, "velocity": node.velocity}
        ),
        "doc": node.doc,
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
    described = {"name": kind.__name__, "words": dict(kind.WORDS), "fields": fields}
    return {**described, "optional": list(kind.OPTIONAL)} if kind.OPTIONAL else described


def _parameter(parameter: Parameter) -> Line:
    default = {} if parameter.default is parameter.empty else {"default": plain(parameter.default)}
    return {"name": parameter.name, "kind": parameter.kind.name, **default}

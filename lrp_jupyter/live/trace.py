r"""Traces: the events of a run as JSON Lines, one object per event; written, checked and described in words.

Every line has ``tick`` (the first is 1), ``time`` (seconds), ``event``, and the event's own fields::

    {"tick":1,"time":0.0,"event":"spawned","machine":"follower"}
    {"tick":1,"time":0.0,"event":"entered","state":"follower/moving"}
    {"tick":9,"time":0.8,"event":"left","state":"follower/moving"}
    {"tick":9,"time":0.8,"event":"discarded","machine":"follower/looking/lookalgo"}
    {"tick":9,"time":0.8,"event":"fired","machine":"follower","transition":"tlooking","source":"moving",
     "destination":"looking"}
    {"tick":9,"time":0.8,"event":"changed","variable":"follower/nobump","value":false}
    {"tick":9,"time":0.8,"event":"issue","code":"LRP601","element":"follower/moving","line":4,"message":"…"}
    {"tick":9,"time":0.8,"event":"patched","applied":true,"restarted":false,"reason":null}
    {"tick":9,"time":0.8,"event":"restarted","reason":"…"}
    {"tick":9,"time":0.8,"event":"forced","state":"follower/looking","how":"teleport"}

    {"tick":9,"time":0.8,"event":"commanded","command":"move","arguments":{…},"sent":true,
     "block":"looking.running","line":12}
    {"tick":9,"time":0.8,"event":"task","task":"drive_to","status":"aborted","reason":"no path"}
    {"tick":9,"time":0.8,"event":"printed","text":"found it\n"}

``started``, ``paused``, ``resumed`` and ``ended`` (its ``onend`` has run) concern the program as a whole. A
variable has changed if its value is another one, or is a list, dict, set, deque, bytearray or array that was
changed in place: of these the number of items and the first 200 values are compared, three levels deep. A
change inside any other object is not seen. A variable that has lost its value has no ``value``. An issue has
an ``instance``, the machine's path as spawned, if that can run in several places. Values without a JSON type
are written as text, without addresses, so equal runs have equal traces.

In a recording (``recording.py``), the same lines are the effects of its ticks and inputs.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping
from typing import Any, TextIO, cast

from lrp_jupyter.errors import FileError
from lrp_jupyter.interpreter.rendering import render, short
from lrp_jupyter.interpreter.trace_events import UNSET, TraceEvent
from lrp_jupyter.language.program import path_text
from lrp_jupyter.live.stored.json_values import plain, unplain
from lrp_jupyter.live.why.wording import call_text

__all__ = ["Trace", "as_dict"]

Line = Mapping[str, Any]

_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")
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
    "task": {"task": str, "status": str, "reason": str},
    "printed": {"text": str},
}
"""The fields that the line of an event must have besides `tick`, `time` and `event`, and their types."""


def as_dict(event: TraceEvent) -> dict[str, Any]:
    """Return an event as a dict for JSON."""
    return {"tick": event.tick, "time": round(event.now, 9), "event": event.kind, **_details(event)}


def _details(event: TraceEvent) -> dict[str, Any]:
    path, data = path_text(event.path), cast(Any, event.data)
    match event.kind:
        case "entered" | "left":
            return {"state": path}
        case "forced":
            return {"state": path, "how": data}
        case "spawned" | "discarded":
            return {"machine": path}
        case "changed":
            return {"variable": path} if data is UNSET else {"variable": path, "value": json_value(data)}
        case "restarted":
            return {"reason": data}
        case "fired":
            return {
                "machine": path_text(data.machine),
                "transition": data.label,
                "source": data.source,
                "destination": data.destination,
            }
        case "issue":
            return {
                "code": data.code,
                "element": path_text(data.element.shown),
                "line": data.line,
                "message": _steady(data.message),
                **({"instance": path_text(data.instances[-1])} if data.instances else {}),
            }
        case "commanded":
            return {
                "command": data.name,
                "arguments": plain(data.arguments),
                "sent": data.sent,
                "block": data.origin.block,
                "line": data.origin.line,
            }
        case "task":
            name, state = data
            return {"task": name, "status": state.status, "reason": state.reason}
        case "printed":
            return {"text": _steady(data)}
        case "patched":
            return {"applied": data.applied, "restarted": data.restarted, "reason": data.reason}
    return {}


def json_value(value: object) -> object:
    """Return a value that JSON has, else its text."""
    if value is None or type(value) in (bool, int):
        return value
    if type(value) is float:
        return value if math.isfinite(value) else repr(value)  # JSON has neither NaN nor infinity
    return value if type(value) is str and len(value) <= 200 else _steady(render(value))


def _steady(text: str) -> str:
    return _ADDRESS.sub("", text)


def check_line(line: Line) -> None:
    """Raise FileError if the line of an event, or of readings, is wrong; KeyError if it lacks a field."""
    if line.get("event") is None and "readings" not in line:
        raise FileError("This line has no `input`, `event` or `readings`.")
    for name, kind in _FIELDS.get(line.get("event"), {}).items():
        if not isinstance(line[name], kind):
            raise FileError(f"The field `{name}` is wrong: it is {short(line[name])}.")
    dict(unplain(line.get("arguments", {"dict": {}})))


def words_of(line: Line) -> str:
    """Describe the line of an event, or of readings, in words."""
    match line.get("event"):
        case "fired":
            return f"`{line['transition']}` fired, from `{line['source']}` to `{line['destination']}`"
        case "entered" | "left" | "forced":
            return f"`{line['state']}` was {line['event']}"
        case "spawned" | "discarded":
            return f"`{line['machine']}` was {line['event']}"
        case "changed":
            value = "lost its value" if "value" not in line else f"became {line['value']!r}"
            return f"`{line['variable']}` {value}"
        case "issue":
            name = line["element"].rpartition("/")[2]
            where = f" in `{line['instance']}`" if "instance" in line else ""
            return f"`{name}`{where} (line {line['line']}) had an issue: {line['message']}"
        case "ended":
            return "the run ended"
        case "restarted":
            return f"the program was restarted ({line['reason'].rstrip('.')})"
        case "printed":
            return f"{line['text']!r} was printed"
        case "commanded":
            call = call_text(line["command"], unplain(line["arguments"]))
            where = f" (line {line['line']})" if line.get("line") else ""
            sent = "" if line["sent"] else ", which was not sent"
            who = f"`{line['block']}`{where} called {call}" if line["block"] else f"{call} was called by hand"
            return f"{who}{sent}"
        case "task":
            why = f": {line['reason']}" if line["reason"] else ""
            return f"`robot.{line['task']}` was {line['status']}{why}"
        case None:
            parts = [f"`robot.{name}` was {unplain(value)!r}" for name, value in line["readings"].items()]
            return ", ".join(parts) or f"the tick was at {line['time']:g} s, with no other reading"
    return f"the program was {line['event']}"


class Trace:
    """An observer that writes a line per event.

    Parameters
    ----------
    write : callable or text file
        Receives every line, with its newline.
    """

    def __init__(self, write: Callable[[str], Any] | TextIO) -> None:
        self._write: Callable[[str], Any] = write if callable(write) else write.write

    def __call__(self, event: TraceEvent) -> None:
        """Write one event."""
        self.line(as_dict(event))

    def line(self, entry: Line) -> None:
        """Write a line, which need not be an event of the interpreter."""
        self._write(json.dumps(entry, ensure_ascii=False, separators=(",", ":")) + "\n")

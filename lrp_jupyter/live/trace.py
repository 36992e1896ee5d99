r"""Traces: what follows in a run as JSON Lines, one object per event.

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
    {"tick":9,"time":0.8,"event":"printed","text":"found it\n"}

``started``, ``paused`` and ``resumed`` concern the program as a whole. A variable that has lost
its value has no ``value``. Values without a JSON type are written as text, without addresses, so equal
runs have equal traces.

The same lines are the part of a recording that says what followed (``recording.py``).
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping
from typing import Any, TextIO

from lrp_jupyter.interpreter.events import UNSET, TraceEvent
from lrp_jupyter.interpreter.rendering import render
from lrp_jupyter.live.plain import plain

__all__ = ["Trace", "as_dict"]

_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


def as_dict(event: TraceEvent) -> dict[str, Any]:
    """Return an event as a dict for JSON."""
    kind, path, tick, now, data = event
    line: dict[str, Any] = {"tick": tick, "time": round(now, 9), "event": kind}
    text = "/".join(path)
    match kind:
        case "entered" | "left":
            line["state"] = text
        case "forced":
            line |= {"state": text, "how": data}
        case "spawned" | "discarded":
            line["machine"] = text
        case "changed":
            line["variable"] = text
            if data is not UNSET:
                line["value"] = _shown(data)
        case "restarted":
            line["reason"] = data
        case _:
            line |= _details(event)
    return line


def _details(event: TraceEvent) -> dict[str, Any]:
    data: Any = event.data
    match event.kind:
        case "fired":
            return {
                "machine": "/".join(event.path[:-1]),
                "transition": data.label,
                "source": data.source,
                "destination": data.destination,
            }
        case "issue":
            element = "/".join(data.element.shown)
            return {
                "code": data.code,
                "element": element,
                "line": data.line,
                "message": _steady(data.message),
            }
        case "commanded":
            _, block, row = data.origin
            arguments = plain(data.arguments)
            return {
                "command": data.name,
                "arguments": arguments,
                "sent": data.sent,
                "block": block,
                "line": row,
            }
        case "printed":
            return {"text": _steady(data)}
        case "patched":
            return {"applied": data.applied, "restarted": data.restarted, "reason": data.reason}
    return {}


def _shown(value: object) -> object:
    if value is None or type(value) in (bool, int):
        return value
    if type(value) is float:
        return value if math.isfinite(value) else repr(value)  # JSON has neither NaN nor infinity
    return value if type(value) is str and len(value) <= 200 else _steady(render(value))


def _steady(text: str) -> str:
    return _ADDRESS.sub("", text)


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

    def line(self, entry: Mapping[str, Any]) -> None:
        """Write a line; also one that is no event of the interpreter."""
        self._write(json.dumps(entry, ensure_ascii=False, separators=(",", ":")) + "\n")

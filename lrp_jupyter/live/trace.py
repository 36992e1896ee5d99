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

from lrp_jupyter.errors import NoDataYet
from lrp_jupyter.interpreter.events import UNSET, TraceEvent
from lrp_jupyter.interpreter.rendering import render

__all__ = ["Trace", "as_dict", "plain"]

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


def plain(value: object) -> Any:
    """Return a reading, or an argument of a command, as JSON.

    What has no type in JSON is an object with one name, that of its kind: ``{"tuple": [1, 2]}``; the parts of
    an object have their names.
    """
    if value is None or type(value) in (bool, int, str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else {"float": repr(value)}
    if isinstance(value, (int, str)):
        return value.real if isinstance(value, int) else str(value)
    if isinstance(value, NoDataYet):
        return {"no data": str(value)}
    if isinstance(value, Exception):
        return {"error": str(value)}
    if isinstance(value, Mapping):
        return {"dict": {str(key): plain(part) for key, part in value.items()}}
    parts = getattr(value, "_fields", None)
    if isinstance(value, (list, tuple)) and parts is None:
        items = [plain(part) for part in value]
        return items if isinstance(value, list) else {"tuple": items}
    if parts is None:
        slots = getattr(type(value), "__slots__", ())
        parts = [*((slots,) if isinstance(slots, str) else slots), *getattr(value, "__dict__", ())]
    public = [name for name in parts if not name.startswith("_") and hasattr(value, name)]
    if not public:
        return {"text": render(value)}
    return {"fields": {name: plain(getattr(value, name)) for name in public}}

"""ROS's log, `/rosout`: issues, notices, edits, beginning and end of a run."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from typing import Any, Literal, NamedTuple

from lrp_jupyter.bridges.ros.outlets import Announcer, Outlet
from lrp_jupyter.errors import ended

Level = Literal["info", "warning", "error", "fatal"]

_REPEAT = 10.0  # seconds for which a sentence is not logged again
_SENTENCES = 1000  # that are compared
_NUMBERS: Mapping[Level, tuple[int, int]] = {
    "info": (2, 20),
    "warning": (4, 30),
    "error": (8, 40),
    "fatal": (16, 50),
}
"""Of the levels in ROS 1 and in ROS 2."""
_OF_NOTICES: Mapping[str, Level] = {
    **dict.fromkeys(("armed", "disarmed", "guard"), "info"),
    **dict.fromkeys(("command watchdog", "tick watchdog", "fault"), "error"),
}
"""The levels of kinds of notices; the others are warnings."""


class LogRecord(NamedTuple):
    """A sentence for the log, at a line of the program if it has one."""

    level: Level
    text: str
    line: int = 0
    function: str = ""
    file: str = ""
    stamp: float = 0.0


class LogOutlet(Outlet):
    """What is worth it of what a bridge is told, as records."""

    keeps = 1000  # as for every node of ROS 2

    def __init__(self) -> None:
        super().__init__("/rosout")
        self._status = ""
        self._said: dict[str, float] = {}

    def type(self, version: int) -> str:
        """Return that of ROS 1 or ROS 2."""
        return "rosgraph_msgs/Log" if version == 1 else "rcl_interfaces/Log"

    def values(self, item: LogRecord, transport: Announcer) -> Mapping[str, Any]:
        """Return the fields of a record; in ROS 1, the header gets the time of sending."""
        numbers = _NUMBERS[item.level]
        place = {"file": item.file, "line": item.line, "function": item.function}
        fields = {"name": transport.log_name, "msg": item.text, **place}
        if transport.version == 1:
            return {"header": {}, **fields, "level": numbers[0]}
        seconds, rest = divmod(item.stamp, 1)
        return {**fields, "level": numbers[1], "stamp": {"sec": int(seconds), "nanosec": int(rest * 1e9)}}

    def tell(self, told: Mapping[str, Any]) -> None:
        """Log what a bridge is told, except for sentences that were logged a moment ago."""
        now, before = time.monotonic(), self._status
        self._status = told["status"]
        for record in (*_of_events(told), *_of_status(told, before)):
            last = self._said.get(record.text)
            if last is not None and now - last < _REPEAT:
                continue
            self._said = {text: then for text, then in self._said.items() if now - then < _REPEAT}
            if len(self._said) < _SENTENCES:
                self._said[record.text] = now
            self.put(record._replace(file=told["file"], stamp=told["stamp"]))


def _of_events(told: Mapping[str, Any]) -> Iterator[LogRecord]:
    name = f"`{told['program']}`"
    for event in told["events"]:
        match event:
            case {"event": "issue", "code": code, "message": message, "line": line, "element": element}:
                yield LogRecord("error", f"{code} {message}", line, event.get("instance", element))
            case {"event": "notice", "kind": kind, "message": message}:
                yield LogRecord(_OF_NOTICES.get(kind, "warning"), message)
            case {"event": "patched", "applied": False, "reason": reason}:
                yield LogRecord("warning", f"An edit of {name} is not applied yet: {reason}")
            case {"event": "patched", "restarted": False, "changes": str(changes)} if changes:
                yield LogRecord("info", f"An edit of {name} was applied while it runs: {ended(changes)}")
            case {"event": "restarted", "reason": reason}:
                yield LogRecord("warning", f"{name} was restarted: {ended(reason)}")
            case {"event": "started" | "resumed" as kind}:
                yield LogRecord("info", f"{name} has {kind}.")


def _of_status(told: Mapping[str, Any], before: str) -> Iterator[LogRecord]:
    """Yield what a new status says."""
    name, status, reason = f"`{told['program']}`", told["status"], told["reason"]
    if status == before:
        return
    if status == "paused":
        yield (
            LogRecord("warning", f"{name} is paused: {reason}")
            if reason
            else LogRecord("info", f"{name} is paused.")
        )
    elif status == "hung":
        yield LogRecord("error", reason)
    elif status == "broken":
        yield LogRecord("fatal", reason)
    elif status in ("stopped", "closed") and before != "stopped":
        yield LogRecord("info", f"{name} has ended.")

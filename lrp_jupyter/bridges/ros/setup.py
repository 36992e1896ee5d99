"""The set-up of a ROS robot, i.e. the connections of its variables, as a value and as JSON.

::

    {"version": 1,
     "subscriptions": {"odom": {"topic": "/odom", "type": "nav_msgs/Odometry", "stale_after": 0.5},
                       "light": {"topic": "/light"}},
     "publishers": {"move": {"topic": "/cmd_vel", "type": "geometry_msgs/Twist",
                             "limits": {"linear": 0.5, "angular": 1.0}},
                    "horn": {"topic": "/horn", "type": "std_msgs/Bool"},
                    "alive": {"topic": "/lrp/alive", "type": "std_msgs/Empty"}},
     "actions": {"drive_to": {"action": "/move_base", "type": "move_base_msgs/MoveBase"}},
     "services": {"spawn": {"service": "/spawn"}},
     "parameters": {"max_speed": {"parameter": "/max_speed"}},
     "stop": {"horn": {"data": false}},
     "tick": {"alive": {}}}

A type that is left out is taken from what is live, and a ``stale_after`` from the pace of the messages; null
is never. ``"velocity": true`` says of a publisher that a message of zeros stops the robot, where its type
does not tell. ``stop`` names what else is sent at a stop, and ``tick`` what is sent in every tick while the
robot is armed: a message, by its fields, through a publisher.

What can be checked without a robot is checked here, and the rest later.

Paper: §7.1 (figures 4 and 5: variable, topic, type).
"""

from __future__ import annotations

import json
import keyword
import math
import os
import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from lrp_jupyter.bridges.ros.definitions import KNOWN, canonical
from lrp_jupyter.bridges.ros.names import is_name
from lrp_jupyter.bridges.ros.transforms import TF_TOPICS, TRANSFORMS
from lrp_jupyter.errors import BridgeError, FileError, did_you_mean
from lrp_jupyter.files import write_file

DESCRIPTION = (__doc__ or "").partition("\n\nWhat can be checked")[0].replace("``", "`").replace("::\n\n", "")
"""What a set-up is, for a person."""

Direction = Literal["subscription", "publisher", "action", "service", "parameter"]
TASKS: tuple[Direction, ...] = ("action", "service")
MEASURED: Literal["measured"] = "measured"
"""A `stale_after` that follows from the pace of the messages."""

KINDS: Mapping[str, str] = {
    "subscription": "topic",
    "publisher": "topic",
    "parameter": "parameter",
    **{task: task for task in TASKS},
}

_TYPE = re.compile(r"[A-Za-z]\w*/[A-Za-z]\w*$", re.ASCII)
_SECTIONS: Mapping[str, Direction] = {
    "subscriptions": "subscription",
    "publishers": "publisher",
    "actions": "action",
    "services": "service",
    "parameters": "parameter",
}
_STOP = "stop"  # the member of every robot that no connection replaces
_WHEN = {"stop": "at_stop", "tick": "at_tick"}  # what a publisher sends by itself
_OWN = {
    "subscription": ("type", "stale_after"),
    "publisher": ("type", "limits", "velocity"),
    "action": ("type", "limits"),
    "service": ("type",),
}


@dataclass(frozen=True, slots=True)
class Wire:
    """A variable of the robot and the topic, action or service it is wired to."""

    variable: str  # the name after `robot.`
    direction: Direction
    topic: str  # or the name of the action or service, as it was written: see `names`
    type: str = ""  # `package/Type`; empty: that of the live one
    limits: Mapping[str, float | tuple[float, float]] = field(default_factory=dict)  # of what is sent
    stale_after: float | Literal["measured"] | None = MEASURED  # s; a message that is older is none
    velocity: bool | None = None  # whether a publisher's message of zeros stops the robot; None: by its type
    at_stop: Mapping[str, Any] | None = None  # the fields that a publisher sends at a stop; None: it does not
    at_tick: Mapping[str, Any] | None = None  # … and in every tick

    @property
    def kind(self) -> str:
        """What it is wired to: a ``topic``, an ``action``, a ``service`` or a ``parameter``."""
        return KINDS[self.direction]

    @property
    def is_read(self) -> bool:
        """Whether it is a reading, and nothing is sent."""
        return self.direction in ("subscription", "parameter")

    def __post_init__(self) -> None:
        if self.variable == _STOP:
            raise BridgeError("`robot.stop` stops the robot, whatever is connected. Use another name.")
        if not _is_name(self.variable):
            raise BridgeError(
                f"`{self.variable}` is not a valid name for a member of `robot`. Use one like `odom`."
            )
        topic = self.topic.strip()
        node, colon, inner = topic.partition(":")  # of a parameter of ROS 2, whose name may have any form
        if not (is_name(node) and (not colon or (inner.strip() and self.direction == "parameter"))):
            better = re.sub(r"/+", "/", re.sub(r"[^\w/]+", "/", topic, flags=re.ASCII)).rstrip("/")
            hint = f" Did you mean `{better}`?" if is_name(better) else ""
            raise BridgeError(
                f"`{topic}` is not a valid {self.kind} name. Use letters, digits and `_`, "
                f"with `/` between names.{hint}"
            )
        object.__setattr__(self, "topic", topic)
        is_tf = self.direction == "subscription" and topic.rpartition("/")[2] in TF_TOPICS
        type_ = self.type or (TRANSFORMS if is_tf else "")
        if type_ and self.direction == "parameter":
            raise BridgeError("A parameter has no type of messages. Leave the type out.")
        object.__setattr__(self, "type", check_type(type_, self.direction))
        if self.velocity is not None and type(self.velocity) is not bool:
            raise BridgeError(f"`velocity` must be true or false, not {self.velocity!r}.")
        seconds = self.stale_after
        if seconds not in (None, MEASURED) and not (
            type(seconds) in (int, float) and 0 < float(seconds) < math.inf
        ):
            raise BridgeError(f"`stale_after` must be a number of seconds above 0, not {seconds!r}.")

    def as_dict(self) -> dict[str, Any]:
        """Everything but variable and direction, as JSON."""
        wire: dict[str, Any] = {self.kind: self.topic}
        if self.type:
            wire["type"] = self.type
        if self.limits:
            wire["limits"] = dict(self.limits)
        if self.stale_after != MEASURED:
            wire["stale_after"] = self.stale_after
        if self.velocity is not None:
            wire["velocity"] = self.velocity
        return wire


def article(kind: str) -> str:
    """Return the article of the name of a kind."""
    return "an" if kind == "action" else "a"


def _is_name(variable: str) -> bool:
    parts = variable.split(".")
    return all(part.isidentifier() and not keyword.iskeyword(part) and part[0] != "_" for part in parts)


def name_for(topic: str, taken: Collection[str]) -> str:
    """Return a variable for a topic, action or service: as many of its last names as make a free one."""
    names = [name for name in (part.strip("_") for part in topic.split("/")) if name]
    tails = ["_".join(names[-count:]) for count in range(1, len(names) + 1)]
    free = (name for name in tails if _is_name(name) and name != _STOP and name not in taken)
    return next(free, f"{tails[-1]}_" if tails else "")


def check_type(type_: str, direction: Direction, also: Iterable[str] = ()) -> str:
    """Return the short form of a type's name, ``package/Type`` or empty."""
    name = canonical(type_)
    if name and not _TYPE.match(name):
        known = (*also, *(() if direction in TASKS else KNOWN))
        full = [each for each in known if each.rpartition("/")[2] == name.rpartition("/")[2]]
        hint = f" Did you mean `{full[0]}`?" if full else did_you_mean(name, known)
        kind = KINDS[direction] if direction in TASKS else "message"
        raise BridgeError(f"`{type_}` is not {article(kind)} {kind} type. Write `package/Type`.{hint}")
    return name


def setup_as_dict(wires: Iterable[Wire]) -> dict[str, Any]:
    """Return the JSON form of a set-up."""
    setup: dict[str, Any] = {"version": 1, "subscriptions": {}, "publishers": {}}
    sent: dict[str, Any] = {}
    for wire in wires:
        setup.setdefault(f"{wire.direction}s", {})[wire.variable] = wire.as_dict()
        for when, name in _WHEN.items():
            if (fields := getattr(wire, name)) is not None:
                sent.setdefault(when, {})[wire.variable] = dict(fields)
    return setup | sent


def setup_from_dict(setup: object, where: str = "The set-up") -> tuple[Wire, ...]:
    """Read a set-up; a BridgeError names the place of a mistake."""
    if not isinstance(setup, Mapping):
        raise BridgeError(f"{where} is not a set-up. Write an object with `subscriptions` and `publishers`.")
    if setup.get("version", 1) != 1:
        raise BridgeError(f"{where} has version {setup['version']!r}, but only version 1 can be read.")
    _no_others(setup, ("version", *_SECTIONS, *_WHEN), where)
    wires: dict[str, Wire] = {}
    for section, direction in _SECTIONS.items():
        entries = setup.get(section, {})
        if not isinstance(entries, Mapping):
            raise BridgeError(f"{where}: `{section}` must be an object of variables.")
        for variable, entry in entries.items():
            place = f"{where}, `{section}.{variable}`"
            if variable in wires:
                before = wires[variable].direction
                raise BridgeError(f"{place}: `{variable}` is already {article(before)} {before}.")
            wires[variable] = _wire_from(variable, direction, entry, place)
    publishers = [name for name, wire in wires.items() if wire.direction == "publisher"]
    for when, name in _WHEN.items():
        sent = setup.get(when, {})
        if not isinstance(sent, Mapping):
            raise BridgeError(f"{where}: `{when}` must be an object of publishers.")
        for variable, fields in sent.items():
            place = f"{where}, `{when}.{variable}`"
            if variable not in publishers:
                hint = did_you_mean(variable, publishers)
                raise BridgeError(f"{place}: There is no publisher `{variable}`.{hint}")
            if not isinstance(fields, Mapping):
                example = 'Write the fields of the message, like `{"data": 0}`, or `{}`.'
                raise BridgeError(f"{place}: {example}")
            change: dict[str, Any] = {name: dict(fields)}
            wires[variable] = replace(wires[variable], **change)
    return tuple(wires.values())


def _wire_from(variable: str, direction: Direction, entry: object, place: str) -> Wire:
    named = KINDS[direction]
    if isinstance(entry, str):
        entry = {named: entry}
    if not isinstance(entry, Mapping) or not isinstance(entry.get(named), str):
        raise BridgeError(f"{place}: {article(named).capitalize()} `{named}` is missing.")
    _no_others(entry, (named, *_OWN.get(direction, ())), place)
    type_, limits = entry.get("type", ""), entry.get("limits", {})
    stale_after, velocity = entry.get("stale_after", MEASURED), entry.get("velocity")
    if not isinstance(type_, str):
        raise BridgeError(f"{place}: The `type` must be a string.")
    try:
        return Wire(variable, direction, entry[named], type_, _limits_from(limits), stale_after, velocity)
    except BridgeError as error:
        raise BridgeError(f"{place}: {error}") from None


def _limits_from(limits: object) -> dict[str, float | tuple[float, float]]:
    if not isinstance(limits, Mapping):
        raise BridgeError('`limits` must be an object, like `{"linear": 0.5}`.')
    found: dict[str, float | tuple[float, float]] = {}
    for name, limit in limits.items():
        ends = limit if isinstance(limit, (list, tuple)) else (limit,)
        if len(ends) not in (1, 2) or not all(type(end) in (int, float) for end in ends):
            raise BridgeError(f"The limit of `{name}` must be a number, or two of them, not {limit!r}.")
        found[str(name)] = (ends[0], ends[1]) if len(ends) == 2 else ends[0]
    return found


def _no_others(mapping: Mapping[str, object], known: Iterable[str], place: str) -> None:
    for key in mapping:
        if key not in known:
            names = ", ".join(f"`{name}`" for name in known)
            raise BridgeError(f"{place}: There is no `{key}`, only {names}.{did_you_mean(str(key), known)}")


def load_setup(path: str | os.PathLike[str]) -> tuple[Wire, ...]:
    """Read a set-up from a file."""
    try:
        text = Path(path).read_text(encoding="utf-8")
        return setup_from_dict(json.loads(text), str(path))
    except OSError as error:
        raise BridgeError(f"The set-up {path} cannot be read: {error.strerror or error}.") from error
    except ValueError as error:
        raise BridgeError(f"The set-up {path} is not JSON: {error}.") from error


def save_setup(path: str | os.PathLike[str], wires: Iterable[Wire]) -> None:
    """Write a set-up to a file, atomically."""
    try:
        write_file(path, json.dumps(setup_as_dict(wires), indent=2) + "\n")
    except FileError as error:
        raise BridgeError(f"The set-up was not saved. {error}") from error

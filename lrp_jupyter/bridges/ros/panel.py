"""The panel of the ROS bridge: the connections, and what is live.

Paper: §7.1, figure 4 (the publishers and subscriptions, and the buttons to create them) and figure 5
(variable, topic and type of a new one; picking a topic fills in its type).
"""

from __future__ import annotations

import math
import re
import reprlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Literal

from lrp_jupyter.bridges.panel import STOP, Button, Field, Panel, Question, Table, number_in
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.goal_topics import topics_of
from lrp_jupyter.bridges.ros.link import SLOW
from lrp_jupyter.bridges.ros.setup import MEASURED, TASKS
from lrp_jupyter.bridges.ros.types import ReceivedMessage, RosMessage
from lrp_jupyter.errors import BridgeError

STALE_AFTER = "Too old after"
"""The label of the field for `stale_after` of a subscription."""

VELOCITY = "Velocity"
"""The label of the field for `velocity` of a publisher."""
_NAMED = "Topic, action, service or parameter"

_OF_EVERY_NODE = (
    *("/get_loggers", "/set_logger_level"),  # of ROS 1
    *("/describe_parameters", "/get_parameters", "/get_parameter_types", "/list_parameters"),
    *("/set_parameters", "/set_parameters_atomically", "/get_type_description"),
)
"""The ends of the names of services that are not shown, as those of rosapi and hidden ones are not."""

_MOST = 6  # fields of a message that are shown
_short = reprlib.Repr()
_short.maxother = _short.maxstring = 120
_NEVER = "never"
_VELOCITY = {"yes": True, "no": False}
_NUMBERS = ("std_msgs/Float64", "std_msgs/Float32")
_COMMAND = re.compile("cmd|command|vel|speed|throttle", re.IGNORECASE)
_COLUMNS = (
    *("variable", "direction", "topic", "type", "rate (Hz)", "age (s)"),
    *(f"{STALE_AFTER[0].lower()}{STALE_AFTER[1:]} (s)", "value"),
)


@dataclass(frozen=True, slots=True)
class Draft:
    """The contents of the fields for a new subscription or publisher."""

    variable: str = ""
    topic: str = ""
    type: str = ""
    velocity: str = ""


def draw_panel(
    *,
    status: str,
    backend: str,
    address: str,
    round_trip: float | None,
    setup: str,
    draft: Draft,
    channels: Iterable[Channel],
    live: Mapping[str, Mapping[str, str]],
) -> Panel:
    """Return the panel: the channels, the fields for a new one, and what is live with its type."""
    rows = {channel.wire.variable: _row(channel) for channel in channels}
    topics = live.get("topic", {})
    inner = {topic for action in live.get("action", {}) for topic in topics_of(action)}
    names = tuple(name for name in sorted(topics) if name not in inner)
    tasks = tuple(
        (name, kind, type_)
        for kind in TASKS
        for name, type_ in sorted(live.get(kind, {}).items())
        if not (name.endswith(_OF_EVERY_NODE) or name.startswith("/rosapi/") or "/_" in name)
    )
    called, pick = tuple(name for name, _, _ in tasks), (Button("pick", "Pick"),)
    found = Table("tasks", "Actions and services of the robot", ("name", "kind", "type"), called, tasks, pick)
    types = {*topics.values(), *(type_ for _, _, type_ in tasks if type_)}
    return Panel(
        "ROS",
        fields=(
            Field("status", "Status", value=status),
            Field("backend", "Connected by", value=backend),
            Field("address", "Address", value=address),
            *(() if round_trip is None else (_trip(round_trip),)),
            Field("variable", "Variable", "text", draft.variable),
            Field("topic", _NAMED, "text", draft.topic, (*names, *called), press="pick"),
            Field("type", "Type", "text", draft.type, tuple(sorted(types))),
            Field("stale_after", STALE_AFTER, "text", choices=(_NEVER,), unit="s"),
            Field("velocity", VELOCITY, "text", draft.velocity, tuple(_VELOCITY)),
            Field("setup", "Set-up file", "text", setup),
        ),
        tables=(
            Table(
                "connections",
                "Connections",
                _COLUMNS,
                tuple(rows),
                tuple(rows.values()),
                (Button("remove", "Remove"),),
            ),
            Table(
                "topics",
                "Topics of the robot",
                ("topic", "type"),
                names,
                tuple((name, topics[name]) for name in names),
                pick,
            ),
            *([found] if tasks else []),
        ),
        buttons=(
            STOP,
            Button("subscribe", "New subscription"),
            Button("publish", "New publisher"),
            Button("action", "New action"),
            Button("service", "New service"),
            Button("parameter", "New parameter"),
            Button("save", "Save set-up"),
        ),
        questions=(
            Question("host", "Address of the robot (`host` or `host:port`)", address),
            Question("setup", "File with a set-up", setup, "Load"),
        ),
    )


def _trip(seconds: float) -> Field:
    """Return the field that shows how long a question and its answer are under way."""
    note = " (slow)" if seconds > SLOW else ""
    return Field("round_trip", "Round trip", value=f"{1000 * seconds:.0f} ms{note}")


def _row(channel: Channel) -> tuple[str, ...]:
    wire, age, rate = channel.wire, channel.age(), channel.rate()
    shown = channel.problem or channel.waiting
    if not shown:
        message = channel.latest.value if channel.latest is not None else channel.last_sent
        nothing = "no data yet" if wire.is_read else "nothing sent yet"
        shown = (
            nothing
            if message is None
            else channel.requests[-1].outcome
            if channel.requests
            else gist(message)
            if isinstance(message, (ReceivedMessage, RosMessage))
            else _text(message)
        )
    if channel.commanders:
        shown += f" (also published by {', '.join(channel.commanders)})"
    return (
        wire.variable,
        wire.direction,
        wire.topic,
        channel.type,
        f"{rate:.1f}" if rate else "",
        "" if age is None else f"{age:.1f}",
        _limit(channel),
        shown,
    )


def _limit(channel: Channel) -> str:
    """Return when the messages of a subscription are too old; empty while that is not known."""
    if channel.wire.direction != "subscription":
        return ""
    limit, is_measured = channel.age_limit().seconds, channel.wire.stale_after == MEASURED
    if limit is None or limit == math.inf:
        return "" if is_measured else _NEVER
    return f"{limit:.1f} (measured)" if is_measured else f"{limit:g}"


def stale_after_in(text: str) -> float | Literal["measured"] | None:
    """Return what a person wrote into the field for `stale_after`."""
    if text == _NEVER:
        return None
    return number_in(text, STALE_AFTER) if text else MEASURED


def velocity_in(text: str) -> bool | None:
    """Return what a person wrote into the field for `velocity`."""
    if text and text not in _VELOCITY:
        raise BridgeError(f"`{VELOCITY}` is `yes`, `no`, or empty: by the type. It is not {text!r}.")
    return _VELOCITY.get(text)


def may_be_velocity(topic: str, type_: str) -> bool:
    """Return whether a number is a velocity by the name of its topic, as far as one can guess."""
    return type_ in _NUMBERS and _COMMAND.search(topic) is not None


def gist(message: ReceivedMessage | RosMessage) -> str:
    """Return a message in a line: the pose of an odometry, the one value of a simple message.

    Of others the fields that are not zero, without headers and covariances.
    """
    fields = message._as_dict() if isinstance(message, ReceivedMessage) else message.as_dict()
    short = [name for name in type(message).__slots__ if name not in fields]
    leaves = {name: getattr(message, name) for name in short} or dict(_leaves(fields))
    if len(leaves) == 1:
        return _text(*leaves.values())
    shown = leaves if short else {name: value for name, value in leaves.items() if value} or leaves
    return ", ".join(f"{name}={_text(value)}" for name, value in islice(shown.items(), _MOST))


def _leaves(fields: Mapping[str, object], path: str = "") -> Iterator[tuple[str, object]]:
    for name, value in fields.items():
        if isinstance(value, Mapping):
            if name != "header":
                yield from _leaves(value, f"{path}{name}.")
        elif name != "covariance":
            yield f"{path}{name}", value


def _text(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else _short.repr(value)

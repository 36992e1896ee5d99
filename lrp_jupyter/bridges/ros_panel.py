"""The panel of the ROS bridge: what is connected to what, and what else there is.

Paper: §7.1, figure 4 (the publishers and subscriptions, and the buttons to create them) and figure 5
(variable, topic and type of a new one; picking a topic fills in its type).
"""

from __future__ import annotations

import reprlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from lrp_jupyter.bridges.panel import STOP, Button, Field, Panel, Question, Table
from lrp_jupyter.bridges.ros_channel import Channel

__all__ = ["Draft", "draw"]

_COLUMNS = ("variable", "direction", "topic", "type", "rate (Hz)", "age (s)", "value")


@dataclass(frozen=True, slots=True)
class Draft:
    """What stands in the fields for a new subscription or publisher."""

    variable: str = ""
    topic: str = ""
    type: str = ""


def draw(
    *,
    sentence: str,
    backend: str,
    address: str,
    setup: str,
    draft: Draft,
    channels: Iterable[Channel],
    topics: Mapping[str, str],
) -> Panel:
    """Draw the panel as it is now; on any thread."""
    rows = {channel.wire.variable: _row(channel) for channel in channels}
    names = tuple(sorted(topics))
    return Panel(
        "ROS",
        fields=(
            Field("status", "Status", value=sentence),
            Field("backend", "Connected by", value=backend),
            Field("address", "Address", value=address),
            Field("variable", "Variable", "text", draft.variable),
            Field("topic", "Topic", "text", draft.topic, names),
            Field("type", "Type", "text", draft.type, tuple(sorted(set(topics.values())))),
            Field("setup", "Set-up file", "text", setup),
        ),
        tables=(
            Table(
                "connections",
                "Publishers and subscriptions",
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
                (Button("pick", "Pick"),),
            ),
        ),
        buttons=(
            STOP,
            Button("subscribe", "New subscription"),
            Button("publish", "New publisher"),
            Button("save", "Save set-up"),
        ),
        questions=(
            Question("host", "Address of the robot (`host` or `host:port`)", address),
            Question("setup", "File with the set-up", setup),
        ),
    )


def _row(channel: Channel) -> tuple[str, ...]:
    wire, age, rate = channel.wire, channel.age(), channel.rate()
    shown = channel.problem or channel.waiting
    if not shown:
        message = channel.latest.value if channel.latest is not None else channel.last_sent
        shown = _short.repr(message) if message is not None else "no data yet"
    return (
        wire.variable,
        wire.direction,
        wire.topic,
        channel.type,
        f"{rate:.1f}" if rate else "",
        "" if age is None else f"{age:.1f}",
        shown,
    )


_short = reprlib.Repr()
_short.maxother = 120

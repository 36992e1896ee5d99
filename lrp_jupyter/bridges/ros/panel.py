"""The panel of the ROS bridge: what is connected to what, and what else there is.

Paper: §7.1, figure 4 (the publishers and subscriptions, and the buttons to create them) and figure 5
(variable, topic and type of a new one; picking a topic fills in its type).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lrp_jupyter.bridges.panel import STOP, Button, Field, Panel, Question, Table
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.gist import gist
from lrp_jupyter.bridges.ros.setup import Direction, Wire, check_type
from lrp_jupyter.errors import BridgeError

if TYPE_CHECKING:
    from lrp_jupyter.bridges.ros.bridge import RosBridge

__all__ = ["Console"]

_COLUMNS = ("variable", "direction", "topic", "type", "rate (Hz)", "age (s)", "value")


@dataclass(frozen=True, slots=True)
class _Draft:
    """What stands in the fields for a new subscription or publisher."""

    variable: str = ""
    topic: str = ""
    type: str = ""


class Console:
    """The panel of a bridge, and what its buttons do.

    Owner: any thread may draw; whoever presses does it between two ticks.
    """

    def __init__(self, bridge: RosBridge) -> None:
        self._bridge = bridge
        self._draft = _Draft()

    def draw(self) -> Panel:
        """Draw the panel as it is now."""
        bridge, draft, topics = self._bridge, self._draft, self._bridge.topics
        rows = {channel.wire.variable: _row(channel) for channel in bridge.wiring.channels}
        names = tuple(sorted(topics))
        return Panel(
            "ROS",
            fields=(
                Field("status", "Status", value=bridge.status.sentence),
                Field("backend", "Connected by", value=bridge.backend),
                Field("address", "Address", value=bridge.address),
                Field("variable", "Variable", "text", draft.variable),
                Field("topic", "Topic", "text", draft.topic, names, press="pick"),
                Field("type", "Type", "text", draft.type, tuple(sorted(set(topics.values())))),
                Field("setup", "Set-up file", "text", bridge.wiring.path),
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
                Question("host", "Address of the robot (`host` or `host:port`)", bridge.address),
                Question("setup", "File with a set-up", bridge.wiring.path, "Load"),
            ),
        )

    def press(self, key: str, row: str, values: Mapping[str, str]) -> bool:
        """Do what a button says, without waiting; give whether it is one of these.

        Raises
        ------
        BridgeError
            What stands in the fields cannot be, or there is no such row.
        """
        bridge = self._bridge
        variable, topic = values.get("variable", "").strip(), values.get("topic", "")
        if key in ("subscribe", "publish"):
            type_ = check_type(values.get("type", ""), bridge.topics.values())
            direction: Direction = "subscription" if key == "subscribe" else "publisher"
            bridge.connect(Wire(variable, direction, topic, type_), wait=False)
            self._draft = _Draft()
        elif key == "pick":
            self._draft = _Draft(variable or row.rpartition("/")[2], row, bridge.topics.get(row, ""))
        elif key == "remove":
            bridge.remove(row)
        elif key == "save":
            path = values.get("setup", "").strip() or bridge.wiring.path
            if not path:
                raise BridgeError("Name the file in which the set-up shall be kept.")
            bridge.save(path)
        else:
            return False
        return True


def _row(channel: Channel) -> tuple[str, ...]:
    wire, age, rate = channel.wire, channel.age(), channel.rate()
    shown = channel.problem or channel.waiting
    if not shown:
        message = channel.latest.value if channel.latest is not None else channel.last_sent
        nothing = "no data yet" if wire.direction == "subscription" else "nothing sent yet"
        shown = nothing if message is None else gist(message)
    return (
        wire.variable,
        wire.direction,
        wire.topic,
        channel.type,
        f"{rate:.1f}" if rate else "",
        "" if age is None else f"{age:.1f}",
        shown,
    )

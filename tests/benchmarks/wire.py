"""What goes over the websocket of a kernel: the messages of the lab among it."""

import json
from collections import Counter
from collections.abc import Callable
from typing import Any


class Wire:
    """Counts the messages from and to a page, Jupyter's own included, and adds up the counts of firings."""

    def __init__(self, page: Any) -> None:
        self.sent: Counter[str] = Counter()
        self.received: Counter[str] = Counter()
        self.size = 0
        self.fired: dict[str, list[int]] = {}
        page.on("websocket", self._listen)

    def _listen(self, socket: Any) -> None:
        socket.on("framesent", self._give)
        socket.on("framereceived", self._take)

    def _give(self, payload: str | bytes) -> None:
        if isinstance(payload, bytes):
            self.sent[kind_of(*parts_of(payload))] += 1

    def _take(self, payload: str | bytes) -> None:
        if isinstance(payload, str):  # not of a kernel
            return
        self.size += len(payload)
        header, message = parts_of(payload)
        self.received[kind_of(header, message)] += 1
        frame = message.get("frame") if message.get("type") == "snapshot" else message
        if isinstance(frame, dict) and frame.get("type") == "frame":
            self.fired.update(frame.get("fired", {}))

    def measure(self, act: Callable[[], object]) -> tuple[Counter[str], Counter[str], int]:
        """Messages to the kernel and to the page, and the latter's bytes, while something is done."""
        sent, received, size = self.sent.copy(), self.received.copy(), self.size
        act()
        return self.sent - sent, self.received - received, self.size - size


def parts_of(payload: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    """Header of a message of Jupyter, and the message of the lab in it, if any.

    In protocol ``v1.kernel.websocket.jupyter.org`` a message is a table of offsets (8 bytes each, their
    number first) and channel, header, parent, metadata, content, buffers one after the other.
    """
    number = int.from_bytes(payload[:8], "little")
    offsets = [int.from_bytes(payload[8 * (i + 1) : 8 * (i + 2)], "little") for i in range(number)]
    header: dict[str, Any] = json.loads(payload[offsets[1] : offsets[2]])
    if header["msg_type"] != "comm_msg":
        return header, {}
    content = json.loads(payload[offsets[4] : offsets[5]])
    packed = content.get("data", {}).get("content") or {}
    return header, json.loads(packed["json"]) if "json" in packed else {}


def kind_of(header: dict[str, Any], message: dict[str, Any]) -> str:
    """Type of a message of the lab, else of Jupyter's."""
    return message.get("type") or header["msg_type"]

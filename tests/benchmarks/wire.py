"""What goes over the websocket of a kernel: the messages of the lab among it."""

import json
from collections.abc import Callable
from typing import Any


class Wire:
    """Counts the messages from and to a page, Jupyter's own included, and adds up the counts of firings."""

    def __init__(self, page: Any) -> None:
        self.sent = self.count = self.size = self.largest = 0
        self.fired: dict[str, list[int]] = {}
        page.on("websocket", self._listen)

    def _listen(self, socket: Any) -> None:
        socket.on("framesent", self._give)
        socket.on("framereceived", self._take)

    def _give(self, payload: str | bytes) -> None:
        self.sent += isinstance(payload, bytes)

    def _take(self, payload: str | bytes) -> None:
        if isinstance(payload, str):  # not of a kernel
            return
        self.count += 1
        self.size += len(payload)
        self.largest = max(self.largest, len(payload))
        content = content_of(payload)
        if content is None:
            return
        packed = content.get("data", {}).get("content") or {}
        message = json.loads(packed["json"]) if "json" in packed else {}
        frame = message.get("frame") if message.get("type") == "snapshot" else message
        if isinstance(frame, dict) and frame.get("type") == "frame":
            self.fired.update(frame.get("fired", {}))

    def measure(self, act: Callable[[], object]) -> tuple[int, int, int, int]:
        """Messages to the kernel and to the page, the latter's bytes and largest, while something is done."""
        sent, count, size, self.largest = self.sent, self.count, self.size, 0
        act()
        return self.sent - sent, self.count - count, self.size - size, self.largest


def content_of(payload: bytes) -> dict[str, Any] | None:
    """Content of a `comm_msg`; None for anything else.

    In protocol ``v1.kernel.websocket.jupyter.org`` a message is a table of offsets (8 bytes each, their
    number first) and channel, header, parent, metadata, content, buffers one after the other.
    """
    if b"comm_msg" not in payload:
        return None
    number = int.from_bytes(payload[:8], "little")
    offsets = [int.from_bytes(payload[8 * (i + 1) : 8 * (i + 2)], "little") for i in range(number)]
    if json.loads(payload[offsets[1] : offsets[2]])["msg_type"] != "comm_msg":
        return None
    content: dict[str, Any] = json.loads(payload[offsets[4] : offsets[5]])
    return content

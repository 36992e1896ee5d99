"""How a bridge stands to its robot: one of a few words, and a sentence for the person."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

__all__ = ["Connection", "Status"]


class Connection(StrEnum):
    """How a bridge stands to its robot."""

    DISCONNECTED = "disconnected"
    CONNECTING = "connecting"
    CONNECTED = "connected"
    WAITING = "waiting for data"
    STALE = "stale"
    LOST = "lost"


@dataclass(frozen=True, slots=True)
class Status:
    """The state of the connection, and a sentence for the person."""

    state: Connection
    sentence: str

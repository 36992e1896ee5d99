"""What the robot is asked for: a goal of an action, or a call of a service."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, Protocol
from uuid import uuid4

from lrp_jupyter.bridges.tasks import TaskStatus
from lrp_jupyter.errors import ended

_ENDS = ("succeeded", "aborted", "rejected", "cancelled")
"""After one of these, the robot is no longer busy with it; one that is lost may still be under way."""

_WORDS = re.compile(r"responded with an error: b?['\"](?:service cannot process request: )?(.*)['\"]")


def own_words(why: str) -> str:
    """Return the sentence of a node that has failed to serve, without what ROS says around it."""
    found = _WORDS.search(why)
    return ended(found[1] if found else why)


class Listener(Protocol):
    """Who has asked: told of every news, on any thread; None as feedback or result says nothing of it."""

    def __call__(
        self, status: TaskStatus, feedback: Any = None, result: Any = None, reason: str = ""
    ) -> None:
        """Note what is said."""


class RosRequest:
    """One goal or call, from the moment in which it is asked for until the robot has said how it ended.

    Owner: any thread may `tell`; the first end counts, and what comes after it is not passed on.

    `listener`: told of the news, with messages as they arrived.
    `is_wanted`: returns False as soon as it is to be cancelled.
    """

    def __init__(self, listener: Listener, is_wanted: Callable[[], bool]) -> None:
        self.id = f"lrp-{uuid4().hex}"
        self.status: TaskStatus = "active"
        self.is_wanted = is_wanted
        self._listener = listener

    @property
    def is_over(self) -> bool:
        """Whether the robot has said that it has ended."""
        return self.status in _ENDS

    def tell(self, status: TaskStatus, feedback: Any = None, result: Any = None, reason: str = "") -> None:
        """Note and pass on what the robot says."""
        if self.is_over or (self.status == "lost" and status == "active"):
            return
        self.status = status
        self._listener(status, feedback, result, reason)

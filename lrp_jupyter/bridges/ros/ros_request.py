"""What the robot is asked for, a goal of an action or a call of a service; and who asks for it."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import Any
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


class RosRequest:
    """One goal or call, from the moment in which it is asked for until the robot has said how it ended.

    Owner: any thread may `tell`; the first end counts, and what comes after it is not passed on.

    `listener`: called with status, feedback, result and reason at each news, with messages as they arrived;
        None as one of them says nothing of it.
    `is_wanted`: returns False as soon as it is to be cancelled.
    """

    def __init__(
        self, listener: Callable[[TaskStatus, Any, Any, str], object], is_wanted: Callable[[], bool]
    ) -> None:
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


class TaskClient(ABC):
    """The client's side of one action or service, as long as it is joined.

    `ask` is called on a thread of its own; `cancel` on any, and it must not block; the others on the link's.
    """

    @abstractmethod
    def ask(self, values: Mapping[str, Any], request: RosRequest) -> None:
        """Send a goal or a call, and have the request told how it goes; BridgeError: it cannot be sent."""

    @abstractmethod
    def hint(self) -> str:
        """Return that nothing serves it, in a sentence, or an empty text."""

    def cancel(self, request: RosRequest | None) -> None:  # noqa: B027  (a call cannot be cancelled)
        """Cancel a goal, or (None) all goals, of whatever client; urgent as a stop."""

    def look(self) -> None:  # noqa: B027  (where what was lost is told)
        """Find what was lost; called again and again."""

    def leave(self) -> None:  # noqa: B027  (where nothing was joined)
        """End what was joined; idempotent."""

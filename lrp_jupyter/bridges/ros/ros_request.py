"""What the robot is asked for, a goal of an action or a call of a service; and who asks for it."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from ast import literal_eval
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any
from uuid import uuid4

from lrp_jupyter.bridges.tasks import Task, TaskStatus
from lrp_jupyter.errors import ended

_ENDS = ("succeeded", "aborted", "rejected", "cancelled")
"""After one of these, the robot is no longer busy with it; one that is lost may still be under way."""

_QUOTED = re.compile(r"responded with an error: (b?(['\"]).*\2)", re.DOTALL)
_AROUND = re.compile(r"(?:error processing request|service cannot process request): ")


def own_words(why: str) -> str:
    """Return the sentence of a node that has failed to serve, without what ROS says around it.

    rospy and rosbridge write it as Python writes bytes, in which a letter that is not ASCII is its code.
    """
    if (found := _QUOTED.search(why)) is not None:
        with suppress(ValueError, SyntaxError):  # it only looks like that
            said = literal_eval(found[1])
            why = said.decode(errors="replace") if isinstance(said, bytes) else said
    return ended(_AROUND.sub("", why, count=1))


def sentence(hint: str) -> str:
    """Return a hint, which follows the name of a variable elsewhere, as a sentence of its own; or nothing."""
    return ended(hint[0].upper() + hint[1:]) if hint else ""


class RosRequest:
    """One goal or call, from the moment in which it is asked for until the robot has said how it ended.

    Owner: any thread may `tell`; the first end counts, and what comes after it is not passed on.

    `task`: who has asked, and is told; None: nothing is.
    `is_call`: whether it is made, whoever waits for it.
    `decode`: makes feedback, and a result, of messages as they arrived; None stays None. ValueError: they are
        of another type.
    """

    def __init__(
        self,
        task: Task | None = None,
        is_call: bool = True,
        decode: Callable[[Any, Any], tuple[Any, Any]] = lambda *raw: raw,
    ) -> None:
        self.id = f"lrp-{uuid4().hex}"
        self.status: TaskStatus = "active"
        self.outcome = "active"  # with the reason, for a person
        self.task, self._is_call, self._decode = task, is_call, decode

    def is_wanted(self) -> bool:
        """Return whether it is not to be cancelled."""
        return self._is_call or (self.task is not None and self.task.is_wanted)

    @property
    def is_over(self) -> bool:
        """Whether the robot has said that it has ended."""
        return self.status in _ENDS

    def tell(self, status: TaskStatus, feedback: Any = None, result: Any = None, reason: str = "") -> None:
        """Note and pass on what the robot says."""
        if self.is_over or (self.status == "lost" and status == "active"):
            return
        is_news, self.status = self.status == "active", status
        try:
            feedback, result = self._decode(feedback, result)
        except ValueError as error:
            feedback, result, reason = None, None, str(error)
        if is_news:  # one that was lost stays lost for who asked, whatever is heard later
            self.outcome = f"{status}: {reason}" if reason else status
        if self.task is not None:
            self.task.update(status, feedback, result, reason)


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

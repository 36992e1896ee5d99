"""Topics on which the bridge itself publishes: what happens in the run, for others to follow and to record.

They are not members of the robot, and what goes over them is not a command: it needs no arming and has no
limits, and no stop ends it. Publishing never waits. Without a connection, the newest items wait for one.
"""

from __future__ import annotations

import json
import threading
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Mapping
from typing import Any, Protocol

from lrp_jupyter.errors import BridgeError, ended, sentence_of

_WAITING = 100  # items, for a connection


class Announcer(Protocol):
    """What an outlet needs of a transport: see `lrp_jupyter.bridges.ros.link.Transport`."""

    @property
    def version(self) -> int:
        """Of ROS: 1 or 2; 0 while it is not known."""

    @property
    def log_name(self) -> str:
        """The name of the node, for the log."""

    def announce(self, topic: str, type_: str, keeps: int) -> object:
        """Advertise a topic that keeps its last messages for those who come later."""

    def send(self, handle: object, values: Mapping[str, Any], urgent: bool) -> None:
        """Publish, without waiting."""

    def leave(self, handle: object) -> None:
        """End an advertisement."""


class Outlet(ABC):
    """A topic on which the bridge publishes.

    `keeps`: how many of the last messages a subscriber gets that comes later, where the back end can do that.
    `resumes`: whether the last message is published again over a new connection.
    """

    keeps = 1
    resumes = False

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self._problem = self._told = ""  # what has gone wrong and was not said yet, and what was said last
        self._handle: object = None
        self._transport: Announcer | None = None
        self._is_up = False
        self._last: Any = None
        self._waiting: deque[Any] = deque(maxlen=_WAITING)
        self._lock = threading.Lock()

    @abstractmethod
    def type(self, version: int) -> str:
        """Return the type of the messages in a version of ROS."""

    @abstractmethod
    def values(self, item: Any, transport: Announcer) -> Mapping[str, Any]:
        """Return the fields of a message."""

    def put(self, item: Any) -> None:
        """Publish, without waiting; on any thread."""
        self._waiting.append(item)
        self._send()

    def join(self, transport: Announcer) -> None:
        """Advertise the topic, unless that was done, and publish what waits; on the link's thread."""
        if self._handle is not None or not transport.version:
            return
        try:
            handle = transport.announce(self.topic, self.type(transport.version), self.keeps)
        except Exception as error:  # also of a library: the robot is not lost by it
            self._fail(f"`{self.topic}` cannot be published: {_why(error)}")
            return
        with self._lock:
            self._handle, self._transport, self._is_up = handle, transport, True
            if self.resumes and self._last is not None and not self._waiting:
                self._waiting.append(self._last)
        self._send()

    def wait(self) -> None:
        """Keep what is to be published until there is a connection again."""
        with self._lock:
            self._is_up = False

    def leave(self) -> None:
        """End the advertisement."""
        with self._lock:
            handle, transport, self._is_up = self._handle, self._transport, False
            self._handle = self._transport = None
        if handle is not None and transport is not None:
            transport.leave(handle)

    def complaint(self) -> str:
        """Return what has gone wrong since the last call, a sentence, or an empty text."""
        problem, self._problem = self._problem, ""
        self._told = problem or self._told
        return problem

    def _fail(self, problem: str) -> None:
        if problem != self._told:
            self._problem = problem

    def _send(self) -> None:
        """Publish what waits; if another thread does that just now, it also publishes what came meanwhile."""
        while self._waiting and self._is_up and self._lock.acquire(blocking=False):
            try:
                self._send_one()
            finally:
                self._lock.release()

    def _send_one(self) -> None:
        transport = self._transport
        if transport is None or not self._waiting:
            return
        item = self._last = self._waiting.popleft()
        try:
            transport.send(self._handle, self.values(item, transport), False)
            self._told = ""
        except Exception as error:  # also of a library: the run goes on
            self._fail(f"`{self.topic}` was not published: {_why(error)}")


def _why(error: Exception) -> str:
    return ended(str(error)) if isinstance(error, BridgeError) else sentence_of(error)


class StateOutlet(Outlet):
    """A ``std_msgs/String`` with what a bridge is told, as JSON; its last message has the whole state."""

    resumes = True

    def type(self, version: int) -> str:
        """Return that of a text."""
        return "std_msgs/String"

    def values(self, item: Any, transport: Announcer) -> Mapping[str, Any]:
        """Return the item as JSON."""
        return {"data": json.dumps(item, ensure_ascii=False)}

"""Actions and services by rclpy: clients of the node, whose answers come on its executor's thread."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from typing import Any

from lrp_jupyter.bridges.ros.ros_request import RosRequest, TaskClient, sentence
from lrp_jupyter.bridges.tasks import TaskStatus
from lrp_jupyter.errors import ended, sentence_of

_SERVER = 2.0  # seconds to find a server
_STATUS: Mapping[int, TaskStatus] = {4: "succeeded", 5: "cancelled", 6: "aborted"}

Fill = Callable[[Any, Mapping[str, Any]], None]


class _RclpyClient(TaskClient):
    """A client of rclpy, by what differs between an action and a service.

    `message`: makes what is sent, with nothing set.
    `find`: waits for a server, and `is_found` does not; they return whether there is one.
    """

    def __init__(
        self,
        what: str,
        message: Callable[[], Any],
        fill: Fill,
        find: Callable[..., bool],
        is_found: Callable[[], bool],
    ) -> None:
        self._what, self._message, self._fill = what, message, fill
        self._find, self._is_found = find, is_found
        self._open: dict[RosRequest, Any] = {}  # what is not over; with its goal, once that is accepted

    def ask(self, values: Mapping[str, Any], request: RosRequest) -> None:
        """Ask a server, if there is one soon."""
        message = self._message()
        self._fill(message, values)
        if not self._find(timeout_sec=_SERVER):
            request.tell("lost", reason=sentence(self._missing))
        elif request.is_wanted():
            self._open[request] = None
            self._send(message, request)

    @abstractmethod
    def _send(self, message: Any, request: RosRequest) -> None:
        """Send what is asked for."""

    def hint(self) -> str:
        """Return that no node offers it, in a sentence, or an empty text."""
        return "" if self._is_found() else self._missing

    @property
    def _missing(self) -> str:
        return f"no node offers the {self._what}"

    def look(self) -> None:
        """Find what was asked of a server that is gone; cancel what goes on though lost, or not wanted."""
        missing = self.hint() if self._open else ""
        for request in tuple(self._open):
            if missing:
                request.tell("lost", reason=sentence(missing))
            elif request.status == "lost" or not request.is_wanted():
                self.cancel(request)

    def _end(self, request: RosRequest, status: TaskStatus, result: Any = None, reason: str = "") -> None:
        self._open.pop(request, None)
        request.tell(status, None, result, reason)


class RclpyAction(_RclpyClient):
    """The client of an action of the class `kind`; `cancelling` is that of the service that cancels."""

    def __init__(self, node: Any, name: str, kind: Any, fill: Fill, cancelling: Any) -> None:
        client = import_module("rclpy.action").ActionClient(node, kind, name)
        super().__init__(f"action `{name}`", kind.Goal, fill, client.wait_for_server, client.server_is_ready)
        self._node, self._client, self._cancelling = node, client, cancelling
        self._canceller = node.create_client(cancelling, f"{name}/_action/cancel_goal")

    def _send(self, message: Any, request: RosRequest) -> None:
        sent = self._client.send_goal_async(message, feedback_callback=partial(self._hear, request))
        sent.add_done_callback(partial(self._decided, request))

    def _hear(self, request: RosRequest, message: Any) -> None:
        request.tell("active", feedback=message.feedback)

    def _decided(self, request: RosRequest, future: Any) -> None:
        try:
            goal = future.result()
        except Exception as error:  # of the middleware
            self._end(request, "lost", reason=ended(sentence_of(error)))
            return
        if not goal.accepted:
            self._end(request, "rejected", reason=f"The server of the {self._what} has rejected the goal.")
            return
        self._open[request] = goal
        goal.get_result_async().add_done_callback(partial(self._ended, request))
        if not request.is_wanted():
            goal.cancel_goal_async()

    def _ended(self, request: RosRequest, future: Any) -> None:
        try:
            answer = future.result()
        except Exception as error:
            self._end(request, "lost", reason=ended(sentence_of(error)))
            return
        self._end(request, _STATUS.get(answer.status, "aborted"), answer.result)

    def cancel(self, request: RosRequest | None) -> None:
        """Cancel a goal, now or when it is accepted, or all of the action."""
        if request is None:  # a request in which nothing is set
            self._canceller.call_async(self._cancelling.Request())
        elif (goal := self._open.get(request)) is not None:
            goal.cancel_goal_async()

    def leave(self) -> None:
        """Destroy the clients."""
        node, self._node = self._node, None
        if node is not None:
            self._client.destroy()
            node.destroy_client(self._canceller)


class RclpyService(_RclpyClient):
    """The client of a service, of the class `kind`."""

    def __init__(self, node: Any, name: str, kind: Any, fill: Fill) -> None:
        self._node, self._client = node, (client := node.create_client(kind, name))
        find, is_found = client.wait_for_service, client.service_is_ready
        super().__init__(f"service `{name}`", kind.Request, fill, find, is_found)

    def _send(self, message: Any, request: RosRequest) -> None:
        self._client.call_async(message).add_done_callback(partial(self._answered, request))

    def _answered(self, request: RosRequest, future: Any) -> None:
        try:
            self._end(request, "succeeded", future.result())
        except Exception as error:
            self._end(request, "aborted", reason=ended(sentence_of(error)))

    def leave(self) -> None:
        """Destroy the client."""
        node, self._node = self._node, None
        if node is not None:
            node.destroy_client(self._client)

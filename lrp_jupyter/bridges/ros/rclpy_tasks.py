"""Actions and services by rclpy: clients of the node, whose answers come on its executor's thread."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from lrp_jupyter.bridges.ros.ros_request import RosRequest
from lrp_jupyter.bridges.tasks import TaskStatus
from lrp_jupyter.errors import ended, sentence_of

_SERVER = 2.0  # seconds to find a server
_STATUS: Mapping[int, TaskStatus] = {4: "succeeded", 5: "cancelled", 6: "aborted"}

Fill = Callable[[Any, Mapping[str, Any]], None]


class RclpyAction:
    """The client of an action, of the class `kind`; `canceller` calls the service that cancels goals."""

    def __init__(self, name: str, kind: Any, client: Any, canceller: Any, fill: Fill) -> None:
        self._name, self._kind, self.client, self.canceller, self._fill = name, kind, client, canceller, fill
        self._goals: dict[RosRequest, Any] = {}  # those that are not over; None until it is accepted

    def ask(self, values: Mapping[str, Any], request: RosRequest) -> None:
        """Send a goal to a server, if there is one soon."""
        goal = self._kind.Goal()
        self._fill(goal, values)
        if not self.client.wait_for_server(timeout_sec=_SERVER):
            request.tell("lost", reason=f"{self.hint().capitalize()}.")
        elif request.is_wanted():
            self._goals[request] = None
            sent = self.client.send_goal_async(goal, feedback_callback=partial(self._hear, request))
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
            self._end(request, "rejected", reason=f"The server of `{self._name}` has rejected the goal.")
            return
        self._goals[request] = goal
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

    def _end(self, request: RosRequest, status: TaskStatus, result: Any = None, reason: str = "") -> None:
        self._goals.pop(request, None)
        request.tell(status, result=result, reason=reason)

    def cancel(self, request: RosRequest | None) -> None:
        """Cancel a goal, now or when it is accepted, or all of the action."""
        if request is None:  # a request in which nothing is set
            self.canceller.call_async(self.canceller.srv_type.Request())
            return
        goal = self._goals.get(request)
        if goal is not None:
            goal.cancel_goal_async()

    def look(self) -> None:
        """Find goals whose server is gone."""
        if self._goals and (missing := self.hint()):
            for request in tuple(self._goals):
                request.tell("lost", reason=f"{missing.capitalize()}.")

    def hint(self) -> str:
        """Return that there is no server, in a sentence, or an empty text."""
        return "" if self.client.server_is_ready() else f"no server of the action `{self._name}` is there"


class RclpyService:
    """The client of a service, of the class `kind`."""

    def __init__(self, name: str, kind: Any, client: Any, fill: Fill) -> None:
        self._name, self._kind, self.client, self._fill = name, kind, client, fill
        self._calls: set[RosRequest] = set()

    def ask(self, values: Mapping[str, Any], request: RosRequest) -> None:
        """Call it, if it is there soon."""
        message = self._kind.Request()
        self._fill(message, values)
        if not self.client.wait_for_service(timeout_sec=_SERVER):
            request.tell("lost", reason=f"{self.hint().capitalize()}.")
            return
        self._calls.add(request)
        self.client.call_async(message).add_done_callback(partial(self._answered, request))

    def _answered(self, request: RosRequest, future: Any) -> None:
        self._calls.discard(request)
        try:
            request.tell("succeeded", result=future.result())
        except Exception as error:
            request.tell("aborted", reason=ended(sentence_of(error)))

    def look(self) -> None:
        """Find calls whose server is gone."""
        if self._calls and (missing := self.hint()):
            for request in tuple(self._calls):
                request.tell("lost", reason=f"{missing.capitalize()}.")

    def hint(self) -> str:
        """Return that no node offers it, in a sentence, or an empty text."""
        return "" if self.client.service_is_ready() else f"no node offers the service `{self._name}`"

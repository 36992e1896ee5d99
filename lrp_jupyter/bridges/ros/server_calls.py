"""What a rosbridge server does for a client and answers once: a call of a service, or a goal of ROS 2.

On ROS 2, unless it is started otherwise, rosbridge serves the next message of a connection only when it has
answered the last one: a service that hangs would hold up every command after it, and a goal even its own
cancel. So each of them gets a websocket of its own. A cancel goes over another one: the server finds the goal
by its id, on whatever connection it came.

A goal that is cancelled before the action's server has accepted it goes on (rosbridge before 2.3): the cancel
is repeated until there is a result. Of a goal that the action's server rejects, servers of 2025 and before do
not tell: it stays active until it is cancelled.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from lrp_jupyter.bridges.ros.ros_request import RosRequest, TaskClient, own_words
from lrp_jupyter.bridges.ros.setup import Direction
from lrp_jupyter.bridges.ros.websocket import Bell, Socket
from lrp_jupyter.bridges.tasks import TaskStatus
from lrp_jupyter.errors import BridgeError, ended, sentence_of

_LOOK = 0.5  # seconds between two looks at a goal

_STATUS: Mapping[object, TaskStatus] = {4: "succeeded", 5: "cancelled", 6: "aborted"}  # of ROS 2

_GONE = ("does not exist", "ROSServiceIOException", "unable to connect", "unavailable", "transport error")
"""What is in rosbridge's sentence when a node that serves is not there, or has died."""


class ServerTask(TaskClient):
    """A service, or an action of ROS 2: nothing is joined before it is asked for.

    `missing`: returns that nothing serves it, in a sentence, or an empty text.
    `socket`: returns the connection to the server, for something urgent or not; BridgeError: there is none.
    """

    def __init__(
        self,
        url: str,
        direction: Direction,
        name: str,
        type_: str,
        missing: Callable[[], str],
        socket: Callable[[bool], Socket],
    ) -> None:
        self._url, self._direction, self._name, self._type = url, direction, name, type_
        self._missing, self._socket = missing, socket

    def hint(self) -> str:
        """Return that nothing serves it, as far as that is known, in a sentence."""
        return self._missing()

    def ask(self, values: Mapping[str, Any], request: RosRequest) -> None:
        """Send a goal or a call; to a server that hangs, neither."""
        socket = self._socket(False)
        if missing := self.hint():
            request.tell("lost", reason=missing)
        elif self._direction == "service":
            socket.run(self._ask(socket, request, op="call_service", service=self._name, args=values))
        else:
            spelled = self._type.replace("/", "/action/", 1)
            goal = {"action": self._name, "action_type": spelled, "feedback": True, "args": values}
            socket.run(self._ask(socket, request, op="send_action_goal", **goal))

    def cancel(self, request: RosRequest | None) -> None:
        """Cancel a goal, or all of the action."""
        socket = self._socket(True)
        if request is not None:
            cancel = {"op": "cancel_action_goal", "id": request.id, "action": self._name}
            socket.put(json.dumps(cancel))
            return
        nothing = {"goal_id": {"uuid": [0] * 16}, "stamp": {"sec": 0, "nanosec": 0}}
        service = f"{self._name}/_action/cancel_goal"
        call = {"op": "call_service", "service": service, "args": {"goal_info": nothing}}
        socket.run(self._ask(socket, RosRequest(), **call))

    # -- in the event loop of the connection ------------------------------------------------------

    async def _ask(self, through: Socket, request: RosRequest, **question: object) -> None:
        """Ask on a websocket of its own, and pass on what comes back, until the answer."""
        answered, reason, lost = Bell(), "", f"The connection to `{self._url}` is lost."
        socket = Socket(self._url, partial(_receive, request, answered), changed=lambda: None)
        try:
            connection = await socket.connect()
            if request.is_wanted():
                socket.put(json.dumps({**question, "id": request.id}))
                looks = [self._look(request)] if question["op"] == "send_action_goal" else []
                await socket.serve(connection, answered.wait(), *looks)
            else:
                await connection.close()
        except BridgeError as error:
            reason = str(error)
        except Exception as error:
            reason = f"{lost} {ended(sentence_of(error))}"
        finally:  # also where it is cancelled, because the connection that it came through has ended
            if not request.is_over:
                request.tell("lost", reason=reason or f"{lost} {socket.ended or through.ended}".rstrip())

    async def _look(self, request: RosRequest) -> None:
        """Repeat a cancel, and find a goal whose server is gone."""
        while True:
            await asyncio.sleep(_LOOK)
            if missing := self.hint():
                request.tell("lost", reason=missing)
            if not request.is_wanted() or request.status == "lost":
                self.cancel(request)


def _receive(request: RosRequest, answered: Bell, message: Mapping[str, Any]) -> None:
    operation = message.get("op")
    if operation == "status" and message.get("level") == "error":
        request.tell("aborted", reason=ended(str(message.get("msg"))))
    elif message.get("id") != request.id:
        return
    elif operation == "action_feedback":
        request.tell("active", feedback=message.get("values"))
        return
    elif operation in ("service_response", "action_result"):
        _tell(request, message)
    answered.ring()


def _tell(request: RosRequest, message: Mapping[str, Any]) -> None:
    """Pass on an answer."""
    values, is_action = message.get("values"), message.get("op") == "action_result"
    if message.get("result") is False:
        why = own_words(str(values or "It gives no reason."))
        status: TaskStatus = "lost" if any(sign in why for sign in _GONE) else "aborted"
        status = "rejected" if "rejected" in why else status
        request.tell(status, reason=why)
        return
    number = message.get("status") if is_action else 4
    if number is None and isinstance(values, Mapping):  # rosbridge before 2.1
        number, values = values.get("status"), values.get("result")
    unnamed: TaskStatus = "aborted" if request.is_wanted() else "cancelled"
    request.tell(_STATUS.get(number, unnamed), result=values)

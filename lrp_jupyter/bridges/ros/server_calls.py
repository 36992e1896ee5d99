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
import threading
from collections.abc import Mapping
from typing import Any

from lrp_jupyter.bridges.ros.ros_request import RosRequest, own_words
from lrp_jupyter.bridges.ros.websocket import Bell, Socket
from lrp_jupyter.bridges.tasks import TaskStatus
from lrp_jupyter.errors import BridgeError, ended, sentence_of

_STATUS: Mapping[object, TaskStatus] = {4: "succeeded", 5: "cancelled", 6: "aborted"}  # of ROS 2

_GONE = ("does not exist", "ROSServiceIOException", "unable to connect", "unavailable", "transport error")
"""What is in rosbridge's sentence when a node that serves is not there, or has died."""


class ServerCall:
    """One question to the server, and what comes back, on a websocket and a thread of its own."""

    def __init__(self, url: str, question: Mapping[str, Any], request: RosRequest | None = None) -> None:
        self.question, self.request = question, request
        self._url, self._done = url, Bell()
        self._text = json.dumps(question)
        self._thread = threading.Thread(target=self._run, name="rosbridge call", daemon=True)
        self._thread.start()

    @property
    def is_over(self) -> bool:
        """Whether the answer is there, or will not come."""
        return not self._thread.is_alive()

    def end(self) -> None:
        """Wait no more for the answer."""
        self._done.ring()

    def has_ended(self, within: float) -> bool:
        """Wait some seconds for its thread to end; return whether it has."""
        if self._thread is not threading.current_thread():
            self._thread.join(within)
        return self.is_over

    def _run(self) -> None:
        why = "the connection ended."
        try:
            why = asyncio.run(self._live()) or why
        except BridgeError as error:
            why = str(error)
        except Exception as error:
            why = sentence_of(error)
        if self.request is not None and not self.request.is_over:
            self.request.tell("lost", reason=f"`{self._url}` has not answered: {ended(why)}")

    async def _live(self) -> str:
        socket = Socket(self._url, self._receive, lambda: None)
        connection = await socket.connect()
        if self.request is None or self.request.is_wanted():
            socket.put(self._text)
            await socket.serve(connection, self._done.wait())
        else:
            await connection.close()
        return socket.ended

    def _receive(self, message: Mapping[str, Any]) -> None:
        operation, request = message.get("op"), self.request
        if operation == "status" and message.get("level") == "error" and request is not None:
            request.tell("aborted", reason=ended(str(message.get("msg"))))
        elif message.get("id") != self.question["id"]:
            return
        elif operation == "action_feedback" and request is not None:
            request.tell("active", feedback=message.get("values"))
            return
        elif operation in ("service_response", "action_result") and request is not None:
            self._tell(request, message)
        self._done.ring()

    def _tell(self, request: RosRequest, message: Mapping[str, Any]) -> None:
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

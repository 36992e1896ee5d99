"""An action of ROS 1: actionlib's protocol, the client's side, over whatever has topics.

An action is five topics below its name. The client publishes ``goal`` and ``cancel``; the server publishes a
``status`` of all goals that it knows, several times a second, and ``feedback`` and ``result``. Goals are told
apart by an id, which is made here; of other clients' goals nothing is passed on.

Topics keep no promises, so what matters is sent until the server's status shows that it has arrived: a goal
for a moment (a server takes the same id only once), a cancel for as long as the server has the goal. And a
server whose status ceases, or which no longer knows a goal of ours, is dead, hangs, or was started again:
then the goal is lost, and is cancelled in case that it is not.
"""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from itertools import pairwise
from statistics import median
from typing import Any

from lrp_jupyter.bridges.ros.link import Transport
from lrp_jupyter.bridges.ros.ros_request import RosRequest, TaskClient
from lrp_jupyter.bridges.ros.setup import Direction
from lrp_jupyter.bridges.tasks import TaskStatus
from lrp_jupyter.errors import BridgeError, ended

_TOPICS = ("goal", "cancel", "status", "feedback", "result")
_STATUS: Mapping[int, TaskStatus] = {
    2: "cancelled",
    3: "succeeded",
    4: "aborted",
    5: "rejected",
    8: "cancelled",
    9: "lost",
}
_GOES_ON = (0, 1)  # the numbers of a goal that waits, or is pursued
_CANCELS = (2, 6, 7, 8)  # the numbers of a goal that is being cancelled, or was

_AGAIN = 0.5  # seconds after which a goal that the server's status does not show is sent again …
_TRIES = 6  # … so often
_RESULT = 1.0  # seconds that a result may come after the status that says that there is one
_SILENT = 3.0  # seconds without a status after which a server is dead or hangs …
_PERIODS = 8  # … or as many of its usual periods, if these are more
_FORGOTTEN = 60.0  # seconds for which a goal that the server does not know is remembered


def actions_in(topics: Mapping[str, str]) -> dict[str, str]:
    """Return the actions, with their types, among the topics with theirs."""
    found = {}
    for topic, type_ in topics.items():
        name, _, last = topic.rpartition("/")
        if last == "goal" and type_.endswith("ActionGoal") and f"{name}/status" in topics:
            found[name] = type_.removesuffix("ActionGoal")
    return found


def topics_of(action: str) -> tuple[str, ...]:
    """Return the topics of an action."""
    return tuple(f"{action}/{last}" for last in _TOPICS)


class GoalTopics(TaskClient):
    """The client's side of one action.

    Owner: messages arrive on any thread, `look` is called on the link's; a lock serializes them.
    """

    def __init__(self, transport: Transport, name: str, type_: str) -> None:
        self._transport, self._name, self._now = transport, name, transport.clock.now
        self._goals: dict[str, _Goal] = {}
        self._over: deque[str] = deque(maxlen=100)  # the ids of those that are over
        self._changed = threading.Condition()
        self._statuses: deque[float] = deque(maxlen=10)  # when they came
        self._handles: list[object] = []
        self._join("status", "actionlib_msgs/GoalStatusArray", self._hear_status, every=False)
        self._join("feedback", f"{type_}ActionFeedback", self._hear_feedback, every=False)
        self._join("result", f"{type_}ActionResult", self._hear_result)
        self._cancel = self._join("cancel", "actionlib_msgs/GoalID")
        self._goal = self._join("goal", f"{type_}ActionGoal")

    def _join(
        self, last: str, type_: str, receive: Callable[[Any], None] | None = None, every: bool = True
    ) -> object:
        """Hear one of the topics or, without `receive`, send on it."""
        direction: Direction = "publisher" if receive is None else "subscription"
        hear, topic = receive or (lambda _: None), f"{self._name}/{last}"
        handle = self._transport.join(topic, type_, direction, lambda message, *_: hear(message), every)
        self._handles.append(handle)
        return handle

    def leave(self) -> None:
        """End the five topics."""
        for handle in self._handles:
            self._transport.leave(handle)

    # -- what is asked for ------------------------------------------------------------------------

    def ask(self, values: Mapping[str, Any], request: RosRequest) -> None:
        """Send a goal until the server has it; bounded. BridgeError: it cannot be sent."""
        goal = _Goal(request, self._now())
        with self._changed:
            if request.id in self._goals:  # it was cancelled already
                return
            self._goals[request.id] = goal
        message = {"goal_id": {"id": request.id}, "goal": values}
        for _ in range(_TRIES):
            with self._changed:
                if goal.is_cancelled or not request.is_wanted():
                    break
                self._transport.send(self._goal, message, urgent=False)
                if self._changed.wait_for(lambda: goal.is_known or not request.is_wanted(), _AGAIN):
                    break
        if not (goal.is_known or goal.is_cancelled) and request.is_wanted():
            self._try_to_cancel(goal)
            why = "it ignores the goal" if self._is_heard(self._now()) else "there is none, or it hangs"
            request.tell("lost", reason=f"No action server of `{self._name}` takes the goal: {why}.")

    def cancel(self, request: RosRequest | None) -> None:
        """Cancel a goal, or all goals that the server has, of whatever client."""
        if request is None:
            self._transport.send(self._cancel, {}, urgent=True)
            return
        with self._changed:
            goal = self._goals.setdefault(request.id, _Goal(request, self._now()))
            goal.is_cancelled = True
            self._changed.notify_all()
            self._transport.send(self._cancel, {"id": request.id}, urgent=True)

    def _try_to_cancel(self, goal: _Goal) -> None:
        with suppress(BridgeError):  # the connection is lost, which the link tells
            self.cancel(goal.request)

    # -- what the server says ---------------------------------------------------------------------

    def _hear_status(self, message: Any) -> None:
        now = self._now()
        with self._changed:
            self._statuses.append(now)
            for each in _part(message, "status_list") or ():
                if self._note(each, now) is None and _part(each, "status") in _GOES_ON:
                    id_ = _part(_part(each, "goal_id"), "id")
                    if id_ in self._over:  # it was sent again, to a server that was started again
                        with suppress(BridgeError):
                            self._transport.send(self._cancel, {"id": id_}, urgent=True)

    def _hear_feedback(self, message: Any) -> None:
        with self._changed:
            goal = self._note(_part(message, "status"))
        if goal is not None:
            goal.request.tell("active", feedback=_part(message, "feedback"))

    def _hear_result(self, message: Any) -> None:
        with self._changed:
            goal = self._note(_part(message, "status"))
            if goal is None:
                return
            self._forget(goal)
        goal.request.tell(goal.end, result=_part(message, "result"), reason=goal.text)

    def _note(self, status: Any, listed: float | None = None) -> _Goal | None:
        """Note the status of a goal; return it if it is one of ours."""
        goal = self._goals.get(_part(_part(status, "goal_id"), "id"))
        if goal is None:
            return None
        number = _part(status, "status")
        goal.is_known, text = True, _part(status, "text")
        goal.text = ended(text) if text else ""
        goal.is_being_cancelled |= number in _CANCELS
        if number in _STATUS:
            goal.end, goal.ended_at = _STATUS[number], goal.ended_at or self._now()
        if listed is not None:
            goal.listed_at = listed
        self._changed.notify_all()
        return goal

    # -- what it no longer says -------------------------------------------------------------------

    def hint(self) -> str:
        """Return that there seems to be no server, in a sentence, or an empty text."""
        return "" if self._is_heard(self._now()) else f"no action server of `{self._name}` is heard"

    def look(self) -> None:
        """Find goals that were lost; repeat a cancel that has not arrived."""
        with self._changed:
            gone = dict(self._gone(self._now()))
            unheard = [each for each in self._goals.values() if each.is_known and each.is_cancelled]
        for goal, (status, why) in gone.items():
            if status == "lost":
                self._try_to_cancel(goal)
            goal.request.tell(status, reason=why)
            with self._changed:
                self._forget(goal)
        for goal in unheard:
            if goal not in gone and not goal.is_being_cancelled:
                self._try_to_cancel(goal)

    def _forget(self, goal: _Goal) -> None:
        self._goals.pop(goal.request.id, None)
        self._over.append(goal.request.id)

    def _gone(self, now: float) -> Iterator[tuple[_Goal, tuple[TaskStatus, str]]]:
        """Find the goals of which nothing more will be heard, with what is to be said of them."""
        server, newest = f"The action server of `{self._name}`", self._newest()
        for goal in self._goals.values():
            if goal.ended_at is not None:
                if now - goal.ended_at > _RESULT:
                    yield goal, (goal.end, goal.text or f"{server} has sent no result.")
            elif not goal.is_known:  # it was cancelled or could not be sent, or `ask` still tries
                if now - goal.asked_at > _FORGOTTEN:
                    yield goal, ("cancelled", "")
            elif not self._is_heard(now):
                yield goal, ("lost", f"{server} has fallen silent: it is dead, or hangs.")
            elif goal.listed_at is not None and newest - goal.listed_at > _RESULT:
                yield goal, ("lost", f"{server} no longer knows the goal: it was started again.")

    def _newest(self) -> float:
        return self._statuses[-1] if self._statuses else -math.inf

    def _is_heard(self, now: float) -> bool:
        """Return whether the server is not dead, and does not hang."""
        periods = [later - earlier for earlier, later in pairwise(tuple(self._statuses))]
        return now - self._newest() < max(_SILENT, _PERIODS * median(periods) if len(periods) > 1 else 0.0)


class _Goal:
    """A goal of ours, as far as the server has spoken of it."""

    def __init__(self, request: RosRequest, asked_at: float) -> None:
        self.request, self.asked_at = request, asked_at
        self.is_known = self.is_cancelled = self.is_being_cancelled = False
        self.end: TaskStatus = "active"
        self.text = ""
        self.ended_at: float | None = None  # when the server said that it has ended; its result is awaited
        self.listed_at: float | None = None  # when it was last in the server's status


def _part(message: Any, name: str) -> Any:
    """Return a field of a message, which is a dictionary (rosbridge) or an object (rospy)."""
    return message.get(name) if isinstance(message, Mapping) else getattr(message, name, None)

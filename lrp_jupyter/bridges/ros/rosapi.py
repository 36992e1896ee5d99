"""What rosapi says of the robot: its topics, their types, and who publishes.

It is asked on a websocket of its own, rarely, and nothing depends on its answers coming soon: rosbridge
processes the messages of one connection in their order, so that a service that hangs would hold up every
command after it, and a list would wait behind large messages. The commands of others arrive on this
connection as well, since subscribing, too, waits while the master of ROS 1 hangs.

An unknown type is asked for in a way that the robot survives. On ROS 1 that is `message_details`. On ROS 2
Jazzy and later, rosapi of rosbridge before 2.3.0 raises ``KeyError: 'check_fields'`` at this question, which
can end it; its version cannot be asked for. So on ROS 2 it is `topics_and_raw_types`, the text of the
``.msg`` files of all topics that exist; and only releases before Jazzy are asked for other types.
"""

from __future__ import annotations

import asyncio
import itertools
import json
import threading
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any

from lrp_jupyter.bridges.ros.clock import RobotClock, stamp_of
from lrp_jupyter.bridges.ros.definitions import (
    HEADERS,
    KNOWN,
    Definition,
    canonical,
    definitions_from_text,
    from_rosapi,
    part_of,
)
from lrp_jupyter.bridges.ros.link import SIM_TIME, RefusedError
from lrp_jupyter.bridges.ros.parameters import ParameterValues, missing_node, missing_parameter, value_in
from lrp_jupyter.bridges.ros.websocket import Bell, Socket
from lrp_jupyter.errors import BridgeError, did_you_mean, ended

_FIRST = 2.0  # seconds that connecting waits for the first list
_ANSWER = 5.0  # seconds for an answer, …
_LONG_ANSWER = 20.0  # … for the texts of all types
_ECHO_RATE = 100  # milliseconds between two commands that are listened to
_SOON, _RARELY = 1.0, 2.0  # seconds between two lists, while something is missing or not
_CLOCK = 60.0  # seconds between two readings of the robot's clock …
_PROMPT = 0.5  # … which may take that long
_VALID = 2.0  # seconds for which the users of a topic are known
_LONGEST = 30.0  # … and at most, while there is no rosapi: each question leaves an error in the robot's log
_SURE = ("foxy", "galactic", "humble", "iron")  # releases of ROS 2 whose rosapi describes any type
_UNTOLD = {
    "action": "does not describe actions. Update rosbridge: 2.3.0 does it or, on Humble, 2.0.2.",
    "service": "is not asked for types of services, because before rosbridge 2.3.0 that can end its rosapi on"
    " ROS 2 Jazzy and later. Update rosbridge.",
}
"""Why the types of these are not known."""
_OWN = "/client_count"  # rosbridge itself publishes it
_RAW_TYPES = "/rosapi/topics_and_raw_types"


class Rosapi:
    """The questions to rosapi, and the last answers.

    Owner: `run` asks; each answer is replaced by one assignment, and any thread may read it.

    `warn`: called with a sentence when rosapi is missing, and when it is there again.
    `changed`: called when there is something new.
    """

    def __init__(
        self, url: str, clock: RobotClock, warn: Callable[[str], None], changed: Callable[[], None]
    ) -> None:
        self.is_ros2 = False
        self.trouble = ""  # that ROS itself does not answer: a sentence
        self.has_sim_time: bool | None = None  # what ROS 1 says of its time; None: it has not been asked
        self.publishers: Mapping[str, tuple[str, ...]] = {}  # on the watched topics, without rosbridge itself
        self.subscribers: Mapping[str, tuple[str, ...]] = {}  # … of those topics of which it was asked
        self._in_need = False
        self._url, self._clock, self._warn, self._changed = url, clock, warn, changed
        self._topics: Mapping[str, str] = {}
        self._offers: Mapping[str, tuple[str, ...]] = {}  # the live actions (of ROS 2) and services
        self._describes_actions = False
        self._followed: frozenset[str] = frozenset()
        self._parameters = ParameterValues()  # of these, as far as they were asked for
        self._kinds: dict[tuple[str, str], str] = {}  # their types, as far as they were asked for
        self._unknown: frozenset[tuple[str, str]] = frozenset()
        self._answered = threading.Event()
        self._exists: bool | None = None  # not known yet
        self._failures = 0
        self._next_time = 0.0
        self._distribution: str | None = None
        self._own: tuple[str, ...] = ()
        self._watched: frozenset[str] = frozenset()
        self._heard_by: frozenset[str] = frozenset()
        self._wanted: frozenset[str] = frozenset()
        self._types: dict[str, Mapping[str, Definition] | BridgeError] = {}
        self._listeners: Mapping[str, tuple[str, Callable[[Any], None]]] = {}
        self._heard: set[str] = set()  # the topics that were subscribed to on this connection
        self._doubted: frozenset[str] = frozenset()
        self._taken: dict[str, tuple[float, bool]] = {}
        self._ids = itertools.count(1)
        self._asked = ""  # the number of the last question
        self._answer: asyncio.Future[Any] | None = None
        self._socket: Socket | None = None
        self._serving: asyncio.Future[Any] | None = None
        self._wake = Bell()

    # -- from any thread --------------------------------------------------------------------------

    def reset(self) -> None:
        """Forget what may be another robot's."""
        self._wake, self._failures, self._own = Bell(), 0, ()
        self._types, self._kinds, self._offers = {}, {}, {}
        self.has_sim_time = None
        self._parameters = ParameterValues()
        if self.trouble:
            self._answered.clear()
        self.trouble = ""

    def topics(self) -> Mapping[str, str]:
        """Return the topics with their types as they were a moment ago; the first time, wait a moment."""
        self._answered.wait(_FIRST)
        self._answered.set()
        return self._topics

    @property
    def exists(self) -> bool:
        """Whether there is one, or may be."""
        return self._exists is not False

    def has_listed(self, direction: str) -> bool:
        """Whether the live actions (of ROS 2) or services are known."""
        return direction in self._offers

    def offers(self, direction: str) -> Mapping[str, str]:
        """Return the live actions (of ROS 2) or services, with their types as far as they are known."""
        return {name: self._kinds.get((direction, name), "") for name in self._offers.get(direction, ())}

    def type_of(self, direction: str, name: str) -> str | None:
        """Return the type of an action or a service; None while it is asked for."""
        found = self._kinds.get((direction, name))
        if found is None and (direction, name) not in self._unknown:
            self._unknown |= {(direction, name)}
            self._wake.ring()
        return found

    def parameters(self, wanted: Collection[str]) -> ParameterValues:
        """Return what is known of some parameters, which are asked for again and again from now on."""
        followed = frozenset(wanted)
        if followed - self._followed:
            self._wake.ring()
        self._followed = followed
        if self._exists is False:
            why = f"`{self._url}` has no rosapi, which tells the parameters. Start it there."
            return ParameterValues({}, dict.fromkeys(followed, why))
        return self._parameters

    def define(self, type_: str) -> Mapping[str, Definition] | None:
        """Return the known definitions of a type and of those in it; None while they are asked for."""
        found = self._types.get(type_)
        if isinstance(found, BridgeError):
            raise RefusedError(str(found))
        if found is None and not self._exists:
            return {}
        if found is None and type_ not in self._wanted:
            self._wanted |= {type_}
            self._wake.ring()
        return found

    def taken(self, topic: str) -> bool | None:
        """Return whether any node publishes or subscribes to a topic; None while that is being asked."""
        answer = self._taken.get(topic)
        if answer is not None and time.monotonic() - answer[0] < _VALID:
            return answer[1]
        if not self._exists:
            return True
        if topic not in self._doubted:
            self._doubted |= {topic}
            self._wake.ring()
        return None

    def listen(self, topic: str, type_: str, receive: Callable[[Any], None]) -> None:
        """Listen to a topic; on the thread of the connection."""
        if topic not in self._listeners:
            self._listeners = {**self._listeners, topic: (type_, receive)}
            self._wake.ring()

    def ignore(self, topic: str) -> None:
        """Listen no more."""
        self._listeners = {name: each for name, each in self._listeners.items() if name != topic}
        self._wake.ring()

    def watch(self, published: Iterable[str], heard: Iterable[str], in_need: bool) -> None:
        """Choose the topics whose publishers, and subscribers, are asked for; sooner if one is missing."""
        watched, heard_by = frozenset(published), frozenset(heard)
        if watched - self._watched or heard_by - self._heard_by or (in_need and not self._in_need):
            self._wake.ring()
        self._watched, self._heard_by, self._in_need = watched, heard_by, in_need

    # -- in the event loop of the connection ------------------------------------------------------

    async def run(self) -> None:
        """Ask until it is cancelled."""
        try:
            while True:
                before = self._news()
                try:
                    news = await self._ask_all()
                except Exception as error:  # an answer of another form: go on without it
                    self._miss(f"has a rosapi whose answer cannot be understood: {error!r}.")
                    news = False
                self._answered.set()
                if news or before != self._news():
                    self._changed()
                pause = _SOON if self._in_need or self.trouble or self._followed else _RARELY
                await self._wake.wait(min(pause * 2**self._failures, _LONGEST))
        finally:
            self._answered.set()  # whoever connects waits for the first list no longer
            await self._hang_up()

    def _news(self) -> tuple[object, ...]:
        seen = self.publishers, self.subscribers, self._parameters
        return self._topics, self.trouble, self._exists, self._offers, seen

    async def _ask_all(self) -> bool:
        """Ask what there is to ask; return whether one of the answers is awaited."""
        appeared = await self._list_topics()
        self._tell_listeners()
        if not self._exists or self.trouble:
            return False
        if self.has_sim_time is None:
            question = {"name": SIM_TIME, "default": "false"}
            answer = {"value": ""} if self.is_ros2 else await self._try("/rosapi/get_param", **question)
            self.has_sim_time = answer["value"] == "true" if "value" in answer else None
        await self._list_offers()
        unknown, wanted, doubted = self._unknown, self._wanted, self._doubted
        for direction, name in unknown:
            answer = await self._try(f"/rosapi/{direction}_type", **{direction: name})
            self._kinds[direction, name] = canonical(str(answer.get("type", "")))
        self._unknown -= unknown
        for type_ in wanted:
            self._types[type_] = await self._describe(type_)
        for topic in doubted:
            is_taken = await self._nodes("publishers", topic) or await self._nodes("subscribers", topic)
            self._taken[topic] = (time.monotonic(), bool(is_taken))
        self._wanted -= wanted
        self._doubted -= doubted
        self._parameters = await self._ask_parameters()
        self.publishers = {topic: await self._others("publishers", topic) or () for topic in self._watched}
        heard = {topic: await self._others("subscribers", topic) for topic in self._heard_by}
        self.subscribers = {topic: nodes for topic, nodes in heard.items() if nodes is not None}
        return appeared or bool(wanted or doubted or unknown)

    async def _list_offers(self) -> None:
        """Ask for the services and, where they are more than topics, for the actions."""
        services = (await self._try("/rosapi/services")).get("services", ())
        actions = (await self._try("/rosapi/action_servers")) if self.is_ros2 else {}
        self._describes_actions = "/rosapi/action_goal_details" in services
        offers = {"service": services, "action": actions.get("action_servers")}
        self._offers = {
            kind: tuple(sorted(map(str, names))) for kind, names in offers.items() if names is not None
        }

    async def _ask_parameters(self) -> ParameterValues:
        """Ask for the values that are followed; one that is not answered stays as it was."""
        values, missing, ask = {}, {}, self._ask_node if self.is_ros2 else self._ask_server
        for name in self._followed:
            answer = await ask(name)
            if isinstance(answer, BridgeError):
                missing[name] = str(answer)
            elif answer is not None:
                values[name] = answer
            elif name in self._parameters.values:
                values[name] = self._parameters.values[name]
        return ParameterValues(values, missing)

    async def _ask_server(self, name: str) -> Any:
        """Return a parameter of ROS 1; an error if there is none, None if it is not known."""
        text = (await self._try("/rosapi/get_param", name=name)).get("value")
        if text is None:
            return None
        value = json.loads(text or "null")
        if value is not None:
            return value
        names = (await self._try("/rosapi/get_param_names")).get("names", ())
        return BridgeError(missing_parameter(name, map(str, names)))

    async def _ask_node(self, name: str) -> Any:
        """Return a parameter of a node of ROS 2, as `_ask_server` does."""
        if missing := missing_node(name, self._offers.get("service", ())):
            return BridgeError(missing)
        node, _, inner = name.partition(":")
        answer = (await self._try(f"{node}/get_parameters", names=[inner])).get("values")
        value = value_in(answer[0]) if answer else None
        if value is not None or answer is None:
            return value
        listed = (await self._try(f"{node}/list_parameters")).get("result", {})
        return BridgeError(missing_parameter(name, [f"{node}:{each}" for each in listed.get("names", ())]))

    async def _list_topics(self) -> bool:
        """Ask for the topics; return whether rosapi has just appeared."""
        try:
            values = await self._ask("/rosapi/topics")
        except RefusedError as error:
            if "master" in str(error).lower():  # whether or not rosapi is there, ROS is not
                self.trouble = (
                    f"`{self._url}` answers, but its ROS master does not: {ended(str(error))} The robot is"
                    " stopped and gets no commands; other nodes that are connected go on. A new master knows"
                    " no node that was there before: start rosbridge and those of the robot again."
                )
                return False
            self.trouble = ""
            self._miss(
                "has no rosapi: topics are not listed, and only common types are known. Start it there."
            )
            return False
        except BridgeError:
            if self._socket is not None and self._socket.is_open:
                await self._give_up()
                self._miss("has a rosapi that does not answer: topics are not listed for now.")
            self._failures = min(self._failures + 1, 5)
            return False
        names, types = values.get("topics", []), values.get("types")
        if types is None:  # an old rosapi: one type at a time
            types = [(await self._try("/rosapi/topic_type", topic=name)).get("type", "") for name in names]
        topics = {str(name): canonical(str(type_)) for name, type_ in zip(names, types, strict=False)}
        self.is_ros2 = any("/msg/" in str(type_) for type_ in types)
        if topics != self._topics:  # what was not known may be now
            self._types = {type_: found for type_, found in self._types.items() if found}
        before, self._exists = self._exists, True
        self._topics, self.trouble, self._failures = topics, "", 0
        await self._read_clock()
        if before is False:
            self._warn(f"rosapi of `{self._url}` answers now: topics are listed.")
        return not before

    async def _read_clock(self) -> None:
        """Ask for the robot's time, now and then; an answer that took long says little."""
        asked = time.monotonic()
        if asked < self._next_time:
            return
        self._next_time = asked + _CLOCK
        answer = await self._try("/rosapi/get_time")
        now = time.monotonic()
        if now - asked < _PROMPT:
            self._clock.read(stamp_of({"header": {"stamp": answer.get("time")}}), now)

    def _tell_listeners(self) -> None:
        """Subscribe to what is listened to, once on each connection."""
        socket, wanted = self._socket, self._listeners
        if socket is None or not socket.is_open:
            return
        for topic in wanted.keys() - self._heard:
            request = {"op": "subscribe", "id": f"e{topic}", "topic": topic, "type": wanted[topic][0]}
            socket.put(json.dumps({**request, "queue_length": 1, "throttle_rate": _ECHO_RATE}))
        for topic in self._heard - wanted.keys():
            socket.put(json.dumps({"op": "unsubscribe", "id": f"e{topic}", "topic": topic}))
        self._heard = set(wanted)

    def _receive(self, message: Mapping[str, Any]) -> None:
        """Take the answer to the last question, or pass on what was listened to."""
        operation, listener = message.get("op"), self._listeners.get(str(message.get("topic")))
        if operation == "publish" and listener is not None:
            listener[1](message.get("msg"))
        elif operation == "service_response" and message.get("id") == self._asked:
            assert self._answer is not None
            if not self._answer.done():
                self._answer.set_result(message)

    def _miss(self, why: str) -> None:
        before, self._exists = self._exists, False
        self._failures = min(self._failures + 1, 5)
        if before is not False:
            self._warn(f"`{self._url}` {why}")

    async def _others(self, who: str, topic: str) -> tuple[str, ...] | None:
        """Return the ``publishers`` or ``subscribers`` of a topic, without those on our side."""
        if not self._own:
            self._own = await self._nodes("publishers", _OWN) or ()
        own, nodes = self._own, await self._nodes(who, topic)
        return nodes and tuple(
            node for node in nodes if (node not in own if own else "rosbridge" not in node)
        )

    async def _nodes(self, who: str, topic: str) -> tuple[str, ...] | None:
        answer = (await self._try(f"/rosapi/{who}", topic=topic)).get(who)
        return None if answer is None else tuple(map(str, answer))

    async def _describe(self, type_: str) -> Mapping[str, Definition] | BridgeError:
        of, part, kind = part_of(type_)
        try:
            if not self.is_ros2:
                return await (self._part_details(type_, of, part, kind) if part else self._details(type_))
            if part and (await self._may_ask() if kind == "service" else self._describes_actions):
                return await self._part_details(type_, of, part, kind)
            if part:
                return BridgeError(f"`{self._url}` {_UNTOLD[kind]}")
            found = await self._from_raw_types(type_)
            if found:
                return found
            if await self._may_ask():
                return await self._details(type_.replace("/", "/msg/", 1))
        except BridgeError as error:
            return error
        return BridgeError(
            f"`{self._url}` knows no message type `{of}` of a topic that exists."
            f"{did_you_mean(of, {*KNOWN, *self._topics.values()})} If its name is right, start the node"
            " that uses it first. rosapi is asked for no other types, because before rosbridge 2.3.0 that can"
            " end it on ROS 2 Jazzy and later."
        )

    async def _may_ask(self) -> bool:
        """Whether rosapi survives a question for any type, on ROS 2."""
        if self._describes_actions:
            return True  # rosbridge 2.3.0 or later
        if self._distribution is None:
            version = await self._try("/rosapi/get_ros_version")
            self._distribution = str(version.get("distro", ""))
        return self._distribution in _SURE

    async def _part_details(self, type_: str, of: str, part: str, kind: str) -> Mapping[str, Definition]:
        """Return the definitions of what is sent to an action or a service, or comes from it."""
        if kind == "action" and not self.is_ros2:
            found = await self._details(of + part)
        else:
            spelled = of.replace("/", "/action/" if kind == "action" else "/srv/", 1) if self.is_ros2 else of
            answer = await self._try(f"/rosapi/{kind}_{part.lower()}_details", type=spelled)
            found = from_rosapi(answer.get("typedefs", []))
        if not found:
            return {}
        first = next(iter(found.values()))  # the part itself, whatever it is called there
        return {**found, type_: Definition(type_, first.fields)}

    async def _details(self, type_: str) -> Mapping[str, Definition]:
        answer = await self._try("/rosapi/message_details", type=type_)
        return from_rosapi(answer.get("typedefs", []))

    async def _from_raw_types(self, type_: str) -> Mapping[str, Definition]:
        """Return the definitions of a type that a topic has, from the texts of all topics."""
        values = await self._try(_RAW_TYPES)
        for each, text in zip(values.get("types", []), values.get("typedefs_full_text", []), strict=False):
            if canonical(str(each)) == type_ and not str(text).startswith("# failed to get full definition"):
                return {**HEADERS[2], **definitions_from_text(type_, str(text))}
        return {}

    async def _try(self, service: str, /, **arguments: object) -> Mapping[str, Any]:
        """Return the values of an answer; nothing if there is none."""
        try:
            return await self._ask(service, **arguments)
        except RefusedError:
            return {}
        except BridgeError:
            await self._give_up()
            return {}

    async def _ask(self, service: str, /, **arguments: object) -> Mapping[str, Any]:
        """Call a service; RefusedError: it has failed or does not exist; BridgeError: nothing came back."""
        socket, serving = self._socket, self._serving
        if socket is None or serving is None or serving.done():
            socket = Socket(self._url, self._receive, changed=lambda: None)
            serving = asyncio.ensure_future(socket.serve(await socket.connect()))
            self._socket, self._serving, self._heard = socket, serving, set()
        self._asked, self._answer = f"q{next(self._ids)}", asyncio.get_running_loop().create_future()
        question = {"op": "call_service", "id": self._asked, "service": service, "args": arguments}
        socket.put(json.dumps(question))
        await asyncio.wait(
            [self._answer, serving],
            timeout=_LONG_ANSWER if service == _RAW_TYPES else _ANSWER,
            return_when=asyncio.FIRST_COMPLETED,
        )
        if not self._answer.done():
            raise BridgeError(f"`{self._url}` did not answer the call of {service}.")
        response = self._answer.result()
        values = response.get("values")
        if response.get("result", True) is False or not isinstance(values, dict):
            raise RefusedError(f"{service}: {values or response.get('msg') or 'no answer'}")
        return values

    async def _give_up(self) -> None:
        """Wait no more for an answer.

        On ROS 2, rosbridge goes on waiting for it, and this connection with it. On ROS 1 it does not; and
        there, while the master hangs, a new connection would make rosbridge hang, too: it logs each one,
        which asks the master.
        """
        if self.is_ros2 or not self._topics:
            await self._hang_up()

    async def _hang_up(self) -> None:
        serving, self._socket, self._serving = self._serving, None, None
        if serving is not None:
            serving.cancel()
            await asyncio.gather(serving, return_exceptions=True)

"""A small rosbridge server for the tests: protocol 2.0 as far as the bridge uses it.

Neither Debian nor PyPI has one, so this one is our own; it serves either the
real ROS master with rospy (`python rosbridge_server.py PORT`), or a few topics in memory. Where the real one
is strict or peculiar, it is, too: the messages of a connection are processed in their order, so that a
service of ROS 2 that hangs holds up all later ones; an unknown operation leaves an error in the log; the
newest message waits for `throttle_rate`, and without it and a queue, none waits; to each request to
subscribe, it sends what the topic keeps; a header without a time stamp gets one; arrays of a fixed length
cannot be packed; numbers that are not finite are null in a text. A goal of ROS 2 holds up its connection; it
is found by its id, on whatever connection it came, and goes on if it is cancelled before it was accepted.
"""

from __future__ import annotations

import base64
import contextlib
import json
import math
import ssl
import struct
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import cbor2
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

Receive = Callable[[dict[str, Any]], None]


class MemoryGoal:
    """A goal of ROS 2, which goes as a test says."""

    def __init__(self, values: dict[str, Any], feedback: Receive) -> None:
        self.values, self.feedback = values, feedback
        self.is_accepted, self.cancels = True, 0
        self.outcome: tuple[int, dict[str, Any]] | None = None
        self._ended = threading.Event()

    def end(self, status: int, **result: Any) -> None:
        self.outcome = (status, result)
        self._ended.set()

    def cancel(self) -> None:
        self.cancels += 1
        if self.is_accepted:
            self.end(5)

    def wait(self) -> None:
        self._ended.wait()


class MemoryGraph:
    """Topics in memory, and a note of everything that was published on them.

    `services`: by name, the type of each and what answers a call.
    `actions`: of ROS 2, their types; `goals`: those that came, by the id of the client.
    `accepts`: whether these are accepted at once.
    """

    def __init__(self, definitions: dict[str, Any]) -> None:
        self.definitions = definitions
        self.services: dict[str, tuple[str, Callable[[dict[str, Any]], dict[str, Any]]]] = {}
        self.actions: dict[str, str] = {}
        self.goals: dict[str, MemoryGoal] = {}
        self.accepts = True
        self.types: dict[str, str] = {}
        self.heard: list[tuple[str, dict[str, Any]]] = []
        self.listeners: list[tuple[str, Receive]] = []
        self.relaxed: list[tuple[str, Receive]] = []  # of these, those who take what is not repeated
        self.advertised: list[str] = []
        self.others: set[str] = set()  # topics to which other nodes subscribe
        self.publishers: dict[str, list[str]] = {"/client_count": ["/rosbridge_websocket"]}
        self.best_effort: set[str] = set()  # topics that are published so
        self.latched: set[str] = set()  # topics that the clients have latched
        self.kept: dict[str, dict[str, Any]] = {}  # the last message of latched topics
        self.master_is_alive = True
        self.is_ros2 = False
        self.distribution = "jazzy"
        self.texts: dict[str, str] = {}  # of types, as in their .msg files and those inside
        self.time = time.time
        self.parameters: dict[str, Any] = {}  # of ROS 1
        self.nodes_parameters: dict[str, dict[str, Any]] = {}  # of ROS 2, by node: as `ParameterValue`

    def topics(self) -> dict[str, str]:
        if not self.master_is_alive:
            raise RuntimeError("unable to communicate with master")
        spell = self.spelled if self.is_ros2 else str
        return {topic: spell(type_) for topic, type_ in self.types.items()}

    def spelled(self, type_: str) -> str:
        return type_.replace("/", "/msg/", 1) if type_.count("/") == 1 else type_

    def service_names(self) -> list[str]:
        kinds = ("get_parameters", "list_parameters")
        own = [f"{node}/{kind}" for node in self.nodes_parameters for kind in kinds]
        return [*self.services, *own, "/robot/get_loggers"]

    def service_type(self, name: str) -> str:
        return self.services[name][0]

    def call(self, name: str, values: dict[str, Any]) -> dict[str, Any]:
        action = name.removesuffix("/_action/cancel_goal")
        if action in self.actions:
            for goal in tuple(self.goals.values()):
                goal.cancel()
            return {"return_code": 0}
        node, _, kind = name.rpartition("/")
        if node in self.nodes_parameters and kind == "get_parameters":
            known = self.nodes_parameters[node]
            return {"values": [known.get(each, {"type": 0}) for each in values["names"]]}
        if node in self.nodes_parameters and kind == "list_parameters":
            return {"result": {"names": list(self.nodes_parameters[node]), "prefixes": []}}
        if name not in self.services:
            raise KeyError(f"Service {name} does not exist")
        return self.services[name][1](values)

    def parameter(self, name: str, default: Any = None) -> Any:
        return self.parameters.get(name, default)

    def parameter_names(self) -> list[str]:
        return list(self.parameters)

    def part_typedefs(self, type_: str, part: str) -> list[dict[str, Any]]:
        return self.typedefs(f"{type_.replace('/srv/', '/').replace('/action/', '/')}_{part}")

    def typedefs(self, type_: str) -> list[dict[str, Any]]:
        wanted, found = [type_.replace("/msg/", "/")], {}
        while wanted:
            name = wanted.pop()
            definition = self.definitions[name]
            found[name] = {
                "type": name,
                "fieldnames": [f"_{field}" if self.is_ros2 else field for field in definition.fields],
                "fieldtypes": [self._base(shape.base) for shape in definition.fields.values()],
                "fieldarraylen": [shape.length for shape in definition.fields.values()],
            }
            inside = [shape.base for shape in definition.fields.values()]
            wanted += [base for base in inside if base in self.definitions and base not in found]
        return list(found.values())

    def _base(self, base: str) -> str:
        names = {"float64": "double", "float32": "float", "bool": "boolean"} if self.is_ros2 else {}
        return names.get(base, base)

    def raw_types(self) -> list[str]:
        return [self.texts.get(type_.replace("/msg/", "/"), "# none") for type_ in self.topics().values()]

    def nodes(self, topic: str, who: str) -> list[str]:
        if who == "subscribers":
            return ["/robot"] if topic in self.others else []
        own = ["/rosbridge_websocket"] if topic in self.advertised else []
        return [*own, *self.publishers.get(topic, [])]

    def subscribe(self, topic: str, type_: str, receive: Receive) -> object:
        self.types.setdefault(topic, type_)
        entry = (topic, receive)
        if topic in self.best_effort:  # chosen now, from the publishers there are
            self.relaxed.append(entry)
        self.listeners.append(entry)
        return entry

    def repeat(self, topic: str, handle: Any, receive: Receive) -> None:
        if topic in self.kept:
            receive(self.kept[topic])

    def latch(self, topic: str, **values: Any) -> None:
        self.kept[topic] = values
        self.send(topic, **values)

    def unsubscribe(self, handle: Any) -> None:
        self.listeners.remove(handle)

    def advertise(self, topic: str, type_: str, latch: bool = False) -> object:
        self.types.setdefault(topic, type_.replace("/msg/", "/"))
        self.advertised.append(topic)
        if latch:
            self.latched.add(topic)
        return topic

    def unadvertise(self, handle: Any) -> None:
        self.advertised.remove(handle)

    def publish(self, handle: Any, values: dict[str, Any]) -> None:
        header = values.get("header")
        if header is not None:
            header.setdefault("stamp", self.stamp(self.time()))
        self.heard.append((handle, values))
        (self.latch if handle in self.latched else self.send)(handle, **values)

    def stamp(self, seconds: float) -> dict[str, int]:
        whole, rest = int(seconds), round(seconds % 1 * 1e9)
        return {"sec": whole, "nanosec": rest} if self.is_ros2 else {"secs": whole, "nsecs": rest}

    def send(self, topic: str, **values: Any) -> None:
        """Publish as another node would."""
        for entry in tuple(self.listeners):
            if entry[0] == topic and (topic not in self.best_effort or entry in self.relaxed):
                entry[1](values)


class Latecomers:
    """Sends the first messages of a publisher to subscribers that connect a moment later, as the real one.

    That gives them one second, which is not enough on a loaded machine.
    """

    PATIENCE = 5.0  # s

    def __init__(self, publisher: Any) -> None:
        self.publisher = publisher

    def peer_subscribe(self, _topic: str, _to_all: Any, to_peer: Callable[[Any], None]) -> None:
        with self.publisher.impl.publock:  # nothing newer is sent before what is older
            if time.monotonic() - self.publisher.began < self.PATIENCE:
                for message in self.publisher.first:
                    to_peer(message)

    def peer_unsubscribe(self, _topic: str, _count: int) -> None:
        pass


class RospyGraph:
    """The topics of a real ROS master."""

    is_ros2 = False

    def __init__(self) -> None:
        import rospy

        self.rospy = rospy
        rospy.init_node("rosbridge", anonymous=True, disable_signals=True, disable_rosout=True)
        self.master = rospy.get_master()

    def topics(self) -> dict[str, str]:
        try:
            return {topic: type_ for topic, type_ in self.master.getTopicTypes()[2] if type_ != "*"}
        except OSError:
            raise RuntimeError("Unable to communicate with master!") from None

    def service_names(self) -> list[str]:
        return [name for name, _nodes in self.master.getSystemState()[2][2]]

    def service_type(self, name: str) -> str:
        import rosservice

        return rosservice.get_service_type(name) or ""

    def call(self, name: str, values: dict[str, Any]) -> dict[str, Any]:
        import genpy
        import roslib.message

        type_ = self.service_type(name)
        if not type_:
            raise KeyError(f"Service {name} does not exist")
        kind = roslib.message.get_service_class(type_)
        request = kind._request_class()
        genpy.message.fill_message_args(request, [values])
        return as_json(self.rospy.ServiceProxy(name, kind).call(request))

    def part_typedefs(self, type_: str, part: str) -> list[dict[str, Any]]:
        import roslib.message

        kind = roslib.message.get_service_class(type_)
        return self._typedefs(getattr(kind, f"_{part.lower()}_class"))

    def typedefs(self, type_: str) -> list[dict[str, Any]]:
        return self._typedefs(self._class(type_))

    def _typedefs(self, kind: Any) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = []
        shapes = [shape.partition("[") for shape in kind._slot_types]
        lengths = [int(rest[:-1] or 0) if bracket else -1 for _, bracket, rest in shapes]
        found.append(
            {
                "type": kind._type,
                "fieldnames": list(kind.__slots__),
                "fieldtypes": [base for base, _, _ in shapes],
                "fieldarraylen": lengths,
            }
        )
        for base in {base for base, _, _ in shapes if "/" in base}:
            found += self.typedefs(base)
        return found

    def parameter(self, name: str, default: Any = None) -> Any:
        return self.rospy.get_param(name, default)

    def parameter_names(self) -> list[str]:
        return list(self.rospy.get_param_names())

    def stamp(self, seconds: float) -> dict[str, int]:
        return {"secs": int(seconds), "nsecs": round(seconds % 1 * 1e9)}

    def nodes(self, topic: str, who: str) -> list[str]:
        if topic == "/client_count" and who == "publishers":
            return [str(self.rospy.get_name())]
        state = self.master.getSystemState()[2][0 if who == "publishers" else 1]
        return [node for name, nodes in state if name == topic for node in nodes]

    def _class(self, type_: str) -> Any:
        import roslib.message

        kind = roslib.message.get_message_class(type_)
        if kind is None:
            raise KeyError(type_)
        return kind

    def subscribe(self, topic: str, type_: str, receive: Receive) -> Any:
        return self.rospy.Subscriber(
            topic,
            self._class(type_),
            lambda message: receive(as_json(message)),
            tcp_nodelay=True,
        )

    def repeat(self, topic: str, handle: Any, receive: Receive) -> None:
        def once(message: Any) -> None:
            receive(as_json(message))

        handle.impl.add_callback(once, None)  # calls it at once, if the topic is latched
        handle.impl.remove_callback(once, None)

    def unsubscribe(self, handle: Any) -> None:
        handle.unregister()

    def advertise(self, topic: str, type_: str, latch: bool = False) -> Any:
        publisher = self.rospy.Publisher(
            topic, self._class(type_), queue_size=100, latch=latch, tcp_nodelay=True
        )
        publisher.began, publisher.first = 0.0, []
        if not latch:
            publisher.impl.add_subscriber_listener(Latecomers(publisher))
        return publisher

    def unadvertise(self, handle: Any) -> None:
        handle.unregister()

    def publish(self, handle: Any, values: dict[str, Any]) -> None:
        import genpy

        message = handle.data_class()
        genpy.message.fill_message_args(message, [values])
        self._stamp(message, values)
        with handle.impl.publock:
            handle.began = handle.began or time.monotonic()
            if time.monotonic() - handle.began < Latecomers.PATIENCE:
                handle.first.append(message)
            handle.publish(message)

    def _stamp(self, message: Any, values: Any) -> None:
        """Put the time into headers without one, however deep."""
        if not isinstance(values, dict):
            return
        if getattr(message, "_type", "") == "std_msgs/Header" and "stamp" not in values:
            message.stamp = self.rospy.Time.from_sec(time.time())
        for name, inner in values.items():
            self._stamp(getattr(message, name), inner)


PACKED = {
    "uint16": (69, "H"),
    "uint32": (70, "I"),
    "uint64": (71, "Q"),
    "int8": (72, "b"),
    "int16": (77, "h"),
}
PACKED |= {"int32": (78, "i"), "int64": (79, "q"), "float32": (85, "f"), "float64": (86, "d")}


def as_cbor(values: Any, type_: str, definitions: dict[str, Any]) -> Any:
    """Pack the arrays of a message, or fail as the real server does."""
    packed = {}
    for name, kind in definitions[type_].fields.items():
        value = values.get(name)
        if value is None:
            continue
        if kind.length > 0 or (kind.length == 0 and kind.base == "string"):
            raise AttributeError(f"{type(value[0]).__name__!r} object has no attribute '__slots__'")
        if kind.length == 0 and kind.base in PACKED:
            tag, code = PACKED[kind.base]
            packed[name] = cbor2.CBORTag(tag, struct.pack(f"<{len(value)}{code}", *value))
        elif kind.length < 0 and isinstance(value, dict) and "secs" not in value and "sec" not in value:
            packed[name] = as_cbor(value, kind.base, definitions)
        else:
            packed[name] = value
    return packed


def as_json(value: Any) -> Any:
    if hasattr(value, "__slots__") and not isinstance(value, (str, bytes)):
        return {name: as_json(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, dict):
        return {name: as_json(inner) for name, inner in value.items()}
    if isinstance(value, bytes):
        return base64.b64encode(value).decode()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return [as_json(item) for item in value] if isinstance(value, (list, tuple)) else value


class Subscription:
    """A topic that a client subscribed to: a message waits until the client may have it, if it has to."""

    def __init__(self, send: Callable[[Any], None], options: dict[str, dict[str, Any]]) -> None:
        self.options = options  # of each id
        self.handle: Any = None
        self._send = send
        self._newest: list[Any] = []
        self._changed = threading.Condition()
        self._is_over = False
        self._thread = threading.Thread(target=self._run, name="subscription", daemon=True)
        self._thread.start()

    def _least(self, option: str) -> int:
        return min((each.get(option, 0) for each in tuple(self.options.values())), default=0)

    def receive(self, values: Any) -> None:
        if not (self._least("throttle_rate") or self._least("queue_length")):
            self._send(values)
            return
        with self._changed:
            self._newest = [values]
            self._changed.notify()

    def finish(self) -> None:
        with self._changed:
            self._is_over = True
            self._changed.notify()

    def _run(self) -> None:
        sent = 0.0
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._newest or self._is_over)
                left = sent + self._least("throttle_rate") / 1000 - time.monotonic()
                if left > 0:
                    self._changed.wait_for(lambda: self._is_over, left)
                if self._is_over:
                    return
                newest, self._newest = self._newest[0], []
            sent = time.monotonic()
            self._send(newest)


class RosbridgeServer:
    """The server, on a thread of its own.

    Its faults can be chosen: see the attributes.

    Attributes
    ----------
    rosapi : bool
        Whether rosapi runs.
    hangs : set of str
        Services that never answer.
    details_end_rosapi : bool
        As before rosbridge 2.3.0 on ROS 2 Jazzy: `message_details` raises an error that ends rosapi.
    is_recent : bool
        As since rosbridge 3.0 on ROS 2: rosapi describes actions, and survives any question.
    packs, fails_to_pack : bool
        Whether it has the compression `cbor`; and whether it fails at it, as ROS 2 did before rosbridge 2.0.
    largest : int or None
        Bytes of a message; larger ones are sent in fragments.
    log : list of str
        The errors in the log of the robot.
    requests : list of dict
        All that clients sent.
    """

    def __init__(
        self,
        graph: MemoryGraph | RospyGraph,
        port: int = 0,
        rosapi: bool = True,
        encryption: ssl.SSLContext | None = None,
    ) -> None:
        self.graph, self.rosapi = graph, rosapi
        self.hangs: set[str] = set()
        self.details_end_rosapi = self.is_recent = False
        self.packs, self.fails_to_pack = True, False
        self.largest: int | None = None
        self.log: list[str] = []
        self.requests: list[dict[str, Any]] = []
        self.clients: set[ServerConnection] = set()
        self._over = threading.Event()
        self._server = serve(
            self._talk, "127.0.0.1", port, max_size=None, max_queue=None, compression=None, ssl=encryption
        )
        self.port: int = self._server.socket.getsockname()[1]
        self._thread = threading.Thread(target=self._server.serve_forever, name="rosbridge server")
        self._thread.start()

    def close(self) -> None:
        self._over.set()
        for goal in getattr(self.graph, "goals", {}).values():
            goal.end(6)
        self._server.shutdown()
        for client in tuple(self.clients):
            client.close_socket()
        self._thread.join(5)

    def asked(self, service: str) -> list[dict[str, Any]]:
        """The calls of a service so far."""
        return [each["args"] for each in tuple(self.requests) if each.get("service") == f"/rosapi/{service}"]

    def subscriptions(self, topic: str) -> list[dict[str, Any]]:
        """The requests for a topic so far."""
        requests = tuple(self.requests)
        return [each for each in requests if each["op"] == "subscribe" and each["topic"] == topic]

    def _talk(self, client: ServerConnection) -> None:
        self.clients.add(client)
        subscriptions: dict[str, Subscription] = {}  # by topic
        publishers: dict[str, tuple[str, Any]] = {}  # by id
        try:
            for frame in client:
                request = json.loads(frame)
                self.requests.append(dict(request))
                try:
                    self._serve(client, request, subscriptions, publishers)
                except ConnectionClosed:  # by a client that no longer wants the answer: nothing to log
                    raise
                except Exception as error:
                    self.log.append(f"{request['op']}: {error}")
                    status = {"op": "status", "level": "error", "msg": f"{type(error).__name__}: {error}"}
                    client.send(json.dumps(status))
        except ConnectionClosed:
            pass
        finally:
            self.clients.discard(client)
            for subscription in subscriptions.values():
                self.graph.unsubscribe(subscription.handle)
                subscription.finish()
            for _, handle in publishers.values():
                self.graph.unadvertise(handle)

    def _serve(
        self,
        client: ServerConnection,
        request: dict[str, Any],
        subscriptions: dict[str, Subscription],
        publishers: dict[str, tuple[str, Any]],
    ) -> None:
        operation, topic = request["op"], request.get("topic", "")
        if operation == "subscribe":
            known = subscriptions.get(topic)
            if known is None:
                send = partial(self._forward, client, topic, request["type"], request)
                known = Subscription(send, {request["id"]: request})
                known.handle = self.graph.subscribe(topic, request["type"], known.receive)
                subscriptions[topic] = known
            known.options.setdefault(request["id"], request).update(request)
            self.graph.repeat(topic, known.handle, known.receive)
        elif operation == "unsubscribe":
            known = subscriptions[topic]
            known.options.pop(request["id"])
            if not known.options:
                self.graph.unsubscribe(subscriptions.pop(topic).handle)
                known.finish()
        elif operation == "advertise":
            publishers[request["id"]] = (
                topic,
                self.graph.advertise(topic, request["type"], request.get("latch", False)),
            )
        elif operation == "unadvertise":
            self.graph.unadvertise(publishers.pop(request["id"])[1])
        elif operation == "publish":
            handles = [handle for name, handle in publishers.values() if name == topic]
            self.graph.publish(handles[0], request["msg"])
        elif operation == "call_service" and not self.graph.is_ros2:
            if request["service"].startswith("/rosapi/"):
                self._call(client, request)
            else:  # on a thread of its own
                threading.Thread(target=self._call, args=(client, request), daemon=True).start()
        elif operation == "send_action_goal" and self.graph.is_ros2:
            self._pursue(client, request)
        elif operation == "cancel_action_goal" and self.graph.is_ros2:
            goal = self.graph.goals.get(request["id"])  # type: ignore[union-attr]
            if goal is not None and goal.outcome is None:
                goal.cancel()
        elif operation == "call_service":
            self._call(client, request)
        else:
            raise KeyError(f"Unknown operation: {operation}.")

    def _call(self, client: ServerConnection, request: dict[str, Any]) -> None:
        answer = self._answer(request)
        if answer is not None:
            with contextlib.suppress(ConnectionClosed):
                client.send(json.dumps(answer))
        elif self.graph.is_ros2:
            self._over.wait()  # as the real one waits: this connection's next message is not processed

    def _pursue(self, client: ServerConnection, request: dict[str, Any]) -> None:
        """Wait for the result of a goal; this connection's next message is not processed before."""
        about = {"action": request["action"], "id": request["id"]}
        graph = self.graph
        assert isinstance(graph, MemoryGraph)

        def feedback(values: dict[str, Any]) -> None:
            client.send(json.dumps({"op": "action_feedback", **about, "values": values}))

        goal = MemoryGoal(request["args"], feedback)
        goal.is_accepted = graph.accepts
        graph.goals[request["id"]] = goal
        goal.wait()
        status, result = goal.outcome or (0, {})
        answer = {"op": "action_result", **about, "values": result, "status": status, "result": True}
        if status == 0:
            answer |= {"values": "Action goal was rejected", "result": False}
        with contextlib.suppress(ConnectionClosed):
            client.send(json.dumps(answer))

    def _forward(
        self, client: ServerConnection, topic: str, type_: str, request: dict[str, Any], values: Any
    ) -> None:
        message = {"op": "publish", "topic": topic, "msg": values}
        try:
            if request.get("compression") == "cbor" and self.packs:
                if self.fails_to_pack:
                    raise AttributeError("'LaserScan' object has no attribute '_slot_types'")
                definitions = self.graph.definitions  # type: ignore[union-attr]
                packed = as_cbor(values, type_.replace("/msg/", "/"), definitions)
                client.send(cbor2.dumps({**message, "msg": packed}))
                return
            text = json.dumps(as_json(message))
            size = self.largest or len(text)
            parts = [text[start : start + size] for start in range(0, len(text), size)]
            for number, part in enumerate(parts):
                fragment = {"op": "fragment", "id": 0, "data": part, "num": number, "total": len(parts)}
                client.send(text if len(parts) == 1 else json.dumps(fragment))
        except ConnectionClosed:
            return
        except Exception as error:
            self.log.append(f"Exception calling subscribe callback: {error}")

    def _answer(self, request: dict[str, Any]) -> dict[str, Any] | None:
        service, arguments = request["service"].removeprefix("/rosapi/"), request.get("args", {})
        answer = {"op": "service_response", "id": request["id"], "service": service}
        if service in self.hangs:
            return None
        if service == "message_details" and self.details_end_rosapi:
            self.rosapi = False
            self.log.append("KeyError: 'check_fields'")
            return None
        try:
            if service == request["service"]:
                return {**answer, "values": self.graph.call(service, arguments), "result": True}
            if not self.rosapi:
                raise KeyError(f"Service {request['service']} does not exist")
            return {**answer, "values": self._rosapi(service, arguments), "result": True}
        except Exception as error:
            self.log.append(f"call_service {type(error).__name__}: {error}")
            return {**answer, "values": f"{type(error).__name__}: {error}", "result": False}

    def _spelled(self, type_: str, kind: str) -> str:
        return type_.replace("/", f"/{kind}/", 1) if self.graph.is_ros2 else type_

    def _rosapi(self, service: str, arguments: dict[str, Any]) -> dict[str, Any]:
        graph = self.graph
        topics = graph.topics() if service.startswith("topics") else {}
        if service == "topics":
            return {"topics": list(topics), "types": list(topics.values())}
        if service == "topics_and_raw_types":
            texts = graph.raw_types()  # type: ignore[union-attr]
            return {"topics": list(topics), "types": list(topics.values()), "typedefs_full_text": texts}
        if service == "message_details":
            return {"typedefs": graph.typedefs(arguments["type"])}
        if service == "services":
            own = ["/rosapi/action_goal_details"] if self.is_recent else []
            return {"services": [*graph.service_names(), *own]}
        if service == "service_type":
            return {"type": self._spelled(graph.service_type(arguments["service"]), "srv")}
        if service == "action_servers":
            return {"action_servers": list(graph.actions)}  # type: ignore[union-attr]
        if service == "action_type" and self.is_recent:
            return {"type": self._spelled(graph.actions[arguments["action"]], "action")}  # type: ignore[union-attr]
        kind, _, part = service.removesuffix("_details").partition("_")
        if service.endswith("_details") and (kind == "service" or (kind == "action" and self.is_recent)):
            return {"typedefs": graph.part_typedefs(arguments["type"], part.capitalize())}
        if service in ("publishers", "subscribers"):
            return {service: graph.nodes(arguments["topic"], service)}
        if service == "get_param" and not graph.is_ros2:
            default = json.loads(arguments.get("default") or "null")
            return {"value": json.dumps(graph.parameter(arguments["name"], default))}
        if service == "get_param_names" and not graph.is_ros2:
            return {"names": graph.parameter_names()}
        if service == "get_time":
            return {"time": graph.stamp(time.time())}
        if service == "get_ros_version" and graph.is_ros2:  # type: ignore[union-attr]
            return {"version": 2, "distro": graph.distribution}  # type: ignore[union-attr]
        raise KeyError(f"Service /rosapi/{service} does not exist")


if __name__ == "__main__":
    running = RosbridgeServer(RospyGraph(), int(sys.argv[1]))
    running.packs = False
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    sys.stdin.read()  # until the parent process ends
    running.close()

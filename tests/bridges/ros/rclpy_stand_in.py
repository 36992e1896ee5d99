"""The part of rclpy's interface that the bridge uses, written from its documentation, with topics in memory.

rclpy comes with ROS 2 only, so what is tested with this is our side: which calls are made, what is made of
their results, and that all is ended. Messages arrive on the executor's thread, as in rclpy, and arrays are
those of `array` and NumPy.
"""

from __future__ import annotations

import array
import queue
import sys
from dataclasses import dataclass, field
from enum import Enum
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy
import pytest

from lrp_jupyter.bridges.ros.definitions import CLOCK, FLOATS, INTEGERS, KNOWN, Definition, FieldType

SPELLED = {"float64": "double", "float32": "float", "bool": "boolean"}
CODES = {"float64": "d", "float32": "f", "uint8": "B", "int32": "i"}
STAMP = Definition("builtin_interfaces/Time", {"sec": FieldType("int32"), "nanosec": FieldType("uint32")})
NAVIGATE = "nav2_msgs/Navigate"
PARTS = {
    f"{NAVIGATE}_Goal": {"pose": FieldType("geometry_msgs/PoseStamped")},
    f"{NAVIGATE}_Feedback": {"left": FieldType("float64")},
    f"{NAVIGATE}_Result": {"taken": FieldType("float64")},
    "lamps/Switch_Request": {"on": FieldType("bool")},
    "lamps/Switch_Response": {"said": FieldType("string")},
    "rcl_interfaces/GetParameters_Request": {"names": FieldType("string", 0)},
    "rcl_interfaces/GetParameters_Response": {"values": FieldType("rcl_interfaces/ParameterValue", 0)},
    "rcl_interfaces/ListParameters_Request": {"prefixes": FieldType("string", 0)},
    "rcl_interfaces/ListParameters_Response": {"result": FieldType("rcl_interfaces/ListParametersResult")},
    "rcl_interfaces/ListParametersResult": {"names": FieldType("string", 0)},
    "rcl_interfaces/ParameterValue": {
        "type": FieldType("uint8"),
        "double_value": FieldType("float64"),
        "string_array_value": FieldType("string", 0),
    },
    "action_msgs/CancelGoal_Request": {},
    "action_msgs/CancelGoal_Response": {"return_code": FieldType("int8")},
}
HEADER = Definition("std_msgs/Header", {"stamp": FieldType(STAMP.type), "frame_id": FieldType("string")})
TEXTS = {name: FieldType("string") for name in ("name", "msg", "file", "function")}
LOG_FIELDS = {
    "stamp": FieldType(STAMP.type),
    "level": FieldType("uint8"),
    **TEXTS,
    "line": FieldType("uint32"),
}
LOG = Definition("rcl_interfaces/Log", LOG_FIELDS)
TYPES = {**KNOWN, STAMP.type: STAMP, HEADER.type: HEADER, LOG.type: LOG}
TYPES |= {CLOCK: Definition(CLOCK, {"clock": FieldType(STAMP.type)})}
TYPES |= {name: Definition(name, fields) for name, fields in PARTS.items()}


class ReliabilityPolicy(Enum):
    RELIABLE = 1
    BEST_EFFORT = 2


class DurabilityPolicy(Enum):
    TRANSIENT_LOCAL = 1
    VOLATILE = 2


@dataclass
class QoSProfile:
    depth: int
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE


@dataclass
class Endpoint:
    """A publisher or a subscription of this node, or of another one."""

    topic_name: str
    msg_type: Any
    qos_profile: QoSProfile
    node_name: str = "robot"
    node_namespace: str = "/"
    callback: Any = None


@dataclass
class Publisher(Endpoint):
    graph: Any = None

    def publish(self, message: Any) -> None:
        self.graph.published.append((self.topic_name, message))


class ExternalShutdownException(Exception):  # noqa: N818  (rclpy's name)
    pass


@dataclass
class Graph:
    """All that there is of ROS 2."""

    domain: int | None = None
    publishers: list[Endpoint] = field(default_factory=list)
    subscriptions: list[Endpoint] = field(default_factory=list)
    published: list[tuple[str, Any]] = field(default_factory=list)
    arrivals: queue.SimpleQueue[Any] = field(default_factory=queue.SimpleQueue)
    alive: list[object] = field(default_factory=list)
    actions: dict[str, str] = field(default_factory=dict)
    accepts: bool = True  # goals
    goals: list[Goal] = field(default_factory=list)
    services: dict[str, tuple[str, Any]] = field(default_factory=dict)
    refuses: str = ""

    def other_publishes(self, topic: str, type_: str, **qos: Any) -> None:
        self.publishers.append(Endpoint(topic, type_, QoSProfile(5, **qos)))

    def other_subscribes(self, topic: str, type_: str) -> None:
        self.subscriptions.append(Endpoint(topic, type_, QoSProfile(5)))

    def deliver(self, topic: str, message: Any) -> None:
        """Let a message of another node arrive."""
        for subscription in self.subscriptions:
            if subscription.topic_name == topic and subscription.callback is not None:
                self.arrivals.put((subscription.callback, message))


class Future:
    """A result that comes later; its callbacks are called on the executor's thread."""

    def __init__(self, graph: Graph, value: Any = None, error: Exception | None = None) -> None:
        self._graph, self._value, self._error = graph, value, error
        self._callbacks: list[Any] = []
        self._is_done = value is not None or error is not None

    def add_done_callback(self, callback: Any) -> None:
        if self._is_done:
            self._graph.arrivals.put((callback, self))
        else:
            self._callbacks.append(callback)

    def set_result(self, value: Any) -> None:
        self._value, self._is_done = value, True
        for callback in self._callbacks:
            self._graph.arrivals.put((callback, self))

    def result(self) -> Any:
        if self._error is not None:
            raise self._error
        return self._value


class Goal:
    """A goal, as its client and its server have it; how it goes, a test says."""

    def __init__(self, graph: Graph, message: Any, feedback: Any) -> None:
        self._graph, self.message, self._feedback = graph, message, feedback
        self.accepted, self.cancels = graph.accepts, 0
        self._result = Future(graph)

    def get_result_async(self) -> Future:
        return self._result

    def cancel_goal_async(self) -> Future:
        self.cancels += 1
        return Future(self._graph, SimpleNamespace(return_code=0))

    def report(self, left: float) -> None:
        feedback = message_class(f"{NAVIGATE}_Feedback")(left=left)
        self._graph.arrivals.put((self._feedback, SimpleNamespace(feedback=feedback)))

    def end(self, status: int, taken: float = 0.0) -> None:
        result = message_class(f"{NAVIGATE}_Result")(taken=taken)
        self._result.set_result(SimpleNamespace(status=status, result=result))


class ActionClient:
    def __init__(self, node: Node, action_type: Any, action_name: str) -> None:
        assert action_type.Goal is message_class(f"{NAVIGATE}_Goal")
        self._graph, self._name = node._graph, action_name
        self._graph.alive.append(self)

    def server_is_ready(self) -> bool:
        return self._name in self._graph.actions

    def wait_for_server(self, timeout_sec: float) -> bool:
        return self.server_is_ready()

    def send_goal_async(self, goal: Any, feedback_callback: Any) -> Future:
        made = Goal(self._graph, goal, feedback_callback)
        self._graph.goals.append(made)
        return Future(self._graph, made)

    def destroy(self) -> None:
        self._graph.alive.remove(self)


class Client:
    def __init__(self, graph: Graph, srv_type: Any, name: str) -> None:
        self._graph, self.srv_type, self._name = graph, srv_type, name
        graph.alive.append(self)

    def service_is_ready(self) -> bool:
        return self._name in self._graph.services

    def wait_for_service(self, timeout_sec: float) -> bool:
        return self.service_is_ready()

    def call_async(self, request: Any) -> Future:
        assert isinstance(request, self.srv_type.Request)
        if self._name.endswith("/_action/cancel_goal"):
            for goal in self._graph.goals:
                goal.cancel_goal_async()
            return Future(self._graph, self.srv_type.Response())
        try:
            return Future(self._graph, self._graph.services[self._name][1](request))
        except Exception as error:
            return Future(self._graph, error=error)


class Node:
    def __init__(self, graph: Graph, name: str, namespace: str) -> None:
        self._graph, self._name, self._namespace = graph, name, namespace
        graph.alive.append(self)

    def get_name(self) -> str:
        return self._name

    def get_namespace(self) -> str:
        return self._namespace

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        ends = [*self._graph.publishers, *self._graph.subscriptions]
        spelled = {end.topic_name: end.msg_type for end in ends if isinstance(end.msg_type, str)}
        return [(name, [type_.replace("/", "/msg/")]) for name, type_ in spelled.items()]

    def get_service_names_and_types(self) -> list[tuple[str, list[str]]]:
        hidden = {f"{name}/_action/cancel_goal": "action_msgs/CancelGoal" for name in self._graph.actions}
        known = {name: type_ for name, (type_, _) in self._graph.services.items()} | hidden
        return [(name, [type_.replace("/", "/srv/")]) for name, type_ in known.items()]

    def create_client(self, srv_type: Any, srv_name: str) -> Client:
        return Client(self._graph, srv_type, srv_name)

    def destroy_client(self, client: Client) -> None:
        self._graph.alive.remove(client)

    def get_publishers_info_by_topic(self, topic: str) -> list[Endpoint]:
        return [end for end in self._graph.publishers if end.topic_name == topic]

    def get_subscriptions_info_by_topic(self, topic: str) -> list[Endpoint]:
        return [end for end in self._graph.subscriptions if end.topic_name == topic]

    def create_publisher(self, msg_type: Any, topic: str, qos_profile: QoSProfile) -> Publisher:
        made = Publisher(topic, msg_type, qos_profile, self._name, self._namespace, graph=self._graph)
        self._graph.publishers.append(made)
        return made

    def create_subscription(self, msg_type: Any, topic: str, callback: Any, qos_profile: Any) -> Endpoint:
        made = Endpoint(topic, msg_type, qos_profile, self._name, self._namespace, callback=callback)
        self._graph.subscriptions.append(made)
        return made

    def destroy_publisher(self, publisher: Endpoint) -> bool:
        return _destroyed(self._graph.publishers, publisher)

    def destroy_subscription(self, subscription: Endpoint) -> bool:
        return _destroyed(self._graph.subscriptions, subscription)

    def get_clock(self) -> Any:
        now = SimpleNamespace(to_msg=lambda: message_class(STAMP.type)(sec=77, nanosec=5))
        return SimpleNamespace(now=lambda: now)

    def destroy_node(self) -> None:
        self._graph.alive.remove(self)
        for ends in (self._graph.publishers, self._graph.subscriptions):
            ends[:] = [end for end in ends if end.node_name != self.get_name()]


def _destroyed(ends: list[Endpoint], end: Endpoint) -> bool:
    """Remove what a node made; what another one made stays, and that is no error."""
    if end not in ends:
        return False
    ends.remove(end)
    return True


class SingleThreadedExecutor:
    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._spins = True

    def add_node(self, node: Node) -> None:
        assert node in self._graph.alive

    def spin(self) -> None:
        try:
            while (arrival := self._graph.arrivals.get()) is not None:
                callback, message = arrival
                callback(message)
            raise ExternalShutdownException
        finally:
            self._spins = False

    def shutdown(self, timeout_sec: float) -> bool:
        if self._spins:
            self._graph.arrivals.put(None)
        return timeout_sec > 0


class Context:
    def try_shutdown(self) -> None:
        assert self in GRAPHS[0].alive
        GRAPHS[0].alive.remove(self)


GRAPHS: list[Graph] = []
_classes: dict[str, type] = {}


def message_class(name: str) -> Any:
    """Return a class of messages as ROS 2 generates it."""
    if name not in _classes:
        fields = TYPES[name].fields

        def make(self: Any, **values: Any) -> None:
            for each, kind in fields.items():
                setattr(self, each, values.get(each, _default(kind)))

        def types(cls: type) -> dict[str, str]:
            return {each: _spelled(kind) for each, kind in fields.items()}

        def equals(self: Any, other: Any) -> bool:
            pairs = zip(vars(self).values(), vars(other).values(), strict=True)
            return all(numpy.array_equal(mine, other) for mine, other in pairs)

        body = {"__init__": make, "__eq__": equals, "get_fields_and_field_types": classmethod(types)}
        _classes[name] = type(name.partition("/")[2], (), body)
    return _classes[name]


def _default(kind: FieldType) -> Any:
    if kind.length > 0:
        return numpy.zeros(kind.length, dtype=kind.base)
    if kind.length == 0:
        return array.array(CODES[kind.base]) if kind.base in CODES else []
    if kind.base in FLOATS:
        return 0.0
    if kind.base in INTEGERS:
        return 0
    return {"string": "", "bool": False}[kind.base] if "/" not in kind.base else message_class(kind.base)()


def _spelled(kind: FieldType) -> str:
    base = SPELLED.get(kind.base, kind.base)
    if kind.length < 0:
        return base
    return f"{base}[{kind.length}]" if kind.length else f"sequence<{base}>"


def set_message_fields(message: Any, values: dict[str, Any]) -> None:
    if GRAPHS[0].refuses:
        raise ValueError(GRAPHS[0].refuses)
    for name, value in values.items():
        if isinstance(value, dict):
            set_message_fields(getattr(message, name), value)
        else:
            setattr(message, name, value)


def install(patch: pytest.MonkeyPatch) -> Graph:
    """Make it importable as rclpy, with the packages of messages; return what it is about."""
    graph = Graph()
    patch.setattr(sys.modules[__name__], "GRAPHS", [graph])

    def init(*, args: list[str], context: Context, domain_id: int | None) -> None:
        assert args == []
        graph.domain = domain_id
        graph.alive.append(context)

    def create_node(name: str, *, namespace: str, context: Context, use_global_arguments: bool) -> Node:
        assert context in graph.alive
        assert not use_global_arguments
        return Node(graph, name, namespace)

    def executor(context: Context) -> SingleThreadedExecutor:
        assert context in graph.alive
        return SingleThreadedExecutor(graph)

    def actions(node: Node) -> list[tuple[str, list[str]]]:
        assert node in graph.alive
        return [(name, [type_.replace("/", "/action/")]) for name, type_ in graph.actions.items()]

    def whole(type_: str, *parts: str) -> Any:
        return SimpleNamespace(**{part: message_class(f"{type_}_{part}") for part in parts})

    modules: dict[str, dict[str, Any]] = {
        "rclpy": {"init": init, "create_node": create_node},
        "rclpy.context": {"Context": Context},
        "rclpy.action": {"ActionClient": ActionClient, "get_action_names_and_types": actions},
        "nav2_msgs": {},
        "nav2_msgs.action": {"Navigate": whole(NAVIGATE, "Goal", "Feedback", "Result")},
        "lamps": {},
        "lamps.srv": {"Switch": whole("lamps/Switch", "Request", "Response")},
        "rcl_interfaces": {},
        "rcl_interfaces.srv": {
            "GetParameters": whole("rcl_interfaces/GetParameters", "Request", "Response"),
            "ListParameters": whole("rcl_interfaces/ListParameters", "Request", "Response"),
        },
        "action_msgs": {},
        "action_msgs.srv": {"CancelGoal": whole("action_msgs/CancelGoal", "Request", "Response")},
        "rclpy.executors": {
            "SingleThreadedExecutor": executor,
        },
        "rclpy.qos": {
            "QoSProfile": QoSProfile,
            "ReliabilityPolicy": ReliabilityPolicy,
            "DurabilityPolicy": DurabilityPolicy,
        },
        "rosidl_runtime_py": {},
        "rosidl_runtime_py.set_message": {"set_message_fields": set_message_fields},
    }
    for name in TYPES:
        package, _, kind = name.partition("/")
        if kind and name not in PARTS:
            modules.setdefault(package, {})
            modules.setdefault(f"{package}.msg", {})[kind] = message_class(name)
    for name, names in modules.items():
        module = ModuleType(name)
        module.__dict__.update(names)
        patch.setitem(sys.modules, name, module)
    return graph

"""The rclpy back end: ROS 2 by its own library, where this Python can import it.

Python can import it in a shell in which ROS 2 was set up (``source /opt/ros/jazzy/setup.bash``). Then ROS
knows everything itself: the types of messages, and who publishes what with which quality of service. Unlike
rospy it can make and end any number of nodes in a process, each in a context of its own.

It follows rclpy's documentation (Humble to Kilted). No package registry carries rclpy, so it was not run with
the real one.
"""

from __future__ import annotations

import importlib
import threading
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakSet

from lrp_jupyter.bridges.latched_values import MOST
from lrp_jupyter.bridges.ros.client_libraries import lacks_library
from lrp_jupyter.bridges.ros.definitions import (
    Definition,
    FieldType,
    canonical,
    definitions_of,
    parse_field,
    part_of,
)
from lrp_jupyter.bridges.ros.kept import LastMessage
from lrp_jupyter.bridges.ros.link import Receive, RefusedError, Transport
from lrp_jupyter.bridges.ros.parameters import ParameterValues
from lrp_jupyter.bridges.ros.rclpy_parameters import RclpyParameters
from lrp_jupyter.bridges.ros.rclpy_tasks import RclpyAction, RclpyService
from lrp_jupyter.bridges.ros.ros_request import TaskClient
from lrp_jupyter.bridges.ros.setup import Direction
from lrp_jupyter.errors import BridgeError, sentence_of

_QUEUE = 10  # messages that wait for a slow subscriber; older ones are dropped
_JOIN = 1.0  # seconds that ending the thread may take


class RclpyTransport(Transport):
    """A node of ROS 2, in the domain that ``ROS_DOMAIN_ID`` names unless another one is given."""

    period = 0.5

    def __init__(self, domain: int | None = None) -> None:
        super().__init__()
        self.place = "ROS 2" if domain is None else f"ROS 2, domain {domain}"
        self._domain = domain
        self._context: Any = None
        self._node: Any = None
        self._executor: Any = None
        self._thread: threading.Thread | None = None
        self._failure = ""  # why no more messages are delivered
        self._subscriptions: list[_Subscription] = []
        self._clients = WeakSet[TaskClient]()
        self._parameters: RclpyParameters | None = None

    def connect(self) -> None:
        """Create the node; other nodes are found while it exists."""
        rclpy, executors = _import("rclpy"), _import("rclpy.executors")
        self.disconnect()
        self._context = _import("rclpy.context").Context()
        try:
            rclpy.init(args=[], context=self._context, domain_id=self._domain)
            self._node = rclpy.create_node(
                self.names.node,
                namespace=self.names.namespace,
                context=self._context,
                use_global_arguments=False,
            )
            self._executor = executors.SingleThreadedExecutor(context=self._context)
            self._executor.add_node(self._node)
        except Exception as error:  # rclpy raises RuntimeError, and errors of its middleware
            self.disconnect()
            raise BridgeError(f"The ROS 2 node cannot be made: {error}") from error
        self._failure = ""
        self._thread = threading.Thread(target=self._spin, args=(self._executor,), name="ROS 2", daemon=True)
        self._thread.start()

    def _spin(self, executor: Any) -> None:
        """Deliver messages until the node ends, or fails; Ctrl-C in a program that uses rclpy ends all."""
        try:
            executor.spin()
            why = "it was shut down."
        except Exception as error:  # of rclpy or its middleware, or of this bridge
            why = sentence_of(error)
        if executor is self._executor:
            self._failure = f"The ROS 2 node failed: {why}"
            self.changed()

    def disconnect(self) -> None:
        """Destroy the node."""
        executor, self._executor = self._executor, None
        if executor is not None:
            executor.shutdown(timeout_sec=_JOIN)
        thread, self._thread = self._thread, None
        if thread is not None and thread is not threading.current_thread():
            thread.join(_JOIN)
        for client in self._clients:
            client.leave()
        parameters, self._parameters = self._parameters, None
        if parameters is not None:
            parameters.leave()
        node, self._node, self._subscriptions = self._node, None, []
        if node is not None:
            node.destroy_node()
        context, self._context = self._context, None
        if context is not None:
            context.try_shutdown()

    def topics(self) -> Mapping[str, str]:
        """Return the topics of other nodes that were discovered so far."""
        if self._failure:
            raise BridgeError(self._failure)
        return {
            topic: canonical(types[0])
            for topic, types in self._node.get_topic_names_and_types()
            if types and self.taken(topic)
        }

    def define(self, type_: str) -> Mapping[str, Definition]:
        """Return the definitions from the classes of the installed packages."""
        return definitions_of(canonical(type_), _fields)

    def taken(self, topic: str) -> bool:
        """Return whether other nodes publish it or subscribe to it."""
        return bool(self._others(topic, "publishers") or self._others(topic, "subscriptions"))

    def commanders(self, topic: str) -> tuple[str, ...]:
        """Return the names of the other nodes that publish on a topic."""
        return _names(self._others(topic, "publishers"))

    def listeners(self, topic: str) -> tuple[str, ...]:
        """Return the names of the other nodes that subscribe to a topic."""
        return _names(self._others(topic, "subscriptions"))

    def _others(self, topic: str, who: str) -> list[Any]:
        """Return what is known of the endpoints of other nodes: ``publishers`` or ``subscriptions``."""
        own = (self._node.get_name(), self._node.get_namespace())
        infos = getattr(self._node, f"get_{who}_info_by_topic")(topic)
        return [info for info in infos if (info.node_name, info.node_namespace) != own]

    def offers(self, direction: Direction) -> Mapping[str, str]:
        """Return the actions and services that were discovered so far."""
        if direction == "action":
            found = _import("rclpy.action").get_action_names_and_types(self._node)
        else:
            found = self._node.get_service_names_and_types()
        return {name: canonical(types[0]) for name, types in found if types}

    def parameters(self, wanted: Collection[str]) -> ParameterValues:
        """Ask the nodes; their answers come later."""
        if self._parameters is None:
            getting = _whole_class("rcl_interfaces/GetParameters", "service")
            listing = _whole_class("rcl_interfaces/ListParameters", "service")
            self._parameters = RclpyParameters(self._node, getting, listing, self.changed)
        return self._parameters.ask(wanted)

    def join(
        self, topic: str, type_: str, direction: Direction, receive: Receive, every: bool = False
    ) -> object:
        """Create a subscription that asks for what is offered, or a reliable publisher."""
        qos, kind = _import("rclpy.qos"), _class_of(type_)
        if direction == "publisher":
            return self._node.create_publisher(kind, topic, qos.QoSProfile(depth=_QUEUE))
        made = _Subscription(topic, kind, receive, every)
        self._adapt(made)
        self._subscriptions.append(made)
        return made

    def announce(self, topic: str, type_: str, keeps: int) -> object:
        """Create a reliable publisher that keeps its last messages."""
        qos = _import("rclpy.qos")
        kept = qos.DurabilityPolicy.TRANSIENT_LOCAL
        profile = qos.QoSProfile(depth=max(keeps, _QUEUE), durability=kept)
        return self._node.create_publisher(_class_of(type_), topic, profile)

    def client(self, direction: Direction, name: str, type_: str) -> TaskClient:
        """Create a client of an action or a service."""
        node, kind = self._node, _whole_class(type_, direction)
        client: TaskClient
        if direction == "service":
            client = RclpyService(node, name, kind, _fill)
        else:
            cancelling = _whole_class("action_msgs/CancelGoal", "service")
            client = RclpyAction(node, name, kind, _fill, cancelling)
        self._clients.add(client)
        return client

    def tend(self, in_need: bool) -> float:
        """Subscribe again where the publishers of a topic now offer something else."""
        for each in self._subscriptions:
            self._adapt(each)
        return super().tend(in_need)

    def hear(self, handle: Any, every: bool) -> None:
        """Subscribe again with a longer queue, or a shorter one."""
        handle.every = every
        self._adapt(handle)

    def _adapt(self, one: _Subscription) -> None:
        """Ask for what all publishers offer and, without any, for the least."""
        qos = _import("rclpy.qos")
        offers = [info.qos_profile for info in self._others(one.topic, "publishers")]
        reliable = {offer.reliability for offer in offers} == {qos.ReliabilityPolicy.RELIABLE}
        kept = {offer.durability for offer in offers} == {qos.DurabilityPolicy.TRANSIENT_LOCAL}
        asked = (reliable, kept, one.every)
        if one.asked == asked:
            return
        profile = qos.QoSProfile(
            depth=MOST if one.every else 1,
            reliability=qos.ReliabilityPolicy.RELIABLE if reliable else qos.ReliabilityPolicy.BEST_EFFORT,
            durability=qos.DurabilityPolicy.TRANSIENT_LOCAL if kept else qos.DurabilityPolicy.VOLATILE,
        )
        before, one.asked = one.entity, asked
        one.last.renew()
        one.entity = self._node.create_subscription(one.kind, one.topic, one.take, profile)
        if before is not None:
            self._node.destroy_subscription(before)

    def leave(self, handle: Any) -> None:
        """End a subscription or a publisher; on a node that is gone it went with it."""
        if handle in self._subscriptions:
            self._subscriptions.remove(handle)
            self._node.destroy_subscription(handle.entity)
        elif self._node is not None and not isinstance(handle, _Subscription):
            self._node.destroy_publisher(handle)

    def send(self, handle: Any, values: Mapping[str, Any], urgent: bool) -> None:
        """Publish. A header without a stamp gets the time of this node, or of the robot's world."""
        message = handle.msg_type()
        try:
            _fill(message, values)
            header = getattr(message, "header", None)
            if header is not None and not (header.stamp.sec or header.stamp.nanosec):
                if self.clock.world is None:
                    header.stamp = self._node.get_clock().now().to_msg()
                else:
                    header.stamp.sec, header.stamp.nanosec = divmod(self.clock.time_ns(), 1_000_000_000)
            handle.publish(message)
        except Exception as error:
            raise BridgeError(f"`{handle.topic_name}` refuses the message: {error}") from error


@dataclass(eq=False)
class _Subscription:
    topic: str
    kind: Any
    receive: Receive
    every: bool  # whether every message counts
    asked: tuple[bool, bool, bool] | None = None  # reliable, given what came before, and every message
    entity: Any = None
    last: LastMessage = field(default_factory=LastMessage)

    def take(self, message: Any) -> None:
        """Pass on a message."""
        if self.last.is_news(message):
            self.receive(message)


def _names(infos: Iterable[Any]) -> tuple[str, ...]:
    return tuple(sorted(f"{info.node_namespace.rstrip('/')}/{info.node_name}" for info in infos))


def _import(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except Exception as error:  # one for another Python raises whatever it happens to
        lack = lacks_library("rclpy") or f"this Python cannot import {module} ({error})."
        raise BridgeError(f"The back end `rclpy`: {lack}") from error


def _fill(message: Any, values: Mapping[str, Any]) -> None:
    _import("rosidl_runtime_py.set_message").set_message_fields(message, dict(values))


def _class_of(type_: str) -> Any:
    """Return the class of a type of messages, also of those of an action or service."""
    of, part, kind = part_of(type_)
    found = _whole_class(of, kind)
    return getattr(found, part) if part else found


def _whole_class(type_: str, direction: str) -> Any:
    package, name = canonical(type_).split("/")
    module = {"action": "action", "service": "srv"}.get(direction, "msg")
    try:
        return getattr(importlib.import_module(f"{package}.{module}"), name)
    except (ImportError, AttributeError):
        raise RefusedError(
            f"`{type_}` is not installed here. Install its package, or set up the workspace that has it."
        ) from None


def _fields(type_: str) -> dict[str, FieldType]:
    try:
        kinds = _class_of(type_).get_fields_and_field_types()
    except AttributeError:
        raise RefusedError(
            f"`{type_}` is that of ROS 1 here. Start in a shell in which only ROS 2 is set up."
        ) from None
    return {name: parse_field(kind) for name, kind in kinds.items()}

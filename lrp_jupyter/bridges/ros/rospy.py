"""The rospy back end: ROS 1 by its own library, where this Python can import it.

rospy was made for programs that are one node from beginning to end, so it is held at arm's length:

* one node per process, made on the first connection and kept: rospy cannot make a second one;
* it may not touch the process: no signals, no handlers of the root logger, no arguments;
* registering waits while the master is down: the master is asked first, with a time limit, and only the
  link's thread ever registers;
* a master that comes back has forgotten all nodes: everything is unregistered and registered again.
"""

from __future__ import annotations

import logging
import os
import socket
import threading
import time
import xmlrpc.client
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from http.client import HTTPConnection, HTTPException
from io import BytesIO
from typing import Any
from urllib.parse import urlsplit
from weakref import WeakSet

from lrp_jupyter.bridges.ros.client_libraries import lacks_library
from lrp_jupyter.bridges.ros.definitions import (
    Definition,
    FieldType,
    canonical,
    definitions_of,
    parse_field,
    part_of,
)
from lrp_jupyter.bridges.ros.goal_topics import GoalTopics, actions_in
from lrp_jupyter.bridges.ros.link import SIM_TIME, Receive, RefusedError, Transport
from lrp_jupyter.bridges.ros.names import GraphNames
from lrp_jupyter.bridges.ros.parameters import ParameterValues, missing_parameter
from lrp_jupyter.bridges.ros.ros_request import RosRequest, TaskClient, own_words, sentence
from lrp_jupyter.bridges.ros.setup import Direction
from lrp_jupyter.errors import BridgeError, NoAnswerError

_ANSWER = 2.0  # seconds for the master to answer
_PROMPT = 0.5  # … and for a node, …
_VALID = 2.0  # … which is asked again after so many
_WRITTEN = 0.2  # seconds that the last messages of a publisher may take to be written
_MEET = 0.5  # seconds for subscribers to connect to a new publisher
_QUEUE = 10  # messages that wait for a slow subscriber; older ones are dropped
_ANNOUNCED = 100  # … where each of them counts

_NEW = "A new master knows no node that was there before: start those of the robot again."
_GONE = f"The robot is stopped and gets no commands; other nodes that are connected go on. {_NEW}"

_node_lock = threading.Lock()
_node_master = ""  # the master that this process's node belongs to
_node_end = ""  # why the node has ended, a sentence
_transports = WeakSet["RospyTransport"]()  # that use it


class RospyTransport(Transport):
    """The node of this process, with the master that ``ROS_MASTER_URI`` names unless another one is given."""

    period = 0.5
    version = 1

    def __init__(self, master: str = "") -> None:
        super().__init__()
        self.place = master or os.environ.get("ROS_MASTER_URI", "http://localhost:11311")
        self._master = _Master(self.place)
        self._pid: int | None = None
        self._every: dict[Any, bool] = {}  # of which subscribers every message counts
        self._topics: Mapping[str, str] = {}  # as the master knew them a moment ago, …
        self._system: Any = ([], [], [])  # … with who publishes, subscribes and serves
        self._service_types: dict[str, str] = {}
        self._nodes: dict[str, tuple[float, bool]] = {}  # when they were asked, and whether they answered

    @property
    def log_name(self) -> str:
        """The name that the node of this process has."""
        return str(_rospy().get_name())

    def connect(self) -> None:
        """Find the master and, in a process's first connection, create the node."""
        _check_node()
        self._pid = int(self._master.ask("getPid"))
        self._service_types = {}
        _make_node(self.place, self.names)
        _transports.add(self)

    def silence(self) -> str:
        """Ask for the master only: a node of this process could not be made again."""
        try:
            self._master.ask("getPid")
        except NoAnswerError as error:
            return str(error)
        return ""

    def disconnect(self) -> None:
        """Leave the node, which stays; its topics were unregistered one by one."""
        _transports.discard(self)

    def topics(self) -> Mapping[str, str]:
        """Ask the master, for topics with subscribers only too; BridgeError: it was restarted."""
        _check_node()
        try:
            pid = int(self._master.ask("getPid"))
        except BridgeError as error:
            raise BridgeError(f"{error} {_GONE}") from None
        if pid != self._pid:
            raise BridgeError(f"The ROS master at `{self.place}` was restarted. {_NEW}")
        pairs = self._master.ask("getTopicTypes")
        self._topics = {str(topic): canonical(str(type_)) for topic, type_ in pairs if type_ != "*"}
        self._system = self._master.ask("getSystemState")
        return self._topics

    def has_sim_time(self) -> bool:
        """Ask the master for ``/use_sim_time``."""
        return bool(self._master.ask("hasParam", SIM_TIME) and self._master.ask("getParam", SIM_TIME))

    def taken(self, topic: str) -> bool:
        """Ask the master for other nodes of the topic: it never forgets a type."""
        return bool(self._others(topic, 0) or self._others(topic, 1))

    def commanders(self, topic: str) -> tuple[str, ...]:
        """Ask the master for the other publishers."""
        return self._others(topic, 0)

    def listeners(self, topic: str) -> tuple[str, ...]:
        """Ask the master for the other subscribers."""
        return self._others(topic, 1)

    def _others(self, topic: str, section: int) -> tuple[str, ...]:
        """Return the other nodes that published (section 0) or subscribed (1) a moment ago, and answer."""
        own = _rospy().get_name()
        return tuple(
            str(node)
            for name, nodes in self._system[section]
            if name == topic
            for node in nodes
            if node != own and self._answers(str(node))
        )

    def _answers(self, node: str) -> bool:
        """Return whether a node answers: the master does not notice that one was killed."""
        asked, answers = self._nodes.get(node, (float("-inf"), False))
        if time.monotonic() - asked > _VALID:
            try:
                _XmlRpc(self._master.ask("lookupNode", node), f"The node `{node}`", _PROMPT).ask("getPid")
                answers = True
            except BridgeError:
                answers = False
            self._nodes[node] = time.monotonic(), answers
        return answers

    def define(self, type_: str) -> Mapping[str, Definition]:
        """Return the definitions from the classes of the installed packages."""
        return definitions_of(type_, _fields)

    def offers(self, direction: Direction) -> Mapping[str, str]:
        """Return the actions whose goals some node hears, or the services that the master knows."""
        _publishers, subscribers, services = self._system
        if direction == "action":
            heard = {name for name, _nodes in subscribers}
            found = actions_in(self._topics)
            return {action: type_ for action, type_ in found.items() if f"{action}/goal" in heard}
        return {str(name): self._service_types.get(name, "") for name, _nodes in services}

    def type_of(self, direction: Direction, name: str) -> str:
        """Ask the node of a service for its type; that of an action is known."""
        if direction == "service" and not self._service_types.get(name):
            self._service_types[name] = _service_type(self._master, name)
        return super().type_of(direction, name) or ""

    def parameters(self, wanted: Collection[str]) -> ParameterValues:
        """Ask the master: it is the parameter server."""
        values, missing = {}, {}
        for name in wanted:
            try:
                values[name] = self._master.ask("getParam", name)
            except RefusedError:
                missing[name] = missing_parameter(name, self._master.ask("getParamNames"))
        return ParameterValues(values, missing)

    def join(
        self, topic: str, type_: str, direction: Direction, receive: Receive, every: bool = False
    ) -> object:
        """Create a subscriber or a publisher."""
        rospy, kind = _rospy(), _class_of(type_)
        try:
            if direction == "publisher":
                publisher = rospy.Publisher(topic, kind, queue_size=_QUEUE, tcp_nodelay=True)
                self._wait_for_listeners(publisher, bool(self._others(topic, 1)))
                return publisher
            subscriber = rospy.Subscriber(topic, kind, callback=receive, queue_size=1, tcp_nodelay=True)
            self.hear(subscriber, every)
            return subscriber
        except (rospy.ROSException, ValueError) as error:
            raise RefusedError(f"`{topic}`: {error}") from error

    def announce(self, topic: str, type_: str, keeps: int) -> object:
        """Create a publisher that keeps its last message."""
        rospy, kind = _rospy(), _class_of(type_)
        try:
            publisher = rospy.Publisher(topic, kind, queue_size=_ANNOUNCED, latch=True, tcp_nodelay=True)
            self._wait_for_listeners(publisher, len(self._others(topic, 1)))
            return publisher
        except (rospy.ROSException, ValueError) as error:
            raise RefusedError(f"`{topic}`: {error}") from error

    def client(self, direction: Direction, name: str, type_: str) -> TaskClient:
        """Join the topics of an action, or be ready to call a service."""
        if direction == "service":
            return RospyService(
                name, _class_of(f"{type_}_Request", whole=True), self._is_offered, self.clock.time_ns
            )
        _class_of(f"{type_}ActionGoal")  # before anything is joined
        return GoalTopics(self, name, type_)

    def hear(self, handle: object, every: bool) -> None:
        """Keep all messages that arrive at once, or the last one; rospy decides that for a topic."""
        topic: Any = handle
        self._every[topic] = every
        impl = topic.impl
        size = None if any(self._every.get(each) for each in self._every if each.impl is impl) else 1
        if impl is not None and impl.queue_size != size:
            impl.set_queue_size(size)
            for connection in list(impl.connections):  # those that are there have their own
                connection.protocol.queue_size = size

    def _wait_for_listeners(self, publisher: Any, count: int) -> None:
        """Wait a moment for existing subscribers, or they would miss the first message."""
        end = time.monotonic() + _MEET
        while publisher.get_num_connections() < count and time.monotonic() < end:
            time.sleep(0.01)

    def _is_offered(self, service: str) -> bool:
        return any(name == service for name, _nodes in self._master.ask("getSystemState")[2])

    def leave(self, handle: object) -> None:
        """Unregister, when what was published has been written."""
        self._every.pop(handle, None)
        end, impl = time.monotonic() + _WRITTEN, getattr(handle, "impl", None)
        while any(getattr(each, "_queue", ()) for each in getattr(impl, "connections", ())):
            if time.monotonic() > end:
                break
            time.sleep(0.005)
        unregister: Callable[[], None] = handle.unregister  # type: ignore[attr-defined]
        unregister()

    def send(self, handle: object, values: Mapping[str, Any], urgent: bool) -> None:
        """Publish. Types were checked when the message was filled: rospy does it only for subscribers."""
        import genpy

        rospy = _rospy()
        publisher: Any = handle
        message = publisher.data_class()
        try:
            fill(message, values, self.clock.time_ns())
            publisher.publish(message)
        except (genpy.MessageException, rospy.ROSException) as error:
            raise BridgeError(f"`{publisher.resolved_name}` refuses the message: {error}") from error


def _rospy() -> Any:
    try:
        import rospy
    except Exception as error:  # one for another Python raises whatever it happens to
        raise BridgeError(f"The back end `rospy`: {lacks_library('rospy')}") from error
    return rospy


def _check_node() -> None:
    """Raise a BridgeError if the node of this process has ended."""
    if _node_end or _rospy().is_shutdown():
        why = _node_end or "The ROS node of this process was shut down."
        raise BridgeError(f"{why} There cannot be a second one: start the program, or the kernel, again.")


def _note_end() -> None:
    """Have the robot stopped while this node can still send; rospy calls it, on a thread of its own."""
    global _node_end
    rospy = _rospy()
    name, users = rospy.get_name(), tuple(_transports)
    why = f"The ROS node `{name}` was shut down from outside, as by `rosnode kill`."
    with suppress(BridgeError):  # there may be no master
        if _Master(_node_master).ask("lookupNode", name) != rospy.get_node_uri():
            why = f"Another node has taken the name `{name}`, so the ROS master has ended this one."
    _node_end = why
    for transport in users:
        transport.ending(why)


def _make_node(master: str, names: GraphNames) -> None:
    """Create the one node of this process."""
    global _node_master
    rospy = _rospy()
    with _node_lock:
        if _node_master and _node_master != master:
            raise BridgeError(
                f"The ROS node of this process belongs to `{_node_master}` and cannot change to `{master}`. "
                "Restart the kernel."
            )
        if _node_master:
            if not names.is_anonymous and names.full != rospy.get_name():
                raise BridgeError(
                    f"The ROS node of this process is `{rospy.get_name()}` and cannot become `{names.full}`."
                    " Restart the kernel."
                )
            return
        root = logging.getLogger()
        handlers, level = root.handlers[:], root.level
        before = os.environ.get("ROS_MASTER_URI")
        os.environ["ROS_MASTER_URI"] = master  # rospy has no other way to set it
        rospy.names._set_caller_id(names.full)  # nor to set the namespace
        try:
            rospy.init_node(
                names.node,
                argv=["lrp"],
                disable_signals=True,
                disable_rosout=True,
                disable_rostime=True,
            )
        except (rospy.ROSException, OSError) as error:
            raise BridgeError(f"The ROS node cannot be created: {error}") from error
        finally:
            if before is None:
                del os.environ["ROS_MASTER_URI"]
            else:
                os.environ["ROS_MASTER_URI"] = before
            for handler in [handler for handler in root.handlers if handler not in handlers]:
                handler.close()
            root.handlers[:] = handlers
            root.setLevel(level)
        _node_master = master
        rospy.on_shutdown(_note_end)


def _class_of(type_: str, whole: bool = False) -> Any:
    """Return the class of a type of messages, or of the `whole` service that they are part of."""
    import roslib.message

    of, part, kind = part_of(type_)
    try:
        if kind == "service":
            found = roslib.message.get_service_class(of)
        else:
            found = roslib.message.get_message_class(of + part)
    except ValueError:
        found = None
    if found is None:
        package = of.partition("/")[0]
        raise RefusedError(
            f"There is no {kind or 'message'} type `{of}` here. Is `{package}` installed, and is the name"
            " right?"
        )
    return getattr(found, f"_{part.lower()}_class") if kind == "service" and not whole else found


def fill(message: Any, values: Mapping[str, Any], now: int) -> None:
    """Put values into a message of genpy, and the time, in ns, into headers that have none."""
    import genpy

    genpy.message.fill_message_args(message, [dict(values)])
    _fill_stamps(message, values, genpy.Time(*divmod(now, 1_000_000_000)))


def _fill_stamps(message: Any, values: object, now: Any) -> None:
    """Put the time into headers that have none."""
    if isinstance(values, (tuple, list)):
        if values and isinstance(values[0], Mapping):
            for each, inner in zip(message, values, strict=True):
                _fill_stamps(each, inner, now)
    elif isinstance(values, Mapping):
        if getattr(message, "_type", "") == "std_msgs/Header" and "stamp" not in values:
            message.stamp = now
        for name, inner in values.items():
            _fill_stamps(getattr(message, name), inner, now)


def _fields(type_: str) -> dict[str, FieldType]:
    kind = _class_of(type_)
    return {name: parse_field(text) for name, text in zip(kind.__slots__, kind._slot_types, strict=True)}


class _Timed(xmlrpc.client.Transport):
    """XML-RPC with a timeout."""

    def __init__(self, seconds: float) -> None:
        super().__init__()
        self._seconds = seconds

    def make_connection(self, host: Any) -> HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = self._seconds
        return connection


class _XmlRpc:
    """The ROS master or a node, asked with a time limit; `who` begins a sentence about it."""

    def __init__(self, uri: str, who: str, seconds: float) -> None:
        self._uri, self._who, self._seconds = uri, who, seconds

    def ask(self, question: str, *arguments: str) -> Any:
        """Call a function of the other side and return its answer."""
        try:
            with xmlrpc.client.ServerProxy(self._uri, transport=_Timed(self._seconds)) as proxy:
                code, text, value = getattr(proxy, question)("/lrp", *arguments)
        except (TimeoutError, OSError, HTTPException, xmlrpc.client.Error, ValueError) as error:
            raise NoAnswerError(self._silent(error)) from None
        if code != 1:
            raise RefusedError(f"{self._who} at `{self._uri}` refuses {question}: {text}")
        return value

    def _silent(self, error: Exception) -> str:
        return f"{self._who} at `{self._uri}` does not answer ({error})."


class _Master(_XmlRpc):
    """The ROS master."""

    def __init__(self, uri: str) -> None:
        super().__init__(uri, "The ROS master", _ANSWER)
        if not urlsplit(uri).hostname:
            raise BridgeError(f"`{uri}` is not the address of a ROS master. Write `http://host:11311`.")

    def _silent(self, error: Exception) -> str:
        return f"No ROS master answers at `{self._uri}` ({error}). Start `roscore`, or name its `host`."


class RospyService(TaskClient):
    """A service, each call of which has a thread and a connection of its own: rospy waits without a limit."""

    def __init__(
        self, name: str, kind: Any, is_offered: Callable[[str], bool], now: Callable[[], int]
    ) -> None:
        self._name, self._kind, self._is_offered, self._now = name, kind, is_offered, now
        self._calls: list[Any] = []

    def ask(self, values: Mapping[str, Any], request: RosRequest) -> None:
        """Call it, on a thread of its own."""
        proxy = _rospy().ServiceProxy(
            self._name, self._kind, persistent=True
        )  # it can be closed while it waits
        self._calls.append(proxy)
        work = threading.Thread(
            target=self._call, args=(proxy, values, request), name="ROS call", daemon=True
        )
        work.start()

    def _call(self, proxy: Any, values: Mapping[str, Any], request: RosRequest) -> None:
        try:
            message = self._kind._request_class()
            fill(message, values, self._now())
            request.tell("succeeded", result=proxy.call(message))
        except Exception as error:  # of rospy, genpy, or the node that serves
            is_its_own = "with an error" in str(error)  # that of the node that serves
            is_gone = isinstance(error, _rospy().ServiceException) and not is_its_own
            why = str(error) or type(error).__name__
            why = sentence(self.hint()) or own_words(why if is_its_own else f"`{self._name}`: {why}")
            request.tell("lost" if is_gone else "aborted", reason=why)
        finally:
            proxy.close()
            if proxy in self._calls:
                self._calls.remove(proxy)

    def leave(self) -> None:
        """End the calls that wait."""
        calls, self._calls = self._calls, []
        for proxy in calls:
            proxy.close()

    def hint(self) -> str:
        """Return that no node serves it, in a sentence, or an empty text."""
        try:
            is_offered = self._is_offered(self._name)
        except BridgeError as error:
            return str(error)
        return "" if is_offered else f"no node offers the service `{self._name}`"


def _service_type(master: _Master, name: str) -> str:
    """Ask the node that serves a service for its type; empty: it does not say."""
    import rosgraph.network
    from rospy.core import parse_rosrpc_uri
    from rospy.impl.tcpros_base import DEFAULT_BUFF_SIZE

    try:
        host, port = parse_rosrpc_uri(master.ask("lookupService", name))
        with socket.create_connection((host, port), _ANSWER) as connection:
            connection.settimeout(_ANSWER)
            asked = {"probe": "1", "md5sum": "*", "callerid": "/lrp", "service": name}
            rosgraph.network.write_ros_handshake_header(connection, asked)
            header = rosgraph.network.read_ros_handshake_header(connection, BytesIO(), DEFAULT_BUFF_SIZE)
    except (OSError, BridgeError, rosgraph.network.ROSHandshakeException):
        return ""
    return canonical(str(header.get("type", "")))

"""A small rosbridge server for the tests: protocol 2.0 as far as the bridge uses it.

Neither Debian nor PyPI has one, so this one is our own; it serves either the
real ROS master with rospy (`python rosbridge_server.py PORT`), or a few topics in memory. It is strict
where the real one is: a message with a field that its type does not have is refused with a status.
"""

from __future__ import annotations

import base64
import json
import math
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

Receive = Callable[[dict[str, Any]], None]


class MemoryGraph:
    """Topics in memory, and a note of everything that was published on them."""

    def __init__(self, definitions: dict[str, Any]) -> None:
        self.definitions = definitions
        self.types: dict[str, str] = {}
        self.heard: list[tuple[str, dict[str, Any]]] = []
        self.listeners: list[tuple[str, Receive]] = []
        self.advertised: list[str] = []
        self.others: set[str] = set()  # topics that other nodes use
        self.master_is_alive = True
        self.is_ros2 = False

    def topics(self) -> dict[str, str]:
        if not self.master_is_alive:
            raise RuntimeError("unable to communicate with master")
        spell = self.spelled if self.is_ros2 else str
        return {topic: spell(type_) for topic, type_ in self.types.items()}

    def spelled(self, type_: str) -> str:
        return type_.replace("/", "/msg/", 1) if type_.count("/") == 1 else type_

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

    def nodes(self, topic: str, _who: str) -> list[str]:
        return ["/somebody"] if topic in self.others else []

    def subscribe(self, topic: str, type_: str, receive: Receive) -> object:
        self.types.setdefault(topic, type_)
        self.listeners.append((topic, receive))
        return self.listeners[-1]

    def unsubscribe(self, handle: Any) -> None:
        self.listeners.remove(handle)

    def advertise(self, topic: str, type_: str) -> object:
        self.types.setdefault(topic, type_)
        self.advertised.append(topic)
        return topic

    def unadvertise(self, handle: Any) -> None:
        self.advertised.remove(handle)

    def publish(self, handle: Any, values: dict[str, Any]) -> None:
        self.heard.append((handle, values))

    def send(self, topic: str, **values: Any) -> None:
        """Publish as another node would."""
        for name, receive in tuple(self.listeners):
            if name == topic:
                receive(values)


class RospyGraph:
    """The topics of a real ROS master."""

    def __init__(self) -> None:
        import rospy

        self.rospy = rospy
        rospy.init_node("rosbridge", anonymous=True, disable_signals=True, disable_rosout=True)
        self.master = rospy.get_master()

    def topics(self) -> dict[str, str]:
        return {topic: type_ for topic, type_ in self.master.getTopicTypes()[2] if type_ != "*"}

    def typedefs(self, type_: str) -> list[dict[str, Any]]:
        kind, found = self._class(type_), []
        shapes = [shape.partition("[") for shape in kind._slot_types]
        lengths = [int(rest[:-1] or 0) if bracket else -1 for _, bracket, rest in shapes]
        found.append(
            {
                "type": type_,
                "fieldnames": list(kind.__slots__),
                "fieldtypes": [base for base, _, _ in shapes],
                "fieldarraylen": lengths,
            }
        )
        for base in {base for base, _, _ in shapes if "/" in base}:
            found += self.typedefs(base)
        return found

    def nodes(self, topic: str, who: str) -> list[str]:
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
            queue_size=1,
            tcp_nodelay=True,
        )

    def unsubscribe(self, handle: Any) -> None:
        handle.unregister()

    def advertise(self, topic: str, type_: str) -> Any:
        publisher = self.rospy.Publisher(topic, self._class(type_), queue_size=10, tcp_nodelay=True)
        publisher.unheard = True
        return publisher

    def unadvertise(self, handle: Any) -> None:
        handle.unregister()

    def publish(self, handle: Any, values: dict[str, Any]) -> None:
        import genpy

        message = handle.data_class()
        genpy.message.fill_message_args(message, [values])
        if handle.unheard:  # as the real one: the first message waits for the subscribers to connect
            handle.unheard = False
            end = time.monotonic() + 0.5
            while handle.get_num_connections() == 0 and time.monotonic() < end:
                time.sleep(0.01)
        handle.publish(message)


def as_json(value: Any) -> Any:
    if hasattr(value, "__slots__") and not isinstance(value, (str, bytes)):
        return {name: as_json(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, bytes):
        return base64.b64encode(value).decode()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return [as_json(item) for item in value] if isinstance(value, (list, tuple)) else value


class RosbridgeServer:
    """The server, on a thread of its own."""

    def __init__(self, graph: MemoryGraph | RospyGraph, port: int = 0, rosapi: bool = True) -> None:
        self.graph, self.rosapi = graph, rosapi
        self.clients: set[ServerConnection] = set()
        self._server = serve(self._talk, "127.0.0.1", port, max_size=None, compression=None)
        self.port: int = self._server.socket.getsockname()[1]
        self._thread = threading.Thread(target=self._server.serve_forever, name="rosbridge server")
        self._thread.start()

    def close(self) -> None:
        self._server.shutdown()
        for client in tuple(self.clients):
            client.close_socket()
        self._thread.join(5)

    def _talk(self, client: ServerConnection) -> None:
        self.clients.add(client)
        subscriptions: dict[str, tuple[str, Any]] = {}
        publishers: dict[str, tuple[str, Any]] = {}
        try:
            for frame in client:
                request = json.loads(frame)
                try:
                    self._serve(client, request, subscriptions, publishers)
                except Exception as error:
                    status = {"op": "status", "level": "error", "msg": f"{type(error).__name__}: {error}"}
                    client.send(json.dumps(status))
        except ConnectionClosed:
            pass
        finally:
            self.clients.discard(client)
            for _, handle in subscriptions.values():
                self.graph.unsubscribe(handle)
            for _, handle in publishers.values():
                self.graph.unadvertise(handle)

    def _serve(
        self,
        client: ServerConnection,
        request: dict[str, Any],
        subscriptions: dict[str, tuple[str, Any]],
        publishers: dict[str, tuple[str, Any]],
    ) -> None:
        operation, topic = request["op"], request.get("topic", "")
        if operation == "subscribe":

            def forward(values: dict[str, Any]) -> None:
                try:
                    client.send(json.dumps({"op": "publish", "topic": topic, "msg": values}))
                except ConnectionClosed:
                    return

            handle = self.graph.subscribe(topic, request["type"], forward)
            subscriptions[request["id"]] = (topic, handle)
        elif operation == "unsubscribe":
            self.graph.unsubscribe(subscriptions.pop(request["id"])[1])
        elif operation == "advertise":
            publishers[request["id"]] = (topic, self.graph.advertise(topic, request["type"]))
        elif operation == "unadvertise":
            self.graph.unadvertise(publishers.pop(request["id"])[1])
        elif operation == "publish":
            handles = [handle for name, handle in publishers.values() if name == topic]
            self.graph.publish(handles[0], request["msg"])
        elif operation == "call_service":
            client.send(json.dumps(self._answer(request)))

    def _answer(self, request: dict[str, Any]) -> dict[str, Any]:
        service, arguments = request["service"], request.get("args", {})
        answer = {"op": "service_response", "id": request["id"], "service": service}
        try:
            if not self.rosapi:
                raise KeyError(f"Service {service} does not exist")
            return {
                **answer,
                "values": self._rosapi(service.removeprefix("/rosapi/"), arguments),
                "result": True,
            }
        except Exception as error:
            return {**answer, "values": f"{type(error).__name__}: {error}", "result": False}

    def _rosapi(self, service: str, arguments: dict[str, Any]) -> dict[str, Any]:
        if service == "topics":
            topics = self.graph.topics()
            return {"topics": list(topics), "types": list(topics.values())}
        if service == "message_details":
            return {"typedefs": self.graph.typedefs(arguments["type"])}
        if service in ("publishers", "subscribers"):
            return {service: self.graph.nodes(arguments["topic"], service)}
        raise KeyError(f"Service /rosapi/{service} does not exist")


if __name__ == "__main__":
    running = RosbridgeServer(RospyGraph(), int(sys.argv[1]))
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    sys.stdin.read()  # until the parent process ends
    running.close()

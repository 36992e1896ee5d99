"""The DDS back end: ROS 2 without a ROS installation, by Cyclone DDS's Python package.

ROS 2 has no master. Its nodes are participants of a DDS *domain*, a number that all of them know
(``ROS_DOMAIN_ID``). Each tells the others which readers and writers it has: by multicast or, where that does
not get through, by unicast to a `host`. A reader and a writer meet if three things fit:

* the topic: ``/cmd_vel`` is ``rt/cmd_vel`` on the wire;
* the type: ``geometry_msgs/msg/Twist`` is ``geometry_msgs::msg::dds_::Twist_``, a struct whose fields are
  sent one after the other (CDR), so both sides must know its definition (`dds_types`); since Iron, a hash of
  it is in the USER_DATA of every reader and writer;
* the quality of service: what the writer offers and what the reader asks for (`dds_qos`).

DDS does not know of nodes: they are announced on a topic of their own (`dds_graph`). A node whose computer
dies says nothing: it is believed to be there until its lease ends, 10 s (Cyclone DDS) or 20 s (Fast DDS)
after its last sign of life, so what is noticed first is that its topics are silent. When no node is left on
the far side of all topics, the robot is lost, until there is one again.

Fast DDS 2.9 and Cyclone DDS 11 were met on the wire, and no robot yet.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from lrp_jupyter.bridges.ros.address import domain_number
from lrp_jupyter.bridges.ros.dds_node import DdsNode, TopicPublisher, TopicReader
from lrp_jupyter.bridges.ros.dds_types import MessageTypes
from lrp_jupyter.bridges.ros.definitions import Definition
from lrp_jupyter.bridges.ros.link import Receive, RefusedError, Transport
from lrp_jupyter.bridges.ros.setup import Direction
from lrp_jupyter.errors import BridgeError, NoAnswerError

_FIND = 4.0  # seconds to find a node; Fast DDS tells of itself every 3 s
_SETTLE = 1.5  # seconds until what a node has is known; its readers or its writers may come a second later


class DdsTransport(Transport):
    """A node of ROS 2 in a DDS domain, where robots are found by multicast; one at a `host` is asked, too."""

    period = 0.5
    has_tasks = False  # who sent a request is written outside of it, by each middleware in its own way

    def __init__(self, domain: int | None = None, host: str = "", folders: Iterable[str] = ()) -> None:
        super().__init__()
        self._domain, self._host, self._folders = domain_number(domain), host, tuple(folders)
        self.place = f"ROS 2, domain {self._domain}"
        self._node: DdsNode | None = None
        self._met: frozenset[tuple[str, bool]] = frozenset()  # what had another node on the far side

    # -- the connection ---------------------------------------------------------------------------

    def connect(self) -> None:
        """Join the domain and wait for other nodes: any, or those that were lost."""
        self.disconnect()
        types = MessageTypes(self._folders, self.clock.time_ns)
        node = DdsNode(self._domain, self.names, self._host, types, lambda: self.changed())
        self._node = node
        if not node.wait_for(lambda: self._is_there(node), _FIND):
            raise NoAnswerError(self._gone() if self._met else self._no_node())
        node.wait_for(node.graph.is_whole, _SETTLE)

    def _is_there(self, node: DdsNode) -> bool:
        if not self._met:
            return len(node.graph) > 0
        return any(node.graph.ends(f"rt{topic}", not writes) for topic, writes in self._met)

    def _no_node(self) -> str:
        return (
            f"No node answers in ROS 2's domain {self._domain}. Is the robot on, in this network, and its"
            f" `ROS_DOMAIN_ID` {self._domain}? Where multicast does not get through, name its `host`."
        )

    def _gone(self) -> str:
        topics = ", ".join(f"`{topic}`" for topic, _writes in sorted(self._met))
        return f"The robot is gone: no other node in ROS 2's domain {self._domain} has {topics} any more."

    def disconnect(self) -> None:
        """Leave the domain."""
        node, self._node = self._node, None
        if node is not None:
            node.close()

    def _open_node(self) -> DdsNode:
        node = self._node
        if node is None or node.failure:
            raise BridgeError(node.failure if node is not None else f"`{self.place}` was left.")
        return node

    # -- topics -----------------------------------------------------------------------------------

    def topics(self) -> Mapping[str, str]:
        """Return the topics of other nodes; BridgeError: none is left on the far side of any topic."""
        node = self._open_node()
        ends = [end for end in node.ends if not end.keeps]  # who follows the run is not the robot
        met = {(end.topic, end.writes) for end in ends if end.others()}
        self._met = (self._met | met) & {(end.topic, end.writes) for end in ends}
        if self._met and not met:
            raise BridgeError(self._gone())
        return node.graph.topics()

    def define(self, type_: str) -> Mapping[str, Definition]:
        """Return the definitions from the user's folders, an installed ROS, or rosbags."""
        return self._open_node().types.define(type_)

    def taken(self, topic: str) -> bool:
        """Return whether other nodes publish it or subscribe to it."""
        return bool(self._open_node().graph.ends(f"rt{topic}"))

    def commanders(self, topic: str) -> tuple[str, ...]:
        """Return the names of the other nodes that publish on a topic."""
        return tuple(name for name in self._names(topic, writes=True) if name)

    def listeners(self, topic: str) -> tuple[str, ...]:
        """Return the names of the other nodes that subscribe to a topic, even while they are not known."""
        return tuple(name or "a node" for name in self._names(topic, writes=False))

    def _names(self, topic: str, writes: bool) -> list[str]:
        node = self._open_node()
        return sorted({node.name_of(end) for end in node.graph.ends(f"rt{topic}", writes)})

    def join(
        self, topic: str, type_: str, direction: Direction, receive: Receive, every: bool = False
    ) -> object:
        """Create a reader or a writer."""
        node = self._open_node()
        end: TopicReader | TopicPublisher
        try:
            if direction == "publisher":
                end = node.advertise(topic, type_, was_heard=(topic, True) in self._met)
            else:
                end = node.subscribe(topic, type_, receive, every)
            self._met |= {(topic, end.writes)} if end.others() else set()
            return end
        except BridgeError:
            raise
        except Exception as error:  # of cyclonedds, for this topic
            raise RefusedError(f"`{topic}` cannot be connected: {error}.") from error

    def announce(self, topic: str, type_: str, keeps: int) -> object:
        """Create a writer that keeps its last messages."""
        try:
            return self._open_node().advertise(topic, type_, keeps=keeps)
        except BridgeError:
            raise
        except Exception as error:  # of cyclonedds, for this topic
            raise RefusedError(f"`{topic}` cannot be connected: {error}.") from error

    def hear(self, handle: object, every: bool) -> None:
        """Have the reader keep all messages until they are taken, or the last one."""
        assert isinstance(handle, TopicReader)
        self._open_node().hear(handle, every)

    def leave(self, handle: object) -> None:
        """End a reader or a writer; those of a node that is gone went with it."""
        assert isinstance(handle, (TopicReader, TopicPublisher))
        node = self._node
        if node is not None:
            node.remove(handle)

    def send(self, handle: object, values: Mapping[str, Any], urgent: bool) -> None:
        """Publish."""
        assert isinstance(handle, TopicPublisher)
        self._open_node()
        handle.send(values, urgent)

    def hint(self, handle: object) -> str:
        """Return why nothing arrives: another quality of service, or no node on the far side."""
        assert isinstance(handle, (TopicReader, TopicPublisher))
        topic, writes = f"`{handle.topic}`", handle.writes
        if found := handle.disagreements():
            who, does = ("subscriber", "asks for") if writes else ("publisher", "offers")
            return (
                f"a {who} of {topic} {does} another quality of service than this side ({', '.join(found)})."
                " Change it there"
            )
        if handle.others():
            return ""
        if (handle.topic, writes) in self._met:
            return f"no other node {'subscribes to' if writes else 'publishes'} {topic} any more"
        return ""

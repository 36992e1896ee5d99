"""A node of ROS 2 on Cyclone DDS: its subscriptions and publishers, and the one thread that serves them.

No callback of DDS runs Python: cyclonedds writes without releasing the interpreter's lock, and a callback
that waits for it inside DDS could wait for ever. One thread waits for whatever happens, and takes it.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from cyclonedds.core import DDSException, DDSStatus, GuardCondition, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.internal import InvalidSample, dds_infinity
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from lrp_jupyter.bridges.latched_values import MOST
from lrp_jupyter.bridges.ros.dds_domain import DdsDomain
from lrp_jupyter.bridges.ros.dds_graph import Endpoint, EndpointGraph, NodeDirectory
from lrp_jupyter.bridges.ros.dds_qos import (
    announcing_qos,
    command_qos,
    disagreements,
    node_of,
    qos_of,
    reading_qos,
)
from lrp_jupyter.bridges.ros.dds_types import MessageTypes
from lrp_jupyter.bridges.ros.link import GUARD_NODE, Receive
from lrp_jupyter.bridges.ros.names import GraphNames
from lrp_jupyter.errors import BridgeError

_ENCLAVE = Policy.Userdata(b"enclave=/;")
_JOIN = 1.0  # seconds that ending the thread may take
_DELIVERED = 0.2  # … and that the last commands may take to arrive when the node ends
_AT_ONCE = 16  # samples


class _TopicEnd:
    """The part of this node in a topic."""

    writes = False
    keeps = 0  # messages, for readers that come later

    def __init__(self, node: DdsNode, topic: str, type_: str) -> None:
        self.topic, self.type = topic, type_
        self._node = node
        self._wire = f"rt{topic}"  # as DDS has it
        self._hash = node.types.hash(type_)
        self._topic = Topic(node.participant, self._wire, node.types.struct(type_))
        self._entity: Any = None
        self._qos: Any = None

    @property
    def key(self) -> Any:
        """The identity of the endpoint."""
        return self._entity.guid

    def others(self) -> list[Endpoint]:
        """Return the endpoints of other nodes on the far side."""
        return self._node.graph.ends(self._wire, writes=not self.writes)

    def disagreements(self) -> list[str]:
        """Return the policies because of which another node does not get or give what it should.

        For a subscription it is enough that one publisher is understood.
        """
        pairs = [(self._qos, other.qos) if self.writes else (other.qos, self._qos) for other in self.others()]
        found = [disagreements(offered, asked) for offered, asked in pairs]
        return [] if not self.writes and [] in found else next(filter(None, found), [])

    def adapt(self) -> None:
        """React to a change on the far side; on the node's thread, or before that knows of this end."""

    def serve(self) -> None:
        """React to what has happened at this end; on the node's thread."""

    def delete(self) -> None:
        """End it."""
        self._node.end(self._entity)
        _delete(self._topic)


class TopicReader(_TopicEnd):
    """A subscription; its quality of service follows what the publishers of the topic offer."""

    def __init__(self, node: DdsNode, topic: str, type_: str, receive: Receive, every: bool) -> None:
        super().__init__(node, topic, type_)
        self._receive, self.every = receive, every
        self._last: dict[int, int] = {}  # the time stamp of the last message of each publisher …
        self._had: dict[int, int] = {}  # … when the present reader replaced another
        self._asked: Qos | None = None
        self.adapt()

    def adapt(self) -> None:
        """Subscribe as the publishers offer, and again when they offer something else."""
        most = MOST if self.every else 1
        asked = reading_qos([other.qos for other in self.others()], self._hash, most)
        if asked != self._asked:
            before = self._entity
            self._asked, self._entity = asked, DataReader(self._node.participant, self._topic, asked)
            self._qos = qos_of(self._entity)
            self._node.listen(self._entity, DDSStatus.DataAvailable)
            if before is not None:
                self._take(before)
                self._had = self._last.copy()
                self._node.end(before)

    def serve(self) -> None:
        """Pass on the messages that have come."""
        self._take(self._entity)

    def _take(self, entity: Any) -> None:
        """Pass on what a reader has; one that replaces another is given again what the topic keeps."""
        while samples := entity.take(_AT_ONCE):
            for sample in samples:
                if isinstance(sample, InvalidSample):
                    continue
                source, stamp = sample.sample_info.publication_handle, sample.sample_info.source_timestamp
                if stamp > self._had.get(source, 0):
                    self._had.pop(source, None)  # from now on, its clock may be set back
                    self._last[source] = stamp
                    self._receive(sample)


class TopicPublisher(_TopicEnd):
    """A publisher; `was_heard` if another node subscribed at some time.

    `keeps`: how many messages are kept for readers that come later; 0: it is for commands.
    """

    writes = True

    def __init__(self, node: DdsNode, topic: str, type_: str, was_heard: bool, keeps: int) -> None:
        super().__init__(node, topic, type_)
        self.keeps = keeps
        name = node.name if GUARD_NODE in node.name else ""  # so that it can be recognised
        qos = announcing_qos(self._hash, keeps) if keeps else command_qos(self._hash, name)
        self._entity = DataWriter(node.participant, self._topic, qos)
        self._qos = qos_of(self._entity)
        self.was_heard = was_heard
        self._owed: Any = None  # a stop that no subscriber received
        node.listen(self._entity, DDSStatus.PublicationMatched)
        self.serve()

    def send(self, values: Mapping[str, Any], urgent: bool) -> None:
        """Publish; a stop waits for a subscriber that is gone."""
        try:
            sample = self._node.types.sample(self.type, values)
            is_heard = self.others() and self._entity.get_matched_subscriptions()
            self._owed = sample if urgent and self.was_heard and not is_heard else None
            self._entity.write(sample)
        except DDSException as error:
            raise BridgeError(f"`{self.topic}` was not sent: {error}") from error
        except Exception as error:  # cyclonedds raises what its serializer happens to
            raise BridgeError(f"`{self.topic}` refuses the message: {error}") from error

    def serve(self) -> None:
        """Send the stop that is owed as soon as there is a subscriber.

        A reader is known a moment before it is connected, and gone a moment before it is disconnected; what
        is sent in between is lost.
        """
        if self._entity.get_publication_matched_status().current_count and self.others():
            self.was_heard = True
            owed, self._owed = self._owed, None
            if owed is not None:
                self._entity.write(owed)

    def flush(self, until: float) -> None:
        """Wait until the last command has arrived, at most until a time of `time.monotonic`."""
        left = max(0.0, until - time.monotonic())
        with suppress(DDSException, AttributeError):  # the second is how cyclonedds reports a timeout
            self._entity.wait_for_acks(duration(seconds=left))


class DdsNode:
    """A node in a domain, from its beginning to its end.

    `host`: where a robot is that cannot be found by multicast; empty: none.
    `changed`: called on the node's thread when readers or writers of other nodes appear or go.
    """

    def __init__(
        self, number: int, names: GraphNames, host: str, types: MessageTypes, changed: Callable[[], None]
    ) -> None:
        self.name, self.types = names.node, types
        self.failure = ""  # why it no longer works
        self._changed = changed
        self._domain = DdsDomain.enter(number, host)
        try:
            self.participant = DomainParticipant(number, Qos(_ENCLAVE))
        except DDSException as error:
            self._domain.leave()
            raise BridgeError(f"DDS has no room for another node in domain {number}: {error}") from error
        self.graph = EndpointGraph(self.participant)
        self.directory = NodeDirectory(self.participant, names)
        self.ends: tuple[_TopicEnd, ...] = ()
        self._lock = threading.RLock()  # for the ends
        self._to_adapt = False  # whether an end wants another quality of service
        self._over = False
        self._happened = threading.Condition()
        self._waiting = WaitSet(self.participant)
        self._bell = GuardCondition(self.participant)
        self._waiting.attach(self._bell)
        for reader in self.graph.readers:
            self.listen(reader, DDSStatus.DataAvailable)
        self._thread = threading.Thread(target=self._run, name="ROS 2", daemon=True)
        self._thread.start()

    def name_of(self, end: Endpoint) -> str:
        """Return the name of the node that has an endpoint; empty while it has not announced itself."""
        name = self.directory.name_of(end) or node_of(end.qos)
        return name or ("" if self.graph.announces(end) else "a node without a name")

    def subscribe(self, topic: str, type_: str, receive: Receive, every: bool = False) -> TopicReader:
        """Subscribe; messages arrive on the node's thread."""
        with self._lock:
            reader = TopicReader(self, topic, type_, receive, every)
            self._add(reader)
            return reader

    def hear(self, reader: TopicReader, every: bool) -> None:
        """Subscribe again, if every message is to be kept now, or no longer."""
        if reader.every != every:
            reader.every, self._to_adapt = every, True
            self._bell.set(True)

    def advertise(self, topic: str, type_: str, was_heard: bool = False, keeps: int = 0) -> TopicPublisher:
        """Become a publisher of a topic."""
        with self._lock:
            publisher = TopicPublisher(self, topic, type_, was_heard, keeps)
            self._add(publisher)
            return publisher

    def _add(self, end: _TopicEnd) -> None:
        self.ends += (end,)
        self._bell.set(True)  # for the announcement, and for what has arrived already

    def remove(self, end: _TopicEnd) -> None:
        """End a subscription or a publisher."""
        with self._lock:
            if end in self.ends:
                self.ends = tuple(other for other in self.ends if other is not end)
                end.delete()
                self._bell.set(True)

    def listen(self, entity: Any, what: int) -> None:
        """Wake the node's thread when something happens at a reader or a writer."""
        entity.set_status_mask(what)
        self._waiting.attach(entity)

    def end(self, entity: Any) -> None:
        """Delete a reader or a writer."""
        self._waiting.detach(entity)
        _delete(entity)

    def wait_for(self, holds: Callable[[], bool], seconds: float) -> bool:
        """Wait until something is known of other nodes; return whether it is. Ends with the node."""
        with self._happened:
            return self._happened.wait_for(lambda: self._over or holds(), seconds) and not self._over

    def close(self) -> None:
        """End everything; idempotent."""
        with self._happened:
            if self._over:
                return
            self._over = True
            self._happened.notify_all()
        self._bell.set(True)
        if self._thread is not threading.current_thread():
            self._thread.join(_JOIN)
        until = time.monotonic() + _DELIVERED
        with self._lock:
            for end in self.ends:
                if isinstance(end, TopicPublisher):
                    end.flush(until)
            self.ends = ()
        _delete(self._waiting, self.participant)
        self._domain.leave()

    def _run(self) -> None:
        try:
            while not self._over:
                self._bell.take()
                self._serve()
                self._waiting.wait(dds_infinity)
        except Exception as error:  # of cyclonedds, or of this bridge: it is reported by the link
            self.failure = f"The ROS 2 node failed: {type(error).__name__}: {error}"
            self._changed()

    def _serve(self) -> None:
        changed = self.graph.update()
        with self._lock:
            if self._over:
                return
            ends = self.ends
            if changed or self._to_adapt:
                self._to_adapt = False
                for end in ends:
                    end.adapt()
            sides = ([end.key for end in ends if end.writes == writes] for writes in (False, True))
            for reader in self.directory.update(self.graph, *sides):
                self.listen(reader, DDSStatus.DataAvailable)
        self.directory.read()
        for end in ends:
            with suppress(DDSException):  # it was removed meanwhile
                end.serve()
        if changed:
            with self._happened:
                self._happened.notify_all()
            self._changed()


def _delete(*entities: Any) -> None:
    """Delete entities of DDS now: cyclonedds otherwise does it whenever they are collected."""
    for entity in entities:
        entity.__del__()

"""Who else is in the domain: the readers and writers of other nodes, and the names of these nodes.

DDS itself tells every participant about the readers and writers of all others, but knows no nodes: ROS 2
announces them on the topic ``ros_discovery_info``, which ``ros2 node list`` reads. Humble and older releases
write 24 octets for the identity of an endpoint, newer ones 16; these are recognised by the hash of the type
that their endpoints carry.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any, NamedTuple
from uuid import UUID

import cyclonedds.idl.types as idl
from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import InstanceState
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct
from cyclonedds.internal import InvalidSample
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from lrp_jupyter.bridges.ros.dds_qos import reading, type_hash_of
from lrp_jupyter.bridges.ros.names import GraphNames

_AT_ONCE = 100  # samples
_TYPE = re.compile(r"(\w+)::msg::dds_::(\w+)_$")
_NODES = "ros_discovery_info"
_OURS = ("rt/", _NODES)
_NODES_HASH = "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"
_NODES_QOS = (
    Policy.Reliability.Reliable(duration(milliseconds=10)),
    Policy.Durability.TransientLocal,
    Policy.DataRepresentation(use_cdrv0_representation=True),
)


class Endpoint(NamedTuple):
    """A reader or writer of another participant."""

    key: UUID
    participant: UUID
    topic: str  # on the wire: `rt/odom`
    type: str  # `nav_msgs/Odometry`; empty if it is not a ROS message
    qos: Qos
    writes: bool


class EndpointGraph:
    """The readers and writers of all other participants.

    Owner: one thread updates; any may read.
    """

    def __init__(self, participant: DomainParticipant) -> None:
        self._own = participant.guid
        self._sources = (
            (BuiltinDataReader(participant, BuiltinTopicDcpsPublication), True),
            (BuiltinDataReader(participant, BuiltinTopicDcpsSubscription), False),
        )
        self._endpoints: Mapping[UUID, Endpoint] = {}

    @property
    def readers(self) -> tuple[Any, ...]:
        """What has news when something changes."""
        return tuple(reader for reader, _writes in self._sources)

    def update(self) -> bool:
        """Take what is new; return whether anything changed."""
        found = dict(self._endpoints)
        for reader, writes in self._sources:
            while samples := _take(reader):
                for sample in samples:
                    if sample.sample_info.instance_state != InstanceState.Alive or sample.qos is None:
                        found.pop(sample.key, None)
                    elif sample.participant_key != self._own and sample.topic_name.startswith(_OURS):
                        match = _TYPE.match(sample.type_name)
                        type_ = f"{match[1]}/{match[2]}" if match else ""
                        found[sample.key] = Endpoint(
                            sample.key, sample.participant_key, sample.topic_name, type_, sample.qos, writes
                        )
        changed = found != self._endpoints
        self._endpoints = found
        return changed

    def topics(self) -> dict[str, str]:
        """Return the topics of ROS with their types; a publisher's word counts more than a subscriber's."""
        return {
            end.topic.removeprefix("rt"): end.type
            for end in sorted(self._endpoints.values(), key=lambda end: end.writes)
            if end.topic.startswith("rt/") and end.type and "/_" not in end.topic
        }

    def ends(self, topic: str, writes: bool | None = None) -> list[Endpoint]:
        """Return the endpoints of a topic, named as on the wire; only writers, or only readers, if asked."""
        return [
            end
            for end in self._endpoints.values()
            if end.topic == topic and (writes is None or end.writes == writes)
        ]

    def announces(self, end: Endpoint) -> bool:
        """Whether the participant of an endpoint announces its nodes."""
        return any(each.participant == end.participant for each in self.ends(_NODES, writes=True))

    def is_whole(self) -> bool:
        """Whether readers and writers of each participant are known: a node of ROS 2 has both."""
        ends = self._endpoints.values()
        return {end.participant for end in ends if end.writes} == {
            end.participant for end in ends if not end.writes
        }

    def __len__(self) -> int:
        return len(self._endpoints)


class NodeDirectory:
    """The announcements of nodes: this one's, and those of the others.

    Owner: the thread that updates the graph.
    """

    def __init__(self, participant: DomainParticipant, names: GraphNames) -> None:
        self._participant, self._own = participant, names
        self._octets = 0  # of an identity; 0: no node was announced yet
        self._reader: Any = None
        self._writer: Any = None
        self._announced: Any = None
        self._names: Mapping[UUID, tuple[tuple[str, frozenset[UUID]], ...]] = {}

    def update(
        self, graph: EndpointGraph, readers: Iterable[UUID], writers: Iterable[UUID]
    ) -> tuple[Any, ...]:
        """Announce this node with its readers and writers; return the readers that are new."""
        others = graph.ends(_NODES)
        if is_new := bool(others) and not self._octets:
            self._octets = 16 if any(type_hash_of(end.qos) for end in others) else 24
            self._open()
        if self._octets:
            self._announce(readers, writers)
        return (self._reader,) if is_new else ()

    def _open(self) -> None:
        user_data = (Policy.Userdata(f"typehash={_NODES_HASH};".encode()),) if self._octets == 16 else ()
        topic = Topic(self._participant, _NODES, _announcement(self._octets))
        self._writer = DataWriter(
            self._participant, topic, Qos(*_NODES_QOS, *user_data, Policy.History.KeepLast(1))
        )
        self._reader = DataReader(
            self._participant, topic, Qos(*_NODES_QOS, *user_data, Policy.History.KeepAll)
        )

    def _announce(self, readers: Iterable[UUID], writers: Iterable[UUID]) -> None:
        kind = _announcement(self._octets)
        ids = (list(map(self._identity, ends)) for ends in (readers, writers))
        node = _node(self._octets)(self._own.namespace, self._own.node, *ids)
        announced = kind(self._identity(self._participant.guid), [node])
        if announced != self._announced:
            self._announced = announced
            self._writer.write(announced)

    def _identity(self, key: UUID) -> Any:
        return _identity(self._octets)(list(key.bytes.ljust(self._octets, b"\0")))

    def read(self) -> None:
        """Take what other nodes announce."""
        if self._reader is None:
            return
        names = dict(self._names)
        while samples := self._reader.take(_AT_ONCE):
            for sample in samples:
                if not isinstance(sample, InvalidSample):
                    names[_key(sample.gid)] = tuple(
                        (
                            f"{node.node_namespace.rstrip('/')}/{node.node_name}",
                            frozenset(map(_key, (*node.reader_gid_seq, *node.writer_gid_seq))),
                        )
                        for node in sample.node_entities_info_seq
                    )
        self._names = names

    def name_of(self, end: Endpoint) -> str:
        """Return the name of the node that has an endpoint; empty while it is not known."""
        nodes = self._names.get(end.participant, ())
        return next((name for name, keys in nodes if end.key in keys), "")


def _take(reader: Any) -> list[Any]:
    with reading:
        samples: list[Any] = reader.take(_AT_ONCE)
        return samples


def _key(gid: Any) -> UUID:
    return UUID(bytes=bytes(gid.data[:16]))


# -- rmw_dds_common's messages, for both lengths of an identity -----------------------------------


@cache
def _identity(octets: int) -> Any:
    return make_idl_struct("Gid_", "rmw_dds_common.msg.dds_.Gid_", {"data": idl.array[idl.uint8, octets]})


@cache
def _node(octets: int) -> Any:
    identities = idl.sequence[_identity(octets)]
    fields = {"node_namespace": str, "node_name": str}
    return make_idl_struct(
        "NodeEntitiesInfo_",
        "rmw_dds_common.msg.dds_.NodeEntitiesInfo_",
        {**fields, "reader_gid_seq": identities, "writer_gid_seq": identities},
    )


@cache
def _announcement(octets: int) -> Any:
    return make_idl_struct(
        "ParticipantEntitiesInfo_",
        "rmw_dds_common.msg.dds_.ParticipantEntitiesInfo_",
        {"gid": _identity(octets), "node_entities_info_seq": idl.sequence[_node(octets)]},
    )

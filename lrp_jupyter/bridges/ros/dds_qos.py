"""Quality of service: what a subscription asks for, what a command offers, and where two sides disagree.

In DDS a reader and a writer of one topic meet only if the writer offers at least what the reader asks for.
So a subscription asks for what all publishers of its topic offer, and no more: sensors are often best
effort, and a latched topic keeps its last message for those who come later. A command is delivered to who
listens now, in order, and never to a subscriber that comes later.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Sequence
from typing import Any

from cyclonedds.qos import Policy, Qos
from cyclonedds.util import duration

_BLOCKED = duration(milliseconds=10)  # that a command may wait for room; nothing else of Python runs then
_ANNOUNCED = 100  # messages
_HASH = b"typehash="
_NODE = b"node="  # not of ROS 2, where a node announces its name only to others that do

reading = threading.Lock()
"""To be held where cyclonedds reads policies: it does that into variables that all threads share."""


def command_qos(type_hash: str, node: str = "") -> Qos:
    """Return what a publisher offers: a new command replaces one that was not delivered yet."""
    return Qos(
        Policy.Reliability.Reliable(_BLOCKED),
        Policy.Durability.Volatile,
        Policy.History.KeepLast(1),
        *_common(type_hash, node),
    )


def announcing_qos(type_hash: str, keeps: int) -> Qos:
    """Return what a publisher offers that keeps its last messages for subscribers that come later.

    One that is slow misses messages only if more than a hundred wait for it.
    """
    return Qos(
        Policy.Reliability.Reliable(_BLOCKED),
        Policy.Durability.TransientLocal,
        Policy.History.KeepLast(max(keeps, _ANNOUNCED)),
        Policy.DurabilityService(0, Policy.History.KeepLast(keeps), -1, -1, -1),
        *_common(type_hash),
    )


def reading_qos(offers: Sequence[Qos], type_hash: str, most: int = 1) -> Qos:
    """Return what a subscription asks for, given what the publishers offer; without any, the least.

    `most`: how many messages wait until they are taken; the newest are kept.
    """
    reliable = _all(offers, Policy.Reliability, Policy.Reliability.Reliable)
    kept = _all(offers, Policy.Durability, *_DURABILITY[1:])
    exclusive = _all(offers, Policy.Ownership, Policy.Ownership.Exclusive)
    return Qos(
        Policy.Reliability.Reliable(_BLOCKED) if reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if kept else Policy.Durability.Volatile,
        Policy.Ownership.Exclusive if exclusive else Policy.Ownership.Shared,
        Policy.LatencyBudget(max((offer[Policy.LatencyBudget].budget for offer in offers), default=0)),
        Policy.History.KeepLast(most),
        *_common(type_hash),
    )


def qos_of(entity: Any) -> Qos:
    """Return all policies of a reader or writer, those that were not set included."""
    with reading:
        found: Qos = entity.get_qos()
        return found


def disagreements(offered: Qos, asked: Qos) -> list[str]:
    """Return the names of the policies because of which a writer and a reader do not meet."""
    found = [
        name
        for name, (policy, levels) in _LEVELS.items()
        if _level(offered[policy], levels) < _level(asked[policy], levels)
    ]
    found += [
        name
        for name, (policy, field) in _PERIODS.items()
        if getattr(offered[policy], field) > getattr(asked[policy], field)
    ]
    if _level(offered[Policy.Ownership], _OWNERSHIP) != _level(asked[Policy.Ownership], _OWNERSHIP):
        found.append("ownership")
    if not _partitions(offered) & _partitions(asked):
        found.append("partition")
    return list(dict.fromkeys(found))


def type_hash_of(qos: Qos) -> str:
    """Return the hash of the type that an endpoint carries since ROS 2 Iron; else an empty text."""
    return _carried(qos, _HASH)


def node_of(qos: Qos) -> str:
    """Return the name of the node that an endpoint itself carries; else an empty text."""
    return _carried(qos, _NODE)


def _carried(qos: Qos, key: bytes) -> str:
    data = qos[Policy.Userdata].data if Policy.Userdata in qos else b""
    return next((part.removeprefix(key).decode() for part in data.split(b";") if part.startswith(key)), "")


def _common(type_hash: str, node: str = "") -> Iterable[Any]:
    yield Policy.DataRepresentation(use_cdrv0_representation=True)
    name = _NODE + node.encode() + b";" if node else b""
    yield Policy.Userdata(_HASH + type_hash.encode() + b";" + name)


_DURABILITY = (
    Policy.Durability.Volatile,
    Policy.Durability.TransientLocal,
    Policy.Durability.Transient,
    Policy.Durability.Persistent,
)
_OWNERSHIP = (Policy.Ownership.Shared, Policy.Ownership.Exclusive)
_LEVELS: dict[str, tuple[Any, Sequence[Any]]] = {
    "reliability": (Policy.Reliability, (Policy.Reliability.BestEffort, Policy.Reliability.Reliable)),
    "durability": (Policy.Durability, _DURABILITY),
    "liveliness": (
        Policy.Liveliness,
        (Policy.Liveliness.Automatic, Policy.Liveliness.ManualByParticipant, Policy.Liveliness.ManualByTopic),
    ),
    "destination order": (
        Policy.DestinationOrder,
        (Policy.DestinationOrder.ByReceptionTimestamp, Policy.DestinationOrder.BySourceTimestamp),
    ),
    "presentation": (
        Policy.PresentationAccessScope,
        (
            Policy.PresentationAccessScope.Instance,
            Policy.PresentationAccessScope.Topic,
            Policy.PresentationAccessScope.Group,
        ),
    ),
}
_PERIODS: dict[str, tuple[Any, str]] = {
    "deadline": (Policy.Deadline, "deadline"),
    "latency budget": (Policy.LatencyBudget, "budget"),
    "liveliness": (Policy.Liveliness, "lease_duration"),
}


def _level(policy: Any, levels: Sequence[Any]) -> int:
    """Return the position of a policy; some are values and some are classes of values."""
    return next(
        n for n, level in enumerate(levels) if policy == level or type(policy) in (level, type(level))
    )


def _all(offers: Sequence[Qos], policy: Any, *levels: Any) -> bool:
    return bool(offers) and all(offer[policy] in levels or type(offer[policy]) in levels for offer in offers)


def _partitions(qos: Qos) -> set[str]:
    return set(qos[Policy.Partition].partitions) if Policy.Partition in qos else {""}

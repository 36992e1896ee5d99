"""Parameters as readings: of the parameter server of ROS 1, and of the nodes of ROS 2.

They are asked for again and again, and a change is seen when the next answer comes.

Paper: §7.1 (what is read from `robot`).
"""

from __future__ import annotations

import xmlrpc.client
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from lrp_jupyter.bridges.ros.types import ReceivedMessage
from lrp_jupyter.errors import did_you_mean

_FIELDS = (
    *("", "bool_value", "integer_value", "double_value", "string_value", "byte_array_value"),
    *("bool_array_value", "integer_array_value", "double_array_value", "string_array_value"),
)
"""The fields of ``rcl_interfaces/ParameterValue``, by the number of the type that is set."""


class ParameterValues(NamedTuple):
    """What is known of some parameters; one that is in neither is being asked for.

    `values`: as ROS tells them.
    `missing`: why there is no value, a sentence.
    """

    values: Mapping[str, Any] = {}
    missing: Mapping[str, str] = {}


def missing_parameter(name: str, known: Iterable[str]) -> str:
    """Return the sentence about a parameter that is not set, given the names of those that are."""
    return f"There is no parameter `{name}`.{did_you_mean(name, known)}"


def missing_node(name: str, services: Iterable[str]) -> str:
    """Return the sentence about a parameter of ROS 2 whose node is not there; empty if it is there.

    `services`: the live ones.
    """
    node, _, inner = name.partition(":")
    nodes = [each.removesuffix("/get_parameters") for each in services if each.endswith("/get_parameters")]
    if not inner:
        return f"In ROS 2, a parameter is one of a node: write `/node:{node[1:]}`."
    return "" if node in nodes else f"There is no node `{node}` with parameters.{did_you_mean(node, nodes)}"


def value_in(answer: Any) -> Any:
    """Return the value in a ``rcl_interfaces/ParameterValue``, by its fields; None: it is not set."""

    def part(name: str) -> Any:
        return answer.get(name) if isinstance(answer, Mapping) else getattr(answer, name, None)

    number = part("type") or 0
    value = part(_FIELDS[number]) if 0 < number < len(_FIELDS) else None
    return list(value) if number > 4 and value is not None and not isinstance(value, str) else value


def as_reading(value: Any, name: str) -> Any:
    """Return a value that does not change: a list becomes a tuple, and a group has its members as fields."""
    if isinstance(value, Mapping):
        members = {key: each for key, each in value.items() if key.isidentifier() and key[0] != "_"}
        contents = {"__slots__": tuple(members), "_type": name}
        kind: type[ReceivedMessage] = type("ParameterGroup", (ReceivedMessage,), contents)
        return kind(*(as_reading(each, f"{name}/{key}") for key, each in members.items()))
    if isinstance(value, (list, tuple)):
        return tuple(as_reading(each, name) for each in value)
    if isinstance(value, xmlrpc.client.Binary):
        return bytes(value.data)
    return value if isinstance(value, (bool, int, float, str, bytes)) else str(value)

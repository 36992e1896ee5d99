"""The names of ROS's graph, as a node resolves them.

A name is global (``/odom``), relative to the namespace of the node (``odom``), or private to the node
(``~odom``, in ROS 2 also ``~/odom``). A remapping rule ``from:=to`` replaces a name; both sides are resolved
before they are compared, so ``cmd_vel:=/base/cmd_vel`` is also meant for a topic that is written in full.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterable, Mapping

from lrp_jupyter.errors import BridgeError

_NAME = re.compile(r"(/|~/?)?[A-Za-z]\w*(/[A-Za-z_]\w*)*", re.ASCII)
_PATH = re.compile(r"[A-Za-z_]\w*(/[A-Za-z_]\w*)*", re.ASCII)
_BASE = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_RULE = "Write `from:=to`, as in `cmd_vel:=/base/cmd_vel`."


def is_name(text: str) -> bool:
    """Return whether a text is the name of a topic, an action, a service or a parameter."""
    return bool(_NAME.fullmatch(text))


class GraphNames:
    """The name of a node, and what other names mean to it.

    `node`: its base name; None: one that begins with `stem` and that no other node has.
    `namespace`: where it is; None: ``ROS_NAMESPACE`` of the environment, or the root.
    `rules`: for remapping: a text of them, separated by spaces or commas; such texts; or a mapping.
    """

    def __init__(
        self,
        node: str | None = None,
        namespace: str | None = None,
        rules: str | Iterable[str] | Mapping[str, str] = (),
        stem: str = "lrp",
    ) -> None:
        self.is_anonymous = node is None
        if node is None:
            node = f"{stem}_{os.getpid()}_{time.time_ns() // 1_000_000}"
        if not _BASE.fullmatch(node):
            remedy = " Name its place as `namespace`." if "/" in node else ""
            raise BridgeError(
                f"`node`: `{node}` is not the name of a node. Use letters, digits and `_`.{remedy}"
            )
        self.node = node
        place = os.environ.get("ROS_NAMESPACE", "") if namespace is None else namespace
        path = place.strip().strip("/")
        if path and not _PATH.fullmatch(path):
            source = "`ROS_NAMESPACE`" if namespace is None else "`namespace`"
            raise BridgeError(f"{source}: `{place}` is not a namespace. Write one like `/robot1`.")
        self.namespace = f"/{path}"
        pairs = [(self._expand(old), self._expand(new)) for old, new in map(_checked, _pairs(rules))]
        self.remappings: Mapping[str, str] = dict(pairs)

    @property
    def full(self) -> str:
        """The name of the node, with its namespace."""
        return f"{self.namespace.rstrip('/')}/{self.node}"

    def resolve(self, name: str) -> str:
        """Return the global name that a name means."""
        full = self._expand(name)
        return self.remappings.get(full, full)

    def _expand(self, name: str) -> str:
        if name.startswith("/"):
            return name
        if name.startswith("~"):
            return f"{self.full}/{name[1:].lstrip('/')}"
        return f"{self.namespace.rstrip('/')}/{name}"


def _pairs(rules: str | Iterable[str] | Mapping[str, str]) -> list[tuple[str, str]]:
    if isinstance(rules, Mapping):
        return [*rules.items()]
    texts = [rules] if isinstance(rules, str) else rules
    found = []
    for rule in (part for text in texts for part in re.split(r"[\s,]+", text) if part):
        old, mark, new = rule.partition(":=")
        if not mark:
            raise BridgeError(f"`{rule}` is not a remapping rule. {_RULE}")
        found.append((old, new))
    return found


def _checked(pair: tuple[str, str]) -> tuple[str, str]:
    for name in pair:
        if not is_name(name):
            raise BridgeError(f"`{':='.join(pair)}`: `{name}` is not a name in ROS. {_RULE}")
    return pair

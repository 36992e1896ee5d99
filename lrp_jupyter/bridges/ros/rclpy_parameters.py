"""ParameterValues by rclpy: their nodes are asked, and the answers come on the executor's thread."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from lrp_jupyter.bridges.ros.parameters import ParameterValues, missing_node, missing_parameter, value_in
from lrp_jupyter.errors import ended, sentence_of


class RclpyParameters:
    """The parameters of other nodes that are followed.

    `getting`, `listing`: the classes of the services ``GetParameters`` and ``ListParameters``.
    `changed`: called when an answer is another one than before.
    """

    def __init__(self, node: Any, getting: Any, listing: Any, changed: Callable[[], None]) -> None:
        self._node, self._changed = node, changed
        self._kinds = {"get": getting, "list": listing}
        self._clients: dict[str, Any] = {}
        self._open: set[str] = set()  # what is being asked for
        self._told: dict[str, tuple[Any, str]] = {}  # the values, and why one is missing

    def ask(self, wanted: Iterable[str]) -> ParameterValues:
        """Ask for all, and return what is known."""
        services = [name for name, _types in self._node.get_service_names_and_types()]
        for name in wanted:
            node, _, inner = name.partition(":")
            if missing := missing_node(name, services):
                self._told[name] = None, missing
            elif name not in self._open:
                self._call("get", node, partial(self._has_value, name, node), name, names=[inner])
        told = dict(self._told)
        return ParameterValues(
            {name: value for name, (value, missing) in told.items() if not missing},
            {name: missing for name, (_, missing) in told.items() if missing},
        )

    def leave(self) -> None:
        """Destroy the clients."""
        clients, self._clients = self._clients, {}
        for client in clients.values():
            self._node.destroy_client(client)

    def _call(self, what: str, node: str, then: Callable[[Any], None], name: str, **fields: Any) -> None:
        service = f"{node}/{what}_parameters"
        if service not in self._clients:
            self._clients[service] = self._node.create_client(self._kinds[what], service)
        request = self._kinds[what].Request()
        for field, value in fields.items():
            setattr(request, field, value)
        self._open.add(name)
        self._clients[service].call_async(request).add_done_callback(partial(self._answered, name, then))

    def _answered(self, name: str, then: Callable[[Any], None], future: Any) -> None:
        self._open.discard(name)
        try:
            then(future.result())
        except Exception as error:  # of the middleware, or the answer has another form
            self._tell(name, None, ended(sentence_of(error)))

    def _has_value(self, name: str, node: str, answer: Any) -> None:
        value = value_in(answer.values[0]) if answer.values else None
        if value is None:
            self._call("list", node, partial(self._has_names, name, node), name)
        else:
            self._tell(name, value)

    def _has_names(self, name: str, node: str, answer: Any) -> None:
        self._tell(name, None, missing_parameter(name, [f"{node}:{each}" for each in answer.result.names]))

    def _tell(self, name: str, value: Any, missing: str = "") -> None:
        before, self._told[name] = self._told.get(name), (value, missing)
        if repr(before) != repr((value, missing)):
            self._changed()

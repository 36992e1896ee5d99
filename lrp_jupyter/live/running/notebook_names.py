"""The names of a notebook that blocks read, such as a threshold or a function of another cell.

The user may assign them at any time. A change of a name that the program uses is an input of the run: it is
detected before the next tick or command, so that repeating a tick, or asking about it, gives the value that
the name had then.
"""

from __future__ import annotations

import builtins
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any

from lrp_jupyter.live.running.checkpoints import COPIED, PLAIN
from lrp_jupyter.live.running.inbox import Command

ABSENT = object()
"""Stands for the value of a name that does not exist."""


@dataclass(frozen=True, slots=True, eq=False)
class ChangeNames(Command):
    """Assign or delete names of the namespace, as the user does; a name is missing where it is absent."""

    before: Mapping[str, object]
    after: Mapping[str, object]

    @property
    def names(self) -> list[str]:
        """The names, in order."""
        return sorted(self.before.keys() | self.after.keys())

    def apply(self, loop: Any) -> None:
        """See :class:`Command`."""
        values = {name: loop.record.restored(value) for name, value in self.after.items()}
        loop.record.names.assign({name: values.get(name, ABSENT) for name in self.names})

    def kept(self, record: Any) -> tuple[Command, int]:
        """See :class:`Command`; mutable values are copied."""
        after = {
            name: record.kept(value) if type(value) in COPIED else value for name, value in self.after.items()
        }
        return replace(self, after=after), 0


class WatchedNames:
    """The names that a program uses or has used, with their last known values; owned by the loop."""

    def __init__(self, namespace: dict[str, Any]) -> None:
        self._namespace = namespace
        self.values: dict[str, object] = {}

    def watch(self, names: Iterable[str]) -> None:
        """Watch these names in addition."""
        for name in names:
            self.values.setdefault(name, self._namespace.get(name, ABSENT))

    def change(self) -> ChangeNames | None:
        """Return the change since the last call, if there is any."""
        get = self._namespace.get
        for name, value in self.values.items():
            if get(name, ABSENT) is not value:
                return self._change()
        return None

    def _change(self) -> ChangeNames | None:
        get, before = self._namespace.get, self.values
        self.values = {name: get(name, ABSENT) for name in before}
        differing = [name for name, value in self.values.items() if not _is_same(before[name], value)]
        if not differing:
            return None
        return ChangeNames(_present(before, differing), _present(self.values, differing))

    def assign(self, values: Mapping[str, object]) -> None:
        """Assign names in the namespace, and delete those that are `ABSENT`; this counts as a change."""
        for name, value in values.items():
            if value is ABSENT:
                self._namespace.pop(name, None)
            else:
                self._namespace[name] = value

    def begin(self, values: Mapping[str, object]) -> None:
        """Assign names in the namespace at the beginning of a run; this does not count as a change."""
        self.assign(values)
        self.values |= values

    def undo(self, changes: Iterable[ChangeNames]) -> None:
        """Forget changes that are no longer kept, so that they are detected again."""
        self.values |= _before(changes)

    def namespace_before(self, changes: Iterable[ChangeNames]) -> dict[str, Any]:
        """Return the namespace as it was before the given most recent changes."""
        names = {**self._namespace.copy(), **self.values, **_before(changes)}
        return {name: value for name, value in names.items() if value is not ABSENT}

    def value_before(self, name: str, changes: Iterable[ChangeNames]) -> object:
        """Return the value of a name before the given most recent changes."""
        for change in changes:
            if name in change.before or name in change.after:
                return change.before.get(name, ABSENT)
        return self.values.get(name, self._namespace.get(name, ABSENT))


def random_module(namespace: Mapping[str, Any]) -> ModuleType:
    """Return the module that `import random` gives to the blocks of a namespace."""
    module: ModuleType = _import_of(namespace)("random")
    return module


def with_modules(namespace: Mapping[str, Any], *modules: ModuleType) -> dict[str, Any]:
    """Return a copy of a namespace whose blocks import these modules instead of those with the same names.

    A name that means such a module, or something of it, means what the new one has.
    """
    find, own = _import_of(namespace), {module.__name__: module for module in modules}
    instead: dict[int, Any] = {}
    for module in modules:
        current = find(module.__name__)
        instead[id(current)] = module
        instead |= {id(old): vars(module)[name] for name, old in vars(current).items()}

    def own_import(name: str, *arguments: Any, **keywords: Any) -> Any:
        return own[name] if name in own else find(name, *arguments, **keywords)

    names = dict(namespace).items()  # other threads may write it
    changed = {name: instead.get(id(value), value) for name, value in names}
    return {**changed, "__builtins__": {**vars(builtins), "__import__": own_import}}


def _import_of(namespace: Mapping[str, Any]) -> Callable[..., Any]:
    """Return the function with which the blocks of a namespace import."""
    own = namespace.get("__builtins__")
    find: Callable[..., Any] = own.get("__import__", __import__) if isinstance(own, dict) else __import__
    return find


def _before(changes: Iterable[ChangeNames]) -> dict[str, object]:
    """Return the values of changed names before the first change of each."""
    values: dict[str, object] = {}
    for change in changes:
        for name in change.names:
            values.setdefault(name, change.before.get(name, ABSENT))
    return values


def _is_same(one: object, other: object) -> bool:
    """Return whether two values of a name are the same, even if recomputed."""
    return one is other or (type(one) is type(other) and type(one) in PLAIN and one == other)


def _present(values: Mapping[str, object], names: Iterable[str]) -> dict[str, object]:
    return {name: values[name] for name in names if values[name] is not ABSENT}

"""Cells: the variables of a running program, as its blocks see them and as the journal restores them.

A block writes variables with instructions in its code, so they are known without running it. A function
defined inside a block, however, may be called at any time by any code, so the variables that it writes are
compared after every tick instead. So are all variables for an observer, and what it sees of a list that is
changed in place are the parts that :func:`parts_of` returns.
"""

from __future__ import annotations

import dis
from array import array
from collections import Counter, OrderedDict, defaultdict, deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from math import inf
from operator import is_
from types import CellType, CodeType, NoneType
from typing import Any, ClassVar, NamedTuple

from lrp_jupyter.interpreter.trace_events import UNSET


@dataclass(slots=True, eq=False)
class Slot:
    """An existing variable: its cell, and its value when it was last compared.

    `captured`: the variables to which functions in its initialiser referred when that ran.
    `computed`, `assigned`: when its initialiser ran, and when a value was assigned by hand: the time in
        seconds, and the number of assignments in the run until then, because time may stand still.
    """

    NEVER: ClassVar[tuple[float, int]] = (-inf, 0)

    cell: CellType
    last: object = UNSET  # up to date only if it is compared: it is leaked, or the run has observers
    parts: list[object] | None = None  # those of `last`, if it can change in place
    leaked: bool = False  # whether a function defined in a block can write it, even after that block's end
    captured: tuple[Slot, ...] = ()
    computed: tuple[float, int] = NEVER
    assigned: tuple[float, int] = NEVER

    @property
    def is_computed(self) -> bool:
        """Whether its initialiser has ever run without a fault."""
        return self.computed != Slot.NEVER

    def keep(self, value: object) -> None:
        """Store a value for the next comparison."""
        self.last, self.parts = value, parts_of(value)

    def forget(self, now: float) -> None:
        """Forget assignments and computations later than `now`, because they were undone."""
        self.computed = min(self.computed, (now, 0))
        if self.assigned[0] > now:
            self.assigned = Slot.NEVER


def content(cell: CellType) -> object:
    """Return the value in a cell, or UNSET."""
    try:
        return cell.cell_contents
    except ValueError:
        return UNSET


def put(cell: CellType, value: object) -> None:
    """Put a value into a cell, or empty it for UNSET."""
    if value is not UNSET:
        cell.cell_contents = value
    elif content(cell) is not UNSET:
        del cell.cell_contents


@lru_cache(maxsize=20_000)
def captures_of(code: CodeType) -> tuple[str, ...]:
    """Return the free variables to which functions, classes and comprehensions inside a code object refer."""
    inside = [each.co_freevars for each in code.co_consts if isinstance(each, CodeType)]
    names = frozenset[str]().union(*inside)
    return tuple([name for name in code.co_freevars if name in names])


def same(old: object, new: object) -> bool:
    """Return whether two values are equal scalars of one type; runs no foreign code."""
    return type(old) is type(new) and id(type(new)) in _SCALARS and old == new


def same_parts(old: list[object] | None, new: list[object] | None) -> bool:
    """Return whether the parts of a value are the same objects as before, or equal scalars."""
    if old is None or new is None:
        return old is new
    return len(old) == len(new) and (all(map(is_, old, new)) or all(map(_is_or_same, old, new)))


def _is_or_same(old: object, new: object) -> bool:
    return old is new or same(old, new)


def parts_of(value: object) -> list[object] | None:
    """Return what is compared of a value that can change in place: its size, its first items and theirs.

    None for a value of any other type than those of Python's collections. The work is bounded, and runs no
    foreign code.
    """
    if id(type(value)) not in _READERS:
        return None
    parts: list[object] = []
    return parts if _collect(value, parts, _DEEPEST) else None


def _collect(value: object, parts: list[object], depth: int) -> bool:
    """Add the parts of a collection; return whether it can change in place."""
    kind = type(value)
    can_change = kind is not tuple
    items = _READERS[id(kind)](value)
    parts.append(len(value))  # type: ignore[arg-type]
    parts += items
    if depth and kind is not set and not _SCALARS.issuperset(map(id, map(type, items))):
        for item in items:
            if len(parts) >= _MOST:
                break
            if id(type(item)) in _READERS and _collect(item, parts, depth - 1):
                can_change = True
    return can_change


def _first(value: Any) -> list[object]:
    return [*islice(value, _MOST)]


def _of_dict(value: Any) -> list[object]:
    return [*islice(value, _MOST), *islice(dict.values(value), _MOST)]


def _of_set(value: Any) -> list[object]:
    return sorted(value, key=id) if len(value) <= _MOST else []  # the order of a set may be any


_MOST, _DEEPEST = 200, 2
_SCALARS = frozenset(map(id, (int, float, bool, str, bytes, complex, NoneType)))
_READERS: dict[int, Callable[[Any], list[object]]] = {
    **dict.fromkeys(map(id, (list, tuple, deque, bytearray, array)), _first),
    **dict.fromkeys(map(id, (dict, OrderedDict, defaultdict, Counter)), _of_dict),
    id(set): _of_set,
}
"""How to read collections, by the id of their type: a metaclass may define `==`."""


class Writes(NamedTuple):
    """The free variables that a code object writes."""

    own: tuple[str, ...]  # that it writes itself while it runs
    inner: frozenset[str]  # that functions, classes and comprehensions inside it write, possibly later


_EXTENDED = dis.opmap["EXTENDED_ARG"]
_WRITING = frozenset({dis.opmap["STORE_DEREF"], dis.opmap["DELETE_DEREF"]})


@lru_cache(maxsize=20_000)
def writes_of(code: CodeType) -> Writes:
    """Return the free variables that a code object can write."""
    raw = code.co_code
    own: set[str] = set()
    if not _WRITING.isdisjoint(raw[::2]):
        # `dis` would take 20 times as long. Free variables are numbered after all others.
        first = len({*code.co_varnames, *code.co_cellvars})
        above = 0
        for operation, argument in zip(raw[::2], raw[1::2], strict=True):
            number = above | argument
            above = number << 8 if operation == _EXTENDED else 0
            if operation in _WRITING and number >= first:
                own.add(code.co_freevars[number - first])
    inner: set[str] = set()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            inside = writes_of(constant)
            inner |= inside.inner.union(inside.own)
    return Writes(tuple(sorted(own)), frozenset(inner.intersection(code.co_freevars)))

"""Cells: the variables of a running program, as its blocks see them and as the journal restores them.

A block writes variables with instructions in its code, so they are known without running it. A function
defined inside a block, however, may be called at any time by any code, so the variables that it writes are
compared after every tick instead.
"""

from __future__ import annotations

import dis
from dataclasses import dataclass
from functools import lru_cache
from math import inf
from types import CellType, CodeType
from typing import ClassVar, NamedTuple

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
    leaked: bool = False  # whether a function defined in a block can write it, even after that block's end
    captured: tuple[Slot, ...] = ()
    computed: tuple[float, int] = NEVER
    assigned: tuple[float, int] = NEVER

    @property
    def is_computed(self) -> bool:
        """Whether its initialiser has ever run without a fault."""
        return self.computed != Slot.NEVER

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
def captures_of(code: CodeType) -> frozenset[str]:
    """Return the free variables to which functions, classes and comprehensions inside a code object refer."""
    inside = [each.co_freevars for each in code.co_consts if isinstance(each, CodeType)]
    return frozenset(code.co_freevars).intersection(*[frozenset().union(*inside)])


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

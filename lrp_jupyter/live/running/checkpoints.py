"""Checkpoints of a session: snapshots taken while it runs, from which any later moment can be reached again.

They are taken rarely enough to cost only a small share of the run's time, and older ones are thinned out, so
that an hour of a run takes no more memory than ten minutes.
"""

from __future__ import annotations

import dis
from collections import deque
from collections.abc import Callable
from functools import lru_cache
from time import perf_counter
from types import CodeType, NoneType
from typing import Any, NamedTuple

from lrp_jupyter.bridges.tasks import TasksMoment
from lrp_jupyter.interpreter.linker import Plan
from lrp_jupyter.interpreter.snapshot import Snapshot

_SPACING = 200  # minimum ticks between two checkpoints
_SHARE = 60  # a checkpoint may take one sixtieth of the time
_MOST = 60  # maximum number of checkpoints
_BYTES = 50_000_000  # maximum bytes of values
_READING = ("LOAD_GLOBAL", "LOAD_NAME", "LOAD_FROM_DICT_OR_GLOBALS")
PLAIN = (int, float, complex, bool, str, bytes, NoneType)
"""The types of immutable values."""
COPIED = (*PLAIN, tuple, frozenset, list, dict, set, bytearray, deque)
"""The types of objects in a namespace that are copied; other objects are shared."""


class SessionCheckpoint(NamedTuple):
    """A moment of a session from which a copy can continue.

    `snapshot`: the interpreter, and the objects of the namespace that are copied.
    `inputs`: the number of inputs up to then.
    `moment`, `tasks`: those of the bridge.
    """

    snapshot: Snapshot
    time: float
    due: float
    rate: float
    running: bool
    inputs: int
    moment: object
    tasks: TasksMoment
    random: tuple[Any, ...]
    armed: bool
    rewound: bool = False
    """Whether the run had just been rewound to it."""

    @property
    def tick(self) -> int:
        """The number of completed ticks."""
        return self.snapshot.tick


class Checkpoints:
    """The checkpoints of a run, in order."""

    def __init__(self) -> None:
        self.all: list[SessionCheckpoint] = []
        self.due = 0
        """The earliest tick after which the next one is taken."""
        self._rested = 0.0  # earliest wall time of the next one

    def add(self, take: Callable[[], SessionCheckpoint], rewound: bool = False) -> SessionCheckpoint | None:
        """Take a checkpoint and return it, unless the last is too recent and the run was not `rewound`."""
        start = perf_counter()
        if start < self._rested and not rewound:
            self.due += _SPACING
            return None
        checkpoint = take()._replace(rewound=rewound)
        self.all.append(checkpoint)
        end = perf_counter()
        self._rested = end + _SHARE * (end - start)
        self.due = checkpoint.tick + _SPACING
        while len(self.all) > 2 and (len(self.all) > _MOST or self._bytes > _BYTES):
            self._thin_out()
        return checkpoint

    @property
    def _bytes(self) -> int:
        return sum(len(each.snapshot.values.data) for each in self.all)

    def _thin_out(self) -> None:
        """Drop the inner checkpoint whose removal leaves the most even spacing."""
        inner = range(1, len(self.all) - 1)
        common = [place for place in inner if not self.all[place].rewound]
        del self.all[min(common or inner, key=self._gap)]

    def _gap(self, place: int) -> int:
        return self.all[place + 1].tick - self.all[place - 1].tick

    def begin(self, tick: int) -> SessionCheckpoint | None:
        """Drop the checkpoints that no tick after this one needs; return the first of the rest."""
        while len(self.all) > 1 and self.all[1].tick <= tick:
            del self.all[0]
        return self.all[0] if self.all else None

    def cut(self, tick: int) -> None:
        """Drop the checkpoints at and after a tick; those at it may contain inputs that are undone."""
        while self.all and self.all[-1].tick >= tick:
            self.all.pop()
        self.due = tick

    def drop(self, inputs: int) -> None:
        """Drop the checkpoints that need a lost input: all inputs up to this number are lost."""
        self.all = [each for each in self.all if each.inputs >= inputs]

    def clear(self) -> None:
        """Drop all."""
        self.all.clear()
        self.due = 0

    def before(self, tick: int, later: float) -> SessionCheckpoint | None:
        """Return the last checkpoint before a tick, or after it without any later input; else the first one.

        `later`: the number of the first input after the tick.
        """
        known = [each for each in self.all if each.tick <= tick]
        clean = (each for each in reversed(known) if each.inputs < later or each.rewound)
        return next(clean, known[0] if known else None)


def names_of(plan: Plan) -> frozenset[str]:
    """Return the global names that the blocks of a program use, such as those of a notebook."""
    codes = (block.code for block in plan.blocks)
    return frozenset().union(*(_globals_of(code) for code in codes if isinstance(code, CodeType)))


def messages_heard(plan: Plan) -> frozenset[str]:
    """Return the readings of messages that the blocks of a program name, such as ``light.new``."""
    codes = (block.code for block in plan.blocks)
    return frozenset().union(*(_news_of(code) for code in codes if isinstance(code, CodeType)))


@lru_cache(maxsize=20_000)
def _news_of(code: CodeType) -> frozenset[str]:
    own = (name for name in code.co_names if name.endswith(".new"))  # see `language.blocks.companions`
    return frozenset(own).union(*(_news_of(each) for each in code.co_consts if isinstance(each, CodeType)))


@lru_cache(maxsize=20_000)
def _globals_of(code: CodeType) -> frozenset[str]:
    """Return the global names that a code object reads, without attributes."""
    own = {each.argval for each in dis.get_instructions(code) if each.opname in _READING}
    inner = (_globals_of(each) for each in code.co_consts if isinstance(each, CodeType))
    return frozenset(own).union(*inner, {"degrees"}.intersection(code.co_freevars))

"""A failed run once more, as a witness: which numbers it used, what they were compared with, what fired.

The text that runs is the program's with calls around its numbers and comparisons, which note a value and
return it. It runs in the process of a worker, as every graded run does.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from lrp_jupyter.errors import Edit, LRPSyntaxError, edited
from lrp_jupyter.grading.attempt import Ended, Job
from lrp_jupyter.interpreter.facts import Fired
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, Span
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.session import Session
from lrp_jupyter.repairs.numbers import Numbers
from lrp_jupyter.runs.rerun import Rerun

_MOST = 1000  # pairs that are kept of a comparison
_READ, _SIDE = "lrp_read_number", "lrp_compared_side"


@dataclass(frozen=True)
class Evidence:
    """What a failed run did.

    `used`: the numbers that were used, by index.
    `compared`: the two sides of each comparison, by its index: different pairs, in order.
    `fired`: the transitions that fired, and `stayed`: for how long each state that was entered was active at
        most; both by path of definition.
    `ended`: why there was no complete run.
    """

    used: frozenset[int] = frozenset()
    compared: Mapping[int, list[tuple[float, float]]] = field(default_factory=dict)
    fired: frozenset[Path] = frozenset()
    stayed: Mapping[Path, float] = field(default_factory=dict)
    ended: str = ""


class _Witness:
    """A job whose last text has the calls in it, and which returns what they noted."""

    def done(self: Any) -> dict[str, Any]:
        """Make the run, and return what was noted."""
        notes = RunNotes()
        noted = replace(self, namespace={**self.namespace, **notes.names})
        ended = noted.outcome(notes.watch).ended
        return {**notes.plain(), "ended": ended}

    def failed(self, ended: Ended, sentence: str, reason: str) -> Evidence:
        """Return what is known of a run that did not come to its end: nothing but that."""
        return Evidence(ended=ended)

    def made(self, data: Any) -> Evidence:
        """Return what was noted, from plain data. Raises ValueError: they do not describe that."""
        try:
            return Evidence(
                frozenset(map(int, data["used"])),
                {
                    int(key): [(float(left), float(right)) for left, right in pairs]
                    for key, pairs in data["compared"].items()
                },
                frozenset(tuple(map(str, path)) for path in data["fired"]),
                {tuple(map(str, path)): float(seconds) for path, seconds in data["stayed"]},
                str(data["ended"]),
            )
        except (TypeError, LookupError, AttributeError, OverflowError) as error:
            raise ValueError("This is not evidence of a run.") from error


@dataclass(frozen=True)
class WitnessJob(_Witness, Job):  # type: ignore[misc]
    """A run of a challenge as a witness."""


@dataclass(frozen=True)
class WitnessRerun(_Witness, Rerun):  # type: ignore[misc]
    """A kept run as a witness."""


class RunNotes:
    """Notes what a program does; in the process of its run."""

    def __init__(self) -> None:
        self._used: set[int] = set()
        self._left: dict[int, object] = {}
        self._pairs: dict[int, dict[tuple[float, float], None]] = {}
        self._fired: set[Path] = set()
        self._stayed: dict[Path, float] = {}
        self._tick = 0

    @property
    def names(self) -> dict[str, Any]:
        """The names that the calls in the text read."""
        return {_READ: self.read, _SIDE: self.side}

    def read(self, index: int, value: Any) -> Any:
        """Note that a number is used, by its index; return it."""
        self._used.add(index)
        return value

    def side(self, index: int, is_right: bool, value: Any) -> Any:
        """Note a side of a comparison, by its index; return it."""
        if not is_right:
            self._left[index] = value
        else:
            left = self._left.get(index)
            pairs = self._pairs.setdefault(index, {})
            if _is_number(left) and _is_number(value) and len(pairs) < _MOST:
                pairs[float(left), float(value)] = None  # type: ignore[arg-type]
        return value

    def watch(self, session: Session) -> None:
        """Note what a tick has brought."""
        now, interpreter = session._loop.timing.now, session.interpreter
        for tick, fact in interpreter.history.told(self._tick + 0.1):
            self._tick = int(tick)
            if isinstance(fact, Fired):
                self._fired.add(fact.transition.path)
        names = resolve(interpreter.program)
        for active in interpreter.active:
            for end in range(2, len(active) + 1, 2):
                state = (*names.defined(active[: end - 1]), active[end - 1])
                seconds = now - (interpreter.entered(active[:end]) or 0.0)
                self._stayed[state] = max(seconds, self._stayed.get(state, 0.0))

    def plain(self) -> dict[str, Any]:
        """Return what was noted, as plain data."""
        return {
            "used": sorted(self._used),
            "compared": {index: list(pairs) for index, pairs in self._pairs.items()},
            "fired": sorted(self._fired),
            "stayed": sorted(self._stayed.items()),
        }


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and abs(value) < 1e12


def with_notes(numbers: Numbers) -> str:
    """Return the text of a program with the calls in it; as it is if that would not be a program."""
    text = numbers.text
    wraps: list[tuple[Span, str, str]] = []
    for index, number in enumerate(numbers.found):
        call = f"{_READ}({index}, "
        if number.is_delay and text[number.span.start - 1] != "[" and number.span == number.shown:
            wraps.append((number.span, f"[{call}", ")]"))
        else:
            wraps += [(span, call, ")") for span in number.reads or (number.span,)]
    for index, each in enumerate(numbers.comparisons):
        wraps.append((each.left, f"{_SIDE}({index}, False, ", ")"))
        wraps.append((each.right, f"{_SIDE}({index}, True, ", ")"))
    noted = _wrapped(text, wraps)
    try:
        parse(noted)
    except LRPSyntaxError:
        return text
    return noted


def _wrapped(text: str, wraps: Iterable[tuple[Span, str, str]]) -> str:
    """Return a text with something before and after each of some ranges, which may be nested."""
    opened, closed = defaultdict[int, str](str), defaultdict[int, str](str)
    for span, before, after in sorted(wraps, key=lambda each: (each[0].start, -each[0].end)):
        opened[span.start] += before
        closed[span.end] = after + closed[span.end]
    return edited(text, [Edit(at, at, closed[at] + opened[at]) for at in {*opened, *closed}])

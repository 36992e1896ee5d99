"""Compare a run with a recorded one, tick by tick, and report the first difference."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from lrp_jupyter.errors import ended
from lrp_jupyter.live.trace import Line, words_of

_TELLING = ("issue", "fired", "forced", "restarted")
"""Events that explain the other events of their tick."""


@dataclass(frozen=True, slots=True)
class FirstDifference:
    """The first difference between a run and its recording.

    `time`: seconds.
    `machine`: the machine in which it occurs; empty if there is none, or it is unknown.
    `recorded`, `now`: the most informative line of the tick that is only in the recording, and only in the
        run.
    """

    tick: int
    time: float
    machine: str
    recorded: Line | None
    now: Line | None

    def __str__(self) -> str:
        where = f", in the machine `{self.machine}`" if self.machine else ""
        head = f"The first difference is at {self.time:g} s (tick {self.tick}){where}."
        recorded, now = self.recorded, self.now
        if recorded is None or now is None:
            only = "Only in the replay" if recorded is None else "Only in the recording"
            return f"{head} {only}: {ended(words_of(recorded or now or {}))}"
        other = {**recorded, "readings": _others(recorded, now)} if "readings" in recorded else recorded
        own = {**now, "readings": _others(now, recorded)} if "readings" in now else now
        return f"{head} Recorded: {ended(words_of(other))} Replay: {ended(words_of(own))}"


class Comparison:
    """Compares the trace of a run with a recorded trace; with values, also variables.

    `other`: whether the program differs from the recorded one: then neither line numbers nor edits count.
    """

    def __init__(self, recorded: Iterable[Line], other: bool = False, has_values: bool = True) -> None:
        self._other = other
        self._left_out = ({"patched"} if other else set()) | (set() if has_values else {"changed"})
        self._recorded = deque(line for line in recorded if self._counts(line))
        self._now: list[Line] = []  # the lines of the current tick
        self._machines: dict[str, str] = {}  # of the states that were entered, by name
        self.difference: FirstDifference | None = None

    def write(self, text: str) -> None:
        """Add a line of the current run."""
        line = json.loads(text)
        if "input" in line or self.difference is not None or not self._counts(line):
            return
        if self._now and self._now[0]["tick"] != line["tick"]:
            self.end_of_tick()
        self._now.append(line)

    def end_of_tick(self, is_whole: bool = True) -> None:
        """Compare the lines of the current tick; if it is not complete, as many as there are."""
        now, self._now = self._now, []
        recorded: list[Line] = []
        while (
            self._recorded
            and now
            and self._recorded[0].get("tick") == now[0]["tick"]
            and (is_whole or len(recorded) < len(now))
        ):
            recorded.append(self._recorded.popleft())
        for line in now:
            if line.get("event") == "entered":
                machine, _, state = line["state"].rpartition("/")
                self._machines[state] = machine
        recorded = _read_in_both(recorded, now)
        if self.difference is None and list(map(self._key, recorded)) != list(map(self._key, now)):
            self._differ(recorded, now)

    def end(self) -> None:
        """Report a recorded line that did not occur."""
        self.end_of_tick()
        if self._recorded and self.difference is None:
            self._differ([self._recorded[0]], [])

    def _counts(self, line: Line) -> bool:
        return line.get("event") not in self._left_out

    def _key(self, line: Line) -> Line:
        return {name: value for name, value in line.items() if name != "line"} if self._other else line

    def _differ(self, recorded: Sequence[Line], now: Sequence[Line]) -> None:
        before, after = self._rest(recorded, now), self._rest(now, recorded)
        if not before and not after:  # the same lines in a different order
            pairs = zip(recorded, now, strict=True)
            one, other = next(pair for pair in pairs if self._key(pair[0]) != self._key(pair[1]))
            before, after = [one], [other]
        was, this = _most_telling(before), _most_telling(after)
        first, *_ = both = [line for line in (was, this) if line is not None]
        machine = next(filter(None, map(self._machine, both)), "")
        self.difference = FirstDifference(first["tick"], first["time"], machine, was, this)

    def _rest(self, lines: Sequence[Line], others: Sequence[Line]) -> list[Line]:
        left = [self._key(line) for line in others]
        rest = []
        for line in lines:
            if (key := self._key(line)) in left:
                left.remove(key)
            else:
                rest.append(line)
        return rest

    def _machine(self, line: Line) -> str:
        if "machine" in line:
            return str(line["machine"])
        if "block" in line:
            return self._machines.get(line["block"].partition(".")[0], "")
        path: str = line.get("state") or line.get("variable") or line.get("element") or ""
        return path.rpartition("/")[0]


def _read_in_both(recorded: list[Line], now: list[Line]) -> list[Line]:
    """Return recorded lines without the readings that are not read now: only a breakpoint had read them."""
    read: set[str] = set().union(*(line.get("readings", ()) for line in now))
    return [
        {**line, "readings": {name: value for name, value in line["readings"].items() if name in read}}
        if "readings" in line and any("readings" in each for each in now)
        else line
        for line in recorded
    ]


def _most_telling(lines: Sequence[Line]) -> Line | None:
    telling = [line for kind in _TELLING for line in lines if line.get("event") == kind]
    return next(iter([*telling, *lines]), None)


def _others(line: Line, other: Line) -> dict[str, Any]:
    others = other.get("readings", {})
    return {name: value for name, value in line["readings"].items() if others.get(name) != value}

"""The search for the smallest change that makes a program pass, within a budget.

Every change is tried in one failed run first; what passes there in others that failed, and what is left in
all runs. Of a number that passes, the range that passes is looked for, to propose a round one inside it.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from itertools import pairwise
from time import perf_counter
from typing import NamedTuple

from lrp_jupyter.errors import Finding
from lrp_jupyter.grading.workers import Halt
from lrp_jupyter.repairs.answer import Repair, Repairs
from lrp_jupyter.repairs.change import Change, Topic
from lrp_jupyter.repairs.judging import Judge, TrialRun
from lrp_jupyter.repairs.numbers import Numbers
from lrp_jupyter.repairs.other_numbers import change_of, distance, doubt_of, nicest, values_of
from lrp_jupyter.repairs.structure import KINDS, Structure
from lrp_jupyter.repairs.witness import Evidence

Progress = Callable[[int, int], object]
"""Called with the number of runs that were made, and of those that are planned so far."""

_FIRST = 0.6  # the share of the budget for the first run
_OTHERS = 2  # further failed runs in which everything that passed the first is tried
_PLACES = 12  # that are tried in all runs
_STEPS = 3  # to each end of a range
_GAP = 0.4  # doublings; between values so far apart another one is tried, if nothing has helped


class Remedy(NamedTuple):
    """A change that helps, and in how many runs; `cost`: how unlikely it is, in doublings of a number."""

    change: Change
    passed: int
    cost: float

    @property
    def rank(self) -> tuple[float, ...]:
        """What is smaller for a better change: one that passes more runs, and then one that is likelier."""
        return -self.passed, self.cost, self.change.topic.number


class Search:
    """One search; `halt` ends it, with what was found until then."""

    def __init__(
        self,
        text: str,
        judge: Judge,
        findings: Sequence[Finding] = (),
        limit: float = 60.0,
        progress: Progress = lambda done, of: None,
        halt: Halt | None = None,
    ) -> None:
        self._text, self._judge, self._findings, self._progress = text, judge, findings, progress
        self._halt = halt or Halt()
        self._limit, self._begin = limit, perf_counter()
        self._passed: dict[TrialRun, bool] = {}
        self._planned = 0
        self._was_cut = False
        self._tried: dict[Topic, None] = {}
        self._values = defaultdict[int, set[float]](set)  # that were tried of each number
        self._doubts = defaultdict[Topic, float](float)  # how far each number is to be doubted
        self._numbers = Numbers(text)

    def run(self) -> Repairs:
        """Search."""
        everything = range(self._judge.runs)
        self._try([TrialRun(self._text, run) for run in everything], math.inf)
        before = self._share(self._text)
        failed = [run for run in everything if not self._passed.get(TrialRun(self._text, run), True)]
        found = self._searched(failed) if failed and not self._halt.done() else []
        needed = max(before + 1, before + (self._judge.runs - before) // 2)
        found = sorted((each for each in found if each.passed >= needed), key=lambda each: each.rank)
        helped = {each.change.topic for each in found}
        vain = [each.number for each in self._tried if each.kind == "number" and each not in helped]
        kinds = Counter(each.kind for each in self._tried)
        return Repairs(
            tuple(self._repair(each.change, each.passed, before) for each in found),
            before,
            self._judge.runs,
            tuple(dict.fromkeys(map(self._numbers.called, vain))),
            {words: kinds[kind] for kind, words in KINDS.items() if kinds[kind]},
            len(self._passed),
            not self._was_cut,
        )

    def _repair(self, change: Change, passed: int, before: int) -> Repair:
        line, text = min(change.lines), change.apply(self._text)
        return Repair(change.subject, line, change.edits, passed, self._judge.runs, before, text)

    def _searched(self, failed: Sequence[int]) -> list[Remedy]:
        first = failed[0]
        evidence = self._judge.witness(self._numbers, first)
        checks = self._checks(failed)
        return self._helpful(self._changes(evidence), first, checks) or self._helpful(
            self._between(), first, checks
        )

    def _helpful(self, changes: Iterable[Change], first: int, checks: Sequence[int]) -> list[Remedy]:
        """Return those of some changes that help."""
        survivors = self._passing(changes, [first], _FIRST)
        survivors = self._passing(survivors, checks, 0.75)
        of_topic = defaultdict[Topic, list[Change]](list)
        for change in survivors:
            of_topic[change.topic].append(change)
        likeliest = sorted(of_topic.items(), key=lambda each: min(map(self._promise, each[1])))
        found = []
        for topic, its in likeliest[:_PLACES]:
            if topic.kind == "number":
                found += self._in_range(topic.number, its, [first, *checks])
            elif (passed := self._all(its[0])) is not None:
                found.append(Remedy(its[0], passed, its[0].size))
        return found

    def _changes(self, evidence: Evidence) -> Iterator[Change]:
        """Yield the changes, the likeliest of each place before the second likeliest of any."""
        found: list[tuple[float, Change]] = []
        for index in range(len(self._numbers.found)):
            doubt = self._doubts[Topic("number", index)] = doubt_of(
                self._numbers, index, evidence, self._findings
            )
            for rank, value in enumerate(values_of(self._numbers, index, evidence)):
                found.append((rank - 2 * doubt, change_of(self._numbers, index, value)))
        for change in Structure(self._numbers, evidence, self._findings).changes():
            found.append((change.size, change))
        yield from (change for _, change in sorted(found, key=lambda each: each[0]))

    def _between(self) -> Iterator[Change]:
        """Yield further values of the numbers, between those that were tried."""
        for index, values in sorted(self._values.items()):
            number = self._numbers.found[index]
            for low, high in pairwise(sorted({*values, number.value})):
                if low * high > 0 and distance(low, high) > _GAP:
                    yield change_of(self._numbers, index, nicest(low, high, number.is_delay))

    def _promise(self, change: Change) -> float:
        return change.size - self._doubts[change.topic]

    def _checks(self, failed: Sequence[int]) -> list[int]:
        """Return further failed runs, in other worlds if there are any."""
        seen = {self._judge.group(failed[0])}
        others = [run for run in failed[1:] if self._judge.group(run) not in seen]
        rest = [run for run in failed[1:] if run not in others]
        return [*others[:1], *rest[-1:], *others[1:]][:_OTHERS]

    def _passing(self, changes: Iterable[Change], runs: Sequence[int], until: float) -> list[Change]:
        """Return those of some changes that pass all of some runs."""
        left = list(changes)
        for run in runs:
            trials = [TrialRun(each.apply(self._text), run) for each in left]
            self._try(trials, until)
            for each, trial in zip(left, trials, strict=True):
                if trial in self._passed:
                    self._tried[each.topic] = None
                    if each.value is not None:
                        self._values[each.topic.number].add(each.value)
            left = [each for each, trial in zip(left, trials, strict=True) if self._passed.get(trial, False)]
        return left

    def _in_range(self, index: int, its: Sequence[Change], runs: Sequence[int]) -> list[Remedy]:
        """Return what is best of the values of a number that pass: one in the middle of their range."""
        number, known = self._numbers.found[index], [each.value for each in its if each.value is not None]
        whole = number.is_delay or (isinstance(number.value, int) and abs(number.value) >= 10)
        nearest = min(known, key=lambda value: distance(number.value, value))
        around = sorted({*self._values[index], number.value})
        below, above = (
            [each for each in around if each < nearest],
            [each for each in around if each > nearest],
        )
        low, high = (
            self._edge(index, nearest, each, known, runs, whole) for each in (reversed(below), above)
        )
        size = min(distance(number.value, each) for each in (low, high, *known))
        width = distance(low, high) if low * high > 0 else 2.0
        cost = size - self._doubts[its[0].topic] - 0.3 * min(width, 3)
        best: list[Remedy] = []
        for value in list(dict.fromkeys([nicest(low, high, whole), nearest, *reversed(known)]))[:3]:
            change = change_of(self._numbers, index, value)
            passed = self._all(change)
            if passed is not None and (not best or passed > best[0].passed):
                best = [Remedy(change, passed, cost)]
            if passed == self._judge.runs:
                break
        return best

    def _edge(
        self,
        index: int,
        passes: float,
        others: Iterable[float],
        known: Sequence[float],
        runs: Sequence[int],
        whole: bool,
    ) -> float:
        """Return the last value that passes before others fail: one that is known, or a few steps beyond."""
        for fails in others:
            if fails in known:
                passes = fails
                continue
            for _ in range(_STEPS):
                middle = (passes + fails) / 2
                if passes * fails > 0:
                    middle = math.copysign(math.sqrt(passes * fails), passes)
                middle = round(middle) if whole else float(f"{middle:.3g}")
                if middle in (passes, fails):
                    break
                if self._passing([change_of(self._numbers, index, middle)], runs, 0.95):
                    passes = middle
                else:
                    fails = middle
            break
        return passes

    def _all(self, change: Change) -> int | None:
        """Return how many of all runs pass; None if they could not all be made."""
        text = change.apply(self._text)
        trials = [TrialRun(text, run) for run in range(self._judge.runs)]
        self._try(trials, 1.0)
        return self._share(text) if self._passed.keys() >= set(trials) else None

    def _share(self, text: str) -> int:
        return sum(self._passed.get(TrialRun(text, run), False) for run in range(self._judge.runs))

    def _try(self, trials: Sequence[TrialRun], until: float) -> None:
        """Make those of some runs that are not known, until a share of the budget is used."""
        wanted = [each for each in dict.fromkeys(trials) if each not in self._passed]
        self._planned += len(wanted)
        end = self._begin + self._limit * until
        if wanted and perf_counter() < end and not self._halt.done():
            with closing(self._judge.outcomes(wanted)) as made:  # which ends the runs that have begun
                for index, passed in made:
                    self._passed[wanted[index]] = passed
                    self._progress(len(self._passed), self._planned)
                    if perf_counter() > end:
                        break
        self._was_cut |= not self._passed.keys() >= set(wanted)

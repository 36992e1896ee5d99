"""Repair a program: the smallest changes with which it passes a challenge, with what shows that they do.

``repair(program, "there and back")`` tries numbers, orders, sources, moments and comparisons, and returns
those that help. It never changes the program.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from types import NoneType
from typing import Any

from lrp_jupyter.arguments import check_number, check_type
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import Edit, Finding, LRPError
from lrp_jupyter.grading.attempt import Job
from lrp_jupyter.grading.challenges import Challenge, challenge
from lrp_jupyter.grading.grade import jobs_of, namespace_of, text_of
from lrp_jupyter.grading.progress import shown_progress
from lrp_jupyter.grading.workers import Halt, HowRun
from lrp_jupyter.live.running.checking import check
from lrp_jupyter.repairs.change import joined
from lrp_jupyter.repairs.judging import Judge
from lrp_jupyter.repairs.search import Progress, Search, SearchResult
from lrp_jupyter.repairs.structure import KINDS
from lrp_jupyter.runs.decide import rerun_of, runs_named
from lrp_jupyter.runs.kept_runs import KeptRun
from lrp_jupyter.runs.rerun import Rerun

_SHOWN = 3  # changes in the answer
_NAMED = 6  # places at which no change helps


@dataclass(frozen=True)
class Repair:
    """A change of a program with which it passes more runs; as text it is a sentence.

    Parameters
    ----------
    phrase : str
        What the change is: ```lightlim` 121 instead of 128 (line 7)``.
    line : int
        The first line that it changes.
    changes : tuple of Edit
        The changes of the text.
    passed, runs, before : int
        How many of the runs pass with the change, how many there are, and how many passed without it.
    text : str
        The whole program after the change.
    """

    phrase: str
    line: int
    changes: tuple[Edit, ...]
    passed: int
    runs: int
    before: int
    text: str

    @property
    def sentence(self) -> str:
        """What the change is, and in how many runs the program passes with it."""
        return f"{self.phrase} passes in {self.passed} of {self.runs} runs (now {self.before})."

    def __str__(self) -> str:
        return self.sentence


@dataclass(frozen=True)
class Repairs:
    """The result of :func:`repair`; true if a change was found. ``print(result)`` explains it.

    Parameters
    ----------
    challenge : str
        Its name; empty if only kept runs have judged.
    repairs : tuple of Repair
        The best one first: the one that passes the most runs, and of several the smallest.
    passed, runs : int
        How many runs the program passes as it is, and how many there are.
    unhelpful : tuple of str
        The numbers that no other value of which helps.
    tried : mapping of str to int
        How many places were tried, by the kind of change in words.
    made : int
        How many runs were made for this.
    complete : bool
        Whether everything was tried, or the time was over before.
    """

    challenge: str
    repairs: tuple[Repair, ...]
    passed: int
    runs: int
    unhelpful: tuple[str, ...]
    tried: dict[str, int]
    made: int
    complete: bool

    @classmethod
    def of(cls, name: str, text: str, found: SearchResult) -> Repairs:
        """Return the answer that the outcome of a search is."""
        repairs = tuple(
            Repair(
                each.change.subject,
                min(each.change.lines),
                each.change.edits,
                each.passed,
                found.runs,
                found.before,
                each.change.apply(text),
            )
            for each in found.found
        )
        helped = {each.change.topic for each in found.found}
        unhelpful = [each for each in found.tried if each.kind == "number" and each not in helped]
        tried = {KINDS[kind]: len([each for each in found.tried if each.kind == kind]) for kind in KINDS}
        return cls(
            name,
            repairs,
            found.before,
            found.runs,
            tuple(dict.fromkeys(each.what for each in unhelpful)),
            {what: count for what, count in tried.items() if count},
            found.made,
            found.is_complete,
        )

    def __bool__(self) -> bool:
        return bool(self.repairs)

    @property
    def first_sentence(self) -> str:
        """The best change, or that there is none."""
        return next(self._sentences())

    @property
    def shown(self) -> tuple[Repair, ...]:
        """The changes that the answer names."""
        return self.repairs[:_SHOWN]

    @property
    def remarks(self) -> str:
        """What the answer says beside these changes: what does not help, and what was tried."""
        return " ".join(self._remarks())

    def __str__(self) -> str:
        return " ".join(self._sentences())

    def _sentences(self) -> Iterator[str]:
        for each in self.repairs[:1]:
            yield each.sentence
        for each in self.shown[1:]:
            yield f"{each.phrase} does, too: {each.passed} of {each.runs}."
        yield from self._remarks()

    def _remarks(self) -> Iterator[str]:
        if self.passed == self.runs:
            yield f"The program passes in all {self.runs} runs as it is."
            return
        if not (self.complete or self.tried):
            yield "The search was ended before a change was tried."
            return
        if not self.repairs:
            now = f"({self.passed} of {self.runs} runs)"
            yield f"No small change was found with which the program passes {now}."
            kinds = joined(self.tried, "and") if self.tried else "nothing"
            yield f"Tried were {kinds}, in {self.made} runs."
        elif self.unhelpful:
            yield f"Changing {joined(self.unhelpful[:_NAMED], 'or')} does not help."
        if not self.complete:
            yield "The search was ended before everything was tried."


def repair(
    program: Any,
    what: str | Challenge | None = None,
    seeds: int = 10,
    *,
    runs: str | os.PathLike[str] | Iterable[KeptRun | str | os.PathLike[str]] = (),
    limit: float = 60,
    namespace: dict[str, Any] | None = None,
    progress: Callable[[int, int], object] | None = None,
    halt: Halt | None = None,
) -> Repairs:
    """Find the smallest changes with which a program passes a challenge, or its kept runs, or both.

    The program stays as it is.

    Parameters
    ----------
    program : str, Program, Session or Lab
    what : str or Challenge, optional
        A challenge or its name.
    seeds : int
        Number of runs in each world, in which a change has to prove itself.
    runs : path, or iterable of paths or KeptRun
        A folder of recordings, or several folders, files or runs.
    limit : float
        Seconds of computing; then the answer is what was found until then.
    namespace : dict, optional
        Names available to the blocks; default: those of the session or lab, if one is given.
    progress : callable, optional
        Called with the number of runs that were made, and of those that are planned so far; by default a bar
        on a terminal or in a notebook.
    halt : Halt, optional
        Set from another thread, it ends the search.

    Returns
    -------
    Repairs

    Raises
    ------
    LRPSyntaxError
        The text is not a valid program.
    FileError
        There is no such folder or file.
    LRPError
        There is no such challenge; or neither a challenge nor a run is given.

    Examples
    --------
    >>> text = "(machine m (state a (onentry [robot.move(linear=0.2)]))) (spawn m a)"
    >>> print(repair(text, "robot 5", seeds=1).repairs[0].phrase)
    `[robot.move(linear=0.2)]` in `running` instead of `onentry` of `a` (line 1)
    """
    check_type("what", what, (str, Challenge, NoneType), "the name of a challenge or a Challenge")
    check_number("limit", limit, "a number of seconds", above=0)
    task = challenge(what) if isinstance(what, str) else what
    names = namespace_of(program) if namespace is None else namespace
    how = HowRun(min(20.0, limit), namespace=names)
    kept, text = runs_named(runs), text_of(program)
    if progress is not None:
        return repaired(text, task, seeds, how, limit, progress, halt, kept)
    with shown_progress("repair") as shown:
        return repaired(text, task, seeds, how, limit, shown, halt, kept)


def repaired(
    text: str,
    task: Challenge | None,
    seeds: int,
    how: HowRun,
    limit: float,
    progress: Progress = lambda done, of: None,
    halt: Halt | None = None,
    kept: Sequence[KeptRun] = (),
) -> Repairs:
    """Find the smallest changes of a text; see :func:`repair`."""
    halt, names = halt or Halt(), how.namespace or {}
    findings: Sequence[Finding] = ()
    jobs: list[Job | Rerun] = []
    if task is not None:
        seeded, of_challenge = jobs_of(text, task, seeds, how)
        findings = check(text, names, SimBridge(seeded.runs[0][0]))
        jobs += of_challenge
    jobs += [rerun_of(text, run, how, names) for run in kept]
    if not jobs:
        raise LRPError("There is nothing to judge the program by. Name a challenge, or runs that are kept.")
    outcome = Search(text, Judge(jobs, how, halt), findings, limit, progress, halt).run()
    return Repairs.of("" if task is None else task.name, text, outcome)

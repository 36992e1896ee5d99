"""Grade a program: run it in virtual time in every world of a challenge, and judge every run.

``grade(program, "there and back")`` takes a second or two and returns, for every run and every criterion,
whether it passed and why, the points, and hints for typical mistakes.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from lrp_jupyter.arguments import check_number, check_type
from lrp_jupyter.grading.attempt import Attempt, Job
from lrp_jupyter.grading.challenges import Challenge, challenge
from lrp_jupyter.grading.criteria import Criterion
from lrp_jupyter.grading.notes import notes_about
from lrp_jupyter.grading.workers import HowRun, run_jobs
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.world import World

_FIGURE = re.compile(r"-?\d+(?:\.\d+)?")


@dataclass(frozen=True)
class Grade:
    """The result of :func:`grade`; true if everything passed. ``print(grade)`` explains it.

    Parameters
    ----------
    challenge : str
    attempts : tuple of Attempt
        In the order of worlds and seeds. One that did not come to its end is the last one.
    out_of : float
        The points for a program that passes.
    runs : int
        How many there would be; those that were not made earn nothing.
    needed : float
        Share of the runs that have to pass, 0 to 1.
    start : float
        Share of the points that the text which one begins with earns in the same runs, as measured: points
        count above that.
    begins_with : str
        What that text is, in words.
    notes : tuple of str
        What a teacher may want to read in a program, such as an import of `sys`; no fault.
    """

    challenge: str
    attempts: tuple[Attempt, ...] = field(default=(), repr=False)
    out_of: float = 10
    runs: int = 0
    needed: float = 1.0
    start: float = 0.0
    begins_with: str = "the program that the challenge begins with"
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, task: Challenge, made: Mapping[int, Attempt], jobs: Sequence[Job]) -> Grade:
        """Return the grade for the runs that were made, by their index; the first end is the last run.

        Several runs are made at the same time, so some after that one may have been made.
        """
        attempts = []
        for index in sorted(made):
            attempts.append(made[index])
            if made[index].ended:
                break
        notes = notes_about(jobs[0].texts)
        return cls(task.name, tuple(attempts), task.points, len(jobs), task.needed, notes=notes)

    @property
    def passed(self) -> bool:
        """Whether every run met every criterion, or as many runs as needed."""
        good = self.runs_passed
        return bool(self.attempts) and good >= self.needed * max(self.runs, len(self.attempts)) - 1e-9

    @property
    def runs_passed(self) -> int:
        """How many runs passed."""
        return sum(attempt.passed for attempt in self.attempts)

    @property
    def first_failed(self) -> Attempt | None:
        """The first run that did not pass."""
        return next((attempt for attempt in self.attempts if not attempt.passed), None)

    @property
    def share(self) -> float:
        """How much of the criteria is met, 0 to 1: the mean of the runs."""
        return sum(attempt.share for attempt in self.attempts) / max(self.runs, len(self.attempts), 1)

    @property
    def points(self) -> float:
        """The points for the share above `start`, to one decimal; only a program that passes gets all."""
        if self.passed:
            return self.out_of
        above = max(0.0, self.share - self.start) / (1 - self.start) if self.start < 1 else 0.0
        return max(0.0, min(round(self.out_of * above, 1), round(self.out_of - 0.1, 1)))

    @property
    def hints(self) -> tuple[str, ...]:
        """The hints of all runs: of those that differ only in their figures, the first."""
        hints: dict[str, str] = {}
        for attempt in self.attempts:
            for hint in attempt.hints:
                hints.setdefault(_FIGURE.sub("", hint), hint)
        return tuple(hints.values())

    @property
    def hint(self) -> str:
        """The first hint; empty when there is none."""
        return next(iter(self.hints), "")

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        word = "passed" if self.passed else "not yet"
        return f"<Grade {self.challenge}: {word}, {self.runs_passed} of {len(self.attempts)} runs>"

    def __str__(self) -> str:
        word = "passed" if self.passed else "not yet"
        lines = [f"{self.challenge}: {word}, {self.points:g} of {self.out_of:g} points"]
        if self.needed < 1:
            lines.append(f"  {self.needed:.0%} of the runs have to pass")
        if self.start and not self.passed:
            lines.append(f"  points count above {self.begins_with}, which meets {self.start:.0%} of the task")
        if len(self.attempts) > 1:
            lines += list(self._summary())
        if self.attempts:
            shown = self.first_failed or self.attempts[0]
            lines += [f"  {verdict}" for verdict in shown.verdicts]
        if self.hint:
            lines.append(f"Hint: {self.hint}")
        lines += [f"Note: {note}" for note in self.notes]
        return "\n".join(lines)

    def _summary(self) -> Iterator[str]:
        worlds = dict.fromkeys(attempt.world for attempt in self.attempts)
        for world in worlds:
            runs = [attempt for attempt in self.attempts if attempt.world == world]
            failed = [str(attempt.seed) for attempt in runs if not attempt.passed]
            if len(runs) == 1:
                text = "passed" if not failed else "not passed"
            else:
                text = f"all {len(runs)} runs passed" if not failed else f"not with seed {', '.join(failed)}"
            yield f"  in `{world}`: {text}"


def grade(
    program: Any,
    what: str | Challenge | World,
    seeds: int | Iterable[int] | None = None,
    *,
    criteria: Sequence[Criterion] = (),
    seconds: float = 60,
    namespace: dict[str, Any] | None = None,
    limit: float = 60,
    memory: float = 1000,
) -> Grade:
    """Run a program in virtual time, each run in a process of its own, and return how it did.

    Parameters
    ----------
    program : str, Program, Session, Lab, or several texts
        Several are applied one after the other to the running program, at equal intervals. One program for a
        challenge of editing live takes the place of the challenge's own while that runs.
    what : str, Challenge or World
        A challenge or its name; a world is graded by `criteria`, for `seconds`.
    seeds : int or iterable of int, optional
        Number of runs in each world, or their seeds; default: those of the challenge, of which a number
        takes the first ones, and further ones after them.
    namespace : dict, optional
        Names available to the blocks; default: those of the session or lab, if one is given.
    limit : float
        Wall seconds of computing that one run may take, and one block at most a sixth of it. A run that
        takes longer, ends its process or needs too much memory does not pass; it is the last one.
    memory : float
        Megabytes that one run may need more than at its beginning (not limited on Windows and macOS).

    Returns
    -------
    Grade
        A text that is not a valid program does not pass; the reason is its first error.

    Raises
    ------
    LRPError
        The challenge does not exist, or the interpreter itself failed.
    """
    how = HowRun(limit, memory, namespace=namespace)
    task, jobs = jobs_of(program, what, seeds, how, criteria=criteria, seconds=seconds)
    attempts: dict[int, Attempt] = {}
    for index, attempt in run_jobs(jobs, how, stop_at_end=True):
        attempt.check()
        attempts[index] = attempt
    result = Grade.of(task, attempts, jobs)
    how = how._replace(namespace=dict(jobs[0].namespace))
    begun = run_jobs(starter_jobs(result, task, how), how, stop_at_end=True)
    return above_starter(result, task, [made for _, made in begun])


def starter_jobs(result: Grade, task: Challenge, how: HowRun) -> list[Job]:
    """Return the runs of the text that one begins with, if the points of a grade depend on them.

    None are made for a program that passes or earns nothing, nor a second time in this process.
    """
    if result.passed or not result.share or start_of(task) is not None:
        return []
    return jobs_of(task.beginning, task, how=how)[1]


def above_starter(result: Grade, task: Challenge, begun: Sequence[Attempt]) -> Grade:
    """Return a grade whose points count above those of the text that one begins with, after its runs."""
    if begun and start_of(task) is None:
        _starters.append((task, sum(made.share for made in begun) / result.runs))
    return replace(result, start=start_of(task) or 0.0, begins_with=task.begins_with)


_starters: list[tuple[Challenge, float]] = []  # measured in this process


def start_of(task: Challenge) -> float | None:
    """Return the share of the points that the text which one begins with earns; None if it is not known."""
    return next((share for known, share in _starters if known == task), None)


def jobs_of(
    program: Any,
    what: str | Challenge | World,
    seeds: int | Iterable[int] | None = None,
    how: HowRun = HowRun(),  # noqa: B008  (an immutable value)
    *,
    criteria: Sequence[Criterion] = (),
    seconds: float = 60,
) -> tuple[Challenge, list[Job]]:
    """Return the challenge, and the runs that grade a program; see :func:`grade`."""
    how.check()
    check_type("what", what, (str, Challenge, World), "the name of a challenge, a Challenge or a World")
    check_number("seconds", seconds, "a number of seconds", above=0)
    if isinstance(what, str):
        task = challenge(what)
    elif isinstance(what, Challenge):
        task = what
    else:
        task = Challenge(what.name or "your world", "", (what,), tuple(criteria), seconds)
    if seeds is not None and not isinstance(seeds, Iterable):
        check_type("seeds", seeds, int, "a number of runs, or the seeds themselves")
        check_number("seeds", seeds, "a number of runs", least=1)
    if not isinstance(what, str):
        task.check()
    if seeds is not None:
        task = replace(task, seeds=task.first_seeds(seeds) if isinstance(seeds, int) else tuple(seeds))
    texts = tuple(text_of(each) for each in (program if isinstance(program, (list, tuple)) else [program]))
    if task.live and len(texts) == 1:
        texts = (task.beginning, *texts)
    names = namespace_of(program) if how.namespace is None else how.namespace
    return task, [Job(texts, task, world, seed, how.limit, names) for world, seed in task.runs]


def namespace_of(program: Any) -> dict[str, Any]:
    """Return the names that a session, or that of a lab, lets its blocks read."""
    session = getattr(program, "session", program)
    return session.namespace if isinstance(session, Session) else {}


def text_of(program: Any) -> str:
    """Return the text of a program, a session or a lab, or the text that it is."""
    if isinstance(program, str):
        return program
    text = getattr(program, "text", None)  # a program, a session, a lab
    if not isinstance(text, str):
        kind = type(program).__name__
        raise TypeError(f"A program must be a text, a Program, a Session or a Lab, not {kind}.")
    return text

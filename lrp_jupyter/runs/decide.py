"""Judge kept runs: run each again with a program, several at a time.

``decide(program, "follower.runs")`` is what ``lrp test`` prints, and what the panel *Runs* of a lab shows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lrp_jupyter.errors import LRPError, printable, sentence_of
from lrp_jupyter.grading.grade import namespace_of, text_of
from lrp_jupyter.grading.workers import Halt, HowRun, run_jobs
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Program
from lrp_jupyter.live.coverage import Coverage, coverage_from
from lrp_jupyter.runs.expectation import expectation
from lrp_jupyter.runs.kept_runs import KeptRun, Where, kept_runs
from lrp_jupyter.runs.outcome import OPEN_LOOP, RunOutcome
from lrp_jupyter.runs.rerun import Rerun

Told = Callable[[KeptRun, RunOutcome], object]


@dataclass(frozen=True, repr=False)
class Decisions:
    """The outcomes of kept runs with a program; true if all passed. ``print(decisions)`` shows each.

    Parameters
    ----------
    program : Program
    outcomes : mapping of KeptRun to RunOutcome
        In the order of the runs; those that were not run again are missing.
    """

    program: Program
    outcomes: Mapping[KeptRun, RunOutcome]

    @property
    def passed(self) -> bool:
        """Whether everything that is expected holds in all runs."""
        return all(outcome.passed for outcome in self.outcomes.values())

    @property
    def coverage(self) -> Coverage:
        """How much of the program the runs have reached together, and in how many of them."""
        return coverage_from(self.program, [outcome.coverage for outcome in self.outcomes.values()])

    def __bool__(self) -> bool:
        return self.passed

    def __getitem__(self, name: str) -> RunOutcome:
        """Return the outcome of a run, by its name."""
        return next(outcome for run, outcome in self.outcomes.items() if run.name == name)

    def __str__(self) -> str:
        return (
            "\n".join(line_of(run, outcome) for run, outcome in self.outcomes.items()) or "No runs are kept."
        )

    __repr__ = __str__


def line_of(run: KeptRun, outcome: RunOutcome) -> str:
    """Return what came of a run, in a line, or two if it is an open loop."""
    mark = "✓" if outcome.passed else "✗"
    reason = f": {outcome.reason}" if outcome.reason else ""
    length = "" if outcome.problem else f"{outcome.seconds:.1f} s, "
    line = f"{mark} {printable(run.name)} ({length}{run.expected}){reason}"
    return line if outcome.open_loop is None else f"{line}\n  {OPEN_LOOP}"


def decide(
    program: Any,
    runs: Where,
    how: HowRun = HowRun(limit=10),  # noqa: B008  (an immutable value)
    *,
    trusted: bool = False,
    told: Told = lambda run, outcome: None,
    halt: Halt | None = None,
) -> Decisions:
    """Run kept runs again with a program, and judge each by what is expected of it.

    Parameters
    ----------
    program : str, Program, Session or Lab
        For a session or a lab, its program is judged, and its blocks can read its names.
    runs : path, or iterable of paths or KeptRun
        A folder of recordings, or several folders, files or runs.
    how : HowRun
        How many at a time, and for how long at most.
    trusted : bool
        Whether expressions in recordings of others are evaluated.
    told : callable, optional
        Called with each run and its outcome as soon as that is known.
    halt : Halt, optional
        Set from another thread, it ends the runs.

    Returns
    -------
    Decisions

    Raises
    ------
    LRPSyntaxError
        The text is not a valid program.
    FileError
        There is no such folder or file.
    LRPError
        A name of the notebook cannot be sent to another process.
    """
    text = text_of(program)
    wanted = kept_runs(runs)
    namespace = namespace_of(program) or how.namespace or {}
    parsed = program if isinstance(program, Program) else parse(text)
    made, jobs = dict[KeptRun, RunOutcome](), list[tuple[KeptRun, Rerun]]()
    for run in wanted:
        try:
            jobs.append((run, rerun_of(text, run, how, namespace, trusted)))
        except LRPError as error:  # of what is expected
            made[run] = RunOutcome(problem=sentence_of(error))
            told(run, made[run])
    for index, outcome in run_jobs([job for _, job in jobs], how, halt=halt):
        run, _ = jobs[index]
        made[run] = outcome
        told(run, outcome)
    return Decisions(parsed, {run: made[run] for run in wanted if run in made})


def rerun_of(
    text: str, run: KeptRun, how: HowRun, namespace: Mapping[str, Any], trusted: bool = False
) -> Rerun:
    """Return a run that is to be run again with a text.

    Raises LRPError: what is expected of it cannot be read, or there is no such challenge.
    """
    expected = expectation(run.expected)
    file = str(Path(run.file).absolute())
    return Rerun((text,), file, expected, expected.challenges, how.limit, trusted, namespace)

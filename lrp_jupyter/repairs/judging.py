"""Who judges a program: some runs, of which each passes or not; here those of a challenge."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from typing import NamedTuple, Protocol

from lrp_jupyter.grading.attempt import Job
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.grade import jobs_of
from lrp_jupyter.grading.workers import Halt, HowRun, run_jobs
from lrp_jupyter.repairs.numbers import Numbers
from lrp_jupyter.repairs.witness import Evidence, WitnessJob, with_notes


class TrialRun(NamedTuple):
    """A text that is to be run, and the number of the run."""

    text: str
    run: int


class Judge(Protocol):
    """Judges texts of programs, each in the same runs."""

    runs: int
    """How many there are."""

    def outcomes(self, trials: Sequence[TrialRun]) -> Iterator[tuple[int, bool]]:
        """Yield the index of each trial, as it is done, and whether it passed."""
        ...

    def witness(self, text: str, numbers: Numbers, run: int) -> Evidence:
        """Return what a text does in a run."""
        ...

    def group(self, run: int) -> object:
        """Return what runs that are alike have in common, such as their world."""
        ...


class ChallengeJudge:
    """Judges programs in the runs of a challenge: its worlds, each with the same seeds."""

    def __init__(self, task: Challenge, seeds: int, how: HowRun, halt: Halt) -> None:
        self.task: Challenge
        self._jobs: list[Job]
        self.task, self._jobs = jobs_of("", task, seeds, how)
        self._how, self._halt = how, halt
        self.runs = len(self._jobs)

    def _job(self, text: str, run: int) -> Job:
        job = self._jobs[run]
        return replace(job, texts=(*job.texts[:-1], text))

    def outcomes(self, trials: Sequence[TrialRun]) -> Iterator[tuple[int, bool]]:
        """Yield the index of each trial, as it is done, and whether it passed."""
        jobs = [self._job(*trial) for trial in trials]
        for index, made in run_jobs(jobs, self._how, halt=self._halt):
            yield index, made.passed

    def witness(self, text: str, numbers: Numbers, run: int) -> Evidence:
        """Return what a text does in a run."""
        job = self._job(text, run)
        if len(job.texts) == 1:  # else calls that are not in the text before would be edits
            job = self._job(with_notes(text, numbers), run)
        noted = WitnessJob(**{each.name: getattr(job, each.name) for each in fields(Job)})
        made: object = next((made for _, made in run_jobs([noted], self._how, halt=self._halt)), None)
        return made if isinstance(made, Evidence) else Evidence()

    def group(self, run: int) -> object:
        """Return the world of a run."""
        return self._jobs[run].world_name

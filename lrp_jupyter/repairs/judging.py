"""Who judges a program: some runs, of a challenge or kept ones, of which each passes or not."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from lrp_jupyter.grading.attempt import Attempt, Job
from lrp_jupyter.grading.workers import Halt, HowRun, RunJob, run_jobs
from lrp_jupyter.repairs.numbers import Numbers
from lrp_jupyter.repairs.witness import Evidence, WitnessJob, WitnessRerun, with_notes
from lrp_jupyter.runs.outcome import RunOutcome
from lrp_jupyter.runs.rerun import Rerun


class TrialRun(NamedTuple):
    """A text that is to be run, and the number of the run."""

    text: str
    run: int


class Judge:
    """Judges texts of programs, each in the same runs; `runs`: how many there are."""

    def __init__(self, jobs: Sequence[Job | Rerun], how: HowRun, halt: Halt) -> None:
        self._jobs, self._how, self._halt = jobs, how, halt
        self.runs = len(jobs)

    def _job(self, text: str, run: int) -> Job | Rerun:
        job = self._jobs[run]
        return replace(job, texts=(*job.texts[:-1], text))

    def outcomes(self, trials: Sequence[TrialRun]) -> Generator[tuple[int, bool]]:
        """Yield the index of each trial, as it is done, and whether it passed."""
        jobs: list[RunJob[Attempt | RunOutcome]] = [self._job(*trial) for trial in trials]
        for index, made in run_jobs(jobs, self._how, halt=self._halt):
            yield index, made.passed

    def witness(self, numbers: Numbers, run: int) -> Evidence:
        """Return what a program does in a run."""
        is_patched = len(self._jobs[run].texts) > 1  # calls that are not in the text before would be edits
        job = self._job(numbers.text if is_patched else with_notes(numbers), run)
        noted: RunJob[Evidence]
        noted = WitnessJob(**vars(job)) if isinstance(job, Job) else WitnessRerun(**vars(job))
        return next((made for _, made in run_jobs([noted], self._how, halt=self._halt)), Evidence())

    def group(self, run: int) -> object:
        """Return what runs that are alike have in common: their world, or their folder."""
        job = self._jobs[run]
        return job.world_name if isinstance(job, Job) else Path(job.recording).parent

"""Kept runs as judges of a program: each is run again, and passes if what is expected of it holds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from lrp_jupyter.grading.attempt import Ended
from lrp_jupyter.grading.workers import Halt, HowRun, run_jobs
from lrp_jupyter.repairs.judging import Judge, TrialRun
from lrp_jupyter.repairs.numbers import Numbers
from lrp_jupyter.repairs.witness import Evidence, RunNotes, evidence_in, with_notes
from lrp_jupyter.runs.decide import rerun_of
from lrp_jupyter.runs.kept_runs import KeptRun
from lrp_jupyter.runs.rerun import Rerun


@dataclass(frozen=True)
class WitnessRerun(Rerun):
    """A kept run that is run again to see what a program does; its text has the calls in it."""

    def done(self) -> dict[str, Any]:
        """Run it again, and return what was noted."""
        notes = RunNotes()
        noted = replace(self, namespace={**self.namespace, **notes.names})
        outcome = noted.outcome(notes.watch)
        return {**notes.plain(), "ended": outcome.ended}

    def made(self, data: Any) -> Evidence:  # type: ignore[override]
        """Return what was noted, from plain data that the program may have written."""
        return evidence_in(data)

    def failed(self, ended: Ended, sentence: str, reason: str) -> Evidence:  # type: ignore[override]
        """Return what is known of a run that did not come to its end: nothing but that."""
        return Evidence(ended=ended)


class ExamplesJudge:
    """Judges programs in kept runs."""

    def __init__(self, kept: Sequence[KeptRun], how: HowRun, halt: Halt) -> None:
        self._kept, self._how, self._halt = kept, how, halt
        self.runs = len(kept)

    def _job(self, text: str, run: int) -> Rerun:
        return rerun_of(text, self._kept[run], self._how, self._how.namespace or {})

    def outcomes(self, trials: Sequence[TrialRun]) -> Iterator[tuple[int, bool]]:
        """Yield the index of each trial, as it is done, and whether it passed."""
        jobs = [self._job(*trial) for trial in trials]
        yield from ((index, made.passed) for index, made in run_jobs(jobs, self._how, halt=self._halt))

    def witness(self, text: str, numbers: Numbers, run: int) -> Evidence:
        """Return what a text does in a run."""
        job = self._job(with_notes(text, numbers), run)
        noted = WitnessRerun(**{each.name: getattr(job, each.name) for each in fields(Rerun)})
        made: object = next((made for _, made in run_jobs([noted], self._how, halt=self._halt)), None)
        return made if isinstance(made, Evidence) else Evidence()

    def group(self, run: int) -> object:
        """Return the folder of a run."""
        return self._kept[run].file.parent


class JointJudge:
    """Several judges as one: the runs of each come after those of the one before."""

    def __init__(self, judges: Sequence[Judge]) -> None:
        self._judges = judges
        self._places = [(judge, run) for judge in judges for run in range(judge.runs)]
        self.runs = len(self._places)

    def outcomes(self, trials: Sequence[TrialRun]) -> Iterator[tuple[int, bool]]:
        """Yield the index of each trial, as it is done, and whether it passed."""
        for judge in self._judges:
            its = [
                (index, TrialRun(trial.text, self._places[trial.run][1]))
                for index, trial in enumerate(trials)
                if self._places[trial.run][0] is judge
            ]
            for place, passed in judge.outcomes([trial for _, trial in its]):
                yield its[place][0], passed

    def witness(self, text: str, numbers: Numbers, run: int) -> Evidence:
        """Return what a text does in a run."""
        judge, its = self._places[run]
        return judge.witness(text, numbers, its)

    def group(self, run: int) -> object:
        """Return what runs that are alike have in common."""
        judge, its = self._places[run]
        return judge.group(its)

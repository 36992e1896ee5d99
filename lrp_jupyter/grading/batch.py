"""Many programs for one challenge: all their runs, in all worlds and with all seeds, share the processors."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence

from lrp_jupyter.grading.attempt import Attempt, Job
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.grade import Grade, above_starter, jobs_of, start_of
from lrp_jupyter.grading.workers import HowRun, run_jobs

Progress = Callable[[int, int], object]
"""Called with the number of runs that need not be made any more, and the number of all runs."""


def grade_all(
    texts: Sequence[str],
    task: Challenge,
    seeds: int | Iterable[int] | None = None,
    how: HowRun = HowRun(),  # noqa: B008  (an immutable value)
    progress: Progress = lambda done, of: None,
) -> list[Grade]:
    """Return the grades of programs, in their order.

    A program that hangs, crashes or is not a valid program is not run again, and costs only its own grade; so
    does a fault of the interpreter. Equal texts are run once. So is the one that everybody begins with, above
    which points count.

    Raises LRPError: the cluster cannot be reached.
    """
    starter = task.beginning
    task = jobs_of(starter, task, seeds, how)[0]
    others = [starter] if texts and start_of(task) is None else []
    of_text = {text: jobs_of(text, task, how=how)[1] for text in (*texts, *others)}
    count = max(map(len, of_text.values()), default=0)
    order = [(text, number) for number in range(count) for text in of_text]
    jobs: list[Job] = [of_text[text][number] for text, number in order]
    made: defaultdict[str, dict[int, Attempt]] = defaultdict(dict)
    ended: set[str] = set()
    progress(0, len(jobs))
    for index, attempt in run_jobs(jobs, how, stop_at_end=True):
        text, number = order[index]
        made[text][number] = attempt
        if attempt.ended:
            ended.add(text)
        progress(sum(count if text in ended else len(made[text]) for text in made), len(jobs))
    begun = list(made[starter].values())
    grades = {
        text: above_starter(Grade.of(task, made[text], jobs), task, begun) for text, jobs in of_text.items()
    }
    return [grades[text] for text in texts]

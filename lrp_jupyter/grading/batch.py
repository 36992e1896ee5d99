"""Many programs for one challenge or several: all their runs share the processors."""

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
    """Return the grades of programs for one challenge, in their order; see :func:`grade_each`."""
    return grade_each([(text, task) for text in texts], seeds, how, progress)


def grade_each(
    programs: Sequence[tuple[str, Challenge]],
    seeds: int | Iterable[int] | None = None,
    how: HowRun = HowRun(),  # noqa: B008  (an immutable value)
    progress: Progress = lambda done, of: None,
) -> list[Grade]:
    """Return the grades of programs, each for a challenge, in their order.

    A program that hangs, crashes or is not a valid program is not run again, and costs only its own grade; so
    does a fault of the interpreter. Equal texts for the same challenge are run once. So is the one that one
    begins with, above which points count.

    Raises LRPError: the cluster cannot be reached.
    """
    if isinstance(seeds, Iterable):
        seeds = tuple(seeds)
    tasks = {task.name: jobs_of("", task, seeds, how)[0] for _, task in programs}
    starters = {(task.beginning, name) for name, task in tasks.items() if start_of(task) is None}
    keys = [(text, task.name) for text, task in programs]
    of_key = {
        (text, name): jobs_of(text, tasks[name], how=how)[1] for text, name in (*keys, *sorted(starters))
    }
    longest = max(map(len, of_key.values()), default=0)
    order = [(key, number) for number in range(longest) for key, its in of_key.items() if number < len(its)]
    jobs: list[Job] = [of_key[key][number] for key, number in order]
    made: defaultdict[tuple[str, str], dict[int, Attempt]] = defaultdict(dict)
    ended: set[tuple[str, str]] = set()
    progress(0, len(jobs))
    for index, attempt in run_jobs(jobs, how, stop_at_end=True):
        key, number = order[index]
        made[key][number] = attempt
        if attempt.ended:
            ended.add(key)
        progress(sum(len(of_key[each]) if each in ended else len(made[each]) for each in made), len(jobs))
    grades = {}
    for (text, name), its in of_key.items():
        task = tasks[name]
        begun = list(made[task.beginning, name].values())
        grades[text, name] = above_starter(Grade.of(task, made[text, name], its), task, begun)
    return [grades[key] for key in keys]

"""How far off the submissions of a class are: for each that does not pass, the smallest change that would."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from lrp_jupyter.grading.marks import Mark, Marks
from lrp_jupyter.grading.workers import HowRun
from lrp_jupyter.repairs.repair import repaired
from lrp_jupyter.repairs.search import Progress

BUDGET = 30.0
"""Seconds of computing for each text."""


def with_repairs(
    marks: Marks, seeds: int | None, how: HowRun, progress: Progress = lambda done, of: None
) -> Marks:
    """Return marks with a note for each submission that did not pass: the first sentence of its repair.

    Notes of a grade are for teachers: the pages for students do not show them.
    """
    tasks = {task.name: task.whole() for task in marks.tasks}

    @cache
    def sentence(text: str, name: str) -> str:
        task = tasks[name]
        wanted = task.count if seeds is None else seeds
        return repaired(text, task, wanted, how, BUDGET, progress).first_sentence

    def noted(mark: Mark) -> Mark:
        text, grade = mark.submission.text, mark.grade
        if not text or not grade.attempts or grade.passed or grade.attempts[-1].ended:
            return mark  # it passed, or did not run to its end
        notes = (*grade.notes, sentence(text, grade.challenge))
        return mark._replace(grade=replace(grade, notes=notes))

    return replace(marks, marks=tuple(map(noted, marks.marks)))

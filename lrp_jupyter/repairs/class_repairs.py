"""How far off the submissions of a class are: for each that does not pass, the smallest change that would."""

from __future__ import annotations

from dataclasses import replace

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
    wanted = {_key(mark): None for mark in marks.marks if _is_off(mark)}
    said: dict[tuple[str, str], str] = {}
    for text, name in wanted:
        task = tasks[name]
        repairs = repaired(text, task, task.count if seeds is None else seeds, how, BUDGET, progress)
        said[text, name] = repairs.first_sentence
    return replace(
        marks, marks=tuple(_noted(mark, said[_key(mark)]) if _is_off(mark) else mark for mark in marks.marks)
    )


def _key(mark: Mark) -> tuple[str, str]:
    return mark.submission.text or "", mark.grade.challenge


def _is_off(mark: Mark) -> bool:
    """Return whether a submission runs to its end, and does not pass."""
    attempts = mark.grade.attempts
    return bool(mark.submission.text) and bool(attempts) and not mark.grade.passed and not attempts[-1].ended


def _noted(mark: Mark, sentence: str) -> Mark:
    return mark._replace(grade=replace(mark.grade, notes=(*mark.grade.notes, sentence)))

"""Feedback to students: a page for each, with criteria, figures, a hint, and a picture of what failed.

No page has a solution, and none speaks of anyone else.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from lrp_jupyter.errors import FileError
from lrp_jupyter.files import shown, unwritable, write_file
from lrp_jupyter.grading.attempt import Attempt
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.grade import Grade
from lrp_jupyter.grading.marks import Handed, Mark, Marks
from lrp_jupyter.grading.pages import page, paragraph, sign, table, words
from lrp_jupyter.sim.svg import svg

_PICTURE = 560  # px
_LONGEST_NAME = 150  # bytes of a student's name in that of a file
_NOT_IN_NAMES = re.compile(r'[\x00-\x1f/\\:*?"<>|]+')


def write_feedback(marks: Marks, folder: Path) -> list[Path]:
    """Write a page for each student into a folder, which is made if it is missing, and return the files.

    A page for a submission from Moodle has the name by which Moodle gives it to its student.

    Raises FileError: the folder or a file cannot be written.
    """
    try:
        folder.mkdir(exist_ok=True)
    except FileExistsError as error:
        raise FileError(f"`{shown(folder)}` exists and is not a folder. Choose another name.") from error
    except (OSError, ValueError) as error:
        raise unwritable(folder, error) from error
    written: dict[str, Path] = {}
    for student in marks.students:
        name = _name(student)
        path = folder / f"{name}.html"
        number = 1
        while path.name.casefold() in written:
            number += 1
            path = folder / f"{name} {number}.html"
        write_file(path, feedback(student, marks.tasks))
        written[path.name.casefold()] = path
    return list(written.values())


def _name(student: Handed) -> str:
    """Return the name of a page: no file system holds longer ones, and Moodle looks at its end."""
    name = _NOT_IN_NAMES.sub("_", student.student).encode()[:_LONGEST_NAME].decode(errors="ignore")
    name = name.strip(" .") or "feedback"
    return f"{name}_{student.number}_assignsubmission_file_feedback" if student.is_from_moodle else name


def feedback(student: Handed, tasks: tuple[Challenge, ...]) -> str:
    """Return the page for a student."""
    by_name = {task.name: task for task in tasks}
    return page(student.student, _body(student, by_name))


def _body(student: Handed, tasks: dict[str, Challenge]) -> Iterator[str]:
    out_of = sum(mark.grade.out_of for mark in student.marks)
    if out_of and len(student.marks) > 1:
        yield paragraph(f"{student.points:g} of {out_of:g} points", "faint")
    for mark in student.marks:
        yield "<section>"
        yield from _section(mark, tasks.get(mark.grade.challenge))
        yield "</section>"


def _section(mark: Mark, task: Challenge | None) -> Iterator[str]:
    grade = mark.grade
    if task is not None:
        yield f"<h2>{words(task.name)}: {grade.points:g} of {grade.out_of:g} points</h2>"
        yield paragraph(task.task, "faint")
    for note in mark.submission.notes:
        yield paragraph(f"Note: {note}")
    if mark.submission.text is None:
        yield paragraph(f"What was handed in cannot be graded. {mark.submission.problem}", "hint")
        return
    if mark.submission.as_given:
        yield paragraph("This is the text that was given out: nothing in it was changed.", "hint")
    yield from _judged(grade, task)


def _judged(grade: Grade, task: Challenge | None) -> Iterator[str]:
    if grade.passed:
        yield f"<p>{sign(True)} It passed.</p>"
    first = grade.first_failed
    if grade.runs > 1:
        yield f"<p>{grade.runs_passed} of {grade.runs} runs passed.</p>"
    attempt = first or (grade.attempts[0] if grade.attempts else None)
    if attempt is None:
        return
    if first is not None:
        yield f"<h3>The first run that did not pass: world {words(first.world)}, seed {first.seed}</h3>"
    rows = [[sign(each.passed), words(each.sentence), words(each.reason)] for each in attempt.verdicts]
    yield table(("", "what was judged", "what happened"), rows)
    if first is not None and grade.hint:
        yield paragraph(f"Hint: {grade.hint}", "hint")
    if first is not None and task is not None:
        yield picture(task, first)
    if len(grade.attempts) > 1:
        yield "<h3>All runs</h3>"
        yield from _runs(grade)


def _runs(grade: Grade) -> Iterator[str]:
    """Yield a row for each world: which of its runs passed."""
    rows = []
    for world in dict.fromkeys(each.world for each in grade.attempts):
        runs = [each for each in grade.attempts if each.world == world]
        rows.append([words(world), " ".join(f"{sign(each.passed)}&nbsp;{each.seed}" for each in runs)])
    yield table(("world", "seeds"), rows)


def picture(task: Challenge, attempt: Attempt) -> str:
    """Return a picture of the world of a run with the way of the robot; empty if it never began."""
    if not attempt.path:
        return ""
    worlds = [world for world, _ in replace(task.whole(), seeds=(attempt.seed,)).runs]
    world = next((each for each in worlds if (each.name or "world") == attempt.world), None)
    if world is None:
        return ""
    drawn = svg(world, _PICTURE, caption=False, ways={"end": attempt.path})
    about = f"The robot at its start, and its way in {attempt.seconds:.1f} s."
    return f"<figure>{drawn}<figcaption class='faint'>{about}</figcaption></figure>"

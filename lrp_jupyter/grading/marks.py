"""The marks of a class: of each student for each challenge."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple
from xml.etree import ElementTree

from lrp_jupyter.grading.attempt import Attempt, failed
from lrp_jupyter.grading.batch import Progress, grade_each
from lrp_jupyter.grading.challenges import Challenge, challenge, challenges
from lrp_jupyter.grading.grade import Grade, jobs_of
from lrp_jupyter.grading.handing_in import code_of
from lrp_jupyter.grading.submissions import Submission
from lrp_jupyter.grading.workers import HowRun
from lrp_jupyter.spreadsheets import csv_text


class Mark(NamedTuple):
    """A submission and its grade."""

    submission: Submission
    grade: Grade

    @property
    def reason(self) -> str:
        """Why it cannot be read, or why the first run that failed did not pass; empty if all passed."""
        if self.submission.text is None:
            return self.submission.problem
        first = self.grade.first_failed
        return first.reason.partition("\n")[0] if first else ""

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be known of the submission, each a sentence."""
        return (*self.submission.notes, *self.grade.notes)

    @property
    def code(self) -> str:
        """The hand-in code, as the lab of an exam shows it; empty for what cannot be read."""
        text = self.submission.text
        return "" if text is None else code_of(text)


class Handed(NamedTuple):
    """The marks of one student.

    `entry`: the name of the file or folder that was handed in.
    `number`: by which Moodle or Canvas knows the student; may be empty.
    """

    student: str
    entry: str
    number: str
    marks: tuple[Mark, ...]

    @property
    def points(self) -> float:
        """The points for all challenges together."""
        return round(sum(mark.grade.points for mark in self.marks), 1)

    @property
    def is_read(self) -> bool:
        """Whether anything that was handed in can be read."""
        return any(mark.submission.text is not None for mark in self.marks)

    @property
    def is_from_moodle(self) -> bool:
        """Whether Moodle has named what was handed in."""
        return bool(self.number) and "_assign" in self.entry

    def mark(self, name: str) -> Mark | None:
        """Return the mark for a challenge; None if nothing was handed in for it."""
        return next((mark for mark in self.marks if mark.grade.challenge == name), None)


@dataclass(frozen=True)
class Marks:
    """The marks of a class.

    `tasks`: the challenges.
    `marks`: in the order of the submissions.
    """

    tasks: tuple[Challenge, ...]
    marks: tuple[Mark, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the challenges."""
        return tuple(task.name for task in self.tasks)

    @property
    def has_exam(self) -> bool:
        """Whether any of the challenges is an exam, whose hand-in codes are compared."""
        return any(task.exam for task in self.tasks)

    @property
    def out_of(self) -> float:
        """The points for programs that pass in all challenges."""
        return sum(task.points for task in self.tasks)

    @property
    def ungraded(self) -> tuple[Mark, ...]:
        """The marks of submissions that are for no challenge: they name none, or cannot be read."""
        return tuple(mark for mark in self.marks if not mark.grade.challenge)

    @property
    def attempts(self) -> tuple[Attempt, ...]:
        """The runs of all submissions."""
        return tuple(attempt for mark in self.marks for attempt in mark.grade.attempts)

    @property
    def students(self) -> tuple[Handed, ...]:
        """The marks of each student, in the order of the submissions and of the challenges."""
        found: dict[tuple[str, str, str], list[Mark]] = {}
        for mark in self.marks:
            each = mark.submission
            found.setdefault((each.student, each.entry, each.number), []).append(mark)
        order = {name: place for place, name in enumerate(self.names)}
        return tuple(
            Handed(*who, tuple(sorted(marks, key=lambda mark: order.get(mark.grade.challenge, -1))))
            for who, marks in found.items()
        )

    def csv(self, separator: str = ",") -> str:
        """Return a table with a row for each submission; ``first_…`` describes its first failed run."""
        rows = ([value(mark) for value in COLUMNS.values()] for mark in self.marks)
        return csv_text(tuple(COLUMNS), rows, separator)

    def table(self, separator: str = ",") -> str:
        """Return a table with a row for each student, and the points for each challenge in a column."""
        rows = (
            (each.student, *(_points(each.mark(name)) for name in self.names), each.points, self.out_of)
            for each in self.students
        )
        return csv_text(("student", *self.names, "points", "out_of"), rows, separator)

    def to_dict(self) -> dict[str, Any]:
        """Return everything that is known of every run, as plain data."""
        return {
            "challenge": ", ".join(self.names),
            "out_of": self.out_of,
            "submissions": [self._as_dict(mark) for mark in self.marks],
        }

    def _as_dict(self, mark: Mark) -> dict[str, Any]:
        submission, grade = mark
        return {
            "student": submission.student,
            "file": submission.file,
            "challenge": grade.challenge,
            "as_given": submission.as_given,
            "code": mark.code,
            "notes": mark.notes,
            "points": grade.points,
            "out_of": grade.out_of,
            "passed": grade.passed,
            "runs": grade.runs,
            "runs_passed": grade.runs_passed,
            "hints": grade.hints,
            "attempts": [{**each.to_dict(), "passed": each.passed} for each in grade.attempts],
        }

    def junit(self) -> str:
        """Return a test suite for each submission, and a test for each of its runs, as JUnit writes them."""
        root = ElementTree.Element("testsuites", name=_xml(", ".join(self.names)))
        for submission, grade in self.marks:
            attempts = grade.attempts
            errors = sum(bool(each.ended) for each in attempts)
            suite = ElementTree.SubElement(
                root,
                "testsuite",
                name=_xml(submission.student),
                file=_xml(submission.file),
                tests=str(len(attempts)),
                failures=str(sum(not each.passed for each in attempts) - errors),
                errors=str(errors),
                time=f"{sum(each.seconds for each in attempts):.1f}",
            )
            for each in attempts:
                case = ElementTree.SubElement(
                    suite,
                    "testcase",
                    classname=_xml(submission.student),
                    name=_xml(f"{grade.challenge} in {each.world}, seed {each.seed}"),
                    time=f"{each.seconds:.1f}",
                )
                if not each.passed:
                    kind = "error" if each.ended else "failure"
                    found = ElementTree.SubElement(
                        case, kind, message=_xml(each.reason), type=each.ended or kind
                    )
                    found.text = _xml("\n".join([*map(str, each.verdicts), *each.hints]))
        ElementTree.indent(root)
        return f'<?xml version="1.0" encoding="utf-8"?>\n{ElementTree.tostring(root, "unicode")}\n'


def grade_class(
    submissions: Sequence[Submission],
    task: Challenge | None = None,
    seeds: int | Iterable[int] | None = None,
    how: HowRun = HowRun(),  # noqa: B008  (an immutable value)
    progress: Progress = lambda done, of: None,
) -> Marks:
    """Grade the submissions of a class; one that cannot be read gets no points, and the others theirs.

    The worlds that a challenge hides from students count, too.

    `task`: the challenge; default: for each submission the one that it is for.
    Raises LRPError: the cluster cannot be reached, or a submission is for a challenge that does not exist.
    """
    tasks = [task or (challenge(each.challenge) if each.challenge else None) for each in submissions]
    named = {its.name: its for its in tasks if its is not None}
    whole = {name: its.whole() for name, its in named.items()}
    programs = [
        (each.text, whole[its.name])
        for each, its in zip(submissions, tasks, strict=True)
        if each.text is not None and its is not None
    ]
    graded = iter(grade_each(programs, seeds, how, progress))
    marks = tuple(
        Mark(each, next(graded) if each.text is not None and its else _unread(each, its, seeds))
        for each, its in zip(submissions, tasks, strict=True)
    )
    in_order = dict.fromkeys([*(each.name for each in challenges() if each.name in named), *named])
    return Marks(tuple(named[name] for name in in_order), marks)


def _unread(submission: Submission, task: Challenge | None, seeds: int | Iterable[int] | None) -> Grade:
    """Return the grade of a submission that cannot be read, or is for no challenge."""
    attempt = failed("text", "can be read", submission.problem)
    if task is None:
        return Grade("", (attempt,), 0, 1)
    jobs = jobs_of("", task.whole(), seeds)[1]
    return Grade.of(task, {0: attempt.of(jobs[0])}, jobs)


def _points(mark: Mark | None) -> object:
    return "" if mark is None else mark.grade.points


def _yes(value: bool) -> str:
    return "yes" if value else "no"


COLUMNS: dict[str, Callable[[Mark], object]] = {
    "student": lambda mark: mark.submission.student,
    "file": lambda mark: mark.submission.file,
    "challenge": lambda mark: mark.grade.challenge,
    "points": lambda mark: mark.grade.points,
    "out_of": lambda mark: mark.grade.out_of,
    "passed": lambda mark: _yes(mark.grade.passed),
    "runs_passed": lambda mark: mark.grade.runs_passed,
    "runs": lambda mark: mark.grade.runs,
    "first_world": lambda mark: mark.grade.first_failed.world if mark.grade.first_failed else "",
    "first_seed": lambda mark: mark.grade.first_failed.seed if mark.grade.first_failed else "",
    "first_reason": lambda mark: mark.reason,
    "first_hint": lambda mark: mark.grade.hint,
    "as_given": lambda mark: _yes(mark.submission.as_given),
    "code": lambda mark: mark.code,
    "notes": lambda mark: " ".join(mark.notes),
}
"""The columns of the table of marks, and what is in them."""

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def _xml(text: str) -> str:
    """Return a text without the characters that XML cannot hold."""
    return _NOT_XML.sub("�", text)

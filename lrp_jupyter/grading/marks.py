"""The marks of a class, for a spreadsheet (CSV), a program (JSON) or a build server (JUnit)."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple
from xml.etree import ElementTree

from lrp_jupyter.grading.attempt import Attempt, failed
from lrp_jupyter.grading.batch import Progress, grade_all
from lrp_jupyter.grading.challenges import Challenge
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
    def code(self) -> str:
        """The hand-in code, as the lab of an exam shows it; empty for what cannot be read."""
        text = self.submission.text
        return "" if text is None else code_of(text)


@dataclass(frozen=True)
class Marks:
    """The marks of a class for one challenge.

    `marks`: in the order of the submissions.
    `out_of`: the points for a program that passes.
    """

    challenge: str
    marks: tuple[Mark, ...]
    out_of: float

    @property
    def attempts(self) -> tuple[Attempt, ...]:
        """The runs of all submissions."""
        return tuple(attempt for mark in self.marks for attempt in mark.grade.attempts)

    def csv(self) -> str:
        """Return a table with a row for each submission; ``first_…`` describes its first failed run."""
        columns = ("student", "file", "challenge", "points", "out_of", "passed", "runs_passed", "runs")
        last = ("first_world", "first_seed", "first_reason", "first_hint", "as_given", "code", "notes")
        return csv_text((*columns, *last), self._rows())

    def _rows(self) -> Iterator[tuple[object, ...]]:
        for mark in self.marks:
            submission, grade = mark
            first = grade.first_failed
            yield (
                *(submission.student, submission.file, grade.challenge, grade.points, grade.out_of),
                *("yes" if grade.passed else "no", grade.runs_passed, grade.runs),
                *(first.world if first else "", first.seed if first else ""),
                *(first.reason.partition("\n")[0] if first else "", grade.hint),
                *("yes" if submission.as_given else "no", mark.code, " ".join(grade.notes)),
            )

    def to_json(self) -> str:
        """Return everything that is known of every run."""
        data = {
            "challenge": self.challenge,
            "out_of": self.out_of,
            "submissions": [self._as_dict(mark) for mark in self.marks],
        }
        return json.dumps(data, ensure_ascii=False, indent=1) + "\n"

    def _as_dict(self, mark: Mark) -> dict[str, Any]:
        submission, grade = mark
        return {
            "student": submission.student,
            "file": submission.file,
            "as_given": submission.as_given,
            "code": mark.code,
            "points": grade.points,
            "passed": grade.passed,
            "runs": grade.runs,
            "runs_passed": grade.runs_passed,
            "hints": grade.hints,
            "notes": grade.notes,
            "attempts": [{**each.to_dict(), "passed": each.passed} for each in grade.attempts],
        }

    def junit(self) -> str:
        """Return a test suite for each submission, and a test for each of its runs, as JUnit writes them."""
        root = ElementTree.Element("testsuites", name=_xml(self.challenge))
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
                    name=_xml(f"{self.challenge} in {each.world}, seed {each.seed}"),
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
    task: Challenge,
    seeds: int | Iterable[int] | None = None,
    how: HowRun = HowRun(),  # noqa: B008  (an immutable value)
    progress: Progress = lambda done, of: None,
) -> Marks:
    """Grade the submissions of a class; one that cannot be read gets no points, and the others theirs.

    Raises LRPError: the cluster cannot be reached.
    """
    texts = [each.text for each in submissions if each.text is not None]
    graded = iter(grade_all(texts, task, seeds, how, progress))
    return Marks(
        task.name,
        tuple(
            Mark(each, next(graded) if each.text is not None else _unread(each, task, seeds))
            for each in submissions
        ),
        task.points,
    )


def _unread(submission: Submission, task: Challenge, seeds: int | Iterable[int] | None) -> Grade:
    """Return the grade of a submission that cannot be read."""
    jobs = jobs_of("", task, seeds)[1]
    return Grade.of(task, {0: failed("text", "can be read", submission.problem).of(jobs[0])}, jobs)


_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def _xml(text: str) -> str:
    """Return a text without the characters that XML cannot hold."""
    return _NOT_XML.sub("�", text)


FORMS: dict[str, Callable[[Marks], str]] = {".csv": Marks.csv, ".json": Marks.to_json, ".xml": Marks.junit}
"""How marks are written, by the suffix of the file."""

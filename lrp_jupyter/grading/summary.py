"""What a teacher wants to know of a class: what fails, who is stuck, whose programs are alike."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.marks import Mark, Marks
from lrp_jupyter.grading.similarity import Alike, alike, groups_of

_MOST = 5  # failures that are printed


class Failure(NamedTuple):
    """Why first runs failed.

    `criterion`: the one that was not met.
    `by`: how many submissions.
    `hint`: the most frequent one; may be empty.
    """

    criterion: str
    by: int
    hint: str


class Summary(NamedTuple):
    """What is to be known of the marks for one challenge.

    `passed`, `of`: how many submissions passed, of how many.
    `average`: the points.
    `ran`: how many submissions were changed and could be run.
    `criteria`: how many of these met each criterion in every run.
    `failures`: the most frequent first.
    `as_given`, `no_progress`, `unread`: the students who have changed nothing, whose changes earn no points,
        and whose submission cannot be read.
    `alike`: programs that are, the most alike first.
    """

    challenge: str
    passed: int
    of: int
    average: float
    out_of: float
    ran: int
    criteria: dict[str, int]
    failures: tuple[Failure, ...]
    as_given: tuple[str, ...]
    no_progress: tuple[str, ...]
    unread: tuple[str, ...]
    alike: tuple[Alike, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return plain data."""
        lists = {name: [each._asdict() for each in getattr(self, name)] for name in ("failures", "alike")}
        return {**self._asdict(), **lists}

    @property
    def stuck(self) -> dict[str, tuple[str, ...]]:
        """Who needs help, by what kind of it, in words."""
        found = {
            "As given": self.as_given,
            "Changed, but no points yet": self.no_progress,
            "Cannot be read": self.unread,
        }
        return {what: names for what, names in found.items() if names}

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        average = f"{self.average:.1f} of {self.out_of:g} points on average"
        yield f"{self.challenge}: {self.passed} of {self.of} passed; {average}"
        for criterion, count in self.criteria.items() if self.ran else ():
            yield f"  {criterion}: {count} of {self.ran}"
        for failure in self.failures[:_MOST]:
            hint = f" Most often: {failure.hint}" if failure.hint else ""
            yield f"  First not met by {failure.by}: {failure.criterion}.{hint}"
        for what, names in self.stuck.items():
            yield f"  {what}: {', '.join(names)}"
        for group in groups_of(self.alike):
            least = min(pair.share for pair in self.alike if pair.first in group)
            more = " or more" if least < 1 else ""
            yield f"  Alike by {least:.0%}{more}: {', '.join(group)}"


def summaries(marks: Marks) -> tuple[Summary, ...]:
    """Return the summary of each challenge."""
    return tuple(
        _summary(task, [mark for mark in marks.marks if mark.grade.challenge == task.name])
        for task in marks.tasks
    )


def _summary(task: Challenge, marks: Sequence[Mark]) -> Summary:
    read = [mark for mark in marks if mark.submission.text is not None]
    changed = [mark for mark in read if not mark.submission.as_given]
    ran = [mark for mark in changed if not any(each.ended for each in mark.grade.attempts)]
    stuck = [mark for mark in changed if not mark.grade.points]
    return Summary(
        task.name,
        sum(mark.grade.passed for mark in marks),
        len(marks),
        sum(mark.grade.points for mark in marks) / len(marks) if marks else 0.0,
        task.points,
        len(ran),
        {each.sentence: sum(_meets(mark, each.sentence) for mark in ran) for each in task.criteria},
        tuple(_failures(changed)),
        _students(mark for mark in read if mark.submission.as_given),
        _students(stuck),
        _students(mark for mark in marks if mark.submission.text is None),
        _alike(ran, task),
    )


def _meets(mark: Mark, sentence: str) -> bool:
    """Return whether a criterion is met in every run."""
    verdicts = [each for run in mark.grade.attempts for each in run.verdicts if each.sentence == sentence]
    return all(each.passed for each in verdicts)


def _failures(marks: Sequence[Mark]) -> Iterator[Failure]:
    failed = [(first, mark) for mark in marks if (first := mark.grade.first_failed) and not mark.grade.passed]
    found = [(first.failure.sentence, mark.grade.hint) for first, mark in failed if first.failure]
    for criterion, count in Counter(sentence for sentence, _ in found).most_common():
        hints = Counter(hint for sentence, hint in found if sentence == criterion and hint)
        yield Failure(criterion, count, next((hint for hint, _ in hints.most_common(1)), ""))


def _students(marks: Iterator[Mark] | Sequence[Mark]) -> tuple[str, ...]:
    return tuple(mark.submission.student for mark in marks)


def _alike(marks: Sequence[Mark], task: Challenge) -> tuple[Alike, ...]:
    """Return which programs are alike; only those that were run, which are known to be read in time."""
    texts: dict[str, str] = {}
    for mark in marks:
        each = mark.submission
        name = each.student if each.student not in texts else f"{each.student} ({each.file})"
        texts[name] = each.text or ""
    given = next((mark.submission.given for mark in marks if mark.submission.given), task.beginning)
    return tuple(alike(texts, given))

"""The marks of a class as a page for its teacher: students by challenges, and what is to be known."""

from __future__ import annotations

from collections.abc import Iterator

from lrp_jupyter.grading.marks import Handed, Marks
from lrp_jupyter.grading.pages import page, paragraph, sign, table, words
from lrp_jupyter.grading.similarity import groups_of
from lrp_jupyter.grading.summary import Summary, summaries


def class_page(marks: Marks) -> str:
    """Return the page."""
    return page(", ".join(marks.names) or "Marks", _body(marks))


def _body(marks: Marks) -> Iterator[str]:
    yield paragraph(f"{len(marks.students)} students, {marks.out_of:g} points", "faint")
    yield table(
        ("student", *marks.names, "points", "first reason, notes"),
        (
            [
                words(each.student),
                *(_cell(each, name) for name in marks.names),
                f"{each.points:g}",
                _about(each),
            ]
            for each in marks.students
        ),
    )
    if marks.ungraded:
        yield paragraph(f"Not graded: {', '.join(mark.submission.student for mark in marks.ungraded)}")
    for summary in summaries(marks):
        yield "<section>"
        yield from _section(summary)
        yield "</section>"


def _row(student: Handed, names: tuple[str, ...]) -> list[str]:
    cells = (_cell(student, name) for name in names)
    return [words(student.student), *cells, f"{student.points:g}", _about(student)]


def _cell(student: Handed, name: str) -> str:
    mark = student.mark(name)
    if mark is None:
        return ""
    given = " as given" if mark.submission.as_given else ""
    return f"{sign(mark.grade.passed)}&nbsp;{mark.grade.points:g}{given}"


def _about(student: Handed) -> str:
    several = len(student.marks) > 1
    lines = []
    for mark in student.marks:
        said = " ".join([*filter(None, [mark.reason]), *mark.notes])
        if said:
            lines.append(words(f"{mark.grade.challenge}: {said}" if several else said))
    return "<br>".join(lines)


def _section(summary: Summary) -> Iterator[str]:
    yield f"<h2>{words(summary.challenge)}</h2>"
    average = f"{summary.average:.1f} of {summary.out_of:g} points on average"
    yield paragraph(f"{summary.passed} of {summary.of} passed; {average}.")
    if summary.ran:
        rows = ((words(each), f"{count} of {summary.ran}") for each, count in summary.criteria.items())
        yield table(("criterion", "met in every run"), rows)
    if summary.failures:
        failures = ((words(each.criterion), str(each.by), words(each.hint)) for each in summary.failures)
        yield table(("first not met", "by", "the most frequent hint"), failures)
    for what, names in summary.stuck.items():
        yield paragraph(f"{what}: {', '.join(names)}")
    if summary.alike:
        pairs = summary.alike[:_MOST]
        yield table(
            ("alike", "", "share"),
            ((words(each.first), words(each.second), f"{each.share:.0%}") for each in pairs),
        )
        if len(summary.alike) > _MOST:
            groups = "; ".join(", ".join(group) for group in groups_of(summary.alike))
            yield paragraph(f"And {len(summary.alike) - _MOST} more pairs, among: {groups}.")
        yield paragraph(_FIGURE, "faint")


_MOST = 30  # pairs
_FIGURE = (
    "The share of what two students wrote themselves that is the same, whatever the names, comments and "
    "layout. A figure, not a verdict: a short task has few answers."
)

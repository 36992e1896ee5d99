"""``lrp grade`` and ``lrp sweep``: batches of runs in virtual time, on all processors or on a cluster."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import typer
from rich.text import Text

from lrp_jupyter.cli.console import plain_console
from lrp_jupyter.cli.excerpt import print_findings
from lrp_jupyter.cli.lists import show_table, table_of
from lrp_jupyter.cli.program_source import read_source
from lrp_jupyter.cli.run_options import check_outputs, pairs_of
from lrp_jupyter.errors import FileError, LRPSyntaxError
from lrp_jupyter.files import shown, write_file
from lrp_jupyter.grading.attempt import Attempt
from lrp_jupyter.grading.challenges import Challenge, load
from lrp_jupyter.grading.feedback import write_feedback
from lrp_jupyter.grading.gradebooks import fill_in
from lrp_jupyter.grading.marks import Mark, Marks, grade_class
from lrp_jupyter.grading.marks_forms import FORMS
from lrp_jupyter.grading.progress import shown_progress
from lrp_jupyter.grading.submissions import Submission, find_submissions
from lrp_jupyter.grading.summary import summaries
from lrp_jupyter.grading.sweep import Sweep, Value, sweep_axes
from lrp_jupyter.grading.workers import HowRun
from lrp_jupyter.repairs.class_repairs import with_repairs

_MOST = 1000  # values of a variable


class MarksFiles(NamedTuple):
    """Where the marks of a class are written.

    `out`: files in the forms of `FORMS`.
    `table`: a table of students and challenges.
    `feedback`: a folder, for a page for each student.
    `gradebook`: a table of Moodle or Canvas, of which a copy is filled in.
    `column`: the one of the gradebook for the points.
    `separator`: between the cells of tables.
    """

    out: Sequence[Path] = ()
    table: Path | None = None
    feedback: Path | None = None
    gradebook: Path | None = None
    column: str | None = None
    separator: str = ","

    @property
    def filled(self) -> Path | None:
        """The copy of the gradebook."""
        book = self.gradebook
        return None if book is None else book.with_name(f"{book.stem}-marked{book.suffix}")

    @property
    def named(self) -> list[Path]:
        """All that the command names beside submissions."""
        found = (*self.out, self.table, self.feedback, self.gradebook, self.filled)
        return [path for path in found if path is not None]

    def check(self) -> None:
        """Raise an error if something cannot be written, before anything runs."""
        check_outputs(self.out, tuple(FORMS))
        check_outputs([self.table] if self.table else [], (".csv",))
        if self.feedback is not None and not self.feedback.absolute().parent.is_dir():
            raise FileError(f"`{shown(self.feedback)}` cannot be written: there is no such folder around it.")
        if self.gradebook is not None and not self.gradebook.is_file():
            raise FileError(f"`{shown(self.gradebook)}` is not a file. Name the table that you downloaded.")

    def write(self, marks: Marks) -> Iterator[str]:
        """Write the files, and yield what is to be told."""
        for path in self.out:
            write_file(path, FORMS[path.suffix.lower()](marks, self.separator))
            yield f"written: {path}"
        if self.table is not None:
            write_file(self.table, marks.table(self.separator))
            yield f"written: {self.table}"
        if self.feedback is not None:
            pages = write_feedback(marks, self.feedback)
            yield f"written: {len(pages)} pages in {self.feedback}"
        if self.gradebook is not None and self.filled is not None:
            filled = fill_in(self.gradebook, marks, self.column)
            write_file(self.filled, filled.text)
            yield f"written: {self.filled}, rows with points: {filled.rows}"
            yield from filled.notes


def grade_files(
    files: Sequence[str],
    name: str | None,
    seeds: int | None,
    where: MarksFiles,
    how: HowRun,
    given: Path | None = None,
    repair: bool = False,
) -> int:
    """Grade one program and explain its grade, or those of a class and list them; return the exit code.

    `name`: the challenge; None for those that the programs name.
    `repair`: whether to say of each program that does not pass which change would make it pass.
    """
    task = None if name is None else load(name)
    where.check()
    submissions = _submissions(files, task, given, where.named)
    alone = len(files) == len({each.entry for each in submissions}) == 1 and not _is_class(files[0])
    if alone and submissions[0].text is None:
        raise FileError(submissions[0].problem)
    if alone:
        marks = grade_class(submissions, task, seeds, how)
    else:
        with shown_progress("grading", lines=True) as progress:
            marks = grade_class(submissions, task, seeds, how, progress)
    if repair:
        with shown_progress("trying changes") as progress:
            marks = with_repairs(marks, seeds, how, progress)
    (_explain if alone else _list)(marks)
    fewer = [each for each in marks.tasks if seeds is not None and seeds < each.count]
    if fewer:
        plain_console().print(f"Note: {_said(fewer)}, and with {seeds} a program may pass by luck.")
    for line in where.write(marks):
        if not alone or not line.startswith("written"):
            plain_console().print(line)
    return _code(marks.attempts) or int(alone and not all(mark.grade.passed for mark in marks.marks))


def _said(tasks: Sequence[Challenge]) -> str:
    """Say how many seeds challenges have."""
    if len(tasks) == 1:
        return f"the challenge has {tasks[0].count} seeds"
    return "the challenges have more seeds"


def _is_class(file: str) -> bool:
    return Path(file).is_dir() or file.lower().endswith(".zip")


def sweep_file(
    file: str,
    name: str,
    assignments: Sequence[str],
    seeds: int,
    out: Sequence[Path],
    picture: Path | None,
    how: HowRun,
) -> int:
    """Sweep variables of a program and print a table; return 1 if it is not a valid program."""
    task, axes = load(name), parse_axes(assignments)
    check_outputs(out, (".csv", ".json"))
    check_outputs([picture] if picture else [], (".svg",))
    if picture is not None and len(axes) > 2:
        raise typer.BadParameter("--map draws one or two variables. Leave out a `--set`, or the map.")
    source = read_source(file)
    try:
        with shown_progress("sweep", lines=True) as progress:
            result = sweep_axes(source.text, task, axes, seeds, how, progress)
    except LRPSyntaxError as error:
        print_findings(source.name, source.text, error.findings)
        return 1
    _show_sweep(result)
    for path in out:
        write_file(path, result.csv() if path.suffix.lower() == ".csv" else result.to_json())
    if picture is not None:
        write_file(picture, result.svg())
    for path in [*out, picture] if picture else out:
        plain_console().print(f"written: {path}")
    return _code([attempt for point in result.points for attempt in point.grade.attempts])


def _show_sweep(result: Sweep) -> None:
    table = table_of(*result.variables, "passed", "points", "median", "worst", "")
    for point in result.points:
        passed = f"{point.passed} of {point.grade.runs}"
        times = ("" if time is None else f"{time:.1f} s" for time in (point.median, point.worst))
        values = (f"{value:g}" if isinstance(value, float) else str(value) for value in point.values)
        cells = (*values, passed, f"{point.grade.points:g}", *times, result.remark(point))
        table.add_row(*map(Text, cells))
    show_table(table)
    for note in result.notes():
        plain_console().print(note)


def parse_axes(assignments: Sequence[str]) -> dict[str, tuple[Value, ...]]:
    """Return the values of each variable of a sweep: ``NAME=FROM:TO:COUNT`` or ``NAME=A,B,…``."""
    axes: dict[str, tuple[Value, ...]] = {}
    for name, text in pairs_of(assignments, "--set"):
        if name in axes:
            raise typer.BadParameter(f"--set {name} is given twice. Write all its values into one.")
        steps = text.split(":")
        axes[name] = _steps(name, text) if len(steps) > 1 else _listed(name, text)
    return axes


def _steps(name: str, text: str) -> tuple[Value, ...]:
    try:
        first, last, count = (
            convert(part) for convert, part in zip((float, float, int), text.split(":"), strict=True)
        )
    except ValueError:
        first = last = count = math.nan
    if not (math.isfinite(first) and math.isfinite(last) and 2 <= count <= _MOST):
        raise typer.BadParameter(
            f"--set {name} takes FROM:TO:COUNT with a count of 2 to {_MOST:,}, as in `{name}=0.4:1.2:9`, "
            f"not `{text}`."
        )
    return tuple(float(f"{first + (last - first) * step / (count - 1):.12g}") for step in range(count))


def _listed(name: str, text: str) -> tuple[Value, ...]:
    try:
        values = ast.literal_eval(f"({text},)")
    except (ValueError, SyntaxError):
        values = (None,)
    if not all(isinstance(value, Value) for value in values):
        raise typer.BadParameter(
            f"--set {name} takes numbers, or texts in quotation marks, as in `{name}=0.1,0.2,0.3`, "
            f"not `{text}`."
        )
    return tuple(dict.fromkeys(values))


def _submissions(
    files: Sequence[str], task: Challenge | None, given: Path | None, apart_from: Sequence[Path]
) -> list[Submission]:
    found: list[Submission] = []
    for file in files:
        if Path(file).exists():
            found += find_submissions([file], task, given, [*apart_from, *([given] if given else [])])
        else:
            source = read_source(file)
            name = task.name if task else source.challenge or ""
            found.append(Submission(source.name, source.name, source.text, challenge=name))
    return found


def _explain(marks: Marks) -> None:
    for mark in marks.marks:
        more = [f"Note: {note}" for note in mark.submission.notes]
        more += [f"Hand-in code: {mark.code}"] if marks.has_exam else []
        report = Text("\n".join([f"{mark.submission.file}, {mark.grade}", *more]))
        report.highlight_regex(r"✓", "green")
        report.highlight_regex(r"✗", "bold red")
        report.highlight_regex(r"(?m)^(?:Hint|Note):", "bold yellow")
        plain_console().print(report)


def _list(marks: Marks) -> None:
    if len(marks.tasks) == 1:
        _list_reasons(marks)
    else:
        _list_tasks(marks)
    for summary in summaries(marks):
        plain_console().print(Text(str(summary)))
    if marks.ungraded:
        names = ", ".join(mark.submission.student for mark in marks.ungraded)
        plain_console().print(Text(f"Not graded: {names}"))


def _list_reasons(marks: Marks) -> None:
    """Print a row for each submission, for one challenge."""
    table = table_of("student", "points", "runs", *(["code"] if marks.has_exam else []), "first reason")
    for mark in marks.marks:
        grade = mark.grade
        points = Text(f"{grade.points:g} of {grade.out_of:g}", _colour(mark))
        runs = Text(f"{grade.runs_passed} of {grade.runs}")
        said = ("as given." if mark.submission.as_given else "", mark.reason, *mark.notes)
        table.add_row(
            Text(mark.submission.student, "bold"),
            points,
            runs,
            *([Text(mark.code)] if marks.has_exam else []),
            Text(" ".join(filter(None, said)), no_wrap=True, overflow="ellipsis"),
        )
    show_table(table)


def _colour(mark: Mark) -> str:
    return "green" if mark.grade.passed else "bold red"


def _list_tasks(marks: Marks) -> None:
    """Print a row for each student, with a column for each challenge."""
    table = table_of("student", *marks.names, "points", "notes")
    for student in marks.students:
        found = (student.mark(name) for name in marks.names)
        cells = (
            Text("") if mark is None else Text(f"{mark.grade.points:g}", _colour(mark)) for mark in found
        )
        said = [mark.submission.problem for mark in student.marks if mark.submission.text is None]
        said += [note for mark in student.marks for note in mark.notes]
        table.add_row(
            Text(student.student, "bold"),
            *cells,
            Text(f"{student.points:g} of {marks.out_of:g}"),
            Text(" ".join(said), no_wrap=True, overflow="ellipsis"),
        )
    show_table(table)


def _code(attempts: Sequence[Attempt]) -> int:
    """Return 3, and print why, if the package itself failed in a run."""
    faults = [attempt for attempt in attempts if attempt.ended == "fault"]
    if not faults:
        return 0
    plain_console(stderr=True).print(
        f"lrp: In {len(faults)} of the runs it was not the program that failed, but what runs and judges it. "
        f"Report this:\n{faults[0].verdicts[0].reason}"
    )
    return 3

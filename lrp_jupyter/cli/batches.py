"""``lrp grade`` and ``lrp sweep``: batches of runs in virtual time, on all processors or on a cluster."""

from __future__ import annotations

import ast
import math
from collections.abc import Sequence
from pathlib import Path

import typer
from rich.text import Text

from lrp_jupyter.cli.console import plain_console
from lrp_jupyter.cli.excerpt import print_findings
from lrp_jupyter.cli.lists import show_table, table_of
from lrp_jupyter.cli.program_source import read_source
from lrp_jupyter.cli.run_options import check_outputs, pairs_of
from lrp_jupyter.errors import FileError, LRPSyntaxError
from lrp_jupyter.files import write_file
from lrp_jupyter.grading.attempt import Attempt
from lrp_jupyter.grading.challenges import Challenge, load
from lrp_jupyter.grading.marks import FORMS, Marks, grade_class
from lrp_jupyter.grading.progress import shown_progress
from lrp_jupyter.grading.submissions import Submission, find_submissions
from lrp_jupyter.grading.sweep import Sweep, Value, sweep_axes
from lrp_jupyter.grading.workers import HowRun

_MOST = 1000  # values of a variable


def grade_files(
    files: Sequence[str],
    name: str,
    seeds: int | None,
    out: Sequence[Path],
    how: HowRun,
    given: Path | None = None,
) -> int:
    """Grade one program and explain its grade, or those of a class and list them; return the exit code."""
    task = load(name)
    whole = task.whole()
    check_outputs(out, tuple(FORMS))
    submissions = _submissions(files, task, given)
    alone = len(files) == 1 and not Path(files[0]).is_dir()
    if alone and submissions[0].text is None:
        raise FileError(submissions[0].problem)
    if alone:
        marks = grade_class(submissions, whole, seeds, how)
        _explain(marks, task.exam)
    else:
        with shown_progress("grading", lines=True) as progress:
            marks = grade_class(submissions, whole, seeds, how, progress)
        _list(marks, task.exam)
    if seeds is not None and seeds < task.count:
        plain_console().print(
            f"Note: the challenge has {task.count} seeds, and with {seeds} a program may pass by luck."
        )
    for path in out:
        write_file(path, FORMS[path.suffix.lower()](marks))
        if not alone:
            plain_console().print(f"written: {path}")
    return _code(marks.attempts) or int(alone and not marks.marks[0].grade.passed)


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


def _submissions(files: Sequence[str], task: Challenge, given: Path | None) -> list[Submission]:
    found: list[Submission] = []
    for file in files:
        if Path(file).exists():
            found += find_submissions([file], task, given)
        else:
            source = read_source(file)
            found.append(Submission(source.name, source.name, source.text))
    return found


def _explain(marks: Marks, is_exam: bool) -> None:
    mark = marks.marks[0]
    code = f"\nHand-in code: {mark.code}" if is_exam else ""
    report = Text(f"{mark.submission.file}, {mark.grade}{code}")
    report.highlight_regex(r"✓", "green")
    report.highlight_regex(r"✗", "bold red")
    report.highlight_regex(r"(?m)^Hint:", "bold yellow")
    plain_console().print(report)


def _list(marks: Marks, is_exam: bool) -> None:
    table = table_of("student", "points", "runs", *(["code"] if is_exam else []), "first reason")
    for mark in marks.marks:
        grade = mark.grade
        points = Text(f"{grade.points:g} of {grade.out_of:g}", "green" if grade.passed else "bold red")
        runs = Text(f"{grade.runs_passed} of {grade.runs}")
        reason = grade.first_failed.reason.partition("\n")[0] if grade.first_failed else ""
        if mark.submission.as_given:
            reason = f"as given. {reason}"
        table.add_row(
            Text(mark.submission.student, "bold"),
            points,
            runs,
            *([Text(mark.code)] if is_exam else []),
            Text(reason, no_wrap=True, overflow="ellipsis"),
        )
    show_table(table)
    grades = [mark.grade for mark in marks.marks]
    mean = sum(grade.points for grade in grades) / len(grades)
    passed = sum(grade.passed for grade in grades)
    average = f"{mean:.1f} of {marks.out_of:g} points on average"
    plain_console().print(f"{marks.challenge}: {passed} of {len(grades)} passed; {average}")


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

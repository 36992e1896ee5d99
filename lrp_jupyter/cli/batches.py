"""``lrp grade`` and ``lrp sweep``: batches of runs in virtual time, on all processors or on a cluster."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.text import Text

from lrp_jupyter.cli.excerpt import plain_console
from lrp_jupyter.cli.lists import show_table, table_of
from lrp_jupyter.cli.progress import shown_progress
from lrp_jupyter.cli.source import read_source
from lrp_jupyter.errors import FileError, LRPError
from lrp_jupyter.files import shown, write_file
from lrp_jupyter.grading.batch import HowRun
from lrp_jupyter.grading.challenges import Challenge, challenge
from lrp_jupyter.grading.marks import FORMS, Marks, grade_class
from lrp_jupyter.grading.submissions import Submission, find_submissions

__all__ = ["grade_files"]


def grade_files(files: Sequence[str], name: str, seeds: int | None, out: Sequence[Path], how: HowRun) -> int:
    """Grade one program and explain its grade, or those of a class and list them; return the exit code.

    It is 1 if the one program does not pass, and 0 if a class is graded, whatever the marks are.
    """
    task = challenge(name)
    check_outputs(out, tuple(FORMS))
    submissions = _submissions(files, task)
    alone = len(files) == 1 and not Path(files[0]).is_dir()
    if alone and submissions[0].text is None:
        raise FileError(submissions[0].problem)
    if alone:
        marks = grade_class(submissions, task, seeds, how)
        _explain(marks)
    else:
        with shown_progress("grading") as progress:
            marks = grade_class(submissions, task, seeds, how, progress)
        _list(marks)
    for path in out:
        write_file(path, FORMS[path.suffix.lower()](marks))
        if not alone:
            plain_console().print(f"written: {path}")
    return _code(marks) or int(alone and not marks.marks[0].grade.passed)


def check_outputs(out: Sequence[Path], suffixes: Sequence[str]) -> None:
    """Raise an error if a file cannot be written, or its suffix names no format; before anything runs."""
    listed = ", ".join(f"`{suffix}`" for suffix in suffixes[:-1])
    known = f"{listed} or `{suffixes[-1]}`" if listed else f"`{suffixes[-1]}`"
    for path in out:
        if path.suffix.lower() not in suffixes:
            raise LRPError(f"`{shown(path)}` cannot be written: the name must end with {known}.")
        if not path.absolute().parent.is_dir():
            raise FileError(f"`{shown(path)}` cannot be written: there is no such folder. Create it first.")


def _submissions(files: Sequence[str], task: Challenge) -> list[Submission]:
    found: list[Submission] = []
    for file in files:
        if Path(file).exists():
            found += find_submissions([file], task)
        else:
            source = read_source(file)
            found.append(Submission(source.name, source.name, source.text))
    return found


def _explain(marks: Marks) -> None:
    mark = marks.marks[0]
    report = Text(f"{mark.submission.file}, {mark.grade}")
    report.highlight_regex(r"✓", "green")
    report.highlight_regex(r"✗", "bold red")
    report.highlight_regex(r"(?m)^Hint:", "bold yellow")
    plain_console().print(report)


def _list(marks: Marks) -> None:
    table = table_of("student", "points", "runs", "first reason")
    for mark in marks.marks:
        grade = mark.grade
        points = Text(f"{grade.points:g} of {grade.out_of:g}", "green" if grade.passed else "bold red")
        runs = Text(f"{mark.runs_passed} of {grade.runs}")
        reason = mark.reason.partition("\n")[0]
        table.add_row(
            Text(mark.submission.student, "bold"),
            points,
            runs,
            Text(reason, no_wrap=True, overflow="ellipsis"),
        )
    show_table(table)
    grades = [mark.grade for mark in marks.marks]
    mean = sum(grade.points for grade in grades) / len(grades)
    passed = sum(grade.passed for grade in grades)
    average = f"{mean:.1f} of {marks.out_of:g} points on average"
    plain_console().print(f"{marks.challenge}: {passed} of {len(grades)} passed; {average}")


def _code(marks: Marks) -> int:
    """Return 3, and print why, if the package itself failed in a run."""
    if not marks.faults:
        return 0
    reason = marks.faults[0].verdicts[0].reason
    plain_console(stderr=True).print(
        f"lrp: In {len(marks.faults)} of the runs not the program failed, but what runs and judges it. "
        f"Report this:\n{reason}"
    )
    return 3

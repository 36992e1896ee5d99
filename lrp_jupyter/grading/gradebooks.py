"""Marks in the tables of Moodle and Canvas: a copy of the table that a teacher has downloaded, filled in.

Moodle's *offline grading worksheet* gets the grade and a comment, Canvas's gradebook the column of the
assignment. All else in the table stays as it is: its rows, their order, the separator, the decimal comma.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple

from lrp_jupyter.errors import FileError, did_you_mean
from lrp_jupyter.files import read_text, shown
from lrp_jupyter.grading.marks import Handed, Marks
from lrp_jupyter.grading.submissions import slug
from lrp_jupyter.spreadsheets import decimal

_MOODLE = {  # the headings of the columns, in English and in German
    "identifier": ("Identifier", "ID"),
    "name": ("Full name", "Vollständiger Name"),
    "grade": ("Grade", "Bewertung"),
    "most": ("Maximum Grade", "Maximum grade", "Bestwertung"),
    "comment": ("Feedback comments", "Feedback als Kommentar"),
    "open": ("Grade can be changed", "Bewertung kann geändert werden"),
}
_CANVAS = ("Student", "ID", "Section")
_POSSIBLE = "points possible"
_DIGITS = re.compile(r"\d+$")


class Filled(NamedTuple):
    """A table that was filled in.

    `text`: the table.
    `rows`: how many of them got points.
    `notes`: what a teacher has to know, each a sentence.
    """

    text: str
    rows: int
    notes: tuple[str, ...]


class _Table(NamedTuple):
    """A table as it was downloaded."""

    rows: list[list[str]]
    separator: str
    line_end: str
    is_marked: bool  # by the mark of UTF-8

    def written(self) -> str:
        file = io.StringIO()
        csv.writer(file, delimiter=self.separator, lineterminator=self.line_end).writerows(self.rows)
        return "\ufeff" * self.is_marked + file.getvalue()

    @property
    def has_comma(self) -> bool:
        """Whether its numbers have a decimal comma."""
        cells = [cell for row in self.rows for cell in row]
        commas = any(re.fullmatch(r"\d+,\d+", cell) for cell in cells)
        points = any(re.fullmatch(r"\d+\.\d+", cell) for cell in cells)
        return commas or (self.separator == ";" and not points)


def fill_in(path: Path, marks: Marks, column: str | None = None) -> Filled:
    """Return a teacher's table with the marks in it.

    `column`: the heading of the column for the points; default: *Grade* in Moodle, and in Canvas for each
        challenge the column that has its name.
    Raises FileError: the table cannot be read, is neither Moodle's nor Canvas's, or has no such column.
    """
    table = _read(path)
    head = table.rows[0]
    if set(_CANVAS) <= set(head):
        return _canvas(path, table, marks, column)
    places = {what: _place(head, names) for what, names in _MOODLE.items()}
    if column is not None:
        places["grade"] = _column(path, head, column)
    if places["grade"] is None or (places["identifier"] is None and places["name"] is None):
        raise FileError(
            f"`{shown(path)}` is neither Moodle's grading worksheet nor Canvas's gradebook: its columns are "
            f"{_listed(head)}. Download it with the language set to English, and keep its first line."
        )
    return _moodle(table, marks, places)


# -- Moodle ----------------------------------------------------------------------------------------


def _moodle(table: _Table, marks: Marks, places: dict[str, int | None]) -> Filled:
    students = _Students(marks)
    notes = []
    locked = []
    count = 0
    for row in table.rows[1:]:
        number = _DIGITS.search(_cell(row, places["identifier"]))
        student = students.find(number[0] if number else "", _cell(row, places["name"]))
        if student is None:
            continue
        if _cell(row, places["open"]).casefold() in ("no", "nein"):
            locked.append(student.student)
            continue
        most = _cell(row, places["most"])
        _put(row, places["grade"], _scaled(student.points, marks.out_of, most, table))
        _put(row, places["comment"], _comment(student))
        count += 1
    if locked:
        notes.append(f"Moodle does not let you change the grades of {', '.join(locked)}.")
    if places["comment"] is None:
        notes.append(
            "There is no column for comments. Switch on *Feedback comments* in the assignment for it."
        )
    return Filled(table.written(), count, (*notes, *students.notes()))


def _comment(student: Handed) -> str:
    """Return what a student reads in Moodle, which takes it as HTML."""
    lines = []
    for mark in student.marks:
        grade = mark.grade
        lines.append(f"{grade.challenge or 'Not graded'}: {grade.points:g} of {grade.out_of:g} points.")
        lines += [mark.submission.problem] if mark.submission.text is None else [mark.reason]
        lines += [f"Hint: {grade.hint}"] if grade.hint else []
    return "<br>".join(escape(line, quote=False).replace("\n", "<br>") for line in lines if line)


# -- Canvas ----------------------------------------------------------------------------------------


def _canvas(path: Path, table: _Table, marks: Marks, column: str | None) -> Filled:
    head = table.rows[0]
    places: dict[str, int] = {}
    if column is not None:
        place = _column(path, head, column)
    else:
        named = {slug(re.sub(r"\s*\(\d+\)$", "", cell)): place for place, cell in enumerate(head)}
        places = {name: named[slug(name)] for name in marks.names if slug(name) in named}
        if not places:
            raise FileError(
                f"`{shown(path)}` has no column for {_listed(marks.names)}. Choose one with `--column NAME`: "
                f"{_listed(head)}."
            )
    students = _Students(marks)
    possible = next((row for row in table.rows[1:] if row and row[0].strip().casefold() == _POSSIBLE), [])
    count = 0
    for row in table.rows[1:]:
        name, number = _cell(row, head.index("Student")), _cell(row, head.index("ID"))
        if row is possible or not (student := students.find(number, name)):
            continue
        if column is not None:
            _put(row, place, _scaled(student.points, marks.out_of, _cell(possible, place), table))
        for task in marks.tasks:
            mark = student.mark(task.name)
            if mark is not None and task.name in places:
                at = places[task.name]
                _put(row, at, _scaled(mark.grade.points, task.points, _cell(possible, at), table))
        count += 1
    left = [name for name in marks.names if column is None and name not in places]
    notes = [f"There is no column for {_listed(left)}."] if left else []
    return Filled(table.written(), count, (*notes, *students.notes()))


# -- both ------------------------------------------------------------------------------------------


class _Students:
    """The students of a class, who are found by a number or a name."""

    def __init__(self, marks: Marks) -> None:
        self._all = marks.students
        self._found: set[int] = set()
        self._by: dict[str, list[int]] = {}
        for index, student in enumerate(self._all):
            for key in {student.number, *_keys(student.student)} - {""}:
                self._by.setdefault(key, []).append(index)

    def find(self, number: str, name: str) -> Handed | None:
        """Return the student with a number, or else the only one of a name."""
        for key in (number, *_keys(name)):
            found = self._by.get(key, [])
            if len(found) == 1 and (
                key == number or number == "" or self._all[found[0]].number in ("", number)
            ):
                self._found.add(found[0])
                return self._all[found[0]]
        return None

    def notes(self) -> list[str]:
        """Say whose marks were not put into any row."""
        missed = [each.student for index, each in enumerate(self._all) if index not in self._found]
        if not missed:
            return []
        return [f"No row was found for {', '.join(missed)}. Enter the points yourself, or correct the names."]


def _keys(name: str) -> list[str]:
    """Return a name as it is compared: its words in any order; and joined in their order, as Canvas does."""
    words = re.findall(r"\w+", name.casefold())
    return [" ".join(sorted(words)), "".join(words)] if words else []


def _read(path: Path) -> _Table:
    text = read_text(path)
    first = text.partition("\n")[0]
    separator = max(",;\t", key=first.count)
    rows = list(csv.reader(io.StringIO(text, newline=""), delimiter=separator))
    if not rows or len(rows[0]) < 2:
        raise FileError(f"`{shown(path)}` is not a table. Download the worksheet again as CSV.")
    return _Table(
        rows, separator, "\r\n" if "\r\n" in text else "\n", path.read_bytes()[:3] == b"\xef\xbb\xbf"
    )


def _place(head: Sequence[str], names: Sequence[str]) -> int | None:
    return next((place for place, cell in enumerate(head) if cell.strip() in names), None)


def _column(path: Path, head: Sequence[str], name: str) -> int:
    found = [place for place, cell in enumerate(head) if slug(cell) == slug(name)]
    found = found or [place for place, cell in enumerate(head) if slug(cell).startswith(slug(name))]
    if len(found) != 1:
        listed = ", ".join(f"`{each}`" for each in head)
        raise FileError(
            f"`{shown(path)}` has no column `{name}`.{did_you_mean(name, head)} Choose one of {listed}."
        )
    return found[0]


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"`{each}`" for each in names)


def _cell(row: Sequence[str], place: int | None) -> str:
    return row[place].strip() if place is not None and place < len(row) else ""


def _put(row: list[str], place: int | None, text: str) -> None:
    if place is not None:
        row += [""] * (place + 1 - len(row))
        row[place] = text


def _scaled(points: float, out_of: float, most: str, table: _Table) -> str:
    """Return points as a share of the most that the table has for them, or as they are where it says none."""
    try:
        whole = float(most.replace(",", "."))
    except ValueError:
        whole = out_of
    share = points / out_of if out_of else 0.0
    number = round(share * (whole or out_of), 2)
    return decimal(number, table.has_comma)

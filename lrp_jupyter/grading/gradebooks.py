"""Marks in the tables of Moodle and Canvas: a copy of the table that a teacher has downloaded, filled in.

Moodle's *offline grading worksheet* gets the grade and a comment, Canvas's gradebook the column of the
assignment. All else in the table stays as it is: its rows, their order, the separator, the decimal comma.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple

from lrp_jupyter.errors import FileError, did_you_mean
from lrp_jupyter.files import guessed, read_data, shown
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
    guess: str

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
    rows = table.rows[1:]
    numbers = [_DIGITS.search(_cell(row, places["identifier"])) for row in rows]
    names = [_cell(row, places["name"]) for row in rows]
    matched = _match([found[0] if found else "" for found in numbers], names, marks, True)
    count, locked = 0, []
    for index, student in matched.items():
        row = rows[index]
        if _cell(row, places["open"]).casefold() in ("no", "nein"):
            locked.append(student.student)
            continue
        _put(row, places["comment"], _comment(student))
        if student.is_read:
            most = _cell(row, places["most"])
            _put(row, places["grade"], _scaled(student.points, marks.out_of, most, table))
            count += 1
    notes = [f"Moodle does not let you change the grades of {', '.join(locked)}."] if locked else []
    if places["comment"] is None:
        notes.append("There is no column for comments. Switch on *Feedback comments* in the assignment.")
    return Filled(table.written(), count, _notes(table, notes, matched, marks))


def _comment(student: Handed) -> str:
    """Return what a student reads in Moodle, which takes it as HTML."""
    lines = []
    for mark in student.marks:
        grade = mark.grade
        if grade.challenge:
            lines.append(f"{grade.challenge}: {grade.points:g} of {grade.out_of:g} points.")
        lines += [mark.reason, f"Hint: {grade.hint}" if grade.hint else ""]
    return "<br>".join(escape(line, quote=False).replace("\n", "<br>") for line in lines if line)


# -- Canvas ----------------------------------------------------------------------------------------


def _canvas(path: Path, table: _Table, marks: Marks, column: str | None) -> Filled:
    head, *rows = table.rows
    named = {slug(re.sub(r"\s*\(\d+\)$", "", cell)): place for place, cell in enumerate(head)}
    whole = None if column is None else _column(path, head, column)
    places = {name: named[slug(name)] for name in marks.names if slug(name) in named}
    if whole is None and not places:
        raise FileError(
            f"`{shown(path)}` has no column for {_listed(marks.names)}. Choose one with `--column NAME`: "
            f"{_listed(head)}."
        )
    possible = next((row for row in rows if _cell(row, 0).casefold() == _POSSIBLE), [])
    students = [row if row is not possible else [] for row in rows]
    name, number = head.index("Student"), head.index("ID")
    matched = _match(
        [_cell(row, number) for row in students], [_cell(row, name) for row in students], marks, False
    )
    filled = {index: student for index, student in matched.items() if student.is_read}
    for index, student in filled.items():
        if whole is not None:
            most = _cell(possible, whole)
            _put(rows[index], whole, _scaled(student.points, marks.out_of, most, table))
            continue
        for task in marks.tasks:
            mark, place = student.mark(task.name), places.get(task.name)
            if mark is not None and mark.submission.text is not None and place is not None:
                points = _scaled(mark.grade.points, task.points, _cell(possible, place), table)
                _put(rows[index], place, points)
    left = [each for each in marks.names if whole is None and each not in places]
    notes = [f"There is no column for {_listed(left)}."] if left else []
    return Filled(table.written(), len(filled), _notes(table, notes, matched, marks))


# -- both ------------------------------------------------------------------------------------------


def _match(numbers: Sequence[str], names: Sequence[str], marks: Marks, is_moodle: bool) -> dict[int, Handed]:
    """Return whose rows these are: by the number, or else by a name that only one row and one student have.

    `is_moodle`: whether the numbers are Moodle's.
    """
    students = marks.students
    by_number = {each.number: each for each in students if each.number and each.is_from_moodle == is_moodle}
    matched = {index: by_number[number] for index, number in enumerate(numbers) if number in by_number}
    rows = _by_key({index: name for index, name in enumerate(names) if index not in matched})
    taken = [*matched.values()]
    free = [each for each in students if each not in taken]
    for key, found in _by_key({index: each.student for index, each in enumerate(free)}).items():
        at = rows.get(key, ())
        if len(found) == len(at) == 1:
            matched[next(iter(at))] = free[next(iter(found))]
    return matched


def _by_key(names: dict[int, str]) -> dict[str, set[int]]:
    """Return which names are the same: their words in any order; or joined in their order, as Canvas does."""
    found: dict[str, set[int]] = {}
    for index, name in names.items():
        words = re.findall(r"\w+", name.casefold())
        for key in (" ".join(sorted(words)), "".join(words)):
            found.setdefault(key, set()).add(index)
    found.pop("", None)
    return found


def _notes(table: _Table, notes: Sequence[str], matched: dict[int, Handed], marks: Marks) -> tuple[str, ...]:
    """Say who gets no points in the table, after other notes."""
    found = [*matched.values()]
    missed = [each.student for each in marks.students if each not in found]
    unread = [each.student for each in found if not each.is_read]
    said = [table.guess, *notes]
    if missed:
        said.append(f"No row was found for {', '.join(missed)}. Enter their points yourself.")
    if unread:
        said.append(f"No grade was entered for {', '.join(unread)}: what they handed in cannot be read.")
    return tuple(filter(None, said))


def _read(path: Path) -> _Table:
    data = read_data(path)
    text, guess = guessed(data, f"`{shown(path)}`")
    first = text.partition("\n")[0]
    separator = max(",;\t", key=first.count)
    rows = list(csv.reader(io.StringIO(text, newline=""), delimiter=separator))
    if not rows or len(rows[0]) < 2:
        raise FileError(f"`{shown(path)}` is not a table. Download the worksheet again as CSV.")
    line_end = "\r\n" if "\r\n" in text else "\n"
    return _Table(rows, separator, line_end, data.startswith(codecs.BOM_UTF8), guess)


def _place(head: Sequence[str], names: Sequence[str]) -> int | None:
    return next((place for place, cell in enumerate(head) if cell.strip() in names), None)


def _column(path: Path, head: Sequence[str], name: str) -> int:
    found = [place for place, cell in enumerate(head) if slug(cell) == slug(name)]
    found = found or [place for place, cell in enumerate(head) if slug(cell).startswith(slug(name))]
    if len(found) != 1:
        hint = did_you_mean(name, head)
        raise FileError(f"`{shown(path)}` has no column `{name}`.{hint} Choose one of {_listed(head)}.")
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
    return decimal(round(share * (whole or out_of), 2), table.has_comma)

"""Tables for a spreadsheet."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[object]], separator: str = ",") -> str:
    """Return a table for a spreadsheet: UTF-8 with its mark, and no text that would be a formula.

    `separator`: between cells. With a semicolon, numbers have a decimal comma: a spreadsheet that wants one
        wants the other, and takes 7.5 for the seventh of May.
    """
    file = io.StringIO()
    writer = csv.writer(file, delimiter=separator)
    writer.writerow(columns)
    for row in rows:
        writer.writerow([_cell(each, separator) for each in row])
    return "\ufeff" + file.getvalue()


def _cell(value: object, separator: str) -> object:
    if isinstance(value, str) and value.startswith(_FORMULA):
        return f"'{value}"
    return decimal(value, separator == ";") if isinstance(value, float) else value


def decimal(number: float, has_comma: bool) -> str:
    """Return a number with a decimal point, or with a comma."""
    text = str(number)
    return text.replace(".", ",") if has_comma else text

"""Tables for a spreadsheet."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table for a spreadsheet: UTF-8 with its mark, and no text that would be a formula."""
    file = io.StringIO()
    writer = csv.writer(file)
    writer.writerow(columns)
    for row in rows:
        writer.writerow(
            [f"'{each}" if isinstance(each, str) and each.startswith(_FORMULA) else each for each in row]
        )
    return "\ufeff" + file.getvalue()

"""The forms in which the marks of a class are written."""

from __future__ import annotations

import json
from collections.abc import Callable

from lrp_jupyter.grading.class_page import class_page
from lrp_jupyter.grading.marks import Marks
from lrp_jupyter.grading.summary import summaries


def as_json(marks: Marks) -> str:
    """Return everything that is known of every run, and the summaries."""
    data = {**marks.to_dict(), "summaries": [each.to_dict() for each in summaries(marks)]}
    return json.dumps(data, ensure_ascii=False, indent=1) + "\n"


FORMS: dict[str, Callable[[Marks, str], str]] = {
    ".csv": Marks.csv,
    ".json": lambda marks, _: as_json(marks),
    ".xml": lambda marks, _: marks.junit(),
    ".html": lambda marks, _: class_page(marks),
}
"""How marks are written, by the suffix of the file; the second argument separates the cells of a table."""

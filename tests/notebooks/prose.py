"""What the prose of the notebooks names, and what there is to be named."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

from stored import NOTEBOOKS, Node, challenge_of

JAVASCRIPT = Path(__file__).parents[2] / "js" / "src"
_TEXT = r'"((?:[^"\\]|\\.)+)"'
_NAMED = re.compile(
    rf"""\b(?:label|title):\s*{_TEXT}          # a button
    |\b(?:item|placed|switchItem|toggle)\(\s*{_TEXT}  # an item of a menu, a switch
    |\biconButton\(\s*"[\w-]+",\s*{_TEXT}      # a button without words
    |\bpanel\(\s*"[\w-]+",\s*{_TEXT}           # a part of the lab
    |h\("span",\s*\{{\}},\s*{_TEXT}            # what stands beside a slider
    |h\("button",\s*\{{[^}}]*\}},\s*{_TEXT}     # a button of a page of the site
    |<button[^>]*>([^<]+)</button>             # and one that is written in it
    |\[\s*"[\w-]+",\s*{_TEXT}\s*\]            # an item in a list of them
    |\?\s*{_TEXT}\s*:\s*{_TEXT}                # a button with two faces
    """,
    re.VERBOSE,
)


@cache
def named_in_the_lab() -> set[str]:
    """Every name under which a person finds something in the lab: labels, and titles up to a colon."""
    names: set[str] = set()
    for file in (*JAVASCRIPT.rglob("*.ts"), *JAVASCRIPT.rglob("*.html")):
        for groups in _NAMED.findall(file.read_text(encoding="utf-8")):
            names.update(name.partition(":")[0] for name in groups if name)
    return names


def prose(notebook: Node) -> str:
    """All Markdown of a notebook, without its blocks of code."""
    cells = "\n\n".join(cell.source for cell in notebook.cells if cell.cell_type == "markdown")
    return re.sub(r"^```.*?^```", "", cells, flags=re.DOTALL | re.MULTILINE)


def bold(text: str) -> list[str]:
    """What is printed bold: by convention the names of what is in the lab, and nothing else."""
    return re.findall(r"\*\*([^*\n]+)\*\*", re.sub(r"`[^`]*`", "", text))


def links(text: str) -> list[str]:
    return re.findall(r"\]\(([^)\s]+)\)", text)


def solution(notebook: Node) -> tuple[str, str] | None:
    """The solution that a notebook of the appendix hides, ``lrp`` or ``python`` and its text."""
    text = "\n\n".join(cell.source for cell in notebook.cells if cell.cell_type == "markdown")
    found = re.search(r"<summary>A solution</summary>.*?```(lrp|python)\n(.*?)```", text, re.DOTALL)
    return (found[1], found[2]) if found else None


def minutes(notebook: Node) -> float:
    """How long a lesson takes by a stranger's clock, without what is there "if you have time".

    A minute for 110 words, for 20 lines of code unless the lesson says that they need not be read, or for
    10 lines to copy; half a minute for each thing to try and each step, and half of that for a button. For
    the exercise eight minutes, which are its goal and two attempts, or three if it is one of several small
    ones; and half a minute for each line to find, up to twelve of them. A reader who had not seen the
    lessons before needed 240 minutes for the ten in which he was never stuck, for which this gave 224. It
    knows nothing of waiting for runs.
    """
    cells = list(_needed(notebook))
    whole = "\n\n".join(cell.source for cell in cells if cell.cell_type == "markdown")
    text = re.sub(r"^```.*?^```", "", whole, flags=re.DOTALL | re.MULTILINE)
    code = [cell.source for before, cell in pairwise(cells) if _is_read(cell, before)]
    exercises = [cell.source for cell in cells if cell.cell_type == "code" and challenge_of(cell.source)]
    pressed, tried = _rows(text, "press"), _rows(text, "type|type, or press|press, or choose|choose|do")
    copied = re.findall(r"^```lrp\n(.*?)^```", whole.partition("\n## Run\n")[2], re.DOTALL | re.MULTILINE)
    trying = pressed / 4 + tried / 2 + text.count("\n### ") / 2 + sum(map(_length, copied)) / 10
    solving = 8 if len(exercises) == 1 else 3 * len(exercises)
    finding = min(sum(_lines_to_find(each, given=whole) for each in exercises), 12) / 2
    return len(text.split()) / 110 + sum(map(_length, code)) / 20 + trying + solving + finding


def _needed(notebook: Node) -> Iterator[Node]:
    """The cells that are not there "if you have time"."""
    needed = True
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            needed = cell.source.startswith("## ") or (
                needed and not cell.source.startswith("### If you have time")
            )
        if needed:
            yield cell


def _length(source: str) -> int:
    return len(source.splitlines())


def _is_read(cell: Node, before: Node) -> bool:
    return cell.cell_type == "code" and "need not read" not in before.source


def _rows(text: str, head: str) -> int:
    """How many rows the tables have whose first column has one of these heads."""
    tables = re.findall(rf"^\| (?:{head}) \|.*\n\|[-|]+\n((?:\|.*\n?)+)", text, re.MULTILINE)
    return sum(map(_length, tables))


def _lines_to_find(exercise: str, given: str) -> int:
    """How many lines of the teachers' solution stand neither in the exercise nor in the lesson."""
    solution = NOTEBOOKS / "teachers" / "solutions" / f"{file_of(challenge_of(exercise))}.lrp"
    known = {line.strip().rstrip(")") for line in f"{exercise}\n{given}".splitlines()} | {""}
    lines = (line.strip().rstrip(")") for line in solution.read_text(encoding="utf-8").splitlines())
    return sum(line not in known for line in lines if not line.startswith(";"))


def file_of(challenge: str) -> str:
    """The name of the file that holds the solution of a challenge, without its ending."""
    return challenge.replace(",", "").replace(" ", "-")

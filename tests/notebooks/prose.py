"""What the prose of the notebooks names, and what there is to be named."""

from __future__ import annotations

import re
from pathlib import Path

from stored import Node

JAVASCRIPT = Path(__file__).parents[2] / "js" / "src"
_TEXT = r'"((?:[^"\\]|\\.)+)"'
_NAMED = re.compile(
    rf"""\b(?:label|title):\s*{_TEXT}          # a button, an item of a menu
    |\btoggle\(\s*{_TEXT}                      # a switch
    |\bpanel\(\s*"[\w-]+",\s*{_TEXT}           # a part of the lab
    |h\("span",\s*\{{\}},\s*{_TEXT}            # what stands beside a slider
    |\[\s*"[\w-]+",\s*{_TEXT}\s*\]            # an item in a list of them
    |\?\s*{_TEXT}\s*:\s*{_TEXT}                # a button with two faces
    """,
    re.VERBOSE,
)


def named_in_the_lab() -> set[str]:
    """Every name under which a person finds something in the lab: labels, and titles up to a colon."""
    names: set[str] = set()
    for file in JAVASCRIPT.rglob("*.ts"):
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
    """How long a lesson takes by a stranger's clock.

    A minute for 150 words, for 25 lines of code to read, or for 10 lines to type; half a minute for each
    thing to try and each step; five minutes for the exercise, or two for each of several small ones.
    """
    text = prose(notebook)
    code = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    exercises = sum("--challenge" in source.partition("\n")[0] for source in code)
    if exercises > 1:  # their code is read in their two minutes
        code = [source for source in code if "--challenge" not in source.partition("\n")[0]]
    lines = sum(len(source.splitlines()) for source in code)
    tables = re.findall(
        r"^\| (?:type|press|choose|do|watch)\b.*\n\|[-|]+\n((?:\|.*\n?)+)", text, re.MULTILINE
    )
    tried = sum(len(table.strip().splitlines()) for table in tables) + text.count("\n### ")
    whole = "\n\n".join(cell.source for cell in notebook.cells if cell.cell_type == "markdown")
    typed = re.findall(r"^```lrp\n(.*?)^```", whole.partition("\n## Run\n")[2], re.DOTALL | re.MULTILINE)
    typing = sum(block.count("\n") for block in typed) / 10
    solving = 5 if exercises == 1 else 2 * exercises
    return len(text.split()) / 150 + lines / 25 + typing + tried / 2 + solving

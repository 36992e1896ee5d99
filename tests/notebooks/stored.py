"""The notebooks as they are stored, and what their cells hold.

Plain JSON: nbformat takes five seconds to import, and only a run needs it (see execution.py).
"""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Mapping
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"
WIDGET = "application/vnd.jupyter.widget-view+json"


class Node(dict[str, Any]):
    """An object of the file: its fields are attributes, and texts that are stored as lines are whole."""

    def __init__(self, fields: Mapping[str, Any]) -> None:
        super().__init__(fields)
        for name, value in fields.items():
            if isinstance(value, list) and (name in ("source", "text") or "/" in name):
                self[name] = "".join(value)

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None


def paths() -> list[Path]:
    """All notebooks, in reading order."""
    found = (path for path in NOTEBOOKS.rglob("*.ipynb") if not path.parent.name.startswith("."))
    return sorted(found, key=lambda path: (len(path.parts), path))


@cache
def read(path: Path) -> Node:
    notebook: Node = json.loads(path.read_text(encoding="utf-8"), object_hook=Node)
    return notebook


def sources(notebook: Node, kind: str) -> list[str]:
    """The texts of all cells of a kind, ``code`` or ``markdown``."""
    return [cell.source for cell in notebook.cells if cell.cell_type == kind]


def opened_program(source: str) -> str | None:
    """The name of the program in a ``%%lrp`` cell."""
    found = re.match(r"%%lrp +([\w-]+)", source)
    return found[1] if found else None


def options_of(source: str) -> dict[str, str]:
    """The options of a ``%%lrp`` cell."""
    words = shlex.split(source.partition("\n")[0])
    return {word[2:]: value for word, value in pairwise(words) if word.startswith("--")}


def challenge_of(source: str) -> str:
    """The challenge that a ``%%lrp`` cell opens; empty if it opens none."""
    return options_of(source).get("challenge", "") if opened_program(source) else ""


def texts_of(cell: Node) -> str:
    """What a cell printed."""
    return "".join(output.text for output in cell.get("outputs", ()) if output.output_type == "stream")


def data_of(cell: Node, kind: str) -> list[str]:
    """What a cell shows, of one MIME type."""
    return [output.data[kind] for output in cell.get("outputs", ()) if kind in output.get("data", {})]

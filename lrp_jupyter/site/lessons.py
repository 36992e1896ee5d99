"""Lessons as pages of HTML: notebooks cut into sections, and their Markdown.

A lesson is a notebook whose name begins with a number; its exercises are in the folder ``exercises``, under
the same name. Other series of exercises are there, too. Sections begin with headings of the second level.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

from lrp_jupyter.errors import LRPError
from lrp_jupyter.files import read_text, shown

_HEADING = re.compile(r"(#{1,2}) (.*)")
_FENCE = re.compile(r"\s*(```|~~~)")


class CodeCell(NamedTuple):
    """A code cell: its source and, as in the notebook, its outputs."""

    source: str
    outputs: tuple[dict[str, Any], ...] = ()

    @property
    def program(self) -> str | None:
        """The program in a ``%%lrp`` cell; None for Python."""
        head, _, text = self.source.partition("\n")
        return text if head.startswith("%%lrp") else None


@dataclass(frozen=True)
class Section:
    """A heading, and what is below it: Markdown, and code cells."""

    title: str
    parts: tuple[str | CodeCell, ...]


@dataclass(frozen=True)
class Lesson:
    """A lesson, or its exercises.

    `name`: its path below the folder of the lessons, without the suffix.
    `opening`: what comes before the first section.
    """

    name: str
    title: str
    opening: Section
    sections: tuple[Section, ...]

    @property
    def page(self) -> str:
        """The name of its page, without a suffix: all pages are in one folder."""
        return self.name.replace("/", "-")


def read_lessons(folder: Path) -> list[Lesson]:
    """Return the lessons of a folder, each before its exercises, and other series last.

    Raises LRPError: one cannot be read.
    """
    files = [*folder.glob("[0-9][0-9]-*.ipynb"), *folder.glob("exercises/*.ipynb")]
    return [read_lesson(file, folder) for file in sorted(files, key=lambda file: (file.name, file.parts))]


def read_lesson(file: Path, folder: Path) -> Lesson:
    """Return the lesson in a notebook of a folder; LRPError: it cannot be read."""
    try:
        cells = json.loads(read_text(file))["cells"]
        parts = [
            "".join(cell["source"])
            if cell["cell_type"] == "markdown"
            else CodeCell("".join(cell["source"]), tuple(cell.get("outputs", ())))
            for cell in cells
            if cell["cell_type"] in ("markdown", "code")
        ]
    except (ValueError, TypeError, KeyError) as error:
        raise LRPError(
            f"`{shown(file)}` is not a notebook that can be read. Save it again in Jupyter."
        ) from error
    title, titles, below = file.stem, [""], [list[str | CodeCell]()]
    for part in parts:
        if isinstance(part, CodeCell):
            below[-1].append(part)
            continue
        for level, heading, text in _cut(part):
            if level == 1:
                title = heading
            elif level == 2:
                titles.append(heading)
                below.append([])
            if text.strip():
                below[-1].append(text.strip("\n"))
    opening, *sections = (Section(each, tuple(parts)) for each, parts in zip(titles, below, strict=True))
    name = file.relative_to(folder).with_suffix("").as_posix()
    return Lesson(name, title, opening, tuple(sections))


def _cut(text: str) -> Iterator[tuple[int, str, str]]:
    """Yield the level and the words of each heading, and the Markdown below it; first what has none."""
    level, heading, lines, is_fenced = 0, "", list[str](), False
    for line in text.split("\n"):
        is_fenced ^= _FENCE.match(line) is not None
        found = None if is_fenced else _HEADING.match(line)
        if found is None:
            lines.append(line)
            continue
        yield level, heading, "\n".join(lines)
        level, heading, lines = len(found[1]), found[2].strip(), []
    yield level, heading, "\n".join(lines)


def html_of(markdown: str) -> str:
    """Return Markdown as HTML."""
    from markdown_it import MarkdownIt

    text: str = MarkdownIt("commonmark").enable("table").render(markdown)
    return text


def inline_html(markdown: str) -> str:
    """Return a line of Markdown as HTML without a paragraph."""
    from markdown_it import MarkdownIt

    text: str = MarkdownIt("commonmark").renderInline(markdown)
    return text


def page(title: str, style: str, body: str) -> str:
    """Return a page of HTML that needs no other file."""
    return (
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{escape(title)}</title>\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<link rel="icon" href="data:,">\n<style>\n{style}</style>\n</head>\n'
        f"<body>\n{body}\n</body>\n</html>\n"
    )

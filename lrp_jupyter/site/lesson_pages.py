"""The lessons of a site as pages: text to read, with labs that run in the page when they are asked for."""

from __future__ import annotations

import json
import posixpath
import re
import shlex
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from lrp_jupyter.site.lessons import CodeCell, Lesson, Section, html_of, inline_html

FOLDER = "lessons"
"""Where the pages are in a site."""

_NOTE = (
    '<p class="note">Where the text speaks of a cell, press <b>Run</b> on this page. One lab runs at a time, '
    "and what you type stays in this browser. Cells in Python run in the notebook: choose <b>As a "
    "notebook</b>.</p>"
)
_PAGE = Path(__file__).with_name("lesson.html")
_NOTEBOOK = re.compile(r'href="([\w./-]+)\.ipynb(#[^"]*)?"')
_LOOKS = re.compile(r"\bLab\b")  # into a lab above: the page has no widgets of Jupyter
_MAGIC = re.compile(r"^%.*\n?", re.MULTILINE)


def write_lessons(lessons: Sequence[Lesson], site: Path, version: str) -> None:
    """Write a page for each lesson, and the list of them, into a site.

    `version`: what the addresses of the site's files end with.
    """
    folder = site / FOLDER
    folder.mkdir()
    pages = {lesson.name: lesson.page for lesson in lessons}
    for before, lesson, after in zip([None, *lessons], lessons, [*lessons[1:], None], strict=False):
        body = _resolved("\n".join(_sections(lesson)), lesson, pages)
        links = (
            f'{_link(before, "prev", "← {}")}<a href="index.html">Lessons</a>'
            f'<a href="{_in_jupyter(lesson.name)}">As a notebook</a>{_link(after, "next", "{} →")}'
        )
        _write(folder / f"{lesson.page}.html", lesson.title, body, links, version)
    listed = "".join(
        f'<li><a href="{escape(each.page)}.html">{inline_html(each.title)}</a></li>' for each in lessons
    )
    body = f'<h1>Lessons</h1>\n<ul class="lessons">{listed}</ul>'
    _write(folder / "index.html", "Lessons", body, '<a href="../index.html">One lab</a>', version)


def _write(file: Path, title: str, body: str, links: str, version: str) -> None:
    page = _PAGE.read_text(encoding="utf-8")
    for mark, text in (("TITLE", escape(title)), ("LINKS", links), ("VERSION", version), ("BODY", body)):
        page = page.replace(f"<!--{mark}-->", text)
    file.write_text(page, encoding="utf-8")


def _link(lesson: Lesson | None, relation: str, text: str) -> str:
    if lesson is None:
        return ""
    words = escape(text.format(lesson.title))
    return f'<a href="{escape(lesson.page)}.html" rel="{relation}">{words}</a>'


def _resolved(body: str, lesson: Lesson, pages: Mapping[str, str]) -> str:
    """Return a page whose links to notebooks lead to their pages or, where they have none, to JupyterLite."""

    def resolved(found: re.Match[str]) -> str:
        name = posixpath.normpath(posixpath.join(posixpath.dirname(lesson.name), found[1]))
        if name in pages:
            return f'href="{pages[name]}.html"'
        return f'href="{_in_jupyter(name)}{found[2] or ""}"'

    return _NOTEBOOK.sub(resolved, body)


def _in_jupyter(name: str) -> str:
    return f"../jupyter/lab/index.html?path={escape(name)}.ipynb"


def _sections(lesson: Lesson) -> Iterator[str]:
    yield f"<h1>{inline_html(lesson.title)}</h1>{_NOTE}"
    setup: list[str] = []
    for section in (lesson.opening, *lesson.sections):
        title = f"<h2>{inline_html(section.title)}</h2>" if section.title else ""
        yield f"<section>{title}{''.join(_parts(lesson, section, setup))}</section>"


def _parts(lesson: Lesson, section: Section, setup: list[str]) -> Iterator[str]:
    """Yield the parts of a section; `setup`: the Python that labs below need, which grows."""
    for part in section.parts:
        if isinstance(part, str):
            yield html_of(part)
        elif (program := part.program) is not None:
            yield _lab(lesson, part, program, setup)
        elif source := _MAGIC.sub("", part.source).strip():
            if not part.outputs and not _LOOKS.search(source):
                setup.append(source)  # it only defines something
            yield f'<pre class="python"><code>{escape(source)}</code></pre>{_outputs(part)}'


def _lab(lesson: Lesson, cell: CodeCell, program: str, setup: Sequence[str]) -> str:
    """Return the place of a lab: its program and its picture until it runs."""
    wanted = {**_options(cell), "text": program, "folder": lesson.name, "setup": "\n\n".join(setup)}
    return (
        f'<div class="lab" data-wanted="{escape(json.dumps(wanted))}">'
        '<p class="tools"><button type="button" data-do="run">Run</button></p>'
        f'<div class="still"><pre><code>{escape(program)}</code></pre>{_outputs(cell)}</div></div>'
    )


def _options(cell: CodeCell) -> dict[str, str]:
    """Return the name of a program, as ``program``, and the options of its cell."""
    name, *words = shlex.split(cell.source.partition("\n")[0].removeprefix("%%lrp"))
    options = zip(words[::2], words[1::2], strict=False)
    return {"program": name, **{key.removeprefix("--"): value for key, value in options}}


def _outputs(cell: CodeCell) -> str:
    return "".join(map(_output, cell.outputs))


def _output(output: dict[str, Any]) -> str:
    data = {kind: "".join(value) for kind, value in output.get("data", {}).items()}
    if "image/svg+xml" in data:
        picture = b64encode(data["image/svg+xml"].encode()).decode()
        return f'<img src="data:image/svg+xml;base64,{picture}" alt="The lab, as it looks when it runs">'
    if "text/html" in data:
        return f'<div class="output">{data["text/html"]}</div>'
    text = "".join(output.get("text", "")) or data.get("text/plain", "")
    return f'<pre class="output">{escape(text)}</pre>' if text else ""

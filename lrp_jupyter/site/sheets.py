"""Paper: a worksheet for each lesson, made of its notebook, and cards of a program to be cut out and played.

A worksheet asks and leaves space. What would give an answer away is left out: answers, outputs, and what a
table says that one will see.
"""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory

from lrp_jupyter.errors import LRPError
from lrp_jupyter.files import read_text, shown, write_file
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Event, Program, State, Transition
from lrp_jupyter.site.lessons import CodeCell, Lesson, Section, html_of, inline_html, page, read_lessons

UNPLUGGED = Path("teachers/unplugged.md")
"""The page, in the folder of the notebooks, whose program becomes cards."""

_STYLE = Path(__file__).with_name("sheets.css")
_BROWSERS = (
    "chromium",
    "chromium-headless-shell",
    "chromium-browser",
    "google-chrome",
    "chrome",
    "msedge",
    "microsoft-edge",
)
_ANSWER = re.compile(r"<details>.*?</details>", re.DOTALL)
_LINK = re.compile(r"\[([^\]]+)\]\([^)]*\)")
_BLOCK = re.compile(r"^(?:```.*?^```$|(?!```)[^\n]*\S[^\n]*(?:\n[^\n]*\S[^\n]*)*)", re.MULTILINE | re.DOTALL)
_CELL = re.compile(r"(?<!\\)\|")
_PROGRAM = re.compile(r"^```lrp\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_CASES = "<table>\n<thead>\n<tr>\n<th></th>\n"  # how a table of cases begins, each with its letter
_BLANK_CARDS = {"state": 4, "event": 2, "transition": 4}


def write_sheets(notebooks: Path, folder: Path, is_pdf: bool = False) -> list[Path]:
    """Write the worksheets of the lessons, and the cards, into a folder; return the files.

    Raises LRPError: there are no lessons, a file cannot be read or written, or no browser makes a PDF.
    """
    pages = {lesson.page: worksheet(lesson) for lesson in read_lessons(notebooks)}
    if not pages:
        raise LRPError(
            f"There is no lesson in `{shown(notebooks)}`. The names of lessons begin with a number, as in "
            "`00-hello.ipynb`."
        )
    unplugged = notebooks / UNPLUGGED
    if unplugged.is_file():
        pages["cards"] = cards(read_text(unplugged))
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, content in pages.items():
        written.append(folder / f"{name}.html")
        write_file(written[-1], content)
    return [_printed(file) for file in written] if is_pdf else written


def _printed(file: Path) -> Path:
    """Have a browser print a page; return the PDF."""
    browser = next(filter(None, map(shutil.which, _BROWSERS)), None)
    if browser is None:
        raise LRPError(
            f"The pages are in `{file.parent}`, but no browser was found that makes PDF of them. Install "
            "Chromium or Chrome, or open a page in any browser and print it."
        )
    pdf = file.with_suffix(".pdf")
    with TemporaryDirectory(prefix="lrp-print-") as profile:
        options = [f"--user-data-dir={profile}", f"--print-to-pdf={pdf.resolve()}", "--no-pdf-header-footer"]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            options.append("--no-sandbox")
        command = [browser, "--headless", "--disable-gpu", *options, file.resolve().as_uri()]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode or not pdf.is_file():
        raise LRPError(f"`{browser}` has not printed `{file}`: {done.stderr.strip()[-400:]}")
    return pdf


# -- worksheets ------------------------------------------------------------------------------------------


def worksheet(lesson: Lesson) -> str:
    """Return the worksheet of a lesson, a page of HTML."""
    number, _, title = lesson.title.rpartition(" · ")
    parts = [
        f'<header><span class="number">{escape(number)}</span><h1>{escape(title)}</h1></header>',
        '<p class="who"><span>Name</span><span>With</span><span>Date</span></p>',
    ]
    able = ""
    for section in lesson.sections:
        shown = _SECTIONS.get(section.title.rstrip(" 0123456789"), _task)(section)
        if section.title == "Afterwards you can":
            able = shown
        elif shown:
            parts.append(f"<section><h2>{escape(section.title)}</h2>{shown}</section>")
    return page(lesson.title, _STYLE.read_text(encoding="utf-8"), "\n".join([*parts, able]))


def _asked(section: Section) -> str:
    """Return the questions to be answered before anything runs, with lines, or space in a table of cases."""
    html = _markdown(section)
    if _CASES in html:
        head, _, cases = html.partition(_CASES)
        cases = cases.replace("</tr>", "<td></td></tr>").replace("<td></td>", "<th>our answer</th>", 1)
        return head + _CASES.replace("table", 'table class="cases"', 1) + cases
    if "<ol>" in html:
        return html.replace("</li>", f"{_lines(2)}</li>")
    return html + _lines(3)


def _tried(section: Section) -> str:
    """Return the tables of what is done, without what one sees, and what is to be predicted."""
    kept: list[str] = []
    before = ""
    for block in (block for part in section.parts if isinstance(part, str) for block in _blocks(part)):
        if kept and kept[-1].startswith("<h3>") and block.startswith("#"):
            kept.pop()  # a heading with nothing below it
        if block.startswith("|"):
            table = _unseen(block)
            if table and "*Predict" in before:
                kept.pop()  # there is space in the table
            kept.append(table)
        elif "*Predict" in block:
            kept.append(html_of(block))
            kept.append(_lines(1))
        elif "*Predict" in before and before.endswith(":"):
            kept.insert(-1, html_of(block))  # what the prediction is about
        elif block.startswith("### "):
            kept.append(f"<h3>{inline_html(block[4:])}</h3>")
        before = block
    if kept and kept[-1].startswith("<h3>"):
        kept.pop()
    return "".join(kept)


def _unseen(table: str) -> str:
    """Return a table of what is typed and seen with space instead of what is seen; any other is left out."""
    head, _, *rows = ([cell.strip() for cell in _CELL.split(row)[1:-1]] for row in table.strip().split("\n"))
    if head[1:] != ["and see"]:
        return ""
    done = "".join(f"<tr><td>{inline_html(row[0])}</td><td></td><td></td></tr>" for row in rows)
    titles = f"<th>{inline_html(head[0])}</th><th>we predict</th><th>we saw</th>"
    return f'<table class="tried"><thead><tr>{titles}</tr></thead><tbody>{done}</tbody></table>'


def _task(section: Section) -> str:
    """Return a task, with its program if that is short, and space to draw and to note the result."""
    return _markdown(section, longest=20) + (
        '<div class="drawing"><span>States and transitions</span></div>'
        '<p class="who"><span>Points</span><span>What did not work at first, and why</span></p>'
    )


def _bug(section: Section) -> str:
    """Return a program whose mistake is to be found, and space for the way to it."""
    return _markdown(section, longest=math.inf) + (
        '<p class="who"><span>We asked</span></p><p class="who"><span>The answer was</span></p>'
        '<p class="who"><span>The smallest edit that repairs it</span></p>'
    )


def _told(section: Section) -> str:
    return _markdown(section)


def _able(section: Section) -> str:
    """Return what one can do now, to be ticked."""
    return f'<section class="able"><h2>I can …</h2>{_markdown(section)}</section>'


def _omitted(_section: Section) -> str:
    return ""


_SECTIONS: dict[str, Callable[[Section], str]] = {
    "Questions": _omitted,
    "Afterwards you can": _able,
    "Bug": _bug,
    "Predict": _asked,
    "Run": _omitted,
    "Investigate": _tried,
    "Modify": _tried,
    "Key points": _told,
}
"""What of a section is printed, by its title without a number; any other is a task."""


def _markdown(section: Section, longest: float = 0) -> str:
    """Return the text of a section, and its programs that have at most so many lines."""
    return "".join(
        html_of("\n\n".join(_blocks(part))) if isinstance(part, str) else _program(part, longest)
        for part in section.parts
    )


def _blocks(markdown: str) -> Iterator[str]:
    """Yield paragraphs, tables and programs, without answers, links, and the way to the next lesson."""
    text = _LINK.sub(r"\1", _ANSWER.sub("", markdown))
    for found in _BLOCK.finditer(text):
        if not found[0].startswith(("Next: ", "Exercises: ")):
            yield found[0].rstrip()


def _program(code: CodeCell, longest: float) -> str:
    program = (code.program or "").strip()
    if not program or program.count("\n") >= longest:
        return ""
    return f"<pre><code>{escape(program)}</code></pre>"


def _lines(count: int) -> str:
    return '<div class="line"></div>' * count


# -- cards -----------------------------------------------------------------------------------------------


def cards(markdown: str) -> str:
    """Return the rules of a game and the cards of its program, the first one in them, as a page of HTML.

    What a comment says beside a line is on the card, in the words of the players.
    Raises LRPError: there is no program, or it is not a valid one.
    """
    found = _PROGRAM.search(markdown)
    if found is None:
        raise LRPError("There is no program between lines ```lrp and ``` from which to make cards. Add one.")
    program = parse(found[1])
    heading, _, rules = _LINK.sub(r"\1", markdown).partition("\n")
    shown = "".join(_cards(program))
    blank = "".join(_card(kind, "", []) * count for kind, count in _BLANK_CARDS.items())
    title = heading.removeprefix("# ")
    body = (
        f'<header><h1>{escape(title)}</h1></header><section class="rules">{html_of(rules)}</section>'
        f'<section class="cards">{shown}</section><section class="cards">{blank}</section>'
    )
    return page(title, _STYLE.read_text(encoding="utf-8"), body)


def _cards(program: Program) -> Iterator[str]:
    for _, machine in program.walk():
        for kind, elements in (
            ("state", machine.states),
            ("event", machine.events),
            ("transition", machine.transitions),
        ):
            for element in elements:
                yield _card(kind, _title(element), _said(program.text, element))


def _title(element: State | Event | Transition) -> str:
    if not isinstance(element, Transition):
        return escape(element.name)
    return f"{escape(element.source_text)} <b>→</b> {escape(element.destination)}"


def _said(text: str, element: State | Event | Transition) -> list[tuple[str, str]]:
    """Return the lines of an element, each with what its comment says."""
    end = text.find("\n", element.span.end)
    lines = text[element.span.start : end if end >= 0 else None].split("\n")
    if isinstance(element, State):  # its name is the title
        lines = lines[1:-1]
    return [(code.strip(), words.strip()) for code, _, words in (line.partition(";") for line in lines)]


def _card(kind: str, title: str, lines: list[tuple[str, str]]) -> str:
    said = "".join(f"<p>{escape(words)}</p><code>{escape(code)}</code>" for code, words in lines)
    return f'<div class="card {kind}"><span>{kind}</span><h3>{title}</h3>{said}</div>'

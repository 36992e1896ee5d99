"""What the checks find in wrong texts, and in some that are right: the rows of `wrong_texts.txt`.

A section begins with ``===`` and a program with a hole ``□``; the rows below ``---`` are put into the hole::

    CODES │ text │ → repaired │ words

Each finding has its code (``none``: there is no finding) and marks what is between ``⟦`` and ``⟧`` where a
row has those; the message of the first contains the words. Its fix makes the repaired text, which is a
program without such findings; ``→ none``: it has no fix. In a section whose program has no hole, the text
stands in place of the repaired one. ``⏎``, ``␉`` and ``␣`` are the end of a line, a tab, and a space at an
end. A title may be followed by the first characters of the codes that count, and by names of the
notebook: ``=== Title (LRP54): count queue``.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import pytest
from checking import end_of, start_of
from support.tables import every

from lrp_jupyter.errors import Finding
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.parser import scan


class Row(NamedTuple):
    codes: list[str]
    text: str
    marks: list[tuple[int, int]]
    right: str
    words: str


class Section(NamedTuple):
    title: str
    frame: str
    codes: str
    names: list[str]
    rows: list[Row]


def read_text(written: str) -> str:
    return written.strip("∅").replace("⏎", "\n").replace("␉", "\t").replace("␣", " ")


def read_row(line: str) -> Row:
    codes, marked, *more = line.split(" │ ")
    right = read_text(more.pop(0).removeprefix("→ ")) if more and more[0].startswith("→ ") else ""
    first, *pieces = read_text(marked).split("⟦")
    text, marks = first, []
    for piece in pieces:
        inside, _, after = piece.partition("⟧")
        marks.append((len(text), len(text) + len(inside)))
        text += inside + after
    return Row(codes.replace("none", "").split(), text, marks, right, "".join(more))


def read_section(written: str) -> Section:
    head, _, rows = written.strip("\n").partition("\n---\n")
    title, _, frame = head.partition("\n")
    found = re.fullmatch(r"([^(:]+)(?: \((LRP\d+)\))?(?:: (.*))?", title)
    assert found is not None
    lines = [line for line in rows.splitlines() if not line.startswith("# ")]
    return Section(
        found[1], frame or "□", found[2] or "", (found[3] or "").split(), list(map(read_row, lines))
    )


FILE = Path(__file__).with_name("wrong_texts.txt")
SECTIONS = [read_section(each) for each in FILE.read_text(encoding="utf-8").split("=== ")[1:]]


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.title)
def test_a_text_has_its_findings_at_their_places_and_their_fix_repairs_it(section: Section) -> None:
    @every("row", section.rows)
    def judge(row: Row) -> None:
        before, hole, _ = section.frame.partition("□")
        assert hole or section.frame.count(row.right) == 1
        text = section.frame.replace(hole or row.right, row.text)
        findings = _found(section, text)
        places = [(start_of(text, each), end_of(text, each)) for each in findings]
        assert [finding.code for finding in findings] == row.codes
        assert [start for start, _ in places] == sorted(start for start, _ in places)
        if row.marks:
            assert places == [(len(before) + start, len(before) + end) for start, end in row.marks]
        if row.words:
            assert row.words in findings[0].message
        if row.right == "none":
            assert findings[0].fix is None
        elif row.right:
            (finding,) = findings
            assert finding.fix
            repaired, right = finding.fix.apply(text), section.frame.replace("□", row.right)
            assert repaired == right if hole else scan(repaired)[0] == scan(right)[0]
            assert scan(right)[0] is not None
            assert finding.code not in {each.code for each in _found(section, right)}
        if "\n" in text:
            again = _found(section, text.replace("\n", "\r\n"))
            assert [finding.code for finding in again] == row.codes, "with the line ends of Windows"

    judge()


def _found(section: Section, text: str) -> list[Finding]:
    return [each for each in check(text, section.names) if each.code.startswith(section.codes)]

from __future__ import annotations

from pathlib import Path

import pytest

from lrp_jupyter.errors import LRPSyntaxError
from lrp_jupyter.language.parser import parse, scan

LISTING = (Path(__file__).parent / "printed_listing.lrp").read_text(encoding="utf-8")


def places(text: str) -> list[tuple[str, int, int]]:
    program, findings = scan(text)
    assert (program is None) == bool(findings)
    return [(finding.code, finding.line, finding.column) for finding in findings]


def test_the_listing_printed_in_the_paper_has_wrong_brackets_in_lines_19_33_and_35_only() -> None:
    assert [place for place in places(LISTING) if place[0] != "LRP501"] == [
        ("LRP102", 19, 59),
        ("LRP103", 33, 18),
        ("LRP102", 33, 57),
        ("LRP103", 35, 18),
        ("LRP102", 35, 60),
    ]


def test_a_text_that_is_no_program_raises_all_its_errors_at_once() -> None:
    with pytest.raises(LRPSyntaxError) as caught:
        parse("(var x [1])\n(var y := [1 +])")
    assert [finding.line for finding in caught.value.findings] == [1, 2]

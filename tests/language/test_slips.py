"""Slips in the Python of blocks: each is one finding with its remedy."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.language.blocks import slips
from lrp_jupyter.language.blocks.slips import explain
from lrp_jupyter.language.parser import scan

SIGNS = ["=", ":=", ":", "(", ")", "[", "]", "{", "}", '"', "'", "&&", "!", ",", ";", "#", "“", "\\", "f'{"]
WORDS = ["x", "robot.move", "if ", "else", "print ", "1", "0,5", "then ", "é", "for i in "]
PIECES = st.sampled_from([*SIGNS, *WORDS, " ", "\n", "\n  ", "\t", "\r\n"])


@given(st.lists(PIECES, max_size=25).map("".join), st.booleans())
def test_any_text_is_explained(text: str, is_condition: bool) -> None:
    for slip in explain(text, 3, 7, is_condition):
        assert 0 <= slip.start <= slip.end <= len(text)
        assert all(0 <= start <= end <= len(text) for start, end, _ in slip.edits)
        assert slip.message.endswith((".", "?"))
    scan(f"(var x := [{text}])")


def test_two_slips_in_one_line_are_two_faults() -> None:
    assert [slip.message for slip in explain("if x && y || z: a = 1")] == [
        "Python has no `&&`. Write `and`.",
        "Python has no `||`. Write `or`.",
    ]


def test_the_search_for_remedies_is_bounded() -> None:
    text = "".join(f"(onpause [print x{i}])\n" for i in range(100))
    findings = scan(text)[1]
    assert len([finding for finding in findings if finding.fix]) == 20
    (slip,) = explain("x y " * 10_000)
    assert slip.edits == ()


def test_a_quote_inside_does_not_join_two_strings() -> None:
    (slip,) = explain('print("on guard, after, edges, "edges")')
    assert "'" not in {edit.text for edit in slip.edits}


def test_the_search_for_the_remedy_of_one_block_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    parsed = []
    error = slips._error
    monkeypatch.setattr(slips, "_error", lambda text: parsed.append(len(text)) or error(text))
    assert slips.explain("(((" + "a b, " * 1000)
    assert sum(parsed) < 500_000

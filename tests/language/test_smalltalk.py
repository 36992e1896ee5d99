"""Smalltalk in blocks: what is called so, and what the listing of the paper becomes."""

from __future__ import annotations

import ast
import re
import sysconfig
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.tables import every

from lrp_jupyter import Session, programs
from lrp_jupyter.errors import Finding
from lrp_jupyter.language.blocks.names_in_blocks import Offsets
from lrp_jupyter.language.blocks.smalltalk import smalltalk
from lrp_jupyter.language.blocks.smalltalk.syntax import UNARY
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.diff import diff
from lrp_jupyter.language.parser import parse, scan
from lrp_jupyter.language.python.block_suite import parse_block
from lrp_jupyter.language.python.python_parser import parse_python
from lrp_jupyter.language.reading.tokens import tokenize

HERE = Path(__file__).parent
LISTING = (HERE / "printed_listing.lrp").read_text(encoding="utf-8")

# -- what is called Smalltalk


def _python() -> Iterator[str]:
    """Every statement and expression of a part of the standard library."""
    for path in sorted(Path(sysconfig.get_path("stdlib")).glob("[a-h]*.py")):
        source = path.read_text(encoding="utf-8")
        places = Offsets(source)
        for node in ast.walk(parse_python(source)):
            if isinstance(node, ast.stmt | ast.expr):
                yield source[places.start_of(node) : places.end_of(node)]


def _blocks() -> Iterator[str]:
    """The blocks of all programs in the repository: bundled, of the tests, of notebooks and pages."""
    root = HERE.parents[1]
    for folder in ("lrp_jupyter", "tests", "notebooks"):
        for path in root.joinpath(folder).rglob("*"):
            if path.suffix in (".lrp", ".md", ".ipynb") and path.stat().st_size < 500_000:
                text = path.read_text(encoding="utf-8")
                yield from (
                    text[start + 1 : end - 1] for kind, start, end in tokenize(text) if kind == "BLOCK"
                )


def _is_python(text: str) -> bool:
    try:
        return bool(parse_block(text).body)
    except SyntaxError:
        return False


@pytest.mark.slow
@pytest.mark.parametrize(("written", "least"), [(_blocks, 1_000), (_python, 50_000)])
def test_no_python_is_called_smalltalk(written: Callable[[], Iterator[str]], least: int) -> None:
    texts = list(written())
    if written is _python and not texts:
        pytest.skip("Python in a page has no sources of its standard library")
    assert len(texts) >= least
    assert [text for text in dict.fromkeys(texts) if smalltalk(text) and _is_python(text)] == []


PIECES = st.sampled_from([
    "robot", " light", " data", " not", "move: ", "[:m | ", "]", "(", ")", " > ", " & ", " + ", "x", " := ",
    ".", "; ", "stop", "ifTrue: ", "^ ", "3", "'a'", "#b", '"c"', "\n", " ", "m", "1 to: 2 do: ", "-",
    "robot.light",
])  # fmt: skip


@given(st.lists(PIECES, max_size=25).map("".join), st.booleans())
def test_a_fix_is_always_python(text: str, is_condition: bool) -> None:
    found = smalltalk(text, 7, is_condition)
    if found is not None:
        assert 0 <= found.start < found.end <= len(text)
        assert found.message.startswith("This is Smalltalk. ")
        for start, end, new in found.edits:
            assert _is_python(text[:start] + new + text[end:])


@pytest.mark.parametrize(
    "text",
    ["(" * 900 + "robot light data", "robot" + " a" * 2_000, "x not" + " + x" * 1_000, "x := " * 900 + "y."],
)
def test_what_is_nested_too_deeply_is_no_smalltalk(text: str) -> None:
    assert smalltalk(text) is None
    assert scan(f"(var x := [{text}])")[1]


@every("message", sorted(UNARY))
def test_a_message_that_any_object_understands_is_no_attribute_of_a_reading(message: str) -> None:
    of_variable, of_reading = (smalltalk(f"y := {value} {message}.") for value in ("x", "robot light data"))
    assert of_variable is not None
    assert of_reading is not None
    assert of_reading.message == of_variable.message.replace("x", "robot.light.data", 1)


def test_every_block_of_a_long_program_in_smalltalk_has_its_fix() -> None:
    block = "robot motorA startAtSpeed: x * 2; stop. nobump := nobump not"
    findings = scan("".join(f"(onpause [{block}])\n" for _ in range(60)))[1]
    assert {finding.code for finding in findings if finding.fix} == {"LRP519"}
    assert [finding.line for finding in findings] == list(range(1, 61))


# -- the listing of the paper


def _places(findings: tuple[Finding, ...]) -> list[tuple[str, int]]:
    return [(finding.code, finding.line) for finding in findings]


SMALLTALK = [4, 7, 8, 13, 15, 17, 19, 27, 28, 33, 35]
BRACKETS = [("LRP102", 19), ("LRP103", 33), ("LRP102", 33), ("LRP103", 35), ("LRP102", 35)]


def test_the_listing_of_the_paper_has_one_error_for_each_block_and_for_each_wrong_bracket() -> None:
    findings = check(LISTING)
    expected = [("LRP519", line) for line in SMALLTALK] + BRACKETS + [("LRP510", 20)]
    assert sorted(_places(findings)) == sorted(expected)
    assert all(finding.fix for finding in findings)


def _in_python(text: str) -> str:
    """The text after all its fixes but those of brackets."""
    while inside := [each for each in check(text) if each.fix and not each.code.startswith("LRP1")]:
        assert inside[0].fix is not None
        text = inside[0].fix.apply(text)
    return text


def test_in_python_nothing_of_the_listing_is_wrong_but_its_brackets() -> None:
    assert _places(check(_in_python(LISTING))) == [("LRP102", 19), ("LRP103", 33), ("LRP103", 35)]


ORDERS: dict[str, Callable[[list[Finding]], Finding]] = {
    "first": lambda offered: offered[0],
    "last": lambda offered: offered[-1],
    "any": Random(1).choice,
}


def _accepted(order: str) -> str:
    """The listing after all its fixes, one after the other, as they are offered."""
    text = LISTING
    for _ in range(100):
        offered = [finding for finding in check(text) if finding.fix]
        if not offered:
            return text
        chosen = ORDERS[order](offered)
        assert chosen.fix is not None
        text = chosen.fix.apply(text)
    raise AssertionError("There is no end of fixes.")


@pytest.mark.slow
@every("order", ORDERS)
def test_the_listing_becomes_a_program_by_accepting_its_fixes_in_any_order(order: str) -> None:
    text = _accepted(order)
    assert check(text) == ()
    assert parse(text) == parse(_accepted("first"))
    assert text.count("\n") == LISTING.count("\n")


def test_the_listing_with_its_fixes_drives_along_the_line_and_ends_at_the_first_wall() -> None:
    pytest.importorskip("pymunk")
    with Session(_accepted("first"), "sim", world="line", seed=1) as session:
        session.run(400, until="end")
        assert session.frame.variables["follower", "nobump"] == "False"
        assert session.call(lambda: session.bridge.robot.odom.x) > 2
        assert not session.issues


# -- the bundled listing, beside the printed one


def _lines(text: str) -> list[str]:
    """The 40 lines of the listing without comments and indentation; `true` is found in a program only."""
    text = re.sub(r" *;.*", "", text[text.index("(var lightlim") :].replace("true", "True"))
    return [" ".join(line.split()).replace(" ]", "]") for line in text.splitlines()]


def test_the_bundled_listing_is_the_printed_one_but_for_the_lines_that_have_a_comment() -> None:
    bundled = programs.load("paper-listing")
    printed, mended = _lines(_in_python(LISTING)), _lines(bundled)
    assert len(printed) == len(mended) == 40
    commented = [";" in line for line in bundled.splitlines()[-40:]]
    assert [old != new for old, new in zip(printed, mended, strict=True)] == commented
    assert [number for number, changed in enumerate(commented, 1) if changed] == [19, 32, 33, 34, 35]


def test_the_bundled_listing_is_the_one_with_its_fixes_but_for_the_flag_and_the_turn() -> None:
    changes = diff(parse(_accepted("first")), parse(programs.load("paper-listing")))
    assert changes.added == changes.removed == changes.moved == ()
    assert {element.path[-1] for element in changes.changed} == {"bumpback", "bumpturn"}

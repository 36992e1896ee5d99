"""The formatter changes only white space, once, and leaves the bundled programs as they are."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import programs
from support.tables import every

import lrp_jupyter
from lrp_jupyter import LRPSyntaxError, parse
from lrp_jupyter.errors import edited
from lrp_jupyter.language.edits.format import formatted, formatting
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Program
from lrp_jupyter.language.reading.tokens import tokenize

BUNDLED = sorted(Path(lrp_jupyter.__file__).parent.glob("programs/*.lrp"))
SPACES = [
    "",
    "",
    " ",
    "   ",
    "\t",
    "\n",
    "\n\n\n",
    "\r\n  ",
    " ; one )\n",
    "; two\n\n  # three [\n",
    "\n\t;\n",
]


@st.composite
def texts(draw: st.DrawFn) -> str:
    """Return a program with white space and comments anywhere between its tokens."""
    source = to_source(draw(programs.filter(lambda program: program != Program())))
    spaces = Random(draw(st.integers(0, 999)))
    text, before = "", 0
    for kind, start, end in tokenize(source):
        needed = " " if before and source[before:start] and kind != "CLOSE" else ""
        text += spaces.choice(SPACES) + needed + source[start:end]
        before = end
    return text + spaces.choice(SPACES)


@pytest.mark.slow
@given(texts())
def test_only_white_space_changes_and_formatting_twice_changes_nothing_more(text: str) -> None:
    after = formatted(text)
    assert parse(after) == parse(text)
    assert "".join(after.split()) == "".join(text.split())
    assert edited(text, formatting(text)) == after
    assert all(not text[start:end].strip() and not new.strip() for start, end, new in formatting(text))
    assert formatting(after) == ()


@every("path", BUNDLED)
def test_a_bundled_program_is_already_formatted(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert path.stem == "paper-listing" or formatted(text) == text  # that one has the lines of the paper
    assert formatted(to_source(parse(text))) == to_source(parse(text))


def test_a_program_typed_into_one_line_is_laid_out() -> None:
    text = "(machine m(var n:=[0])(state a(running[n+=1]))(state b(machine c(state x)))(on[n>5]*->b t))"
    assert (
        formatted(text)
        == """\
(machine m
  (var n := [0])
  (state a (running [n+=1]))
  (state b
    (machine c
      (state x)))
  (on [n>5] *-> b t))
"""
    )


def test_comments_blank_lines_and_lone_brackets_stay() -> None:
    text = "; top\n\n\n\n(machine m   ; m\n; a\n  (state a\n   (running [\n x = 1\n])) ; x\n\n# end\n)"
    assert (
        formatted(text)
        == """\
; top

(machine m   ; m
  ; a
  (state a
    (running [
      x = 1
    ])) ; x

  # end
)
"""
    )


def test_the_line_ends_of_the_text_stay() -> None:
    assert formatted("(machine m\r\n(state a)(state b))\r\n(spawn m a)") == (
        "(machine m\r\n  (state a)\r\n  (state b))\r\n(spawn m a)\r\n"
    )


@every("text", ["\ufeff(machine m(state a))", "(machine m(state a)\n\ufeff(state b)(state c))"])
def test_a_byte_order_mark_is_white_space(text: str) -> None:
    assert edited(text, formatting(text)) == formatted(text)
    assert parse(formatted(text)) == parse(text)


def test_a_text_with_errors_is_not_formatted() -> None:
    with pytest.raises(LRPSyntaxError):
        formatted("(machine m (state a)")


def test_the_parts_of_a_behaviour_are_laid_out() -> None:
    text = (
        "(machine m(state a(onentry(spawn n   s(var v:=[-1])\n(var w := [2]))))"
        "(on n . s   for  20 a->b(effect [x=1][y])) (exit [x]for[y] a -> b t\n(effect [x\ny])))"
    )
    assert (
        formatted(text)
        == """\
(machine m
  (state a
    (onentry (spawn n s (var v := [-1])
               (var w := [2]))))
  (on n.s for 20 a -> b (effect [x=1] [y]))
  (exit [x] for [y] a -> b t
    (effect [x
             y])))
"""
    )

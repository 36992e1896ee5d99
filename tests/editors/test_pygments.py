"""The colours of a program for tools that use Pygments."""

import re

from hypothesis import given
from hypothesis import strategies as st
from pygments.lexers import get_lexer_by_name, get_lexer_for_filename
from pygments.token import Comment, Keyword, Name, Number, String

from lrp_jupyter import programs
from lrp_jupyter.editors.pygments_lexer import LRPLexer
from lrp_jupyter.language.reading.tokens import KEYWORDS

SIGNS = [
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    " ",
    "\n",
    '"',
    "'",
    "->",
    ":=",
    "*-",
    "12",
    "é",
    "𝄞",
    "; c",
    "# ]",
    "//",
]
PIECES = [*SIGNS, *sorted(KEYWORDS), "for", "a", "robot.light.data > 1", "%%lrp"]


def coloured(text):
    return [(type_, part) for _, type_, part in LRPLexer().get_tokens_unprocessed(text)]


def typed(text, *types):
    return [part for type_, part in coloured(text) if type_ in types]


@given(st.lists(st.sampled_from(PIECES)).map("".join))
def test_every_character_is_coloured_once_and_in_order(text):
    offset = 0
    for start, _, part in LRPLexer().get_tokens_unprocessed(text):
        assert part
        assert start == offset
        offset += len(part)
    assert offset == len(text)


def test_a_tool_finds_it_by_name_and_by_file():
    assert isinstance(get_lexer_by_name("lrp"), LRPLexer)
    assert isinstance(get_lexer_for_filename("wander.lrp"), LRPLexer)


def test_a_text_is_coloured_as_it_is_read():
    text = """%%lrp --world line
(machine move ; it's a comment
  (event near [robot.light.data < 3 and "]" != '"'])  # [
  (state for (running [speed = 2]))
  (on near for 2000 for -> stop tnear))"""
    assert typed(text, Comment.Preproc) == ["%%lrp --world line"]
    assert typed(text, Comment.Single) == ["; it's a comment", "# ["]
    assert typed(text, Keyword) == ["machine", "event", "state", "running", "on", "for"]
    assert typed(text, Name.Namespace, Name.Class, Name.Function) == ["move", "near", "for"]
    assert "".join(part for type_, part in coloured(text) if type_ in String) == '"]"\'"\''
    assert typed(text, Number.Integer) == ["3", "2", "2000"]


def test_bundled_programs_have_their_definitions_in_colour():
    for name in programs.names():
        text = programs.load(name)
        states = re.findall(r"\(state\s+(\w+)", re.sub(r"[;#].*", "", text))
        assert typed(text, Name.Class) == states

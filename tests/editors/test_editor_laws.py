"""Laws of what editors are told: positions, names, colours, and texts that are being written."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lsprotocol import types as lsp
from support.wild import program as programs

from lrp_jupyter import programs as bundled
from lrp_jupyter.editors.hover_cards import card
from lrp_jupyter.editors.live_hints import differences
from lrp_jupyter.editors.outline_symbols import folds, outline, selection
from lrp_jupyter.editors.program_text import AssumedRobot, ProgramText
from lrp_jupyter.editors.semantic_colours import KINDS, encoded, words
from lrp_jupyter.editors.text_positions import TextPositions
from lrp_jupyter.editors.word_options import complete
from lrp_jupyter.language.parser import parse, scan, sketch
from lrp_jupyter.language.reading.matching import matched
from lrp_jupyter.language.reading.tokens import tokenize

ROBOT = AssumedRobot(None, None)
ENCODINGS = {"utf-8": "utf-8", "utf-16": "utf-16-le", "utf-32": "utf-32-le"}
TEXTS = st.text(st.sampled_from("aä€🤖 \r\n\x0b\x85\u2028;([])"), max_size=40)
WORDS = st.sampled_from(
    ["(", ")", "[", "]", "(on", "(state", "x", "->", "'", "; c\n", "\n", "for", "{", "*", "🤖", " "]
)


def text_of(text):
    return ProgramText(text, 1, "utf-16", ROBOT)


@given(TEXTS, st.sampled_from([*ENCODINGS]))
def test_every_offset_has_a_position_and_comes_back(text, encoding):
    at = TextPositions(text, encoding)
    size = {"utf-8": 1, "utf-16": 2, "utf-32": 4}[encoding]
    for offset in range(len(text) + 1):
        found = at.position(offset)
        before = text[:offset].replace("\r\n", "\n").replace("\r", "\n")
        is_between = text[offset - 1 : offset + 1] == "\r\n"
        if not is_between:
            assert found.line == before.count("\n")
            assert found.character == len(before.rpartition("\n")[2].encode(ENCODINGS[encoding])) // size
            assert at.offset(found) == offset
    assert at.offset(lsp.Position(10**6, 0)) == len(text)


@given(programs)
def test_what_is_read_of_a_whole_program_is_the_program(text):
    assert sketch(text) == parse(text)
    assert matched(text) == [*tokenize(text)]


@pytest.mark.slow
@given(programs, st.lists(st.tuples(st.integers(0, 10**6), WORDS), max_size=4), st.integers(0, 10**6))
def test_an_editor_is_answered_whatever_is_written(text, additions, place):
    for at, word in additions:
        at %= len(text) + 1
        text = text[:at] + word + text[at:]
    now, offset = text_of(text), place % (len(text) + 1)
    assert complete(now, offset).begin <= offset
    _, span = card(now, offset) or ("", (offset, offset))
    assert span[0] <= offset <= span[1]
    whole = scan(text)[0]
    assert whole is None or len(outline(now)) == len([*whole.variables, *whole.events, *whole.machines])
    around = selection(now, offset)
    while around is not None:
        start, end = now.at.span(around.range)
        assert start <= offset <= end
        around = around.parent
    last = now.at.position(len(text)).line
    assert all(0 <= fold.start_line < fold.end_line <= last for fold in folds(now))
    coloured = words(now)
    assert all(one.end <= other.start for one, other in pairwise(coloured))


def decoded(text):
    """The words that have a colour, as an editor reads them."""
    data, line, column, found = encoded(text), 0, 0, []
    for index in range(0, len(data), 5):
        down, right, length, kind, _ = data[index : index + 5]
        line, column = line + down, right if down else column + right
        start = text.at.offset(lsp.Position(line, column))
        end = text.at.offset(lsp.Position(line, column + length))
        found.append((text.text[start:end], KINDS[kind]))
    return found


@pytest.mark.parametrize("name", bundled.names())
def test_every_word_of_the_bundled_programs_has_its_colour(name):
    text = text_of(bundled.load(name))
    found = decoded(text)
    kinds = {"machine": "class", "state": "enumMember", "event": "event", "variable": "variable"}
    for symbol in text.symbols[0]:
        expected = kinds.get(symbol.element.kind, "function")
        word = text.text[slice(*symbol.definition)]
        assert found.count((word, expected)) >= 1
    places = {(word.start, word.end) for word in words(text)}
    for start, end in ((each[1], each[2]) for each in tokenize(text.text) if each[0] == "NAME"):
        assert (start, end) in places, text.text[start:end]
    written = "".join(text.text[word.start : word.end] for word in words(text) if word.kind == "comment")
    assert written.count(";") >= sum(line.startswith(";") for line in text.text.splitlines())


def test_python_in_a_block_has_colours():
    found = decoded(text_of('(state s (running [if robot.light.data > 10: # so 🤖\n  robot.say("a\\\nb")]))'))
    for expected in (
        ("if", "keyword"),
        ("10", "number"),
        ("# so 🤖", "comment"),
        ("say", "method"),
        ('b"', "string"),
    ):
        assert expected in found


def test_a_keyword_is_not_looked_for_in_the_comment_before_it():
    text = text_of("(; on\n on x s -> t)")
    assert decoded(text) == [("; on", "comment"), ("on", "keyword"), ("->", "operator")]
    assert "Leads to another state" not in card(text, 4)[0]
    assert "Leads to another state" in card(text, 8)[0]


@pytest.mark.parametrize(
    ("code", "is_known"),
    [
        ("pr|int(1)", True),
        ("x().pr|int", False),
        ("1.re|al", False),
        ("'pr|int'", False),
        ("1 # pr|int\n", False),
        ("f'{pr|int}'", True),
    ],
)
def test_a_word_of_python_is_explained_where_it_means_that(code, is_known):
    text = f"(machine m (state s (running [{code}])))"
    found = card(text_of(text.replace("|", "")), text.index("|"))
    assert bool(found and "```python" in found[0]) is is_known


@given(
    st.lists(
        st.lists(st.sampled_from("abc"), min_size=1, max_size=4), min_size=1, max_size=4, unique_by=tuple
    )
)
def test_what_tells_paths_apart_is_a_part_of_each(paths):
    texts = ["/".join(path) for path in paths]
    found = differences(texts)
    assert all(part in text for part, text in zip(found, texts, strict=True))

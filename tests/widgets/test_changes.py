"""Change sets: merging comes to one text, and to that of CodeMirror, which made `changes.json`."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.widgets.wire.changes import TextChanges, difference, from_units, to_units

TEXT = st.text(st.sampled_from("ab ()\n\U0001d11eé"), max_size=12).map(to_units)


@st.composite
def changes_of(draw, text):
    """Draw changes of a text."""
    sections, left = [], len(text)
    while left:
        length = draw(st.integers(1, left))
        sections.append((length, draw(st.none() | TEXT)))
        left -= length
    return TextChanges.of([*sections, (0, draw(TEXT))])


@st.composite
def concurrent(draw):
    """Draw a text, and two sets of changes that were made to it at the same time."""
    text = draw(TEXT)
    return text, draw(changes_of(text)), draw(changes_of(text))


@given(concurrent())
def test_changes_made_at_the_same_time_come_to_one_text_in_either_order(case):
    text, a, b = case
    assert b.map(a).apply(a.apply(text)) == a.map(b, first=True).apply(b.apply(text))


@given(concurrent())
def test_what_is_inserted_survives_whatever_the_other_side_does(case):
    text, a, b = case
    merged = b.map(a).apply(a.apply(text))
    for changes in (a, b):
        for _, inserted in changes.sections:
            assert (inserted or "") in merged


def test_changes_are_mapped_as_codemirror_maps_them():
    cases = json.loads(Path(__file__).with_name("changes.json").read_text("utf-8"))
    assert len(cases) > 500
    for case in cases:
        a, b = TextChanges.from_json(case["a"]), TextChanges.from_json(case["b"])
        assert b.map(a).json() == case["after_a"], case
        assert a.map(b, first=True).json() == case["before_b"], case
        assert b.map(a).apply(a.apply(to_units(case["text"]))) == to_units(case["both"])


@given(concurrent())
def test_changes_survive_json(case):
    _, changes, _ = case
    assert TextChanges.from_json(json.loads(json.dumps(changes.json()))) == changes


@given(TEXT, TEXT)
def test_the_difference_of_two_texts_makes_one_of_the_other(old, new):
    changes = difference(old, new)
    assert changes.apply(old) == new
    assert (changes.length, changes.new_length) == (len(old), len(new))
    assert changes.is_empty == (old == new)


def test_the_difference_of_two_texts_is_small():
    old = "(state a)\n(state b)\n(eps a -> b)\n(state c)\n"

    renamed = difference(old, old.replace(" a", " far"))
    assert renamed.json() == [7, [1, "far"], 17, [1, "far"], 17]


def test_no_difference_splits_a_character():
    for old, new in [("\U0001d11e", "\U0001d11f"), ("\U0001d11e", "\U0001d51e")]:
        assert [each for each, _ in difference(to_units(old), to_units(new)).sections] == [2]


@given(concurrent(), st.data())
def test_a_place_stays_with_the_text_beside_it(case, data):
    text, changes, _ = case
    place = data.draw(st.integers(0, len(text)))
    before, after = changes.map_place(place), changes.map_place(place, after=True)
    assert 0 <= before <= after <= changes.new_length
    typed = TextChanges.of([(place, None), (0, "|"), (len(text) - place, None)])
    assert changes.map(typed).apply(typed.apply(text)).count("|") - changes.apply(text).count("|") == 1


def test_a_place_is_before_or_after_what_is_inserted_there():
    changes = TextChanges.from_json([1, [0, "xy"], 1])
    assert (changes.map_place(1), changes.map_place(1, after=True)) == (1, 3)
    assert TextChanges.from_json([[3], 1]).map_place(2) == 0


@pytest.mark.parametrize(
    "sections", [[0], [[0]], [-1], [["a"]], [[1, "a\nb"]], [[1, "\r"]], [[1, 2]], [None]]
)
def test_what_is_not_a_set_of_changes_is_refused(sections):
    with pytest.raises(ValueError, match="A section must"):
        TextChanges.from_json(sections)


def test_changes_of_texts_of_other_lengths_are_not_mapped():
    with pytest.raises(ValueError, match="not of one text"):
        TextChanges.from_json([3]).map(TextChanges.from_json([1]))
    with pytest.raises(ValueError, match="not of one text"):
        TextChanges.from_json([[3]]).map(TextChanges.from_json([1]))
    with pytest.raises(ValueError, match="not of one text"):
        TextChanges.from_json([1]).map(TextChanges.from_json([[3]]))


@given(st.text(st.sampled_from("a\r\n\U0001d11e\ud834\udd1e")))
def test_units_become_the_text_again_apart_from_mixed_line_ends(text):
    units = to_units(text)
    assert "\r" not in units
    assert not any(ord(each) > 0xFFFF for each in units)
    assert to_units(from_units(units, "\r\n")) == units
    assert len(units) == len(from_units(units).encode("utf-16-le", "surrogatepass")) // 2

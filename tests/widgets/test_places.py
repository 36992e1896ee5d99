from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.widgets.acts.editor_questions import format_
from lrp_jupyter.widgets.wire import page_places as places
from lrp_jupyter.widgets.wire.page_places import offset_of, range_of


@given(st.text(alphabet="ab \n\r𝄞é"), st.data())
def test_offsets_survive_the_way_to_lines_and_back(text, data):
    start = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(start, len(text)))
    there = range_of(text, start, end)
    assert offset_of(text, there["line"], there["column"]) == start
    assert offset_of(text, there["end_line"], there["end_column"]) == end


def test_columns_count_characters_outside_the_basic_plane_once():
    assert range_of("𝄞𝄞x", 2, 3) == {"line": 1, "column": 3, "end_line": 1, "end_column": 4}


def test_a_place_after_the_text_is_its_end():
    assert offset_of("ab\ncd", 9, 1) == 5
    assert offset_of("ab\ncd", 2, 99) == 5


def test_the_lines_of_a_text_are_counted_once_for_all_edits(monkeypatch):
    counted = []
    count = places.line_starts
    monkeypatch.setattr(places, "line_starts", lambda text: counted.append(text) or count(text))
    text = "(machine m\r\n(state a)(state b)\r\n(on  [a]  a->a))\n"
    edits = format_(None, text)
    assert len(edits) > 4
    assert edits[1] == {
        "range": {"line": 2, "column": 10, "end_line": 2, "end_column": 10},
        "text": "\r\n  ",
    }
    assert len(counted) == 1

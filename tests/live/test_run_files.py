"""Kept runs have names that files can have on every system."""

import pytest

from lrp_jupyter.live.stored.run_files import check_name, possible_name


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("maze, seed 3", "maze, seed 3"),
        ("../a:b", "-a-b"),
        (" .. ", "run"),
        ("con", "run"),
        ("a\u202eb", "a-b"),
        ("x" * 79 + " y", "x" * 79),
    ],
)
def test_every_text_leads_to_a_name_that_a_run_can_have(text, name):
    assert possible_name(text) == name
    check_name(name)

import pytest

from lrp_jupyter.errors import LRPSyntaxError
from lrp_jupyter.language.edits.initials import with_initial

TEXT = """; a comment [with brackets]
(var speed := [ # an odd layout
  0.2 + 0.1 ])
(machine m
  (var time := [1]) (var deep := [2])
  (state a (machine n (var time := [3]) (state b))))
"""


def test_only_the_initialiser_of_the_variable_changes():
    changed = with_initial(TEXT, ("speed",), "0.5")
    assert changed == TEXT.replace("[ # an odd layout\n  0.2 + 0.1 ]", "[0.5]")
    assert with_initial(TEXT, ("deep",), "5") == TEXT.replace("[2]", "[5]")
    assert with_initial(TEXT, ("m", "a", "n", "time"), "5") == TEXT.replace("[3]", "[5]")


def test_a_variable_that_a_spawn_initialises_is_changed_there():
    text = """
(machine follow (var side := [1]) (state s))
(machine m
  (state left (onentry (spawn follow s (var side := [2]))))
  (state right (onentry (spawn follow s (var side := [3]))))
  (state there (onentry (spawn follow s))))
"""
    for path, old in (
        ("m/left/follow/side", "[2]"),
        ("m/right/follow/side", "[3]"),
        ("m/there/follow/side", "[1]"),
        ("follow/side", "[1]"),
        ("side", "[1]"),
    ):
        assert with_initial(text, path, "9") == text.replace(old, "[9]")
    alone = "(machine f (var side := [1]) (state s)) (spawn f s (var side := [2]))"
    for path in ("f/side", ("side",)):
        assert with_initial(alone, path, "9") == alone.replace("[2]", "[9]")


def test_of_two_definitions_the_first_one_counts():
    assert with_initial("(var v := [1]) (var v := [2])", ("v",), "3") == "(var v := [3]) (var v := [2])"


def test_a_text_that_is_not_a_program_has_no_initialisers():
    with pytest.raises(LRPSyntaxError):
        with_initial("(var v := [1]", ("v",), "2")

"""Variables by path, by text and by bare name: the same in frames, sessions and labs."""

import pytest
from support.tables import every

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.by_path import ByPath

VALUES = ByPath({("n",): 5, ("m", "k"): 2, ("m", "a", "inner", "same"): 3, ("m", "same"): 4, ("m", "n"): 6})


@every(
    ("key", "value"),
    [
        (("n",), 5),
        ("n", 5),  # the whole path of one variable, and the name of two
        ("m/n", 6),
        (("m", "k"), 2),
        ("m/k", 2),
        ("k", 2),
        ("m/a/inner/same", 3),
        ("m/same", 4),
    ],
)
def test_a_variable_is_found_by_path_by_text_and_by_its_only_name(key, value):
    assert VALUES[key] == value
    assert VALUES.get(key) == value
    assert key in VALUES


def test_an_ambiguous_name_is_an_error_that_lists_the_paths():
    for read in (VALUES.__getitem__, VALUES.get):
        with pytest.raises(UnknownElementError) as caught:
            read("same")
        assert str(caught.value) == (
            "Several variables are called `same`. Use one of `m/a/inner/same`, `m/same`."
        )
    assert "same" in VALUES


def test_an_unknown_name_is_an_error_with_the_most_similar_one():
    with pytest.raises(UnknownElementError, match=r"no variable `m/kk` now\..* Did you mean `m/k`\?"):
        VALUES["m/kk"]
    assert VALUES.get("m/kk", "none") == "none"
    assert "m/kk" not in VALUES
    assert 3 not in VALUES


def test_a_mapping_iterates_over_paths_and_shows_them_as_text():
    assert list(ByPath({("m", "k"): 2})) == [("m", "k")]
    assert repr(ByPath({("m", "k"): 2})) == "{'m/k': 2}"
    assert ByPath({("m", "k"): 2}) == {("m", "k"): 2}
    assert dict(VALUES.items()) == dict(VALUES)

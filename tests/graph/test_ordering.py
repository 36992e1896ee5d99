"""The order of nodes inside their layers."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.graph.arrangement import order


def crossings(links, level, across):
    down = [sorted(link, key=lambda name: level[name]) for link in links]
    return sum(
        (across[a] - across[c]) * (across[b] - across[d]) < 0
        for i, (a, b) in enumerate(down)
        for c, d in down[:i]
        if level[a] == level[c] and level[b] == level[d]
    )


def test_crossed_links_are_uncrossed():
    level = dict.fromkeys("abc", 0) | dict.fromkeys("xyz", 1)
    links = [("a", "z"), ("b", "y"), ("c", "x")]
    assert crossings(links, level, order("abcxyz", links, level)) == 0


def test_a_link_over_several_layers_does_not_run_through_the_middle_of_others():
    level = {"a": 0, "b": 0, "c": 1, "d": 1, "x": 2, "y": 2}
    links = [("a", "y"), ("b", "c"), ("b", "d"), ("c", "x"), ("d", "x")]
    across = order("abcdxy", links, level)
    assert (across["a"] - across["b"]) * (across["y"] - across["x"]) > 0


def test_nothing_to_order_and_nothing_to_cross():
    assert order((), (), {}) == {}
    assert order("a", [("a", "a")], {"a": 0}) == {"a": 0.0}
    assert order("ab", [("a", "b")], {"a": 0, "b": 0}) == {"a": -0.5, "b": 0.5}


names = "abcdefghij"


@given(
    st.lists(st.integers(0, 4), min_size=10, max_size=10), st.lists(st.tuples(*[st.sampled_from(names)] * 2))
)
def test_every_name_gets_a_place_of_its_own_whatever_the_links(levels, links):
    level = dict(zip(names, levels, strict=True))
    across = order(names, links, level)
    assert across == order(names, links, level)
    for depth in range(5):
        row = sorted(across[name] for name in names if level[name] == depth)
        assert all(right - left >= 1 for left, right in pairwise(row))

"""The checks explain planted mistakes: the four figures over all kinds."""

from __future__ import annotations

import pytest

from . import inside, outside  # noqa: F401  (register their kinds)
from .measure import score, shares
from .planting import corpus
from .sources import sources

LEAST = {"told": 99, "at the line": 98.5, "told once": 98.5, "taken back by the first fix": 88}


def test_there_are_mistakes_of_many_kinds_in_many_programs():
    planted = corpus()
    assert len(planted) >= 41
    assert sum(map(len, planted.values())) >= 12 * 41
    assert len({mistake.program for mistakes in planted.values() for mistake in mistakes}) > 30
    assert all(mistake.wrong != mistake.right for mistakes in planted.values() for mistake in mistakes)


def test_the_programs_have_every_form_of_the_language():
    keywords = {form.keyword for source in sources() for form in source.forms}
    assert len(keywords) == 14


@pytest.mark.parametrize("seed", [0, 1])
def test_mistakes_are_explained(seed: int):
    scores = [score(mistake) for mistakes in corpus(seed=seed).values() for mistake in mistakes]
    found = dict(zip(LEAST, shares(scores), strict=True))
    assert {name: figure for name, figure in found.items() if figure < LEAST[name]} == {}

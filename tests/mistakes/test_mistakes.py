"""The checks explain planted mistakes: the four figures over all kinds."""

from __future__ import annotations

import pytest

from lrp_jupyter.language.reading.tokens import KEYWORDS

from . import inside, numbers, outside  # noqa: F401  (register their kinds)
from .measure import new_findings, score, shares
from .planting import PER_KIND, corpus
from .sources import sources

FIGURES = ("told", "at the line", "told once", "taken back by the first fix")
FEWER = 4
"""Mistakes of each kind that are tried by default."""


@pytest.mark.slow
def test_there_are_mistakes_of_many_kinds_in_many_programs():
    planted = corpus(FEWER, 0)
    assert len(planted) >= 41
    assert sum(map(len, planted.values())) >= 0.9 * FEWER * len(planted)
    assert len({mistake.program for mistakes in planted.values() for mistake in mistakes}) > 30
    assert all(mistake.wrong != mistake.right for mistakes in planted.values() for mistake in mistakes)


def test_the_programs_have_every_form_of_the_language():
    keywords = {form.keyword for source in sources() for form in source.forms}
    assert keywords == KEYWORDS


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "seed", "least"),
    [
        (FEWER, 0, (99.5, 99, 99, 88.5)),
        pytest.param(PER_KIND, 0, (99.5, 99, 99, 88.5), marks=pytest.mark.slow),
        pytest.param(PER_KIND, 1, (99.5, 99, 99, 88.5), marks=pytest.mark.slow),
    ],
)
def test_mistakes_are_explained(count: int, seed: int, least: tuple[float, ...]):
    scores = [score(mistake) for mistakes in corpus(count, seed).values() for mistake in mistakes]
    found = dict(zip(FIGURES, shares(scores), strict=True))
    assert all(figure >= one for figure, one in zip(found.values(), least, strict=True)), found


@pytest.mark.slow
def test_no_mistake_in_python_is_called_smalltalk():
    called = {
        kind
        for kind, mistakes in corpus(FEWER, 0).items()
        if any(finding.code == "LRP519" for mistake in mistakes for finding in new_findings(mistake))
    }
    assert called == {kind for kind in corpus(FEWER, 0) if "Smalltalk" in kind}

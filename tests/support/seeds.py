"""Seeds of random runs: a few by default, all of them together with the slow tests."""

import pytest


def seeds(few: int, many: int) -> list:
    """Return the parameters 0 to `many` - 1; those from `few` on are marked slow."""
    return [*range(few), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(few, many))]

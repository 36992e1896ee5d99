"""What the tests of widgets share."""

import pytest
from support.bench import Bench


@pytest.fixture
def bench():
    made = []

    def make(*arguments, **options):
        made.append(Bench(*arguments, **options))
        return made[-1]

    yield make
    for each in made:
        each.connection.close()
        assert each.connection.fault == ""

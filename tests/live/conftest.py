import threading

import pytest

from lrp_jupyter.live.session import Session


@pytest.fixture
def session():
    """Make sessions that are closed in the end and leave no thread."""
    before = set(threading.enumerate())
    made = []

    def make(text="", *arguments, **options):
        made.append(Session(text, *arguments, **options))
        return made[-1]

    yield make
    for each in made:
        each.close()
    left = [thread for thread in threading.enumerate() if thread not in before and thread.is_alive()]
    assert not left

import pytest
from support.editor_client import EditorClient


@pytest.fixture
def editor(tmp_path):
    """Open an editor on a file of this folder."""
    started = []

    def start(name="my.lrp", **options):
        started.append(EditorClient(tmp_path / name, **options))
        return started[-1]

    yield start
    for each in started:
        each.close()

import subprocess
import sys
import tempfile
from pathlib import Path

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


@pytest.fixture
def run(tmp_path):
    """Run the file of an editor."""
    started = []

    def start(file, *options):
        command = [sys.executable, "-m", "lrp_jupyter", "run", str(file), "--watch", "--socket", *options]
        started.append(subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True))
        return started[-1]

    yield start
    for each in started:
        if each.poll() is None:
            each.kill()
        each.communicate()


@pytest.fixture(autouse=True)
def runtime(monkeypatch):
    with tempfile.TemporaryDirectory(prefix="lrp-", dir="/tmp") as folder:  # short: the path of a socket
        monkeypatch.setenv("XDG_RUNTIME_DIR", folder)
        yield Path(folder) / "lrp-jupyter"

"""A Python that this package starts finds the modules that this one finds, and runs no stranger's."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from lrp_jupyter.process import python_of

TAKEN = sys.stdlib_module_names | {"sitecustomize", "usercustomize", "startup", "lrp_jupyter", "pip"}
TELLS = "import json, random, sys; print(json.dumps([sys.argv[1:], sys.path, __name__]))"


@pytest.fixture
def strange(tmp_path, monkeypatch):
    """Be in a folder in which each module of Python's own has a namesake, and is where Python starts."""
    for name in TAKEN:
        (tmp_path / f"{name}.py").write_text("open('ran', 'a').write(__file__)")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", f"{os.pathsep}{tmp_path}")
    monkeypatch.setenv("PYTHONSTARTUP", "startup.py")
    monkeypatch.setenv("PYTHONINSPECT", "1")
    monkeypatch.setenv("PYTHONWARNINGS", "error::startup.Warning")
    return tmp_path


def ran(module, *arguments, path):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "path", path)
        started = python_of(module, *arguments)
    done = subprocess.run(**started, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert not Path("ran").exists()
    return json.loads(done.stdout)


@pytest.mark.parametrize("here", ["", ".", None], ids=["empty", "relative", "absolute"])
def test_the_current_folder_is_searched_last_and_not_while_python_starts(strange, here):
    (strange / "mine.py").write_text(TELLS)
    arguments, path, name = ran(
        "mine", "--a", "b c", path=[str(strange) if here is None else here, *sys.path]
    )
    assert (arguments, name) == (["--a", "b c"], "__main__")
    assert (path[0], path[-1]) == (os.path.dirname(os.__file__), str(strange))
    assert sorted(path[:-1]) == sorted({os.path.abspath(each) for each in sys.path} - {str(strange)})


def test_a_folder_that_this_process_does_not_search_is_not_searched(strange, tmp_path_factory):
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (elsewhere / "mine.py").write_text(TELLS)
    _, path, _ = ran("mine", path=[str(elsewhere), *sys.path])
    assert str(strange) not in path


def test_every_process_of_the_package_is_started_in_this_way(package_sources):
    started = {name for name, text in package_sources.items() if "sys.executable" in text}
    assert started == {"process.py"}


@pytest.fixture(scope="module")
def package_sources():
    package = Path(sys.modules["lrp_jupyter"].__file__).parent
    return {
        path.relative_to(package).as_posix(): path.read_text(encoding="utf-8")
        for path in package.rglob("*.py")
    }

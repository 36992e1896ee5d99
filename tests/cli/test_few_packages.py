"""The command with the few packages that the documentation lists, as if no others were installed."""

import re
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow  # each starts processes of its own

PAGE = Path(__file__).parents[2] / "notebooks" / "command-line.md"
LISTED = re.search(r"--no-deps \. && pip install ([\w -]+)", PAGE.read_text(encoding="utf-8"))
WITHOUT = """\
import sys
hidden, finders = set({hidden!r}), list(sys.meta_path)
class Others:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] not in hidden:
            return next(filter(None, (each.find_spec(name, path, target) for each in finders)), None)
    def find_distributions(self, context):
        able = [each for each in finders if hasattr(each, "find_distributions")]
        return [found for each in able for found in each.find_distributions(context)]
sys.meta_path[:] = [Others()]
from lrp_jupyter.cli import main
main()
"""
TEXT = "(machine m (state a) (state b) (ontime 300 a -> b go)) (spawn m a)\n"


def plain(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def with_all_they_need(names):
    """These packages, and all that pip installs with them."""
    found, waiting = {"lrp-jupyter", "pip", "setuptools"}, list(names)
    while waiting:
        name = plain(waiting.pop())
        if name in found:
            continue
        try:
            needs = requires(name) or []
        except PackageNotFoundError:  # of another platform
            continue
        found.add(name)
        waiting += [re.match(r"[\w.-]+", each)[0] for each in needs if "extra ==" not in each]
    return found


@pytest.fixture
def lrp(tmp_path):
    there = with_all_they_need(LISTED[1].split())
    hidden = {name for name, of in packages_distributions().items() if not there & set(map(plain, of))}
    assert {"pymunk", "anywidget", "ipywidgets", "traitlets", "IPython", "jupyterlab"} <= hidden
    code = WITHOUT.format(hidden=sorted(hidden))
    (tmp_path / "my.lrp").write_text(TEXT)

    def run(*arguments):
        command = [sys.executable, "-c", code, *arguments]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=240)

    return run


def test_programs_run_on_a_robot_and_are_asked_and_replayed_with_the_packages_listed(lrp):
    drive = ("run", "my.lrp", "--bridge", "none", "--for", "1", "--speed", "max", "--record", "my.lrplog")
    for arguments, said in (
        (drive, "m/b active"),
        (("why", "my.lrplog", "go"), "`go`"),
        (("replay", "my.lrplog"), "The run matches the recording."),
        (("check", "my.lrp"), "no findings"),
        (("graph", "my.lrp"), "<svg"),
        (("format", "my.lrp"), ""),
    ):
        done = lrp(*arguments)
        assert (done.returncode, said in done.stdout + done.stderr) == (0, True), (arguments, done.stderr)


@pytest.mark.parametrize(
    "arguments",
    [("run", "my.lrp", "--for", "1"), ("grade", "my.lrp", "--challenge", "square")],
    ids=" ".join,
)
def test_what_needs_the_simulator_says_how_to_get_it(lrp, arguments):
    done = lrp(*arguments)
    assert done.returncode != 0
    assert "Simulated worlds need `pymunk`: install it with `pip install pymunk`." in done.stderr
    assert "Traceback" not in done.stderr


def test_the_language_server_says_how_to_get_it(lrp):
    done = lrp("language-server")
    assert done.returncode == 2
    assert 'Install it with `pip install "lrp-jupyter[editors]"`.' in done.stderr


def test_the_page_of_a_run_says_how_to_get_it(lrp):
    done = lrp("run", "my.lrp", "--bridge", "none", "--serve", "0")
    assert done.returncode == 2
    assert "--serve needs `websockets`: install it with" in done.stderr


def test_the_lab_says_how_to_get_it(lrp):
    done = lrp("lab")
    assert 'Install it with `pip install "lrp-jupyter[lab]"`.' in done.stderr

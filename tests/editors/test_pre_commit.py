"""The hooks for pre-commit, run as it runs them: with the names of files."""

import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

pytestmark = pytest.mark.slow  # processes of their own
HOOKS = yaml.safe_load((Path(__file__).parents[2] / ".pre-commit-hooks.yaml").read_text())
RIGHT = "(machine m\n  (state a))\n(spawn m a)\n"


@pytest.mark.parametrize(
    ("hook", "text", "fails", "after"),
    [
        ("lrp-check", RIGHT, False, RIGHT),
        ("lrp-check", "(machine m (state a)", True, "(machine m (state a)"),
        ("lrp-format", RIGHT, False, RIGHT),
        ("lrp-format", "(machine   m\n (state a))\n(spawn m a)\n", False, RIGHT),
        ("lrp-format", "(machine m (state a)", True, "(machine m (state a)"),
    ],
)
def test_a_hook_fails_or_changes_the_file(tmp_path, hook, text, fails, after):
    (found,) = [each for each in HOOKS if each["id"] == hook]
    program, *arguments = shlex.split(found["entry"])
    file = tmp_path / "mine.lrp"
    file.write_text(text)
    run = [Path(sys.executable).with_name(program), *arguments, file]
    assert bool(subprocess.run(run, capture_output=True).returncode) == fails
    assert file.read_text() == after

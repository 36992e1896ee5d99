"""Neovim, with the file that is shipped for it; and what is shipped for other editors."""

import json
import os
import shutil
import subprocess
import sys
import tomllib
from importlib.resources import files
from pathlib import Path

import pytest

SHIPPED = files("lrp_jupyter.editors")
HERE = Path(__file__).parent
PROGRAM = """\
(var pace := [0.2])
(event dark [robot.light.data < 100])
(machine rover
  (state driving (running [robot.move(linear=pace)]))
  (state turning (running [robot.move(angular=1)]))
  (on dark driving -> turnin)
  (ontime 500 turning -> driving))
(spawn rover driving)
"""


@pytest.fixture
def neovim(tmp_path):
    """Run a Lua file in Neovim with a program, and return what it tells."""
    if shutil.which("nvim") is None:
        pytest.skip("Neovim is not installed")
    binaries = tmp_path / "bin"
    binaries.mkdir()
    command = binaries / "lrp"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m lrp_jupyter "$@"\n')
    command.chmod(0o755)
    program, told = tmp_path / "my.lrp", tmp_path / "told.json"
    program.write_text(PROGRAM)
    environment = os.environ | {
        "PATH": f"{binaries}:{os.environ['PATH']}",
        "HOME": str(tmp_path),
        "XDG_CONFIG_HOME": str(tmp_path),
        "XDG_STATE_HOME": str(tmp_path),
        "LRP_TOLD": str(told),
    }
    plugins = tmp_path / "nvim" / "after" / "plugin"
    plugins.mkdir(parents=True)
    shutil.copy(str(SHIPPED / "neovim" / "lrp.lua"), plugins)

    def start(script):
        command = ["nvim", "--headless", "-n", str(program), "-c", f"luafile {HERE / script}"]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
        assert told.exists(), done.stdout + done.stderr
        return json.loads(told.read_text())

    return start


@pytest.mark.slow
def test_neovim_marks_fixes_explains_renames_lays_out_and_completes(neovim):
    told = neovim("inside_neovim.lua")
    assert "missing" not in told, told
    assert told["codes"] == ["LRP303"]
    assert "robot.move(linear=0.0, angular=0.0)" in told["hover"]
    fixed = PROGRAM.replace("turnin)", "turning)").replace("driving", "rolling")
    assert told["text"] == fixed.rstrip("\n")
    assert told["completion"] == ["turning"]


@pytest.mark.slow
def test_neovim_shows_the_values_of_a_run(neovim, run, tmp_path):
    run(tmp_path / "my.lrp", "--set", "pace=0.25")
    told = neovim("live_in_neovim.lua")
    pace, dark, driving = (each.strip() for each in told["shown"])
    assert (pace, driving) == ("= 0.25", "● active")
    assert dark in ("= True", "= False")


def test_helix_starts_the_server():
    settings = tomllib.loads((SHIPPED / "helix" / "languages.toml").read_text(encoding="utf-8"))
    (language,) = settings["language"]
    assert language["file-types"] == ["lrp"]
    assert settings["language-server"][language["language-servers"][0]]["args"] == ["language-server"]

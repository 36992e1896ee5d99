"""A bridge in a package of its own, installed by pip: found by its entry point, used by its name."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow  # each starts processes of its own

PACKAGE = Path(__file__).with_name("example_package")
RIDE = """
(machine lift
  (state up (running [robot.move(linear=1.0)]))
  (state top (onentry [robot.move(linear=0)]))
  (on [robot.floor.data >= 2] up -> top ttop))
(spawn lift up)
"""

Command = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which pip has installed the package."""
    folder = tmp_path_factory.mktemp("installed")
    offline = ("--no-index", "--no-build-isolation", "--no-deps")
    command = [sys.executable, "-m", "pip", "install", "--quiet", *offline, "--target", folder, PACKAGE]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PYTHONWARNINGS": ""})
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture
def python(installed: Path, tmp_path: Path) -> Command:
    """Run Python where the package is installed."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *map(str, arguments)],
            env={**os.environ, "PYTHONPATH": str(installed)},
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=180,
        )

    return run


@pytest.fixture
def ride(tmp_path: Path) -> Path:
    path = tmp_path / "ride.lrp"
    path.write_text(RIDE, encoding="utf-8")
    return path


def test_lrp_bridges_lists_it_with_the_package_it_comes_from(python: Command) -> None:
    listed = python("-m", "lrp_jupyter", "bridges")
    row = next(line for line in listed.stdout.splitlines() if line.startswith("lift"))
    assert row.rstrip().split(maxsplit=2) == ["lift", "lrp-lift", "A lift in a house with some floors."]


def test_lrp_run_uses_it(python: Command, ride: Path) -> None:
    options = ("--bridge", "lift", "--speed", "max", "--until", "top", "--trace", "-")
    ran = python("-m", "lrp_jupyter", "run", ride, *options)
    assert ran.returncode == 0, ran.stderr
    lines = [json.loads(line) for line in ran.stdout.splitlines()]
    last = next(line for line in reversed(lines) if line["event"] != "commanded")
    assert (last["event"], last["state"]) == ("entered", "lift/top")
    assert 6.0 <= last["time"] < 6.5, "two floors of three metres, at a metre a second"


def test_its_options_are_those_of_the_command_line(python: Command, ride: Path) -> None:
    run = ("-m", "lrp_jupyter", "run", ride, "--bridge", "lift", "--speed", "max", "--for", "20")
    assert "lift/top active" in python(*run, "--option", "floors=2").stdout
    assert "lift/up active" in python(*run, "--option", "floors=1").stdout, "it is as high as the house"
    wrong = python(*run, "--option", "floor=1")
    assert wrong.returncode == 2
    assert "`floor`" in wrong.stderr


def test_it_passes_the_public_conformance_tests(python: Command) -> None:
    code = (
        "from lrp_jupyter.bridges.conformance import check_bridge\n"
        "from lrp_jupyter.bridges.discovery import find_bridges\n"
        "report = check_bridge(find_bridges()['lift'].load())\n"
        "print(report)\n"
        "raise SystemExit(not report.passed)\n"
    )
    checked = python("-c", code)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_where_it_is_not_installed_the_bridge_is_unknown(ride: Path) -> None:
    command = [sys.executable, "-m", "lrp_jupyter", "run", str(ride), "--bridge", "lift"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=180)
    assert done.returncode == 2
    assert "There is no bridge `lift`" in done.stderr

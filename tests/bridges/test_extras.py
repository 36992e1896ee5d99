"""What a robot needs is an extra: nothing of it is imported before its bridge is opened."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import requires
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow  # each starts processes of its own

LIBRARIES = ("websockets", "rospy", "rosgraph", "genpy", "roslibpy", "ev3_dc", "cyclonedds", "rosbags")
BRIDGES = ("lrp_jupyter.bridges.ros", "lrp_jupyter.bridges.ev3")

Start = Callable[..., "subprocess.Popen[str]"]


def imported_by(code: str, names: tuple[str, ...]) -> list[str]:
    """Those of these modules that a process of its own has imported after some code."""
    code += f"\nimport sys\nprint(*(name for name in {names!r} if name in sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()[-1].split()


def test_a_program_on_the_simulator_imports_nothing_of_other_robots() -> None:
    code = """
from lrp_jupyter import Session
from lrp_jupyter.bridges.discovery import find_bridges
assert {"ros", "ev3"} <= set(find_bridges())
Session("(machine m (state a (running [robot.move(linear=0.1)]))) (spawn m a)", bridge="sim").run(1)
"""
    assert imported_by(code, LIBRARIES + BRIDGES) == []


@pytest.mark.parametrize(("bridge", "other"), [("ros.RosBridge", "ev3"), ("ev3.EV3Bridge", "ros")])
def test_a_bridge_that_is_made_and_not_opened_imports_no_library(bridge: str, other: str) -> None:
    module, _, name = bridge.partition(".")
    code = f"from lrp_jupyter.bridges.{module} import {name}\n{name}(host='127.0.0.1').panel()"
    assert imported_by(code, (*LIBRARIES, f"lrp_jupyter.bridges.{other}")) == []


def test_the_core_is_installed_without_them() -> None:
    needed = [each for each in requires("lrp-jupyter") or () if "extra" not in each]
    assert needed
    assert not [each for each in needed if each.startswith(("websockets", "cyclonedds", "ev3", "ros"))]
    assert [each for each in requires("lrp-jupyter") or () if each.startswith("websockets") and "ros" in each]


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ((), '`pip install "lrp-jupyter[ros]"`'),
        (("--option", "backend=rospy"), "rospy"),
        (("--option", "backend=dds"), '`pip install "lrp-jupyter[ros2]"`'),
    ],
)
def test_where_a_library_is_missing_the_error_names_what_to_install(
    bare_lrp: Start, tmp_path: Path, options: tuple[str, ...], sentence: str
) -> None:
    program = tmp_path / "wait.lrp"
    program.write_text("(machine m (state a)) (spawn m a)")
    run = bare_lrp("run", program, "--bridge", "ros", "--host", "127.0.0.1", *options, missing=LIBRARIES)
    _output, complaints = run.communicate(timeout=180)
    assert run.returncode == 2
    assert complaints.startswith("lrp: ")
    assert sentence in complaints
    assert complaints.count("\n") == 1

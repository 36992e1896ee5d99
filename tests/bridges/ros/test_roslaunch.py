"""A program beside other nodes: roslaunch starts, names and remaps it, starts it again and ends it."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sys
import xmlrpc.client
from pathlib import Path
from typing import Any

import pytest
from bridges.ros.conftest import HERE
from support.waiting import until

pytestmark = [pytest.mark.ros, pytest.mark.slow]

DOCUMENTED = HERE.parents[2] / "notebooks" / "ros"
FILES = {
    "drive.lrp": "(machine m (state a (running [robot.move(linear=0.1)]))) (spawn m a)",
    "robot.json": json.dumps({"publishers": {"move": {"topic": "cmd_vel", "type": "geometry_msgs/Twist"}}}),
    "lrp": f"""#!{sys.executable}
from lrp_jupyter.bridges.guarding import guard
from lrp_jupyter.cli import main
guard._LAPSE = 60.0  # the machine may be loaded
main()
""",
}

TERMINAL = "import os, pty, sys; sys.exit(os.waitstatus_to_exitcode(pty.spawn(sys.argv[1:])))"
SYNCHRONIZED = "\x1b[?2026h"  # how a board begins


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """A folder with a package."""
    package = tmp_path / "behaviour"
    package.mkdir()
    for name in ("package.xml", "behaviour.launch"):
        shutil.copy(DOCUMENTED / name, package)
    for name, text in FILES.items():
        (package / name).write_text(text)
    (package / "lrp").chmod(0o755)
    return tmp_path


@pytest.fixture
def master(real: Any) -> Any:
    import rosgraph

    return rosgraph.Master("/tests")


def test_a_launch_file_names_remaps_starts_again_and_ends_a_program(
    real: Any, master: Any, workspace: Path
) -> None:
    def moves() -> bool:
        return bool(wheels) and not wheels[-1].endswith(" 0.0")

    def pid() -> int:
        with xmlrpc.client.ServerProxy(master.lookupNode("/robot1/behaviour")) as node:
            return int(node.getPid("/tests")[2])

    robot = (sys.executable, str(HERE / "robot_node.py"), "1", "empty", "/cmd_vel:=/base/cmd_vel")
    wheels: list[str] = real.lines(real.start(*robot, ready=True))
    launch = workspace / "behaviour" / "behaviour.launch"
    command = (
        "/usr/bin/env",
        f"ROS_PACKAGE_PATH={workspace}",
        "/usr/bin/roslaunch",
        str(launch),
        "program:=drive",
    )
    roslaunch = real.start(sys.executable, "-c", TERMINAL, *command)
    printed: list[str] = real.lines(roslaunch)
    until(moves, lambda: printed)
    assert "/robot1/behaviour" in dict(master.getSystemState()[0])["/base/cmd_vel"]

    first = pid()
    os.kill(first, signal.SIGKILL)
    until(lambda: not moves())  # by the guard
    until(moves, lambda: printed)
    assert pid() != first

    roslaunch.stdin.write("\x03")  # Ctrl-C
    roslaunch.stdin.flush()
    assert roslaunch.wait(180) == 0
    until(lambda: any(line.startswith("drive: ") for line in printed))
    assert SYNCHRONIZED not in "".join(printed), "no board, in a terminal that it shares with other nodes"
    until(lambda: not moves())

"""ROS's own libraries, rospy and rclpy, which are there for one Python: that of the distribution of ROS.

A virtual environment hides them, and so does another Python. In a shell with ROS set up, ``PYTHONPATH`` shows
them to every Python, but the compiled parts of rclpy, and what rospy needs, fit only theirs.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from functools import cache
from importlib import import_module

from lrp_jupyter.process import PYTHON

_SYSTEM = "/usr/bin/python3"  # that of the operating system, for which ROS is made
_OLDEST = (3, 11)  # that this package runs on
_INSTEAD: Mapping[str, str] = {
    "rospy": "the back end `rosbridge`, with rosbridge_server on the robot's side",
    "rclpy": "the back end `dds`, or `rosbridge` with rosbridge_server on the robot's side",
}
_MISSING: Mapping[str, str] = {
    "rospy": "Install it (Debian 12: `apt install python3-rospy`)",
    "rclpy": "Start in a shell with ROS 2 set up (`source /opt/ros/jazzy/setup.bash`)",
}
_ANSWER = 10.0  # seconds for the other Python to answer


def lacks_library(library: str) -> str:
    """Return why this Python has no rospy, or no rclpy, and the remedy; an empty text if it has it."""
    try:
        import_module(library)
    except Exception as error:  # what is compiled for another Python raises whatever it happens to
        why = str(error) or type(error).__name__
    else:
        return ""
    here = f"this Python ({PYTHON}, {sys.version.split()[0]}) has no {library} ({why})"
    version = _version_with(library)
    if version is None:
        remedy = f"{_MISSING[library]}, or use {_INSTEAD[library]}."
    elif version >= _OLDEST:
        remedy = f"`{_SYSTEM}` has it: make the environment with `{_SYSTEM} -m venv --system-site-packages`."
    else:
        older, oldest = (".".join(map(str, each)) for each in (version, _OLDEST))
        remedy = (
            f"It is for `{_SYSTEM}`, which is Python {older}, and this package needs {oldest} or later: use"
            f" {_INSTEAD[library]}."
        )
    return f"{here}. {remedy}"


@cache
def _version_with(library: str) -> tuple[int, ...] | None:
    """Return the version of the system's Python, if that has the library."""
    ask = f"import {library}, sys; print(*sys.version_info[:2])"
    try:
        told = subprocess.run(  # not in the current folder, where a module may have such a name
            [_SYSTEM, "-c", ask], cwd=os.sep, capture_output=True, text=True, timeout=_ANSWER
        )
        return tuple(map(int, told.stdout.split())) or None
    except (OSError, ValueError, subprocess.SubprocessError):
        return None

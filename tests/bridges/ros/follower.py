"""The bundled follower on a ROS robot: its set-up, and there and back on the course of the paper."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.clock import MonotonicClock
from lrp_jupyter.live.session import Session

SETUP = Path(__file__).with_suffix(".json")
FRESH: dict[str, Any] = json.loads(SETUP.read_text())  # one whose readings become too old
for _wire in FRESH["subscriptions"].values():
    _wire["stale_after"] = 0.5
FASTER = 4.0  # both the robot's time and the program's
PATIENT = """
from lrp_jupyter.bridges import guard
from lrp_jupyter.bridges.ros import RosBridge, websocket
guard._LAPSE = websocket._STALE = websocket._FRESH = 60.0
RosBridge.stopper = lambda bridge: None
"""  # what a program on a loaded machine begins with
_PROGRAM = files("lrp_jupyter.programs").joinpath("follower.lrp").read_text(encoding="utf-8")


def go_there_and_back(ros: RosBridge) -> None:
    """Run the program, unchanged, with a robot that is so much faster."""
    with Session(_PROGRAM, bridge=ros, clock=MonotonicClock(FASTER)) as session:
        session.start()
        assert session.wait_for("bumpback", timeout=180)
        assert ros.robot.odom.x > 1.0
        assert session.wait_for("end", timeout=180)
        assert ros.robot.odom.x < 0.0
        assert [issue.message for issue in session.issues] == []


def last_state(trace: Path) -> str:
    """The state that was entered last."""
    lines = map(json.loads, reversed(trace.read_text().splitlines()))
    return str(next(line["state"] for line in lines if line["event"] == "entered"))

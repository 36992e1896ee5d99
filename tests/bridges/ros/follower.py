"""The bundled follower on a ROS robot: its set-up, and there and back on the course of the paper."""

from __future__ import annotations

import json
import math
import threading
from importlib.resources import files
from pathlib import Path
from typing import Any

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.session import Session

SETUP = Path(__file__).with_suffix(".json")
FRESH: dict[str, Any] = json.loads(SETUP.read_text())  # one whose readings become too old
for _wire in FRESH["subscriptions"].values():
    _wire["stale_after"] = 0.5
AT_ONCE = math.inf  # the speed of a robot whose time passes when it is commanded
PATIENT = """
from lrp_jupyter.bridges import guard
from lrp_jupyter.bridges.ros import RosBridge, websocket
guard._LAPSE = websocket._STALE = websocket._FRESH = 60.0
RosBridge.stopper = lambda bridge: None
"""  # what a program on a loaded machine begins with
_PROGRAM = files("lrp_jupyter.programs").joinpath("follower.lrp").read_text(encoding="utf-8")


class RobotTime:
    """The time of a robot as the clock of its program: what is held up waits for the other.

    The robot tells its time in the frame of its odometry.
    """

    speed = 1.0

    def __init__(self, ros: RosBridge) -> None:
        self._ros, self._base = ros, 0.0

    def _there(self) -> float:
        latest = [each.latest for each in self._ros.wiring.channels if each.wire.variable == "odom"]
        return float(latest[0].value.header.frame_id) if latest and latest[0] else 0.0

    def now(self) -> float:
        return self._there() - self._base

    def sleep_until(self, t: float, wake: threading.Event) -> None:
        while self.now() < t and not wake.wait(0.002):
            pass

    def delay(self, t: float) -> float:
        raise NotImplementedError

    def rebase(self, t: float) -> None:
        self._base = self._there() - t

    def pause(self) -> None:
        """It passes all the same."""

    resume = pause


def go_there_and_back(ros: RosBridge) -> None:
    """Run the program, unchanged, with a robot `AT_ONCE`."""
    with Session(_PROGRAM, bridge=ros, clock=RobotTime(ros)) as session:
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

"""The bundled follower on a ROS robot: its set-up, and there and back on the course of the paper."""

from __future__ import annotations

import json
import threading
from contextlib import suppress
from importlib.resources import files
from pathlib import Path
from typing import Any

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.simulation import STEP

SETUP = Path(__file__).with_suffix(".json")
LOOSE: dict[str, Any] = json.loads(SETUP.read_text())  # whose changes are not saved, on a machine that stalls
FRESH: dict[str, Any] = json.loads(SETUP.read_text())  # one whose readings become too old
for _setup, _seconds in ((LOOSE, None), (FRESH, 0.5)):
    for _wire in _setup["subscriptions"].values():
        _wire["stale_after"] = _seconds
_ROUNDING = 1e-6  # s
TOLD = 0.0  # the speed of a robot whose time passes when it is told to
PATIENT = """
from lrp_jupyter.bridges.guarding import guard
from lrp_jupyter.bridges.ros import RosBridge, websocket
guard._LAPSE = websocket._STALE = websocket._FRESH = 60.0
RosBridge.stopper = lambda bridge: None
"""  # what a program on a loaded machine begins with
_PROGRAM = files("lrp_jupyter.programs").joinpath("follower.lrp").read_text(encoding="utf-8")


class RobotTime:
    """The time of a robot as the clock of its program: neither can be held up without the other.

    The robot goes on when it obeys the last command, and the program when it has all readings of that time.
    """

    speed = 1.0

    def __init__(self, ros: RosBridge) -> None:
        ros.publish("until", "/until", "std_msgs/Float64")
        self._ros, self._base, self._steps = ros, 0.0, 0

    def _there(self) -> float:
        odom, light = self._channel("odom").latest, self._channel("light").latest
        if odom and light:
            steps = int(odom.value.header.frame_id)
            if steps % 16 == light.value.data % 16:
                self._steps = steps
        return self._steps * STEP

    def _obeys(self) -> bool:
        odom, sent = self._channel("odom").latest, self._channel("move").last_sent
        if not odom or not sent:
            return sent is None
        told, wanted = odom.value.twist.twist, sent.as_dict()
        return bool((told.linear.x, told.angular.z) == (wanted["linear"]["x"], wanted["angular"]["z"]))

    def _channel(self, variable: str) -> Channel:
        return next(each for each in self._ros.wiring.channels if each.wire.variable == variable)

    def now(self) -> float:
        return self._there() - self._base + _ROUNDING

    def sleep_until(self, t: float, wake: threading.Event) -> None:
        asked, polls = -1.0, 0
        while self.now() < t and not wake.wait(0.001):
            goal = t + self._base if self._obeys() else self._there()
            if goal != asked or polls % 100 == 0:  # again: at first, there may be no subscriber
                with suppress(BridgeError):  # it is not connected yet
                    self._ros.robot.until(data=goal)
            asked, polls = goal, polls + 1

    def delay(self, t: float) -> float:
        raise NotImplementedError

    def rebase(self, t: float) -> None:
        self._base = self._there() - t

    def pause(self) -> None:
        """It passes all the same."""

    resume = pause


def go_there_and_back(ros: RosBridge) -> None:
    """Run the program, unchanged, with a robot whose time is `TOLD`."""
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

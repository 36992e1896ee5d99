"""The public checks of every bridge, on the back end `dds` and a robot in another process."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.ros import RosBridge

pytestmark = pytest.mark.ros

SETUP: dict[str, Any] = json.loads((Path(__file__).parents[1] / "follower.json").read_text())
for _wire in SETUP["subscriptions"].values():
    _wire["stale_after"] = 0.5
_LEASE = 2.0  # s, less than the checks allow until a robot is lost


class TestDds(BridgeConformance):
    moves = True

    @pytest.fixture(autouse=True)
    def _connected(self, robot: Callable[..., Any], processes: Any) -> None:
        self.start, self.end = robot, processes.end
        self.robot = robot(lease=_LEASE)
        self.told = processes.lines(self.robot)  # it prints when it is told another speed

    def make_bridge(self) -> Bridge:
        return RosBridge(backend="dds", setup=SETUP)

    def has_moved(self, bridge: Bridge) -> bool:
        return bool(self.told)

    def silence(self) -> None:
        os.killpg(self.robot.pid, signal.SIGSTOP)

    def cut(self) -> None:
        self.end(self.robot)

    def restore(self) -> None:
        if self.robot.poll() is None:
            os.killpg(self.robot.pid, signal.SIGCONT)
        else:
            self.robot = self.start(lease=_LEASE)

"""The public checks of every bridge, on the back end `dds` and a robot in another process."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from typing import Any

import pytest
from bridges.ros.follower import FRESH

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.ros import RosBridge

pytestmark = pytest.mark.ros

_LEASE = 2.0  # s, less than the checks allow until a robot is lost


class TestDds(BridgeConformance):
    moves = True
    robot: Any = None  # for all checks
    told: list[str]  # it prints when it is told another speed

    @pytest.fixture(autouse=True)
    def _connected(self, robot: Callable[..., Any], processes: Any) -> None:
        self.launch, self.processes = robot, processes
        if TestDds.robot is None:
            self.start()
        self.before = len(self.told)

    def start(self) -> None:
        TestDds.robot = self.launch(lease=_LEASE)
        TestDds.told = self.processes.lines(TestDds.robot)

    def make_bridge(self) -> Bridge:
        return RosBridge(backend="dds", setup=FRESH)

    def has_moved(self, bridge: Bridge) -> bool:
        return len(self.told) > self.before

    def silence(self) -> None:
        os.killpg(self.robot.pid, signal.SIGSTOP)

    def cut(self) -> None:
        self.processes.end(self.robot)

    def restore(self) -> None:
        if self.robot.poll() is None:
            os.killpg(self.robot.pid, signal.SIGCONT)
        else:
            self.start()
            self.before = 0

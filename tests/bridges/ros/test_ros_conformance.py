"""The public checks of every bridge, on both back ends."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.ros import RosBridge

SETUP = Path(__file__).with_name("follower.json")


class TestRosbridge(BridgeConformance):
    @pytest.fixture(autouse=True)
    def _connected(self, server: Any) -> None:
        self.port = server.port

    def make_bridge(self) -> Bridge:
        return RosBridge(backend="rosbridge", host="127.0.0.1", port=self.port, setup=SETUP)


@pytest.mark.ros
class TestRospy(BridgeConformance):
    @pytest.fixture(autouse=True)
    def _connected(self, lasting: Any) -> None:
        self.port = lasting.master_port
        first = self.make_bridge()  # rospy's one node, with its threads, stays with the process
        first.open()
        first.close()

    def make_bridge(self) -> Bridge:
        return RosBridge(backend="rospy", host="127.0.0.1", port=self.port, setup=SETUP)

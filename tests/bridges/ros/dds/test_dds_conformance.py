"""The public checks of every bridge, on the back end `dds` and a robot in another process."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.ros import RosBridge

pytestmark = pytest.mark.ros

SETUP = Path(__file__).parents[1] / "follower.json"


class TestDds(BridgeConformance):
    @pytest.fixture(autouse=True)
    def _connected(self, robot: Callable[..., Any]) -> None:
        robot()

    def make_bridge(self) -> Bridge:
        return RosBridge(backend="dds", setup=SETUP)

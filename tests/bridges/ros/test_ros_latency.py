"""The latency of a robot behind rospy and rosbridge; see `latency.py`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.ros import latency

from lrp_jupyter.bridges.ros import RosBridge

pytestmark = pytest.mark.ros

HERE = Path(__file__).parent


@pytest.mark.parametrize("rate", [10, 50])
def test_every_change_of_the_light_is_answered(
    real: Any,
    connect: Callable[..., RosBridge],
    backend: str,
    rate: int,
    capsys: pytest.CaptureFixture[str],
) -> None:
    node = real.start(sys.executable, str(HERE / "latency_node.py"), latency.CHANGES, ready=True)
    bridge = connect(setup=HERE / "follower.json")
    latency.tell(capsys, backend, rate, latency.measure(bridge, rate, node))

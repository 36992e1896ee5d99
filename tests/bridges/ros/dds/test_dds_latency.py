"""The latency of a robot behind DDS; see `latency.py` in the folder above."""

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
    domain: int,
    processes: Any,
    connect: Callable[..., RosBridge],
    rate: int,
    capsys: pytest.CaptureFixture[str],
) -> None:
    node = processes.start(sys.executable, str(HERE / "dds_latency_node.py"), latency.CHANGES, ready=True)
    bridge = connect(setup=HERE.parent / "follower.json")
    latency.tell(capsys, "dds", rate, latency.measure(bridge, rate, node))

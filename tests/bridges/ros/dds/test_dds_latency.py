"""The latency of a robot behind DDS; see `latency.py` in the folder above."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.ros.latency import CHANGES, measure

from lrp_jupyter.bridges.ros import RosBridge


@pytest.mark.ros
def test_every_change_of_the_light_is_answered(
    domain: int, processes: Any, connect: Callable[..., RosBridge], capsys: pytest.CaptureFixture[str]
) -> None:
    script = str(Path(__file__).with_name("dds_latency_node.py"))
    measure(processes.start(sys.executable, script, CHANGES, ready=True), connect, "dds", capsys)

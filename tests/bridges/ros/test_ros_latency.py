"""The latency of a robot behind rospy and rosbridge; see `latency.py`."""

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
    real: Any, connect: Callable[..., RosBridge], backend: str, capsys: pytest.CaptureFixture[str]
) -> None:
    script = str(Path(__file__).with_name("latency_node.py"))
    measure(real.start(sys.executable, script, CHANGES, ready=True), connect, backend, capsys)

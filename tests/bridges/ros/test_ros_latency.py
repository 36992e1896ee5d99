"""How long a robot waits for its program: from a published message to the command of the new state.

It is a benchmark, `pytest -m ros tests/bridges/ros/test_ros_latency.py`, which prints a row of the table in
the documentation for each back end and rate (`CHANGES=100` measures longer). Nothing is asserted about times
but that each change of the light is answered.
"""

from __future__ import annotations

import json
import os
import statistics
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.session import Session

pytestmark = pytest.mark.ros

CHANGES = int(os.environ.get("CHANGES", "10"))
NODE = Path(__file__).with_name("latency_node.py")
SETUP = Path(__file__).with_name("follower.json")
PROGRAM = """
(machine answer
  (event bright [robot.light.data > 128])
  (event dark [robot.light.data < 128])
  (state forward (running [robot.move(linear=0.1)]))
  (state backward (running [robot.move(linear=-0.1)]))
  (on dark forward -> backward)
  (on bright backward -> forward))
(spawn answer backward)
"""


@pytest.mark.parametrize("rate", [10, 50])
def test_every_change_of_the_light_is_answered(
    real: Any, connect: Callable[..., RosBridge], backend: str, rate: int, capsys: pytest.CaptureFixture[str]
) -> None:
    node = real.start(sys.executable, str(NODE), str(CHANGES), ready=True)
    with Session(PROGRAM, bridge=connect(setup=SETUP), rate=rate) as session:
        session.start()
        assert session.wait_for("backward", timeout=30)
        node.stdin.write("go\n")
        node.stdin.flush()
        line = node.stdout.readline()
    assert line, real.log(node)
    times = json.loads(line)
    assert len(times) == CHANGES
    tell(capsys, backend, rate, times)


def tell(capsys: pytest.CaptureFixture[str], backend: str, rate: int, times: list[float]) -> None:
    median, slow = statistics.median(times), statistics.quantiles(times, n=20)[-1]
    with capsys.disabled():
        sys.stdout.write(f"\n| {backend} | {rate} Hz | {median:.0f} | {slow:.0f} |\n")

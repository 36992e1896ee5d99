"""How long a robot waits for its program: from a published message to the command of the new state.

A benchmark of every back end: `pytest -m ros tests/bridges/ros -k latency` prints a row of the table in the
documentation, with the median and the 95th percentile in milliseconds; with `CHANGES=100`, which measures
longer, a row for each of two rates.
Nothing is asserted about times but that each change of the light is answered.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from bridges.ros.follower import SETUP

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.session import Session

CHANGES = os.environ.get("CHANGES", "2")
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


def measure(node: subprocess.Popen[str], connect: Callable[..., RosBridge], name: str, capsys: Any) -> None:
    """Run the program at two rates against a node that changes the light; print what it has measured."""
    assert node.stdin is not None
    assert node.stdout is not None
    for rate in (10, 50) if "CHANGES" in os.environ else (50,):  # Hz
        with Session(PROGRAM, bridge=connect(setup=SETUP), rate=rate) as session:
            session.start()
            assert session.wait_for("backward", timeout=120)
            node.stdin.write("go\n")
            node.stdin.flush()
            line = node.stdout.readline()
        assert line, "the node has ended"
        times: list[float] = json.loads(line)
        assert len(times) == int(CHANGES)
        median, slow = statistics.median(times), statistics.quantiles(times, n=20)[-1]
        with capsys.disabled():
            sys.stdout.write(f"\n| {name} | {rate} Hz | {median:.0f} | {slow:.0f} |\n")

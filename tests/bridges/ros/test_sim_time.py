"""The robot's time is that on `/clock`: a real master, a node that publishes it, and a bag that is played."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.session import Session

HERE = Path(__file__).parent
Connect = Callable[..., RosBridge]
AFTER_TWO = "(machine m (state early) (state late) (ontime 2000 early -> late)) (spawn m early)"


class World:
    """A world whose time a test sets, in seconds."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def show(self, seconds: float) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(f"{seconds!r}\n")
        self._process.stdin.flush()


@pytest.fixture
def world(real: Any) -> Iterator[World]:
    """A world with a time of its own, as ROS 1 says of it."""
    import rosgraph

    master = rosgraph.Master("/tests")
    master.setParam("/use_sim_time", True)
    yield World(real.start(sys.executable, str(HERE / "clock_node.py"), ready=True))
    master.deleteParam("/use_sim_time")


def ticks(session: Session, count: int) -> None:
    """Wait until a session has ticked so often."""
    until(lambda: session.frame.tick >= count)
    assert session.frame.tick == count


@pytest.mark.ros
class TestRos1:
    def test_ontime_lasts_for_seconds_of_the_robots_time(self, world: World, connect: Connect) -> None:
        ros = connect()
        with Session(AFTER_TWO, ros) as session:
            session.start()
            world.show(100.0)
            for step in range(20):
                ticks(session, step + 1)
                assert session.frame.is_active("early")
                world.show(100 + (step + 1) / 10)
            ticks(session, 21)
            assert session.frame.time == 2.0
            assert session.frame.is_active("late")

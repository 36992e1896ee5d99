"""Every message of a real ROS 1: at a high rate, and of topics that keep the last one."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session

pytestmark = pytest.mark.ros

Connect = Callable[..., RosBridge]
NODE = str(Path(__file__).parent / "counting_node.py")
COUNTED = 1000
QUEUE = """(var queue := [[]]) (var ages := [[]])
(machine m (state idle) (state end) (on [LAST in robot.count.new] idle -> end))
(machine keeper (state k (running [queue.extend(robot.count.new)] [ages.append(robot.count.age)])))
(spawn m idle)
(spawn keeper k)"""


def is_heard(real: Any, topic: str) -> bool:
    return bool(real.subscribers(topic))


def test_none_of_a_thousand_in_a_second_is_lost_and_the_run_is_repeated(
    real: Any, connect: Connect, tmp_path: Path
) -> None:
    node = real.start(sys.executable, NODE, "/count", str(COUNTED), "1000", ready=True)
    ros = connect()
    ros.subscribe("count", "/count", "std_msgs/UInt32")
    program, path = QUEUE.replace("LAST", str(COUNTED - 1)), tmp_path / "run.lrplog"
    with Session(program, bridge=ros, rate=20) as session:
        with session.record(path):
            session.start()
            until(lambda: session.frame.tick > 5 and is_heard(real, "/count"))
            assert session.variables["queue"] == []
            assert not session.issues  # before the first message there is nothing to say
            node.stdin.write("go\n")
            node.stdin.flush()
            until(lambda: session.frame.active[0] == ("m", "end"))
            session.pause()
        assert session.variables["queue"] == list(range(COUNTED))
        assert not [notice for notice in ros.safety.notices if notice.kind == "dropped"]
        assert session.variables["ages"][0] == float("inf")
        with session.fork(session.frame.tick) as fork:
            assert fork.variables["queue"] == session.variables["queue"]
    again = reproduce(read_recording(path))
    with again.session as session:
        assert again.difference is None
        assert session.variables["queue"] == list(range(COUNTED))


def test_every_variable_of_a_latched_topic_has_its_message(real: Any, connect: Connect) -> None:
    real.start(sys.executable, NODE, "/map", "42", "0", ready=True)
    ros = connect()
    for name in ("first", "second"):  # one after the other
        ros.subscribe(name, "/map")
        until(lambda name=name: ros.describe(name).age is not None)
        assert getattr(ros.robot, name).data == 42
    ros.remove("first")
    ros.subscribe("third", "/map")
    until(lambda: ros.describe("third").age is not None)
    assert ros.robot.third.data == 42

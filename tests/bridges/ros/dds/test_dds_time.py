"""The time on `/clock`, on ROS 2's wire."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import pytest
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.options import convert_options
from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.session import Session

pytest.importorskip("cyclonedds", reason="the extra `ros2` is missing")
pytest.importorskip("rosbags", reason="the extra `ros2` is missing")

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import int32, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from lrp_jupyter.bridges.ros.dds_node import DdsNode
from lrp_jupyter.bridges.ros.dds_types import MessageTypes
from lrp_jupyter.bridges.ros.names import GraphNames

RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(100))
TEXT = """(machine m
    (state early (running [robot.move(linear=0.2)])) (state late)
    (ontime 2000 early -> late))
  (spawn m early)"""


@dataclass
class WireTime(IdlStruct, typename="builtin_interfaces.msg.dds_.Time_"):
    sec: int32 = 0
    nanosec: uint32 = 0


@dataclass
class WireClock(IdlStruct, typename="rosgraph_msgs.msg.dds_.Clock_"):
    clock: WireTime


@pytest.fixture
def world(domain: int) -> Iterator[DomainParticipant]:
    """Another node of the domain."""
    node = DdsNode(domain, GraphNames("world"), "", MessageTypes(), lambda: None)
    yield node.participant
    node.close()


def test_a_program_goes_by_it_where_the_option_says_so(
    make: Callable[..., RosBridge], world: DomainParticipant
) -> None:
    setup = {"publishers": {"move": {"topic": "/cmd_vel", "type": "geometry_msgs/TwistStamped"}}}
    stamped = MessageTypes().struct("geometry_msgs/TwistStamped")
    writer = DataWriter(world, Topic(world, "rt/clock", WireClock), RELIABLE)
    reader = DataReader(world, Topic(world, "rt/cmd_vel", stamped), RELIABLE)
    ros = make(setup=setup, **convert_options(RosBridge, {"sim_time": "true"}))
    with Session(TEXT, ros) as session:
        session.open()
        ros.arm()
        until(lambda: ros.status.sentence.startswith("`sim_time` is set, and no time arrives on `/clock`"))
        assert ros.status.state is ConnectionState.WAITING
        session.start()
        until(lambda: writer.get_matched_subscriptions() and reader.get_matched_publications())
        for tenth in range(21):
            assert (session.frame.tick, session.frame.is_active("late")) == (tenth, False)
            writer.write(WireClock(WireTime(1_700_000_000 + tenth // 10, tenth % 10 * 100_000_000)))
            until(lambda tenth=tenth: session.frame.tick > tenth)
        assert (session.frame.tick, session.frame.time, session.frame.is_active("late")) == (21, 2.0, True)
        stamps = [each.header.stamp for each in until(lambda: reader.take(100)) if each.twist.linear.x == 0.2]
        shown = {(1_700_000_000 + tenth // 10, tenth % 10 * 100_000_000) for tenth in range(21)}
        assert stamps
        assert {(each.sec, each.nanosec) for each in stamps} <= shown

"""A velocity that no node hears is told, with the topic that may be meant."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge

Connect = Callable[..., RosBridge]
TWIST = "geometry_msgs/Twist"
NODE = """\
import rospy, sys
from geometry_msgs.msg import Twist
rospy.init_node(sys.argv[1], disable_rosout=True)
end = rospy.{}
print("ready", flush=True)
rospy.spin()
"""
BASE = NODE.format("Subscriber(sys.argv[2], Twist, lambda message: None)")
TELEOP = NODE.format("Publisher(sys.argv[2], Twist, queue_size=1)")


def shown(ros: RosBridge) -> str:
    """What the panel says of the only connection."""
    (row,) = ros.panel().tables[0].rows
    return row[-1]


def test_a_velocity_that_no_node_hears_is_told_where_it_is_chosen_and_before_arming(
    make: Callable[..., RosBridge], graph: Any
) -> None:
    graph.others.clear()
    ros = make(
        setup={"publishers": {"move": "/cmd_vel", "horn": {"topic": "/horn", "type": "std_msgs/Bool"}}}
    )
    ros.open()
    unheard = "o other node subscribes to `/cmd_vel`"
    until(lambda: f"n{unheard}." in ros.status.sentence)
    assert ros.status.state is ConnectionState.WAITING
    assert ros.failsafe.endswith(f" N{unheard}.")
    graph.types["/robot1/cmd_vel"] = TWIST
    graph.others |= {"/robot1/cmd_vel", "/horn"}
    until(lambda: f"n{unheard}. Did you mean `/robot1/cmd_vel`, to which `/robot` s" in ros.status.sentence)
    ros.publish("move", "/robot1/cmd_vel")
    until(lambda: ros.status.state is ConnectionState.CONNECTED)
    assert "subscribes" not in ros.failsafe
    graph.types["/volume"] = "std_msgs/Float64"
    graph.others |= {"/volume"}
    ros.publish("wheel", "/wheel", "std_msgs/Float64", velocity=True)
    until(lambda: "no other node subscribes to `/wheel`. Back end" in ros.status.sentence)


def test_without_rosapi_it_is_not_known_who_hears_a_velocity(
    make: Callable[..., RosBridge], serve: Callable[..., Any], graph: Any
) -> None:
    graph.others.clear()
    ros = make(port=serve(rosapi=False).port)
    ros.open()
    ros.publish("move", "/cmd_vel", TWIST)
    until(lambda: ros.status.state is ConnectionState.CONNECTED)
    assert "subscribes" not in ros.failsafe
    ros.subscribe("odom", "/odom")
    assert "does not tell which topics there are. Name the type of `/odom`." in ros.status.sentence


@pytest.mark.ros
def test_of_real_nodes_only_those_that_are_there_hear_and_command(
    real: Any, connect: Connect, backend: str
) -> None:
    base = real.start(sys.executable, "-c", BASE, "base", "/robot1/cmd_vel", ready=True)
    ros = connect()
    ros.publish("move", "/cmd_vel", TWIST)
    until(lambda: "Did you mean `/robot1/cmd_vel`, to which `/base` subscribes?" in shown(ros))
    ros.publish("move", "/robot1/cmd_vel", TWIST)
    until(lambda: "subscribes" not in shown(ros))
    if backend == "rosbridge":  # rosapi asks the master only
        return
    teleop = real.start(sys.executable, "-c", TELEOP, "teleop", "/robot1/cmd_vel", ready=True)
    until(lambda: "(also published by /teleop)" in shown(ros))
    os.killpg(teleop.pid, signal.SIGKILL)
    until(lambda: "also published" not in shown(ros))
    os.killpg(base.pid, signal.SIGKILL)
    until(lambda: "no other node subscribes to `/robot1/cmd_vel`" in shown(ros))
    assert real.subscribers("/robot1/cmd_vel") == ["/base"], "the master still lists it"

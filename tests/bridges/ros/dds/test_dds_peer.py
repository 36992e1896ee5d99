"""The bridge against a stranger on ROS 2's wire: Fast DDS, the middleware of most robots."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.errors import BridgeError, NoDataYet

pytestmark = pytest.mark.ros

Connect = Callable[..., RosBridge]
MOVE = {"publishers": {"move": {"topic": "/cmd_vel", "type": "geometry_msgs/Twist"}}}
TWIST = "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"
NODES = "reader ros_discovery_info reliable transient_local"


def reading(ros: RosBridge, name: str) -> Any:
    """What a program reads between two ticks; None when nothing can be had."""
    try:
        return getattr(ros.robot, name)
    except (NoDataYet, BridgeError):
        return None


def announced(robot: Any, name: str = r"lrp_\d") -> dict[str, Any]:
    """What the bridge announced last of its node."""
    nodes = [node for line in robot.got("ros_discovery_info") for node in line["nodes"]]
    return next((node for node in reversed(nodes) if re.match(name, node["name"])), {})


def test_both_sides_understand_each_other(peer: Any, connect: Connect) -> None:
    robot = peer("writer odom reliable volatile", "writer echo reliable", "reader cmd_vel reliable", NODES)
    robot.do("reader stamped reliable")
    ros = connect(setup=MOVE, namespace="robot1")
    ros.robot.move(linear=0.1, angular=-1 / 3)  # the first command after opening arrives
    (command,) = until(lambda: robot.got("rt/cmd_vel"))
    assert (command["linear"], command["angular"]) == ([0.1, 0, 0], [0, 0, -1 / 3])

    ros.subscribe("echo", "/echo")
    ros.subscribe("odom", "/odom")
    until(lambda: robot.do("odom 1.5 -0.25") or reading(ros, "odom"))
    odom = ros.robot.odom
    assert (odom.x, odom.y, odom.theta) == (1.5, -0.25, 0.0)
    stamp = odom.header.stamp
    assert (odom.header.frame_id, stamp.sec, stamp.nanosec) == ("odom", 1700000000, 250000000)
    assert odom.pose.covariance[35] == 0.5
    until(lambda: ros.robot.move(linear=0.1, angular=-1 / 3) or reading(ros, "echo"))
    assert (ros.robot.echo.linear.x, ros.robot.echo.angular.z) == (0.1, -1 / 3)
    with pytest.raises(BridgeError, match=r"`/odom` carries `nav_msgs/Odometry`, not `std_msgs/UInt8`"):
        ros.subscribe("wrong", "/odom", "std_msgs/UInt8")

    # a header without a stamp gets the time now
    ros.publish("stamped", "/stamped")
    before = time.time()
    ros.robot.stamped(lambda msg: (msg.header(frame_id="base"), msg.twist.linear(x=0.5)))
    got = until(lambda: robot.got("rt/stamped"))[0]
    assert (got["frame"], got["linear"][0]) == ("base", 0.5)
    assert before <= got["sec"] + got["nanosec"] * 1e-9 <= time.time()

    # a best-effort sensor arrives whoever comes first, and a large scan arrives whole
    ros.subscribe("scan", "/scan", "sensor_msgs/LaserScan")
    robot.do("writer scan best_effort volatile")
    until(lambda: robot.do("scan 3") or reading(ros, "scan"))
    assert ros.robot.scan.ranges == (0.0, 0.25, 0.5)
    ros.remove("scan")
    ros.subscribe("scan", "/scan")
    until(lambda: robot.do("scan 2") or reading(ros, "scan"))
    assert ros.robot.scan.ranges == (0.0, 0.25)
    robot.do("drop scan", "writer scan reliable")
    until(lambda: robot.do("scan 100000") or len(ros.robot.scan.ranges) == 100000)
    assert ros.robot.scan.ranges[-1] == 24999.75

    # a subscription becomes reliable when a reliable publisher comes; what that kept reaches who comes later
    def asked() -> list[bool]:
        return [end["reliable"] for end in robot.said("their_reader") if end["their_reader"] == "rt/light"]

    ros.subscribe("light", "/light", "std_msgs/UInt8")
    until(lambda: asked() == [False])
    robot.do("writer light reliable transient_local", "light 77")
    until(lambda: asked() == [False, True])
    until(lambda: reading(ros, "light"))
    ros.remove("light")
    ros.subscribe("light", "/light")
    assert until(lambda: reading(ros, "light")).data == 77
    there = {"/odom": "nav_msgs/Odometry", "/scan": "sensor_msgs/LaserScan", "/light": "std_msgs/UInt8"}
    there |= {"/stamped": "geometry_msgs/TwistStamped"}
    assert dict(ros.topics) == there | dict.fromkeys(["/cmd_vel", "/echo"], "geometry_msgs/Twist")

    # it announces itself as a node of ROS 2
    def ends(what: str, topic: str, side: str) -> list[dict[str, Any]]:
        ours = [end for end in robot.said(what) if end["gid"] in announced(robot).get(side, [])]
        return [end for end in ours if end[what] == topic]

    (writer,) = until(lambda: ends("their_writer", "rt/cmd_vel", "writers"))
    (reader,) = until(lambda: ends("their_reader", "rt/odom", "readers"))
    assert (writer["type"], writer["user_data"]) == ("geometry_msgs::msg::dds_::Twist_", f"typehash={TWIST};")
    assert (writer["reliable"], writer["kept"]) == (True, False)
    assert announced(robot)["namespace"] == "/robot1"
    assert {one["user_data"] for one in robot.said("participant")} == {"enclave=/;"}
    ros.remove("odom")
    until(lambda: reader["gid"] not in announced(robot)["readers"])

    # another node that commands is named
    ros.publish("say", "/echo", "geometry_msgs/Twist")
    robot.do("announce teleop")
    until(lambda: any("`/teleop` publishes on `/echo`, too" in notice.text for notice in ros.safety.notices))


def test_every_message_of_a_topic_arrives_once_if_the_program_takes_them(peer: Any, connect: Connect) -> None:
    robot = peer("writer light reliable transient_local", "light 77")
    ros = connect()
    for name in ("light", "glow"):  # what it keeps reaches each of them
        ros.subscribe(name, "/light")
        assert until(lambda name=name: reading(ros, name)).data == 77

    def tick() -> Any:
        ros.begin_tick(0.0, 0.1)
        found = getattr(ros.robot, "light.new")
        ros.end_tick(0.0)
        return found

    def readers() -> int:
        return len([end for end in robot.said("their_reader") if end["their_reader"] == "rt/light"])

    tick()
    before = readers()
    ros.take_messages(["light.new"])
    until(lambda: readers() > before)  # it subscribes again, with room for all of them
    robot.do(*(f"light {number % 7}" for number in range(200)))
    until(lambda: len(getattr(ros.robot, "light.new")) == 200)
    assert tick() == tuple(number % 7 for number in range(200))
    assert (tick(), ros.robot.glow.data) == ((), 199 % 7)


def test_a_subscriber_that_asks_for_too_much_is_named_until_it_is_gone(peer: Any, connect: Connect) -> None:
    robot = peer("reader cmd_vel reliable transient_local")
    ros = connect(setup=MOVE)
    until(lambda: "`/cmd_vel` asks for another quality of service" in ros.status.sentence)
    assert ros.status.state is ConnectionState.WAITING
    for asks, policy in (
        ("reliable transient_local", "durability"),
        ("reliable deadline", "deadline"),
        ("exclusive", "ownership"),
    ):
        robot.do("drop cmd_vel", f"reader cmd_vel {asks}")
        until(lambda policy=policy: f"({policy})" in ros.status.sentence)
        ros.robot.move(linear=0.2)
    robot.do("drop cmd_vel", "reader cmd_vel reliable volatile")
    until(lambda: ros.status.state is ConnectionState.CONNECTED)
    until(lambda: ros.robot.move(linear=0.3) or robot.speeds())  # it is known a moment before it is connected
    assert 0.2 not in robot.speeds()


@pytest.mark.usefixtures("guarded")
def test_the_guard_of_a_robot_is_not_reported_as_another_who_commands(
    peer: Any, connect: Connect, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = peer("reader cmd_vel reliable", NODES)
    ros = connect(setup=MOVE)
    until(lambda: all(announced(robot, name).get("writers") for name in (r"lrp_\d", "lrp_guard")))
    assert ros.wiring.link is not None
    transport, found = ros.wiring.link.transport, []
    look = transport.commanders
    monkeypatch.setattr(transport, "commanders", lambda topic: found.append(look(topic)) or found[-1])
    until(
        lambda: sum("/lrp_guard_" in " ".join(names) for names in found) > 1
    )  # so what was made of the first one is done
    assert not [notice.text for notice in ros.safety.notices if "too: the robot obeys" in notice.text]


def test_a_robot_that_goes_is_named_and_gets_no_old_command_when_it_is_back(
    peer: Any, connect: Connect
) -> None:
    ends = ("writer odom reliable", "reader cmd_vel reliable")
    robot = peer(*ends, lease=4)
    ros = connect(setup=MOVE)
    ros.subscribe("odom", "/odom")
    until(lambda: robot.do("odom 1 2") or reading(ros, "odom"))
    ros.robot.move(linear=0.2)
    until(lambda: robot.speeds() == [0.2])
    robot.do("drop cmd_vel")  # a part of it
    until(lambda: "no other node subscribes to `/cmd_vel` any more" in ros.status.sentence)
    ros.stop_all()
    robot.do("reader cmd_vel reliable")
    until(lambda: robot.speeds() == [0.2, 0.0])  # the stop that was not received
    ros.robot.move(linear=0.2)
    until(lambda: robot.speeds() == [0.2, 0.0, 0.2])
    robot.kill()
    until(lambda: ros.status.state is ConnectionState.LOST)
    assert "no other node in ROS 2's domain" in ros.status.sentence
    assert "`/cmd_vel`, `/odom`" in ros.status.sentence
    for _ in range(5):
        with pytest.raises(BridgeError, match=r"`robot\.move` was not sent: The robot is gone"):
            ros.robot.move(linear=0.9)
    with pytest.raises(BridgeError, match="The robot is gone"):
        _ = ros.robot.odom
    robot = peer(*ends)
    until(lambda: robot.do("odom 3 4") or reading(ros, "odom"))
    assert ros.robot.odom.x == 3
    until(lambda: robot.speeds() == [0.0])  # it may have driven on all the time
    ros.robot.move(linear=0.3)
    until(lambda: robot.speeds() == [0.0, 0.3])
    until(lambda: robot.do("odom 3 4") or ros.status.state is ConnectionState.CONNECTED)


def test_a_network_of_humble_is_told_of_the_node_in_its_own_layout(peer: Any, connect: Connect) -> None:
    robot = peer(typed=False)
    connect()

    def told() -> list[str]:
        ends = robot.said("their_writer")
        return [end["user_data"] for end in ends if end["their_writer"] == "ros_discovery_info"]

    until(lambda: told() == ["", ""])

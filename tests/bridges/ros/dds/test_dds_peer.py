"""The bridge against a stranger on ROS 2's wire: Fast DDS, the middleware of most robots."""

from __future__ import annotations

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
TWIST = "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"


def reading(ros: RosBridge, name: str) -> Any:
    """What a program reads between two ticks; None when nothing can be had."""
    try:
        return getattr(ros.robot, name)
    except (NoDataYet, BridgeError):
        return None


def test_topics_are_found_with_their_types(peer: Any, connect: Connect) -> None:
    peer("writer odom reliable", "writer scan best_effort", "reader cmd_vel reliable")
    ros = connect()
    there = {
        "/odom": "nav_msgs/Odometry",
        "/scan": "sensor_msgs/LaserScan",
        "/cmd_vel": "geometry_msgs/Twist",
    }
    until(lambda: dict(ros.topics) == there)


def test_values_are_the_same_in_both_directions(peer: Any, connect: Connect) -> None:
    robot = peer("writer odom reliable volatile", "reader cmd_vel reliable", "writer echo reliable")
    ros = connect()
    ros.subscribe("odom", "/odom")
    ros.subscribe("echo", "/echo")
    ros.publish("move", "/cmd_vel")
    until(lambda: robot.do("odom 1.5 -0.25") or reading(ros, "odom"))
    odom = ros.robot.odom
    assert (odom.x, odom.y, odom.theta) == (1.5, -0.25, 0.0)
    assert (odom.header.frame_id, odom.header.stamp.sec, odom.header.stamp.nanosec) == (
        "odom",
        1700000000,
        250000000,
    )
    assert odom.pose.covariance[35] == 0.5
    ros.robot.move(linear=0.1, angular=-1 / 3)
    until(lambda: reading(ros, "echo"))
    (command,) = robot.got("rt/cmd_vel")
    assert (command["linear"], command["angular"]) == ([0.1, 0, 0], [0, 0, -1 / 3])
    assert (ros.robot.echo.linear.x, ros.robot.echo.angular.z) == (0.1, -1 / 3)


def test_the_first_command_after_opening_arrives(peer: Any, connect: Connect) -> None:
    robot = peer("reader cmd_vel reliable")
    ros = connect(setup={"publishers": {"move": {"topic": "/cmd_vel", "type": "geometry_msgs/Twist"}}})
    ros.robot.move(linear=0.2)
    until(lambda: robot.speeds() == [0.2])


def test_a_header_without_a_stamp_gets_the_time_now(peer: Any, connect: Connect) -> None:
    robot = peer("reader stamped reliable")
    ros = connect()
    ros.publish("move", "/stamped")
    before = time.time()
    ros.robot.move(lambda msg: (msg.header(frame_id="base"), msg.twist.linear(x=0.5)))
    until(lambda: robot.got("rt/stamped"))
    got = robot.got("rt/stamped")[0]
    assert (got["frame"], got["linear"][0]) == ("base", 0.5)
    assert before <= got["sec"] + got["nanosec"] * 1e-9 <= time.time()


def test_a_best_effort_sensor_arrives_whoever_comes_first(peer: Any, connect: Connect) -> None:
    robot = peer("writer light reliable")
    ros = connect()
    ros.subscribe("scan", "/scan", "sensor_msgs/LaserScan")
    robot.do("writer scan best_effort volatile")
    until(lambda: robot.do("scan 3") or reading(ros, "scan"))
    assert ros.robot.scan.ranges == (0.0, 0.25, 0.5)
    ros.remove("scan")
    ros.subscribe("again", "/scan")
    until(lambda: robot.do("scan 2") or reading(ros, "again"))
    assert ros.robot.again.ranges == (0.0, 0.25)


def test_a_large_scan_arrives_whole(peer: Any, connect: Connect) -> None:
    robot = peer("writer scan reliable")
    ros = connect()
    ros.subscribe("scan", "/scan")
    until(lambda: robot.do("scan 100000") or reading(ros, "scan"))
    ranges = ros.robot.scan.ranges
    assert len(ranges) == 100000
    assert ranges[-1] == 24999.75


def test_a_latched_message_reaches_who_comes_later(peer: Any, connect: Connect) -> None:
    peer("writer light reliable transient_local", "light 77")
    ros = connect()
    ros.subscribe("light", "/light")
    until(lambda: reading(ros, "light"))
    assert ros.robot.light.data == 77


def test_a_subscription_becomes_reliable_when_a_reliable_publisher_comes(peer: Any, connect: Connect) -> None:
    robot = peer("writer odom reliable")
    ros = connect()
    ros.subscribe("light", "/light", "std_msgs/UInt8")

    def asked() -> list[bool]:
        return [end["reliable"] for end in robot.said("their_reader") if end["their_reader"] == "rt/light"]

    until(lambda: asked() == [False])
    robot.do("writer light reliable transient_local", "light 5")
    until(lambda: asked() == [False, True])
    until(lambda: reading(ros, "light"))


def test_a_subscriber_that_asks_for_too_much_is_named_until_it_is_gone(peer: Any, connect: Connect) -> None:
    robot = peer("reader cmd_vel reliable transient_local")
    ros = connect()
    ros.publish("move", "/cmd_vel")
    until(lambda: "`/cmd_vel` asks for another quality of service" in ros.status.sentence)
    assert "(durability)" in ros.status.sentence
    assert ros.status.state is ConnectionState.WAITING
    robot.do("drop cmd_vel", "reader cmd_vel reliable volatile")
    until(lambda: ros.status.state is ConnectionState.CONNECTED)
    until(lambda: ros.robot.move(linear=0.3) or robot.speeds())  # it is known a moment before it is connected
    assert set(robot.speeds()) == {0.3}


@pytest.mark.parametrize(("asks", "policy"), [("reliable deadline", "deadline"), ("exclusive", "ownership")])
def test_the_policy_is_named(peer: Any, connect: Connect, asks: str, policy: str) -> None:
    robot = peer(f"reader cmd_vel {asks}")
    ros = connect()
    ros.publish("move", "/cmd_vel")
    until(lambda: f"({policy})" in ros.status.sentence)
    ros.robot.move(linear=0.3)
    robot.do("announce robot")
    assert robot.speeds() == []


def test_another_type_than_that_of_the_live_topic_is_refused(peer: Any, connect: Connect) -> None:
    peer("writer odom reliable")
    ros = connect()
    with pytest.raises(BridgeError, match=r"`/odom` carries `nav_msgs/Odometry`, not `std_msgs/UInt8`"):
        ros.subscribe("odom", "/odom", "std_msgs/UInt8")


def test_it_announces_itself_as_a_node_of_ros_2(peer: Any, connect: Connect) -> None:
    robot = peer(
        "writer odom reliable",
        "reader cmd_vel reliable",
        "reader ros_discovery_info reliable transient_local",
    )
    ros = connect()
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel")

    def announced() -> dict[str, Any]:
        nodes = [node for line in robot.got("ros_discovery_info") for node in line["nodes"]]
        return next((node for node in reversed(nodes) if node["name"] == "lrp"), {})

    def ends(what: str, side: str) -> list[dict[str, Any]]:
        return [end for end in robot.said(what) if end["gid"] in announced().get(side, [])]

    until(lambda: ends("their_writer", "writers") and ends("their_reader", "readers"))
    (writer,), (reader,) = ends("their_writer", "writers"), ends("their_reader", "readers")
    assert (writer["their_writer"], writer["type"]) == ("rt/cmd_vel", "geometry_msgs::msg::dds_::Twist_")
    assert writer["user_data"] == f"typehash={TWIST};"
    assert (writer["reliable"], writer["kept"]) == (True, False)
    assert reader["their_reader"] == "rt/odom"
    assert announced()["namespace"] == "/"
    assert {one["user_data"] for one in robot.said("participant")} == {"enclave=/;"}
    ros.remove("odom")
    until(lambda: announced()["readers"] == [])


def test_other_nodes_that_command_are_named(peer: Any, connect: Connect) -> None:
    robot = peer("writer echo reliable")
    ros = connect()
    ros.publish("move", "/echo", "geometry_msgs/Twist")
    robot.do("announce teleop")
    until(lambda: any("`/teleop` publishes on `/echo`, too" in notice.text for notice in ros.safety.notices))


@pytest.mark.usefixtures("guarded")
def test_the_guard_of_a_robot_is_not_reported_as_another_who_commands(
    peer: Any, connect: Connect, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = peer("reader cmd_vel reliable", "reader ros_discovery_info reliable transient_local")
    ros = connect()
    ros.publish("move", "/cmd_vel")

    def writers() -> list[str]:
        nodes = [node for line in robot.got("ros_discovery_info") for node in line["nodes"]]
        return [node["name"] for node in nodes if node["writers"]]

    until(lambda: {"lrp", "lrp_guard"} <= set(writers()))
    assert ros.wiring.link is not None
    transport, found = ros.wiring.link.transport, []
    look = transport.commanders
    monkeypatch.setattr(transport, "commanders", lambda topic: found.append(look(topic)) or found[-1])
    until(lambda: found.count(("/lrp_guard",)) > 1)  # so what was made of the first one is done
    assert not [notice.text for notice in ros.safety.notices if "too: the robot obeys" in notice.text]


def test_a_robot_that_dies_is_lost_and_gets_no_old_command_when_it_is_back(
    peer: Any, connect: Connect
) -> None:
    robot = peer("writer odom reliable", "reader cmd_vel reliable", lease=4)
    ros = connect()
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel")
    until(lambda: robot.do("odom 1 2") or reading(ros, "odom"))
    ros.robot.move(linear=0.2)
    until(lambda: robot.speeds() == [0.2])
    robot.kill()
    until(lambda: ros.status.state is ConnectionState.LOST)
    assert "no other node in ROS 2's domain" in ros.status.sentence
    assert "`/cmd_vel`, `/odom`" in ros.status.sentence
    for _ in range(5):
        with pytest.raises(BridgeError, match=r"`robot\.move` was not sent: The robot is gone"):
            ros.robot.move(linear=0.9)
    with pytest.raises(BridgeError, match="The robot is gone"):
        _ = ros.robot.odom
    robot = peer("writer odom reliable", "reader cmd_vel reliable")
    until(lambda: robot.do("odom 3 4") or reading(ros, "odom"))
    assert ros.robot.odom.x == 3
    until(lambda: robot.speeds() == [0.0])  # it may have driven on all the time
    ros.robot.move(linear=0.3)
    until(lambda: robot.speeds() == [0.0, 0.3])
    until(lambda: ros.status.state is ConnectionState.CONNECTED)


def test_a_part_of_the_robot_that_goes_is_named(peer: Any, connect: Connect) -> None:
    robot = peer("writer odom reliable", "reader cmd_vel reliable")
    ros = connect()
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel")
    ros.robot.move(linear=0.2)
    until(lambda: robot.speeds() == [0.2])
    until(lambda: robot.do("odom 1 2") or ros.status.state is ConnectionState.CONNECTED)
    robot.do("drop cmd_vel")
    until(lambda: "no other node subscribes to `/cmd_vel` any more" in ros.status.sentence)
    ros.stop_all()
    robot.do("reader cmd_vel reliable")
    until(lambda: robot.speeds() == [0.2, 0.0])  # the stop that nobody heard


def test_a_network_of_humble_is_told_of_the_node_in_its_own_layout(peer: Any, connect: Connect) -> None:
    robot = peer(typed=False)
    connect()
    until(
        lambda: (
            [
                end["user_data"]
                for end in robot.said("their_writer")
                if end["their_writer"] == "ros_discovery_info"
            ]
            == ["", ""]
        )
    )

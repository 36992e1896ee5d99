"""The rclpy back end, with a stand-in for rclpy: the calls it makes, and what it makes of answers."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from bridges.ros import rclpy_stand_in as stand_in
from bridges.ros.test_seen_from_outside import PROGRAM, SETUP
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.bridges.ros.rclpy import RclpyTransport
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.session import Session


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(RclpyTransport, "period", 0.05)
    graph = stand_in.install(monkeypatch)
    graph.other_publishes("/odom", "nav_msgs/Odometry")
    return graph


@pytest.fixture
def ros(graph: Any) -> Iterator[RosBridge]:
    bridge = RosBridge(backend="rclpy")
    bridge.open()
    bridge.arm()
    yield bridge
    bridge.close()
    assert graph.alive == []
    assert [
        end for end in (*graph.publishers, *graph.subscriptions) if end.node_name.startswith("lrp_")
    ] == []


def test_topics_of_other_nodes_are_listed_with_their_types(ros: RosBridge) -> None:
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    assert dict(ros.topics) == {"/odom": "nav_msgs/Odometry"}


def test_a_message_arrives_with_its_arrays(ros: RosBridge, graph: Any) -> None:
    ros.subscribe("odom", "/odom")
    message = stand_in.message_class("nav_msgs/Odometry")()
    message.pose.pose.position.x = 1.5
    message.pose.covariance[7] = 0.25
    graph.deliver("/odom", message)
    until(lambda: ros.status.state is ConnectionState.CONNECTED)
    assert ros.robot.odom.x == 1.5
    assert ros.robot.odom.pose.covariance[7] == 0.25


@pytest.mark.parametrize("kind", ["BEST_EFFORT", "RELIABLE"])
def test_a_subscription_asks_for_what_is_offered(ros: RosBridge, graph: Any, kind: str) -> None:
    offered = stand_in.ReliabilityPolicy[kind]
    kept = stand_in.DurabilityPolicy.TRANSIENT_LOCAL
    graph.other_publishes("/scan", "sensor_msgs/LaserScan", reliability=offered, durability=kept)
    ros.subscribe("scan", "/scan", "sensor_msgs/LaserScan")
    (made,) = [end for end in graph.subscriptions if end.topic_name == "/scan"]
    assert made.qos_profile.reliability is offered
    assert made.qos_profile.durability is kept


def test_a_subscription_that_comes_first_asks_for_the_least_and_then_for_what_is_offered(
    ros: RosBridge, graph: Any
) -> None:
    def asked() -> list[tuple[str, str]]:
        found = [end.qos_profile for end in graph.subscriptions if end.topic_name == "/map"]
        return [(each.reliability.name, each.durability.name) for each in found]

    ros.subscribe("map", "/map", "std_msgs/String")  # of a node that starts later, or is not known yet
    assert asked() == [("BEST_EFFORT", "VOLATILE")]
    kept = stand_in.DurabilityPolicy.TRANSIENT_LOCAL
    graph.other_publishes("/map", "std_msgs/String", durability=kept)
    until(lambda: asked() == [("RELIABLE", "TRANSIENT_LOCAL")])
    message = stand_in.message_class("std_msgs/String")()
    message.data = "a maze"
    graph.deliver("/map", message)
    until(lambda: ros.describe("map").age is not None)
    assert ros.robot.map.data == "a maze"


def test_every_message_counts_if_the_program_takes_them_and_what_a_topic_keeps_counts_once(
    ros: RosBridge, graph: Any
) -> None:
    kept = stand_in.DurabilityPolicy.TRANSIENT_LOCAL
    graph.other_publishes("/map", "std_msgs/String", durability=kept)
    ros.subscribe("map", "/map", "std_msgs/String")

    def deliver(*texts: str) -> None:
        for text in texts:
            message = stand_in.message_class("std_msgs/String")()
            message.data = text
            graph.deliver("/map", message)

    def asked() -> list[int]:
        return [end.qos_profile.depth for end in graph.subscriptions if end.topic_name == "/map"]

    def tick() -> object:
        ros.begin_tick(0.0, 0.1)
        found = getattr(ros.robot, "map.new")
        ros.end_tick(0.0)
        return found

    deliver("a maze")
    until(lambda: ros.describe("map").age is not None)
    assert asked() == [1]
    ros.begin_tick(0.0, 0.1)
    ros.end_tick(0.0)
    ros.take_messages(["map.new"])
    until(lambda: asked() == [1000])
    deliver("a maze", "b", "c", "c")  # the first one, to the new subscription
    until(lambda: ros.robot.map.data == "c")
    until(lambda: len(getattr(ros.robot, "map.new")) == 3)
    assert tick() == ("b", "c", "c")
    assert tick() == ()
    ros.take_messages([])
    until(lambda: asked() == [1])


def _fail(_message: Any) -> None:
    raise RuntimeError("the middleware is gone")


@pytest.mark.parametrize(
    ("end", "why"),
    [((_fail, None), "RuntimeError: the middleware is gone"), (None, "ExternalShutdownException")],
)
def test_an_executor_that_ends_is_a_lost_robot_until_there_is_another_one(
    ros: RosBridge, graph: Any, end: Any, why: str
) -> None:
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    until(lambda: "no other node subscribes to `/cmd_vel`" in ros.status.sentence)
    graph.other_subscribes("/cmd_vel", "geometry_msgs/Twist")
    ros.robot.move(linear=0.2)
    graph.arrivals.put(end)
    until(lambda: any(f"The ROS 2 node failed: {why}" in each.text for each in ros.safety.notices))
    until(lambda: ros.status.state is not ConnectionState.LOST)
    assert [sent.linear.x for _topic, sent in graph.published][-1] == 0.0
    graph.deliver("/odom", stand_in.message_class("nav_msgs/Odometry")())
    until(lambda: ros.status.state is ConnectionState.CONNECTED)
    ros.robot.move(linear=0.1)


def test_a_command_is_published_reliably(ros: RosBridge, graph: Any) -> None:
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    ros.robot.move(linear=0.2, angular=-1)
    ((topic, sent),) = graph.published
    assert topic == "/cmd_vel"
    assert (sent.linear.x, sent.angular.z) == (0.2, -1.0)
    (made,) = [end for end in graph.publishers if end.topic_name == "/cmd_vel"]
    assert made.qos_profile.reliability is stand_in.ReliabilityPolicy.RELIABLE
    assert made.qos_profile.durability is stand_in.DurabilityPolicy.VOLATILE


def test_a_stamped_command_has_the_time_of_the_node(ros: RosBridge, graph: Any) -> None:
    ros.publish("move", "/cmd_vel", "geometry_msgs/TwistStamped")
    ros.robot.move(linear=0.2)
    ((_topic, sent),) = graph.published
    assert (sent.header.stamp.sec, sent.header.stamp.nanosec) == (77, 5)
    assert sent.twist.linear.x == 0.2


def test_in_a_simulation_it_has_the_time_of_that(graph: Any) -> None:
    ros = RosBridge(backend="rclpy", sim_time=True)
    ros.open()
    ros.arm()
    ros.publish("move", "/cmd_vel", "geometry_msgs/TwistStamped")
    message = stand_in.message_class("rosgraph_msgs/Clock")()
    message.clock.sec, message.clock.nanosec = 7, 500_000_000
    graph.deliver("/clock", message)
    until(lambda: ros.world_time() == 7.5)
    ros.robot.move(linear=0.2)
    stamps = [(sent.header.stamp.sec, sent.header.stamp.nanosec) for _topic, sent in graph.published]
    ros.close()
    assert stamps[0] == (7, 500_000_000)


def test_a_topic_of_another_type_is_refused(ros: RosBridge) -> None:
    with pytest.raises(BridgeError, match="carries `nav_msgs/Odometry`, not `std_msgs/UInt8`"):
        ros.subscribe("odom", "/odom", "std_msgs/UInt8")


def test_a_type_that_is_not_installed_is_told(ros: RosBridge) -> None:
    with pytest.raises(BridgeError, match="`lift_msgs/Lift` is not installed here"):
        ros.subscribe("lift", "/lift", "lift_msgs/Lift")


def test_a_message_that_rclpy_refuses_is_told(ros: RosBridge, graph: Any) -> None:
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    graph.refuses = "too fast"
    with pytest.raises(BridgeError, match="`/cmd_vel` refuses the message: too fast"):
        ros.robot.move(linear=0.2)
    graph.refuses = ""


# -- actions and services -------------------------------------------------------------------------


@pytest.fixture
def asked(ros: RosBridge, graph: Any) -> RosBridge:
    """The same, with an action and a service."""
    graph.actions["/Navigate"] = stand_in.NAVIGATE

    def switch(request: Any) -> Any:
        if not request.on:
            raise RuntimeError("it is stuck")
        return stand_in.message_class("lamps/Switch_Response")(said="on")

    graph.services["/lamp"] = ("lamps/Switch", switch)
    until(lambda: "/lamp" in ros.live.get("service", {}))
    ros.action("drive_to", "/Navigate")
    ros.service("lamp", "/lamp")
    return ros


def latched(ros: RosBridge, name: str = "drive_to") -> tuple[str | None, str]:
    """What a tick sees."""
    ros.begin_tick(0.0, 0.1)
    ros.end_tick(0.0)
    task = getattr(ros.robot, name)
    return task.status, task.reason


def drive(ros: RosBridge, graph: Any, x: float) -> Any:
    """Ask for a goal; return it, when it has come."""
    latched(ros)  # a tick in which it was stopped is over
    before = len(graph.goals)
    ros.robot.drive_to(pose_pose_position_x=x)
    until(lambda: len(graph.goals) > before)
    return graph.goals[before]


def test_a_goal_is_pursued_replaced_reached_and_cancelled(asked: RosBridge, graph: Any) -> None:
    assert asked.panel().tables[2].rows == (
        ("/Navigate", "action", stand_in.NAVIGATE),
        ("/lamp", "service", "lamps/Switch"),
    )
    first = drive(asked, graph, 1.0)
    assert first.message.pose.pose.position.x == 1.0
    first.report(0.5)
    until(lambda: latched(asked) and asked.robot.drive_to.feedback)
    assert asked.robot.drive_to.feedback.left == 0.5
    second = drive(asked, graph, 2.0)
    until(lambda: first.cancels)
    assert not second.cancels
    second.end(4, taken=3.5)
    until(lambda: latched(asked) == ("succeeded", ""))
    assert asked.robot.drive_to.result.taken == 3.5
    third = drive(asked, graph, 3.0)
    third.report(0.25)
    until(lambda: latched(asked) and asked.robot.drive_to.feedback)
    asked.stop_all()
    assert third.cancels


@pytest.mark.parametrize(("number", "status"), [(5, "cancelled"), (6, "aborted")])
def test_each_end_of_a_goal_has_its_own_status(
    asked: RosBridge, graph: Any, number: int, status: str
) -> None:
    drive(asked, graph, 1.0).end(number)
    until(lambda: latched(asked)[0] == status)


def test_a_goal_that_is_rejected_or_has_no_server_says_so(asked: RosBridge, graph: Any) -> None:
    graph.accepts = False
    drive(asked, graph, 1.0)
    until(lambda: latched(asked)[0] == "rejected")
    graph.accepts = True
    goal = drive(asked, graph, 2.0)
    types = graph.actions.pop("/Navigate")
    until(lambda: latched(asked) == ("lost", "No node offers the action `/Navigate`."))
    asked.robot.drive_to(pose_pose_position_x=3.0)
    until(lambda: latched(asked)[0] == "lost")
    assert len(graph.goals) == 2
    assert not goal.cancels
    graph.actions["/Navigate"] = types  # it was cut off, and goes on
    until(lambda: goal.cancels)


def test_a_goal_that_is_not_wanted_any_more_is_cancelled_as_soon_as_it_is_accepted(
    asked: RosBridge, graph: Any
) -> None:
    accepts = threading.Event()
    graph.arrivals.put((lambda _: accepts.wait(60), None))  # the answer of the server is under way
    goal = drive(asked, graph, 1.0)
    asked.stop_all()
    assert not goal.cancels
    accepts.set()
    until(lambda: goal.cancels)


def test_a_service_answers_fails_or_is_not_there(asked: RosBridge, graph: Any) -> None:
    asked.robot.lamp(on=True)
    until(lambda: latched(asked, "lamp")[0] == "succeeded")
    assert asked.robot.lamp.result.said == "on"
    asked.robot.lamp(on=False)
    until(lambda: latched(asked, "lamp")[0] == "aborted")
    assert "it is stuck" in asked.robot.lamp.reason
    del graph.services["/lamp"]
    asked.robot.lamp(on=True)
    until(lambda: latched(asked, "lamp")[0] == "lost")


def test_what_happens_in_a_run_is_published_and_kept_for_who_comes_later(graph: Any) -> None:
    bridge = RosBridge(backend="rclpy", setup=SETUP, state_topic="/lrp/state", node="me")
    with Session(PROGRAM, bridge, name="light") as session:
        session.start()
        until(lambda: any(topic == "/lrp/state" for topic, _ in tuple(graph.published)))
        kept = {end.topic_name: end.qos_profile for end in graph.publishers if end.node_name == "me"}
        assert {profile.durability for profile in kept.values()} == {
            stand_in.DurabilityPolicy.TRANSIENT_LOCAL
        }
        assert kept["/rosout"].depth == 1000
        light = stand_in.message_class("std_msgs/UInt8")(data=42)
        until(lambda: graph.deliver("/light", light) or session.frame.is_active("dark"))
        until(lambda: any(getattr(message, "line", 0) for _, message in tuple(graph.published)))
    texts = [message.data for topic, message in graph.published if topic == "/lrp/state"]
    assert [json.loads(text)["status"] for text in (texts[0], texts[-1])] == ["running", "closed"]
    log = [message for topic, message in graph.published if topic == "/rosout"]
    assert (40, 3, "me") in [(each.level, each.line, each.name) for each in log]
    assert log[-1].msg == "`light` has ended."
    assert abs(log[-1].stamp.sec - json.loads(texts[-1])["stamp"]) <= 1

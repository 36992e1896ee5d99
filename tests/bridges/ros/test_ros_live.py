"""The bridge against a real ROS 1: its master, its command line tools, its C++ relay."""

from __future__ import annotations

import logging
import os
import signal
import threading
import time
from collections.abc import Callable
from itertools import count
from typing import Any

import pytest
from bridges.bounded import bounded
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.errors import BridgeError, NoDataYet
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.saver import Saver
from lrp_jupyter.widgets.texts import Texts

pytestmark = pytest.mark.ros

Connect = Callable[..., RosBridge]


def reading(ros: RosBridge, name: str) -> Any:
    """What a program reads between two ticks; None when nothing can be had."""
    try:
        return getattr(ros.robot, name)
    except (NoDataYet, BridgeError):
        return None


def chatter(real: Any, text: str, topic: str = "/chatter") -> Any:
    return real.start("/usr/bin/rostopic", "pub", "-r", "20", topic, "std_msgs/String", f"data: '{text}'")


def echo(real: Any, topic: str) -> list[str]:
    """The lines that `rostopic echo` prints."""
    lines = real.lines(real.start("/usr/bin/rostopic", "echo", "-p", topic))
    until(lambda: any("rostopic" in node for node in real.subscribers(topic)))
    return lines  # type: ignore[no-any-return]


def velocities(lines: list[str]) -> list[tuple[float, float]]:
    """linear.x and angular.z of what was printed."""
    rows = [line.split(",") for line in lines if line and not line.startswith("%")]
    return [(float(row[1]), float(row[6])) for row in rows]


def test_what_rostopic_publishes_arrives(real: Any, connect: Connect) -> None:
    ros = connect()
    ros.subscribe("text", "/chatter", "std_msgs/String")
    with pytest.raises(NoDataYet, match=r"`robot\.text` has no data yet"):
        _ = ros.robot.text
    before = time.monotonic()
    chatter(real, "hello")
    until(lambda: reading(ros, "text"))
    assert ros.robot.text.data == "hello"
    age = ros.describe("text").age
    assert age is not None
    assert 0 <= age <= time.monotonic() - before


def test_rostopic_receives_all_four_forms_of_publishing(real: Any, connect: Connect) -> None:
    ros = connect()
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    lines = echo(real, until, "/cmd_vel")
    until(lambda: ros.robot.move() or velocities(lines))  # in ROS the first ones may be lost

    def fill(msg: Any) -> None:
        msg.linear.x = 0.4

    ros.robot.move(linear_x=0.2, angular=0.1)
    ros.robot.move(lambda msg: msg.linear(x=0.3))
    ros.robot.move(fill)
    with ros.robot.move as msg:
        msg.angular.z = 0.5
    until(lambda: (0.0, 0.5) in velocities(lines))
    assert velocities(lines)[-4:] == [(0.2, 0.1), (0.3, 0.0), (0.4, 0.0), (0.0, 0.5)]


def test_the_relay_of_c_plus_plus_sends_back_what_was_published(real: Any, connect: Connect) -> None:
    ros = connect()
    ros.publish("say", "/there", "std_msgs/String")
    real.start("/usr/lib/topic_tools/relay", "/there", "/back")
    ros.subscribe("heard", "/back")  # its type is known when it exists

    def returned() -> Any:
        ros.robot.say(data="über")
        return reading(ros, "heard")

    until(returned)
    assert ros.robot.heard.data == "über"
    assert ros.setup["subscriptions"]["heard"] == {"topic": "/back"}


def test_arrays_times_octets_and_messages_in_messages_arrive_as_they_were_sent(
    real: Any, connect: Connect
) -> None:
    ros = connect()
    ros.publish("joints", "/joints", "sensor_msgs/JointState")
    ros.publish("octets", "/octets", "std_msgs/UInt8MultiArray")
    ros.subscribe("joints_heard", "/joints")
    ros.subscribe("octets_heard", "/octets")

    def returned() -> Any:
        ros.robot.joints(
            name=["ä", "b"], position=[1, 2.5], header={"frame_id": "base", "stamp": {"secs": 12, "nsecs": 5}}
        )
        ros.robot.octets(data=bytes([0, 255]), layout_dim=[{"label": "x", "size": 2}])
        return reading(ros, "joints_heard") and reading(ros, "octets_heard")

    until(returned)
    joints, octets = ros.robot.joints_heard, ros.robot.octets_heard
    assert (joints.name, joints.position, joints.velocity) == (("ä", "b"), (1.0, 2.5), ())
    assert (joints.header.stamp.secs, joints.header.stamp.nsecs) == (12, 5)
    assert octets.data == bytes([0, 255])
    assert [(dim.label, dim.size) for dim in octets.layout.dim] == [("x", 2)]
    ros.publish("again", "/joints", "sensor_msgs/JointState")
    ros.robot.again(header=joints.header, name=joints.name)  # what arrived may be sent on


def test_topics_with_subscribers_only_are_in_the_list(real: Any, connect: Connect) -> None:
    real.start_robot()
    ros = connect()
    table = ros.panel().tables[1]
    rows = dict(table.rows)
    assert rows["/cmd_vel"] == "geometry_msgs/Twist"
    assert rows["/odom"] == "nav_msgs/Odometry"
    ros.press("pick", row="/odom")
    assert {field.key: field.value for field in ros.panel().fields}["type"] == "nav_msgs/Odometry"


def test_an_odometry_has_x_y_and_theta(real: Any, connect: Connect) -> None:
    real.start_robot(world="empty")
    ros = connect()
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel")
    until(lambda: reading(ros, "odom"))
    start = ros.robot.odom

    def turned() -> bool:
        ros.robot.move(angular=1.0)
        return bool(ros.robot.odom.theta > start.theta + 0.2)

    until(turned)
    assert ros.robot.odom.x == pytest.approx(ros.robot.odom.pose.pose.position.x)


def test_a_wrong_type_is_refused_with_the_right_one(real: Any, connect: Connect) -> None:
    real.start_robot()
    ros = connect()
    with pytest.raises(BridgeError, match=r"`/odom` carries `nav_msgs/Odometry`, not `std_msgs/String`"):
        ros.subscribe("odom", "/odom", "std_msgs/String")
    with pytest.raises(BridgeError, match=r"`/cmd_vel` carries `geometry_msgs/Twist`"):
        ros.publish("move", "/cmd_vel", "geometry_msgs/Pose")
    assert ros.members() == tuple(member for member in ros.members() if member.name == "stop")
    assert real.subscribers("/odom") == []


def test_a_type_that_is_no_longer_used_blocks_nothing(real: Any, connect: Connect, backend: str) -> None:
    ros = connect()
    ros.subscribe("text", "/new", "std_msgs/String")
    ros.subscribe("text", "/other", "std_msgs/String")
    until(lambda: real.subscribers("/new") == [])
    ros.subscribe("number", "/new", "std_msgs/Int32")  # the master still thinks of texts
    until(lambda: len(real.subscribers("/new")) == 1)


def test_an_unknown_type_is_refused(real: Any, connect: Connect) -> None:
    ros = connect()
    with pytest.raises(BridgeError, match="no message type `geometry_msgs/Twsit`"):
        ros.publish("move", "/cmd_vel", "geometry_msgs/Twsit")
    assert "move" not in dir(ros.robot)


def test_a_topic_changed_under_a_variable_starts_without_data(real: Any, connect: Connect) -> None:
    chatter(real, "old")
    ros = connect()
    ros.subscribe("text", "/chatter", "std_msgs/String")
    until(lambda: reading(ros, "text"))
    ros.subscribe("text", "/silence", "std_msgs/String")
    with pytest.raises(NoDataYet):
        _ = ros.robot.text
    until(lambda: real.subscribers("/chatter") == [])


def test_who_else_commands_is_told(real: Any, connect: Connect) -> None:
    ros = connect()
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    twist = "{linear: {x: 0.0, y: 0.0, z: 0.0}, angular: {x: 0.0, y: 0.0, z: 0.0}}"
    other = real.start("/usr/bin/rostopic", "pub", "-r", "5", "/cmd_vel", "geometry_msgs/Twist", twist)

    def row() -> str:
        return str(ros.panel().tables[0].rows[0][6])

    until(lambda: any("/rostopic_" in notice.text for notice in ros.safety.notices))
    assert "/rostopic_" in row()
    other.send_signal(signal.SIGINT)
    until(lambda: "/rostopic_" not in row())
    assert "/lrp" not in row()


def test_a_time_stamp_that_was_not_set_is_the_time_of_sending(real: Any, connect: Connect) -> None:
    ros = connect()
    ros.publish("move", "/cmd", "geometry_msgs/TwistStamped")
    lines = echo(real, until, "/cmd")
    before = time.time()
    until(lambda: ros.robot.move(linear=0.2) or [line for line in lines if not line.startswith("%")])
    stamps = [int(line.split(",")[2]) / 1e9 for line in lines if not line.startswith("%")]
    assert before - 1 < stamps[0] < time.time() + 1


def test_pause_and_stop_send_a_velocity_of_zero(real: Any, connect: Connect) -> None:
    ros = connect()
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    lines = echo(real, until, "/cmd_vel")
    session = Session("(machine m (state s (running [robot.move(linear=0.2)])))(spawn m s)", bridge=ros)
    try:
        session.start()
        until(lambda: velocities(lines)[-1:] == [(0.2, 0.0)])
        session.pause()
        until(lambda: velocities(lines)[-1:] == [(0.0, 0.0)])
        session.resume()
        until(lambda: velocities(lines)[-1:] == [(0.2, 0.0)])
        session.stop_robot()
        until(lambda: velocities(lines)[-1:] == [(0.0, 0.0)])
    finally:
        session.close()


def test_two_hundred_edits_leave_one_subscriber_and_no_threads_or_descriptors(
    real: Any, connect: Connect
) -> None:
    chatter(real, "hello")
    ros = connect(setup={"subscriptions": {"text": {"topic": "/chatter", "type": "std_msgs/String"}}})
    program = "(machine m (state s (running [seen = robot.text.data; {n}])))(spawn m s)"
    session = Session(program.format(n=0), bridge=ros, rate=100)
    until(lambda: reading(ros, "text"))
    session.start()
    try:
        subscribers, threads, files = real.subscribers("/chatter"), threading.active_count(), descriptors()
        for n in range(1, 201):
            assert session.edit(program.format(n=n)) == ()  # the active state changed: a restart
            if n % 20 == 0:
                session.stop()
                session.start()
            ros.subscribe("text", "/chatter", "std_msgs/String")
        until(lambda: session.frame.tick > 0 and reading(ros, "text"))
        assert real.subscribers("/chatter") == subscribers
        assert len(subscribers) == 1
        until(lambda: threading.active_count() <= threads)
        until(lambda: descriptors() <= files)
        assert not session.issues
    finally:
        session.close()
    until(lambda: real.subscribers("/chatter") == [])


def descriptors() -> int:
    return len(os.listdir("/proc/self/fd"))


def test_a_master_that_dies_stops_the_robot_and_does_not_slow_the_loop(
    real: Any, connect: Connect, backend: str
) -> None:
    ros = connect()
    ros.subscribe("text", "/chatter", "std_msgs/String")
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    talker = chatter(real, "before")
    until(lambda: reading(ros, "text"))
    session = Session(
        "(machine m (state s (running [robot.move(linear=0.2)])))(spawn m s)", bridge=ros, rate=50
    )
    session.start()
    try:
        until(lambda: ros.safety.command_count > 10)
        real.kill_master()
        until(lambda: ros.status.state is ConnectionState.LOST)
        with pytest.raises(BridgeError, match="master"):
            _ = ros.robot.text
        until(lambda: any("was not sent" in issue.message for issue in session.issues))
        first = session.frame.tick
        with bounded(3):
            until(lambda: session.frame.tick >= first + 50)
        assert "master" in ros.status.sentence
        real.end(talker)
        real.start_master()
        chatter(real, "after")
        until(lambda: getattr(reading(ros, "text"), "data", "") == "after")
        until(lambda: ros.status.state is ConnectionState.CONNECTED)
        assert len(real.subscribers("/chatter")) == 1
        if backend == "rosbridge":  # it publishes where it did, which the new master does not know
            real.kill_rosbridge()
            real.start_rosbridge()
        lines = echo(real, until, "/cmd_vel")
        until(lambda: (0.2, 0.0) in velocities(lines))
    finally:
        session.close()


@pytest.mark.parametrize("backend", ["rosbridge"])
def test_a_rosbridge_server_that_dies_and_comes_back_gets_no_old_commands(
    real: Any, connect: Connect
) -> None:
    ros = connect()
    ros.subscribe("text", "/chatter", "std_msgs/String")
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    chatter(real, "hello")
    lines = echo(real, until, "/cmd_vel")
    until(lambda: reading(ros, "text"))
    ros.robot.move(linear=0.1)
    until(lambda: velocities(lines))
    real.kill_rosbridge()
    until(lambda: ros.status.state is ConnectionState.LOST)
    for _ in range(5):
        with pytest.raises(BridgeError):
            ros.robot.move(linear=0.9)
    assert reading(ros, "text") is None
    real.start_rosbridge()
    until(lambda: reading(ros, "text"))
    until(lambda: velocities(lines)[-1:] == [(0.0, 0.0)])  # it may have driven on all the time
    ros.robot.move(linear=0.3)
    until(lambda: velocities(lines)[-1:] == [(0.3, 0.0)])
    assert velocities(lines) == [(0.1, 0.0), (0.0, 0.0), (0.3, 0.0)]


@pytest.mark.parametrize("backend", ["rospy"])
def test_a_master_that_hangs_is_lost_too(real: Any, connect: Connect) -> None:
    ros = connect()
    ros.subscribe("text", "/chatter", "std_msgs/String")
    real.signal_master(signal.SIGSTOP)
    try:
        until(lambda: ros.status.state is ConnectionState.LOST)
        with pytest.raises(BridgeError, match=r"master|answer"):
            _ = ros.robot.text
    finally:
        real.signal_master(signal.SIGCONT)
    chatter(real, "again")
    until(lambda: reading(ros, "text"))


@pytest.mark.parametrize("backend", ["rosbridge"])
def test_a_master_that_hangs_ends_nothing_that_runs_over_rosbridge(real: Any, connect: Connect) -> None:
    ros = connect()
    ros.subscribe("text", "/chatter", "std_msgs/String")
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    lines = echo(real, until, "/cmd_vel")
    until(lambda: ros.robot.move(linear=0.1) or velocities(lines))
    chatter(real, "hello")
    until(lambda: reading(ros, "text"))
    real.signal_master(signal.SIGSTOP)
    try:
        until(lambda: any("does not answer" in notice.text for notice in ros.safety.notices))
        ros.robot.move(linear=0.3)
        until(lambda: velocities(lines)[-1:] == [(0.3, 0.0)])
        assert ros.describe("text").age is not None
        until(lambda: ros.status.state is ConnectionState.CONNECTED)  # unless the messages were held up
    finally:
        real.signal_master(signal.SIGCONT)


def test_without_a_master_rospy_does_not_open_and_reports_it(real: Any) -> None:
    real.kill_master()
    ros = RosBridge(backend="rospy", host="127.0.0.1", port=real.master_port)
    with bounded(3), pytest.raises(BridgeError, match="No ROS master answers"):
        ros.open()
    assert ros.status.state is ConnectionState.DISCONNECTED


def test_one_process_has_one_node(real: Any) -> None:
    first = RosBridge(backend="rospy", host="127.0.0.1", port=real.master_port)
    first.open()
    first.close()
    other = RosBridge(backend="rospy", host="localhost", port=real.master_port)
    with pytest.raises(BridgeError, match="belongs to"):
        other.open()


def test_rospy_leaves_the_logging_of_the_process_alone(real: Any) -> None:
    before = logging.getLogger().handlers[:]
    ros = RosBridge(backend="rospy", host="127.0.0.1", port=real.master_port)
    ros.open()
    ros.close()
    assert logging.getLogger().handlers == before


def test_looking_back_sends_no_message(real: Any, connect: Connect) -> None:
    """Scrubbing, questions, forks and what-ifs never command a real robot, and its program goes on."""
    program = """\
    (machine m
      (state still)
      (state drive (onentry [robot.move(linear=0.2)]))
      (ontime 300 still -> drive)
      (ontime 300 drive -> calm)
      (state calm (onentry [robot.move()])))
    (spawn m still)
    """
    chatter(real, "hello")
    ros = connect(setup={"subscriptions": {"text": {"topic": "/chatter", "type": "std_msgs/String"}}})
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    lines = echo(real, until, "/cmd_vel")

    def driven() -> list[tuple[float, float]]:
        """What was sent but for stops: a watchdog adds one whenever the loop is held up."""
        return [velocity for velocity in velocities(lines) if any(velocity)]

    with Session(program, bridge=ros, rate=20) as session:
        connection = PageConnection(session, Saver(Texts()))
        got: list[dict[str, Any]] = []
        ids = count(1)

        def ask(kind: str, /, **fields: Any) -> dict[str, Any]:
            number = next(ids)
            connection.receive(page, {"type": kind, "view": "page", "id": number, **fields})
            until(lambda: any(each.get("id") == number for each in got))
            return next(each for each in got if each.get("id") == number)

        def page(message: dict[str, Any], _buffers: object) -> None:
            got.append(message)
            if message["type"] == "frame":
                connection.receive(page, {"type": "credit", "view": "page", "frame": message["frame"]})

        connection.receive(page, {"type": "hello", "view": "page", "part": "lab"})
        try:
            session.start()
            until(lambda: driven() and velocities(lines)[-1:] == [(0.0, 0.0)])
            until(lambda: session.frame.tick > 40)
            begun = session.frame.tick
            for tick in (*range(2, 40), 3, 20):
                assert ask("command", do="look", tick=tick)["error"] is None
            assert connection.view_state()["tick"] == 20
            assert "why" in ask("why", kind="state", path="m/drive")
            assert "why" in ask("why", kind="robot", path="move")
            assert ask("timeline", epoch=0, tick=0)["timeline"]["happenings"]
            assert ask("what_if", seconds=1)["what_if"]["open_loop"]
            with session.fork(5) as fork:
                fork.run(3)
            assert session.status == "running"
            until(lambda: session.frame.tick > begun + 5)
            assert ask("command", do="look")["error"] is None
            assert connection.view_state()["tick"] >= begun + 5
            time.sleep(0.3)
            assert driven() == [(0.2, 0.0)], "once, by the program"
        finally:
            connection.close()

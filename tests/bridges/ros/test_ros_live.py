"""The bridge against a real ROS 1: its master, its command line tools, its C++ relay."""

from __future__ import annotations

import logging
import os
import re
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.guarding import safety
from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.errors import BridgeError, NoDataYet
from lrp_jupyter.live.clock import MonotonicClock
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Texts

pytestmark = pytest.mark.ros

Connect = Callable[..., RosBridge]
TEXT = {"subscriptions": {"text": {"topic": "/chatter", "type": "std_msgs/String"}}}
DRIVES = "(machine m (state s (running [robot.move(linear=0.2)])))(spawn m s)"


def reading(ros: RosBridge, name: str) -> Any:
    """What a program reads between two ticks; None when nothing can be had."""
    with suppress(NoDataYet, BridgeError):
        return getattr(ros.robot, name)


def refusal(ros: RosBridge, name: str) -> str:
    """Why nothing can be read; in the tick under way, the program still has its reading."""
    try:
        getattr(ros.robot, name)
    except BridgeError as error:
        return str(error)
    return ""


def chatter(real: Any, text: str) -> Any:
    return real.start(
        "/usr/bin/rostopic", "pub", "-r", "20", "/chatter", "std_msgs/String", f"data: '{text}'"
    )


def echo(real: Any) -> Callable[[], list[tuple[float, float]]]:
    """Have `rostopic echo` print the velocities; return what reads linear.x and angular.z of them."""
    lines = real.lines(real.start("/usr/bin/rostopic", "echo", "-p", "/cmd_vel"))
    until(lambda: any("rostopic" in node for node in real.subscribers("/cmd_vel")))

    def velocities() -> list[tuple[float, float]]:
        rows = [line.split(",") for line in tuple(lines) if line and not line.startswith("%")]
        return [(float(row[1]), float(row[6])) for row in rows]

    return velocities


def test_topics_are_found_heard_and_commanded(real: Any, connect: Connect) -> None:
    real.start_robot(world="empty")
    before = time.monotonic()
    chatter(real, "hello")
    real.start("/usr/lib/topic_tools/relay", "/there", "/back")
    velocities = echo(real)
    ros = connect()

    # those with subscribers only are in the list, too
    types = dict(ros.panel().tables[1].rows)
    assert (types["/cmd_vel"], types["/odom"]) == ("geometry_msgs/Twist", "nav_msgs/Odometry")
    ros.press("pick", row="/odom")
    assert {field.key: field.value for field in ros.panel().fields}["type"] == "nav_msgs/Odometry"

    # a wrong type is refused with the right one
    for connected, topic, type_, sentence in (
        (ros.subscribe, "/odom", "std_msgs/String", r"`/odom` carries `nav_msgs/Odometry`, not `std_msgs/S"),
        (ros.publish, "/cmd_vel", "geometry_msgs/Pose", r"`/cmd_vel` carries `geometry_msgs/Twist`"),
        (ros.publish, "/new", "geometry_msgs/Twsit", "no message type `geometry_msgs/Twsit`"),
    ):
        with pytest.raises(BridgeError, match=sentence):
            connected("wrong", topic, type_)
    assert dir(ros.robot) == ["stop"]
    assert real.subscribers("/odom") == []

    # what `rostopic` publishes arrives; under another topic, the variable starts without data
    ros.subscribe("text", "/chatter", "std_msgs/String")
    until(lambda: reading(ros, "text"))
    assert ros.robot.text.data == "hello"
    age = ros.describe("text").age
    assert age is not None
    assert 0 <= age <= time.monotonic() - before
    ros.subscribe("text", "/silence", "std_msgs/String")
    with pytest.raises(NoDataYet, match=r"`robot\.text` has no data yet"):
        _ = ros.robot.text
    until(lambda: real.subscribers("/chatter") == [])
    ros.subscribe("text", "/other", "std_msgs/String")
    until(lambda: real.subscribers("/silence") == [])
    ros.subscribe("number", "/silence", "std_msgs/Int32")  # the master still thinks of texts
    until(lambda: len(real.subscribers("/silence")) == 1)

    # all four forms of publishing arrive at `rostopic`
    def fill(msg: Any) -> None:
        msg.linear.x = 0.4

    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    until(lambda: ros.robot.move() or velocities())  # in ROS the first ones may be lost
    ros.robot.move(linear_x=0.2, angular=0.1)
    ros.robot.move(lambda msg: msg.linear(x=0.3))
    ros.robot.move(fill)
    with ros.robot.move as msg:
        msg.angular.z = 0.5
    until(lambda: (0.0, 0.5) in velocities())
    assert velocities()[-4:] == [(0.2, 0.1), (0.3, 0.0), (0.4, 0.0), (0.0, 0.5)]

    # an odometry has x, y and theta
    ros.subscribe("odom", "/odom")
    start = until(lambda: reading(ros, "odom"))
    until(lambda: ros.robot.move(angular=1.0) or ros.robot.odom.theta > start.theta + 0.2)
    ros.robot.move()
    odom = ros.robot.odom
    assert odom.x == odom.pose.pose.position.x

    # who else commands is told
    twist = "{linear: {x: 0.0, y: 0.0, z: 0.0}, angular: {x: 0.0, y: 0.0, z: 0.0}}"
    other = real.start("/usr/bin/rostopic", "pub", "-r", "5", "/cmd_vel", "geometry_msgs/Twist", twist)

    def row() -> str:
        table = ros.panel().tables[0]
        return str(dict(zip(table.keys, table.rows, strict=True))["move"][-1])

    until(lambda: any("/rostopic_" in notice.text for notice in ros.safety.notices))
    until(lambda: "/rostopic_" in row())
    other.send_signal(signal.SIGINT)
    until(lambda: "/rostopic_" not in row())
    assert "/lrp" not in row()


def test_messages_arrive_as_they_were_sent(real: Any, connect: Connect) -> None:
    """Through a relay in C++, with arrays, times, octets and messages in messages."""
    real.start("/usr/lib/topic_tools/relay", "/there", "/back")
    ros = connect()
    for name, topic, type_ in (
        ("say", "/there", "std_msgs/String"),
        ("joints", "/joints", "sensor_msgs/JointState"),
        ("octets", "/octets", "std_msgs/UInt8MultiArray"),
        ("move", "/cmd", "geometry_msgs/TwistStamped"),
    ):
        ros.publish(name, topic, type_)
    heard = {"text": "/back", "joints_heard": "/joints", "octets_heard": "/octets", "moved": "/cmd"}
    for name, topic in heard.items():
        ros.subscribe(name, topic)  # its type is known when it exists
    before = time.time()

    def returned() -> bool:
        ros.robot.say(data="über")
        ros.robot.joints(
            name=["ä", "b"], position=[1, 2.5], header={"frame_id": "base", "stamp": {"secs": 12, "nsecs": 5}}
        )
        ros.robot.octets(data=bytes([0, 255]), layout_dim=[{"label": "x", "size": 2}])
        ros.robot.move(linear=0.2)
        return all(reading(ros, name) for name in heard)

    until(returned)
    assert ros.robot.text.data == "über"
    assert ros.setup["subscriptions"]["text"] == {"topic": "/back"}
    joints, octets, stamp = ros.robot.joints_heard, ros.robot.octets_heard, ros.robot.moved.header.stamp
    assert (joints.name, joints.position, joints.velocity) == (("ä", "b"), (1.0, 2.5), ())
    assert (joints.header.stamp.secs, joints.header.stamp.nsecs) == (12, 5)
    assert octets.data == bytes([0, 255])
    assert [(dim.label, dim.size) for dim in octets.layout.dim] == [("x", 2)]
    assert before - 1 < stamp.secs + stamp.nsecs * 1e-9 < time.time() + 1  # not set, so that of sending
    ros.robot.joints(header=joints.header, name=joints.name)  # what arrived may be sent on


def test_a_program_that_is_edited_paused_and_stopped_drives_with_one_subscriber(
    real: Any, connect: Connect
) -> None:
    chatter(real, "hello")
    ros = connect(setup=TEXT)
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    velocities = echo(real)
    program = (
        "(machine m (state s (running [seen = robot.text.data; {n}; robot.move(linear=0.2)])))(spawn m s)"
    )
    until(lambda: reading(ros, "text"))
    with Session(program.format(n=0), bridge=ros, rate=100) as session:
        session.start()
        until(lambda: velocities()[-1:] == [(0.2, 0.0)])
        for change, speed in (
            *((session.pause, 0.0), (session.resume, 0.2)),
            *((session.stop_robot, 0.0), (session.resume, 0.2)),
        ):
            change()
            until(lambda speed=speed: velocities()[-1:] == [(speed, 0.0)])
        subscribers, threads, files = real.subscribers("/chatter"), threading.active_count(), descriptors()
        for n in range(1, 51):
            assert session.edit(program.format(n=n)) == ()  # the active state changed: a restart
            if n % 10 == 0:
                session.stop()
                session.start()
            ros.subscribe("text", "/chatter", "std_msgs/String")
        until(lambda: session.frame.tick > 0 and reading(ros, "text"))
        assert real.subscribers("/chatter") == subscribers
        assert len(subscribers) == 1
        until(lambda: threading.active_count() <= threads)
        until(lambda: descriptors() <= files)
        assert not session.issues
    until(lambda: real.subscribers("/chatter") == [])


def descriptors() -> int:
    return len(os.listdir("/proc/self/fd"))


def is_heard_by_rosbridge(real: Any) -> bool:
    """Whether it listens to the commands of others: what it subscribes to without a master, it waits for."""
    return any("rosbridge" in node for node in real.subscribers("/cmd_vel"))


def test_a_lost_robot_stops_and_is_found_again(
    real: Any, connect: Connect, backend: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for limit in ("rospy._ANSWER", "rosapi._ANSWER", "rosapi._FIRST"):
        monkeypatch.setattr(f"lrp_jupyter.bridges.ros.{limit}", 1.0)
    for pause in ("rosapi._SOON", "rosapi._RARELY"):
        monkeypatch.setattr(f"lrp_jupyter.bridges.ros.{pause}", 0.2)
    ros = connect(setup=TEXT)
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    velocities = echo(real)
    talker = chatter(real, "before")
    until(lambda: reading(ros, "text"))
    with Session(DRIVES, bridge=ros, rate=50) as session:
        session.start()
        until(lambda: (0.2, 0.0) in velocities())
        if backend == "rosbridge":
            until(lambda: is_heard_by_rosbridge(real))

        real.signal_master(signal.SIGSTOP)  # it hangs
        try:
            if backend == "rospy":
                until(lambda: ros.status.state is ConnectionState.LOST)
                until(lambda: re.search("master|answer", refusal(ros, "text")))
            else:  # nothing ends that runs over rosbridge
                until(lambda: any("does not answer" in notice.text for notice in ros.safety.notices))
                sent = len(velocities())
                until(lambda: len(velocities()) > sent + 5)
                assert ros.describe("text").age is not None
                until(lambda: ros.status.state is ConnectionState.CONNECTED)  # unless it was held up
        finally:
            real.signal_master(signal.SIGCONT)
        until(lambda: reading(ros, "text") and ros.status.state is ConnectionState.CONNECTED)
        if backend == "rosbridge":
            until(lambda: any("answers now" in notice.text for notice in ros.safety.notices))
            until(lambda: is_heard_by_rosbridge(real))

        real.kill_master()
        until(lambda: ros.status.state is ConnectionState.LOST)
        until(lambda: "master" in refusal(ros, "text"))
        until(lambda: "A new master knows no" in ros.status.sentence)
        until(lambda: velocities()[-1:] == [(0.0, 0.0)])  # what is connected still hears it
        until(lambda: any("was not sent" in issue.message for issue in session.issues))
        first = session.frame.tick
        until(lambda: session.frame.tick >= first + 50)
        until(lambda: "master" in ros.status.sentence)  # or that it has not been asked in time
        real.end(talker)
        real.start_master()
        chatter(real, "after")
        until(lambda: getattr(reading(ros, "text"), "data", "") == "after")
        until(lambda: ros.status.state is not ConnectionState.LOST)  # the new master knows of no wheels
        assert len(real.subscribers("/chatter")) == 1
        if backend == "rosbridge":  # it publishes where it did, which the new master does not know
            real.kill_rosbridge()
            until(lambda: ros.status.state is ConnectionState.LOST)
            real.start_rosbridge()
        velocities = echo(real)
        until(lambda: (0.2, 0.0) in velocities())


@pytest.mark.parametrize("backend", ["rospy"])
def test_a_process_has_one_node_of_one_master(real: Any, connect: Connect) -> None:
    before = logging.getLogger().handlers[:]
    connect().close()
    assert logging.getLogger().handlers == before
    with pytest.raises(BridgeError, match="belongs to"):
        RosBridge(backend="rospy", host="localhost", port=real.master_port).open()
    real.kill_master()
    ros = RosBridge(backend="rospy", host="127.0.0.1", port=real.master_port, patience=2)
    with pytest.raises(BridgeError, match="No ROS master answers"):
        ros.open()
    assert ros.status.state is ConnectionState.DISCONNECTED


def test_looking_back_sends_no_message(real: Any, connect: Connect, monkeypatch: pytest.MonkeyPatch) -> None:
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
    monkeypatch.setattr(safety, "patience", lambda _period: 3600.0)  # a stop replaces what is still queued
    ros = connect()
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    velocities = echo(real)

    def driven() -> list[tuple[float, float]]:
        """What was sent but for stops."""
        return [velocity for velocity in velocities() if any(velocity)]

    with Session(program, bridge=ros, rate=20, clock=MonotonicClock(4)) as session:
        connection = PageConnection(session, Saver(Texts()))
        got: list[dict[str, Any]] = []
        ids = count(1)

        def ask(kind: str, /, **fields: Any) -> dict[str, Any]:
            number = next(ids)
            connection.receive(page, {"type": kind, "view": "page", "id": number, **fields})
            return until(lambda: next((each for each in tuple(got) if each.get("id") == number), None)) or {}

        def page(message: dict[str, Any], _buffers: object) -> None:
            got.append(message)
            if message["type"] == "frame":
                connection.receive(page, {"type": "credit", "view": "page", "frame": message["frame"]})

        connection.receive(page, {"type": "hello", "view": "page", "part": "lab"})
        try:
            session.start()
            until(lambda: driven() and velocities()[-1:] == [(0.0, 0.0)])
            begun = until(lambda: session.frame.tick > 40 and session.frame.tick)
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
            ros.robot.move(linear=0.3)  # arrives after whatever was sent before
            until(lambda: (0.3, 0.0) in driven())
            assert driven() == [(0.2, 0.0), (0.3, 0.0)], "once, by the program"
        finally:
            connection.close()

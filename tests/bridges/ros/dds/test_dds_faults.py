"""What can go wrong on ROS 2's wire, and how the bridge reacts: nobody there, options, quality of service."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.bridges.ros.names import GraphNames
from lrp_jupyter.errors import BridgeError, NoDataYet

pytest.importorskip("cyclonedds", reason="the extra `ros2` is missing")
pytest.importorskip("rosbags", reason="the extra `ros2` is missing")

from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from lrp_jupyter.bridges.ros import dds, dds_domain
from lrp_jupyter.bridges.ros.dds_domain import DdsDomain
from lrp_jupyter.bridges.ros.dds_node import DdsNode
from lrp_jupyter.bridges.ros.dds_qos import disagreements, qos_of, reading_qos
from lrp_jupyter.bridges.ros.dds_types import MessageTypes

Make = Callable[..., RosBridge]


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody is waited for so long."""
    monkeypatch.setattr(dds, "_FIND", 0.2)


@pytest.fixture
def other(domain: int) -> Iterator[DdsNode]:
    """Another node of this process, in the same domain, with a reader and a writer of its own."""
    node = DdsNode(domain, GraphNames("other"), "", MessageTypes(), lambda: None)
    node.subscribe("/here", "std_msgs/Empty", lambda _message: None)
    node.advertise("/here", "std_msgs/Empty")
    yield node
    node.close()


# -- what it has not ----------------------------------------------------------------------------------


@pytest.mark.usefixtures("other")
def test_what_is_no_topic_is_refused_with_the_back_end_that_has_it(connect: Make) -> None:
    ros = connect()
    for ask, kind in (
        (lambda: ros.action("drive_to", "/navigate", "nav2_msgs/NavigateToPose"), "an action"),
        (lambda: ros.service("spawn", "/spawn"), "a service"),
        (lambda: ros.parameter("speed", "/controller:max_speed"), "a parameter"),
    ):
        with pytest.raises(BridgeError, match=rf"has topics only\. Use `rosbridge` for {kind}, with"):
            ask()


# -- opening ------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.usefixtures("impatient")
def test_where_nobody_is_opening_fails_and_says_what_to_look_at(make: Make, domain: int) -> None:
    ros = make(patience=2)
    sentence = rf"No node answers in ROS 2's domain {domain}\. Is the robot on.*`ROS_DOMAIN_ID` {domain}\?"
    with pytest.raises(BridgeError, match=sentence):
        ros.open()
    assert ros.status.state is ConnectionState.DISCONNECTED
    assert DdsDomain._all == {}


def test_a_search_can_be_broken_off(make: Make) -> None:
    ros = make(patience=0.2)
    with pytest.raises(BridgeError, match=r"did not answer within 0\.2 s"):
        ros.open()
    assert "ROS 2" not in {thread.name for thread in threading.enumerate()}


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"domain": 233}, r"`domain` must be a number from 0 to 232, not `233`"),
        ({"domain": "home"}, r"`domain` must be a number from 0 to 232, not `home`"),
        ({"port": 9090}, r"takes a `host` without a port.*Set `domain` instead"),
        ({"host": "turtle.local:9090"}, r"takes a `host` without a port"),
        ({"backend": "rosbridge", "domain": 3}, r"`rosbridge` has no `domain`"),
        ({"backend": "rclpy", "messages": "src"}, r"`rclpy` takes no `messages`"),
    ],
)
def test_an_option_that_means_nothing_is_refused(options: dict[str, Any], sentence: str) -> None:
    with pytest.raises(BridgeError, match=sentence):
        RosBridge(**{"backend": "dds", **options})


@pytest.mark.parametrize(
    ("variable", "value", "sentence"),
    [
        ("ROS_DOMAIN_ID", "none", r"`ROS_DOMAIN_ID` must be a number from 0 to 232, not `none`"),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCAL", r"must be one of SUBNET.*Did you mean `LOCALHOST`"),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF", r"no robot can be found"),
        ("ROS_STATIC_PEERS", "no-such-host.invalid", r"`no-such-host\.invalid` has no IPv4 address"),
        (
            "CYCLONEDDS_URI",
            "file:///no/such/file",
            r"DDS cannot be started in domain \d+\..*`CYCLONEDDS_URI`",
        ),
    ],
)
@pytest.mark.usefixtures("domain")
def test_a_mistake_in_the_environment_is_named(
    make: Make, monkeypatch: pytest.MonkeyPatch, variable: str, value: str, sentence: str
) -> None:
    monkeypatch.setenv(variable, value)
    with pytest.raises(BridgeError, match=sentence):
        make().open()
    assert DdsDomain._all == {}


def test_a_host_without_an_address_and_a_folder_without_types_are_named(make: Make, tmp_path: Path) -> None:
    with pytest.raises(BridgeError, match=r"`no-such-host\.invalid` has no IPv4 address"):
        make(host="no-such-host.invalid").open()
    with pytest.raises(BridgeError, match=r"has no message types"):
        make(messages=str(tmp_path)).open()


@pytest.mark.parametrize(
    ("environment", "host", "parts"),
    [
        ({}, "127.0.0.9", ['<Peer address="127.0.0.9"/>', "<ParticipantIndex>auto</ParticipantIndex>"]),
        ({"ROS_STATIC_PEERS": "127.0.0.7; 127.0.0.8"}, "", ['"127.0.0.7"', '"127.0.0.8"']),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, "", ["<AllowMulticast>false<", '"127.0.0.1"']),
        ({"CYCLONEDDS_URI": "<Tracing/>"}, "", [",<Tracing/>"]),
    ],
)
def test_the_environment_of_ros_2_is_heeded(
    environment: dict[str, str], host: str, parts: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS", "ROS_AUTOMATIC_DISCOVERY_RANGE", "CYCLONEDDS_URI"):
        monkeypatch.delenv(name, raising=False)
    assert "Peer " not in dds_domain._configuration("")
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    config = dds_domain._configuration(host)
    assert all(part in config for part in parts), config


@pytest.mark.slow
def test_two_bridges_share_a_domain_but_not_two_networks(make: Make, other: DdsNode) -> None:
    first, second = make(), make()
    first.open()
    second.open()
    with pytest.raises(
        BridgeError, match=r"Another bridge of this process uses domain \d+ with another `host`"
    ):
        make(host="127.0.0.9").open()
    first.close()
    other.advertise("/odom", "nav_msgs/Odometry")
    second.subscribe("odom", "/odom")
    assert second.status.state is ConnectionState.WAITING


# -- topics -------------------------------------------------------------------------------------------


def test_a_message_that_does_not_fit_is_refused_and_others_are_not(other: DdsNode, make: Make) -> None:
    got: list[Any] = []
    other.subscribe("/text", "std_msgs/String", lambda message: got.append(message.data))
    ros = make()
    ros.open()
    ros.arm()
    ros.publish("say", "/text", "std_msgs/String")
    with pytest.raises(BridgeError, match=r"`/text` refuses the message"):
        ros.robot.say(data="\ud800")  # half a character
    until(lambda: ros.robot.say(data="whole") or got)
    assert set(got) == {"whole"}


def test_a_type_of_the_users_own_goes_over_the_wire(other: DdsNode, make: Make, tmp_path: Path) -> None:
    folder = tmp_path / "src" / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Thing.msg").write_text("string name\ngeometry_msgs/Point[] corners\n")
    ros = make(messages=str(tmp_path / "src"))
    ros.open()
    ros.arm()
    ros.publish("put", "/thing", "my_msgs/Thing")
    ros.subscribe("seen", "/thing", "my_msgs/Thing")

    def seen() -> Any:
        ros.robot.put(name="crate", corners=[{"x": 1.5}])
        try:
            return ros.robot.seen
        except NoDataYet:
            return None

    until(seen)
    assert (ros.robot.seen.name, ros.robot.seen.corners[0].x) == ("crate", 1.5)
    with pytest.raises(BridgeError, match=r"knows no message type `my_msgs/Thong`.*`my_msgs/Thing`"):
        ros.subscribe("other", "/other", "my_msgs/Thong")


def test_a_mistake_in_a_users_type_is_told_where_it_is(other: DdsNode, make: Make, tmp_path: Path) -> None:
    folder = tmp_path / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Thing.msg").write_text("string name\nfloat64\n")
    ros = make(messages=str(tmp_path))
    ros.open()
    with pytest.raises(BridgeError, match=r"Thing\.msg, line 2: `float64` is not a field"):
        ros.subscribe("thing", "/thing", "my_msgs/Thing")


def test_a_command_that_nobody_hears_is_named_and_not_kept(other: DdsNode, make: Make) -> None:
    ros = make()
    ros.open()
    ros.arm()
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    assert "no other node subscribes to `/cmd_vel`" in ros.status.sentence
    ros.robot.move(linear=0.9)
    ros.stop_all()
    got: list[float] = []
    other.subscribe("/cmd_vel", "geometry_msgs/Twist", lambda message: got.append(message.linear.x))
    until(lambda: ros.status.state is ConnectionState.CONNECTED)
    until(lambda: ros.robot.move(linear=0.1) or got)  # it is known a moment before it is connected
    assert set(got) == {0.1}


def test_a_robot_that_says_goodbye_is_lost_at_once(other: DdsNode, make: Make) -> None:
    writer = other.advertise("/odom", "nav_msgs/Odometry")
    ros = make()
    ros.open()
    ros.subscribe("odom", "/odom")
    until(lambda: ros.wiring.link is not None and "/odom" in ros.topics)
    other.remove(writer)
    until(lambda: ros.status.state is ConnectionState.LOST)
    assert "`/odom` any more" in ros.status.sentence
    ros.close()
    assert not [thread for thread in threading.enumerate() if thread.name == "ROS" and thread.is_alive()]


# -- quality of service -------------------------------------------------------------------------------


POLICIES = st.tuples(
    st.sampled_from([Policy.Reliability.BestEffort, Policy.Reliability.Reliable(duration(milliseconds=10))]),
    st.sampled_from([Policy.Durability.Volatile, Policy.Durability.TransientLocal]),
    st.sampled_from([Policy.Ownership.Shared, Policy.Ownership.Exclusive]),
    st.sampled_from([Policy.Deadline(duration(seconds=s)) for s in (1, 2, 10**9)]),
    st.sampled_from([Policy.LatencyBudget(duration(seconds=s)) for s in (0, 1)]),
    st.sampled_from(
        [Policy.DestinationOrder.ByReceptionTimestamp, Policy.DestinationOrder.BySourceTimestamp]
    ),
    st.one_of(
        st.builds(kind, st.sampled_from([duration(seconds=1), duration(seconds=2)]))
        for kind in (
            Policy.Liveliness.Automatic,
            Policy.Liveliness.ManualByParticipant,
            Policy.Liveliness.ManualByTopic,
        )
    ),
)


@pytest.fixture
def topic(domain: int) -> Iterator[Topic[Any]]:
    network = Domain(domain, dds_domain._configuration(""))
    participant = DomainParticipant(domain)
    yield Topic(participant, "rt/odom", MessageTypes().struct("nav_msgs/Odometry"))
    participant.__del__()
    network.__del__()


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(offered=POLICIES, asked=POLICIES)
def test_two_sides_disagree_exactly_where_dds_does_not_connect_them(
    topic: Topic[Any], offered: tuple[Any, ...], asked: tuple[Any, ...]
) -> None:
    participant: Any = topic.participant
    writer = DataWriter(participant, topic, Qos(*offered))
    reader = DataReader(participant, topic, Qos(*asked))
    adapted = DataReader(participant, topic, reading_qos([qos_of(writer)], ""))
    found = disagreements(qos_of(writer), qos_of(reader))
    matched = [len(end.get_matched_publications()) for end in (reader, adapted)]
    for end in (adapted, reader, writer):
        end.__del__()
    assert matched == [found == [], 1], "a subscription that asks for what is offered gets it"


def test_a_subscription_asks_no_more_than_all_publishers_offer(topic: Topic[Any]) -> None:
    participant: Any = topic.participant
    best = Qos(Policy.Reliability.BestEffort, Policy.Durability.TransientLocal)
    sure = Qos(Policy.Reliability.Reliable(0), Policy.Durability.Volatile)
    writers = [DataWriter(participant, topic, qos) for qos in (best, sure)]
    reader = DataReader(participant, topic, reading_qos([qos_of(writer) for writer in writers], ""))
    assert len(reader.get_matched_publications()) == 2
    assert reading_qos([], "")[Policy.Reliability] == Policy.Reliability.BestEffort

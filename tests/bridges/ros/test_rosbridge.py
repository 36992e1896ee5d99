"""A rosbridge server as strangers run it: its services hang, its log is read, its network is slow."""

from __future__ import annotations

import json
import math
import re
import ssl
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.certificates import own_certificate
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge, rosapi, rosbridge, websocket
from lrp_jupyter.bridges.ros.definitions import HEADERS, KNOWN, Definition, FieldType
from lrp_jupyter.bridges.ros.link import GUARD_NODE
from lrp_jupyter.cli.guard_command import RosSide
from lrp_jupyter.errors import BridgeError, NoDataYet
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session

Make = Callable[..., RosBridge]
ODOM = {"pose": {"pose": {"position": {"x": 1.0, "y": 2.0}, "orientation": {"z": 1.0, "w": 0.0}}}}
SCAN = {"header": {"frame_id": "base"}, "angle_min": -1.5, "ranges": [0.5, 1.25, 2.0], "intensities": []}


@pytest.fixture
def ros2(graph: Any) -> Any:
    """The graph of a ROS 2."""
    graph.is_ros2 = True
    graph.definitions |= HEADERS[2]
    return graph


@pytest.fixture
def hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    """An answer is not waited for so long."""
    monkeypatch.setattr(rosapi, "_ANSWER", 0.1)
    monkeypatch.setattr(rosapi, "_FIRST", 0.1)


def opened(make: Make, **options: Any) -> RosBridge:
    ros = make(**options)
    ros.open()
    ros.arm()
    return ros


def notices(ros: RosBridge) -> list[str]:
    return [notice.text for notice in ros.safety.notices if notice.kind == "fault"]


def value(ros: RosBridge, row: str) -> str:
    """What the panel shows in the row of a variable."""
    table = ros.panel().tables[0]
    return dict(zip(table.keys, table.rows, strict=True))[row][-1]


# -- types ----------------------------------------------------------------------------------------


def test_a_ros_2_server_is_spoken_to_in_its_own_names_and_not_asked_for_types_that_are_known(
    make: Make, server: Any, ros2: Any
) -> None:
    server.details_end_rosapi = True
    ros2.types["/odom"] = "nav_msgs/msg/Odometry"
    ros = opened(make)
    ros.subscribe("odom", "/odom", "nav_msgs/msg/Odometry")
    ros.publish("move", "/cmd_vel")
    ros.robot.move(linear_x=0.2)
    until(lambda: ros2.heard)
    assert ros2.heard[0][1]["linear"]["x"] == 0.2
    assert [each["type"] for each in server.subscriptions("/odom")] == ["nav_msgs/msg/Odometry"]
    until(lambda: ros2.send("/odom", header={"stamp": {"sec": 5, "nanosec": 7}}, **ODOM) or age(ros, "odom"))
    odom = ros.robot.odom
    assert (odom.x, odom.theta, odom.header.stamp.sec) == (1.0, pytest.approx(math.pi), 5)
    assert server.rosapi
    assert not server.asked("message_details")


def age(ros: RosBridge, name: str) -> bool:
    return ros.describe(name).age is not None


def test_an_unknown_type_of_ros_2_is_read_from_the_text_of_its_msg_file(
    make: Make, server: Any, ros2: Any
) -> None:
    server.details_end_rosapi = True
    ros2.types["/leds"] = "my_msgs/Leds"
    ros2.texts["my_msgs/Leds"] = (
        "# the lights\nuint8 MOST=4\nstd_msgs/Header header\nLed[<=4] leds\nfloat32 dim 0.5\n"
        + "=" * 80
        + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
        + "=" * 80
        + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
        + "=" * 80
        + "\nMSG: my_msgs/Led\nstring<=8 colour\nbool on\n"
    )
    ros = opened(make)
    ros.publish("leds", "/leds")
    ros.robot.leds(leds=[{"colour": "red", "on": True}])
    until(lambda: ros2.heard)
    topic, message = ros2.heard[0]
    assert topic == "/leds"
    assert message["leds"] == [{"colour": "red", "on": True}]
    assert server.rosapi


def test_a_type_that_no_topic_of_ros_2_has_is_refused_with_the_reason(
    make: Make, server: Any, ros2: Any
) -> None:
    server.details_end_rosapi = True
    ros = opened(make)
    with pytest.raises(BridgeError, match=r"no message type `my_msgs/Thing`.*before rosbridge 2\.3\.0"):
        ros.publish("thing", "/thing", "my_msgs/Thing")
    with pytest.raises(BridgeError, match="Did you mean `geometry_msgs/Twist`"):
        ros.publish("move", "/cmd", "geometry_msgs/Twsit")
    assert server.rosapi


def test_releases_before_jazzy_describe_any_type(make: Make, server: Any, ros2: Any) -> None:
    ros2.distribution = "humble"
    ros2.definitions["my_msgs/Horn"] = Definition("my_msgs/Horn", {"tone": FieldType("float64")})
    ros = opened(make)
    ros.publish("horn", "/horn", "my_msgs/Horn")
    ros.robot.horn(tone=440)
    until(lambda: ("/horn", {"tone": 440.0}) in ros2.heard)


def test_a_text_that_cannot_be_read_is_refused_with_its_line(make: Make, ros2: Any) -> None:
    ros2.types["/leds"] = "my_msgs/Leds"
    ros2.texts["my_msgs/Leds"] = "float32 dim\nwhat is this(?)\n=3"
    with pytest.raises(BridgeError, match="`my_msgs/Leds`, line 3: `=3` cannot be read"):
        opened(make).subscribe("leds", "/leds")


@pytest.mark.usefixtures("hasty")
def test_silence_about_a_type_refuses_that_type_and_nothing_else(make: Make, server: Any, graph: Any) -> None:
    server.hangs.add("message_details")
    ros = opened(make)
    until(lambda: ros.topics)
    ros.publish("move", "/cmd_vel")
    with pytest.raises(BridgeError, match="no message type `my_msgs/Thing`"):
        ros.publish("thing", "/thing", "my_msgs/Thing")
    ros.robot.move(linear=0.2)  # on another connection than the one that hangs
    until(lambda: graph.heard)
    assert ros.status.state is not ConnectionState.LOST


# -- rosapi that comes late, or slowly ------------------------------------------------------------


def test_without_rosapi_common_types_work_and_it_is_found_when_it_starts(
    serve: Callable[..., Any], make: Make, graph: Any
) -> None:
    server = serve(rosapi=False)
    ros = opened(make, port=server.port)
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    ros.robot.move(linear=0.2)
    until(lambda: graph.heard)
    with pytest.raises(BridgeError, match="no message type `my_msgs/Thing`"):
        ros.subscribe("thing", "/thing", "my_msgs/Thing")
    ros.subscribe("odom", "/odom")
    until(lambda: len(server.asked("topics")) > 2)
    assert len([text for text in notices(ros) if "has no rosapi" in text]) == 1
    assert ros.panel() is not None
    server.rosapi = True
    until(lambda: "/odom" in ros.topics)
    until(lambda: graph.send("/odom", **ODOM) or age(ros, "odom"))
    until(lambda: notices(ros)[-1].endswith("answers now: topics are listed."))
    server.rosapi = False  # it ends, which is not a lost robot
    until(lambda: len([text for text in notices(ros) if "has no rosapi" in text]) == 2)
    heard = len(graph.heard)
    ros.robot.move(linear=0.2)
    until(lambda: len(graph.heard) > heard)
    assert ros.status.state is ConnectionState.CONNECTED
    server.close()
    until(lambda: ros.status.state is ConnectionState.LOST)
    graph.types["/new"] = "std_msgs/Bool"
    serve(server.port)  # with rosapi, which is asked again
    until(lambda: ros.topics.get("/new") == "std_msgs/Bool")


@pytest.mark.slow
@pytest.mark.parametrize("is_ros2", [False, True], ids=["ROS 1", "ROS 2"])
@pytest.mark.usefixtures("hasty")
def test_a_list_of_topics_that_comes_late_or_never_has_no_consequence(
    make: Make, server: Any, graph: Any, is_ros2: bool
) -> None:
    graph.is_ros2 = is_ros2
    server.hangs.add("topics")
    ros = opened(make)
    ros.subscribe("odom", "/odom", "nav_msgs/Odometry")
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    until(lambda: len(server.asked("topics")) > 1)
    assert any("does not answer" in text for text in notices(ros))
    ros.robot.move(linear=0.2)
    until(lambda: graph.heard)
    until(lambda: graph.send("/odom", **ODOM) or ros.status.state is ConnectionState.CONNECTED)
    server.hangs.clear()
    until(lambda: "/odom" in ros.topics and (is_ros2 or len(server.clients) == 2))
    before, told = set(server.clients), len(notices(ros))
    server.hangs.add("topics")
    until(lambda: any("does not answer" in text for text in notices(ros)[told:]))
    server.hangs.clear()
    until(lambda: notices(ros)[-1].endswith("answers now: topics are listed."))
    if not is_ros2:
        assert set(server.clients) == before, "no new connection is made"


def test_what_rosapi_answers_in_another_form_is_passed_over(make: Make, server: Any, graph: Any) -> None:
    graph.topics = lambda: {7: None}
    server._rosapi = lambda service, _: {"topics": 7, "types": None}
    ros = opened(make)
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    ros.robot.move(linear=0.2)
    until(lambda: graph.heard)
    assert any("cannot be understood" in text for text in notices(ros))


# -- subscriptions --------------------------------------------------------------------------------


def test_a_best_effort_sensor_of_ros_2_that_starts_later_arrives(make: Make, ros2: Any, clock: Any) -> None:
    ros = opened(make)
    ros.subscribe("scan", "/scan", "sensor_msgs/LaserScan")
    until(lambda: any(topic == "/scan" for topic, _ in ros2.listeners))
    ros2.best_effort.add("/scan")
    ros2.publishers["/scan"] = ["/lidar"]
    clock.now += 1.5
    until(lambda: ros2.send("/scan", **SCAN) or age(ros, "scan"))
    assert ros.robot.scan.ranges == (0.5, 1.25, 2.0)


def test_a_sensor_that_is_only_quiet_is_not_subscribed_to_again_and_again(
    make: Make, server: Any, ros2: Any, clock: Any
) -> None:
    ros2.publishers["/bumper"] = ["/base"]
    ros2.types["/bumper"] = "std_msgs/Bool"
    ros = opened(make)
    ros.subscribe("bumper", "/bumper")
    for _ in range(2):
        until(lambda: setattr(clock, "now", clock.now + 0.5) or "/base" in value(ros, "bumper"))
        clock.now += 10.0
        asked = len(server.asked("topics"))
        until(lambda asked=asked: len(server.asked("topics")) > asked + 2)
    assert re.search("/base.*restart rosbridge", value(ros, "bumper"))
    until(lambda: len(server.subscriptions("/bumper")) > 1)
    until(lambda: ros2.send("/bumper", data=True) or age(ros, "bumper"))
    until(lambda: value(ros, "bumper") == "True")
    assert len(server.subscriptions("/bumper")) == 2


def test_a_topic_that_is_published_but_does_not_arrive_points_to_the_log(
    make: Make, graph: Any, clock: Any
) -> None:
    ros = opened(make)
    ros.subscribe("odom", "/odom")
    until(lambda: graph.listeners)
    clock.now += 3.1
    until(lambda: "see the log of rosbridge" in value(ros, "odom"))
    graph.send("/odom", **ODOM)
    until(lambda: value(ros, "odom").startswith("x=1"))


def test_a_fast_topic_is_thinned_out_to_what_the_program_can_use(make: Make, server: Any, graph: Any) -> None:
    ros = opened(make)
    ros.subscribe("odom", "/odom")
    until(lambda: server.subscriptions("/odom"))
    assert server.subscriptions("/odom")[0]["throttle_rate"] == 20
    assert server.subscriptions("/odom")[0]["queue_length"] == 1
    assert ros.wiring.link is not None
    ros.wiring.link.transport.pace = 0.05
    ros.wiring.link.transport.changed()
    until(lambda: len(server.subscriptions("/odom")) == 2)
    assert server.subscriptions("/odom")[1]["throttle_rate"] == 50
    assert server.subscriptions("/odom")[1]["id"] == server.subscriptions("/odom")[0]["id"]
    assert len(graph.listeners) == 1


@pytest.mark.parametrize("packs", [True, False], ids=["new", "old"])
def test_large_arrays_come_packed_if_the_server_can_and_small_messages_as_text_or_in_fragments(
    make: Make, server: Any, graph: Any, packs: bool
) -> None:
    graph.types["/scan"] = "sensor_msgs/LaserScan"
    server.packs, server.largest = packs, 50
    ros = opened(make)
    ros.subscribe("scan", "/scan")
    ros.subscribe("odom", "/odom")
    until(lambda: graph.send("/scan", **SCAN) or age(ros, "scan"))
    until(lambda: graph.send("/odom", **ODOM) or age(ros, "odom"))
    assert server.subscriptions("/scan")[0]["compression"] == "cbor"
    assert server.subscriptions("/odom")[0]["compression"] == "none"
    assert ros.robot.scan.ranges == (0.5, 1.25, 2.0)
    assert ros.robot.scan.intensities == ()
    assert ros.robot.odom.x == 1.0


def test_a_server_that_fails_to_pack_is_asked_for_text(
    make: Make, server: Any, graph: Any, clock: Any
) -> None:
    server.fails_to_pack = True
    graph.publishers["/scan"] = ["/lidar"]
    ros = opened(make)
    ros.subscribe("scan", "/scan", "sensor_msgs/LaserScan")
    until(lambda: graph.send("/scan", **SCAN) or any("subscribe callback" in line for line in server.log))
    assert len(server.subscriptions("/scan")) == 1
    clock.now += 3.1
    until(lambda: graph.send("/scan", **SCAN) or age(ros, "scan"))
    assert [each["compression"] for each in server.subscriptions("/scan")] == ["cbor", "none"]


@pytest.mark.parametrize(
    ("type_", "expected"),
    [
        ("sensor_msgs/LaserScan", True),
        ("nav_msgs/Odometry", False),  # 36 numbers, which no server packs
        ("sensor_msgs/Imu", False),
        ("geometry_msgs/Twist", True),  # in a text, a number that is not finite would be null
        ("std_msgs/Int32", False),
        ("test/Names", False),
        ("test/Image", True),
        ("test/Octets", False),
        ("test/Loop", True),
        ("test/Missing", False),
    ],
)
def test_only_what_every_server_packs_is_packed(type_: str, expected: bool) -> None:
    fields = {
        "test/Names": {"names": FieldType("string", 0), "values": FieldType("float64", 0)},
        "test/Image": {"header": FieldType("std_msgs/Header"), "data": FieldType("uint8", 0)},
        "test/Octets": {"data": FieldType("byte", 0)},
        "test/Loop": {"inner": FieldType("test/Loop", 0), "data": FieldType("int16", 0)},
        "test/Missing": {"data": FieldType("test/Nowhere")},
    }
    definitions = {**KNOWN, **{name: Definition(name, inside) for name, inside in fields.items()}}
    assert rosbridge._is_packed(type_, definitions) is expected


def test_a_scan_that_was_long_under_way_is_too_old_to_drive_by(make: Make, server: Any, graph: Any) -> None:
    ros = opened(make)
    ros.subscribe("scan", "/scan", "sensor_msgs/LaserScan", stale_after=0.5)
    ros.publish("move", "/cmd_vel")
    until(lambda: graph.listeners and graph.advertised)

    def scanned(seconds_ago: float) -> None:
        stamp = graph.stamp(time.time() - seconds_ago)
        graph.send("/scan", **{**SCAN, "header": {"frame_id": "base", "stamp": stamp}})

    until(lambda: scanned(0) or age(ros, "scan"))
    until(lambda: scanned(30) or (ros.describe("scan").age or 0) > 7)  # the first one may have been late, too
    ros.begin_tick(0.0, 0.1)
    with pytest.raises(NoDataYet, match="old"):
        _ = ros.robot.scan
    assert ros.status.state is ConnectionState.STALE
    ros.robot.move(linear=0.2)
    ros.end_tick(0.0)
    assert 0.2 not in [values["linear"]["x"] for _, values in graph.heard]

    def is_seen() -> bool:
        scanned(0)
        ros.begin_tick(0.1, 0.1)
        try:
            return bool(ros.robot.scan.ranges == (0.5, 1.25, 2.0))
        except NoDataYet:
            return False

    until(is_seen)


def test_a_number_that_is_rarely_sent_does_not_keep_arrays_from_being_packed(
    make: Make, server: Any, graph: Any, clock: Any
) -> None:
    graph.types |= {"/battery": "std_msgs/Float32", "/scan": "sensor_msgs/LaserScan"}
    graph.publishers["/battery"] = ["/base"]
    ros = opened(make)
    ros.subscribe("battery", "/battery")
    until(lambda: server.subscriptions("/battery"))
    clock.now += 3.1
    until(lambda: server.subscriptions("/battery")[-1]["compression"] == "none")
    ros.subscribe("scan", "/scan")
    until(lambda: graph.send("/scan", **SCAN) or age(ros, "scan"))
    assert server.subscriptions("/scan")[0]["compression"] == "cbor"


# -- numbers that are not finite ------------------------------------------------------------------


@pytest.mark.parametrize("packs", [True, False])
def test_nothing_in_reach_is_infinite_whether_the_server_packs_or_writes_a_text(
    make: Make, server: Any, graph: Any, packs: bool
) -> None:
    server.packs = packs
    kinds = {"range": "sensor_msgs/Range", "scan": "sensor_msgs/LaserScan", "far": "std_msgs/Float32"}
    graph.types |= {f"/{name}": type_ for name, type_ in kinds.items()}
    ros = opened(make)
    for name in kinds:
        ros.subscribe(name, f"/{name}")
    until(lambda: len(graph.listeners) == len(kinds))
    graph.send("/range", range=math.inf, max_range=4.0)
    graph.send("/scan", ranges=[1.5, math.inf])
    graph.send("/far", data=-math.inf)
    until(lambda: all(age(ros, name) for name in kinds))
    assert (ros.robot.range.range, ros.robot.range.max_range) == (math.inf, 4.0)
    assert ros.robot.scan.ranges == (1.5, math.inf)
    told = "A number on `/far` is infinite or not a number"
    if packs:
        assert ros.robot.far.data == -math.inf
    else:
        assert math.isnan(ros.robot.far.data)
        until(lambda: any(told in text for text in notices(ros)))
    assert [text for text in notices(ros) if "infinite" in text and not text.startswith(told)] == []


# -- every message --------------------------------------------------------------------------------


def test_every_message_comes_of_topics_of_which_the_program_takes_them_and_the_newest_of_others(
    make: Make, server: Any, graph: Any
) -> None:
    graph.types |= {"/order": "std_msgs/String", "/map": "std_msgs/String"}
    graph.latch("/map", data="a maze")
    ros = opened(make)
    for name in ("order", "map", "light"):
        ros.subscribe(name, f"/{name}")
    until(lambda: len(graph.listeners) == 3 and age(ros, "map"))

    def asked(topic: str) -> tuple[bool, int]:
        last = server.subscriptions(topic)[-1]
        return last["throttle_rate"] > 0, last["queue_length"]

    def tick(*paths: str) -> list[object]:
        ros.begin_tick(0.0, 0.1)
        found = [getattr(ros.robot, path) for path in paths]
        ros.end_tick(0.0)
        return found

    assert asked("/order") == asked("/map") == (True, 1)
    tick()
    ros.take_messages(["order.new", "map.new"])
    until(lambda: asked("/order") == asked("/map") == (False, 0))
    assert asked("/light") == (True, 1)
    for number in range(700):
        graph.send("/order", data=str(number % 3))
    graph.send("/map", data="another maze")
    until(lambda: ros.describe("map").age is not None and ros.robot.map.data == "another maze")
    until(lambda: len(getattr(ros.robot, "order.new")) == 700)
    orders, maps = tick("order.new", "map.new")
    assert orders == tuple(str(number % 3) for number in range(700))
    assert maps == ("another maze",)  # the one that came again with the other subscription is not new
    assert tick("order.new", "map.new") == [(), ()]
    ros.take_messages([])
    until(lambda: asked("/order") == (True, 1))


def test_every_variable_of_a_latched_topic_has_its_message_and_none_counts_it_twice(
    make: Make, server: Any, graph: Any
) -> None:
    graph.types["/map"] = "std_msgs/String"
    graph.latch("/map", data="a maze")
    ros = opened(make)
    ros.take_messages(["map.new", "plan.new"])
    ros.subscribe("map", "/map")
    until(lambda: age(ros, "map"))
    ros.subscribe("plan", "/map")
    until(lambda: age(ros, "plan"))
    assert ros.robot.plan.data == "a maze"
    assert ros.robot.plan == ros.robot.map
    assert (getattr(ros.robot, "map.new"), getattr(ros.robot, "plan.new")) == (("a maze",), ())
    assert ros.describe("plan.age").name == "plan.age"


PEOPLE = """(var seen := [[]]) (var kept := [None])
(machine m (state s (running
  [seen.append((robot.person.new, robot.person.age, robot.guest.new, robot.guest.age))]
  [kept = robot.guest.data.age])))
(spawn m s)"""


def test_a_field_of_the_message_is_preferred_and_the_rest_is_beside_a_reading_called_data(
    make: Make, server: Any, graph: Any
) -> None:
    person = Definition("test/Person", {"name": FieldType("string"), "age": FieldType("uint8")})
    graph.definitions[person.type] = person
    graph.types |= {"/person": person.type}
    ros = opened(make)
    ros.subscribe("person", "/person")
    ros.subscribe("guest.data", "/person")
    until(lambda: ros.describe("person").type == "Person")
    with Session(PEOPLE, bridge=ros, clock=VirtualClock()) as session:
        session.run(0.1)
        assert session.variables["seen"] == []  # the age of a person who has not come is not known
        until(lambda: [each["throttle_rate"] for each in server.subscriptions("/person")][-1:] == [0])
        graph.send("/person", name="Ada", age=36)
        until(lambda: age(ros, "person") and age(ros, "guest.data"))
        session.run(0.1)
        ((new, years, guests, seconds),) = session.variables["seen"]
        assert [(each.name, each.age) for each in new] == [("Ada", 36)]
        assert (guests, years, session.variables["kept"]) == (new, 36, 36)
        assert 0 <= seconds < 1000
        waiting = [issue.message for issue in session.issues]
        assert waiting == ["`robot.person` has no data yet.", "`robot.guest.data` has no data yet."]
        fields = [field.name for field in ros.describe("person").fields]
        assert fields == ["person.name", "person.age", "person.new"]
        with pytest.raises(
            AttributeError, match=r"asked of the robot, in a block, .* as in `robot\.order\.new`\.$"
        ):
            _ = ros.robot.guest.data.new


# -- what the server says -------------------------------------------------------------------------


def test_what_is_no_message_is_passed_over_and_one_of_another_type_is_reported(
    make: Make, server: Any, graph: Any
) -> None:
    ros = opened(make)
    ros.subscribe("odom", "/odom")
    until(lambda: len(graph.listeners) == 1)
    status = json.dumps({"op": "status", "level": "error", "msg": "out of paper"})
    none = ("{", "[1, 2]", "7", '{"op": "no such"}', '{"op": "publish", "topic": "/else"}', b"\xff")
    for client in tuple(server.clients):
        for words in (*none, status):
            client.send(words)
    graph.send("/odom", **ODOM)
    until(lambda: age(ros, "odom"))
    assert ros.robot.odom.x == 1.0
    assert any("out of paper" in text for text in notices(ros))
    wrong = "A message on `/odom` is not a `nav_msgs/Odometry`"
    for fields in ({"data": "text"}, {"pose": 3}, {"pose": {"pose": {"position": {"x": "1"}}}}):
        graph.send("/odom", **fields)
        until(lambda: wrong in ros.status.sentence)
        graph.send("/odom", **ODOM)
        until(lambda: ros.status.state is ConnectionState.CONNECTED)
    ros.subscribe("first", "/first", "nav_msgs/Odometry")
    until(lambda: len(graph.listeners) == 2)
    graph.send("/first", data="text")
    until(lambda: "A message on `/first` is not" in ros.status.sentence)
    with pytest.raises(BridgeError, match="A message on `/first` is not a `nav_msgs/Odometry`"):
        _ = ros.robot.first


def test_a_tick_sees_one_world(ros: RosBridge, graph: Any) -> None:
    ros.subscribe("odom", "/odom")
    until(lambda: graph.send("/odom", **ODOM) or age(ros, "odom"))
    ros.begin_tick(0.0, 0.1)
    graph.send("/odom", pose={"pose": {"position": {"x": 9.0}}})
    until(lambda: value(ros, "odom").startswith("x=9") and "x=9.0" in repr(ros.wiring.channels[0].latest))
    assert ros.robot.odom.x == 1.0
    ros.end_tick(0.0)
    assert ros.robot.odom.x == 9.0


# -- commands -------------------------------------------------------------------------------------


def test_a_wrong_field_or_type_is_refused_before_anything_is_sent(ros: RosBridge, graph: Any) -> None:
    ros.publish("move", "/cmd_vel")
    ros.publish("goal", "/goal", "geometry_msgs/Pose")
    move = ros.robot.move
    for wrong, sentence in (
        (lambda: move(linaer_x=0.2), "Did you mean `linear_x`"),
        (lambda: move(lambda msg: msg.linear(x="fast")), r"`msg\.linear\.x` must be a number, not 'fast'"),
        (lambda: move(linear_x=math.nan), "finite"),
        (lambda: move(lambda msg: setattr(msg.angular, "w", 1)), "has no `w`"),
        (lambda: ros.robot.goal(position=1.0), r"`msg\.position` has fields of its own.*`msg\.position\.x`"),
    ):
        with pytest.raises(BridgeError, match=sentence):
            wrong()
    assert graph.heard == []


def test_a_disarmed_robot_gets_a_stop_and_nothing_else_and_closing_stops_it(
    ros: RosBridge, graph: Any
) -> None:
    ros.publish("move", "/cmd_vel")
    ros.disarm()
    ros.robot.move(linear=0.2)
    ros.press("stop")
    until(lambda: graph.heard)
    ros.arm()
    ros.robot.move(linear=0.1)
    until(lambda: speeds(graph)[-1:] == [0.1])
    ros.close()  # the connection goes after the stop
    until(lambda: not graph.advertised)
    assert speeds(graph)[-1] == 0.0
    assert set(speeds(graph)) == {0.0, 0.1}


@pytest.mark.slow
def test_the_stop_button_works_while_the_program_hangs(ros: RosBridge, graph: Any) -> None:
    ros.publish("move", "/cmd_vel")
    let_go, hangs = threading.Event(), threading.Event()
    session = Session(
        "(machine m (state s (running [robot.move(linear=0.2); hangs.set(); let_go.wait()])))(spawn m s)",
        bridge=ros,
        namespace={"let_go": let_go, "hangs": hangs},
    )
    session.start()
    try:
        assert hangs.wait(60)
        # of the watchdog, once; it may come before the program's command
        until(lambda: 0.0 in speeds(graph))
        stopped = len(graph.heard)
        ros.press("stop")
        until(lambda: speeds(graph)[stopped:] == [0.0])
    finally:
        let_go.set()
        session.close()


def test_each_velocity_ends_when_the_program_gives_no_more_of_it(ros: RosBridge, graph: Any) -> None:
    ros.publish("move", "/cmd_vel")
    ros.publish("second.move", "/second", "geometry_msgs/Twist")
    text = """(machine m
        (state both (running [robot.move(linear=0.1)] [robot.second.move(linear=0.2)]))
        (state one (running [robot.second.move(linear=0.2)]))
        (ontime 100 both -> one))
      (spawn m both)"""
    sent = []
    with Session(text, bridge=ros, clock=VirtualClock(), rate=10) as session:
        session.on_tick(lambda: sent.append([each.last_sent.get("linear.x") for each in ros.wiring.channels]))
        session.run(1)
    assert [0.1, 0.2] in sent
    assert sent[-1] == [0.0, 0.2]


def speeds(graph: Any) -> list[float]:
    return [values["linear"]["x"] for topic, values in tuple(graph.heard) if topic == "/cmd_vel"]


def test_a_time_stamp_that_was_not_set_is_the_time_of_sending(make: Make, server: Any, graph: Any) -> None:
    graph.time = lambda: 1_800_000_000.5
    graph.types["/cmd"] = "geometry_msgs/TwistStamped"
    ros = opened(make)
    ros.publish("move", "/cmd")
    move = ros.robot.move
    commands: list[Callable[[], object]] = [
        lambda: move(linear=0.2),
        lambda: move(lambda msg: msg.header(frame_id="base")),
        lambda: move(lambda msg: msg.header.stamp(secs=3)),
        lambda: move(header={"stamp": {"secs": 0}}),
    ]
    for number, command in enumerate(commands, 1):
        command()
        until(lambda number=number: len(graph.heard) == number)  # a command that waits too long is not sent
    stamps = [values["header"]["stamp"] for _, values in graph.heard]
    now = {"secs": 1_800_000_000, "nsecs": 500_000_000}
    assert stamps == [now, now, {"secs": 3, "nsecs": 0}, {"secs": 0, "nsecs": 0}]


@pytest.mark.parametrize("rosapi", [True, False])
def test_in_a_simulation_it_is_the_time_of_that(
    make: Make, serve: Callable[..., Any], ros2: Any, rosapi: bool
) -> None:
    server = serve(rosapi=rosapi)
    ros = opened(make, port=server.port, sim_time=True)
    ros.publish("move", "/cmd", "geometry_msgs/TwistStamped")
    until(lambda: ros2.send("/clock", clock={"sec": 7, "nanosec": 5}) or ros.world_time() == 7.000000005)
    ros.robot.move(linear=0.2)
    stamp = until(lambda: ros2.heard)[0][1]["header"]["stamp"]
    assert tuple(stamp.values()) == (7, 5)


def test_no_error_is_left_in_the_log_of_the_robot(make: Make, server: Any, graph: Any) -> None:
    ros = opened(make)
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel")
    ros.robot.move(linear=0.2)
    until(lambda: len(server.asked("topics")) > 1 and graph.heard)
    ros.close()
    until(lambda: not server.clients)
    assert server.log == []


def test_another_node_that_commands_is_told_once_and_shown_in_the_panel(
    make: Make, server: Any, graph: Any
) -> None:
    graph.publishers["/cmd_vel"] = ["/teleop"]
    ros = opened(make)
    ros.publish("move", "/cmd_vel")
    until(lambda: any("`/teleop` publishes on `/cmd_vel`" in text for text in notices(ros)))
    assert "also published by /teleop" in value(ros, "move")
    asked = len(server.asked("topics"))
    until(lambda: len(server.asked("topics")) > asked + 1)
    assert len([text for text in notices(ros) if "`/teleop` publishes on `/cmd_vel`" in text]) == 1
    graph.publishers["/cmd_vel"] = ["/teleop", "/nav"]
    until(lambda: any("`/nav` publishes on `/cmd_vel`" in text for text in notices(ros)))
    graph.publishers["/cmd_vel"] = []
    until(lambda: "also published" not in value(ros, "move"))


def test_another_client_of_the_same_server_that_commands_is_told(
    make: Make, server: Any, graph: Any, clock: Any
) -> None:
    ours, theirs = opened(make), opened(make)
    for ros in (ours, theirs):
        ros.publish("move", "/cmd_vel")
    until(lambda: ours.robot.move(linear=0.2) or any(topic == "/cmd_vel" for topic, _ in graph.listeners))
    for _ in range(2):
        ours.robot.move(linear=0.2)
        sent = len(graph.heard)
        theirs.robot.stop()  # as a guard does; a stop replaces an earlier one that is still queued
        until(lambda sent=sent: any(values["linear"]["x"] == 0 for _, values in graph.heard[sent:]))
    assert "also published" not in value(ours, "move")
    until(lambda: theirs.robot.move(linear=-0.1) or "another client of" in value(ours, "move"))
    until(lambda: any("`another client of ws://" in text for text in notices(ours)))

    def is_forgotten() -> bool:
        clock.now += 5.1  # again, where a command was still on its way
        return "also published" not in value(ours, "move")

    until(is_forgotten)


def test_a_stop_does_not_expire_while_it_waits_for_the_network(
    make: Make, graph: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    ros = opened(make)
    ros.publish("move", "/cmd_vel")
    monkeypatch.setattr(websocket, "_FRESH", 0.0)  # whatever has to wait is too late
    ros.robot.move(linear=0.2)
    assert ros.stop_all()
    until(lambda: graph.heard)
    assert [values["linear"]["x"] for _topic, values in graph.heard] == [0.0]


def test_a_guard_says_that_a_stop_could_not_be_sent(make: Make, graph: Any) -> None:
    ros = make(node=GUARD_NODE, setup={"publishers": {"move": {"topic": "/cmd_vel", "type": "no_such/Type"}}})
    ros.open()
    assert not ros.stop_all()
    assert "`robot.move` was not sent" in notices(ros)[-1]
    graph.types["/drive"] = "geometry_msgs/Twist"
    ros.publish("move", "/drive")
    until(ros.stop_all)
    until(lambda: graph.heard)


def test_a_guard_on_the_side_of_the_robot_tries_until_a_stop_is_sent_and_ends_without_one(
    make: Make, server: Any, graph: Any
) -> None:
    side = RosSide("/drive", "", backend="rosbridge", host=f"127.0.0.1:{server.port}")
    try:
        with pytest.raises(BridgeError, match=r"`/drive` does not exist yet"):
            side.stop()
        graph.types["/drive"] = "geometry_msgs/Twist"
        until(lambda: can_stop(side))
        until(lambda: graph.heard)
        heard = len(graph.heard)
    finally:
        side.close()
    until(lambda: not server.clients)
    assert graph.heard[heard:] == []


def test_a_guard_on_the_side_of_the_robot_hears_again_and_again_that_a_program_is_there(
    server: Any, graph: Any
) -> None:
    graph.types["/alive"] = "std_msgs/Empty"
    side = RosSide("", "", "/alive", ["/move_base"], backend="rosbridge", host=f"127.0.0.1:{server.port}")
    try:
        until(lambda: graph.send("/alive") or side.heard[1])
        first, _ = side.heard
        until(lambda: graph.send("/alive") or side.heard[0] > first)
    finally:
        side.close()


def can_stop(side: RosSide) -> bool:
    try:
        side.stop()
    except BridgeError:
        return False
    return True


# -- encryption -----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    return own_certificate(tmp_path_factory.mktemp("certificate"))


@pytest.fixture
def encrypted(serve: Callable[..., Any], certificate: tuple[Path, Path]) -> Any:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(*certificate)
    return serve(encryption=context)


def test_an_encrypted_server_is_spoken_to_encrypted(
    encrypted: Any, make: Make, graph: Any, certificate: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SSL_CERT_FILE", str(certificate[0]))
    ros = opened(make, host=f"wss://127.0.0.1:{encrypted.port}/robot", port=None)
    ros.publish("move", "/cmd_vel")
    ros.robot.move(linear=0.2)
    until(lambda: graph.heard)
    assert ros.address == f"wss://127.0.0.1:{encrypted.port}/robot"


def test_a_certificate_that_is_not_trusted_is_named_with_what_to_do(
    encrypted: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SSL_CERT_FILE", raising=False)
    ros = RosBridge(host=f"wss://127.0.0.1:{encrypted.port}")
    with pytest.raises(BridgeError, match=r"is not trusted: self-signed certificate\..*SSL_CERT_FILE"):
        ros.open()


@pytest.mark.slow
def test_a_server_that_does_not_encrypt_is_not_spoken_to_in_the_clear(server: Any) -> None:
    with pytest.raises(BridgeError, match=r"write `ws://` if it does not encrypt"):
        RosBridge(host=f"wss://127.0.0.1:{server.port}", patience=2).open()
    assert server.requests == []

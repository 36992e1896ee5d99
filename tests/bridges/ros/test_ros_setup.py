"""What is connected to what: from Python, by the panel, from a file; and what is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from bridges.ros.rosbridge_server import MemoryGraph, RosbridgeServer
from hypothesis import given
from hypothesis import strategies as st
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.bridges.ros.address import parse_address
from lrp_jupyter.bridges.ros.setup import MEASURED, Wire, setup_as_dict, setup_from_dict
from lrp_jupyter.errors import BridgeError, NoDataYet, ended

Make = Callable[..., RosBridge]
SETUP = Path(__file__).with_name("follower.json")


def rows(ros: RosBridge) -> dict[str, dict[str, str]]:
    panel = ros.panel()
    assert panel is not None
    table = panel.tables[0]
    return {
        key: dict(zip(table.columns, row, strict=True))
        for key, row in zip(table.keys, table.rows, strict=True)
    }


def fields(ros: RosBridge) -> dict[str, Any]:
    panel = ros.panel()
    assert panel is not None
    return {field.key: field for field in panel.fields}


# -- names ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("variable", "topic", "type_", "sentence"),
    [
        ("my odom", "/odom", "", "not a valid name for a member of `robot`"),
        ("class", "/odom", "", "not a valid name for a member of `robot`"),
        ("_odom", "/odom", "", "not a valid name for a member of `robot`"),
        ("", "/odom", "", "not a valid name for a member of `robot`"),
        ("stop", "/stop", "", "`robot.stop` stops the robot, whatever is connected"),
        ("odom", "/odom//x", "", "not a valid topic name.*Did you mean `/odom/x`"),
        ("odom", "/odom/", "", "Did you mean `/odom`"),
        ("odom", "/my odom", "", "Did you mean `/my/odom`"),
        ("odom", "~/", "", "not a valid topic name"),
        ("odom", "odom/", "", "Did you mean `odom`"),
        ("odom", "/2odom", "", "not a valid topic name"),
        ("odom", "", "", "not a valid topic name"),
        ("move", "/mobile_base/commands.velocity", "", "Did you mean `/mobile_base/commands/velocity`"),
        ("odom", "/odom", "Odometry", "Did you mean `nav_msgs/Odometry`"),
        ("odom", "/odom", "a/b/c", "not a message type"),
    ],
)
def test_an_illegal_name_is_refused_with_a_better_one(
    variable: str, topic: str, type_: str, sentence: str
) -> None:
    with pytest.raises(BridgeError, match=sentence):
        RosBridge().subscribe(variable, topic, type_)


ages = st.sampled_from([MEASURED, None, 0.5])
names = st.text("abcz09", min_size=1, max_size=8).map("n{}".format)
wires = st.builds(
    Wire,
    names.map("v_{}".format),
    st.sampled_from(["subscription", "publisher", "action", "service"]),
    st.builds("{}{}".format, st.sampled_from(["", "/", "~"]), st.lists(names, min_size=1).map("/".join)),
    st.sampled_from(["", "std_msgs/String", "nav_msgs/msg/Odometry"]),
)
wires |= st.builds(Wire, names, st.just("subscription"), names, stale_after=ages)
wires |= st.builds(Wire, names, st.just("publisher"), names, velocity=st.sampled_from([None, True, False]))


@given(st.lists(wires, unique_by=lambda wire: wire.variable))
def test_a_setup_is_the_same_after_a_way_through_json(setup: list[Wire]) -> None:
    again = setup_from_dict(json.loads(json.dumps(setup_as_dict(setup))))
    assert {wire.variable: wire for wire in again} == {wire.variable: wire for wire in setup}


@pytest.mark.parametrize(
    ("setup", "sentence"),
    [
        ([], "is not a set-up"),
        ({"version": 2}, "has version 2, but only version 1"),
        ({"subscription": {}}, "Did you mean `subscriptions`"),
        ({"subscriptions": []}, "must be an object of variables"),
        ({"subscriptions": {"odom": {}}}, r"`subscriptions\.odom`: A `topic` is missing"),
        ({"subscriptions": {"odom": {"topic": "//"}}}, r"`subscriptions\.odom`: .*not a valid topic name"),
        ({"subscriptions": {"odom": {"topic": "/o", "typ": "x"}}}, "Did you mean `type`"),
        ({"subscriptions": {"odom": {"topic": "/o", "type": 3}}}, "must be a string"),
        ({"publishers": {"move": {"topic": "/m", "limits": 3}}}, "`limits` must be an object"),
        ({"publishers": {"move": {"topic": "/m", "limits": {"x": "fast"}}}}, "limit of `x` must be"),
        ({"subscriptions": {"a": {"topic": "/a", "stale_after": 0}}}, "seconds above 0, not 0"),
        ({"subscriptions": {"a": {"topic": "/a", "stale_after": "1"}}}, "seconds above 0, not '1'"),
        ({"publishers": {"a": {"topic": "/a", "stale_after": 1}}}, "There is no `stale_after`"),
        ({"subscriptions": {"a": "/a"}, "publishers": {"a": "/b"}}, "is already a subscription"),
        ({"actions": {"a": "/a"}, "services": {"a": "/b"}}, "is already an action"),
        ({"actions": {"a": {"topic": "/a"}}}, "An `action` is missing"),
        (
            {"actions": {"a": {"action": "/a", "type": "Go"}}},
            "`Go` is not an action type",
        ),
        ({"services": {"a": {"service": "/a", "limits": {}}}}, "There is no `limits`"),
        ({"parameters": {"a": {"parameter": "/a", "type": "b/C"}}}, "There is no `type`, only `parameter`"),
        ({"parameters": {"a": {"parameter": "/a:"}}}, "`/a:` is not a valid parameter name"),
        ({"services": {"a": {"service": "/a:b"}}}, "`/a:b` is not a valid service name"),
        ({"services": {"a": "/a.b"}}, r"not a valid service name.*Did you mean `/a/b`"),
        ({"publishers": {"cancel": "/c"}, "stop": {"cancle": {}}}, "Did you mean `cancel`"),
        ({"publishers": {"cancel": "/c"}, "stop": {"cancel": True}}, "Write the fields of the message"),
        ({"publishers": {"cancel": "/c"}, "stop": []}, "`stop` must be an object of publishers"),
        ({"subscriptions": {"a": "/a"}, "tick": {"a": {}}}, r"`tick\.a`: There is no publisher `a`"),
    ],
)
def test_a_mistake_in_a_setup_is_named_with_its_place(setup: Any, sentence: str) -> None:
    with pytest.raises(BridgeError, match=sentence):
        RosBridge(setup=setup) if isinstance(setup, dict) else setup_from_dict(setup)


def test_what_a_setup_names_is_sent_at_every_stop_and_a_wrong_field_is_refused(
    make: Make, graph: Any
) -> None:
    graph.types["/lamp"] = "std_msgs/Bool"
    stop = {"publishers": {"lamp": "/lamp", "cancel": {"topic": "/cancel", "type": "std_msgs/Empty"}}}
    setup = {**stop, "stop": {"lamp": {"data": False}, "cancel": {}}, "tick": {"cancel": {}}}
    ros = make(setup=setup)
    ros.open()
    assert (ros.setup["stop"], ros.setup["tick"]) == (setup["stop"], setup["tick"])
    assert ros.stop_all()
    until(lambda: ("/cancel", {}) in graph.heard and ("/lamp", {"data": False}) in graph.heard)
    with pytest.raises(BridgeError, match=r"What is to be sent at a stop: .*`msg` has no `dat`"):
        ros.publish("bell", "/lamp", at_stop={"dat": False})
    with pytest.raises(BridgeError, match=r"What is to be sent in a tick: .*`msg` has no `dat`"):
        ros.publish("bell", "/lamp", at_tick={"dat": False})


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(BridgeError, match=r"none\.json cannot be read"):
        RosBridge(setup=tmp_path / "none.json")
    (tmp_path / "bad.json").write_text("{")
    with pytest.raises(BridgeError, match=r"bad\.json is not JSON"):
        RosBridge(setup=tmp_path / "bad.json")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"backend": "rospi"}, "Did you mean `rospy`"),
        ({"host": "a b"}, "is not an address"),
        ({"host": "robot:x"}, "is not an address"),
        ({"port": "0"}, "is not an address"),
        ({"hots": "robot"}, "Did you mean `host`"),
        ({"patience": "long"}, "`patience` takes `inf` or a number, not `long`"),
    ],
)
def test_a_wrong_option_is_refused(options: dict[str, Any], sentence: str) -> None:
    with pytest.raises(BridgeError, match=sentence):
        make_bridge(RosBridge, **options)


@pytest.mark.parametrize("host", ["10.0.0.5:9091", "ws://10.0.0.5:9091/", " 10.0.0.5:9091 "])
def test_an_address_may_be_written_in_several_ways(host: str) -> None:
    ros = RosBridge(host=host)
    assert fields(ros)["address"].value == host.strip()
    ros.answer("host", "10.0.0.6")
    assert fields(ros)["address"].value == "10.0.0.6"


@pytest.mark.parametrize(
    ("host", "port", "url", "shown"),
    [
        (None, None, "ws://127.0.0.1:9090", ""),
        (None, 9091, "ws://127.0.0.1:9091", ""),
        ("turtle.local", None, "ws://turtle.local:9090", "turtle.local:9090"),
        ("turtle.local:1", "2", "ws://turtle.local:2", "turtle.local:2"),
        ("wss://turtle.local:9090", None, "wss://turtle.local:9090", "wss://turtle.local:9090"),
        ("wss://lab.org/robot/3", None, "wss://lab.org:443/robot/3", "wss://lab.org:443/robot/3"),
        ("ws://lab.org/robot?key=x", None, "ws://lab.org:9090/robot?key=x", "ws://lab.org:9090/robot?key=x"),
        ("lab.org/robot", None, "ws://lab.org:9090/robot", "ws://lab.org:9090/robot"),
        ("[::1]:9091", None, "ws://[::1]:9091", "[::1]:9091"),
        ("fe80::a:1", None, "ws://[fe80::a:1]:9090", "[fe80::a:1]:9090"),
        ("wss://[::1]", None, "wss://[::1]:443", "wss://[::1]:443"),
    ],
)
def test_an_address_means_what_is_written(host: str, port: Any, url: str, shown: str) -> None:
    address = parse_address(host, port, 9090)
    assert (address.url, str(address)) == (url, shown)
    if host and port is None:
        assert parse_address(shown, None, 9090) == address


def test_the_address_of_a_master_may_be_written_as_in_the_environment() -> None:
    assert str(parse_address("http://turtle:11311/", None, 11311, ("http",))) == "turtle:11311"
    assert RosBridge(backend="rospy", host="http://turtle:11311").address == "http://turtle:11311"


@pytest.mark.parametrize(
    ("backend", "host", "sentence"),
    [
        ("rosbridge", "http://turtle:9090", "begins with `http://`, but only `ws://` or `wss://`"),
        ("rosbridge", "ftp://turtle", "begins with `ftp://`"),
        ("rosbridge", "me@turtle", "has a user name"),
        ("rosbridge", "wss://me:secret@turtle/x", "has a user name"),
        ("rosbridge", "turtle:70000", "is not an address"),
        ("rosbridge", "ws://", "is not an address"),
        ("rosbridge", "[::1", "is not an address"),
        ("rosbridge", "turtle#1", "is not an address"),
        ("rospy", "ws://turtle:11311", "begins with `ws://`, but only `http://`"),
        ("rospy", "http://turtle:11311/x", "has a path"),
    ],
)
def test_an_address_that_cannot_be_connected_to_is_refused(backend: str, host: str, sentence: str) -> None:
    with pytest.raises(BridgeError, match=sentence):
        RosBridge(backend=backend, host=host)


def test_a_subscription_may_say_when_it_is_too_old_to_drive_by() -> None:
    setup = {"subscriptions": {"scan": {"topic": "/scan", "stale_after": 0.5}}}
    assert setup_as_dict(setup_from_dict(setup))["subscriptions"] == setup["subscriptions"]
    ros = RosBridge()
    ros.subscribe("scan", "/scan", stale_after=0.5)
    assert ros.setup["subscriptions"] == setup["subscriptions"]


# -- from Python ----------------------------------------------------------------------------------


def test_what_is_connected_before_opening_is_there_after_it(make: Make, graph: Any) -> None:
    ros = make()
    ros.subscribe("light", "/light")
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    ros.open()
    assert dir(ros.robot) == ["light", "move", "stop"]
    until(lambda: graph.listeners)
    graph.send("/light", data=7)
    until(lambda: ros.describe("light").age is not None)
    assert ros.robot.light.data == 7


def test_the_type_of_a_live_topic_is_filled_in(ros: RosBridge) -> None:
    ros.subscribe("odom", "/odom")
    assert rows(ros)["odom"]["type"] == "nav_msgs/Odometry"
    assert "odom.theta" in [field.name for field in ros.describe("odom").fields]


def test_a_topic_that_does_not_exist_yet_is_waited_for(ros: RosBridge, graph: Any) -> None:
    assert "No topic is connected: name some in a set-up (`setup=robot.json`)" in ros.status.sentence
    ros.subscribe("far", "/far")
    ros.publish("horn", "/horn")
    assert ros.status.state is ConnectionState.WAITING
    with pytest.raises(NoDataYet):
        _ = ros.robot.far
    with pytest.raises(BridgeError, match="`/horn` does not exist yet"):
        ros.robot.horn(data=True)
    graph.types |= {"/far": "std_msgs/Float32", "/horn": "std_msgs/Bool"}
    until(lambda: any(topic == "/far" for topic, _ in graph.listeners) and "/horn" in graph.advertised)
    graph.send("/far", data=0.5)
    until(lambda: ros.status.state is ConnectionState.CONNECTED)
    assert ros.robot.far.data == 0.5
    ros.robot.horn(data=True)
    until(lambda: ("/horn", {"data": True}) in graph.heard)


@pytest.mark.parametrize(
    ("written", "meant"),
    [("/robot1/light", "/light"), ("/robot1/state_of_it", ""), ("/floor_light", "/light")],
)
def test_a_topic_in_another_namespace_is_meant_before_one_that_is_spelled_alike(
    ros: RosBridge, graph: Any, written: str, meant: str
) -> None:
    graph.types |= {"/robot1/lrp/light_switch": "std_msgs/String", "/robot1/odd": "std_msgs/String"}
    until(lambda: "/robot1/odd" in ros.topics)
    ros.subscribe("light", written)
    hint = f" Did you mean `{meant}`?" if meant else ""
    until(lambda: f"`{written}` does not exist yet, and its type is not known.{hint}" in ros.status.sentence)
    assert bool(meant) == ("Did you mean" in ros.status.sentence)


def test_who_waited_for_a_connection_finds_the_status_that_belongs_to_it(
    ros: RosBridge, monkeypatch: pytest.MonkeyPatch
) -> None:
    link = ros.wiring.link
    assert link is not None
    report, answered = link._report_change, []

    def watched(state: ConnectionState, sentence: str) -> None:
        answered.extend(channel.answered.is_set() for channel in ros.wiring.channels if "horn" in sentence)
        report(state, sentence)

    monkeypatch.setattr(link, "_report_change", watched)
    ros.publish("horn", "/horn")
    assert "`/horn` does not exist yet" in ros.status.sentence
    assert answered[0] is False


def test_the_same_subscription_again_is_not_a_second_one(ros: RosBridge, graph: Any) -> None:
    for _ in range(10):
        ros.subscribe("odom", "/odom")
    until(lambda: len(graph.listeners) == 1)
    member = ros.describe("odom")
    assert member.type == "Odometry"


def test_two_variables_on_one_topic_share_it(ros: RosBridge, graph: Any) -> None:
    ros.subscribe("odom", "/odom")
    ros.subscribe("also", "/odom")
    until(lambda: graph.listeners and rows(ros)["also"]["value"] == "no data yet")
    assert len(graph.listeners) == 1
    ros.remove("odom")
    graph.send("/odom", pose={"pose": {"position": {"x": 3.0}}})
    until(lambda: ros.describe("also").age is not None)
    assert ros.robot.also.x == 3.0
    ros.remove("also")
    until(lambda: not graph.listeners)


def test_a_removed_variable_is_gone(ros: RosBridge, graph: Any) -> None:
    ros.subscribe("odom", "/odom")
    ros.remove("odom")
    until(lambda: not graph.listeners)
    assert dir(ros.robot) == ["stop"]
    with pytest.raises(BridgeError, match="`odom` is connected to nothing"):
        ros.remove("odom")


def test_of_two_names_that_exclude_each_other_the_second_one_is_named(make: Make) -> None:
    ros = make(setup={"subscriptions": {"tf": "/tf", "tf.odom": "/odom"}})
    with pytest.raises(BridgeError, match=r"`robot\.tf\.odom` cannot be connected: `tf` is already a member"):
        ros.open()


def test_a_refused_change_leaves_what_was_there(ros: RosBridge, graph: Any) -> None:
    ros.subscribe("odom", "/odom")
    with pytest.raises(BridgeError, match="carries `std_msgs/UInt8`"):
        ros.subscribe("odom", "/light", "nav_msgs/Odometry")
    assert rows(ros)["odom"]["topic"] == "/odom"
    until(lambda: [topic for topic, _ in graph.listeners] == ["/odom"])


def test_a_publisher_that_is_removed_stops_what_it_moved(ros: RosBridge, graph: Any) -> None:
    ros.publish("move", "/cmd_vel")
    ros.robot.move(linear=0.2)
    until(lambda: graph.heard)
    ros.publish("move", "/other", "geometry_msgs/Twist")
    until(lambda: graph.heard[-1:] == [("/cmd_vel", ros.nodes.table["move"].standstill().as_dict())])


def test_limits_bring_a_command_back(ros: RosBridge, graph: Any) -> None:
    ros.publish("move", "/cmd_vel", limits={"linear": 0.5})
    ros.robot.move(linear=2.0)
    until(lambda: graph.heard)
    assert graph.heard[0][1]["linear"]["x"] == 0.5
    with pytest.raises(BridgeError, match="Did you mean `linear"):
        ros.publish("move", "/cmd_vel", limits={"liner": 0.5})


def test_velocities_are_watched_by_their_type(ros: RosBridge, graph: Any) -> None:
    ros.publish("drive", "/cmd_vel")
    ros.publish("horn", "/horn", "std_msgs/Bool")
    watched = {node.path: node.velocity for node in ros.nodes.members() if hasattr(node, "velocity")}
    assert watched == {"stop": False, "drive": True, "horn": False}


# -- the file -------------------------------------------------------------------------------------


def test_every_change_is_written_to_the_file_of_the_setup(make: Make, tmp_path: Path) -> None:
    path = tmp_path / "robot.json"
    ros = make()
    ros.save(path)
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel", limits={"linear": (-0.1, 0.5)})
    assert RosBridge(setup=path).setup == ros.setup
    ros.remove("odom")
    assert json.loads(path.read_text()) == {
        "version": 1,
        "subscriptions": {},
        "publishers": {"move": {"topic": "/cmd_vel", "limits": {"linear": [-0.1, 0.5]}}},
    }
    assert [file.name for file in tmp_path.iterdir()] == ["robot.json"]


def test_a_setup_is_an_answer_too(ros: RosBridge, graph: Any) -> None:
    ros.subscribe("old", "/odom")
    ros.answer("setup", str(SETUP))
    until(lambda: rows(ros)["light"]["value"] == "no data yet")
    assert sorted(rows(ros)) == ["bumper", "light", "move", "odom"]
    assert "old" not in dir(ros.robot)


# -- the panel ------------------------------------------------------------------------------------


def test_the_panel_shows_every_connection_with_rate_age_and_value(
    ros: RosBridge, graph: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 100.0
    monkeypatch.setattr("lrp_jupyter.bridges.ros.clock.time", SimpleNamespace(monotonic=lambda: now))
    ros.subscribe("light", "/light")
    ros.publish("move", "/cmd_vel")
    assert rows(ros)["light"]["value"] == "no data yet"
    until(lambda: graph.listeners)
    for value in range(5):
        now += 0.1
        graph.send("/light", data=value)
        until(lambda: rows(ros)["light"]["value"] == str(value))  # noqa: B023
    now += 0.5
    light = rows(ros)["light"]
    assert (float(light["rate (Hz)"]), float(light["age (s)"])) == (10, 0.5)
    now += 1
    assert (rows(ros)["light"]["rate (Hz)"], rows(ros)["light"]["age (s)"]) == ("", "1.5"), "they have ceased"
    ros.robot.move(linear=0.2)
    assert rows(ros)["move"]["value"] == "linear.x=0.2"
    assert rows(ros)["move"]["direction"] == "publisher"
    ros.robot.stop()
    assert rows(ros)["move"]["value"].startswith("linear.x=0, linear.y=0")


def test_picking_a_topic_fills_in_its_type(ros: RosBridge) -> None:
    ros.press("pick", row="/odom")
    draft = {key: field.value for key, field in fields(ros).items()}
    assert (draft["variable"], draft["topic"], draft["type"]) == ("odom", "/odom", "nav_msgs/Odometry")
    assert fields(ros)["topic"].choices == ("/cmd_vel", "/light", "/odom")


def test_a_picked_name_makes_a_variable_that_is_free_and_legal(ros: RosBridge) -> None:
    ros.subscribe("odom", "/odom")
    for name, variable in (
        ("/odom", "odom"),  # it is that one already
        ("/robot_2/odom", "robot_2_odom"),
        ("/robot/class", "robot_class"),
        ("/class", "class_"),
        ("/base/stop", "base_stop"),
        ("/base/_hidden_", "hidden"),
    ):
        ros.press("pick", row=name)
        assert fields(ros)["variable"].value == variable
        ros.press("action", values={"variable": variable, "topic": name})
        ros.remove(variable)
        ros.subscribe("odom", "/odom")


def test_a_subscription_is_made_by_button_without_waiting(ros: RosBridge, graph: Any) -> None:
    ros.press("subscribe", values={"variable": "light", "topic": "/light", "type": ""})
    until(lambda: rows(ros)["light"]["type"] == "std_msgs/UInt8")
    ros.press("publish", values={"variable": "move", "topic": "/cmd_vel", "type": "geometry_msgs/Twist"})
    until(lambda: "/cmd_vel" in graph.advertised)
    ros.press("remove", row="light")
    assert "light" not in rows(ros)


def test_a_person_chooses_when_a_message_is_too_old(
    ros: RosBridge, graph: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 100.0
    monkeypatch.setattr("lrp_jupyter.bridges.ros.clock.time", SimpleNamespace(monotonic=lambda: now))
    ros.press("subscribe", values={"variable": "light", "topic": "/light", "stale_after": "0,3"})
    assert ros.setup["subscriptions"]["light"]["stale_after"] == 0.3
    assert fields(ros)["stale_after"].value == "", "it is not kept for the next one"
    until(lambda: graph.listeners)
    assert rows(ros)["light"]["type"] == "std_msgs/UInt8"
    graph.send("/light", data=7)
    until(lambda: rows(ros)["light"]["value"] == "7")
    for age, is_stale in ((0.2, False), (0.2, True)):
        now += age
        ros.begin_tick(0.0, 0.1)
        ros.end_tick(0.0)
        assert (ros.status.state is ConnectionState.STALE) is is_stale
    assert "`robot.light`" in ros.status.sentence
    for late, said, shown in (("0.5", 0.5, "0.5"), ("never", None, "never")):
        ros.press("subscribe", values={"variable": "light", "topic": "/light", "stale_after": late})
        assert ros.setup["subscriptions"]["light"]["stale_after"] == said
        assert rows(ros)["light"]["too old after (s)"] == shown
    ros.press("subscribe", values={"variable": "light", "topic": "/light", "stale_after": ""})
    assert "stale_after" not in ros.setup["subscriptions"]["light"], "it is measured"


def test_what_cannot_be_connected_is_reported_in_its_row(ros: RosBridge) -> None:
    ros.press("subscribe", values={"variable": "light", "topic": "/light", "type": "std_msgs/String"})
    until(lambda: "carries `std_msgs/UInt8`" in rows(ros)["light"]["value"])
    assert "carries" in ros.status.sentence


@pytest.mark.parametrize(
    ("key", "row", "values", "sentence"),
    [
        ("subscribe", "", {"variable": "", "topic": "/odom"}, "not a valid name"),
        ("subscribe", "", {"variable": "odom", "topic": ""}, "not a valid topic name"),
        ("publish", "", {"variable": "move", "topic": "/m", "type": "Twist"}, "geometry_msgs/Twist"),
        ("publish", "", {"variable": "move", "topic": "/m", "stale_after": "1"}, "is for subscriptions"),
        ("subscribe", "", {"variable": "odom", "topic": "/o", "stale_after": "soon"}, "must be a number"),
        ("subscribe", "", {"variable": "odom", "topic": "/o", "stale_after": "-1"}, "a number of seconds"),
        ("remove", "nothing", {}, "connected to nothing"),
        ("save", "", {}, "Name one"),
        ("jump", "", {}, "no button `jump`"),
    ],
)
def test_a_button_that_cannot_be_pressed_explains_why(
    ros: RosBridge, key: str, row: str, values: dict[str, str], sentence: str
) -> None:
    with pytest.raises(BridgeError, match=sentence):
        ros.press(key, row, values)


def test_the_panel_saves_the_setup(ros: RosBridge, tmp_path: Path) -> None:
    ros.subscribe("odom", "/odom")
    ros.press("save", values={"setup": str(tmp_path / "robot.json")})
    assert fields(ros)["setup"].value == str(tmp_path / "robot.json")
    assert RosBridge(setup=tmp_path / "robot.json").setup == ros.setup


def test_another_address_is_connected_in_the_background(ros: RosBridge, graph: Any) -> None:
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel")
    other_graph = MemoryGraph(graph.definitions)
    other_graph.types, other_graph.others = graph.types, graph.others
    other = RosbridgeServer(other_graph)
    try:
        ros.answer("host", f"127.0.0.1:{other.port}")
        until(lambda: other_graph.listeners and other_graph.advertised)
        until(lambda: not graph.listeners)
        other_graph.send("/odom", pose={"pose": {"position": {"x": 4.0}}})
        until(lambda: ros.status.state is ConnectionState.CONNECTED)
        assert ros.robot.odom.x == 4.0
        ros.robot.move(linear=0.1)
        until(lambda: other_graph.heard)
    finally:
        ros.close()
        other.close()


def test_an_address_that_is_none_is_refused(ros: RosBridge) -> None:
    with pytest.raises(BridgeError, match="is not an address"):
        ros.answer("host", "where?")
    with pytest.raises(BridgeError, match="has no option `colour`"):
        ros.answer("colour", "red")


@pytest.mark.parametrize(
    ("reason", "sentence"),
    [("it is lost", "it is lost."), ("It is lost.", "It is lost."), ("Or `b`?", "Or `b`?")],
)
def test_a_sentence_ends_once(reason: str, sentence: str) -> None:
    assert ended(reason) == sentence


def test_arming_names_what_every_stop_reaches_and_what_goes_on(make: Make) -> None:
    wires = {"move": {"topic": "/cmd_vel", "type": "geometry_msgs/Twist"}}
    ros = make(setup={"publishers": wires})
    ros.open()
    plain = ros.failsafe
    ros.connect(Wire("goal", "publisher", "/move_base_simple/goal", "geometry_msgs/PoseStamped"), wait=False)
    ros.connect(Wire("lamp", "publisher", "/lamp", "std_msgs/Bool"), wait=False)
    said = (
        " Every stop is a velocity of zero on `/cmd_vel`:"
        " what was sent to `/move_base_simple/goal` or `/lamp` and has begun goes on."
    )
    assert ros.failsafe == plain + said
    ros.arm()
    assert ros.safety.notices[-1].text.endswith(said)
    ros.remove("move")
    assert ros.failsafe.endswith(
        " No stop is sent: what was sent to `/move_base_simple/goal` or `/lamp` and has begun goes on."
    )
    ros.connect(Wire("drive_to", "action", "/move_base", "move_base_msgs/MoveBase"), wait=False)
    ros.connect(Wire("lamp", "publisher", "/lamp", "std_msgs/Bool", at_stop={"data": False}), wait=False)
    assert ros.failsafe.endswith(
        " Every stop cancels the goals of `/move_base` and sends what the set-up says on `/lamp`:"
        " what was sent to `/move_base_simple/goal` and has begun goes on."
    )

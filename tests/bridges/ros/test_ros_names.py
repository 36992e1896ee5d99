"""What names in a set-up mean to a node with a name of its own, a namespace and remapping rules."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.ros import rclpy_stand_in
from hypothesis import given
from hypothesis import strategies as st
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.bridges.ros.arguments import bridge_options, split_arguments
from lrp_jupyter.bridges.ros.names import GraphNames
from lrp_jupyter.errors import BridgeError

words = st.sampled_from(["a", "b", "odom"])
paths = st.lists(words, min_size=1, max_size=2).map("/".join)
names = st.builds("{}{}".format, st.sampled_from(["", "/", "~"]), paths)
namespaces = paths.map("/{}".format) | st.just("/")
RELATIVE = {
    "subscriptions": {"odom": {"topic": "odom"}},
    "publishers": {"move": {"topic": "cmd_vel", "type": "geometry_msgs/Twist"}},
}


# -- the names alone ------------------------------------------------------------------------------


@pytest.mark.ros
@given(names, namespaces, st.dictionaries(names, names, max_size=3))
def test_names_mean_what_they_mean_to_ros(
    ros_home: Any, name: str, namespace: str, rules: dict[str, str]
) -> None:
    from rosgraph.names import resolve_name

    node = f"{namespace.rstrip('/')}/me"
    resolved = {resolve_name(old, node): resolve_name(new, node) for old, new in rules.items()}
    for written in (rules, ", ".join(f"{old}:={new}" for old, new in rules.items())):
        assert GraphNames("me", namespace, written).resolve(name) == resolve_name(name, node, resolved)


def test_the_namespace_is_that_of_the_environment_and_private_names_are_written_in_both_ways(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "/robot1/")
    here = GraphNames("me", None, ["~/odom:=other"])
    assert (here.full, here.resolve("~odom"), here.resolve("~/x")) == (
        "/robot1/me",
        "/robot1/other",
        "/robot1/me/x",
    )
    assert GraphNames("me", "/").resolve("odom") == "/odom"
    assert GraphNames().node.startswith("lrp_")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (
            {"node": "/robot1/me"},
            "`node`: `/robot1/me` is not the name of a node.*its place as `namespace`",
        ),
        ({"namespace": "robot 1"}, "`namespace`: `robot 1` is not a namespace. Write one like `/robot1`"),
        ({"remap": "cmd_vel=/x"}, "`cmd_vel=/x` is not a remapping rule. Write `from:=to`"),
        ({"remap": {"cmd_vel": "/x y"}}, "`cmd_vel:=/x y`: `/x y` is not a name in ROS"),
    ],
)
def test_a_mistake_in_an_option_is_named(options: dict[str, Any], sentence: str) -> None:
    with pytest.raises(BridgeError, match=sentence):
        RosBridge(**options)


# -- the arguments of a node ----------------------------------------------------------------------

KNOWN = ("node", "namespace", "host", "remap", "setup", "sim_time")


@pytest.mark.parametrize(
    ("arguments", "options"),
    [
        (  # roslaunch
            "cmd_vel:=/base/cmd_vel __name:=behaviour __log:=/home/a/behaviour-1.log _setup:=robot.json",
            {"node": "behaviour", "remap": "cmd_vel:=/base/cmd_vel", "setup": "robot.json"},
        ),
        (
            "__ns:=/robot1 __master:=http://robot:11311",
            {"namespace": "/robot1", "host": "http://robot:11311"},
        ),
        (  # launch_ros
            "--ros-args --log-level debug --ros-args -r __node:=behaviour -r __ns:=/robot1 -r a:=b -r c:=~/d"
            " -p use_sim_time:=true",
            {"node": "behaviour", "namespace": "/robot1", "sim_time": "true", "remap": "a:=b c:=~/d"},
        ),
        (
            "--ros-args --remap a:=b -- _setup:=x --ros-args --disable-stdout-logs",
            {"remap": "a:=b", "setup": "x"},
        ),
        (  # rules for one of several nodes
            "--ros-args -r __node:=me -r me:a:=b -r other:c:=d -p /robot1/me:setup:=x",
            {"node": "me", "remap": "a:=b", "setup": "x"},
        ),
    ],
)
def test_the_arguments_of_a_node_are_options_of_the_bridge(arguments: str, options: dict[str, str]) -> None:
    mine, ros = split_arguments(["follower", *arguments.split(), "--", "--bridge"])
    assert bridge_options(ros, KNOWN) == options
    if "--ros-args" not in arguments:
        assert mine == ["follower", "--", "--bridge"]


def test_a_file_of_parameters_is_read_for_this_node(tmp_path: Path) -> None:
    path = tmp_path / "launch_params"
    ours, every = {"setup": "robot.json"}, {"use_sim_time": True}
    nodes = {"/**": {"ros__parameters": every}, "robot1": {"me": {"ros__parameters": ours}}}
    path.write_text(json.dumps({**nodes, "/other": {"ros__parameters": {"speed": 1}}}))  # JSON is YAML
    named = ["--ros-args", "-r", "__node:=me", "--params-file", str(path)]
    assert bridge_options(named, KNOWN) == {"node": "me", "sim_time": "true", "setup": "robot.json"}


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ("__nam:=x", "`__nam:=x`: .* Did you mean `__name`?"),
        ("_speed:=1", "`_speed:=1`: The bridge `ros` has no option `speed`"),
        ("--ros-args -p stup:=x", "`-p stup:=x`: .* Did you mean `setup`?"),
        ("--ros-args -r cmd_vel=/x", "`-r cmd_vel=/x`: Write a rule `from:=to`"),
        ("--ros-args -p", "`-p`: After it comes a parameter `name:=value`"),
        ("--ros-args --remop a:=b", "`--ros-args --remop`: .* Did you mean `--remap`?"),
        (
            "--ros-args --params-file nowhere",
            "`--params-file nowhere`: The file cannot be read: No such file",
        ),
    ],
)
def test_a_wrong_argument_of_a_node_is_named(arguments: str, sentence: str) -> None:
    with pytest.raises(BridgeError, match=sentence):
        bridge_options(arguments.split(), KNOWN)


# -- a bridge ---------------------------------------------------------------------------------------


@pytest.mark.usefixtures("guarded")
def test_the_setup_keeps_what_was_written_and_the_robot_and_the_guard_get_what_it_means(
    make: Callable[..., RosBridge], graph: Any, tmp_path: Path
) -> None:
    graph.types |= {"/robot1/odom": "nav_msgs/Odometry", "/base/cmd_vel": "geometry_msgs/Twist"}
    path = tmp_path / "setup.json"
    path.write_text(json.dumps(RELATIVE))
    ros = make(setup=path, namespace="robot1", remap="cmd_vel:=/base/cmd_vel", node="me")
    ros.open()
    ros.stop_all()
    until(lambda: [topic for topic, _ in graph.heard] == ["/base/cmd_vel"])
    ros.publish("say", "~words", "std_msgs/String")
    saved = json.loads(path.read_text())
    assert saved["subscriptions"]["odom"] == {"topic": "odom"}
    assert {name: each["topic"] for name, each in saved["publishers"].items()} == {
        "move": "cmd_vel",
        "say": "~words",
    }
    shown = {row[0]: row[2] for row in ros.panel().tables[0].rows}
    assert shown == {"odom": "/robot1/odom", "move": "/base/cmd_vel", "say": "/robot1/me/words"}
    assert "a velocity of zero on `/base/cmd_vel`" in ros.failsafe
    guard = ros.stopper()
    assert guard is not None
    assert guard.arguments["setup"]["publishers"]["move"]["topic"] == "/base/cmd_vel"
    assert RosBridge(**guard.arguments).names.remappings == {}


def test_static_transforms_are_where_the_remapping_rules_say() -> None:
    frames = {"subscriptions": {"tf": "tf", "fixed": "tf_static"}}
    for rules, topics in (
        ("", ("/robot1/tf", "/robot1/tf_static", "/robot1/tf_static")),
        ("tf:=/tf tf_static:=/tf_static", ("/tf", "/tf_static", "/tf_static")),
        ("/tf_static:=x", ("/robot1/tf", "/robot1/tf_static", "/robot1/tf_static")),
    ):
        ros = RosBridge(namespace="robot1", remap=rules, setup=frames)
        assert tuple(each.wire.topic for each in ros.wiring.all_channels) == topics


def test_a_node_of_ros_2_has_the_name_and_the_namespace(monkeypatch: pytest.MonkeyPatch) -> None:
    graph = rclpy_stand_in.install(monkeypatch)
    bridge = RosBridge("rclpy", node="me", namespace="/robot1", setup=RELATIVE)
    bridge.open()
    ends = {end.topic_name: (end.node_namespace, end.node_name) for end in graph.publishers}
    bridge.close()
    assert ends == dict.fromkeys(("/robot1/cmd_vel", "/rosout"), ("/robot1", "me"))

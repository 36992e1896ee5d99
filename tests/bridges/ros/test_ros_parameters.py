"""Parameters as readings: of a real parameter server, and of the nodes of ROS 2."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from bridges.ros import rclpy_stand_in as stand_in
from support.waiting import until

from lrp_jupyter.bridges.members import MemberError
from lrp_jupyter.bridges.ros import RosBridge, rosapi
from lrp_jupyter.bridges.ros.definitions import HEADERS
from lrp_jupyter.errors import BridgeError, NoDataYet
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session

FAST = """(machine m
  (state slow (running [robot.move(linear=robot.speed / 2)]))
  (state fast)
  (on [robot.speed > 1 and 2 in robot.speed.new] slow -> fast))
(spawn m slow)"""


def value(ros: RosBridge, name: str) -> Any:
    with suppress(NoDataYet):
        return getattr(ros.robot, name)
    return None


def why_missing(ros: RosBridge, name: str) -> str:
    """Why it has no value, once that is known."""

    def sentence() -> str:
        try:
            getattr(ros.robot, name)
        except NoDataYet as error:
            return "" if "is asked for" in str(error) else str(error)
        return ""

    return str(until(sentence))


@pytest.mark.ros
def test_a_program_follows_a_parameter_and_the_run_is_repeated(
    real: Any, connect: Callable[..., RosBridge], tmp_path: Path
) -> None:
    import rosgraph

    server = rosgraph.Master("/tests")
    server.setParam("/max_speed", 0.5)
    server.setParam("/limits", {"wheel": {"left": 1, "right": [1, 2.5]}, "name": "slow", "class": "a"})
    ros = connect()
    ros.parameter("speed", "/max_sped")
    assert why_missing(ros, "speed") == (
        "`robot.speed`: There is no parameter `/max_sped`. Did you mean `/max_speed`?"
    )
    assert "There is no parameter `/max_sped`." in ros.status.sentence
    ros.parameter("speed", "/max_speed")
    ros.parameter("limits", "limits")
    ros.parameter("left", "/limits/wheel/left")
    until(lambda: value(ros, "speed"))
    assert not ros.unreached, "the robot was there"
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    until(lambda: value(ros, "speed") == 0.5 and value(ros, "limits") and value(ros, "left"))
    limits: Any = ros.robot.limits
    assert (limits.wheel.left, limits.wheel.right, limits.name, ros.robot.left) == (1, (1, 2.5), "slow", 1)
    with pytest.raises(MemberError, match=r"`/limits` has no `nam`; .* Did you mean `name`"):
        _ = limits.nam
    with pytest.raises(MemberError, match=r"`robot\.speed` is read from the robot and cannot be assigned"):
        ros.robot.speed = 1.0
    assert ros.setup["parameters"]["speed"] == {"parameter": "/max_speed"}
    assert RosBridge(setup=ros.setup).setup == ros.setup
    rows = {row[0]: (row[1], row[2], row[-1]) for row in ros.panel().tables[0].rows}
    assert rows["speed"] == ("parameter", "/max_speed", "0.5")
    assert {field.name for field in ros.describe("limits").fields} >= {"limits.wheel", "limits.name"}

    path = tmp_path / "run.lrplog"
    with Session(FAST, bridge=ros, rate=20) as session:
        with session.record(path):
            session.start()
            until(lambda: ros.safety.commands and session.frame.tick > 5)
            server.setParam("/max_speed", 2)
            until(lambda: session.frame.active == (("m", "fast"),))
            server.deleteParam("/max_speed")
            assert "There is no parameter `/max_speed`." in why_missing(ros, "speed")
            session.pause()
        assert not session.issues
        tick = session.frame.tick
    again = reproduce(read_recording(path))
    with again.session as session:
        assert again.difference is None
        assert (session.frame.tick, session.frame.active) == (tick, (("m", "fast"),))


# -- ROS 2 ----------------------------------------------------------------------------------------


def follows(ros: RosBridge, put: Callable[[str, Any], None]) -> None:
    """A node `/controller` has the parameters `max_speed` and `wheel-names`."""
    put("max_speed", 0.5)
    put("wheel-names", ["left", "right"])
    ros.parameter("speed", "/controller:max_speed")
    ros.parameter("wheels", "/controller:wheel-names")
    until(lambda: value(ros, "speed") == 0.5 and value(ros, "wheels") == ("left", "right"))
    put("max_speed", 0.25)
    until(lambda: value(ros, "speed") == 0.25)
    for name, sentence in {
        "/controller:max_sped": "There is no parameter `/controller:max_sped`. Did you mean `/c",
        "/controler:max_speed": "There is no node `/controler` with parameters. Did you mean `/controller`?",
        "/max_speed": "In ROS 2, a parameter is one of a node: write `/node:max_speed`.",
    }.items():
        ros.parameter("other", name)
        assert sentence in why_missing(ros, "other")


@pytest.mark.slow
def test_a_node_is_asked_over_rosbridge(
    make: Callable[..., RosBridge], graph: Any, server: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    graph.is_ros2 = True
    graph.definitions |= HEADERS[2]
    known = graph.nodes_parameters["/controller"] = {}
    ros = make()
    ros.open()

    def put(name: str, parameter: Any) -> None:
        field = {"type": 3, "double_value": parameter}
        if isinstance(parameter, list):
            field = {"type": 9, "string_array_value": parameter}
        known[name] = {"bool_value": False, **field}

    follows(ros, put)
    monkeypatch.setattr(rosapi, "_ANSWER", 0.1)
    server.hangs.add("/controller/get_parameters")
    known["max_speed"] = {"type": 3, "double_value": 0.75}

    def asked() -> int:
        return sum(each.get("service") == "/controller/get_parameters" for each in tuple(server.requests))

    before = asked()
    until(lambda: asked() > before + 4)
    assert ros.robot.speed == 0.25, "what is not answered stays as it was"
    server.hangs.clear()
    until(lambda: value(ros, "speed") == 0.75)
    server.rosapi = False
    assert "has no rosapi, which tells the parameters" in why_missing(ros, "speed")


def test_a_node_is_asked_by_rclpy(monkeypatch: pytest.MonkeyPatch) -> None:
    graph, known = stand_in.install(monkeypatch), dict[str, Any]()
    make = stand_in.message_class

    def get(request: Any) -> Any:
        unset = make("rcl_interfaces/ParameterValue")()
        return make("rcl_interfaces/GetParameters_Response")(values=[known.get(*request.names, unset)])

    def names(_request: Any) -> Any:
        listed = make("rcl_interfaces/ListParametersResult")(names=list(known))
        return make("rcl_interfaces/ListParameters_Response")(result=listed)

    def put(name: str, parameter: Any) -> None:
        field = {"type": 3, "double_value": parameter}
        if isinstance(parameter, list):
            field = {"type": 9, "string_array_value": parameter}
        known[name] = make("rcl_interfaces/ParameterValue")(**field)

    graph.services["/controller/get_parameters"] = ("rcl_interfaces/GetParameters", get)
    graph.services["/controller/list_parameters"] = ("rcl_interfaces/ListParameters", names)
    ros = RosBridge(backend="rclpy", patience=60.0)
    ros.open()
    try:
        follows(ros, put)
    finally:
        ros.close()
    assert graph.alive == []


def test_a_parameter_has_no_type() -> None:
    ros = RosBridge()
    with pytest.raises(BridgeError, match="A parameter has no type of messages"):
        ros.press("parameter", values={"variable": "speed", "topic": "/speed", "type": "std_msgs/Bool"})
    ros.press("parameter", values={"variable": "speed", "topic": "speed"})
    assert ros.setup["parameters"] == {"speed": {"parameter": "speed"}}

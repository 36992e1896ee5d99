"""`--bridge ros` without a back end takes what is set, else what answers, and says which."""

from __future__ import annotations

import platform
import re
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.ros import rclpy_stand_in
from support.ports import free_port
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge, backends, client_libraries
from lrp_jupyter.bridges.ros.backends import AUTO, Choice, choose_backend
from lrp_jupyter.errors import BridgeError

VARIABLES = ("ROS_VERSION", "ROS_MASTER_URI", "ROS_DOMAIN_ID")


@pytest.fixture(autouse=True)
def bare(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """An environment in which nothing of ROS is set."""
    if request.node.get_closest_marker("ros") is None:
        for name in VARIABLES:
            monkeypatch.delenv(name, raising=False)


@pytest.fixture
def rclpy(monkeypatch: pytest.MonkeyPatch) -> Any:
    return rclpy_stand_in.install(monkeypatch)


def test_a_named_back_end_is_taken_whatever_is_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_VERSION", "2")
    assert choose_backend("rospy") == Choice("rospy")
    assert str(choose_backend("rospy")) == "rospy"


@pytest.mark.parametrize(
    ("host", "backend"),
    [("ws://10.0.0.5:9091", "rosbridge"), ("wss://turtle.local", "rosbridge"), ("http://10.0.0.5", "rospy")],
)
def test_an_address_with_a_scheme_decides(host: str, backend: str) -> None:
    assert choose_backend(AUTO, host).backend == backend


def test_ros_2_is_taken_where_it_is_set_up(rclpy: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_VERSION", "2")
    assert str(choose_backend(AUTO)) == "rclpy, because ROS 2 is set up in this environment"
    bridge = RosBridge()
    bridge.open()
    status = bridge.status.sentence
    bridge.close()
    assert status.endswith("Back end: rclpy, because ROS 2 is set up in this environment.")


def test_a_domain_of_ros_2_leads_to_dds(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("cyclonedds", reason="The extra `ros2` is missing.")
    assert choose_backend(AUTO, domain=7) == Choice("dds", "a `domain` is named")
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    assert choose_backend(AUTO) == Choice("dds", "`ROS_DOMAIN_ID` is set")


def test_an_installed_ros_2_is_preferred_in_a_domain(rclpy: Any) -> None:
    assert choose_backend(AUTO, domain=7) == Choice("rclpy", "a `domain` is named")


def test_what_is_set_counts_for_this_machine_only(
    rclpy: Any, serve: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_VERSION", "2")
    server = serve()
    assert choose_backend(AUTO, "127.0.0.1", server.port).backend == "rosbridge"


def test_what_is_set_and_cannot_be_imported_is_not_taken(
    serve: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_VERSION", "2")
    server = serve()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("lrp_jupyter.bridges.ros.backends._PORTS", {"rosbridge": server.port, "rospy": 1})
        assert choose_backend(AUTO).backend == "rosbridge"


REMEDIES = {  # by what the system's Python says when it is asked for a library
    "exit 1": {
        "rospy": r"Install it \(Debian 12: `apt install python3-rospy`\), or use the back end `rosbridge`",
        "rclpy": r"Start in a shell with ROS 2 set up .*\), or use the back end `dds`, or `rosbridge`",
    },
    "echo 3 8": {"rospy": r"It is for `.*`, which is Python 3\.8, .* needs 3\.11 or later: .* `rosbridge`"},
    "echo 3 10": {"rclpy": r"It is for `.*`, which is Python 3\.10, .* needs 3\.11 or later: .* `dds`"},
    "echo 3 12": dict.fromkeys(
        ("rospy", "rclpy"), r"`.*/python3` has it: make the .*/python3 -m venv --system-site-packages`"
    ),
}


@pytest.mark.parametrize(
    ("says", "library", "remedy"),
    [(says, library, remedy) for says, each in REMEDIES.items() for library, remedy in each.items()],
)
def test_a_library_of_another_python_is_named_with_what_to_use(
    says: str, library: str, remedy: str, server: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    system = tmp_path / "python3"
    system.write_text(f"#!/bin/sh\n{says}\n")
    system.chmod(0o755)
    client_libraries._version_with.cache_clear()
    monkeypatch.setattr(client_libraries, "_SYSTEM", str(system))
    monkeypatch.setitem(sys.modules, library, None)
    here = (
        rf"this Python \({sys.executable}, {platform.python_version()}\) has no {library} \(.*\)\. {remedy}"
    )
    with pytest.raises(BridgeError, match=here):
        RosBridge(backend=library).open()
    monkeypatch.setenv(
        *{"rospy": ("ROS_MASTER_URI", "http://localhost:11311"), "rclpy": ("ROS_VERSION", "2")}[library]
    )
    monkeypatch.setattr(backends, "_PORTS", {"rosbridge": server.port, "rospy": 1})
    was_set = {"rospy": "`ROS_MASTER_URI` is set", "rclpy": "ROS 2 is set up in this environment"}[library]
    assert re.search(f"^rosbridge, because `.*` answers; {was_set}, but {here}", str(choose_backend(AUTO)))
    client_libraries._version_with.cache_clear()


def test_what_answers_is_taken_and_told(server: Any) -> None:
    bridge = RosBridge(host="127.0.0.1", port=server.port)
    shown = {field.key: field.value for field in bridge.panel().fields}
    assert shown["backend"] == AUTO
    panel = bridge.open()
    assert panel is not None
    shown = {field.key: field.value for field in panel.fields}
    bridge.close()
    why = f"rosbridge, because `ws://127.0.0.1:{server.port}` answers"
    assert shown["backend"] == why
    assert f"Back end: {why}." in shown["status"]


@pytest.mark.slow
def test_where_nobody_answers_each_one_says_why() -> None:
    with pytest.raises(
        BridgeError, match=r"No ROS robot answers\. rosbridge: No rosbridge server .*roslaunch"
    ):
        RosBridge(host="127.0.0.1", port=1, patience=2).open()


def test_a_back_end_that_cannot_be_used_keeps_no_other_one_from_being_asked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def half_installed() -> Any:
        raise BridgeError("The back end `dds` needs two packages.")

    monkeypatch.setattr(backends, "_import_dds", half_installed)
    monkeypatch.setattr(backends, "_is_installed", lambda backend: backend == "dds")
    with pytest.raises(BridgeError) as caught:
        choose_backend(AUTO)
    assert str(caught.value) == (
        "No ROS robot answers. dds: The back end `dds` needs two packages. Not asked, because Python cannot"
        ' import them here: `websockets` (`pip install "lrp-jupyter[ros]"`), `rospy`, `rclpy`.'
    )


@pytest.mark.parametrize("backend", ["rclpy"])
def test_an_address_is_refused_where_robots_are_found_without(backend: str) -> None:
    with pytest.raises(BridgeError, match=f"`{backend}` takes no address.*ROS_DOMAIN_ID"):
        RosBridge(backend=backend, host="10.0.0.5")


def test_a_new_address_is_asked_who_answers_there(server: Any, serve: Callable[..., Any]) -> None:
    bridge = RosBridge(host="127.0.0.1", port=server.port)
    bridge.open()
    other = serve()
    bridge.answer("host", f"127.0.0.1:{other.port}")
    until(lambda: f"because `ws://127.0.0.1:{other.port}` answers" in bridge.connected_by)
    bridge.close()


def test_a_robot_whose_time_is_simulated_is_waited_for_too(serve: Callable[..., Any]) -> None:
    port = free_port()
    bridge = RosBridge(host="127.0.0.1", port=port, patience="inf", sim_time=True)
    opening = threading.Thread(target=bridge.open)
    opening.start()
    until(lambda: "Waiting for the robot: No ROS robot answers" in bridge.status.sentence)
    serve(port)
    opening.join()
    assert "`sim_time` is set, and no time arrives" in bridge.status.sentence
    bridge.close()


@pytest.mark.ros
def test_a_master_is_taken_that_is_set_or_found_at_its_address(real: Any) -> None:
    assert choose_backend(AUTO) == Choice("rospy", "`ROS_MASTER_URI` is set")
    found = choose_backend(AUTO, "127.0.0.1", real.master_port)
    assert found == Choice("rospy", f"`http://127.0.0.1:{real.master_port}` answers")

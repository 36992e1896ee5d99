"""A rosbridge server that cannot be reached, dies, hangs or is slow, and how the bridge reacts."""

from __future__ import annotations

import math
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from support.ports import free_port
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge, link, panel, rosapi, websocket
from lrp_jupyter.errors import BridgeError, NoDataYet
from lrp_jupyter.live.clock import MonotonicClock
from lrp_jupyter.live.session import Session

Make = Callable[..., RosBridge]
ODOM = {"pose": {"pose": {"position": {"x": 1.0, "y": 2.0}, "orientation": {"z": 1.0, "w": 0.0}}}}


@pytest.fixture
def driver(make: Make, wire: Any, graph: Any) -> RosBridge:
    """A bridge over a wire that can be cut, with an odometry and a velocity."""
    ros = make(port=wire.port)
    ros.open()
    ros.arm()
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel")
    until(lambda: graph.listeners and graph.advertised)
    return ros


def fails(ros: RosBridge, name: str, **fields: object) -> str:
    """The sentence with which a reading or a command fails; empty if it does not."""
    try:
        member = getattr(ros.robot, name)
        if fields:
            member(**fields)
    except BridgeError as error:
        return str(error)
    except NoDataYet:
        return ""
    return ""


def hears(ros: RosBridge, graph: Any) -> bool:
    """Whether the odometry arrives, which is sent again."""
    graph.send("/odom", **ODOM)
    return ros.describe("odom").age is not None and not fails(ros, "odom")


def commands(graph: Any) -> list[float]:
    return [values["linear"]["x"] for topic, values in tuple(graph.heard) if topic == "/cmd_vel"]


def notices(ros: RosBridge) -> list[str]:
    return [notice.text for notice in ros.safety.notices if notice.kind == "fault"]


# -- opening --------------------------------------------------------------------------------------


@pytest.fixture
def stranger() -> Iterator[Callable[[bytes], int]]:
    """Servers that do not speak rosbridge."""
    listeners: list[socket.socket] = []
    threads: list[threading.Thread] = []
    over = threading.Event()

    def start(words: bytes) -> int:
        listener = socket.create_server(("127.0.0.1", 0))
        listeners.append(listener)

        def answer() -> None:
            client, _ = listener.accept()
            with client:
                client.sendall(words)
                over.wait()

        threads.append(threading.Thread(target=answer))
        threads[-1].start()
        return int(listener.getsockname()[1])

    yield start
    over.set()
    for listener, thread in zip(listeners, threads, strict=True):
        thread.join()
        listener.close()


@pytest.mark.slow
def test_opening_fails_where_no_rosbridge_server_is_and_says_how_to_start_one(
    stranger: Callable[[bytes], int], make: Make, graph: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        ros = RosBridge("rosbridge", "127.0.0.1", unused.getsockname()[1], patience=2)
        with pytest.raises(
            BridgeError, match=r"No rosbridge server answers at `ws://127\.0\.0\.1.*roslaunch"
        ):
            ros.open()
    assert ros.status.state is ConnectionState.DISCONNECTED
    assert ros.members() == ()
    with pytest.raises(BridgeError, match="is not a rosbridge server"):
        make(port=stranger(b"HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n")).open()
    over = threading.Event()
    graph.topics = over.wait  # asked for its topics, it thinks
    monkeypatch.setattr(rosapi, "_FIRST", 3600.0)  # its end does not wait for that
    try:
        with pytest.raises(BridgeError, match=r"did not answer within 0\.1 s"):
            make(patience=0.1).open()
    finally:
        over.set()
    monkeypatch.setattr(websocket, "_CONNECT", 0.1)
    with pytest.raises(BridgeError, match=r"No rosbridge server answers|does not answer"):
        make(port=stranger(b""), patience=2).open()


def test_a_back_end_that_is_not_installed_names_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "websockets.asyncio.client", None)
    with pytest.raises(BridgeError, match="pip install"):
        RosBridge(backend="rosbridge", host="127.0.0.1").open()


@pytest.mark.parametrize("backend", ["rosbridge", "auto"])
def test_a_server_that_comes_late_is_waited_for(serve: Callable[..., Any], make: Make, backend: str) -> None:
    port, told = free_port(), []
    ros = make(backend=backend, port=port, patience="inf")
    ros.status_listener = told.append
    opening = threading.Thread(target=ros.open)
    opening.start()
    until(lambda: any("Waiting for the robot: No " in status.sentence for status in told))
    assert {status.state for status in told} == {ConnectionState.CONNECTING}
    serve(port)
    opening.join()
    assert ros.is_open


def test_neither_back_end_is_imported_before_the_bridge_is_opened() -> None:
    program = (
        "import sys; from lrp_jupyter.bridges.ros import RosBridge; RosBridge(); RosBridge('rospy');"
        "print([name for name in ('websockets', 'rospy', 'asyncio') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() in ("[]", "['asyncio']")


# -- a server that dies ---------------------------------------------------------------------------


@pytest.mark.slow
def test_a_server_that_was_lost_gets_a_stop_and_no_old_command(
    driver: RosBridge, graph: Any, wire: Any
) -> None:
    def cut() -> None:
        (before,) = graph.listeners
        wire.cut()
        until(lambda: graph.listeners and before not in graph.listeners and graph.advertised)
        until(lambda: driver.status.state is ConnectionState.WAITING)
        with pytest.raises(NoDataYet):
            _ = driver.robot.odom  # what arrived before the loss is no longer a reading

    until(lambda: hears(driver, graph))
    cut()
    assert commands(graph) == [], "it never moved"
    driver.robot.move(linear=0.1)
    until(lambda: commands(graph) == [0.1])
    until(lambda: hears(driver, graph))
    port, wire.target = wire.target, 1
    wire.cut()
    until(lambda: driver.status.state is ConnectionState.LOST)
    until(lambda: "rosbridge server" in fails(driver, "odom"))
    for _ in range(5):
        assert "`robot.move` was not sent: " in fails(driver, "move", linear=0.9)
    wire.target = port
    until(lambda: driver.status.state is not ConnectionState.LOST)
    until(lambda: commands(graph)[-1:] == [0.0])  # first: it may have driven on all the time
    until(lambda: not fails(driver, "move", linear=0.2))
    until(lambda: commands(graph)[-1:] == [0.2])
    assert commands(graph) == [0.1, 0.0, 0.2]
    until(lambda: hears(driver, graph))
    assert driver.robot.odom.x == 1.0
    wire.target = 1
    wire.cut()
    until(lambda: driver.status.state is ConnectionState.LOST)
    program = "(machine m (state s (running [robot.move(linear=0.9)])))(spawn m s)"
    with Session(program, bridge=driver, clock=MonotonicClock(10)) as session:
        session.start()
        until(lambda: session.frame.tick > 20)  # its loop goes on


def test_a_velocity_that_was_connected_elsewhere_during_a_loss_is_ended_where_it_was(
    driver: RosBridge, graph: Any, wire: Any
) -> None:
    driver.robot.move(linear=0.1)
    until(lambda: commands(graph) == [0.1])
    port, wire.target = wire.target, 1
    wire.cut()
    until(lambda: driver.status.state is ConnectionState.LOST)
    driver.publish("move", "/other/cmd_vel", "geometry_msgs/Twist")
    wire.target = port
    until(lambda: commands(graph) == [0.1, 0.0])
    until(
        lambda: (
            [each.wire.topic for each in driver.wiring.all_channels if each.is_velocity] == ["/other/cmd_vel"]
        )
    )


def test_what_is_missing_after_a_loss_is_the_topic_and_no_longer_the_server(
    driver: RosBridge, wire: Any
) -> None:
    driver.subscribe("far", "/far")
    port, wire.target = wire.target, 1
    wire.cut()
    until(lambda: driver.status.state is ConnectionState.LOST)
    wire.target = port
    until(lambda: "`robot.far`: `/far` does not exist yet" in driver.status.sentence)
    assert fails(driver, "far") == ""


def test_a_server_whose_master_dies_is_looked_for_in_steps_until_it_is_back(
    make: Make, graph: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    ros = make()
    ros.open()
    ros.subscribe("odom", "/odom")
    assert ros.wiring.link is not None
    steps: list[tuple[float, bool]] = []
    monkeypatch.setattr(
        ros.wiring.link._changed, "wait_for", lambda holds, seconds: steps.append((seconds, holds()))
    )
    graph.master_is_alive = False
    until(lambda: "its ROS master does not" in ros.status.sentence)
    assert ros.status.state is ConnectionState.LOST
    del steps[:]
    until(lambda: len(steps) > 2)
    assert set(steps) == {(link._AGAIN, False)}, "a connection that ends does not hurry it"
    graph.master_is_alive = True
    until(lambda: ros.status.state is ConnectionState.WAITING)
    until(lambda: hears(ros, graph))
    assert ros.robot.odom.y == 2.0


def test_a_master_that_dies_while_rosapi_does_not_answer_is_noticed(
    make: Make, graph: Any, server: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rosapi, "_ANSWER", 0.1)
    ros = make()
    ros.open()
    ros.subscribe("odom", "/odom")
    until(lambda: ros.topics)
    server.hangs.add("topics")
    until(lambda: any("does not answer" in notice.text for notice in ros.safety.notices))
    graph.master_is_alive = False
    server.hangs.clear()
    until(lambda: ros.status.state is ConnectionState.LOST)
    assert "its ROS master does not" in ros.status.sentence
    assert ros.live == {}, "what was live, actions and services too, is not offered any more"
    graph.master_is_alive = True
    until(lambda: hears(ros, graph))


# -- a server that hangs, or is slow --------------------------------------------------------------


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """All happens ten times sooner than for a user, whatever a loaded machine makes of the round trip."""
    for name, seconds in {"_PING": 0.01, "_STALE": 0.06, "_LOST": 0.4, "_SLOWEST": 0.0}.items():
        monkeypatch.setattr(websocket, name, seconds)


@pytest.mark.usefixtures("quick")
def test_a_server_that_hangs_gets_no_pile_of_commands(
    driver: RosBridge, graph: Any, wire: Any, clock: Any
) -> None:
    driver.robot.move(linear=0.1)
    until(lambda: 0.1 in commands(graph))
    wire.hold()
    clock.was_seen()
    clock.now += 0.05
    clock.was_seen()
    tries = [fails(driver, "move", linear=0.9)]
    assert tries == [""], "nobody could know"
    clock.now += 0.02
    until(lambda: tries.append(fails(driver, "move", linear=0.9)) or tries[-1])
    assert "no longer answers" in tries[-1]
    until(lambda: driver.status.state is ConnectionState.STALE)
    clock.now += 0.3  # it is not given up yet
    clock.was_seen()
    assert driver.status.state is ConnectionState.STALE
    clock.now += 0.1
    until(lambda: driver.status.state is ConnectionState.LOST)
    wire.release()
    until(lambda: driver.status.state is not ConnectionState.LOST)
    until(lambda: commands(graph)[-1:] == [0.0])
    assert commands(graph).count(0.9) <= tries.count("")

    until(lambda: hears(driver, graph))
    wire.hold_after(20)  # half a frame
    graph.send("/odom", **ODOM)
    until(lambda: setattr(clock, "now", clock.now + 0.1) or driver.status.state is ConnectionState.LOST)
    wire.cut()
    until(lambda: driver.status.state is ConnectionState.WAITING)
    until(lambda: hears(driver, graph))


@pytest.mark.usefixtures("quick")
def test_a_large_message_on_its_way_is_a_sign_of_life(
    driver: RosBridge, wire: Any, graph: Any, clock: Any
) -> None:
    """The pong waits behind it, for longer than a server that says nothing would have."""
    graph.types["/text"] = "std_msgs/String"
    driver.subscribe("text", "/text")
    until(lambda: any(topic == "/text" for topic, _ in graph.listeners))
    until(lambda: hears(driver, graph))
    wire.hold_after(1000)
    graph.send("/text", data="x" * 1_500_000)
    for _ in range(10):
        until(lambda: wire.is_held)
        clock.was_seen()
        assert not driver.wiring.link.transport.trouble()  # type: ignore[union-attr]
        clock.now += 0.05
        wire.hold_after(1000)
    wire.hold_after(math.inf)
    until(lambda: driver.describe("text").age is not None)
    assert len(driver.robot.text.data) == 1_500_000
    assert notices(driver) == []


@pytest.mark.slow
def test_a_link_that_is_slow_but_steady_is_told_and_given_more_time(
    driver: RosBridge, wire: Any, graph: Any, clock: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(websocket, "_PING", 0.01)
    monkeypatch.setattr(websocket, "_STALE", 0.03)
    monkeypatch.setattr(websocket, "_LOST", 0.06)
    for module in (link, panel):
        monkeypatch.setattr(module, "SLOW", 0.15)
    wire.delay = 0.1  # each way
    until(lambda: any("is slow: a round trip takes " in text for text in notices(driver)))
    shown = {field.key: field.value for field in driver.panel().fields}["round_trip"]
    assert shown.endswith("ms (slow)")
    driver.robot.move(linear=0.2)
    until(lambda: graph.heard)
    wire.hold()
    clock.was_seen()
    clock.now += 0.3  # less than 2.5 round trips
    clock.was_seen()
    assert not driver.wiring.link.transport.trouble()  # type: ignore[union-attr]
    clock.now += 5.0
    until(lambda: driver.status.state in (ConnectionState.STALE, ConnectionState.LOST))


def test_the_round_trip_of_a_good_link_is_shown_and_not_called_slow(
    driver: RosBridge, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (link, panel):
        monkeypatch.setattr(module, "SLOW", 20.0)  # as a loaded machine may be
    until(lambda: driver.round_trip is not None)
    shown = {field.key: field.value for field in driver.panel().fields}["round_trip"]
    assert shown.endswith(" ms")
    assert not any("slow" in text for text in notices(driver))

"""What can go wrong with a robot over rosbridge, and how the bridge reacts."""

from __future__ import annotations

import json
import math
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from bridges.bounded import bounded
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge, link, rosbridge, websocket
from lrp_jupyter.errors import BridgeError, NoDataYet
from lrp_jupyter.live.session import Session

Make = Callable[..., RosBridge]
ODOM = {"pose": {"pose": {"position": {"x": 1.0, "y": 2.0}, "orientation": {"z": 1.0, "w": 0.0}}}}


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A server that hangs is given up sooner."""
    monkeypatch.setattr(websocket, "_STALE", 0.6)
    monkeypatch.setattr(websocket, "_LOST", 1.0)


@pytest.fixture
def strict(monkeypatch: pytest.MonkeyPatch) -> None:
    """A server that hangs is noticed as by a user, long before it is given up."""
    monkeypatch.setattr(websocket, "_STALE", 0.6)
    monkeypatch.setattr(websocket, "_LOST", 4.0)


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


def fails(ros: RosBridge, name: str, *arguments: object, **fields: object) -> str:
    """The sentence with which a reading or a command fails; empty if it does not."""
    try:
        member = getattr(ros.robot, name)
        if arguments or fields:
            member(*arguments, **fields)
    except BridgeError as error:
        return str(error)
    except NoDataYet:
        return ""
    return ""


def commands(graph: Any) -> list[float]:
    return [values["linear"]["x"] for topic, values in tuple(graph.heard) if topic == "/cmd_vel"]


# -- opening --------------------------------------------------------------------------------------


def test_without_a_server_opening_fails_at_once_and_names_how_to_start_one() -> None:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        ros = RosBridge("rosbridge", "127.0.0.1", unused.getsockname()[1])
        sentence = r"No rosbridge server answers at `ws://127\.0\.0\.1.*roslaunch"
        with bounded(1), pytest.raises(BridgeError, match=sentence):
            ros.open()
    assert ros.status.state is ConnectionState.DISCONNECTED
    assert ros.members() == ()


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
            try:
                client, _ = listener.accept()
            except OSError:
                return
            with client:
                client.sendall(words)
                over.wait(5)

        threads.append(threading.Thread(target=answer))
        threads[-1].start()
        return int(listener.getsockname()[1])

    yield start
    over.set()
    for listener in listeners:
        listener.close()
    for thread in threads:
        thread.join(5)


def test_what_is_not_a_rosbridge_server_is_reported(stranger: Callable[[bytes], int]) -> None:
    port = stranger(b"HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n")
    with pytest.raises(BridgeError, match="is not a rosbridge server"):
        RosBridge("rosbridge", "127.0.0.1", port).open()


def test_a_silent_server_is_not_waited_for(
    stranger: Callable[[bytes], int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(websocket, "_CONNECT", 0.3)
    with bounded(2), pytest.raises(BridgeError, match=r"No rosbridge server answers|does not answer"):
        RosBridge("rosbridge", "127.0.0.1", stranger(b"")).open()


def test_opening_has_an_end_even_if_the_server_only_shakes_hands(make: Make, graph: Any) -> None:
    over = threading.Event()
    graph.topics = over.wait  # asked for its topics, it thinks
    ros = make(patience=0.5)
    try:
        with bounded(4), pytest.raises(BridgeError, match=r"did not answer within 0\.5 s"):
            ros.open()
    finally:
        over.set()


@pytest.mark.parametrize(
    ("backend", "module", "advice"),
    [("rosbridge", "websockets.asyncio.client", r"pip install"), ("rospy", "rospy", r"python3-rospy")],
)
def test_a_back_end_that_is_not_installed_names_what_to_install(
    backend: str, module: str, advice: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(BridgeError, match=advice):
        RosBridge(backend=backend, host="127.0.0.1").open()


def test_neither_back_end_is_imported_before_the_bridge_is_opened() -> None:
    program = (
        "import sys; from lrp_jupyter.bridges.ros import RosBridge; RosBridge(); RosBridge('rospy');"
        "print([name for name in ('websockets', 'rospy', 'asyncio') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() in ("[]", "['asyncio']")


# -- a server that dies ---------------------------------------------------------------------------


def test_a_lost_server_refuses_readings_and_commands_in_a_sentence(
    driver: RosBridge, graph: Any, wire: Any
) -> None:
    graph.send("/odom", **ODOM)
    until(lambda: driver.describe("odom").age is not None)
    wire.target = 1
    wire.cut()
    until(lambda: driver.status.state is ConnectionState.LOST)
    until(lambda: "rosbridge server" in fails(driver, "odom"))
    assert "`robot.move` was not sent: " in fails(driver, "move", linear=0.2)


def test_after_a_reconnect_subscriptions_are_back_and_the_values_new(
    driver: RosBridge, graph: Any, wire: Any
) -> None:
    graph.send("/odom", **ODOM)
    until(lambda: fails(driver, "odom") == "" and driver.describe("odom").age is not None)
    (before,) = graph.listeners
    wire.cut()
    until(lambda: graph.listeners and before not in graph.listeners)
    until(lambda: driver.status.state is ConnectionState.WAITING)
    with pytest.raises(NoDataYet):
        _ = driver.robot.odom  # what arrived before the loss is no longer a reading
    graph.send("/odom", **ODOM)
    until(lambda: driver.status.state is ConnectionState.CONNECTED)
    assert driver.robot.odom.x == 1.0


def test_nothing_that_was_commanded_without_a_connection_is_sent_later(
    driver: RosBridge, graph: Any, wire: Any
) -> None:
    driver.robot.move(linear=0.1)
    until(lambda: commands(graph) == [0.1])
    port, wire.target = wire.target, 1
    wire.cut()
    until(lambda: driver.status.state is ConnectionState.LOST)
    for _ in range(5):
        assert fails(driver, "move", linear=0.9)
    wire.target = port
    until(lambda: fails(driver, "move", linear=0.2) == "")
    until(lambda: commands(graph)[-1:] == [0.2])
    assert commands(graph) == [0.1, 0.0, 0.2]  # stopped first: it may have driven on all the time


def test_a_robot_that_never_moved_is_not_told_to_stop_after_a_reconnect(
    driver: RosBridge, graph: Any, wire: Any
) -> None:
    (before,) = graph.listeners
    wire.cut()
    until(lambda: graph.listeners and before not in graph.listeners and graph.advertised)
    until(lambda: driver.status.state is ConnectionState.WAITING)
    assert commands(graph) == []


@pytest.mark.usefixtures("strict")
def test_a_server_that_hangs_gets_no_pile_of_commands(driver: RosBridge, graph: Any, wire: Any) -> None:
    until(lambda: not fails(driver, "move", linear=0.1))
    until(lambda: 0.1 in commands(graph))
    wire.hold()
    tries = [""]
    with bounded(2):
        until(lambda: tries.append(fails(driver, "move", linear=0.9)) or tries[-1])
    assert "no longer answers" in tries[-1]
    sent = tries.count("") - 1  # in the first moment, before anybody could know
    until(lambda: driver.status.state is ConnectionState.LOST or not fails(driver, "move", linear=0.9))
    assert driver.status.state is ConnectionState.LOST
    wire.release()
    until(lambda: driver.status.state is not ConnectionState.LOST)
    until(lambda: commands(graph)[-1:] == [0.0])
    assert commands(graph).count(0.9) <= sent


@pytest.mark.usefixtures("impatient")
def test_half_a_frame_is_a_loss_and_the_bridge_comes_back(driver: RosBridge, graph: Any, wire: Any) -> None:
    wire.hold_after(20)
    graph.send("/odom", **ODOM)
    until(lambda: driver.status.state is ConnectionState.LOST)
    wire.cut()
    until(lambda: driver.status.state is ConnectionState.WAITING)
    until(
        lambda: (
            graph.send("/odom", **ODOM)
            or (driver.describe("odom").age is not None and not fails(driver, "odom"))
        )
    )


def test_the_loop_keeps_its_rate_while_the_server_is_gone(driver: RosBridge, graph: Any, wire: Any) -> None:
    session = Session(
        "(machine m (state s (running [robot.move(linear=0.2)])))(spawn m s)", bridge=driver, rate=50
    )
    session.start()
    try:
        until(lambda: 0.2 in commands(graph))
        wire.target = 1
        wire.cut()
        until(lambda: driver.status.state is ConnectionState.LOST)
        first = session.frame.tick
        with bounded(2):
            until(lambda: session.frame.tick >= first + 50)
    finally:
        session.close()


def test_a_server_whose_master_dies_is_lost_until_the_master_is_back(
    make: Make, graph: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rosbridge.RosbridgeTransport, "period", 0.1)
    ros = make()
    ros.open()
    ros.subscribe("odom", "/odom")
    graph.master_is_alive = False
    until(lambda: "its ROS master does not" in ros.status.sentence)
    assert ros.status.state is ConnectionState.LOST
    graph.master_is_alive = True
    until(lambda: ros.status.state is ConnectionState.WAITING)
    until(lambda: graph.send("/odom", **ODOM) or ros.describe("odom").age is not None)
    assert ros.robot.odom.y == 2.0


def test_a_robot_that_stays_lost_is_looked_for_in_steps(
    make: Make, graph: Any, server: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    ros = make()
    ros.open()
    until(lambda: ros.topics)
    monkeypatch.setattr(link, "_AGAIN", 60.0)
    graph.master_is_alive = False
    until(lambda: ros.status.state is ConnectionState.LOST)
    until(lambda: not server.clients)
    asked = len(server.asked("topics"))
    assert ros.wiring.link is not None
    ros.wiring.link.transport.changed()  # as when a connection ends
    threading.Event().wait(0.2)
    assert len(server.asked("topics")) == asked


# -- what the server says -------------------------------------------------------------------------


def test_what_is_not_a_message_is_passed_over(driver: RosBridge, server: Any, graph: Any) -> None:
    for client in server.clients:
        for words in (
            "{",
            "[1, 2]",
            "7",
            '{"op": "no such"}',
            '{"op": "publish", "topic": "/else"}',
            b"\xff",
        ):
            client.send(words)
    graph.send("/odom", **ODOM)
    until(lambda: driver.describe("odom").age is not None)
    assert driver.robot.odom.x == 1.0


@pytest.mark.parametrize(
    "words", [{"data": "text"}, {"pose": 3}, {"pose": {"pose": {"position": {"x": "1"}}}}]
)
def test_a_message_of_another_type_is_reported_with_its_topic(
    driver: RosBridge, graph: Any, words: dict[str, Any]
) -> None:
    graph.send("/odom", **words)
    until(lambda: "A message on `/odom` is not a `nav_msgs/Odometry`" in fails(driver, "odom"))
    graph.send("/odom", **ODOM)
    until(lambda: not fails(driver, "odom"))


def test_what_the_server_complains_about_is_shown(driver: RosBridge, server: Any) -> None:
    for client in server.clients:
        client.send(json.dumps({"op": "status", "level": "error", "msg": "out of paper"}))
    until(lambda: any("out of paper" in notice.text for notice in driver.safety.notices))


def test_null_is_what_json_has_for_nan(ros: RosBridge, graph: Any) -> None:
    graph.types["/far"] = "std_msgs/Float32"
    ros.subscribe("far", "/far", "std_msgs/Float32")
    until(lambda: any(topic == "/far" for topic, _ in graph.listeners))
    graph.send("/far", data=None)
    until(lambda: ros.describe("far").age is not None)
    assert math.isnan(ros.robot.far.data)


def test_without_rosapi_the_common_types_work_and_others_are_refused(
    serve: Callable[..., Any], make: Make, graph: Any
) -> None:
    ros = make(port=serve(rosapi=False).port)
    ros.open()
    ros.arm()
    assert any("has no rosapi" in notice.text for notice in ros.safety.notices)
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    ros.robot.move(linear=0.2)
    until(lambda: commands(graph) == [0.2])
    with pytest.raises(BridgeError, match="no message type `my_msgs/Thing`"):
        ros.subscribe("thing", "/thing", "my_msgs/Thing")
    assert ros.panel() is not None


def test_a_ros_2_server_is_spoken_to_in_its_own_names(make: Make, graph: Any) -> None:
    graph.is_ros2 = True
    graph.types["/odom"] = "nav_msgs/msg/Odometry"
    ros = make()
    ros.open()
    ros.arm()
    asked = []
    plain = graph.subscribe

    def subscribe(topic: str, type_: str, receive: Any) -> object:
        asked.append(type_)
        return plain(topic, type_, receive)

    graph.subscribe = subscribe
    ros.subscribe("odom", "/odom", "nav_msgs/msg/Odometry")
    until(lambda: asked == ["nav_msgs/msg/Odometry"])
    until(lambda: graph.send("/odom", **ODOM) or ros.describe("odom").age is not None)
    assert ros.robot.odom.theta == pytest.approx(math.pi)
    ros.publish("move", "/cmd_vel")
    ros.robot.move(linear_x=0.2)
    until(lambda: commands(graph) == [0.2])


# -- on this side ---------------------------------------------------------------------------------


def test_a_wrong_field_or_type_is_refused_before_anything_is_sent(driver: RosBridge, graph: Any) -> None:
    move = driver.robot.move
    for wrong, sentence in (
        (lambda: move(linaer_x=0.2), "Did you mean `linear_x`"),
        (lambda: move(lambda msg: msg.linear(x="fast")), r"`msg\.linear\.x` must be a number, not 'fast'"),
        (lambda: move(linear_x=math.nan), "finite"),
        (lambda: move(lambda msg: setattr(msg.angular, "w", 1)), "has no `w`"),
    ):
        with pytest.raises(BridgeError, match=sentence):
            wrong()
    assert commands(graph) == []


def test_a_nested_message_is_not_a_number(ros: RosBridge) -> None:
    ros.publish("goal", "/goal", "geometry_msgs/Pose")
    with pytest.raises(BridgeError, match=r"`msg\.position` has fields of its own.*`msg\.position\.x`"):
        ros.robot.goal(position=1.0)


def test_a_tick_sees_one_world(driver: RosBridge, graph: Any) -> None:
    graph.send("/odom", **ODOM)
    until(lambda: driver.describe("odom").age is not None)
    driver.begin_tick(0.0, 0.1)
    graph.send("/odom", pose={"pose": {"position": {"x": 9.0}}})
    until(lambda: driver.panel().tables[0].rows[0][6].startswith("x=9") and "x=9.0" in latest(driver))
    assert driver.robot.odom.x == 1.0
    driver.end_tick(0.0)
    assert driver.robot.odom.x == 9.0


def latest(ros: RosBridge) -> str:
    return repr(ros.wiring.channels[0].latest)


def test_a_disarmed_robot_gets_a_stop_and_nothing_else(driver: RosBridge, graph: Any) -> None:
    driver.disarm()
    driver.robot.move(linear=0.2)
    driver.press("stop")
    until(lambda: commands(graph))
    assert set(commands(graph)) == {0.0}


def test_closing_stops_the_robot_before_the_connection_goes(driver: RosBridge, graph: Any) -> None:
    driver.robot.move(linear=0.2)
    driver.close()
    until(lambda: commands(graph)[-1:] == [0.0])
    until(lambda: not graph.advertised and not graph.listeners)


def test_the_stop_button_works_while_the_program_hangs(driver: RosBridge, graph: Any) -> None:
    let_go, hangs = threading.Event(), threading.Event()
    session = Session(
        "(machine m (state s (running [robot.move(linear=0.2); hangs.set(); let_go.wait()])))(spawn m s)",
        bridge=driver,
        namespace={"let_go": let_go, "hangs": hangs},
    )
    session.start()
    try:
        assert hangs.wait(60)
        # of the watchdog, once; it may come before the program's command
        until(lambda: 0.0 in commands(graph))
        stopped = len(commands(graph))
        driver.press("stop")
        until(lambda: commands(graph)[stopped:] == [0.0])
    finally:
        let_go.set()
        session.close()

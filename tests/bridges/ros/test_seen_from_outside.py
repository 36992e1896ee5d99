"""What other nodes see of a run: its states beside the sensors in a bag, and its log."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import threading
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xmlrpc.client import ServerProxy

import pytest
from bridges.ros.follower import PATIENT
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge, rosout
from lrp_jupyter.bridges.ros.outlets import StateOutlet
from lrp_jupyter.bridges.ros.rosout import LogOutlet, LogRecord
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.session import Session

PROGRAM = """\
(machine m
  (state bright)
  (state dark (running [1 / 0]))
  (on [robot.light.data < 100] bright -> dark darkens)
  (on [robot.light.data > 150] dark -> bright brightens))
(spawn m bright)
"""
LIGHT = {"topic": "/light", "type": "std_msgs/UInt8"}
SETUP = {"subscriptions": {"light": LIGHT}, "publishers": {}}
TOLD = PROGRAM.replace("100", "100 and robot.go.data == 1").replace("150", "150 and robot.go.data == 2")
WIRES = {"light": LIGHT, "go": {"topic": "/go", "type": "std_msgs/UInt8"}}  # of a robot and of its program


def shine(peer: RosBridge, brightness: int, go: int = 0) -> None:
    """Publish what a light sensor measures, and which transition may fire."""
    peer.robot.light(data=brightness)
    peer.robot.go(data=go)


def hears(node: str, topic: str, source: str) -> bool:
    """Whether a node is connected, by its own account, to the publisher of a topic that publishes another."""
    import rosgraph

    master = rosgraph.Master("/tests")
    publishers, subscribers, _services = map(dict, master.getSystemState())
    (name,) = [each for each in subscribers[topic] if node in each]
    addresses = [master.lookupNode(each) for each in publishers.get(source, ())]
    with ServerProxy(master.lookupNode(name)) as asked:
        _code, _text, connections = asked.getBusInfo("/tests")
    return any(each[4] == topic and each[5] and each[1] in addresses for each in connections)


@pytest.mark.ros
def test_a_bag_has_the_states_and_their_reasons_beside_the_sensors_and_the_log(
    real: Any, backend: str, bare_lrp: Callable[..., Any], tmp_path: Path
) -> None:
    bag, program, setup = (tmp_path / name for name in ("run.bag", "light.lrp", "robot.json"))
    program.write_text(TOLD)
    setup.write_text(json.dumps({"subscriptions": WIRES, "publishers": {}}))
    topics = "/light", "/lrp/state", "/rosout"
    at_once = "--buffsize=0", "--chunksize=1"
    recorder = real.start("/usr/bin/rosbag", "record", *at_once, "-O", str(bag), *topics)
    until(lambda: all(any("record" in node for node in real.subscribers(topic)) for topic in topics))
    port = real.start_rosbridge() if backend == "rosbridge" else real.master_port
    where = [
        f"{name}={value}" for name, value in {"backend": backend, "host": "127.0.0.1", "port": port}.items()
    ]
    options = [word for each in (*where, f"setup={setup}", "state_topic=/lrp/state") for word in ("-o", each)]
    run = bare_lrp("run", program, "--bridge", "ros", *options, environment=real.environment, before=PATIENT)
    peer = RosBridge("rospy", setup={"subscriptions": {}, "publishers": WIRES})
    peer.open()
    try:
        peer.arm()
        sources = {"/light": "/light", "/lrp/state": "/lrp/state", "/rosout": "/lrp/state"}
        until(lambda: all(hears("record", *each) for each in sources.items()))
        written = bag.with_name("run.bag.active")
        for brightness, go, told in ((200, 0, "spawned"), (42, 1, "darkens"), (201, 2, "brightens")):
            before = written.stat().st_size  # first the reading is in the bag, and then the program may go on
            until(lambda b=brightness, n=before: shine(peer, b) or written.stat().st_size > n + 8192)
            until(lambda b=brightness, g=go, t=told: shine(peer, b, g) or t.encode() in written.read_bytes())
        late = real.start("/usr/bin/rostopic", "echo", "-n", "1", "-p", "/lrp/state")
        output, _ = late.communicate(timeout=60)
        assert '"active": ["m/bright"]' in output
    finally:
        peer.close()
    run.send_signal(signal.SIGINT)
    run.communicate(timeout=60)
    assert run.returncode == 130
    os.killpg(recorder.pid, signal.SIGINT)
    until(bag.exists)
    read = ["/usr/bin/python3", str(Path(__file__).with_name("read_bag.py")), str(bag)]
    own = {name: text for name, text in os.environ.items() if name != "PYTHONPATH"}  # Debian's Python
    lines = subprocess.run(read, capture_output=True, text=True, check=True, env=own).stdout
    heard = [json.loads(line) for line in lines.splitlines()]

    reading: dict[str, Any] = {}
    changes = []
    for each in heard:
        if each["topic"] == "/light":
            reading = each
        elif each["topic"] == "/lrp/state":
            told = json.loads(each["data"])
            for event in told["events"]:
                if event["event"] == "fired":
                    assert event["values"]["robot.light.data"] == reading["data"]
                    assert reading["time"] <= each["time"]
                    changes.append((event["transition"], event["line"], reading["data"], told["active"]))
    assert changes == [("darkens", 4, 42, ["m/dark"]), ("brightens", 5, 201, ["m/bright"])]
    log = [each for each in heard if each["topic"] == "/rosout" and each["file"] == str(program)]
    assert {each["name"].startswith("/lrp") for each in log} == {True}
    assert all(heard[0]["time"] - 60 < each["stamp"] <= each["time"] for each in log)
    records = [(each["level"], each["msg"], each["line"], each["function"]) for each in log]
    assert (2, "`light` has started.", 0, "") in records
    assert (8, "LRP601 ZeroDivisionError: division by zero", 3, "m/dark") in records
    if backend == "rospy":  # what a client of rosbridge says last is published, or not, by the server
        assert records[-1] == (2, "`light` has ended.", 0, "")


# -- topics in memory -----------------------------------------------------------------------------


def told_on(graph: Any, topic: str) -> list[dict[str, Any]]:
    return [values for name, values in tuple(graph.heard) if name == topic]


def states(graph: Any) -> list[dict[str, Any]]:
    return [json.loads(values["data"]) for values in told_on(graph, "/lrp/state")]


@pytest.mark.parametrize(
    ("is_ros2", "type_", "level"), [(False, "rosgraph_msgs/Log", 2), (True, "rcl_interfaces/Log", 20)]
)
def test_a_disarmed_robot_is_followed_too_and_what_is_told_is_no_command(
    make: Callable[..., RosBridge], graph: Any, is_ros2: bool, type_: str, level: int
) -> None:
    graph.is_ros2 = is_ros2
    move = {"topic": "/cmd_vel", "type": "geometry_msgs/Twist"}
    ros = make(setup={"subscriptions": {}, "publishers": {"move": move}}, state_topic="lrp/state")
    with Session("(machine m (state s (running [robot.move(linear=0.1)]))) (spawn m s)", ros) as session:
        session.start()
        until(lambda: states(graph))
        until(lambda: session.frame.tick > 3)
        assert {command.name for command in ros.safety.commands} == {"move"}
    assert states(graph)[-1]["active"] == ["m/s"]
    assert {values["linear"]["x"] for values in told_on(graph, "/cmd_vel")} <= {0.0}, "stops only"
    levels = {values["msg"]: values["level"] for values in told_on(graph, "/rosout")}
    assert levels["`move` was not sent: the robot is disarmed."] == level
    assert (graph.types["/rosout"], graph.types["/lrp/state"]) == (type_, "std_msgs/String")


def test_the_state_is_published_again_when_the_server_is_back_and_the_log_catches_up(
    serve: Callable[..., Any], make: Callable[..., RosBridge], graph: Any
) -> None:
    server = serve()
    ros = make(setup=SETUP, port=server.port, state_topic="/lrp/state")
    with Session(PROGRAM, ros, name="light") as session:
        session.start()
        until(lambda: states(graph))
        server.close()
        until(lambda: ros.status.state is ConnectionState.LOST)
        before = len(states(graph))
        session.edit(PROGRAM.replace("< 100", "< 120"))
        assert session.frame.status == "running"
        assert len(states(graph)) == before
        serve(server.port)
        until(
            lambda: any("An edit of `light` was applied" in each["msg"] for each in told_on(graph, "/rosout"))
        )
        until(lambda: any(e["event"] == "patched" for told in states(graph)[before:] for e in told["events"]))
        session.pause()
        until(lambda: states(graph)[-1]["status"] == "paused")


def test_a_sentence_that_is_repeated_is_logged_once_in_ten_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    now, log = [0.0], LogOutlet()
    monkeypatch.setattr(rosout, "time", SimpleNamespace(monotonic=lambda: now[0]))
    records: list[LogRecord] = []
    monkeypatch.setattr(log, "put", records.append)
    restarted = {"event": "restarted", "reason": "`a` is active and its `running` changed."}
    told = {"program": "p", "file": "p.lrp", "status": "running", "reason": "", "stamp": 1.0}
    for now[0] in (0.0, 1.0, 9.0, 11.0):
        log.tell({**told, "events": [restarted]})
    assert [(record.level, record.file) for record in records] == [("warning", "p.lrp")] * 2
    log.tell({**told, "status": "broken", "reason": "It failed.", "events": []})
    log.tell({**told, "status": "closed", "events": []})
    assert [record.level for record in records[2:]] == ["fatal", "info"]


@pytest.mark.parametrize("name", ["/lrp state", "//state", "9"])
def test_a_topic_that_cannot_be_is_refused_with_the_option_that_names_it(name: str) -> None:
    with pytest.raises(BridgeError, match=r"`state_topic`: `.*` is not a valid topic name"):
        RosBridge(state_topic=name)


def test_what_is_told_while_another_thread_publishes_waits_for_nothing_and_is_published_in_order() -> None:
    outlet, going, held = StateOutlet("/lrp/state"), threading.Event(), threading.Event()
    sent: list[str] = []

    class Held:
        version, log_name = 2, "lrp"

        def announce(self, topic: str, type_: str, keeps: int) -> object:
            return topic

        def send(self, handle: object, values: Any, urgent: bool) -> None:
            sent.append(values["data"])
            going.set()
            assert held.wait(60)

        def leave(self, handle: object) -> None:
            """Nothing to end."""

    outlet.put(1)
    link = threading.Thread(target=outlet.join, args=(Held(),))
    link.start()
    assert going.wait(60)
    outlet.put(2)  # would hang
    outlet.put(3)
    held.set()
    link.join(60)
    assert sent == ["1", "2", "3"]
    assert outlet.complaint() == ""
    outlet.put(float)  # nothing that JSON has
    outlet.put(4)
    assert sent[-1] == "4"
    assert outlet.complaint().startswith("`/lrp/state` was not published: TypeError:")
    assert outlet.complaint() == ""

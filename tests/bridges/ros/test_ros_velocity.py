"""What is said to be a velocity is stopped like one, whatever its type."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.dying import PATIENT, CommandLine, Robot, kill
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.bridges.ros.definitions import Definition, FieldType
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.session import Session

Make = Callable[..., RosBridge]
SPEEDS = "test/Speeds"
WHEELS = """\
import rospy, sys, threading, time
from std_msgs.msg import Float64
speeds = {}
lock = threading.Lock()  # each topic has a thread of its own
def turn(speed, wheel):
    with lock:
        if speeds.get(wheel) != speed.data:
            speeds[wheel] = speed.data
            sys.stdout.write(f"{time.monotonic()} {max(map(abs, speeds.values()))}\\n")
            sys.stdout.flush()
rospy.init_node("wheels", disable_rosout=True)
for wheel in "left", "right":
    rospy.Subscriber(f"/{wheel}/command", Float64, turn, wheel)
print("ready", flush=True)
rospy.spin()
"""
PROGRAM = """\
(machine m (state s (running [robot.left(data=1.5)] [robot.right(data=-1.5)])))
(spawn m s)
"""
FLOAT = "std_msgs/Float64"


def wheels(**more: Any) -> dict[str, Any]:
    each = {"type": FLOAT, "velocity": True, **more}
    return {
        "publishers": {side: {"topic": f"/{side}/command", **each} for side in ("left", "right")},
    }


def test_each_of_two_velocities_is_watched_limited_and_stopped(make: Make, graph: Any) -> None:
    graph.others |= {"/left/command", "/right/command"}
    ros = make(setup=wheels(limits={"data": 1}))
    ros.open()
    assert ros.setup["publishers"]["left"]["velocity"] is True
    assert "goes on: " not in ros.failsafe
    ros.arm()
    ros.begin_tick(0.0, 0.1)
    ros.robot.left(data=1.5)
    ros.robot.right(data=0)
    ros.end_tick(0.0)
    until(lambda: ("/left/command", {"data": 1.0}) in graph.heard)
    ros.begin_tick(1.0, 0.1)
    ros.end_tick(1.0)
    until(lambda: ("/left/command", {"data": 0.0}) in graph.heard)
    assert any("put `left` into `running`" in notice.text for notice in ros.safety.notices)


def test_one_of_three_that_is_disconnected_while_it_moves_is_stopped_and_watched_no_more(
    make: Make, graph: Any
) -> None:
    graph.others |= {"/a", "/b", "/c", "/d"}
    each = {"type": FLOAT, "velocity": True}
    ros = make(setup={"publishers": {name: {"topic": f"/{name}", **each} for name in "abc"}})
    ros.open()
    ros.arm()
    ros.begin_tick(0.0, 0.1)
    for name in "abc":
        getattr(ros.robot, name)(data=1)
    ros.end_tick(0.0)
    ros.remove("a")
    ros.publish("b", "/d", FLOAT, velocity=True)
    ros.begin_tick(1.0, 0.1)
    ros.robot.b(data=1)
    ros.end_tick(1.0)
    until(lambda: ("/c", {"data": 0.0}) in graph.heard)
    assert {topic for topic, values in graph.heard if not values["data"]} == {"/a", "/b", "/c"}
    assert ros.safety.motion.keys() == {"/d"}
    assert [notice.text for notice in ros.safety.notices if notice.kind == "command watchdog"] == [
        "No command for 0.5 s. If it has to go on, put `c` into `running`."
    ]


def test_what_is_no_velocity_although_its_type_is_one_is_left_alone(make: Make, graph: Any) -> None:
    ros = make(setup={"publishers": {"feel": {"topic": "/haptic", "type": "geometry_msgs/Twist"}}})
    ros.open()
    ros.publish("feel", "/haptic", "geometry_msgs/Twist", velocity=False)
    ros.arm()
    ros.robot.feel(linear=0.2)
    until(lambda: graph.heard)
    assert ros.stop_all()
    ros.robot.feel(linear=0.3)
    until(lambda: len(graph.heard) == 2)
    assert [values["linear"]["x"] for _, values in graph.heard] == [0.2, 0.3]


def test_of_a_list_of_speeds_it_has_to_be_said_how_many_zeros_stop_it(make: Make, graph: Any) -> None:
    graph.definitions[SPEEDS] = Definition(SPEEDS, {"data": FieldType("float64", 0)})
    ros = make()
    ros.open()
    ros.arm()
    with pytest.raises(BridgeError, match=r'`"stop": {"wheels": {"data": \[0, 0\]}}` in the set-up'):
        ros.publish("wheels", "/wheels", SPEEDS, velocity=True)
    ros.publish("wheels", "/wheels", SPEEDS, velocity=True, at_stop={"data": [0, 0, 0]})
    for act, speeds in (lambda: ros.robot.wheels(data=[1, 2, 3]), [1, 2, 3]), (ros.stop_all, [0, 0, 0]):
        act()
        until(lambda speeds=speeds: graph.heard[-1:] == [("/wheels", {"data": speeds})])


@pytest.mark.parametrize(
    ("topic", "type_", "guess"),
    [
        ("/left/command", FLOAT, "yes"),
        ("/wheel_vel", "std_msgs/Float32", "yes"),
        ("/battery", FLOAT, ""),
        ("/cmd_vel", "geometry_msgs/Twist", ""),
        ("/cmd_name", "std_msgs/String", ""),
    ],
)
def test_the_panel_guesses_which_number_is_a_velocity_and_a_person_decides(
    make: Make, graph: Any, topic: str, type_: str, guess: str
) -> None:
    graph.types[topic] = type_
    ros = make()
    ros.open()
    until(lambda: topic in ros.topics)
    ros.press("pick", row=topic)
    field = next(each for each in ros.panel().fields if each.key == "velocity")
    assert (field.value, field.choices) == (guess, ("yes", "no"))
    for said, velocity in (("yes", True), ("no", False), ("", None)):
        ros.press("publish", values={"variable": "it", "topic": topic, "velocity": said})
        assert ros.setup["publishers"]["it"].get("velocity") is velocity
    with pytest.raises(BridgeError, match="`Velocity` is `yes`, `no`, or empty"):
        ros.press("publish", values={"variable": "it", "topic": topic, "velocity": "maybe"})
    with pytest.raises(BridgeError, match="`Velocity` is for publishers"):
        ros.press("subscribe", values={"variable": "it", "topic": topic, "velocity": "yes"})


@pytest.mark.ros
@pytest.mark.slow
def test_the_guard_stops_both_wheels_when_the_program_is_killed(
    real: Any, backend: str, tmp_path: Path
) -> None:
    lines: list[str] = real.lines(real.start(sys.executable, "-c", WHEELS, ready=True))
    port = real.start_rosbridge() if backend == "rosbridge" else real.master_port
    setup = tmp_path / "setup.json"
    setup.write_text(json.dumps(wheels()))
    options = {"backend": backend, "host": "127.0.0.1", "port": port, "setup": setup}
    robot = Robot(
        lambda: [(float(moment), float(speed)) for moment, speed in map(str.split, lines)],
        ("--bridge", "ros", *(part for name in options for part in ("-o", f"{name}={options[name]}"))),
        environment=real.environment,
        program=PROGRAM,
    )
    driver = CommandLine(robot, tmp_path, before=PATIENT)
    try:
        robot.is_driven()
        kill(driver, robot)
    finally:
        driver.end()


@pytest.mark.ros
def test_a_program_that_pauses_stops_both_wheels(real: Any, connect: Callable[..., RosBridge]) -> None:
    lines: list[str] = real.lines(real.start(sys.executable, "-c", WHEELS, ready=True))
    with Session(PROGRAM, bridge=connect(setup=wheels())) as session:
        session.start()
        until(lambda: lines[-1:] and lines[-1].endswith(" 1.5"))
        session.pause()
        until(lambda: lines[-1].endswith(" 0.0"))

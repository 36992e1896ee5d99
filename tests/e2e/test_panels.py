"""The panels of real robots: a ROS robot behind a server of topics, and an emulated EV3 brick."""

import json
import socket
import threading
from pathlib import Path

import pytest
from bridges.ev3.brick import Brick
from bridges.ros.rosbridge_server import MemoryGraph, RosbridgeServer
from support.waiting import until

from e2e import axe
from e2e.programs import COUNTER
from lrp_jupyter.bridges.ros.definitions import KNOWN

SETUP = json.loads((Path(__file__).parents[1] / "bridges" / "ros" / "follower.json").read_text())
DRIVE = """\
(var hang := [False])
(machine m
  (state a
    (running [robot.move(linear=0.1)] [
      while hang: pass])))
(spawn m a)
"""
MESSAGES = """\
(machine m
  (state a (running [robot.move(lambda msg: msg)]))
  (state b (running [robot.odom]))
  (state c (running [robot.move()])))
(spawn m b)
"""


class RosRobot:
    """Topics in memory that are published, and the server by which a bridge finds them."""

    def __init__(self):
        self.graph = MemoryGraph(dict(KNOWN))
        self.graph.types |= {
            "/odom": "nav_msgs/Odometry",
            "/light": "std_msgs/UInt8",
            "/cmd_vel": "geometry_msgs/Twist",
        }
        self.graph.others |= set(self.graph.types)
        self.light = 200
        self._gone = threading.Event()
        self._speaker = threading.Thread(target=self._speak, name="topics")
        self._speaker.start()
        self.server = RosbridgeServer(self.graph)
        self.port = self.server.port

    def _speak(self):
        while not self._gone.wait(0.1):
            self.graph.send("/light", data=self.light)
            self.graph.send("/odom", pose={"pose": {"position": {"x": 1.25, "y": 0.5, "z": 0.0}}})

    @property
    def speeds(self):
        return [values["linear"]["x"] for topic, values in self.graph.heard if topic == "/cmd_vel"]

    def die(self):
        self.server.close()

    def come_back(self):
        self.server = RosbridgeServer(self.graph, self.port)

    def close(self):
        self._gone.set()
        self._speaker.join()
        self.server.close()


@pytest.fixture
def ros():
    robot = RosRobot()
    yield robot
    robot.close()


@pytest.fixture
def open_ros(open_lab, ros, tmp_path):
    """Open a lab on the ROS robot, with everything connected or nothing."""

    def open_ros(program, connected=True):
        setup = tmp_path / "robot.json"
        setup.write_text(json.dumps(SETUP if connected else {"version": 1}))
        return open_lab(program, f"m --bridge ros --host 127.0.0.1 --port {ros.port} --setup {setup}")

    return open_ros


@pytest.fixture
def brick():
    brick = Brick()
    brick.sensors[0].type, brick.sensors[0].values = 16, {0: 0.0, 1: 3.0}
    brick.sensors[1].type, brick.sensors[1].values = 29, {0: 42.0, 1: 7.0, 2: 5.0}
    brick.sensors[2].type, brick.sensors[2].values = 30, {0: 25.5}
    yield brick
    brick.close()
    assert brick.violations == []


@pytest.fixture
def open_brick(open_lab, brick):
    """Open a lab on the brick, or on one whose address is not known."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        beacon = probe.getsockname()[1]

    def open_brick(program=COUNTER, host="--host 127.0.0.1"):
        return open_lab(program, f"m --bridge ev3 {host} --port {brick.port} --beacon_port {beacon}")

    return open_brick


def row(key):
    return f'[data-row="{key}"]'


def cell(key, column):
    return f'{row(key)} [data-column="{column}"]'


def field(lab, key):
    return lab.sees(f'[data-field="{key}"]')


def press(lab, action, key=""):
    lab.sees(f'{row(key) if key else ""} [data-lrp-action="panel-{action}"]').click()


def arm(lab):
    press(lab, "arm")
    lab.sees('[data-lrp-action="confirm-arm"]').click()
    lab.until("note => note.hidden", ".lrp-disarmed")


COMPLETED = [
    ("msg: msg", ".lin", {"linear"}),
    ("msg: msg.linear", ".", {"x", "y", "z"}),
    ("robot.odom", ".", {"x", "y", "theta"}),
    ("robot.odom.", "pose.pose.position.", {"x", "y", "z"}),
    ("c (running [robot.move(", "ang", {"angular_z="}),
]


def test_a_ros_robot_is_connected_armed_lost_and_stopped(open_ros, ros):
    lab = open_ros(DRIVE)
    see_topics(lab, ros)
    arm_by_a_question(lab, ros)
    stop_beside_a_hanging_block(lab, ros)
    for theme in ("dark", "light"):
        axe.choose_theme(lab, theme)
        axe.finds_nothing_serious(lab)
    lose_the_server(lab, ros)
    connect_another_address(lab, ros)


def test_topics_are_picked_and_known_to_the_editor(open_ros, ros):
    lab = open_ros(COUNTER, connected=False)
    pick_topics(lab, ros)
    complete_fields(lab)


def test_a_brick_is_found_turned_built_and_found_again(open_brick, brick):
    lab = open_brick(host="")
    answer_for_its_address(lab)
    see_motors_and_sensors(lab, brick)
    for theme in ("dark", "light"):
        axe.choose_theme(lab, theme)
        axe.finds_nothing_serious(lab)
    turn_motors_by_hand(lab, brick)
    choose_another_port(lab, brick)
    lose_and_find_it(lab, brick)


# -- ROS -------------------------------------------------------------------------------------------


def see_topics(lab, ros):
    """Publishers and subscriptions are listed with rate, age and value."""
    lab.reads(cell("light", "value"), "200")
    lab.reads(cell("light", "type"), "std_msgs/UInt8")
    lab.reads(cell("odom", "value"), "x=1.25, y=0.5, theta=0")
    lab.until("cell => Number(cell.textContent) > 2", cell("light", "rate (Hz)"))
    lab.until("cell => Number(cell.textContent) < 2", cell("light", "age (s)"))
    lab.reads(cell("bumper", "value"), "no data yet")
    lab.reads(cell("move", "direction"), "publisher")
    ros.light = 20
    lab.until("cell => cell.textContent === '20'", cell("light", "value"))
    assert ros.speeds == [], "a lab on hardware opens disarmed"


def arm_by_a_question(lab, ros):
    """The person who arms the robot is told who stops it."""
    press(lab, "arm")
    told = "each => each.textContent.includes('a guard process stops the robot')"
    lab.until(told, '[role="dialog"] .lrp-failsafe')
    lab.reads('[role="dialog"] .lrp-failsafe code', "lrp guard")
    axe.finds_nothing_serious(lab)
    lab.page.keyboard.press("Escape")
    lab.until("note => !note.hidden", ".lrp-disarmed")
    lab.goes_on()
    assert ros.speeds == [], "nobody has armed it"
    arm(lab)
    until(lambda: 0.1 in ros.speeds, "a command")
    lab.until(told, ".lrp-state .lrp-failsafe")
    lab.reads(cell("move", "value"), "linear.x=0.1")


def stop_beside_a_hanging_block(lab, ros):
    lab.replace("[False]", "[True]")
    lab.sees(':scope[data-lrp-status="hung"]')
    ros.graph.heard.clear()
    press(lab, "stop")
    until(lambda: ros.speeds, "the command to stop")
    assert set(ros.speeds) == {0.0}
    lab.replace("[True]", "[False]")
    lab.do("run")
    lab.ready("running")


def lose_the_server(lab, ros):
    """A dead server is shown, and everything comes back with it."""
    ros.die()
    lab.sees('.lrp-state .lrp-dot[data-status="lost"]')
    lab.reads(".lrp-sentence", str(ros.port))
    lab.goes_on()
    ros.come_back()
    lab.misses('.lrp-state .lrp-dot[data-status="lost"]')
    ros.light = 33
    lab.reads(cell("light", "value"), "33")


def connect_another_address(lab, ros):
    other = RosRobot()
    other.light = 77
    try:
        lab.sees(".lrp-questions summary").click()
        lab.sees('[data-question="host"]').fill(f"127.0.0.1:{other.port}")
        lab.sees('[data-lrp-action="answer-host"]').click()
        lab.reads(cell("light", "value"), "77")
        lab.reads('[data-show="address"]', f"127.0.0.1:{other.port}")
        until(lambda: not ros.graph.listeners, "the end of the first connection")
    finally:
        other.close()


def pick_topics(lab, ros):
    """A topic is picked, its type filled in, its row removed again; an invalid name is refused."""
    field(lab, "variable").fill("my light")
    field(lab, "topic").fill("/light")
    press(lab, "subscribe")
    lab.reads(".lrp-toast", "is not a valid name")
    assert field(lab, "variable").input_value() == "my light", "it can be corrected"
    field(lab, "variable").fill("")

    press(lab, "pick", "/odom")
    lab.until("input => input.value === 'nav_msgs/Odometry'", '[data-field="type"]')
    assert field(lab, "variable").input_value() == "odom"
    press(lab, "subscribe")
    lab.reads(cell("odom", "value"), "x=1.25")
    lab.until("input => input.value === ''", '[data-field="topic"]')

    field(lab, "variable").fill("eye")
    assert lab.find("datalist option").evaluate_all("all => all.map(one => one.value)")[:3] == [
        "/cmd_vel",
        "/light",
        "/odom",
    ]
    field(lab, "topic").fill("/light")  # one of the list: its type is filled in
    lab.until("input => input.value === 'std_msgs/UInt8'", '[data-field="type"]')
    press(lab, "subscribe")
    lab.reads(cell("eye", "value"), "200")

    field(lab, "variable").fill("mo")
    lab.goes_on()
    assert field(lab, "variable").input_value() == "mo", "what is typed is left alone"
    field(lab, "variable").fill("move")
    field(lab, "topic").fill("/cmd_vel")
    press(lab, "publish")
    lab.reads(cell("move", "type"), "geometry_msgs/Twist")
    press(lab, "remove", "eye")
    lab.misses(row("eye"))
    until(lambda: {topic for topic, _ in ros.graph.listeners} == {"/odom"}, "the end of /light")


def complete_fields(lab):
    """The editor knows the fields of messages from their types."""
    lab.find(".cm-content").focus()
    lab.page.keyboard.press("Control+a")
    lab.page.keyboard.insert_text(MESSAGES)
    lab.is_active("m/b")
    for place, typed, offered in COMPLETED:
        lab.type_after(place, typed)
        lab.until(
            "(list, labels) => labels.every(label =>"
            " [...list.querySelectorAll('.cm-completionLabel')].some(one => one.textContent === label))",
            ".cm-tooltip-autocomplete",
            sorted(offered),
        )
        if typed == ".lin":  # by a click: Enter is a new line as long as a list has just opened
            lab.find(".cm-completionLabel").first.click()
        else:
            lab.page.keyboard.press("Escape")
        lab.misses(".cm-tooltip-autocomplete")


# -- EV3 -------------------------------------------------------------------------------------------


def answer_for_its_address(lab):
    """The address of a brick is asked, and a wrong one refused."""
    lab.until("dialog => dialog.open", ".lrp-questions")
    host = lab.sees('[data-question="host"]')
    host.fill("not an address")
    host.press("Enter")
    lab.reads(".lrp-toast", "is not the address of a brick")
    host.fill("127.0.0.1")
    host.press("Enter")
    lab.reads(".lrp-sentence", "SLOWPOKE")
    lab.until("dialog => !dialog.open", ".lrp-questions")
    lab.reads(cell("sensor3", "value"), "25.5")


def see_motors_and_sensors(lab, brick):
    for motor in ("motorA", "motorB", "motorC", "motorD"):
        lab.reads(cell(motor, "type"), "large motor")
    lab.reads(cell("sensor1", "type"), "touch")
    lab.reads(cell("sensor2", "value"), "42")
    lab.reads(cell("sensor2", "unit"), "%")
    lab.reads(cell("sensor3", "value"), "25.5")
    lab.reads(cell("sensor4", "type"), "nothing")
    lab.reads('[data-show="battery"]', "87 %")
    brick.sensors[0].values[0] = 1.0
    lab.until("cell => cell.textContent === '1'", cell("sensor1", "value"))
    press(lab, "next_mode", "sensor2")
    lab.reads(cell("sensor2", "mode"), "ambient")
    lab.until("cell => cell.textContent === '7'", cell("sensor2", "value"))


def turn_motors_by_hand(lab, brick):
    """Motors turn once the robot is armed, and all stop at once."""
    press(lab, "forward", "motorA")
    lab.goes_on()
    assert brick.motors[0].turning == 0, "a lab on hardware opens disarmed"
    arm(lab)
    field(lab, "speed").fill("30")
    press(lab, "forward", "motorA")
    until(lambda: brick.motors[0].turning == 30, "motor A")
    press(lab, "backward", "motorD")
    until(lambda: brick.motors[3].turning == -30, "motor D")
    lab.until("cell => Number(cell.textContent) > 20", cell("motorA", "count (deg)"))
    lab.reads(cell("motorD", "speed (%)"), "-30")
    press(lab, "halt", "motorA")
    until(lambda: brick.motors[0].turning == 0, "the end of motor A")
    assert brick.motors[3].turning == -30
    press(lab, "reset_count", "motorA")
    lab.until("cell => cell.textContent === '0'", cell("motorA", "count (deg)"))
    press(lab, "stop")
    until(lambda: brick.motors[3].turning == 0, "the end of motor D")
    lab.ready("paused")


def choose_another_port(lab, brick):
    """The robot's readings are shown of the ports that are chosen."""
    lab.do("run")
    lab.reads(cell("light.data", "value"), "and not a colour sensor. Set light to 2, where one is.")
    lab.reads(cell("bumper.data", "value"), "True")
    field(lab, "light").select_option("2")
    field(lab, "wheel").fill("112")
    press(lab, "build")
    lab.reads(cell("light.data", "value"), "107")
    brick.sensors[1].values[0] = 100.0
    lab.reads(cell("light.data", "value"), "255")
    field(lab, "left").select_option("C")
    press(lab, "build")
    lab.reads(".lrp-toast", "are both in port C")


def lose_and_find_it(lab, brick):
    brick.unplug()
    lab.until("dot => ['stale', 'lost'].includes(dot.dataset.status)", ".lrp-state .lrp-dot")
    lab.goes_on()
    brick.plug_in()
    lab.sees('.lrp-state .lrp-dot[data-status="connected"]')
    brick.sensors[2].values[0] = 11.5
    lab.reads(cell("sensor3", "value"), "11.5")

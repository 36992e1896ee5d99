"""A robot for tests has the members of the real one, reads what it is told, and keeps its commands."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from support.robots import Buggy, Cart, Courier
from support.tables import every

from lrp_jupyter import Session
from lrp_jupyter.bridges import MemberError, find_bridges, make_bridge
from lrp_jupyter.bridges.member_tree import RobotMethod
from lrp_jupyter.errors import BridgeError, StaleData
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.running.checking import members_of
from lrp_jupyter.testing import RobotStub

ROS = Path(__file__).parents[2] / "notebooks" / "ros"
OPTIONS = {
    "ros": [
        {"setup": path, "backend": backend}
        for path in (ROS / "robot.json", ROS / "convoy.json")
        for backend in ("rosbridge", "auto")
    ],
    "sim": [{"world": world} for world in ("line", "maze", "convoy")],
}


def described(bridge):
    """All that a program and a view know of the members of a robot."""
    found = {}
    for node in bridge.nodes.members():
        found[node.path] = replace(node.describe(), age=None), node.limits
        if isinstance(node, RobotMethod):
            names = ("message", "command", "velocity", "mover", "likely", "units", "parameters")
            found[node.path] += tuple(getattr(node, name) for name in names)
    return found


def test_a_stub_has_the_members_of_every_bridge_that_knows_them_without_a_connection():
    """With their descriptions, units, limits and signatures; the checks of a program see no difference."""
    compared = []
    offers = find_bridges().items()  # other tests may have defined some
    own = [name for name, offer in offers if offer.load().__module__.startswith("lrp_jupyter.")]
    for name in [*own, Cart, Buggy, Courier]:
        for options in OPTIONS.get(name, [{}]):
            real = make_bridge(name, **options)
            if name == "none":
                with pytest.raises(
                    BridgeError, match="`none` knows no member of `robot` without a connection"
                ):
                    RobotStub.of(real)
                continue
            stub, named = RobotStub.of(real), RobotStub.of(name, **options)
            stub.open()
            real.offer_stop()
            assert described(stub) == described(real), (name, options)
            known, expected = members_of(named), members_of(real)
            assert (known.members, known.complete) == (expected.members, expected.complete), (name, options)
            compared.append(name)
    assert {"sim", "ros", "ev3"} < set(compared)


LINE = """
(var seen := [[]])
(machine m
  (state a (running [robot.move(linear=0.2)]))
  (state b (onentry [robot.stop()] [seen = seen + list(robot.light.new)]) (running [robot.lamp()]))
  (on [robot.light.data < 128] a -> b dark))
(spawn m a)
"""


def test_a_reading_that_was_not_set_has_no_data_as_of_a_real_robot():
    robot = RobotStub.of("sim")
    with Session(LINE, robot) as session:
        session.run(0.5)
        assert session.frame.is_active("a")
        assert "`robot.light.data` has no data yet" in str(session.why_not("dark"))
        robot["light.data"] = 20
        assert session.run(until="b", seconds=1)
        assert session.frame.time == 0.5
        robot["light.data"] = None
        session.run(0.2)
        assert "light.data" not in session.frame.readings


@every(
    "given",
    [
        {"table": {"light.data": [(1.5, 20), (0, 255)]}},
        {"set": {"light.data": lambda now: 255 if now < 1.45 else 20}},
        {"table": {"light.data": [(0, 255), (1.42, 30), (1.44, 20)]}},
    ],
)
def test_readings_change_over_time(given):
    robot = RobotStub.of("sim")
    for method, readings in given.items():
        getattr(robot, method)(readings)
    with Session(LINE, robot) as session:
        assert session.run(until="b", seconds=5)
        assert session.frame.time == 1.5
        assert session.variables["seen"] == [20]
        session.rewind(5)
        assert session.frame.is_active("a")
        assert session.run(until="b", seconds=5)
        assert session.frame.time == 1.5


def test_what_is_given_is_a_message_an_exception_or_a_mistake():
    robot = RobotStub.of("ros", setup=ROS / "robot.json")
    program = """
(var got := [[]])
(machine m
  (state a (running [got.append((robot.scan.nearest(-10, 10), robot.button.data))])
           (onexit [got.append(robot.order.new)]))
  (state b (running [robot.move(linear=0.1)]))
  (on [robot.battery.percentage < 0.2] a -> b low))
(spawn m a)
"""
    robot["scan"] = {"ranges": [2.0, 0.5, 3.0], "angle_min": -0.1, "angle_increment": 0.1}
    robot["button.data"] = True
    robot["battery"] = StaleData("The battery is silent.")
    robot.table({"order": [(0.25, {"data": "tea"}), (0.28, {"data": "cake"}), (0.5, {"data": "more"})]})
    with Session(program, robot) as session:
        session.run(0.3)
        assert session.variables["got"] == [(0.5, True)] * 3
        assert "The battery is silent." in str(session.why_not("low"))
        robot["battery.percentage"] = 0.1
        session.run(0.2)
        assert session.variables["got"][3:] == [("tea", "cake")]
    for name, message in [
        ("scann", "There is no reading `scann`. Did you mean `scan`?"),
        ("move", "`move` is a method, not a reading. Use `returns` for what it returns."),
        ("scan.new", "`scan.new` follows from `scan`. Set `scan`."),
        ("scan.rangs", "`scan` cannot be {'rangs': 1}. It has 'rangs'."),
    ]:
        with pytest.raises(MemberError, match=re.escape(message)):
            robot[name] = 1


def test_commands_are_kept_in_order_with_their_times_and_after_limits():
    robot = RobotStub.of("sim")
    text = """
(machine m
  (state a (onentry [robot.pen(True)]) (running [robot.move(linear=9)]))
  (state b (onentry [robot.stop()]) (running [robot.move(angular=0.5)]))
  (ontime 300 a -> b)
  (ontime 200 b -> a))
(spawn m a)
"""
    with Session(text, robot) as session:
        session.run(0.6)
        session.pause()
    assert repr(robot.commands) == (
        "[0 s: robot.pen(down=True), 0 s to 0.2 s: robot.move(linear=0.5), 0.3 s: robot.stop(), "
        "0.3 s to 0.4 s: robot.move(angular=0.5), 0.5 s: robot.pen(down=True), 0.5 s: robot.move(linear=0.5)]"
    )
    last = robot.last("move")
    assert (last.time, last.name, last.arguments, last.last) == (0.5, "move", {"linear": 0.5}, 0.5)
    assert robot.last("say") is None
    with pytest.raises(MemberError, match=r"There is no method `mvoe`\. Did you mean `move`\?"):
        robot.last("mvoe")


def test_methods_return_what_the_test_says():
    robot = RobotStub.of(Cart)
    text = "(var heard := [[]]) (machine m (state a (running [heard.append(robot.beep(1))]))) (spawn m a)"
    with Session(text, robot) as session:
        session.step()
        robot.returns("beep", "tone")
        session.step()
        robot.returns("beep", lambda seconds, tone: seconds + tone)
        session.step()
        robot.returns("beep", BridgeError("It has no battery."))
        session.step()
        assert session.variables["heard"] == [None, "tone", 441]
        assert [issue.message for issue in session.issues] == ["It has no battery."]


@every(
    ("end", "leads", "at"),
    [
        ({}, "arrived", 0.1),
        ({"after": 1.0}, "arrived", 1.0),
        ({"status": "aborted", "after": 0.35, "reason": "A door is shut."}, "lost", 0.4),
    ],
)
def test_tasks_end_when_the_test_says(end, leads, at):
    robot = RobotStub.of(Courier)
    text = """
(machine m
  (state going (onentry [robot.go(3)]))
  (state arrived) (state lost (onentry [print(robot.go.reason)]))
  (on [robot.go.succeeded] going -> arrived)
  (on [robot.go.failed] going -> lost))
(spawn m going)
"""
    with Session(text, robot) as session:
        session.run(2)
        assert session.frame.is_active("going")
        assert repr(robot.commands) == "[0 s: robot.go(place=3)]"
        session.reset()
        robot.ends("go", **end)
        start = session.frame.time
        assert session.run(until=leads, seconds=5)
        assert round(session.frame.time - start, 3) == at
    with pytest.raises(MemberError, match="There is no method `gone`"):
        robot.ends("gone")


def test_a_session_with_it_is_recorded_and_reproduced_and_forked(tmp_path):
    robot, path = RobotStub.of("sim"), tmp_path / "run.lrplog"
    robot.table({"light.data": [(0, 255), (0.7, 20)]})
    with Session(LINE, robot) as session, session.record(path):
        session.run(1)
        with session.fork(3, inputs=True) as fork:
            fork.run(0.6)
            assert fork.frame.is_active("b")
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert again.session.frame.is_active("b")
    again.session.close()


def test_the_lab_does_not_offer_it():
    assert "stub" not in find_bridges()

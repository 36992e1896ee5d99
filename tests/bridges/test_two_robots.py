"""A world with two robots: `robot` is the first, `robot.NAME` the other, and the safety holds for both."""

from __future__ import annotations

import math
from typing import Any

import pytest

from lrp_jupyter.bridges.bridge import MemberError
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.running.checking import check
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim import Simulation, World, WorldError, load
from lrp_jupyter.sim.animation import EVERY, animated
from lrp_jupyter.sim.simulation import WorldMoment
from lrp_jupyter.sim.sketch import sketch
from lrp_jupyter.sim.svg import svg
from lrp_jupyter.sim.world import BoxSolid, FloorSpec, Noise, PathStroke, RobotSpec
from lrp_jupyter.sim.world_reading import read_world

PERIOD = 0.1
NOISY = Noise(motor=0.1, light=5, distance=0.01, gyro=0.01, odom=0.05)


def world(noise: Noise = NOISY) -> World:
    """A room with two robots side by side, each in front of a wall, one of them on a black line."""
    lights = ((0.06, 0.02), (0.06, -0.02))
    return World(
        (3, 2),
        (
            RobotSpec((0.5, 0.5, 0), light=lights, noise=noise, name="lower"),
            RobotSpec((0.5, 1.5, 0), light=lights, limits=(0.3, 2.0), noise=noise, name="upper"),
        ),
        floor=FloorSpec(strokes=(PathStroke(((0.3, 1.53), (2, 1.53))),)),
        solids=(
            BoxSolid((1.5, 0.5, 0.1, 0.4), name="near wall"),
            BoxSolid((1.9, 1.5, 0.1, 0.4), name="far wall"),
        ),
    )


@pytest.fixture
def sim() -> SimBridge:
    sim = SimBridge(world(Noise()))
    sim.open()
    return sim


def tick(sim: SimBridge, number: int, act: Any) -> None:
    now = number * PERIOD
    sim.begin_tick(now, PERIOD)
    act(sim.robot)
    sim.end_tick(now)
    sim.advance(PERIOD)


def poses(sim: SimBridge) -> list[tuple[float, float, float]]:
    return [robot.pose for robot in sim.simulation.robots]


def test_the_other_robot_is_a_part_of_robot(sim: SimBridge) -> None:
    assert dir(sim.robot) == sorted([*dir(sim.robot.upper), "upper"])
    assert repr(sim.robot.upper).startswith("<robot.upper: ")
    with pytest.raises(MemberError, match="`robot` has no `lower`; it has "):
        sim.robot.lower  # noqa: B018


def test_both_are_driven_and_each_senses_for_itself(sim: SimBridge) -> None:
    def both(robot: Any) -> None:
        robot.move(linear=0.2)
        robot.upper.move(angular=1.0)

    tick(sim, 0, both)
    assert (sim.robot.left.light, sim.robot.right.light) == (255, 255)
    assert (sim.robot.upper.left.light, sim.robot.upper.right.light) == (0, 255)
    for number in range(1, 10):
        tick(sim, number, both)
    sim.begin_tick(1.0, PERIOD)
    assert sim.robot.odom.x == pytest.approx(0.2, abs=0.01)
    assert sim.robot.gyro.data == 0
    assert sim.robot.upper.gyro.data == pytest.approx(1.0, abs=0.02)
    assert sim.robot.upper.odom.x == 0
    assert sim.robot.front.distance == pytest.approx(1.45 - 0.7 - 0.08, abs=0.01)


def test_both_bumpers_are_pressed_by_what_each_touches(sim: SimBridge) -> None:
    seen = set()
    for number in range(70):
        tick(sim, number, lambda robot: (robot.move(linear=0.3), robot.upper.move(linear=0.2)))
        seen.add((bool(sim.robot.bumper.data), bool(sim.robot.upper.bumper.data)))
    assert seen == {(False, False), (True, False), (True, True)}


def test_both_are_clipped_to_their_own_limits(sim: SimBridge) -> None:
    tick(sim, 0, lambda robot: (robot.move(linear=9), robot.upper.move(linear=9, angular=-9)))
    assert [robot.command for robot in sim.simulation.robots] == [(0.5, 0.0), (0.3, -2.0)]
    assert [notice.text for notice in sim.safety.notices] == [
        "`move`: linear 9 limited to 0.5.",
        "`upper.move`: linear 9 limited to 0.3.",
        "`upper.move`: angular -9 limited to -2.",
    ]


def test_the_watchdog_stops_the_one_that_gets_no_commands_and_not_the_other(sim: SimBridge) -> None:
    tick(sim, 0, lambda robot: robot.upper.move(linear=0.2))
    for number in range(1, 10):
        tick(sim, number, lambda robot: robot.move(linear=0.2))
    assert [robot.command for robot in sim.simulation.robots] == [(0.2, 0.0), (0.0, 0.0)]
    (notice,) = sim.safety.notices
    assert notice.text == "No command for 0.5 s. If it has to go on, put `upper.move` into `running`."
    assert sim.simulation.robots[1].pose[0] == pytest.approx(0.5 + 0.2 * 0.5, abs=0.03)
    lower = sim.simulation.robots[0].pose[0]
    assert lower == pytest.approx(0.5 + 0.2 * 0.9, abs=0.01), "it drove on without a pause"


def test_a_stop_by_name_stops_that_one_and_a_stop_of_all_stops_both(sim: SimBridge) -> None:
    tick(sim, 0, lambda robot: (robot.move(linear=0.2), robot.upper.move(linear=0.2)))
    tick(sim, 1, lambda robot: robot.upper.stop())
    assert [robot.command for robot in sim.simulation.robots] == [(0.2, 0.0), (0.0, 0.0)]
    tick(sim, 2, lambda robot: robot.upper.move(linear=0.2))
    sim.stop_all()
    sim.advance(PERIOD)
    assert [robot.command for robot in sim.simulation.robots] == [(0.0, 0.0), (0.0, 0.0)]
    assert sim.safety.motion == {}


def test_a_pause_stops_both() -> None:
    with Session(BOTH, SimBridge(world()), clock=VirtualClock()) as session:
        session.run(seconds=2)
        session.resume()
        session.pause()
        session.call(lambda: session.bridge.advance(0.5))
        assert [robot.command for robot in session.bridge.simulation.robots] == [(0, 0), (0, 0)]


def test_of_what_a_pause_has_stopped_the_robot_is_told_and_not_the_lamp() -> None:
    text = "(machine m (state a (onentry [robot.upper.{}] [robot.upper.lamp()])))(spawn m a)"
    for command, told in [("move(linear=0.1)", ["upper.move 1"]), ("stop()", [])]:
        with Session(text.format(command), SimBridge(world()), clock=VirtualClock()) as session:
            session.run(seconds=0.2)
            session.resume()
            session.pause()
            session.run(seconds=0.2)
            assert [notice.about for notice in session.bridge.safety.notices] == told


def test_robots_see_and_touch_each_other() -> None:
    facing = World((2, 1), (RobotSpec((0.5, 0.5, 0)), RobotSpec((1.5, 0.5, math.pi), name="other")))
    sim = SimBridge(facing)
    sim.open()
    assert sim.robot.front.distance == pytest.approx(1.0 - 2 * 0.08, abs=0.001)
    assert sim.robot.other.front.distance == pytest.approx(1.0 - 2 * 0.08, abs=0.001)
    for number in range(40):
        tick(sim, number, lambda robot: (robot.move(linear=0.2), robot.other.move(linear=0.2)))
    assert sim.robot.bumper.data
    assert sim.robot.other.bumper.data
    assert sim.touched == {"other"}


def test_both_leave_trails_with_their_pens(sim: SimBridge) -> None:
    sim.robot.pen()
    sim.robot.upper.pen(True)
    tick(sim, 0, lambda robot: (robot.move(linear=0.3), robot.upper.move(linear=0.3)))
    assert {round(piece.ends()[1], 1) for _, _, piece in sim.simulation.floor.marks} == {0.5, 1.5}
    sim.robot.upper.pen(False)
    assert [robot.pen for robot in sim.picture.robots] == [True, False]


BOTH = """
(machine low
  (state going (running [robot.move(linear=0.2 + robot.left.light / 5000, angular=0.1)]))
  (state turning (running [robot.move(linear=-0.1, angular=1)]))
  (on [robot.bumper.data or robot.front.distance < 0.2] going -> turning)
  (ontime 1200 turning -> going))
(machine up
  (state going
    (running [
      turn = (robot.upper.right.light - robot.upper.left.light) / 200
      robot.upper.move(linear=0.25, angular=turn)]))
  (state turning (running [robot.upper.move(linear=-0.1, angular=-1)]))
  (on [robot.upper.bumper.data] going -> turning)
  (ontime 1500 turning -> going))
(spawn low going)
(spawn up going)
"""


def test_going_back_and_forking_are_exact_for_both() -> None:
    def now(session: Session) -> object:
        return poses(session.bridge), session.frame.readings, session.interpreter.active

    with Session(BOTH, SimBridge(world()), clock=VirtualClock()) as session:
        session.run(seconds=8)
        there = poses(session.bridge)
        session.run(seconds=12)
        end = now(session)
        with session.fork(at=80) as fork:
            fork.run(seconds=12.1)
            assert now(fork) == end
        session.rewind(120)
        assert poses(session.bridge) == there
        session.run(seconds=12)
        assert now(session) == end
        assert all(math.dist(a[:2], b[:2]) > 0.1 for a, b in zip(there, end[0], strict=True))


def test_the_watchdog_of_both_is_part_of_what_is_gone_back_to() -> None:
    once = BOTH.replace("(state going\n    (running", "(state going\n    (onentry")
    with Session(once, SimBridge(world(Noise())), clock=VirtualClock()) as session:
        session.run(seconds=0.3)
        for _ in range(2):
            session.run(seconds=1)
            assert session.bridge.simulation.robots[1].command == (0, 0)
            session.rewind(10)
            assert session.bridge.simulation.robots[1].command != (0, 0)


def test_why_the_other_robot_does_this_is_answered_about_it() -> None:
    with Session(BOTH, SimBridge(world()), clock=VirtualClock()) as session:
        session.run(seconds=3)
        assert session.why("robot.move").facts["command"] == "move"
        assert session.why("robot.upper.move").facts["command"] == "upper.move"
        assert "`robot.upper.move(linear=0.25" in str(session.why("robot.upper.move"))


def test_the_checks_know_both() -> None:
    text = "; world: convoy\n(machine m (state a (running [{}]))) (spawn m a)"
    assert check(text.format("robot.follower.move(linear=robot.follower.front.distance)")) == ()
    (finding,) = check(text.format("robot.folower.stop()"))
    assert finding.message == "`robot` has no `folower`. Did you mean `follower`?"
    (finding,) = check(text.format("robot.follower.moove(linear=1)"))
    assert "Did you mean `move`?" in finding.message


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (("a", "a"), "`robots[1].name`: There is another `a`. Choose another name."),
        (("robot2", ""), "`robots[1].name`: There is another `robot2`. Choose another name."),
        (("", "left"), "`robots[1].name`: A robot has a member `left` already. Choose another name."),
        (("", "my robot"), "`robots[1].name`: Expected a name such as `follower`, not 'my robot'."),
        (("", "if"), "`robots[1].name`: Expected a name such as `follower`, not 'if'."),
    ],
)
def test_wrong_names_of_robots_are_located(names: tuple[str, str], message: str) -> None:
    robots = [{"pose": [1 + index, 1, 0], "name": name} for index, name in enumerate(names)]
    with pytest.raises(WorldError) as caught:
        read_world({"version": 1, "size": [4, 2], "robots": robots})
    assert str(caught.value) == message
    with pytest.raises(BridgeError):
        SimBridge({"version": 1, "size": [4, 2], "robots": robots})


def test_robots_without_names_are_numbered() -> None:
    sim = SimBridge({"version": 1, "size": [4, 2], "robots": [{"pose": [1, 1, 0]}, {"pose": [2, 1, 0]}]})
    sim.open()
    assert "robot2" in dir(sim.robot)
    assert sim.world.to_json().count("name") == 0


def test_no_robot_can_have_the_name_of_a_member() -> None:
    sim = SimBridge("maze")
    sim.open()
    for name in dir(sim.robot):
        with pytest.raises(WorldError, match="already"):
            read_world({"version": 1, "size": [4, 2], "robots": [{"pose": [1, 1, 0], "name": name}]})


def test_pictures_show_both_in_their_own_colours_with_their_names() -> None:
    simulation = Simulation("convoy")
    simulation.drive(0.2, robot=1)
    simulation.step(100)
    run = simulation.repeated(WorldMoment(0, 0), simulation.moment, EVERY)
    for picture in (svg(simulation), animated(run)):
        assert ">leader</text>" in picture
        assert ">follower</text>" in picture
        assert picture.count('fill="#A6CEE3"') == picture.count('fill="#FDBF6F"') == 1
    assert sum(row.count("→") for row in sketch(simulation)) == 2


def test_names_are_written_and_read_without_loss() -> None:
    assert read_world(load("convoy").to_dict()) == load("convoy")
    assert load("convoy").robot_names == ("leader", "follower")

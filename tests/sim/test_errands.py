"""Ways, turns and texts that a robot of the world is asked for, and does by itself."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.tables import every

from lrp_jupyter.sim import Drive, DriveBy, DriveTo, PlaceRobot, Say, Simulation, TurnBy, World, load
from lrp_jupyter.sim.world import BoxSolid, Noise, RobotSpec

NOISY = Noise(motor=0.1, gyro=0.05, odom=0.02)


def field(*solids, noise=NOISY, robots=1):
    """A field without an edge."""
    spec = RobotSpec((5, 5, 1.0), noise=noise)
    other = replace(spec, pose=(5, 7, 0.0), name="other")
    return Simulation(World((10, 10), (spec, other)[:robots], solids=solids, open=True), seed=1)


def perform(simulation, what):
    """Let a robot do it, and read the sensors ten times a second; return how it ended, and after how long."""
    simulation.apply(what)
    robot, begin = simulation.robots[what.robot], simulation.steps
    while robot.is_on_errand:
        simulation.latch()
        for _ in range(10):
            if robot.is_on_errand:
                simulation.step()
    assert robot.command == (0, 0)
    return robot.memory.errand, (simulation.steps - begin) / 100


speeds = st.floats(0.05, 5)


@given(st.floats(-2, 2), speeds)
def test_a_way_is_as_long_as_asked_for_by_the_odometer(metres, speed):
    simulation = field()
    errand, seconds = perform(simulation, DriveBy(metres, speed))
    x, y, theta = simulation.robot.reckoned
    assert errand.status == "succeeded"
    assert x == pytest.approx(metres, abs=0.002)
    assert abs(y) < 0.05
    assert abs(theta) < 0.1
    assert seconds <= abs(metres) / min(speed, 0.5) * 1.1 + 1.5


@given(st.floats(-9, 9), speeds)
def test_a_turn_is_as_wide_as_asked_for_by_the_odometer_also_more_than_once_around(radians, speed):
    simulation = field()
    errand, _ = perform(simulation, TurnBy(radians, speed))
    assert errand.status == "succeeded"
    assert simulation.robot.reckoned[2] == pytest.approx(radians, abs=math.radians(0.3))


@pytest.mark.slow
@given(st.lists(st.tuples(st.floats(-2, 2), st.floats(-2, 2)), min_size=1, max_size=3), speeds)
def test_points_are_reached_one_after_the_other_by_the_odometer(points, speed):
    simulation = field()
    for x, y in points:
        errand, _ = perform(simulation, DriveTo(x, y, speed))
        assert errand.status == "succeeded"
        assert simulation.robot.reckoned[:2] == pytest.approx((x, y), abs=0.005)


def test_without_noise_the_odometer_is_right():
    simulation = field(noise=Noise())
    perform(simulation, DriveTo(0.6, -0.8))
    x, y = 0.6 * math.cos(1) + 0.8 * math.sin(1), 0.6 * math.sin(1) - 0.8 * math.cos(1)
    assert simulation.robot.pose[:2] == pytest.approx((5 + x, 5 + y), abs=0.005)


@given(st.floats(0.01, 2), speeds, st.floats(0.01, 2), speeds)
def test_a_robot_accelerates_evenly_up_to_the_speed_also_when_the_goal_changes(way, fast, far, slow):
    simulation, seen = field(), [0.0]
    for what in (DriveTo(way, 0, fast), DriveTo(far, 0, slow)):
        simulation.apply(what)
        for _ in range(60):
            simulation.step()
            seen.append(simulation.robot.command[0])
    assert max(map(abs, seen)) <= min(max(fast, slow), 0.5) + 1e-9
    assert all(abs(after - before) <= 0.05 for before, after in pairwise(seen))  # to rest
    assert sum(abs(after - before) > 0.005 + 1e-9 for before, after in pairwise(seen)) <= 2


@every("what", [DriveBy(3), DriveBy(3, 0.02), DriveTo(3, 0.4)])
def test_a_robot_that_a_wall_blocks_gives_up_and_says_how_far_it_came(what):
    simulation = field(BoxSolid((5.2, 5.3, 0.1, 2), angle=1.0))
    errand, seconds = perform(simulation, what)
    assert errand.status == "aborted"
    left = math.dist(simulation.robot.reckoned[:2], (3, 0.4 if isinstance(what, DriveTo) else 0))
    assert errand.reason == f"The robot has not moved for 1 s, {left:.2f} m before the goal."
    assert seconds < 30
    before = simulation.robot.pose
    simulation.step(100)
    assert simulation.robot.pose == pytest.approx(before, abs=0.01)


def test_a_robot_that_gets_on_too_slowly_gives_up_after_a_time_that_follows_from_way_and_speed():
    simulation = field(BoxSolid((5.3, 5.47, 0.3, 0.3), angle=1.0, push=0.3), noise=Noise())
    simulation.robot.spec = replace(simulation.robot.spec, limits=(0.5, 4))
    simulation.apply(DriveBy(1, 0.1))
    for _ in range(4000):
        if simulation.steps % 90 == 0:  # it is lifted back again and again, and its wheels do not notice
            simulation.robot.memory.odometer = replace_seen(simulation)
        simulation.step()
    errand = simulation.robot.memory.errand
    assert errand.status == "aborted"
    assert errand.reason.startswith("Not there after 35 s, ")


def replace_seen(simulation):
    """An odometer that counts from here on what it has counted already."""
    odometer = simulation.robot.memory.odometer
    return odometer._replace(seen=simulation.robot.pose)


def test_a_robot_that_was_pushed_off_its_way_has_not_driven_it():
    simulation = field(BoxSolid((5, 6.2, 6, 0.1), angle=0.3), noise=Noise())
    errand, _ = perform(simulation, DriveBy(2.5))
    assert errand.status == "aborted"
    assert errand.reason == "The robot came off its way, 0.81 m before the goal."


@every("velocity", [Drive(0.1), Drive()])
def test_a_velocity_ends_an_errand_and_drives(velocity):
    simulation = field(robots=2)
    for robot in (0, 1):
        simulation.apply(DriveBy(1, robot=robot))
    simulation.step(50)
    simulation.apply(velocity)
    assert simulation.robots[1].is_on_errand
    assert simulation.robot.memory.errand.status == "aborted"
    reason = "The robot was driven by `move`, or stopped, before that was done."
    assert simulation.robot.memory.errand.reason == reason
    simulation.step(50)
    assert simulation.robot.command == (velocity.linear, 0)


def test_a_robot_that_is_lifted_drives_on_as_its_wheels_tell_it():
    simulation = field(noise=Noise())
    simulation.apply(DriveBy(0.5))
    simulation.step(100)
    simulation.apply(PlaceRobot((2, 2, 0)))
    while simulation.robot.is_on_errand:
        simulation.step()
    assert simulation.robot.reckoned[0] == pytest.approx(0.5, abs=0.002)
    assert simulation.robot.pose[0] < 2.4


def test_a_reset_of_the_world_ends_what_its_robots_do():
    simulation = field()
    simulation.apply(DriveBy(2))
    simulation.apply(Say("Off I go"))
    simulation.step(50)
    simulation.reset()
    assert simulation.robot.memory.errand is None
    assert simulation.said() == ""


def test_a_robot_says_a_text_for_a_time_that_follows_from_its_length_and_drives_meanwhile():
    simulation = field()
    simulation.apply(DriveBy(2))
    simulation.apply(Say("Hello"))
    simulation.step(139)
    assert simulation.said() == "Hello"
    simulation.step()
    assert simulation.said() == ""
    simulation.apply(Say("A longer text"))
    simulation.step(140)
    assert simulation.said() == "A longer text"
    simulation.apply(Say(""))
    assert simulation.said() == ""
    assert simulation.robot.is_on_errand


@pytest.mark.parametrize(
    ("what", "sentence"),
    [
        (DriveBy(math.nan), "Expected a finite number, not nan"),
        (DriveTo(0, math.inf), "Expected a finite number, not inf"),
        (TurnBy(1, math.nan), "Expected a finite number, not nan"),
        (DriveBy(2e3), "2000 m is too far: the farthest is 1000 m"),
        (DriveBy(1, 0), "`speed` must be greater than 0, not 0: the way says in which direction"),
        (TurnBy(1, -1), "`speed` must be greater than 0, not -1"),
        (DriveTo(1, 1, robot=1), "There is no robot 1"),
        (Say("x" * 201), "A text has at most 200 characters, not 201"),
    ],
)
def test_what_cannot_be_done_is_refused(what, sentence):
    simulation = field()
    with pytest.raises(ValueError, match=sentence):
        simulation.apply(what)
    assert simulation.robot.memory.errand is None


def test_a_robot_that_has_done_its_errand_lets_the_world_rest(monkeypatch):
    simulation = Simulation(load("boxes"))
    perform(simulation, DriveBy(0.2))
    simulation.apply(Say("Done, and here I stay."))
    simulation.step(300)
    made, make_step = [], simulation._space.step
    monkeypatch.setattr(simulation._space, "step", lambda dt: made.append(dt) or make_step(dt))
    simulation.step(100)
    assert made == []
    simulation.apply(TurnBy(1))
    simulation.step(100)
    assert len(made) == 100

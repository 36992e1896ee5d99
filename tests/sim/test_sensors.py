import math
import statistics

import pytest
from support.tables import every

from lrp_jupyter.sim import Simulation, World
from lrp_jupyter.sim.world import BoxSolid, DiscSolid, FloorSpec, Noise, PathStroke, RobotSpec


def room(pose=(1, 1, 0), *, solids=(), strokes=(), size=(4, 2), seed=0, **robot):
    spec = RobotSpec(pose, **robot)
    return Simulation(World(size, (spec,), FloorSpec(strokes=strokes), tuple(solids), seed=seed))


def test_light_sensors_look_ahead_and_aside():
    line = PathStroke(((0, 1.06), (4, 1.06)))
    simulation = room((1, 1, math.pi / 2), strokes=[line], light=((0.06, 0), (0.06, 0.05), (0, 0)))
    assert simulation.latch().lights == (0, 0, 255)


def test_readings_are_plain_numbers():
    readings = room().latch()
    assert [type(value) for value in (*readings.lights, readings.bumper)] == [int, int]
    assert [type(value) for value in (*readings.distances, readings.gyro, *readings.odom)] == [float] * 5


@every(("heading", "distance"), [(0, 0.42), (math.pi, 0.92), (math.pi / 4, math.inf)])
def test_the_distance_is_from_the_rim_to_the_next_solid_in_range(heading, distance):
    simulation = room(
        (1, 1, heading), solids=[DiscSolid((1.6, 1, 0.1)), BoxSolid((3, 1, 0.1, 2))], distance=((0, 1.0),)
    )
    assert simulation.latch().distances == (pytest.approx(distance),)


def test_every_ray_has_its_bearing():
    simulation = room((1, 0.5, 0), distance=((math.pi / 2, 3), (-math.pi / 2, 3)))
    assert simulation.latch().distances == pytest.approx((1.42, 0.42))


def test_a_ray_sees_other_robots_and_not_its_own():
    robots = (RobotSpec((1, 1, 0)), RobotSpec((2, 1, 0)))
    simulation = Simulation(World((4, 2), robots))
    simulation.latch()
    assert simulation.robot.readings.distances == pytest.approx((0.84,))
    assert simulation.robots[1].readings.distances == pytest.approx((1.92,))


def test_an_open_world_has_no_wall_to_see_or_to_bump_into():
    simulation = Simulation(World((1, 1), (RobotSpec((0.5, 0.5, 0)),), open=True))
    assert simulation.latch().distances == (math.inf,)
    simulation.drive(0.5)
    simulation.step(300)
    assert simulation.robot.pose[0] > 1.5


def test_the_bumper_is_pressed_by_what_is_in_front():
    simulation = room((1, 1, 0), solids=[BoxSolid((1.3, 1, 0.1, 0.3))])
    simulation.drive(0.2)
    pressed = []
    for _ in range(20):
        pressed.append(simulation.latch().bumper)
        simulation.step(10)
    assert pressed[0] == 0
    assert pressed[-1] == 1
    assert pressed == sorted(pressed)  # once pressed it stays so, while the robot pushes
    assert simulation.robot.memory.touched == {0}


def test_the_bumper_does_not_feel_what_is_behind():
    simulation = room((1, 1, 0), solids=[BoxSolid((0.7, 1, 0.1, 0.3))])
    simulation.drive(-0.2)
    simulation.step(200)
    assert simulation.latch().bumper == 0
    assert simulation.robot.memory.touched == {0}
    assert simulation.robot.pose[0] == pytest.approx(0.83, abs=0.002)


def test_a_short_bump_is_latched_for_one_loop():
    simulation = room((1, 1, 0), solids=[BoxSolid((1.16, 1, 0.1, 0.3))])
    simulation.latch()
    simulation.drive(0.5)
    simulation.step(6)
    simulation.drive(-0.5)
    simulation.step(30)
    assert simulation.robot.pose[0] < 0.99  # far from the wall again
    assert simulation.latch().bumper == 1
    simulation.step(10)
    assert simulation.latch().bumper == 0


def test_reading_twice_in_one_step_returns_the_same():
    simulation = room((1, 1, 0), solids=[BoxSolid((1.132, 1, 0.1, 0.3))])
    simulation.drive(0.2)
    simulation.step(10)
    first = simulation.latch()
    assert first.bumper == 1
    assert simulation.latch() == first


def test_a_robot_without_sensors_reads_nothing():
    simulation = room(light=(), bumper=False, distance=(), solids=[BoxSolid((1.2, 1, 0.1, 0.3))])
    simulation.drive(0.3)
    simulation.step(100)
    readings = simulation.latch()
    assert (readings.lights, readings.bumper, readings.distances) == ((), 0, ())


def test_the_gyro_counts_full_turns():
    simulation = room()
    simulation.drive(angular=1.0)
    simulation.step(1000)
    assert simulation.latch().gyro == pytest.approx(10, abs=0.05)


def test_odometry_is_in_the_frame_of_the_start():
    simulation = room((1, 0.5, math.pi / 2))
    for linear, angular in ((0.2, 0), (0, -1), (0.2, 0.4)):
        simulation.drive(linear, angular)
        for _ in range(10):
            simulation.step(10)
            simulation.latch()
    x, y, theta = simulation.robot.readings.odom
    true_x, true_y, heading = simulation.robot.pose
    assert (x, y) == pytest.approx((true_y - 0.5, 1 - true_x))  # forward is up, left is to the left
    assert theta == pytest.approx(heading - math.pi / 2)


def test_odometry_does_not_notice_being_carried():
    simulation = room()
    simulation.drive(0.2)
    simulation.step(50)
    simulation.place((3, 0.5, 2))
    simulation.step(50)
    odom = simulation.latch().odom
    assert odom == pytest.approx((0.2, 0, 0), abs=0.01)
    assert simulation.robot.readings.gyro == pytest.approx(2)  # the gyro does


def test_noise_is_as_large_as_configured_and_drawn_once_per_loop():
    noise = Noise(light=20, distance=0.05, gyro=0.1)
    simulation = room(strokes=[PathStroke(((1.06, 1),), width=0.1, grey=128)], noise=noise)
    readings = [simulation.latch() for _ in range(500)]
    assert simulation.robot.readings is readings[-1]
    assert statistics.stdev(reading.lights[0] for reading in readings) == pytest.approx(20, rel=0.15)
    assert {reading.distances for reading in readings} == {(math.inf,)}  # nothing stays nothing
    assert statistics.stdev(reading.gyro for reading in readings) == pytest.approx(0.1, rel=0.15)


def test_distance_noise_never_makes_a_distance_negative():
    simulation = room(solids=[BoxSolid((1.15, 1, 0.1, 0.5))], noise=Noise(distance=0.1))
    ways = [simulation.latch().distances[0] for _ in range(300)]
    assert min(ways) == 0
    assert max(ways) > 0.1


def test_distance_sensors_that_drop_out_see_nothing_for_ten_ticks():
    simulation = room(solids=[BoxSolid((1.5, 1, 0.1, 0.5))], noise=Noise(dropout=0.05))
    seen = "".join("_" if math.isinf(simulation.latch().distances[0]) else "#" for _ in range(1000))
    gaps = [len(gap) for gap in seen.split("#") if gap]
    assert 10 < len(gaps) < 60
    assert set(gaps[:-1]) == {10}


def test_motor_noise_makes_a_straight_way_crooked():
    simulation = room(noise=Noise(motor=0.2))
    simulation.drive(0.2)
    for _ in range(50):
        simulation.latch()
        simulation.step(10)
    x, y, heading = simulation.robot.pose
    assert 1.6 < x < 2.4
    assert y != 1
    assert heading != 0


def test_odometry_noise_adds_up():
    simulation = room(noise=Noise(odom=0.1))
    simulation.drive(0.2)
    for _ in range(50):
        simulation.step(10)
        simulation.latch()
    x, _, _ = simulation.robot.readings.odom
    assert x == pytest.approx(1, abs=0.1)
    assert x != pytest.approx(simulation.robot.pose[0] - 1, abs=1e-6)


def test_another_seed_is_another_noise():
    noisy = {seed: room(noise=Noise(light=20), seed=seed).latch().lights for seed in range(20)}
    assert noisy[3] == room(noise=Noise(light=20), seed=3).latch().lights
    assert len(set(noisy.values())) > 5

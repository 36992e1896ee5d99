"""Solids that move by themselves, on a patrol, to and fro or round."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.sim import PlaceSolid, PutSolid, Simulation, World, load
from lrp_jupyter.sim.svg import svg
from lrp_jupyter.sim.world import BoxSolid, DiscSolid, Patrol, RobotSpec
from lrp_jupyter.sim.world_reading import read_world

TO_AND_FRO = Patrol(((1.0, 0.0),), speed=0.2)
ROUND = Patrol(((1.0, 0.0), (1.0, 0.5)), speed=0.2, closed=True)


def with_patrol(patrol, robot=(0.2, 0.2, 0)):
    solid = BoxSolid((1, 1, 0.2, 0.2), name="cart", patrol=patrol)
    return Simulation(World((3, 2), (RobotSpec(robot),), solids=(solid,)))


def test_it_goes_to_and_fro_at_its_speed():
    simulation = with_patrol(TO_AND_FRO)
    places = []
    for _ in range(20):
        simulation.step(100)
        places.append(simulation.solids[0].pose)
    across = [0.2, 0.4, 0.6, 0.8, 1.0, 0.8, 0.6, 0.4, 0.2, 0.0] * 2
    assert [x for x, _, _ in places] == pytest.approx([1 + each for each in across])
    assert {(round(y, 9), angle) for _, y, angle in places} == {(1, 0)}


def test_a_closed_course_goes_round():
    simulation = with_patrol(ROUND)
    simulation.step(600)
    assert simulation.solids[0].pose[:2] == pytest.approx((2, 1.2))
    simulation.step(150 + 100)
    back = math.hypot(1, 0.5)
    assert simulation.solids[0].pose[:2] == pytest.approx((2 - 0.2 / back, 1.5 - 0.1 / back))


@given(st.floats(0, 1000), st.booleans(), st.floats(0.01, 2))
def test_it_jumps_nowhere_and_repeats_itself(time, closed, speed):
    patrol = Patrol(((0.3, 0.1), (0.3, -0.4), (-0.2, 0.0)), speed, closed)
    assert math.dist(patrol.at(time), patrol.at(time + 0.01)) <= speed * 0.01 + 1e-9
    points = patrol.points((0, 0))
    way = sum(map(math.dist, points, points[1:])) * (1 if closed else 2)
    assert patrol.at(time + way / speed) == pytest.approx(patrol.at(time), abs=1e-6)


def test_it_pushes_the_robot_and_presses_its_bumper_and_is_seen_coming():
    simulation = with_patrol(replace(TO_AND_FRO, path=((-0.7, 0.0),)), robot=(0.5, 1, 0))
    seen = []
    while not simulation.latch().bumper:
        seen.append(simulation.latch().distances[0])
        simulation.step(10)
    assert seen == sorted(seen, reverse=True)
    assert seen[0] == pytest.approx(0.32)
    simulation.step(100)
    simulation.latch()
    assert simulation.robot.memory.touched == {0}
    assert simulation.robot.pose[0] < 0.4


def test_it_pushes_a_box_aside():
    world = World(
        (3, 2),
        (RobotSpec((0.2, 0.2, 0)),),
        solids=(BoxSolid((1, 1, 0.2, 0.2), patrol=TO_AND_FRO), DiscSolid((1.5, 1, 0.1), push=0.3)),
    )
    simulation = Simulation(world)
    simulation.step(400)
    assert simulation.solids[1].pose[0] == pytest.approx(1.8 + 0.1 + 0.1, abs=0.01)


def test_a_world_in_which_something_moves_is_never_at_rest():
    simulation = with_patrol(TO_AND_FRO)
    simulation.step(5000)  # over checkpoints
    assert simulation.solids[0].pose[0] == pytest.approx(1.0)
    simulation.step(250)
    assert simulation.solids[0].pose[0] == pytest.approx(1.5)


def test_a_reset_begins_its_course_again():
    simulation = with_patrol(ROUND)
    simulation.step(333)
    simulation.reset()
    assert simulation.solids[0].pose == (1, 1, 0)
    simulation.step(100)
    assert simulation.solids[0].pose == pytest.approx((1.2, 1, 0))


def test_moved_by_hand_it_goes_on_from_there():
    simulation = with_patrol(TO_AND_FRO)
    simulation.step(100)
    simulation.place_solid(0, (1.5, 0.5, 0.3))
    simulation.step(150)
    assert simulation.solids[0].pose == pytest.approx((1.8, 0.5, 0.3))
    assert simulation.solids[0].patrol == ((pytest.approx(1.3), 0.5), (pytest.approx(2.3), 0.5))


def test_edits_of_other_things_do_not_disturb_it():
    simulation, other = with_patrol(TO_AND_FRO), with_patrol(TO_AND_FRO)
    for each in (simulation, other):
        each.step(123)
        each.apply(PlaceSolid((1.4, 1.2, 0), 0))
        each.step(50)
    simulation.apply(PutSolid(DiscSolid((0.3, 1.7, 0.1))))
    for each in (simulation, other):
        each.step(50)
    assert simulation.solids[0].pose == pytest.approx(other.solids[0].pose)


def test_what_replaces_it_is_where_it_was_put_and_keeps_its_patrol():
    simulation = with_patrol(TO_AND_FRO)
    simulation.step(100)
    larger = BoxSolid((1.4, 1.0, 0.3, 0.3), name="cart")
    simulation.apply(PutSolid(simulation.continued(larger, 0), 0))
    assert simulation.solids[0].pose == pytest.approx((1.4, 1, 0))
    simulation.step(100)
    assert simulation.solids[0].pose == pytest.approx((1.6, 1, 0))
    assert simulation.world.solids[0].patrol == TO_AND_FRO
    pushable = replace(larger, push=0.3)
    assert simulation.continued(pushable, 0) == pushable


def test_patrols_are_written_and_read_without_loss():
    world = with_patrol(ROUND).world
    assert read_world(world.to_dict()) == world
    assert '"patrol":{"path":[[1.0,0.0],[1.0,0.5]],"closed":true}' in world.to_json()
    assert "patrol" not in load("boxes").to_json()


def test_it_is_drawn_with_its_patrol():
    picture = svg(with_patrol(ROUND))
    assert "#8fc7c3" in picture
    assert 'd="M1 1L2 1L2 1.5L1 1"' in picture


def test_a_robot_can_wait_at_the_bundled_crossing():
    simulation = Simulation("crossing")
    for _ in range(1000):
        near = simulation.latch().distances[0] < 0.25
        simulation.drive(0.0 if near else 0.25)
        assert not simulation.robot.memory.touched
        simulation.step(10)
        if "goal" in simulation.zones():
            return
    pytest.fail("It does not arrive.")

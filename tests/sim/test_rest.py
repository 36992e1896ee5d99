from dataclasses import replace
from random import Random

import pytest
from support.seeds import seeds

from lrp_jupyter.sim import Simulation, load
from lrp_jupyter.sim.rest import Rest


def against_the_wall():
    simulation = Simulation("line")
    simulation.place((0.5, 0.5, 3.14159))
    simulation.drive(0.2)
    simulation.step(100)
    assert simulation.latch().bumper == 1
    simulation.drive(0.0)
    return simulation


def count_steps(simulation, monkeypatch):
    """Return a list that grows with every step of physics."""
    made, make_step = [], simulation._space.step
    monkeypatch.setattr(simulation._space, "step", lambda dt: made.append(dt) or make_step(dt))
    return made


@pytest.mark.parametrize("make", [lambda: Simulation("line"), lambda: Simulation("boxes"), against_the_wall])
def test_a_world_in_which_nothing_moves_needs_no_physics(make, monkeypatch):
    simulation = make()
    simulation.step(300)
    made = count_steps(simulation, monkeypatch)
    simulation.step(100)
    assert made == []
    simulation.drive(-0.1)
    simulation.step(100)
    assert len(made) == 100


def test_a_robot_that_rests_against_a_wall_still_presses_its_bumper():
    simulation = against_the_wall()
    for _ in range(50):
        simulation.step(10)
        readings = simulation.latch()
        assert readings.bumper == 1
        assert simulation.robot.memory.touched == {0}


@pytest.mark.parametrize(
    "by_hand", [lambda s: s.place((1, 0.6, 0)), lambda s: s.place_solid(0, (1.2, 1, 0.3))]
)
def test_a_world_at_rest_is_disturbed_by_hand(by_hand, monkeypatch):
    simulation = Simulation("boxes")
    simulation.step(300)
    made = count_steps(simulation, monkeypatch)
    by_hand(simulation)
    simulation.step(1)
    assert len(made) == 1


def drive_and_stop(world, seed):
    """Return all that is seen of a run with many stops, some of them at a wall or a box."""
    simulation, random = Simulation(world, seed), Random(seed)
    seen = []
    for _ in range(30):
        speeds = random.choice([(0.4, 0.0), (0.3, 0.5), (-0.3, 0.0), (0.0, 0.0), (0.0, 1.0)])
        for _ in range(random.choice([2, 15, 40])):
            readings = simulation.latch()
            simulation.drive(*speeds)
            simulation.step(random.randint(1, 10))
            memory = simulation.robot.memory
            solids = [solid.body.motion() for solid in simulation.solids]
            seen.append((readings, replace(memory), simulation.robot.body.motion(), solids))
    return seen


@pytest.mark.parametrize("seed", seeds(1, 4))
@pytest.mark.parametrize("world", ["line", "boxes", "walls"])
def test_steps_that_are_left_out_would_have_changed_nothing(world, seed, monkeypatch):
    short = drive_and_stop(load(world), seed)
    monkeypatch.setattr(Rest, "observe", lambda rest, step: None)
    assert drive_and_stop(load(world), seed) == short

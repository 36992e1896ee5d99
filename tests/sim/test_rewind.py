from dataclasses import replace
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.seeds import seeds
from support.tables import every

from lrp_jupyter.sim import (
    Draw,
    Drive,
    DriveBy,
    DriveTo,
    Lamp,
    Latch,
    Pen,
    PlaceRobot,
    PlaceSolid,
    PutSolid,
    RemoveSolid,
    ResetWorld,
    Say,
    SetStart,
    Simulation,
    TurnBy,
    WorldError,
    input_log,
    load,
)
from lrp_jupyter.sim.world import BoxSolid, DiscSolid, Noise, Patrol


def crowded():
    """A narrow room full of boxes, one of them moving by itself, and two noisy robots: much is touching."""
    world = load("boxes")
    noise = Noise(motor=0.2, light=10, distance=0.01, gyro=0.01, odom=0.05, dropout=0.03)
    return replace(
        world,
        size=(1.6, 1.3),
        robots=(
            replace(world.robots[0], pose=(0.5, 0.57, 0), noise=noise),
            replace(world.robots[0], pose=(0.3, 0.57, 0), noise=noise, name="other"),
        ),
        solids=tuple(
            replace(
                box,
                box=(0.75 + 0.22 * (index % 3), 0.35 + 0.22 * (index // 3), 0.2, 0.2),
                push=None if index == 7 else 0.3,
                patrol=Patrol(((0.05, 0.1), (0.2, 0.1)), 0.1, closed=True) if index == 7 else None,
            )
            for index, box in enumerate([world.solids[0]] * 9)
        ),
    )


def everything(simulation):
    """All that can be known of a running world."""
    return (
        simulation.moment,
        simulation.world,
        [robot.body.motion() for robot in simulation.robots],
        [robot.memory for robot in simulation.robots],
        [thing.body.motion() for thing in simulation.solids],
        [(step, paint, piece.ends()) for step, paint, piece in simulation.floor.marks],
        simulation._random.getstate(),
    )


def seen(simulation):
    """The same without identities."""
    moment, world, robots, memories, solids, marks, random = everything(simulation)
    return (
        moment,
        world,
        robots,
        [replace(memory, pen=None) for memory in memories],
        solids,
        [(step, paint.grey, ends) for step, paint, ends in marks],
        random,
    )


def drive_about(simulation, random, loops):
    for _ in range(loops):
        simulation.latch()
        if random.random() < 0.7:
            simulation.drive(random.uniform(-0.1, 0.5), random.uniform(-1, 1), random.randint(0, 1))
        if random.random() < 0.1:
            simulation.apply(DriveTo(random.uniform(-0.2, 0.6), random.uniform(-0.3, 0.3), 0.4, 1))
            simulation.apply(TurnBy(random.uniform(-3, 3), 2.0))
            simulation.apply(Say("x" * random.randint(0, 20)))
        if random.random() < 0.05:
            simulation.pen(random.random() < 0.7)
        simulation.lamp(random.random() < 0.5)
        if random.random() < 0.02:
            simulation.place((random.uniform(0.2, 1.4), random.uniform(0.2, 1.1), random.uniform(0, 6)))
        simulation.step(10)


@pytest.mark.parametrize("seed", seeds(2, 30))
def test_a_fork_and_going_back_are_the_run_as_it_was_and_go_on_as_it_did_though_things_touch(seed):
    simulation = Simulation(crowded(), seed)
    simulation.drive(0.4)
    simulation.step(100)  # into the boxes
    drive_about(simulation, Random(seed), 140)
    moment, there = simulation.moment, seen(simulation)
    drive_about(simulation, Random(-seed), 120)  # over a checkpoint
    straight = seen(simulation)
    assert any(thing.pose != thing.start_motion(0)[:3] for thing in simulation.solids)
    fork = simulation.fork(moment)
    assert seen(fork) == there
    drive_about(fork, Random(-seed), 120)
    assert seen(fork) == seen(simulation) == straight, "and the run has not noticed"
    simulation.rewind(moment)
    assert seen(simulation) == there
    drive_about(simulation, Random(-seed), 120)
    assert seen(simulation) == straight


def test_two_runs_with_the_same_seed_are_the_same():
    runs = []
    for seed in (1, 1, 2):
        simulation = Simulation(crowded(), seed)
        drive_about(simulation, Random(5), 150)
        runs.append(seen(simulation))
    assert runs[0] == runs[1] != runs[2]


poses = st.tuples(st.floats(0, 1.6), st.floats(0, 1.3), st.floats(-3, 3))
inputs = st.one_of(
    st.just(Latch()),
    st.builds(Drive, st.floats(-0.5, 0.5), st.floats(-3, 3), st.integers(0, 1)),
    st.builds(DriveBy, st.floats(-0.5, 0.5), st.floats(0.05, 0.5), st.integers(0, 1)),
    st.builds(TurnBy, st.floats(-3, 3), st.floats(0.05, 4), st.integers(0, 1)),
    st.builds(DriveTo, st.floats(-1, 1), st.floats(-1, 1), st.floats(0.05, 0.5), st.integers(0, 1)),
    st.builds(Say, st.text(max_size=9), st.integers(0, 1)),
    st.builds(Pen, st.booleans(), robot=st.integers(0, 1)),
    st.builds(Lamp, st.booleans(), st.integers(0, 1)),
    st.builds(
        PlaceRobot, st.tuples(st.floats(0, 1.6), st.floats(0, 1.3), st.floats(-3, 3)), st.integers(0, 1)
    ),
    st.builds(
        PlaceSolid, st.tuples(st.floats(0, 1.6), st.floats(0, 1.3), st.floats(-3, 3)), st.integers(0, 8)
    ),
    st.builds(
        Draw, st.lists(st.tuples(st.floats(0, 1.6), st.floats(0, 1.3)), min_size=1, max_size=3).map(tuple)
    ),
    st.just(ResetWorld()),
    st.builds(
        PutSolid,
        st.sampled_from(
            [
                BoxSolid((1.4, 0.2, 0.2, 0.1), push=0.3),
                BoxSolid((0.9, 0.57, 0.1, 0.4)),
                BoxSolid((0.5, 0.9, 0.1, 0.1), patrol=Patrol(((0.3, 0),))),
                DiscSolid((1, 0.6, 0.1)),
            ]
        ),
        st.none() | st.integers(0, 8),
    ),
    st.builds(RemoveSolid, st.integers(0, 8)),
    st.builds(SetStart, poses),
)


def possible(script):
    """The part of a script in which no solid is replaced or removed that is not there."""
    simulation, done = Simulation(crowded()), []
    for what, steps in script:
        try:
            simulation.apply(what)
        except (ValueError, WorldError):
            continue
        done.append((what, steps))
    return done


@pytest.mark.slow
@given(st.lists(st.tuples(inputs, st.integers(0, 60)), min_size=1, max_size=25).map(possible), st.data())
def test_whatever_acts_every_moment_can_be_gone_back_to(script, data):
    simulation = Simulation(crowded())
    moments = [(simulation.moment, seen(simulation))]
    for what, steps in script:
        simulation.apply(what)
        moments.append((simulation.moment, seen(simulation)))
        simulation.step(steps)
    straight = seen(simulation)
    index = data.draw(st.integers(0, len(moments) - 1))
    moment, there = moments[index]
    simulation.rewind(moment)
    assert seen(simulation) == there
    steps = script[index - 1][1] if index else 0
    simulation.step(steps)
    for what, steps in script[index:]:
        simulation.apply(what)
        simulation.step(steps)
    assert seen(simulation) == straight


def test_a_step_is_the_moment_before_its_inputs():
    simulation = Simulation("empty")
    simulation.step(100)
    simulation.reset()
    simulation.drive(0.2)
    simulation.step(50)
    simulation.rewind(100)
    assert simulation.moment == (100, 0)
    assert simulation.robot.command == (0, 0)


def test_rewinding_undoes_a_reset():
    simulation = Simulation("empty")
    simulation.pen(grey=0)
    simulation.drive(0.2)
    simulation.step(200)
    moment, there = simulation.moment, seen(simulation)
    simulation.reset()
    simulation.step(100)
    simulation.rewind(moment)
    assert seen(simulation) == there
    assert simulation.floor.light(1.6, 1) == 0


def test_rewinding_undoes_drawings():
    simulation = Simulation("empty")
    moment = simulation.moment
    simulation.draw(((1, 1), (2, 1)))
    simulation.rewind(moment)
    assert simulation.floor.light(1.5, 1) == 255


@every("step", [-1, 11])
def test_only_what_has_been_can_be_gone_back_to(step):
    simulation = Simulation("empty")
    simulation.step(10)
    with pytest.raises(ValueError, match=r"Cannot rewind to step -?1+: only steps 0 to 10 can be reached"):
        simulation.rewind(step)


def test_a_moment_of_a_future_that_was_undone_is_refused():
    simulation = Simulation("empty")
    moment = simulation.moment
    simulation.latch()
    later = simulation.moment
    simulation.rewind(moment)
    with pytest.raises(ValueError, match="Cannot rewind"):
        simulation.rewind(later)


def test_memory_is_bounded_by_forgetting_the_oldest(monkeypatch):
    monkeypatch.setattr(input_log, "MOST_CHECKPOINTS", 3)
    simulation = Simulation("empty")
    simulation.step(5500)
    assert simulation.earliest == 3000
    simulation.rewind(3000)
    assert simulation.time == 30


def test_a_moment_before_what_is_remembered_of_its_step_is_refused(monkeypatch):
    monkeypatch.setattr(input_log, "MOST_CHECKPOINTS", 1)
    simulation = Simulation("empty")
    simulation.step(10)
    moment = simulation.moment
    simulation.reset()
    for go_to in (simulation.fork, simulation.rewind):
        with pytest.raises(ValueError, match=r"^Step 10 is too long ago: the log begins in step 10\.$"):
            go_to(moment)


def test_many_inputs_are_bounded_too(monkeypatch):
    monkeypatch.setattr(input_log, "CHECKPOINT_INPUTS", 10)
    monkeypatch.setattr(input_log, "MOST_INPUTS", 50)
    simulation = Simulation(crowded())
    for _ in range(30):
        simulation.latch()
        simulation.drive(0.3)
        simulation.step(10)
    moment = simulation.moment
    for _ in range(10):
        simulation.latch()
        simulation.step(10)
    straight = seen(simulation)
    assert simulation.earliest > 0
    simulation.rewind(moment)
    for _ in range(10):
        simulation.latch()
        simulation.step(10)
    assert seen(simulation) == straight


def test_a_world_that_was_closed_can_be_forked():
    simulation = Simulation(crowded(), 1)
    drive_about(simulation, Random(1), 30)
    moment, there = simulation.moment, seen(simulation)
    simulation.close()
    assert seen(simulation.fork(moment)) == there

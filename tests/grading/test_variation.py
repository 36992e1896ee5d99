"""Seeds put things elsewhere: as far as a challenge allows, alike each time, in the lab as in the marks."""

import itertools
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter import Session
from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import Criterion, drives, ends_in, visits
from lrp_jupyter.grading.grade import grade
from lrp_jupyter.grading.variation import moves, shades, varied, wears
from lrp_jupyter.sim import worlds
from lrp_jupyter.sim.floor import LiveFloor
from lrp_jupyter.sim.mirror import mirrored
from lrp_jupyter.sim.world import BoxSolid, CircleZone, FloorSpec, PathStroke, RobotSpec, World

YARD = World(
    name="yard",
    size=(3, 2),
    floor=FloorSpec(strokes=(PathStroke(((1, 0), (1, 2))),)),
    robots=(RobotSpec((0.5, 1, 0)),),
    solids=(BoxSolid((2, 1, 0.1, 1), name="wall"),),
    zones={"goal": CircleZone((1, 1, 0.1)), "start": CircleZone((0.5, 1, 0.1))},
)
FAR = st.floats(0, 0.3)


@given(FAR, FAR, st.integers())
def test_what_moves_moves_together_within_its_bounds_and_nothing_else_does(x, y, seed):
    world = varied(YARD, [moves("floor", "goal", x=x, y=y)], seed)
    (stroke,) = world.floor.strokes
    by = stroke.path[0][0] - 1, stroke.path[0][1]
    assert abs(by[0]) <= x + 1e-9
    assert abs(by[1]) <= y + 1e-9
    assert world.zones["goal"].circle[:2] == pytest.approx((1 + by[0], 1 + by[1]))
    assert (world.robots, world.solids, world.zones["start"]) == (
        YARD.robots,
        YARD.solids,
        YARD.zones["start"],
    )


def test_the_same_seed_varies_a_world_alike_and_others_otherwise():
    vary = [moves("robot", x=0.1, degrees=20), moves("wall", y=0.2, degrees=5), shades(30)]
    worlds = [varied(YARD, vary, seed) for seed in range(20)]
    assert worlds == [varied(YARD, vary, seed) for seed in range(20)]
    assert len({world.robots[0].pose for world in worlds}) == 20
    assert len({world.solids[0].angle for world in worlds}) == 20
    assert all(225 <= world.floor.grey <= 255 for world in worlds)
    assert all(0 <= world.floor.strokes[0].grey <= 30 for world in worlds)


def test_what_a_world_does_not_have_is_refused_with_the_nearest_name():
    with pytest.raises(LRPError, match="nothing named `gaol`"):
        moves("gaol", x=1).of(YARD, random.Random(0))


AXES = [{"x": True}, {"y": True}, {"x": True, "y": True}]


@pytest.mark.parametrize("axes", AXES, ids=" ".join)
def test_the_floor_of_a_mirrored_world_is_its_mirror_image(axes):
    for world in map(worlds.load, worlds.BUNDLED):
        width, height = world.size
        floor, other = LiveFloor(world.floor), LiveFloor(mirrored(world, "mirrored", **axes).floor)
        for x, y in itertools.product(range(1, 60), range(1, 40)):
            x, y = width * x / 60, height * y / 40
            there = width - x if axes.get("x") else x, height - y if axes.get("y") else y
            assert other.light(*there) == pytest.approx(floor.light(x, y), abs=1)


LOOKING_AROUND = """
(machine m (state on (running [robot.move(angular={}); far.append(robot.distance.data)]))) (spawn m on)
"""


@pytest.mark.parametrize("axes", AXES, ids=" ".join)
def test_a_robot_that_turns_the_other_way_sees_in_the_mirror_what_it_sees_here(axes):
    seen = []
    other = mirrored(worlds.load("boxes"), "mirrored", **axes)
    for world, angular in (("boxes", 0.5), (other, 0.5 if len(axes) == 2 else -0.5)):
        far = []
        with Session(LOOKING_AROUND.format(angular), "sim", world=world, namespace={"far": far}) as session:
            session.run(13)
        seen.append(far)
    assert seen[0] == pytest.approx(seen[1], abs=1e-6)


@pytest.mark.slow
def test_wheels_wear_within_their_bounds_and_a_robot_drives_as_they_turn():
    worn = [varied(YARD, [wears(0.2, 0.1)], seed) for seed in range(20)]
    wheels = [world.robots[0].wheels for world in worn]
    assert len(set(wheels)) == 20
    for left, right in wheels:
        assert 0.8 * 0.9 <= left <= 1.2 * 1.1
        assert 0.9 / 1.1 <= left / right <= 1.1 / 0.9
    assert varied(worn[0], [moves("robot")], 1).robots[0].wheels == wheels[0]
    driven = [grade(BY_THE_CLOCK, Challenge("there", "", world, drives(0.5), 9)).passed for world in worn]
    assert set(driven) == {True, False}


BY_THE_CLOCK = """
(machine m (state driving (running [robot.move(linear=0.2)])) (state there (onentry [robot.stop()]))
  (ontime 2500 driving -> there))
(spawn m driving)
"""


def test_a_program_that_knows_where_things_are_does_not_get_there():
    there = Challenge("there", "Drive to the goal.", YARD, ends_in("goal"), seconds=5, seeds=5)
    assert grade(BY_THE_CLOCK, there).passed
    elsewhere = Challenge(
        "there", "", YARD, ends_in("goal"), seconds=5, seeds=5, vary=moves("goal", "floor", x=0.3)
    )
    assert not grade(BY_THE_CLOCK, elsewhere).passed


PULSES = """
(machine m (state driving (running [robot.move(linear=0.2)])) (state resting)
  (ontime 500 driving -> resting) (ontime 500 resting -> driving))
(spawn m driving)
"""


def test_what_is_asked_of_the_end_has_to_hold_for_a_while():
    """A robot that comes to the goal and drives on was there for a moment, not at the end."""
    passing = Challenge("through", "", YARD, visits("goal"), seconds=9)
    assert grade(PULSES, passing).passed
    staying = Challenge("to", "", YARD, ends_in("goal"), seconds=9)
    assert not grade(PULSES, staying).passed
    (attempt,) = grade(BY_THE_CLOCK, staying).attempts
    assert attempt.passed
    assert attempt.seconds == pytest.approx(2.0 + 4, abs=0.3)  # from when it came to the goal


def test_what_is_met_in_time_may_hold_beyond_it_and_must_not_be_broken_there():
    slow = BY_THE_CLOCK.replace("2500", "2600")
    assert grade(slow, Challenge("just", "", YARD, ends_in("goal"), seconds=3)).passed
    through = BY_THE_CLOCK.replace("2500", "4500")
    assert not grade(through, Challenge("just", "", YARD, ends_in("goal"), seconds=2.5)).passed


def test_a_challenge_that_asks_nothing_of_the_end_ends_at_once():
    assert Challenge("once", "", YARD, visits("goal")).hold == 0
    late = Criterion("is late", lambda run: (run.seconds > 1, ""), "at the end")
    assert Challenge("end", "", YARD, [visits("goal"), late]).hold == 4

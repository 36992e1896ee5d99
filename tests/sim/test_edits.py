"""A world is edited while it runs."""

from dataclasses import replace

import pytest
from support.tables import every

from lrp_jupyter.sim import (
    Draw,
    PlaceSolid,
    PutSolid,
    PutZone,
    RemoveSolid,
    RemoveZone,
    SetStart,
    Simulation,
    World,
    WorldError,
    floor,
    load,
)
from lrp_jupyter.sim.world import BoxSolid, BoxZone, CircleZone, DiscSolid, FloorSpec, PathStroke
from lrp_jupyter.sim.world_edits import MOST_POINTS, Become, is_edit
from lrp_jupyter.sim.world_reading import read_world

WALL = BoxSolid((2.0, 1.0, 0.1, 1.0), name="wall")


def test_a_wall_that_is_put_into_a_running_world_stops_the_robot():
    simulation = Simulation("empty")
    simulation.drive(0.5)
    simulation.step(20)
    simulation.apply(PutSolid(WALL))
    simulation.step(300)
    assert simulation.robot.pose[0] == pytest.approx(2.0 - 0.05 - 0.08, abs=0.01)
    simulation.apply(RemoveSolid(0))
    simulation.step(100)
    assert simulation.robot.pose[0] > 2.2


def test_an_edit_leaves_everything_else_where_it_is():
    simulation = Simulation("boxes")
    simulation.pen(grey=0)
    simulation.drive(0.5)
    simulation.step(150)  # it pushes the first box
    boxes = [thing.body.motion() for thing in simulation.solids]
    robot, marks = simulation.robot.body.motion(), len(simulation.floor.marks)
    assert boxes[0] != simulation.solids[0].start_motion(0)
    simulation.apply(PutSolid(DiscSolid((0.2, 0.2, 0.1), push=0.3)))
    simulation.apply(PutSolid(replace(simulation.world.solids[2], push=None), 2))
    simulation.apply(RemoveSolid(1))
    kept = [thing.body.motion() for thing in simulation.solids]
    assert kept[:3] == [boxes[0], boxes[2], boxes[3]]
    assert kept[3] == (0.2, 0.2, 0, 0, 0, 0)
    assert simulation.robot.body.motion() == robot
    assert len(simulation.floor.marks) == marks


def test_a_solid_that_is_put_elsewhere_is_there_now_and_after_a_reset():
    simulation = Simulation("boxes")
    simulation.apply(PutSolid(replace(simulation.world.solids[0], box=(0.3, 1.8, 0.2, 0.2)), 0))
    assert simulation.solids[0].pose[:2] == (0.3, 1.8)
    simulation.reset()
    assert simulation.solids[0].pose[:2] == (0.3, 1.8)
    simulation.reset(drawings=True)
    assert simulation.world == load("boxes")
    assert simulation.solids[0].pose[:2] == (1.2, 1)


def test_a_reset_starts_where_the_start_was_put_and_the_gyro_does_not_jump():
    simulation = Simulation("empty")
    pose = simulation.robot.pose
    simulation.latch()
    simulation.apply(SetStart((0.4, 0.5, 1.0)))
    assert simulation.robot.pose == pose
    assert simulation.latch().gyro == 0
    simulation.reset()
    assert simulation.robot.pose == (0.4, 0.5, 1.0)
    assert simulation.latch().gyro == 0


def test_lines_lie_below_the_trails_and_stay_over_a_reset():
    simulation = Simulation("empty")
    simulation.pen(grey=0, width=0.02)
    simulation.drive(0.4)
    simulation.step(100)
    simulation.draw(((1.6, 0.5), (1.6, 1.5)), width=0.1, grey=100)
    assert simulation.floor.light(1.6, 1.0) == 0
    assert simulation.floor.light(1.6, 1.2) == 100
    simulation.reset()
    assert simulation.floor.light(1.6, 1.0) == 100


def test_zones_are_added_renamed_changed_and_removed_in_their_places():
    world = load("line")
    world = PutZone("middle", BoxZone((1, 1, 0.2, 0.2))).edited(world)
    world = PutZone("start", world.zones["near"], former="near").edited(world)
    world = PutZone("far", CircleZone((1, 1, 0.1))).edited(world)
    assert list(world.zones) == ["start", "far", "middle"]
    assert world.zones["far"] == CircleZone((1, 1, 0.1))
    assert list(RemoveZone("far").edited(world).zones) == ["start", "middle"]


@every(
    ("edit", "message"),
    [
        (RemoveSolid(9), "There is no solid 9: the world has 2."),
        (PutSolid(WALL, 2), "There is no solid 2"),
        (RemoveZone("moon"), "There is no zone `moon`."),
        (PutZone("", CircleZone((0, 0, 1))), "A zone needs a name."),
        (PutZone("far", CircleZone((0, 0, 1)), former="near"), "There is a zone `far` already"),
        (SetStart((0, 0, 0), 1), "There is no robot 1."),
    ],
)
def test_an_edit_of_what_is_not_there_is_refused_and_nothing_is_recorded(edit, message):
    simulation = Simulation("line")
    with pytest.raises(WorldError, match=message):
        simulation.apply(edit)
    assert not simulation.history.can_undo
    assert simulation.world == load("line")


def test_whatever_is_put_is_inside_of_the_world_and_the_result_is_a_world_in_json():
    world = load("empty")
    edits = [
        PutSolid(replace(WALL, box=(-5, 99, 0.1, 1))),
        PutSolid(DiscSolid((9, 9, 0.1), push=0.5, name="can")),
        PutZone("z", CircleZone((-1, -1, 0.2))),
        PutZone("y", BoxZone((9, 9, 0.2, 0.3))),
        SetStart((9, -9, 2)),
        Draw(((0, 0), (1, 1))),
        Draw(((0, 0), (1, 1)), grey=None),
    ]
    for edit in edits:
        world = edit.edited(world)
    assert world.solids[0].box[:2] == (0, 2)
    assert world.robots[0].pose == (3, 0, 2)
    assert world.floor.strokes[1].grey == 255
    assert read_world(world.to_dict()) == world
    assert is_edit(load("empty"), world)


def test_another_size_or_another_robot_is_another_world():
    world = load("empty")
    robot = replace(world.robots[0], radius=0.1)
    assert not is_edit(world, replace(world, size=(3, 3)))
    assert not is_edit(world, replace(world, robots=(robot,)))
    assert not is_edit(world, replace(world, robots=(*world.robots, robot)))
    assert not is_edit(replace(world, robots=(*world.robots, robot)), world)


def test_drawing_without_end_is_bounded():
    world = World((1, 1), load("empty").robots)
    line = Draw(tuple((0.5, 0.5) for _ in range(MOST_POINTS // 2)))
    for _ in range(4):
        world = line.edited(world)
    assert len(world.floor.strokes) == 2


def test_an_edit_that_changes_nothing_is_not_undone():
    simulation = Simulation("line")
    simulation.reset(drawings=True)
    simulation.apply(SetStart(simulation.world.robots[0].pose))
    assert not simulation.history.can_undo


def test_an_input_about_what_an_edit_before_it_removes_is_dropped():
    simulation = Simulation("empty")
    simulation.apply(PutSolid(WALL))
    simulation.submit(Become(simulation.original))
    simulation.submit(PlaceSolid((1.0, 1.0, 0.0), 0))
    simulation.submit(RemoveSolid(0))
    simulation.step(1)
    assert simulation.world == simulation.original
    assert simulation.time == 0.01


def test_a_stroke_on_a_floor_with_many_enters_only_its_own_pieces(monkeypatch):
    entered = []
    enter = floor._enter
    monkeypatch.setattr(floor, "_enter", lambda *arguments: (entered.append(1), enter(*arguments)))
    simulation = Simulation("empty")
    for y in range(1, 20):
        simulation.draw(((0.1, y / 20), (1.0, y / 20), (1.1, y / 20)))
    assert len(entered) == 2 * 19


@every("grey", [255, 100])
def test_a_floor_that_was_painted_step_by_step_is_like_one_painted_at_once(grey):
    strokes = [PathStroke(((0.1, 0.1 * n), (1.0, 0.2)), 0.05, 20 * n) for n in range(1, 8)]
    spec = FloorSpec(grey, tuple(strokes))
    ink = floor.Paint(0.05, 30, True)
    stepwise, at_once = floor.LiveFloor(FloorSpec(200)), floor.LiveFloor(spec)
    for each in (stepwise, at_once):
        each.ink(ink, (0.5, 0.0), (0.5, 1.0), 0)
    for shown in (strokes[:2], strokes[:5], strokes[1:3], strokes):
        stepwise.paint(FloorSpec(grey, tuple(shown)))
    spots = [(x / 40, y / 40) for x in range(45) for y in range(30)]
    assert [stepwise.light(*spot) for spot in spots] == [at_once.light(*spot) for spot in spots]

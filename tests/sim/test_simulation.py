import math
import threading

import pytest
from support.tables import every

from lrp_jupyter.sim import Draw, Drive, Lamp, Pen, PlaceRobot, PlaceSolid, Simulation, World, load
from lrp_jupyter.sim.sim_robot import Body
from lrp_jupyter.sim.world import BoxSolid, DiscSolid, RobotSpec, middle_of


def room(*solids, pose=(1, 1, 0), size=(4, 2)):
    return Simulation(World(size, (RobotSpec(pose),), solids=solids))


def test_a_commanded_robot_drives_straight_ahead():
    simulation = Simulation("empty")
    simulation.drive(linear=0.2)
    simulation.step(100)
    assert simulation.time == 1.0
    x, y, heading = simulation.robot.pose
    assert x == pytest.approx(1.7, abs=0.01)
    assert (y, heading) == (1, 0)


def test_a_commanded_robot_drives_a_circle():
    simulation = room()
    simulation.drive(0.2, 0.5)
    simulation.step(round(100 * 2 * math.pi / 0.5))
    assert simulation.robot.pose[:2] == pytest.approx((1, 1), abs=0.02)


def test_a_robot_with_uneven_wheels_bends_towards_the_slower_one():
    simulation = Simulation(World((4, 2), (RobotSpec((1, 1, 0), wheels=(0.8, 0.9)),)))
    for _ in range(2):
        simulation.drive(0.2)
        simulation.step(100)
        x, y, heading = simulation.robot.pose
        assert 1.1 < x < 1.17
        assert y > 1.01
        assert heading == pytest.approx(0.02 / (1.4 * 0.08), abs=0.01)
        simulation.reset()


def test_a_command_holds_until_the_next():
    simulation = room()
    simulation.drive(0.2)
    simulation.step(200)
    assert simulation.robot.command == (0.2, 0.0)
    simulation.drive()
    simulation.step(10)
    x = simulation.robot.pose[0]
    simulation.step(100)
    assert simulation.robot.pose[0] == x


def test_time_is_the_number_of_steps():
    simulation = room()
    simulation.step(12345)
    assert simulation.steps == 12345
    assert simulation.time == 123.45


def test_speeds_are_limited_to_what_the_robot_can_do():
    simulation = room()
    assert simulation.drive(9, -9) == (0.5, -4.0)


@every("speeds", [(math.nan, 0), (0, math.inf)])
def test_a_speed_must_be_a_number(speeds):
    with pytest.raises(ValueError, match="Expected a finite number"):
        room().drive(*speeds)


def test_a_wall_stops_a_robot_and_does_not_move():
    simulation = room(BoxSolid((2, 1, 0.1, 1)))
    simulation.drive(0.5)
    simulation.step(500)
    assert simulation.robot.pose[0] == pytest.approx(1.87, abs=0.002)
    assert simulation.solids[0].pose == (2, 1, 0)


def test_the_edge_of_the_world_is_a_wall():
    simulation = room(pose=(3.5, 1, 0))
    simulation.drive(0.5)
    simulation.step(300)
    assert simulation.robot.pose[0] == pytest.approx(3.92, abs=0.002)
    simulation.latch()
    assert simulation.robot.memory.touched == {-1}


@every("solid", [BoxSolid((1.4, 1, 0.2, 0.2), push=0.3), DiscSolid((1.4, 1, 0.1), push=0.3)])
def test_a_box_is_pushed_and_does_not_slide_on(solid):
    simulation = room(solid)
    simulation.drive(0.3)
    simulation.step(300)
    assert simulation.solids[0].pose[0] == pytest.approx(simulation.robot.pose[0] + 0.18, abs=0.01)
    assert simulation.robot.pose[0] > 1.6
    simulation.drive(-0.3)
    simulation.step(50)
    there = simulation.solids[0].pose
    simulation.step(100)
    assert simulation.solids[0].pose == there


def test_more_friction_than_the_wheels_grip_cannot_be_pushed():
    simulation = room(BoxSolid((1.5, 1, 0.4, 0.4), push=1.0))
    simulation.drive(0.3)
    simulation.step(300)
    assert simulation.solids[0].pose[0] == pytest.approx(1.5, abs=0.01)


def test_a_box_between_robot_and_wall_holds():
    simulation = room(BoxSolid((1.4, 1, 0.2, 0.2), push=0.3), BoxSolid((1.8, 1, 0.1, 1)))
    simulation.drive(0.5)
    simulation.step(600)
    assert simulation.solids[0].pose[0] < 1.66
    assert simulation.robot.pose[0] < 1.49


def test_robots_are_driven_each_by_its_number():
    simulation = Simulation(World((4, 2), (RobotSpec((1, 0.5, 0)), RobotSpec((1, 1.5, 0)))))
    simulation.drive(0.2, robot=1)
    simulation.step(100)
    assert simulation.robots[0].pose == (1, 0.5, 0)
    assert simulation.robots[1].pose[0] == pytest.approx(1.2, abs=0.01)


def test_ten_steps_at_once_are_ten_steps():
    one, ten = Simulation("boxes"), Simulation("boxes")
    for simulation, count in ((one, 1), (ten, 10)):
        simulation.drive(0.4, 0.1)
        for _ in range(1500 // count):
            simulation.step(count)
    assert one.robot.body.motion() == ten.robot.body.motion()
    assert [thing.pose for thing in one.solids] == [thing.pose for thing in ten.solids]


def test_sleeping_bodies_move_like_awake_ones(monkeypatch):
    def drive():
        simulation = Simulation("boxes")
        for loop in range(150):
            simulation.drive(0.3 if loop % 9 else 0.0, 0.0 if loop % 4 else 0.7)
            simulation.step(10)
        motions = [simulation.robot.body.motion(), *(thing.body.motion() for thing in simulation.solids)]
        return motions, simulation.robot.memory.touching | simulation.robot.memory.touched

    asleep, touched = drive()
    monkeypatch.setattr(Body, "sleep", lambda body: None)
    assert drive() == (asleep, touched)
    assert touched  # the way leads into something


# -- by hand --------------------------------------------------------------------------------------


def test_a_robot_is_put_elsewhere_at_rest():
    simulation = room()
    simulation.drive(0.2)
    simulation.step(100)
    simulation.drive()
    simulation.place((3, 0.5, 1))
    assert simulation.robot.pose == (3, 0.5, 1)
    simulation.step(10)
    assert simulation.robot.pose == (3, 0.5, 1)


def test_a_robot_is_never_put_outside_the_world():
    simulation = room()
    simulation.place((9, -9, 0))
    assert simulation.robot.pose == (4, 0, 0)


def test_a_moved_wall_is_felt_where_it_is_now():
    simulation = room(BoxSolid((3, 0.2, 0.1, 0.3)))
    simulation.place_solid(0, (2, 1, 0))
    simulation.drive(0.5)
    simulation.step(300)
    assert simulation.robot.pose[0] == pytest.approx(1.87, abs=0.002)
    assert simulation.solids[0].pose == (2, 1, 0)


def test_a_pushable_box_is_put_elsewhere():
    simulation = room(BoxSolid((3, 0.2, 0.1, 0.1), push=0.3))
    simulation.place_solid(0, (1.5, 1, 0.3))
    simulation.step(5)
    assert simulation.solids[0].pose == (1.5, 1, 0.3)


@every(
    "what",
    [
        Drive(robot=1),
        Pen(robot=-1),
        Lamp(robot=1),
        PlaceRobot((1, 1, 0), 1),
        PlaceSolid((1, 1, 0), 0),
        Draw(()),
    ],
)
def test_an_input_that_concerns_nothing_is_refused_at_once(what):
    simulation = room()
    with pytest.raises(ValueError, match=r"There is no (robot|solid) |A stroke needs at least one point"):
        simulation.submit(what)


def test_lines_are_drawn_and_erased():
    simulation = room()
    simulation.draw(((0.5, 1), (2, 1)))
    assert simulation.latch().lights == (0,)
    simulation.draw(((1, 1), (1.1, 1)), width=0.1, grey=None)
    assert simulation.latch().lights == (255,)


def test_submitted_inputs_act_before_the_next_step_or_latch():
    simulation = room()
    thread = threading.Thread(target=lambda: simulation.submit(Draw(((0.5, 1), (2, 1)))))
    thread.start()
    thread.join()
    assert simulation.greys() == (255,)
    assert simulation.latch().lights == (0,)
    simulation.submit(PlaceRobot((3, 0.5, 0)))
    simulation.step()
    assert simulation.robot.pose == (3, 0.5, 0)


# -- pens -----------------------------------------------------------------------------------------


def test_a_pen_leaves_a_trail_that_light_sensors_see():
    simulation = room()
    simulation.pen(grey=100)
    simulation.drive(0.2)
    simulation.step(100)
    simulation.pen(False)
    simulation.step(100)
    assert simulation.floor.light(1.1, 1) == 100
    assert simulation.floor.light(1.3, 1) == 255
    assert simulation.floor.marks[0][0] < simulation.floor.marks[-1][0] <= 100  # each knows its step


def test_being_carried_leaves_no_trail():
    simulation = room()
    simulation.pen(grey=100)
    simulation.place((3, 1, 0))
    simulation.step(10)
    assert simulation.floor.marks == []


def test_a_pen_runs_dry(monkeypatch):
    monkeypatch.setattr("lrp_jupyter.sim.simulation.MOST_MARKS", 20)
    simulation = room()
    simulation.pen()
    simulation.drive(0.5)
    simulation.step(200)
    simulation.draw(((1, 1), (1, 2)))
    assert len(simulation.floor.marks) == 20


# -- reset ----------------------------------------------------------------------------------------


def test_a_reset_puts_everything_back_but_time_and_drawings():
    simulation = Simulation("boxes")
    start = simulation.latch()
    simulation.draw(((0.1, 1.9), (0.4, 1.9)))
    simulation.pen(grey=0)
    simulation.drive(0.4)
    simulation.step(300)
    simulation.latch()
    simulation.reset()
    assert simulation.time == 3
    assert simulation.robot.pose == simulation.world.robots[0].pose
    assert simulation.robot.command == (0, 0)
    starts = [(*middle_of(solid), solid.angle) for solid in simulation.world.solids]
    assert [solid.pose for solid in simulation.solids] == starts
    assert simulation.floor.light(0.6, 1) == 255
    assert simulation.floor.light(0.2, 1.9) == 0
    assert simulation.latch() == start
    simulation.reset(drawings=True)
    assert simulation.floor.light(0.2, 1.9) == 255


def test_a_run_after_a_reset_is_the_first_run_again():
    def drive(simulation):
        simulation.drive(0.4, 0.02)
        simulation.step(1700)
        return simulation.robot.body.motion(), [thing.pose for thing in simulation.solids]

    simulation = Simulation("boxes")
    first = drive(simulation)
    simulation.step(137)
    simulation.reset()
    assert drive(simulation) == first


# -- for views ------------------------------------------------------------------------------------


def test_the_revision_grows_when_a_drawing_of_the_scene_has_become_wrong():
    simulation = room(BoxSolid((3, 1, 0.1, 0.1)))
    seen = [simulation.revision]
    for change in (
        lambda: simulation.place_solid(0, (2, 1, 0)),
        simulation.reset,
        lambda: simulation.rewind(0),
    ):
        change()
        seen.append(simulation.revision)
    assert seen == sorted(set(seen))
    simulation.drive(0.2)
    simulation.step(500)
    assert simulation.revision == seen[-1]


def test_zones_name_where_a_robot_is():
    simulation = Simulation("line")
    assert simulation.zones() == set()
    simulation.place((0.5, 0.5, 0))
    assert simulation.zones() == {"near"}


def test_a_seed_replaces_that_of_the_world():
    assert Simulation("line", seed=7).world.seed == 7
    assert Simulation("line").world == load("line")

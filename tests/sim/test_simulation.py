import pytest
from lrp_jupyter.sim import Simulation


def test_a_commanded_robot_drives_straight_ahead():
    simulation = Simulation("empty")
    simulation.drive(linear=0.2)
    simulation.step(100)
    assert simulation.time == 1.0
    x, y, heading = simulation.robot.pose
    assert x == pytest.approx(1.7, abs=0.01)
    assert (y, heading) == (1, 0)


def test_the_light_sensor_tells_line_from_floor():
    simulation = Simulation("line")
    assert simulation.latch().lights == (0,)
    simulation.place((1.0, 1.0, 0.0))
    assert simulation.latch().lights == (255,)


def test_rewinding_and_going_on_is_the_straight_run():
    def drive_on(simulation):
        for loop in range(60):
            simulation.latch()
            simulation.drive(linear=0.3, angular=0.1 * (loop % 7))
            simulation.step(10)
        return simulation.robot.body.motion()

    simulation = Simulation("line")
    drive_on(simulation)
    moment = simulation.moment
    straight = drive_on(simulation)
    simulation.rewind(moment)
    assert simulation.moment == moment
    assert drive_on(simulation) == straight

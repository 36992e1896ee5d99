"""The bridge to Webots, with a stand-in for its module: a world that moves only when the program does."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from types import ModuleType

import pytest
from bridges.own.conftest import EXAMPLES, HERE

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.session import Session
from lrp_jupyter.programs import load

WEBOTS = str(EXAMPLES / "webots.py")


@pytest.fixture
def controller(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """Webots' module, as in a process of its own."""
    monkeypatch.delitem(sys.modules, "controller", raising=False)
    monkeypatch.syspath_prepend(str(HERE / "webots"))
    import controller

    yield controller
    del sys.modules["controller"]


class TestWebots(BridgeConformance):
    moves = True

    @pytest.fixture(autouse=True)
    def _webots(self, controller: ModuleType) -> None:
        self.controller = controller

    def make_bridge(self) -> Bridge:
        return make_bridge(WEBOTS, step=0.02)

    def has_moved(self, bridge: Bridge) -> bool:
        robot = self.controller.Robot.created.simulation.robot
        return robot.command != (0.0, 0.0)

    def wait(self, seconds: float) -> None:
        """Time passes in `advance`."""


def test_the_unchanged_follower_goes_there_and_back(controller):
    with Session(load("follower"), WEBOTS, step=0.02) as session:
        session.run(30)
        assert controller.Robot.created.simulation.robot.pose[0] > 1.0
        session.run(90)
        assert session.frame.active[0][-1] == "end"
        assert controller.Robot.created.simulation.robot.pose[0] < 0.5
        assert not session.issues


def test_the_world_stands_still_while_the_program_is_paused(controller):
    with Session(load("follower"), WEBOTS, step=0.02) as session:
        session.start()
        assert session.wait_for("moving", timeout=60)
        session.pause()
        world = controller.Robot.created
        then, where = world.getTime(), world.simulation.robot.pose
        for _ in range(5):
            session.call(lambda: None)  # the loop turns, and does not tick
        assert (world.getTime(), world.simulation.robot.pose) == (then, where)


def test_the_time_of_the_program_is_the_time_of_the_world(controller):
    with Session(load("follower"), WEBOTS, step=0.02) as session:
        session.run(3)
        assert controller.Robot.created.getTime() == pytest.approx(session.frame.time)


TURNS = """
(machine turns
  (state left (running [robot.turn_by(degrees(90))]))
  (state back (running [robot.turn_by(degrees(-45))]))
  (state long (running [robot.turn_by(50)]))
  (state over)
  (on [robot.turn_by.succeeded] left -> back)
  (on [robot.turn_by.succeeded] back -> long)
  (ontime 1000 long -> over))
(spawn turns left)
"""


def test_a_program_turns_there_as_in_the_simulator_and_no_further_when_its_state_is_left(controller):
    with Session(TURNS, WEBOTS, step=0.02) as session, Session(TURNS, "sim") as simulated:
        session.open()
        simulated.open()
        simulation = controller.Robot.created.simulation
        start = simulation.robot.pose[2], simulated.bridge.pose[2]
        for state, turned in (("back", 90), ("long", 45)):
            for each in (session, simulated):
                assert each.run(until=state, seconds=20)
            angles = simulation.robot.pose[2] - start[0], simulated.bridge.pose[2] - start[1]
            assert [math.degrees(angle) for angle in angles] == pytest.approx([turned, turned], abs=2)
        assert session.run(until="over", seconds=20)
        session.run(0.2)
        stands = simulation.robot.pose
        session.run(1)
        assert simulation.robot.pose == stands
        assert not session.issues


def test_a_move_of_another_machine_ends_a_turn_and_that_is_told(controller):
    pushing = (
        "(machine p (state s) (state t (running [robot.move(linear=0.1)])) (ontime 500 s -> t)) (spawn p s)"
    )
    with Session(TURNS + pushing, WEBOTS, step=0.02) as session:
        session.open()
        turn = session.bridge.robot.turn_by
        assert session.run(until=lambda frame: turn.failed, limit=10)
        assert turn.reason == "The robot was told something else meanwhile."


def test_the_end_of_webots_is_a_lost_robot(controller):
    with Session(load("follower"), WEBOTS, step=0.02) as session:
        session.run(1)
        controller.Robot.created.has_ended = True
        session.run(1)
        assert session.bridge.status.state == "lost"
        assert session.bridge.status.sentence == "Webots has ended the simulation."


def test_it_cannot_step_back(controller):
    with Session(load("follower"), WEBOTS, step=0.02) as session:
        session.run(1)
        with pytest.raises(BridgeError, match="cannot step back"):
            session.rewind()


def test_another_time_step_is_told_with_the_option_to_set(controller):
    with pytest.raises(BridgeError, match=r"This world moves in steps of 0\.02 s\. Say so: `step=0\.02`\."):
        make_bridge(WEBOTS).open()


def test_a_robot_without_ground_sensors_is_told(controller, monkeypatch):
    monkeypatch.setattr(controller.Robot, "without", ("gs1",))
    with pytest.raises(BridgeError, match="no device `gs1`"):
        make_bridge(WEBOTS, step=0.02).open()


def test_where_webots_is_not_installed_it_is_said_where_its_module_is(monkeypatch):
    monkeypatch.setitem(sys.modules, "controller", None)
    with pytest.raises(BridgeError, match="Add `lib/controller/python` of the folder of Webots"):
        make_bridge(WEBOTS).open()


def test_an_option_that_is_no_number_is_told_with_its_name():
    with pytest.raises(BridgeError, match=r"`step.*fast`"):
        make_bridge(WEBOTS, step="fast")

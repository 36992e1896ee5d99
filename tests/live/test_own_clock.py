"""A robot in a world that has a clock of its own, but is not simulated by this package."""

import pytest

from lrp_jupyter.bridges.bridge import Bridge, NullBridge
from lrp_jupyter.bridges.interventions import WorldLoaded
from lrp_jupyter.bridges.recorded import RecordedBridge
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.past.replay import repeat
from lrp_jupyter.live.running.inputs import Input
from lrp_jupyter.live.session import Session

CLIMB = """(machine lift
  (state up (running [robot.move(linear=1)]))
  (state down (running [robot.move(linear=-1)]))
  (on [robot.height.data > 1] up -> down))
(spawn lift up)"""


class Lift(Bridge, offered=False):
    hardware = False
    time_step = 0.01

    def open_interface(self):
        self.height = self.speed = 0.0
        self.add_variable("height.data", lambda: self.height)
        self.add_method("move", self.move)

    def move(self, linear=0.0):
        self.speed = linear

    def advance(self, seconds):
        self.height += seconds * self.speed

    def moment(self):
        return self.height, self.speed

    def rewind(self, moment):
        self.height, self.speed = moment


def test_only_a_world_that_is_simulated_here_can_be_drawn_repeated_and_copied():
    sim = SimBridge()
    assert sim.simulated is sim
    assert Lift().simulated is NullBridge().simulated is None


def test_a_world_with_a_clock_of_its_own_is_rewound_and_its_forks_are_fed_what_was_read():
    with Session(CLIMB, Lift()) as session:
        session.run(2)
        assert session.at(10).readings["height.data"] == pytest.approx(0.9)
        height = session.bridge.height
        session.rewind(5)
        session.run(0.5)
        assert session.bridge.height == pytest.approx(height)
        with session.fork(at=8, inputs=True) as fork:
            assert isinstance(fork.bridge, RecordedBridge)
            fork.run(1)
            assert fork.frame.active == (("lift", "down"),)
            assert fork.frame.readings == session.at(18).readings
        ahead = session.what_if(2, CLIMB.replace("> 1", "> 0.5"), seconds=1)
        assert ahead.open_loop
        assert (ahead.changed.way, ahead.changed.solids, ahead.changed.touch) == ((), (), None)
        assert session.at(10).robot is session.frame.robot is None
        with pytest.raises(BridgeError, match="`lift` has no simulated world that could be drawn"):
            session.animation()
        with pytest.raises(BridgeError, match="`lift` has no world to which WorldLoaded"):
            repeat(session._loop, Input(0, 0, session.frame.time, WorldLoaded({})))

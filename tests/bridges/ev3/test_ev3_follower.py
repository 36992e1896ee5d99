"""The bundled follower, unchanged, drives a brick: there and back on the course of the paper.

The emulated brick's motors drive the simulated robot, whose sensors are those of the brick.
"""

from __future__ import annotations

import math

import pytest

from lrp_jupyter.bridges.ev3 import EV3Bridge
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session
from lrp_jupyter.programs import load
from lrp_jupyter.sim.simulation import STEP, Simulation

WHEEL, TRACK = 0.056, 0.12  # m
EVERY = 8  # physics steps between two looks at the motors


@pytest.mark.slow
def test_the_follower_goes_there_and_back(brick, make_bridge, clock, monkeypatch):
    simulation, sensors = Simulation("line"), brick.sensors
    sensors[0].type, sensors[1].type, sensors[2].type, sensors[3].type = 16, 126, 29, 30

    def sense() -> None:
        readings = simulation.latch()
        sensors[0].values = {0: float(readings.bumper)}
        sensors[2].values = {0: float(round(readings.lights[0] / 2.55))}
        sensors[3].values = {0: min([255.0, *(way * 100 for way in readings.distances)])}

    def drive(now: float) -> None:
        while simulation.steps * STEP < now:
            left, right = (math.radians(brick.motors[i].turning * 10) * WHEEL / 2 for i in (1, 2))
            simulation.drive((left + right) / 2, (right - left) / TRACK)
            simulation.step(EVERY)
            clock.now += EVERY * STEP
            sense()
            bridge.link._turn()
        EV3Bridge.sense(bridge, now)

    sense()
    bridge = make_bridge()
    monkeypatch.setattr(bridge, "sense", drive)
    with Session(load("follower"), bridge=bridge, clock=VirtualClock()) as session:
        bridge.arm()
        session.run(30)
        assert bridge.robot.odom.x > 1.0
        session.run(90)
        assert session.frame.active[0][-1] == "end"
        assert session.issues == ()
        assert simulation.robot.readings.odom[0] < 0.0
        assert bridge.link.snapshot.pose[0] < 0.5, "dead reckoning, with wheels that slipped at a wall"

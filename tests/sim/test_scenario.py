"""The paper's follower, written by hand: there and back on the S course.

Its rules are the listing's, tested in the order of the listing, with `nobump` cleared on entering
`bumpturn`. Times are counted in loops, so that no rounding decides whether 0.1 s have passed.
"""

from dataclasses import replace

import pytest
from support.seeds import seeds

from lrp_jupyter.sim import Simulation, load
from lrp_jupyter.sim.world import Noise

BLACK, WHITE = 118, 138


class Follower:
    def __init__(self, search, look, rate=10):
        self.search = search
        self.look = round(look * rate)
        self.rate = rate
        self.state = None
        self.nobump = True
        self.bumps = []

    def enter(self, state):
        self.state, self.loops = state, 0
        if state == "looking":
            self.side, self.sweep, self.swept = 0, self.look, 0
        if state == "bumpturn":
            self.nobump = False

    def tick(self, simulation):
        readings = simulation.latch()
        if self.state is None:
            return self.enter("looking")
        self.loops += 1
        light, bump = readings.lights[0], readings.bumper == 1
        if self.state == "moving" and light > WHITE:
            return self.enter("looking")
        if self.state == "looking" and light < BLACK:
            return self.enter("moving")
        if bump and self.state != ("bumpback" if self.nobump else "end"):
            self.bumps.append(simulation.time)
            return self.enter("bumpback" if self.nobump else "end")
        if self.state == "bumpback" and self.loops >= self.rate:
            return self.enter("bumpturn")
        if self.state == "bumpturn" and self.loops >= 3 * self.rate:
            return self.enter("looking")
        if self.state == "looking":
            self.swept += 1
            if self.swept >= self.sweep:
                self.sweep *= 2 if self.side == 3 else 1
                self.side, self.swept = (self.side + 1) % 4, 0
                return None
        if self.state == "moving":
            simulation.drive(linear=0.2)
        elif self.state == "bumpback":
            simulation.drive(linear=-0.2)
        elif self.state == "bumpturn":
            simulation.drive(angular=1.0)
        elif self.state == "looking":
            simulation.drive(angular=self.search if self.side in (0, 3) else -self.search)
        else:
            simulation.drive()
        return None


def run(world="line", seed=None, rate=10, *, search, look):
    simulation, follower = Simulation(world, seed), Follower(search, look, rate)
    while follower.state != "end" and simulation.time < 350:
        follower.tick(simulation)
        simulation.step(100 // rate)
    return simulation, follower


def test_the_follower_goes_there_and_back():
    simulation, follower = run(search=1.0, look=0.2)
    there, back = follower.bumps
    assert there == pytest.approx(18.6, abs=3)
    assert 41 <= back <= 54
    assert simulation.zones() == {"near"}
    assert simulation.robot.memory.touched == {0}


def test_it_goes_there_and_back_with_the_constants_of_the_paper():
    # On a real clock 0.1 s have not quite passed after one loop of 0.1 s: looking begins with two.
    _, follower = run(search=0.2, look=0.2)
    there, back = follower.bumps
    assert 80 <= there <= 120
    assert 170 <= back <= 235


@pytest.mark.parametrize("seed", seeds(1, 6))
@pytest.mark.parametrize("search", [1.0, 0.2])
def test_noise_does_not_lead_it_astray(seed, search):
    world = load("line")
    noise = Noise(motor=0.2, light=20)
    world = replace(world, robots=(replace(world.robots[0], noise=noise),))
    _, follower = run(world, seed, search=search, look=0.2)
    assert len(follower.bumps) == 2


def test_the_run_is_the_same_every_time():
    first, again = (run(search=1.0, look=0.2) for _ in range(2))
    assert first[1].bumps == again[1].bumps
    assert first[0].robot.body.motion() == again[0].robot.body.motion()

"""How fast a world runs: `pytest --benchmark-only tests/sim`."""

import pytest

from lrp_jupyter.sim import Simulation, World
from lrp_jupyter.sim.world import BoxSolid, RobotSpec


def crowd():
    solids = tuple(
        BoxSolid((0.3 + 0.3 * (index % 10), 1 + 0.3 * (index // 10), 0.1, 0.1)) for index in range(50)
    )
    return Simulation(World((4, 4), (RobotSpec((0.5, 0.4, 0)),), solids=solids))


def test_a_step_among_fifty_solids(benchmark):
    simulation = crowd()
    simulation.drive(angular=0.5)
    benchmark(simulation.step, 100)


@pytest.mark.parametrize(("linear", "angular"), [(0.0, 0.5), (0.02, 0.5)], ids=["turning", "curve"])
def test_a_loop_of_ten_steps_with_sensors(benchmark, linear, angular):
    simulation = Simulation("line")

    def loop():
        simulation.latch()
        simulation.drive(linear, angular)
        simulation.step(10)

    benchmark(loop)


def test_rewinding_over_ten_seconds(benchmark):
    simulation = crowd()
    for _ in range(95):
        simulation.latch()
        simulation.drive(angular=0.5)
        simulation.step(10)
    benchmark(lambda: simulation.rewind(simulation.moment))

"""Tests of behaviours: a robot that a test sets and asks, and what a run did, as a text.

>>> from lrp_jupyter import Session
>>> from lrp_jupyter.testing import RobotStub
>>> robot = RobotStub.of("sim")
>>> robot.table({"light.data": [(0, 255), (1, 20)]})
>>> program = "(machine m (state a (running [robot.move(linear=0.2)])) (state b (onentry [robot.stop()]))"
>>> with Session(f"{program} (on [robot.light.data < 128] a -> b)) (spawn m a)", robot) as session:
...     session.run(until="b", seconds=5)
True
>>> robot.commands
[0 s to 0.9 s: robot.move(linear=0.2), 1 s: robot.stop()]
"""

from lrp_jupyter.testing.robot_stub import RobotStub, StubCommand
from lrp_jupyter.testing.run_report import report

__all__ = ["RobotStub", "StubCommand", "report"]

"""Detection of a world at rest, whose steps of physics need not be made.

Standing is exact here: a robot that was stopped has the velocity 0.0, not nearly so. A step is a
function of the positions and velocities of the bodies, and of the impulses that contacts and joints
remember. Once a step begins and ends with the same positions, with nothing in motion and with no
impulse remembered, so does every step after it, until an input disturbs the world. A world in which something
moves by itself is never at rest.
"""

from __future__ import annotations

from lrp_jupyter.sim.sim_robot import Body, Motion, SimRobot, SimSolid
from lrp_jupyter.sim.world import can_move

_CERTAIN = 5  # steps in a row; pymunk forgets ended contacts after 3


class Rest:
    """Detects that a space, which was just built, is at rest, and keeps up its robots' contacts meanwhile."""

    def __init__(self, robots: tuple[SimRobot, ...], solids: tuple[SimSolid, ...]) -> None:
        self._robots = robots
        self._bodies: list[Body] = [robot.body for robot in robots]
        self._bodies += [solid.body for solid in solids if can_move(solid.spec)]
        self._is_possible = all(solid.spec.patrol is None for solid in solids)
        self.disturb()

    def disturb(self) -> None:
        """Start over: something may move now."""
        self.is_certain = False
        self._unchanged = 0
        self._motions: list[Motion] = []

    def observe(self, step: int) -> None:
        """Compare the world with the one before this step, which was just made."""
        if not self._is_possible:
            return
        motions = [body.motion() for body in self._bodies]
        self._contacts = [
            (robot.memory, frozenset(robot.body.contacts), robot.memory.pressed_at == step)
            for robot in self._robots
        ]
        for robot in self._robots:
            robot.body.contacts.clear()
        if motions != self._motions or any(any(motion[3:]) for motion in motions):
            self._motions, self._unchanged = motions, 0
        elif any(body.is_loaded for body in self._bodies):
            self._unchanged = 0
        else:
            self._unchanged += 1
            self.is_certain = self._unchanged >= _CERTAIN

    def go_on(self, step: int) -> None:
        """Record the contacts that the robots still have at a step that is not made."""
        for memory, touching, is_pressed in self._contacts:
            memory.touching |= touching
            if is_pressed:
                memory.pressed_at = step

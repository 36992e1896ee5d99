"""A robot on a serial line, as a micro:bit would be: ``python serial_robot.py LINK SPEED [SILENCE]``.

The line is a pseudo-terminal to which LINK leads. When this process ends the robot is unplugged. With SILENCE
it stops by itself when no line has come for so many seconds.
"""

from __future__ import annotations

import math
import os
import select
import sys
import threading
import time
import tty
from contextlib import suppress
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2]))

from support.simulated import SimulatedRobot, ready

from lrp_jupyter.sim.world_inputs import DriveBy, TurnBy

TASKS = {b"drive": DriveBy, b"turn": TurnBy}
STILL = (0.0, 0.0)
ENDS = {"succeeded": "done", "aborted": "blocked"}


class Brain:
    """What the robot's own program knows: the number of the last task, and when a line has come."""

    def __init__(self, robot: SimulatedRobot, silence: float) -> None:
        self.robot, self.silence = robot, silence
        self.heard, self.number, self.is_dropped = time.monotonic(), -1, False

    def obey(self, word: bytes, first: bytes, second: bytes) -> None:
        """Do what a line says; ValueError, TypeError, KeyError: it cannot be read."""
        self.heard = time.monotonic()
        if word == b"move":
            self.robot.drive(float(first), float(second))
            self.number = -1
        elif int(second) != self.number:
            self.robot.ask(TASKS[word](float(first), number=int(second)))
            self.number, self.is_dropped = int(second), False

    def end(self) -> str:
        """Return how the last task has ended; nothing if it has not."""
        errand = self.robot.errand
        is_over = errand is not None and not errand.is_active
        if time.monotonic() - self.heard > self.silence and self.robot.wanted != STILL and not is_over:
            self.is_dropped = True
            self.robot.drive(*STILL)
        if self.number >= 0 and self.is_dropped:
            return f"dropped {self.number}\n"
        return "" if errand is None or errand.is_active else f"{ENDS[errand.status]} {errand.what.number}\n"


def main(link: Path, speed: float, silence: float = math.inf) -> None:
    robot = SimulatedRobot(speed)
    brain, thinking = Brain(robot, silence), threading.Lock()
    end, device = os.openpty()
    tty.setraw(device)
    os.set_blocking(end, False)  # what nobody reads is dropped, as on a wire
    link.unlink(missing_ok=True)
    link.symlink_to(os.ttyname(device))

    def listen() -> None:
        rest = b""
        while select.select([end], [], []):
            *lines, rest = (rest + os.read(end, 4096)).split(b"\n")
            for line in lines:
                with thinking, suppress(ValueError, TypeError, KeyError):
                    brain.obey(*line.split())

    threading.Thread(target=listen, daemon=True).start()
    ready(robot)

    def publish(light: int, bumper: bool, _odom: object) -> None:
        with thinking:
            outcome = brain.end()
        with suppress(BlockingIOError):
            os.write(end, f"light {light}\nbumper {bumper:d}\n{outcome}".encode())

    robot.run(publish)


if __name__ == "__main__":
    main(Path(sys.argv[1]), *map(float, sys.argv[2:]))

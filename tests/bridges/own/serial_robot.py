"""A robot on a serial line, as a micro:bit would be: ``python serial_robot.py LINK SPEED``.

The line is a pseudo-terminal to which LINK leads. When this process ends the robot is unplugged.
"""

from __future__ import annotations

import os
import select
import sys
import threading
import tty
from contextlib import suppress
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2]))

from support.simulated import SimulatedRobot, ready


def main(link: Path, speed: float) -> None:
    robot = SimulatedRobot(speed)
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
                with suppress(ValueError):
                    word, linear, angular = line.split()
                    if word == b"move":
                        robot.drive(float(linear), float(angular))

    threading.Thread(target=listen, daemon=True).start()
    ready(robot)

    def publish(light: int, bumper: bool, _odom: object) -> None:
        with suppress(BlockingIOError):
            os.write(end, f"light {light}\nbumper {bumper:d}\n".encode())

    robot.run(publish)


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]))

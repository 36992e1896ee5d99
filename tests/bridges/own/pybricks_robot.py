"""A hub with Pybricks, which runs the hub's program: ``python pybricks_robot.py SPEED PATIENCE``.

Its modules are stand-ins from their documentation; behind them is the simulator. The program hears and prints
through a pipe, as it does on a hub through Bluetooth. Its stopwatches are slower by the factor PATIENCE.
"""

from __future__ import annotations

import math
import os
import runpy
import select
import sys
import threading
import time
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

sys.path.append(str(Path(__file__).parents[2]))

from support.simulated import SimulatedRobot

from lrp_jupyter.sim.world_inputs import DriveBy, TurnBy

PROGRAM = Path(__file__).parents[3] / "notebooks" / "bridges" / "pybricks_hub.py"


class Motor:
    def __init__(self, port: str, positive_direction: str = "clockwise") -> None:
        self.port = port


def hub(robot: SimulatedRobot, speed: float, patience: float) -> dict[str, ModuleType]:
    """The modules of a hub."""
    seen: dict[str, Any] = {"light": 255, "bumper": False}

    def notice(light: int, bumper: bool, _odom: object) -> None:
        seen.update(light=light, bumper=bumper)

    threading.Thread(target=robot.run, args=(notice,), daemon=True).start()

    class DriveBase:
        def __init__(self, left: Motor, right: Motor, wheel_diameter: float, axle_track: float) -> None:
            assert (left.port, right.port) == ("A", "B")

        def drive(self, speed: int, turn_rate: int) -> None:
            robot.drive(speed / 1000, math.radians(-turn_rate))

        def straight(self, distance: int, then: str = "hold", wait: bool = True) -> None:
            assert not wait
            robot.ask(DriveBy(distance / 1000))

        def turn(self, angle: int, then: str = "hold", wait: bool = True) -> None:
            assert not wait
            robot.ask(TurnBy(math.radians(-angle)))

        def done(self) -> bool:
            return robot.wanted == (0.0, 0.0) or self._status() == "succeeded"

        def stalled(self) -> bool:
            return self._status() == "aborted"

        def _status(self) -> str:
            errand = robot.errand
            return "active" if errand is None else errand.status

        def stop(self) -> None:
            robot.drive(0.0, 0.0)

    class StopWatch:
        def __init__(self) -> None:
            self.reset()

        def reset(self) -> None:
            self._since = time.monotonic()

        def time(self) -> int:
            return round(1000 * speed / patience * (time.monotonic() - self._since))

    def wait(milliseconds: int) -> None:
        robot.gone.wait(milliseconds / 1000 / speed)

    def color_sensor(_port: str) -> SimpleNamespace:
        return SimpleNamespace(reflection=lambda: round(seen["light"] / 2.55))

    def force_sensor(_port: str) -> SimpleNamespace:
        return SimpleNamespace(pressed=lambda force=3: seen["bumper"])

    standard_input = SimpleNamespace(buffer=os.fdopen(0, "rb", buffering=0), fileno=lambda: 0)
    return {
        "pybricks": module(),
        "pybricks.parameters": module(
            Direction=SimpleNamespace(COUNTERCLOCKWISE="counterclockwise"),
            Port=SimpleNamespace(A="A", B="B", C="C", D="D"),
        ),
        "pybricks.pupdevices": module(Motor=Motor, ColorSensor=color_sensor, ForceSensor=force_sensor),
        "pybricks.robotics": module(DriveBase=DriveBase),
        "pybricks.tools": module(StopWatch=StopWatch, wait=wait),
        "uselect": module(poll=select.poll),
        "usys": module(stdin=standard_input),
    }


def module(**names: object) -> ModuleType:
    module = ModuleType("of a hub")
    vars(module).update(names)
    return module


if __name__ == "__main__":
    speed, patience = map(float, sys.argv[1:])
    sys.modules.update(hub(SimulatedRobot(speed, sys.stderr), speed, patience))
    sys.stdout.reconfigure(line_buffering=True, newline="\r\n")  # type: ignore[union-attr]
    runpy.run_path(str(PROGRAM))

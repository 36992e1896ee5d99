"""How soon a robot stands when its program dies or is suspended: ``python tests/benchmarks/standing.py``."""

from __future__ import annotations

import argparse
import os
import signal
import statistics
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from bridges.dying import CommandLine, on_wheels
from support.waiting import until


def main(times: int, driven: float) -> None:
    with on_wheels() as standing, tempfile.TemporaryDirectory() as folder:
        for name, number in (("kill -9", signal.SIGKILL), ("SIGSTOP", signal.SIGSTOP)):
            took = []
            for _ in range(times):
                robot = standing()
                driver = CommandLine(robot, Path(folder))
                try:
                    robot.is_driven()
                    time.sleep(driven)  # its guard connects meanwhile
                    moment = time.monotonic()
                    os.kill(driver.pid, number)
                    until(lambda robot=robot: robot.stands)
                    took.append(robot.speeds()[-1][0] - moment)
                finally:
                    driver.end()
            print(f"{name}: it stands after {statistics.median(took):.2f} s, at most {max(took):.2f} s")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", type=int, default=5)
    parser.add_argument("--driven", type=float, default=2.5, help="seconds that the robot drives before")
    options = parser.parse_args()
    main(options.times, options.driven)

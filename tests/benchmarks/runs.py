"""How soon kept runs are judged after an edit: ``python tests/benchmarks/runs.py``.

Fourteen recorded minutes of the line follower, each with other noise, on all processors. Beside them a
session runs as in a lab, with and without the runs, and says how late its ticks come.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import threading
from itertools import pairwise
from pathlib import Path
from time import perf_counter, sleep

from lrp_jupyter import Session, VirtualClock, programs
from lrp_jupyter.grading.workers import close_workers
from lrp_jupyter.widgets.views.shown_runs import ShownRuns

TEXT = programs.load("follower")
NOISE = {"motor": 0.1, "light": 5}


def record(
    folder: Path, text: str = TEXT, runs: int = 14, seconds: float = 60.0, exact: bool = False
) -> None:
    """Keep runs of a program, each with other noise, or all without."""
    noise = None if exact else NOISE
    for seed in range(runs):
        with Session(text, "sim", VirtualClock(), world="line", noise=noise, seed=seed) as session:
            session.run(seconds)
            session.keep(f"run {seed:02}", folder)


def edited(number: int) -> str:
    """Return the program with another number in it."""
    return TEXT.replace("maxlook := [", f"maxlook := [{1 + number} * ", 1)


class Decided:
    """Waits until what is shown of runs is that of the present program."""

    def __init__(self, runs: ShownRuns) -> None:
        self._runs, self._news = runs, threading.Event()
        runs.attach(self._news.set)

    def wait(self, session: Session) -> tuple[float, float]:
        """Return the seconds until the first, and until the last of the runs is judged."""
        start, first = perf_counter(), 0.0
        while True:
            assert self._runs.view(session) is not None
            waiting = [each["state"] == "waiting" for each in self._runs.kept().values()]
            if first == 0.0 and not all(waiting):
                first = perf_counter() - start
            if waiting and not any(waiting):
                return first, perf_counter() - start
            self._news.wait(0.5)
            self._news.clear()


def lateness(seconds: float, during: Session) -> list[float]:
    """Return by how many milliseconds the ticks of a session come apart more, or less, than they should."""
    times: list[float] = []
    end = during.on_tick(lambda: times.append(perf_counter()))
    sleep(seconds)
    end()
    gaps = [after - before for before, after in pairwise(times)]
    return [1000 * abs(gap - 1 / during.rate) for gap in gaps]


def row(name: str, values: list[float], unit: str) -> None:
    """Print the median and the 95th percentile of some values."""
    high = statistics.quantiles(values, n=20, method="inclusive")[-1] if len(values) > 1 else values[0]
    print(f"| {name} | {statistics.median(values):.2f} | {high:.2f} | {unit} |", flush=True)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edits", type=int, default=20)
    parser.add_argument("--runs", type=int, default=14)
    parser.add_argument("--exact", action="store_true", help="motors and sensors without noise")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as home:
        folder = Path(home, "follower.runs")
        record(folder, runs=options.runs, exact=options.exact)
        size = sum(file.stat().st_size for file in folder.iterdir()) / 1e6
        with Session(TEXT, "sim", world="line", name="follower") as session:
            session.start()
            alone = lateness(5, session)
            runs = ShownRuns(folder)
            decided = Decided(runs)
            cold = decided.wait(session)
            print(f"{options.runs} recorded minutes, {size:.1f} MB\n")
            print("| what | median | 95th percentile | |\n|---|---:|---:|---|")
            row("the first time, when the processes start, until all are judged", [cold[1]], "s")
            both = []
            for number in range(options.edits):
                session.edit(edited(number % 5))
                both.append(decided.wait(session))
            row("after an edit, until the first is judged", [first for first, _ in both], "s")
            row("after an edit, until all are", [last for _, last in both], "s")
            stop = threading.Event()

            def keep_on() -> None:
                number = 0
                while not stop.wait(0.3):
                    number += 1
                    session.edit(edited(number % 5))
                    runs.view(session)

            typing = threading.Thread(target=keep_on)
            typing.start()
            beside = lateness(10, session)
            stop.set()
            typing.join()
            row("ticks of the session, alone: too early or too late by", alone, "ms")
            row(
                "the same while the program is edited, and the runs judged, three times a second",
                beside,
                "ms",
            )
            runs.close()
    close_workers()


if __name__ == "__main__":
    sys.exit(main())

"""What it costs to remember, to answer, and to run the past again: ``python tests/benchmarks/past.py``.

Ratios within one run: a tick with and without what the past needs, the best of several turns each.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time

sys.path.insert(0, str(Path(__file__).parent))
import texts

from lrp_jupyter import Session, VirtualClock
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.programs import load


def ring(**options: object) -> Session:
    return Session(texts.blocks(5), clock=VirtualClock(), **options)  # type: ignore[arg-type]


def follower(**options: object) -> Session:
    return Session(load("follower"), "sim", world="line", clock=VirtualClock(), **options)  # type: ignore[arg-type]


def ticks(make: Callable[..., Session], seconds: float, turns: int) -> None:
    """Print the time of a tick without a journal, with it, and written into a file."""
    best: dict[str, float] = {}
    for _ in range(turns):
        for name, options in {"nothing is remembered": {"journal": 0}, "the past is kept": {}}.items():
            with make(**options) as session:
                session.run(2)
                before, begin = session.frame.tick, process_time()
                session.run(seconds)
                spent = (process_time() - begin) / (session.frame.tick - before)
                best[name] = min(best.get(name, 9.0), spent)
        with tempfile.TemporaryDirectory() as folder, make() as session:
            path = Path(folder) / "run.lrplog"
            with session.record(path):
                session.run(2)
                before, begin = session.frame.tick, process_time()
                session.run(seconds)
                spent = (process_time() - begin) / (session.frame.tick - before)
                best["and a recording is written"] = min(best.get("and a recording is written", 9.0), spent)
            size = path.stat().st_size / session.frame.time * 600 / 1e6
    base = next(iter(best.values()))
    print("| | µs | ratio |\n|---|---:|---:|")
    for name, time in best.items():
        print(f"| {name} | {time * 1e6:.2f} | {time / base:.2f} |")
    print(f"\n10 minutes at {session.rate:g} Hz: {size:.1f} MB of recording\n")


def timed(calls: list[Callable[[], object]]) -> str:
    spent = []
    for call in calls:
        begin = perf_counter()
        call()
        spent.append((perf_counter() - begin) * 1e3)
    return f"{statistics.median(spent):.1f} | {statistics.quantiles(spent, n=20)[-1]:.1f}"


def questions(seconds: float, count: int) -> None:
    """Print how long answers, looks back and forks take in a session that ran for a while."""
    print("| after 10 minutes of the line follower | p50 ms | p95 ms |\n|---|---:|---:|")
    with follower() as session:
        session.run(seconds)
        last = session.frame.tick
        some = [1 + (last - 2) * number // count for number in range(count)]
        print(f"| why not, now | {timed([lambda: session.why_not('tlooking')] * count)} |")
        then = [lambda t=t: session.why_not("tlooking", t) for t in some]
        print(f"| why not, in an earlier tick | {timed(then)} |")
        print(f"| why a state is active | {timed([lambda: session.why('follower/moving')] * count)} |")
        print(f"| why the robot moves | {timed([lambda: session.why('robot.move')] * count)} |")
        print(f"| the frame of an earlier tick | {timed([lambda t=t: session.at(t) for t in some])} |")
        print(f"| a fork of an earlier tick | {timed([lambda t=t: session.fork(t).close() for t in some])} |")

        def again() -> None:
            with session.fork(max(1, last - 600), inputs=True) as fork:
                fork.run(60)

        print(f"| the last 60 s run again | {timed([again] * max(2, count // 5))} |")
        whole = session.timeline()
        print(f"| the whole timeline | {timed([session.timeline] * count)} |")
        new = [lambda: session.timeline(whole.cursor)]
        print(f"| what is new in it | {timed(new * count)} |")
        names = ["robot.light.data", "follower/nobump", "robot.odom.x"]
        print(f"| three plots of all of it | {timed([lambda: session.plots(names)] * max(2, count // 5))} |")
        print(f"| a preview of 3 s | {timed([lambda: session.what_if(seconds=3)] * count)} |")
        paces = [
            load("follower").replace("forward := [0.2]", f"forward := [0.{pace}]") for pace in (20, 21, 22)
        ]
        print(f"| the same of three programs | {timed([lambda: session.try_programs(paces, 3)] * count)} |")
        recent = [lambda: session.plots(event="outofline", seconds=30)]
        print(f"| the last 30 s of what an event reads | {timed(recent * count)} |")
        changed = load("follower").replace("lightlim + 10", "lightlim + 60")
        edited = [lambda: session.what_if(max(1, last - 600), changed, 60)]
        print(f"| the last 60 s beside those of an edited program | {timed(edited * max(2, count // 5))} |")


def replayed(seconds: float) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.lrplog"
        with follower() as session, session.record(path):
            session.run(seconds)
        begin = perf_counter()
        again = reproduce(read_recording(path))
        spent = perf_counter() - begin
        assert again.difference is None
        again.session.close()
    print(f"\nA recording of {seconds:.0f} s is read and run again in {spent:.2f} s, with no difference.")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="see that it runs; the figures mean nothing")
    quick = parser.parse_args().quick
    turns, count = (1, 3) if quick else (7, 50)
    print("\n**A tick without a robot: a ring of five states**\n")
    ticks(ring, 5 if quick else 500, turns)
    print("**A tick of the line follower in the simulator**\n")
    ticks(follower, 2 if quick else 60, turns)
    questions(10 if quick else 600, count)
    replayed(5 if quick else 600)


if __name__ == "__main__":
    main()

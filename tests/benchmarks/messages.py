"""What it costs a tick that every message counts, and that none of a thousand in a second is lost.

    python tests/benchmarks/messages.py

Prints the median time of a tick of a program that does not ask for messages, and of one that adds all of them
to a list, with none and with a hundred messages in each tick; then how many of a thousand in a second arrive.
"""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parents[1]))

from support.robots import Buggy

from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session

TICKS, MANY, SECONDS = 1500, 100, 5
PROGRAM = "(var all := [[]]) (machine m (state s (running [all.extend({})] [{}])))(spawn m s)"
PROGRAMS = {
    "not asked for": PROGRAM.format("()", "robot.count.data > 5"),
    "all taken": PROGRAM.format("robot.count.new", "robot.count.data > 5"),
}


def buggy() -> Buggy:
    return Buggy(lambda bridge: bridge.feed("count.data", 0, stale_after=None))


def tick_time(program: str, messages: int) -> float:
    """Return the median time of a tick, in microseconds."""
    with Session(program, buggy(), clock=VirtualClock()) as session:
        session.run(1)
        loop, times = session._loop, []
        for tick in range(TICKS):
            for number in range(messages):
                session.bridge.feed("count.data", tick * messages + number)
            began = time.perf_counter()
            loop.tick()
            times.append(time.perf_counter() - began)
            loop.timing.go_to(loop.timing.due)
        return median(times) * 1e6


def received(program: str, rate: float) -> tuple[int, int]:
    """Return how many messages arrived in a program that ticks in real time, and how many were sent."""
    count = SECONDS * 1000
    with Session(program, buggy(), rate=rate) as session:
        session.start()
        time.sleep(0.5)

        def send() -> None:
            began = time.monotonic()
            for number in range(count):
                session.bridge.feed("count.data", 1 + number)
                time.sleep(max(0.0, began + (number + 1) / 1000 - time.monotonic()))

        sender = threading.Thread(target=send)
        sender.start()
        sender.join()
        time.sleep(0.5)
        session.pause()
        taken = [number for number in session.variables["all"] if number]
        assert taken == sorted(set(taken))
        return len(taken), count


if __name__ == "__main__":
    for name, program in PROGRAMS.items():
        for messages in (0, MANY):
            print(f"{name:14} {messages:4} messages in a tick: {tick_time(program, messages):6.1f} µs a tick")
    for rate in (10, 100):
        taken, sent = received(PROGRAMS["all taken"], rate)
        print(f"at {rate:3} Hz, {taken:,} of {sent:,} messages were taken, in their order")

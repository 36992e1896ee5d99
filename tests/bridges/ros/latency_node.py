"""The other side of the benchmark of a robot's latency: `python latency_node.py COUNT`, with rospy.

It publishes a light on `/light` that is now dark, now bright, and measures with its own clock how long it
takes until the program's command on `/cmd_vel` has changed its sign. It prints the milliseconds as JSON.
"""

from __future__ import annotations

import json
import random
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

PATIENCE = 120.0  # s


class Stopwatch:
    """Measures the time from each change of the light to the command that answers it."""

    def __init__(self, show: Callable[[int], None]) -> None:
        self._show = show
        self._forward: bool | None = None
        self._answered = threading.Event()
        self._at = 0.0

    def command(self, linear: float) -> None:
        """Take a command; on the thread on which it arrives."""
        now = time.monotonic()
        if self._forward is not None and linear != 0 and (linear > 0) is self._forward:
            self._forward, self._at = None, now
            self._answered.set()

    def measure(self, count: int) -> list[float]:
        """Return the milliseconds of each of so many changes, at random moments."""
        chance, found = random.Random(1), []
        for number in range(count + 1):
            time.sleep(chance.uniform(0.15, 0.35))
            self._answered.clear()
            self._forward = number % 2 == 0
            began = time.monotonic()
            self._show(255 if self._forward else 0)
            assert self._answered.wait(PATIENCE), f"no command after {number} changes"
            found.append(1e3 * (self._at - began))
        return found[1:]  # the first one may have come before the program ran


def answer(stopwatch: Stopwatch, count: int) -> None:
    """Measure whenever a line says that a program runs, until there are no more."""
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    for _line in sys.stdin:
        sys.stdout.write(json.dumps(stopwatch.measure(count)) + "\n")
        sys.stdout.flush()


def main(count: int) -> None:
    import rospy
    from geometry_msgs.msg import Twist
    from std_msgs.msg import UInt8

    class Listeners(rospy.SubscribeListener):  # type: ignore[misc]
        """Whether there are any: a subscription of rosbridge may be under way."""

        there = threading.Event()

        def peer_subscribe(self, *_: object) -> None:
            self.there.set()

        def peer_unsubscribe(self, _topic: str, count: int) -> None:
            if count == 0:
                self.there.clear()

    def show(value: int) -> None:
        Listeners.there.wait()
        light.publish(UInt8(value))

    def take(message: Any) -> None:
        stopwatch.command(message.linear.x)

    stopwatch = Stopwatch(show)
    rospy.init_node("stopwatch", disable_signals=True, disable_rosout=True, disable_rostime=True)
    light = rospy.Publisher("/light", UInt8, Listeners(), tcp_nodelay=True, queue_size=1)
    rospy.Subscriber("/cmd_vel", Twist, take, queue_size=1, tcp_nodelay=True)
    answer(stopwatch, count)


if __name__ == "__main__":
    main(int(sys.argv[1]))

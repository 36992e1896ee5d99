"""An EV3 stands although the program that drives it is dead or suspended: the brick ends its own slices."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from bridges.dying import Robot, StandsStill

pytestmark = pytest.mark.slow  # each starts processes of its own


@pytest.fixture
def robot(make_brick: Callable[..., Any], free_udp_port: int) -> Iterator[Robot]:
    """A brick in real time, with a wheel at motor B."""
    brick, over = make_brick(), threading.Event()
    speeds: list[tuple[float, float]] = []

    def look() -> None:
        while not over.wait(0.005):
            speed = brick.motors[1].turning
            if not speeds or speed != speeds[-1][1]:
                speeds.append((time.monotonic(), speed))

    looking = threading.Thread(target=look)
    looking.start()
    options = {"host": "127.0.0.1", "port": brick.port, "beacon_port": free_udp_port}
    named = [f"{name}={value}" for name, value in options.items()]
    yield Robot(
        lambda: list(speeds),
        ("--bridge", "ev3", *(part for option in named for part in ("--option", option))),
        f"from lrp_jupyter.bridges.ev3 import EV3Bridge\nbridge = EV3Bridge(**{options!r})",
    )
    over.set()
    looking.join()


class TestAnEV3(StandsStill):
    """It has no guard."""

    guarded = False

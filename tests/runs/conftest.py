from pathlib import Path

import pytest

from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session

LAPS = """(var pace := [0.3]) (var turn := [1500])
(machine laps
  (state ahead (running [robot.move(linear=pace)]))
  (state aside (running [robot.move(angular=1.0)]))
  (state away (onentry [robot.stop()]))
  (event bump [robot.bumper.data])
  (ontime 2000 ahead -> aside) (ontime turn aside -> ahead) (on bump ahead -> away)
  (on [pace < 0] ahead -> aside))
(spawn laps ahead)"""
"""A robot that drives and turns in turns until it bumps; in the world `line`, at 22.9 s."""


@pytest.fixture
def keep(tmp_path):
    """Keep a run of a program, and return its file."""

    def of(name="run", text=LAPS, seconds=25.0, bridge="sim", act=lambda session: None, **options) -> Path:
        options = {"world": "line", **options} if bridge == "sim" else options
        with Session(text, bridge, VirtualClock(), name="laps", **options) as session:
            act(session)
            session.run(seconds)
            return session.keep(name, tmp_path / "laps.runs")

    return of

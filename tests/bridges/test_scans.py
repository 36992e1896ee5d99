"""`robot.scan.nearest(-30, 30)`: the nearest distance of a scan in a sector, in ROS and in the simulator."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.robots import Bare

from lrp_jupyter import check
from lrp_jupyter.bridges.ros.types import Types
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session

NEAR = "(machine m (state a) (state b) (on [robot.scan.nearest(-30, 30) < 0.5] a -> b near)) (spawn m a)"
LOW, HIGH = 0.1, 5.0


def scan(first: float, step: float, ranges: list[float], **limits: float) -> Any:
    """A scan whose first ray, and whose steps, are given in degrees."""
    fields = {"range_min": LOW, "range_max": HIGH, "angle_max": 9.0, **limits}
    angles = {"angle_min": math.radians(first), "angle_increment": math.radians(step)}
    return Types().form("sensor_msgs/LaserScan").decode({**fields, **angles, "ranges": ranges})


distances = st.one_of(
    st.floats(0.0, 6.0), st.sampled_from([math.nan, math.inf, 0.0, -1.0, 0.05, LOW, HIGH, 7.0])
)


@given(
    st.integers(-360, 360),
    st.sampled_from([-30, -1, 1, 2, 45]),
    st.lists(distances, min_size=1, max_size=400),
    st.integers(-400, 400),
    st.integers(0, 360),
)
def test_the_nearest_ray_of_a_sector_wherever_the_scan_begins_and_whichever_way_it_turns(
    first: int, step: int, ranges: list[float], right: int, width: int
) -> None:
    # the edges of the sector are between rays, so that rounding decides nothing
    middle, half = right + width / 2, width / 2 + 0.5
    inside = [
        distance
        for number, distance in enumerate(ranges)
        if abs(math.remainder(first + number * step - middle, 360)) <= half
    ]
    reading = scan(first, step, ranges)
    if not inside:
        with pytest.raises(BridgeError, match="No ray of the scan lies between"):
            reading.nearest(right - 0.5, right + width + 0.5)
        return
    measured = [distance for distance in inside if LOW <= distance <= HIGH]
    assert reading.nearest(right - 0.5, right + width + 0.5) == min(measured, default=math.inf)


def test_what_is_too_near_to_be_measured_is_near_and_a_range_that_is_not_set_is_no_limit() -> None:
    reading = scan(-90, 90, [1.0, -math.inf, 2.0])
    assert (reading.nearest(), reading.nearest(-90, -45)) == (LOW, 1.0)  # the edge is part of the sector
    assert scan(0, 1, [70.0], range_max=0.0).nearest(0, 0) == 70.0


@pytest.mark.parametrize(
    ("sector", "sentence"),
    [
        ((30, -30), r"write `nearest\(-30, 30\)` for what lies .*, or `nearest\(30, 330\)` for all the rest"),
        ((150, 170), "No ray of the scan lies between 150° and 170°: there are 181, from -90° to 90°"),
        (("left", 30), r"`nearest\(right\)` must be a number, not 'left'"),
        ((math.nan, 30), r"`nearest\(right\)` must be a finite number"),
    ],
)
def test_a_sector_that_means_nothing_is_refused_with_what_the_scan_sees(
    sector: tuple[Any, Any], sentence: str
) -> None:
    with pytest.raises(BridgeError, match=sentence):
        scan(-90, 1, [1.0] * 181).nearest(*sector)
    with pytest.raises(BridgeError, match="between 1° and 2°: it is empty"):
        scan(0, 1, []).nearest(1, 2)
    with pytest.raises(BridgeError, match="there is only one, at 0°"):
        scan(0, 1, [2.0]).nearest(1, 2)


def test_a_field_of_that_name_is_preferred() -> None:
    types = Types()
    known = types._definitions["sensor_msgs/LaserScan"]
    known = type(known)(known.type, {**known.fields, "nearest": known.fields["range_min"]})
    types.add({known.type: known})
    assert types.form(known.type).decode({"nearest": 0.25, "ranges": [1.0]}).nearest == 0.25


def test_the_simulated_robot_has_the_same_word_for_its_rays() -> None:
    sim = SimBridge("maze")
    sim.open()
    robot: Any = sim.robot
    assert robot.scan.nearest(-30, 30) == robot.distance.data == robot.scan.nearest(330, 390)
    assert robot.scan.nearest(80, 100) == robot.left.distance
    assert robot.scan.nearest() == min(robot.scan.ranges) == min(robot.distance.all)
    with pytest.raises(BridgeError, match=r"between 10° and 20°: they are at -90°, 0°, 90°\."):
        robot.scan.nearest(10, 20)
    assert check(f"; world: maze\n{NEAR}") == ()
    with Session(NEAR, SimBridge("maze"), clock=VirtualClock()) as session:
        session.run(0.2)
        assert session.why_not("near").facts["values"] == {"robot.scan.nearest(-30, 30)": 0.65}


def test_it_is_completed_explained_recorded_and_replayed(tmp_path: Path) -> None:
    seen = [scan(-90, 1, [3.0] * 90 + [distance] + [0.2] * 90) for distance in (2.0, 1.0, 0.4)]
    robot = Bare(lambda bridge: bridge.add_variable("scan", lambda: seen[0], type=type(seen[0])))
    path = tmp_path / "run.lrplog"
    with Session(NEAR.replace("30, 30", "0.4, 0.4"), robot, clock=VirtualClock()) as session:
        with session.record(path):
            session.run(0.2)
            offered = {field.name: field.signature for field in robot.describe("scan").fields}
            assert offered["scan.nearest"] == "(right=-180, left=180)"
            answer = session.why_not("near")
            assert answer.facts["values"] == {"robot.scan.nearest(-0.4, 0.4)": 2.0}
            while len(seen) > 1:
                del seen[0]
                session.run(0.1)
        assert session.frame.active == (("m", "b"),)
        at = session.frame.tick
    again = reproduce(read_recording(path))
    with again.session as session:
        assert again.difference is None
        assert (session.frame.tick, session.frame.active) == (at, (("m", "b"),))


def test_a_wrong_call_is_an_issue_of_the_block_that_makes_it() -> None:
    text = "(machine m (state a) (state b) (on [robot.scan.nearest(30, -30) < 0.5] a -> b)) (spawn m a)"
    with Session(text, SimBridge("maze"), clock=VirtualClock()) as session:
        session.run(0.1)
        (issue,) = session.issues
        assert "write `nearest(-30, 30)`" in issue.message
        assert (issue.line, text[issue.column - 1 :][:10]) == (1, "robot.scan")

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.tables import every

from lrp_jupyter.sim.floor import SPOT, LiveFloor, Paint
from lrp_jupyter.sim.world import ArcStroke, CircleStroke, FloorSpec, PathStroke


def light(x, y, *strokes, grey=255):
    return LiveFloor(FloorSpec(grey, strokes)).light(x, y)


def test_an_empty_floor_has_its_grey_everywhere():
    assert light(3, -7, grey=90) == 90


def test_the_middle_of_a_line_is_as_dark_as_the_line():
    assert light(1, 1, PathStroke(((0, 1), (2, 1)), grey=40)) == 40


def test_half_the_spot_on_the_edge_reads_the_mean():
    assert light(1, 1.015, PathStroke(((0, 1), (2, 1)), width=0.03)) == pytest.approx(127.5)


@given(st.floats(-SPOT, SPOT))
def test_the_share_of_the_spot_on_a_line_is_the_area_of_its_part(beyond):
    step = SPOT / 100
    inside = total = 0
    for row in range(-100, 101):
        width = math.sqrt(SPOT**2 - min(SPOT, abs(row * step)) ** 2)
        total += width
        inside += width if row * step + beyond <= 0 else 0
    seen = light(1, 1.5 + beyond, PathStroke(((0, 1), (2, 1)), width=1))
    assert 1 - seen / 255 == pytest.approx(inside / total, abs=0.01)


def test_a_line_thinner_than_the_spot_is_seen_in_part():
    assert 160 < light(1, 1, PathStroke(((0, 1), (2, 1)), width=0.001)) < 190


def test_later_strokes_cover_earlier_ones():
    line, over = PathStroke(((0, 0), (1, 0))), PathStroke(((0.5, -1), (0.5, 1)), grey=200)
    assert light(0.5, 0, line, over) == 200
    assert light(0.5, 0, over, line) == 0


def test_a_path_has_round_ends_and_corners():
    path = PathStroke(((0, 0), (1, 0), (1, 1)), width=0.2)
    assert light(1.06, -0.06, path) == 0
    assert light(1.09, -0.09, path) == 255
    assert light(-0.09, 0, path) == 0


def test_one_point_is_a_dot():
    assert light(1, 1.09, PathStroke(((1, 1),), width=0.2)) == 0
    assert light(1, 1.11, PathStroke(((1, 1),), width=0.2)) == 255


@every("angles", [(0.5, 2.5), (2.5, 0.5)])
def test_an_arc_is_seen_between_its_angles_only(angles):
    arc = ArcStroke((1, 1, 0.5, *angles))
    on = [light(1 + 0.5 * math.cos(angle), 1 + 0.5 * math.sin(angle), arc) for angle in (0.6, 1.5, 2.4)]
    off = [light(1 + 0.5 * math.cos(angle), 1 + 0.5 * math.sin(angle), arc) for angle in (0, 3, -1.5)]
    assert on == [0, 0, 0]
    assert off == [255, 255, 255]
    assert light(1 + 0.51 * math.cos(0.49), 1 + 0.51 * math.sin(0.49), arc) == 0  # its end is round


def test_a_circle_is_a_ring():
    ring = CircleStroke((1, 1, 0.5))
    assert [light(1.5, 1, ring), light(1, 0.5, ring), light(1, 1, ring)] == [0, 0, 255]


@given(st.floats(0, 2), st.floats(0, 2))
def test_the_grid_of_cells_hides_nothing(x, y):
    arc = ArcStroke((1, 1, 0.6, -2, 2.2), width=0.11)
    dx, dy = x - 1, y - 1
    angle = math.atan2(dy, dx)
    nearest = (
        abs(math.hypot(dx, dy) - 0.6)
        if -2 <= angle <= 2.2
        else min(math.hypot(dx - 0.6 * math.cos(end), dy - 0.6 * math.sin(end)) for end in (-2, 2.2))
    )
    seen = light(x, y, arc)
    if nearest < 0.055 - SPOT:
        assert seen == 0
    if nearest > 0.055 + SPOT:
        assert seen == 255


def test_what_is_painted_on_a_floor_is_on_no_copy_of_it():
    line = PathStroke(((0, 0), (1, 0)))
    floor, copy = LiveFloor(FloorSpec(255, (line,))), LiveFloor(FloorSpec(255, (line,)))
    floor.paint(FloorSpec(255, (line, PathStroke(((0.5, -1), (0.5, 1))))))
    assert (floor.light(0.5, 0.5), copy.light(0.5, 0.5)) == (0, 255)
    assert floor.light(0.2, 0) == copy.light(0.2, 0)


def test_ink_darkens_and_never_lightens():
    floor = LiveFloor(FloorSpec(255, (PathStroke(((0, 0), (1, 0))),)))
    floor.ink(Paint(0.01, 120, True), (0.5, -1), (0.5, 1), step=3)
    assert floor.light(0.5, 0) == 0
    assert floor.light(0.5, 0.5) == 120


def test_a_prefix_of_the_marks_is_the_floor_of_before():
    floor = LiveFloor(FloorSpec())
    floor.ink(Paint(0.01, 99, True), (0, 0), (1, 0), step=1)
    floor.ink(Paint(0.01, 0, True), (0, 0), (1, 0), step=2)
    assert floor.light(0.5, 0) == 0
    assert LiveFloor(FloorSpec(), floor.marks[:1]).light(0.5, 0) == 99

"""Sweeps: which initial values are fast, and which are robust."""

import json
import re
from xml.etree import ElementTree

import pytest
from support.tables import every

from lrp_jupyter import Session, sweep
from lrp_jupyter.errors import LRPError, LRPSyntaxError, UnknownElementError
from lrp_jupyter.grading.attempt import Attempt
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import drives
from lrp_jupyter.grading.grade import Grade, grade
from lrp_jupyter.grading.sweep import Sweep, SweepPoint

TEXT = """
(var v := [0.1]) (var on := [True])
(machine m (state a (running [robot.move(linear=v) if on else None]))) (spawn m a)
"""


def result(*times, axes=("v",), values=None):
    """A sweep with these times of its runs at each value; None is a failed run."""
    points = []
    for number, runs in enumerate(times):
        attempts = tuple(
            Attempt("w", seed, time or 0.0, (), ended="" if time else "time")
            for seed, time in enumerate(runs)
        )
        points.append(
            SweepPoint((number,) if values is None else values[number], Grade("x", attempts, 10, 2))
        )
    return Sweep("x", axes, tuple(points))


def values_of(point):
    return None if point is None else point.values


@pytest.mark.slow
def test_a_sweep_is_the_grade_of_each_text_with_that_value():
    swept = sweep(TEXT, "first move", v=[0.02, 0.2], seeds=2)
    assert [point.values for point in swept.points] == [(0.02,), (0.2,)]
    for point in swept.points:
        assert point.grade == grade(TEXT.replace("[0.1]", f"[{point.values[0]}]"), "first move", 2)
    assert swept.fastest.values == swept.most_robust.values == (0.2,)
    assert [point.passed for point in swept.points] == [0, 2]


@pytest.mark.slow
def test_two_variables_are_swept_in_all_combinations():
    with Session(TEXT) as session:
        swept = sweep(session, "first move", {"on": [False, True]}, v=[0.1, 0.2], seeds=1)
    assert [point.values for point in swept.points] == [(False, 0.1), (False, 0.2), (True, 0.1), (True, 0.2)]
    assert [point.passed for point in swept.points] == [0, 0, 1, 1]
    assert swept.axes == ((False, True), (0.1, 0.2))


def test_the_fastest_is_among_those_with_which_the_most_runs_pass():
    assert values_of(result((9, 9), (1, None), (5, 7), (6, 8)).fastest) == (2,)
    assert values_of(result((None, None)).fastest) is None


@every(
    ("passing", "middle"),
    [("1110111110", 6), ("0111", 2), ("11011", 0), ("1101110", 4), ("111", 1), ("1", 0), ("000", 1)],
)
def test_the_most_robust_is_the_middle_of_the_longest_row_of_neighbours(passing, middle):
    swept = result(*((5, 5) if each == "1" else (5, None) for each in passing))
    assert values_of(swept.most_robust) == (middle,)


def test_of_equally_robust_values_the_faster_one_is_taken():
    assert values_of(result((9, 9), (9, 9), (3, 3), (9, 9)).most_robust) == (2,)


def test_the_most_robust_of_a_plane_is_the_furthest_from_its_edges():
    rows = ["00000", "01110", "01110", "01110", "00000"]
    values = [(x, y) for x in range(5) for y in range(5)]
    swept = result(
        *((5, 5) if rows[x][y] == "1" else (5, None) for x, y in values), axes=("x", "y"), values=values
    )
    assert swept.most_robust.values == (2, 2)


def test_the_table_has_a_row_for_each_value_and_the_text_ends_with_the_conclusions():
    swept = result((9, 9), (1, None), (5, 7))
    columns, rows = swept.table()
    assert columns == ("v", "passed", "runs", "points", "median_s", "worst_s", "remark")
    assert rows[1] == (1, 1, 2, 0.0, 1, 1, "")
    assert rows[2][3:] == (10, 6, 7, "fastest, most robust")
    assert str(swept).splitlines()[-2:] == [
        "Fastest: v = 2 (2 of 2 runs passed, median 6.0 s, worst 7.0 s).",
        "Most robust: v = 2 (2 of 2 runs passed, median 6.0 s, worst 7.0 s).",
    ]
    assert swept.csv().splitlines()[2] == "1,1,2,0.0,1,1,"
    assert len(json.loads(swept.to_json())["points"]) == 3


def test_a_challenge_without_noise_says_that_its_seeds_are_alike():
    task = Challenge("way", "Drive.", "empty", drives(0.3), 5)
    assert "has no noise" in str(sweep(TEXT, task, v=[0.1], seeds=1))


def test_a_map_of_one_variable_has_a_cell_for_each_run_and_crosses_those_that_failed():
    root = ElementTree.fromstring(result((9, 9), (1, None), (5, 7)).svg())
    svg = "{http://www.w3.org/2000/svg}"
    cells = [each for each in root.iter(f"{svg}rect") if each.find(f"{svg}title") is not None]
    assert len(cells) == 6
    failed = [each.find(f"{svg}title").text for each in cells if each.get("class") == "failed"]
    assert failed == ["v = 1, w, seed 1: not made"]
    fills = {each.find(f"{svg}title").text: each.get("fill") for each in cells}
    assert fills["v = 1, w, seed 0: 1.0 s"] == "#fee838"  # the shortest time is the lightest
    assert fills["v = 0, w, seed 0: 9.0 s"] == "#00224e"
    texts = [each.text for each in root.iter(f"{svg}text")]
    assert {"2/2", "1/2", "fastest", "did not pass", "9.0 s", "1.0 s"} <= set(texts)


def test_a_map_of_two_variables_writes_the_shares_legibly():
    swept = result(
        (9, 9), (None, None), (5, None), (5, 7), axes=("x<", "y"), values=[(0, 0), (0, 1), (1, 0), (1, 1)]
    )
    picture = swept.svg()
    root = ElementTree.fromstring(picture)
    svg = "{http://www.w3.org/2000/svg}"
    shares = [
        (each.text, each.get("class"))
        for each in root.iter(f"{svg}text")
        if each.get("class") in ("on-dark", "on-light")
    ]
    assert shares == [("100%", "on-light"), ("0%", "on-dark"), ("50%", "on-light"), ("100%", "on-light")]
    assert "prefers-color-scheme:dark" in picture


def test_a_sweep_is_a_picture_and_a_table_in_a_notebook():
    html = result((9, 9), (1, None))._repr_html_()
    assert html.index("<svg") < html.index("<table>")
    assert len(re.findall("<tr>", html)) == 3
    three = result((9, 9), axes=("a", "b", "c"), values=[(1, 2, 3)])
    assert "<svg" not in three._repr_html_()
    with pytest.raises(ValueError, match="one or two variables, not 3"):
        three.svg()


@every(
    ("variables", "error", "words"),
    [
        ({"w": [1]}, UnknownElementError, "`w` cannot be swept: There is no variable `w`."),
        ({"vv": [1]}, UnknownElementError, "Did you mean `v`"),
        ({}, ValueError, "needs a variable"),
        ({"v": []}, ValueError, "has no values"),
        ({"v": "123"}, TypeError, "must be a list of values"),
        ({"v": 0.5}, TypeError, "must be a list of values"),
        ({"v": [float("nan")]}, ValueError, "cannot be nan"),
        ({"v": [None]}, TypeError, "not NoneType"),
    ],
)
def test_a_wrong_variable_or_value_is_a_sentence(variables, error, words):
    with pytest.raises(error, match=re.escape(words)):
        sweep(TEXT, "first move", **variables)


def test_a_text_that_is_not_a_program_or_an_unknown_challenge_is_not_swept():
    with pytest.raises(LRPSyntaxError):
        sweep("(var v := [1]", "first move", v=[1])
    with pytest.raises(LRPError, match="Did you mean `first move`"):
        sweep(TEXT, "frst move", v=[1])


def test_numbers_of_numpy_are_written_as_python_reads_them():
    numpy = pytest.importorskip("numpy")
    swept = sweep(TEXT, "first move", v=numpy.linspace(0.1, 0.2, 2), seeds=1)
    assert [point.values for point in swept.points] == [(0.1,), (0.2,)]

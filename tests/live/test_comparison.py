"""A run is compared with a recorded one tick by tick, and the first difference is told."""

import json

import pytest

from lrp_jupyter.live.comparison import Comparison


def changed(tick, variable, value):
    return {"tick": tick, "time": tick / 10, "event": "changed", "variable": variable, "value": value}


def read(tick, **readings):
    return {"tick": tick, "time": tick / 10, "readings": readings}


PATCHED = {"tick": 1, "time": 0.1, "event": "patched", "applied": True, "restarted": False, "reason": None}
FIRED = {
    "tick": 2,
    "time": 0.2,
    "event": "fired",
    "machine": "m",
    "transition": "go",
    "source": "a",
    "destination": "b",
}


def compared(recorded, now, other=False):
    comparison = Comparison(recorded, other)
    for line in now:
        comparison.write(json.dumps(line))
    comparison.end()
    return comparison.difference


@pytest.mark.parametrize(
    ("recorded", "now", "told"),
    [
        ([changed(1, "n", 1)], [changed(1, "n", 2)], "Recorded: `n` became 1. Replay: `n` became 2."),
        ([changed(1, "n", 1)], [], "Only in the recording: `n` became 1."),
        ([], [changed(1, "n", 1)], "Only in the replay: `n` became 1."),
        (
            [changed(1, "n", 1), changed(1, "k", 1)],
            [changed(1, "k", 1), changed(1, "n", 1)],
            "Recorded: `n` became 1. Replay: `k` became 1.",
        ),
        (
            [read(1, light=3, gap=0.5)],
            [read(1, light=4, gap=0.5)],
            "Recorded: `robot.light` was 3. Replay: `robot.light` was 4.",
        ),
    ],
    ids=["another value", "only there", "only now", "order", "reading"],
)
def test_what_each_did_is_told(recorded, now, told):
    difference = compared(recorded, now)
    assert str(difference) == f"The first difference is at 0.1 s (tick 1). {told}"


def test_what_explains_a_tick_is_told_first():
    left = {"tick": 2, "time": 0.2, "event": "left", "state": "m/a"}
    difference = compared([read(1), changed(2, "n", 1), read(2)], [read(1), left, FIRED, read(2)])
    assert (difference.tick, difference.machine, difference.now) == (2, "m", FIRED)
    assert "at 0.2 s (tick 2), in the machine `m`." in str(difference)


def test_a_tick_that_is_not_over_is_compared_as_far_as_it_is():
    comparison = Comparison([FIRED, read(2)])
    comparison.write(json.dumps(FIRED))
    comparison.end_of_tick(is_whole=False)
    assert comparison.difference is None


def test_a_reading_that_nothing_reads_any_more_is_no_difference():
    assert compared([read(1, light=3, gap=0.5)], [read(1, gap=0.5)]) is None
    assert compared([read(1, gap=0.5)], [read(1, light=3, gap=0.5)]) is not None


def test_another_program_may_have_other_lines_and_no_edits():
    recorded, now = {**FIRED, "line": 3}, {**FIRED, "line": 9}
    assert compared([PATCHED, recorded], [now], other=True) is None
    assert compared([recorded], [now]) is not None
    assert compared([PATCHED], []) is not None

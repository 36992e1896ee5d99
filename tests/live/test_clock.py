import math
from threading import Event

import pytest

from lrp_jupyter.live import clock as clocks
from lrp_jupyter.live.clock import MonotonicClock, VirtualClock


@pytest.fixture
def wall(monkeypatch):
    """A wall clock that the test moves by hand."""
    now = [100.0]
    monkeypatch.setattr(clocks, "monotonic", lambda: now[0])
    return now


def test_a_virtual_clock_jumps_to_the_time_waited_for():
    clock = VirtualClock()
    clock.sleep_until(217.1, Event())
    assert clock.now() == 217.1


def test_a_virtual_clock_never_goes_back_by_waiting():
    clock = VirtualClock(5)
    clock.sleep_until(3, Event())
    assert clock.now() == 5


def test_a_virtual_clock_does_not_jump_when_the_wait_is_interrupted():
    clock, wake = VirtualClock(), Event()
    wake.set()
    clock.sleep_until(3, wake)
    clock.sleep_until(math.inf, wake)
    assert clock.now() == 0


def test_paused_time_does_not_pass(wall):
    clock = MonotonicClock()
    wall[0] += 2
    clock.pause()
    wall[0] += 60
    assert clock.now() == 2
    clock.resume()
    wall[0] += 1
    assert clock.now() == 3


def test_pausing_and_resuming_twice_is_as_good_as_once(wall):
    clock = MonotonicClock()
    clock.pause()
    wall[0] += 5
    clock.pause()
    clock.resume()
    wall[0] += 1
    clock.resume()
    assert clock.now() == 1


@pytest.mark.parametrize("speed", [0.25, 1, 10])
def test_a_clock_runs_at_its_speed(wall, speed):
    clock = MonotonicClock(speed)
    wall[0] += 4
    assert clock.now() == 4 * speed
    assert clock.delay(4 * speed + 1) == pytest.approx(1 / speed)


def test_changing_the_speed_does_not_move_the_present(wall):
    clock = MonotonicClock()
    wall[0] += 3
    clock.speed = 10
    assert clock.now() == 3
    wall[0] += 1
    assert clock.now() == 13


def test_at_infinite_speed_nothing_waits(wall):
    clock = MonotonicClock(math.inf)
    clock.sleep_until(217.1, Event())
    assert (clock.now(), clock.delay(300)) == (217.1, 0)


def test_a_rebased_clock_continues_from_there(wall):
    clock = MonotonicClock()
    wall[0] += 9
    clock.rebase(2)
    wall[0] += 1
    assert clock.now() == 3
    clock.pause()
    clock.rebase(7)
    wall[0] += 1
    assert clock.now() == 7


def test_a_paused_clock_waits_for_a_call_only(wall):
    clock, wake = MonotonicClock(), Event()
    clock.pause()
    assert clock.delay(1) == math.inf
    wake.set()
    clock.sleep_until(1, wake)


@pytest.mark.parametrize("speed", [0, -1, math.nan])
def test_a_clock_runs_forwards(speed):
    with pytest.raises(ValueError, match="above 0"):
        MonotonicClock(speed)


def test_a_wait_of_a_clock_is_one_that_a_timer_can_count(wall):
    for speed in (5e-324, 1e-308, 1e-9):
        assert MonotonicClock(speed).delay(10) <= 3600
    assert MonotonicClock(1e300).speed == math.inf

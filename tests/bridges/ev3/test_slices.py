"""Motors that go on turning, in slices: on the emulated brick, in virtual time, without a network."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import pytest

from lrp_jupyter.bridges.ev3 import protocol
from lrp_jupyter.bridges.ev3.slices import SLICE, Slices


@pytest.fixture
def slices(clock: Any) -> Slices:
    return Slices(clock)


@pytest.fixture
def obeys(brick: Any, emulation: ModuleType) -> Any:
    """Let the brick execute a code."""
    return lambda code: emulation.run_code(brick, code, 0)


def turning(brick: Any) -> list[float]:
    return [motor.turning for motor in brick.motors]


def test_a_motor_that_is_renewed_turns_on_without_a_gap(slices, obeys, brick, clock):
    obeys(slices.turn({1: 30}))
    for _ in range(500):
        clock.now += 0.02
        assert turning(brick) == [0, 30, 0, 0]
        code, late = slices.renew()
        obeys(code)
        assert not late
    assert brick.motors[1].angle == pytest.approx(30 * 10 * 500 * 0.02)
    assert 45 <= brick.motors[1].starts <= 51, "five commands a second"


def test_a_motor_that_is_not_renewed_stands_after_a_slice_and_is_not_held(slices, obeys, brick, clock):
    obeys(slices.turn({0: 100, 3: -20}) + slices.turn({1: 50}, regulated=False))
    clock.now += SLICE - 0.01
    assert turning(brick) == [100, 50, 0, -20]
    clock.now += 0.02
    assert turning(brick) == [0, 0, 0, 0]
    assert not any(motor.braked for motor in brick.motors)


def test_a_renewal_that_comes_too_late_starts_nothing_and_says_which_motors_stand(
    slices, obeys, brick, clock
):
    obeys(slices.turn({0: 100, 3: -20}))
    clock.now += 3
    assert slices.renew() == (b"", 0b1001)
    clock.now += 0.3
    assert slices.renew() == (b"", 0)
    assert slices.turn({0: 100}), "a new command is another thing"


def test_a_command_that_repeats_the_last_one_is_sent_when_a_renewal_is_due(slices, clock):
    assert slices.turn({1: 30, 2: 30})
    clock.now += 0.1
    assert slices.turn({1: 30, 2: 30}) == b""
    clock.now += 0.15
    assert slices.turn({1: 30, 2: 30})
    assert slices.renew() == (b"", 0)
    assert slices.turn({1: 30, 2: 31}) == protocol.run_milliseconds(0b0100, 31, 600, False)
    assert slices.turn({1: 30}, regulated=False) == protocol.run_milliseconds(
        0b0010, 30, 600, False, regulated=False
    )


def test_motors_with_the_same_speed_begin_in_one_operation(slices):
    assert slices.turn({1: 30, 2: 30}) == protocol.run_milliseconds(0b0110, 30, 600, False)


def test_a_speed_of_zero_stops_the_motor_and_holds_it_and_no_power_lets_it_run_out(slices, clock):
    slices.turn({0: 30, 1: 30})
    assert slices.turn({0: 0}) == protocol.stop(0b0001, brake=True)
    assert slices.turn({1: 0}, regulated=False) == protocol.stop(0b0010, brake=False)
    clock.now += 100
    assert slices.renew() == (b"", 0)


def test_what_another_command_took_over_is_not_renewed(slices, clock):
    slices.turn({0: 30, 1: 40})
    slices.release(0b0001)
    clock.now += 0.3
    assert slices.renew() == (protocol.run_milliseconds(0b0010, 40, 600, False), 0)

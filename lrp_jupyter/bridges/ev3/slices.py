"""Motors that go on turning, in slices of 0.6 s, so that a brick left alone stops them by itself.

No command of a program turns a motor for ever. A motor that is to go on gets the brick's timed command, 0.6 s
long, and the link renews it every 0.2 s, in the frame that reads the brick. If this process is killed or
stopped, if the computer sleeps or the network fails, the renewals cease, and with them the motors.

Renewing causes no jerk, as the source of the brick's firmware (`d_pwm.c`, 1.09) shows. A timed command that
meets a turning motor resets its clock and the terms of its regulator. It keeps the power that the regulator
has found. There are no ramps. With `brake` 0 the motor does not slow down towards the end of a slice, and one
that comes late meets a motor that still rolls. While a motor accelerates, each command pushes it once more;
thus a command that repeats the last one, as that of `move` in every tick, is only sent when a renewal is due.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from lrp_jupyter.bridges.ev3 import protocol

SLICE = 0.6
"""Seconds that a motor turns without a renewal."""

_RENEWED = 0.2  # seconds after which a slice is renewed: an answer of the brick may take 0.3 s meanwhile


class _Turn(NamedTuple):
    """What a motor is to do: percent of its speed (regulated) or power; 0: stand."""

    percent: int
    regulated: bool


class Slices:
    """The motors of one connection that go on turning; returns the byte codes that make them do so.

    Owner: whoever is sending a frame, so that codes are sent in the order in which they were made.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._turns: dict[int, tuple[_Turn, float]] = {}  # by motor, with the time of the last slice

    def turn(self, percents: Mapping[int, int], regulated: bool = True) -> bytes:
        """Let motors go on turning; empty where they do so already.

        `percents`: by motor (0 to 3): -100 to 100. With 0 a regulated motor is held, another one runs out.
        `regulated`: whether they are percent of the speed, which the brick keeps, or of the power.
        """
        now, due = self._clock(), []
        for motor, percent in percents.items():
            turn = _Turn(percent, regulated)
            known, since = self._turns.get(motor, (None, 0.0))
            if known != turn or now - since >= _RENEWED:
                self._turns[motor] = turn, now
                due.append(motor)
        return self._code(due)

    def release(self, motors: int) -> None:
        """Leave motors, a bit mask, to another command."""
        self._turns = {motor: turn for motor, turn in self._turns.items() if not motors & 1 << motor}

    def renew(self) -> tuple[bytes, int]:
        """Renew what is due; also return the bit mask of the motors for which it is too late.

        These stand: the brick has stopped them, and they are not started again.
        """
        now, due, late = self._clock(), [], 0
        for motor, (turn, since) in self._turns.items():
            if turn.percent and now - since > SLICE:
                late |= 1 << motor
            elif turn.percent and now - since >= _RENEWED:
                due.append(motor)
        self.release(late)
        self._turns.update({motor: (self._turns[motor][0], now) for motor in due})
        return self._code(due), late

    def _code(self, motors: list[int]) -> bytes:
        """Return the code of a slice for motors; those that do the same begin together."""
        ports: dict[_Turn, int] = {}
        for motor in motors:
            turn = self._turns[motor][0]
            ports[turn] = ports.get(turn, 0) | 1 << motor
        code = b""
        for (percent, regulated), mask in ports.items():
            if percent:
                code += protocol.run_milliseconds(mask, percent, round(1000 * SLICE), False, regulated)
            else:  # at a regulated speed of 0 the brick would keep its last power
                code += protocol.stop(mask, brake=regulated)
        return code

"""Drives the wheels of a brick for a way, a turn or a point that a program asks for, reading by reading.

On the way the motors turn in slices, so that a brick left alone stops them as it does after `move`. The end
is the brick's own, and no longer than a slice: each wheel is turned by the angle that is left, which the
brick does exactly, and then holds. What is still left when they stand is turned again, slowly. The odometer
says what is left.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass

from lrp_jupyter.bridges.ev3 import protocol
from lrp_jupyter.bridges.ev3.link import BrickLink
from lrp_jupyter.bridges.ev3.protocol import BrickReading
from lrp_jupyter.bridges.ev3.vehicle import Vehicle
from lrp_jupyter.sim.errands import ENDED, Errand, Errands, after_leg, begun, judged
from lrp_jupyter.sim.world import Pose

_LAST = 0.3  # s, at the speed of the errand, that the brick drives alone
_SHARE, _LEAST = 0.5, 8  # of the speed then, and percent at least
_NEAR, _NEARLY = 2, 8  # degrees of a wheel: near enough, and after two corrections
_CORRECTIONS = 2
_RESTING = 10  # hundredths of a second after which a wheel that was commanded turns
_KEEPING = 2.0  # 1/s: how it keeps its heading


@dataclass(slots=True)
class _Trip:
    errand: Errand
    told: Callable[[Errand, float], object]
    corrections: int = -1  # -1: the motors turn in slices
    commanded: int = 0  # when the brick was told to drive the rest


class WheelDriver:
    """Drives one vehicle for one errand at a time. Any thread may call any method.

    `vehicle`: returns how it is built.
    `clock`: in seconds.
    """

    def __init__(self, link: BrickLink, vehicle: Callable[[], Vehicle], clock: Callable[[], float]) -> None:
        self._link, self._vehicle, self._clock = link, vehicle, clock
        self._lock = threading.RLock()
        self._trip: _Trip | None = None

    def begin(self, what: Errands, told: Callable[[Errand, float], object]) -> None:
        """Drive for an errand from now on; that before it is over.

        `told`: called with the errand and what is left of it after each reading, until it is over.
        """
        with self._lock:
            before = None if self._trip is None else self._trip.errand
            trip = _Trip(begun(what, self._link.snapshot.pose, self.now(), before), told)
            self._trip = trip
            self._link.own(trip, sum(1 << motor for motor in self._vehicle().motors))
            self.go_on()

    def end(self, number: int) -> None:
        """End an errand, and stop the wheels, if they still turn for that one."""
        with self._lock:
            trip = self._trip
            if trip is not None and trip.errand.what.number == number:
                self._trip = None
                self._hold(trip)

    def go_on(self) -> None:
        """Drive on as the latest reading demands."""
        with self._lock:
            trip, seen = self._trip, self._link.snapshot
            if trip is None or seen.reading is None:
                return
            if self._link.owner is trip:
                trip.errand = self._driven(trip, seen.pose, seen.reading)
                if not trip.errand.is_active:
                    self._hold(trip)
            else:
                trip.errand = trip.errand.ended("aborted", ENDED)
            if not trip.errand.is_active:
                self._trip = None
            told, errand, left = trip.told, trip.errand, trip.errand.left(seen.pose)
        told(errand, left)

    def _driven(self, trip: _Trip, pose: Pose, reading: BrickReading) -> Errand:
        errand, vehicle, now = trip.errand, self._vehicle(), self.now()
        ahead, turn = errand.rest(pose)
        share = turn * vehicle.track / 2000
        rest = vehicle.degrees(ahead - share, ahead + share)
        farthest = max(map(abs, rest.values()))
        linear, angular = (0.0, errand.speed) if errand.leg.goal is None else (errand.speed, 0.0)
        pace = max(map(abs, vehicle.degrees(linear - angular * vehicle.track / 2000, 0.0).values()))
        is_slow = farthest <= pace * _LAST
        if trip.corrections < 0 and not is_slow:
            if angular:
                angular = math.copysign(angular, turn)
            else:
                linear, angular = math.copysign(linear, ahead), max(-1.0, min(1.0, _KEEPING * turn))
            percents, _ = vehicle.percents(linear, angular, reading)
            self._link.turn(percents, owner=trip)
            return judged(errand, pose, now)
        turns = any(reading.motors[motor].speed for motor in rest)
        if trip.corrections >= 0 and (turns or now - trip.commanded < _RESTING):
            return judged(errand, pose, now)
        if farthest <= (_NEAR if trip.corrections < _CORRECTIONS else _NEARLY):
            trip.corrections = -1
            return after_leg(errand, pose, now)
        percents, _ = vehicle.percents(*((0.0, errand.speed) if angular else (errand.speed, 0.0)), reading)
        usual = max(map(abs, percents.values()))
        fastest = max(_LEAST, round(usual * _SHARE)) if trip.corrections < 0 else _LEAST
        code, wheels = b"", 0
        for motor, degrees in rest.items():
            if amount := abs(round(degrees)):
                wheels |= 1 << motor
                percent = math.ceil(fastest * amount / farthest)
                code += protocol.run_degrees(1 << motor, percent if degrees > 0 else -percent, amount, True)
        trip.corrections, trip.commanded = trip.corrections + 1, now
        self._link.command(code, wheels, owner=trip)
        return judged(errand, pose, now)

    def _hold(self, trip: _Trip) -> None:
        wheels = sum(1 << motor for motor in self._vehicle().motors)
        self._link.command(protocol.stop(wheels, brake=True), wheels, owner=trip)

    def now(self) -> int:
        """Return the time, in steps of the errands."""
        return round(100 * self._clock())

"""Criteria about how the robot moves."""

from __future__ import annotations

from lrp_jupyter.grading.criteria.criterion import Criterion, Found
from lrp_jupyter.grading.run_record import RunRecord, Sample, angle_between

_FASTEST, _SLACK = 0.8, 0.05  # m/s; metres, which a collision may add
_BEND = 1.2  # rad/m; a tighter bend is not straight on


def drives(metres: float) -> Criterion:
    """Require that the robot drives at least this far, anywhere."""

    def judge(run: RunRecord) -> Found:
        return Found(run.driven / metres, f"it drove {run.driven:.2f} m")

    return Criterion(f"drives at least {metres:g} m", judge, "once")


def turns(degrees: float) -> Criterion:
    """Require that the robot turns by at least this much, left and right turns added up."""

    def judge(run: RunRecord) -> Found:
        turned = run.turned.total
        return Found(turned / degrees, f"it turned {turned:.0f}°")

    return Criterion(f"turns at least {degrees:g}°", judge, "once")


def drives_straight(share: float) -> Criterion:
    """Require that the robot drives at least this share (0 … 1) of its way straight on."""

    def judge(run: RunRecord) -> Found:
        straight = run.fold(_straight, 0.0)
        part = straight / run.driven if run.driven else 0.0
        return Found(part / share, f"{part:.0%} of its way was straight")

    return Criterion(f"drives at least {share:.0%} of its way straight on", judge)


def backs_off(times: int) -> Criterion:
    """Require that the robot drives backward so often."""

    def judge(run: RunRecord) -> Found:
        count = run.fold(backed, 0)
        return Found(count / times, f"it {times_of('backed off', count)}")

    return Criterion(times_of("backs off", times), judge, "once")


def lasts(seconds: float) -> Criterion:
    """Require that the run goes on for this time: what must always hold has held so long."""

    def judge(run: RunRecord) -> Found:
        return Found((run.seconds + 1e-6) / seconds, f"{run.seconds:.0f} s have passed")

    return Criterion(f"goes on for {seconds:g} s", judge, "once")


def ends_still(seconds: float) -> Criterion:
    """Require that the robot stands still at the end for this time, without trying to move."""

    def judge(run: RunRecord) -> Found:
        return Found((run.stood + 1e-6) / seconds, f"it stood still for {run.stood:.1f} s")

    return Criterion(f"stands still for {seconds:g} s at the end", judge)


def keeps_driving(seconds: float, until: str = "") -> Criterion:
    """Require that the robot never stands still for longer than this time.

    Parameters
    ----------
    seconds : float
    until : str
        A solid: when the robot has touched it, it may stand still. By default, it has to drive on to the end.
    """

    def judge(run: RunRecord) -> Found:
        def step(so_far: tuple[float, float, bool], now: Sample, before: Sample) -> tuple[float, float, bool]:
            most, since, over = so_far
            over = over or (bool(until) and until in now.touched)
            since = now.time if over or now.moved(before) else since
            return max(most, now.time - since), since, over

        stood, _, _ = run.fold(step, (0.0, 0.0, False), ("stood still for", until))
        reason = f"it stood still for {stood:.1f} s" if stood > 0.15 else "it never stood still"
        return Found(stood <= seconds + 1e-6, reason)

    before = f" before it touches the {until}" if until else ""
    return Criterion(f"never stands still for longer than {seconds:g} s{before}", judge, "always")


def stops_once(seconds: float = 4) -> Criterion:
    """Require that the robot does not drive on after it has stood still for longer than this time.

    So no program passes that stops again and again, in the hope of one right place.
    """

    def judge(run: RunRecord) -> Found:
        def step(
            so_far: tuple[bool, float, float | None], now: Sample, before: Sample
        ) -> tuple[bool, float, float | None]:
            """Keep whether it has driven, since when it stands still, and when it went on."""
            has_driven, since, went_on = so_far
            if not any(now.command) and not now.moved(before):
                return so_far
            if has_driven and went_on is None and before.time - since > seconds:
                went_on = now.time
            return has_driven or now.moved(before), now.time, went_on

        nothing: tuple[bool, float, float | None] = (False, 0.0, None)
        went_on = run.fold(step, nothing, ("stops once", seconds))[2]
        if went_on is None:
            return Found(1, "it did not drive on after a stop")
        return Found(0, f"it had stopped, and drove on after {went_on:.1f} s")

    return Criterion("stops only once", judge, "always")


def drives_smoothly(step: float) -> Criterion:
    """Require that the commanded speed never changes by more than this from a tick to the next, in m/s."""

    def judge(run: RunRecord) -> Found:
        def largest(so_far: tuple[float, float], now: Sample, before: Sample) -> tuple[float, float]:
            change = round(abs(now.command[0] - before.command[0]), 6)
            return so_far if change <= so_far[0] else (change, now.time)

        change, time = run.fold(largest, (0.0, 0.0), "drives smoothly")
        if change <= step + 1e-6:
            return Found(1, f"its speed changed by {change * 100:.0f} cm/s at most")
        return Found(0, f"its speed changed by {change * 100:.0f} cm/s after {time:.1f} s")

    return Criterion(f"changes its speed by at most {step * 100:g} cm/s per tick", judge, "always")


def within(seconds: float, criterion: Criterion) -> Criterion:
    """Require that a criterion is met within this time from the start."""

    def judge(run: RunRecord) -> Found:
        share, reason = criterion.judge(run)
        if run.seconds <= seconds + 1e-6:
            return Found(share, reason)
        return Found(min(share, 0.99), f"not within {seconds:g} s: {reason}")

    return Criterion(f"{criterion.sentence}, within {seconds:g} s", judge, "once")


def not_carried() -> Criterion:
    """Require that the robot comes from place to place by driving; holds in every challenge."""

    def judge(run: RunRecord) -> Found:
        jump = run.fold(_jump, None)
        if jump is None:
            return Found(1, "it drove by itself")
        return Found(0, f"it was put down elsewhere after {jump:.1f} s")

    return Criterion("is not carried", judge, "always")


def times_of(verb: str, count: int) -> str:
    """Return what happened, and how often, in words."""
    if not count:
        return f"never {verb}"
    return f"{verb} {({1: 'once', 2: 'twice'}).get(count, f'{count} times')}"


def backed(count: int, now: Sample, before: Sample) -> int:
    """Count how often the robot begins to drive backward; a step of :meth:`RunRecord.fold`."""
    return count + (now.command[0] < 0 <= before.command[0])


def _straight(so_far: float, now: Sample, before: Sample) -> float:
    way = now.distance(before)
    return so_far + way if abs(angle_between(before, now)) <= _BEND * way else so_far


def _jump(found: float | None, now: Sample, before: Sample) -> float | None:
    if found is not None or now.distance(before) <= _FASTEST * (now.time - before.time) + _SLACK:
        return found
    return now.time

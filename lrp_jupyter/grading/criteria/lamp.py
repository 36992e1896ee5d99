"""Criteria about the robot's lamp."""

from __future__ import annotations

from collections.abc import Callable

from lrp_jupyter.grading.criteria.criterion import Criterion, Found
from lrp_jupyter.grading.run_record import RunRecord, Sample

_Lit = tuple[Sample | None, float, bool]
"""When the lamp was wrong for too long, for how long it is, and whether it has been right in this phase."""


def lit_while(what: str, condition: Callable[[Sample], object], seconds: float = 0.3) -> Criterion:
    """Require that the lamp is lit while a condition of the robot holds, and dark while it does not.

    Parameters
    ----------
    what : str
        The condition in words, such as "drives backward".
    condition : callable
        Takes a :class:`~lrp_jupyter.grading.run_record.Sample`.
    seconds : float
        How long the lamp may be wrong altogether while the condition holds once, and then does not. It has
        to be right in the end, however short that is.
    """

    def judge(run: RunRecord) -> Found:
        def step(so_far: _Lit, now: Sample, before: Sample) -> _Lit:
            first, wrong, right = so_far
            is_wanted, was_wanted = bool(condition(now)), bool(condition(before))
            if is_wanted != was_wanted:
                first = first or (None if right else before)
                wrong, right = 0.0, False
            if now.lamp == is_wanted:
                return first, wrong, True
            wrong += now.time - before.time
            return first or (now if wrong > seconds + 1e-6 else None), wrong, right

        nothing: _Lit = (None, 0.0, True)
        found, _, _ = run.fold(step, nothing, ("lit while", what))
        if found is None:
            return Found(1, "it was never wrong")
        lamp = "lit" if found.lamp else "dark"
        return Found(0, f"after {found.time:.1f} s it was {lamp} when it should not have been")

    return Criterion(f"lights its lamp while it {what}, and only then", judge, "always")


def blinks(seconds: float, slack: float = 0.25) -> Criterion:
    """Require that the lamp is lit and dark in turn, each for this time.

    Parameters
    ----------
    seconds : float
    slack : float
        How much longer or shorter a phase may be, in seconds.
    """

    def judge(run: RunRecord) -> Found:
        def phases(so_far: tuple[float, float, int], now: Sample, before: Sample) -> tuple[float, float, int]:
            """Keep the phase that is furthest off, the beginning of this one, and how many there were."""
            worst, since, count = so_far
            if now.lamp == before.lamp:
                return so_far
            length = now.time - since
            is_worse = count and abs(length - seconds) > abs(worst - seconds)
            return (length if is_worse else worst), now.time, count + 1

        worst, since, count = run.fold(phases, (seconds, 0.0, 0), "blinks")
        present = run.seconds - since
        worst = present if present > max(worst, seconds + slack) else worst
        if abs(worst - seconds) <= slack + 1e-6:
            return Found(1, f"it was switched {count} times")
        return Found(0, f"it once took {worst:.1f} s to switch")

    sentence = f"blinks: its lamp is lit for {seconds:g} s, dark for {seconds:g} s, and so on"
    return Criterion(sentence, judge, "always")

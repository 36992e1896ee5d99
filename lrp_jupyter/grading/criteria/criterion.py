"""What a criterion is, what it finds in a run, and the verdict on it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, NamedTuple

from lrp_jupyter.grading.run_record import RunRecord

When = Literal["once", "always", "at the end"]
State = Literal["open", "so far", "met", "failed"]


class Found(NamedTuple):
    """What a criterion finds in a run: how much of it is met (0 … 1), and why.

    A partial result is what partial credit is given for.
    """

    share: float
    reason: str


class Verdict(NamedTuple):
    """The result of one criterion for one run.

    Parameters
    ----------
    sentence : str
    passed : bool
    reason : str
        With the measured figure.
    share : float
        How much of it is met, 0 to 1.
    state : {"open", "so far", "met", "failed"}
        During the run, a criterion that is not met yet is open, and one that is met but can still be broken
        is met so far. One that is open after the end was never decided: another criterion was broken first.
    decided : float or None
        When it was met or broken for good, in seconds of the run; None if only the end decides.
    """

    sentence: str
    passed: bool
    reason: str
    share: float = 0.0
    state: State = "open"
    decided: float | None = None

    def __str__(self) -> str:
        mark = "✓" if self.passed else "○" if self.state == "open" else "✗"
        return f"{mark} {self.sentence}: {self.reason}"


class Criterion(NamedTuple):
    """A sentence ("reaches `far`"), and the function that judges a run by it.

    Parameters
    ----------
    sentence : str
    judge : callable
        Takes a :class:`~lrp_jupyter.grading.run_record.RunRecord` and returns whether the criterion is met
        (or how much of it, 0 to 1), and the reason. It is asked after every tick.
    when : {"at the end", "once", "always"}
        Whether it counts at the end only, is met for good when it was met once, or is broken for good when
        it was broken once; a run ends there.
    needs_motion : bool
        Whether a robot that never moves cannot meet it.

    Examples
    --------
    >>> short = Criterion("drives 3 m at most", lambda run: (run.driven < 3, f"{run.driven:.1f} m"), "always")
    """

    sentence: str
    judge: Callable[[RunRecord], tuple[float, str]]
    when: When = "at the end"
    needs_motion: bool = True

    def missing(self, run: RunRecord) -> str | None:
        """Return why a run does not meet it; None if it does."""
        share, reason = self.judge(run)
        return None if share >= 1 else reason

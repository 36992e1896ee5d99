"""What happens in a run, one thing after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from lrp_jupyter.grading.record import RunRecord, Sample

__all__ = ["in_order"]


def in_order(run: RunRecord, things: Sequence[Callable[[Sample], bool]], key: object) -> tuple[float, ...]:
    """Return when several things happened, one after the other, up to the first that did not.

    Parameters
    ----------
    run : RunRecord
    things : sequence of callable
        Each says whether a sample shows it.
    key : object
        Under which the result is remembered.

    Returns
    -------
    tuple of float
        Seconds of the run.
    """

    def step(done: tuple[float, ...], now: Sample, _: Sample) -> tuple[float, ...]:
        is_later = not done or done[-1] < now.time
        return (*done, now.time) if len(done) < len(things) and is_later and things[len(done)](now) else done

    return run.fold(step, (), key)

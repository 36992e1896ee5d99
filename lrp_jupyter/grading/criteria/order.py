"""What happens in a run, one thing after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from lrp_jupyter.grading.record import RunRecord, Sample


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


def reason_of(done: Sequence[float], names: Sequence[str], verb: str) -> str:
    """Return what happened of several things in their order: the last one, and what did not come after it.

    Parameters
    ----------
    done : sequence of float
        When they happened.
    names : sequence of str
    verb : str
        Its past tense with what follows, such as ``"came to"``.
    """
    if not done:
        return f"it never {verb} {names[0]}"
    last = f"it {verb} {names[len(done) - 1]} after {done[-1]:.1f} s"
    if len(done) == len(names):
        return last
    return f"{last}, but not {verb.rpartition(' ')[2]} {names[len(done)]} after that"

"""What happens in a run, one thing after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from lrp_jupyter.grading.run_record import RunRecord, Sample


def in_order(run: RunRecord, things: Sequence[Callable[[Sample], bool]], key: object) -> tuple[float, ...]:
    """Return at which seconds things happened, one after the other, up to the first that did not.

    `things`: each says whether a sample shows it.
    `key`: under which the result is remembered.
    """

    def step(done: tuple[float, ...], now: Sample, _: Sample) -> tuple[float, ...]:
        is_later = not done or done[-1] < now.time
        return (*done, now.time) if len(done) < len(things) and is_later and things[len(done)](now) else done

    return run.fold(step, (), key)


def longest(run: RunRecord, holds: Callable[[Sample, Sample], object], key: object) -> float:
    """Return how many seconds something held at most, which is asked of a sample and the one before it."""

    def step(so_far: tuple[float, float], now: Sample, before: Sample) -> tuple[float, float]:
        most, since = so_far
        since = since if holds(now, before) else now.time
        return max(most, now.time - since), since

    return run.fold(step, (0.0, 0.0), key)[0]


def reason_of(done: Sequence[float], names: Sequence[str], verb: str) -> str:
    """Say which of several things happened last, and which did not come after it.

    `done`: when they happened.
    `verb`: its past tense with what follows, such as ``"touched the"``.
    """
    if not done:
        return f"it never {verb} {names[0]}"
    last = f"it {verb} {names[len(done) - 1]} after {done[-1]:.1f} s"
    if len(done) == len(names):
        return last
    return f"{last}, but never {verb} {names[len(done)]} after that"

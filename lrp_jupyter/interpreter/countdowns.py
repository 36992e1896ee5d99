"""Countdowns: the transitions that wait for a time now, since when, and for how long.

Paper: §3.1 (timeouts).
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from lrp_jupyter.language.program import Name, Path, Program
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.triggers import Delay


class Countdown(NamedTuple):
    """A transition that waits for a time."""

    since: float
    """When the time began, in seconds of the run."""
    delay: float
    """How long it is, in milliseconds."""


def countdowns(
    program: Program,
    path: Path,
    state: Path,
    entered: float,
    holding: Mapping[str, float],
    value: Callable[[str], object],
) -> Iterator[tuple[Path, Countdown]]:
    """Yield the transitions of one machine that wait for a time, by its path as spawned and their ids.

    A delay that a block computes is not known without running that.

    `path`: the machine's, as spawned. `state`: the active one, by path of definition, `entered` at that time.
    `holding`: since when triggers hold, by id. `value`: returns the value of a variable that it sees.
    """
    names = resolve(program)
    for element, noun, *_ in names.arrows[names.by_path[state[:-1]]]:
        name = element.path[-1]
        delay = noun.trigger if isinstance(noun.trigger, Delay) else noun.hold
        since = entered if delay is noun.trigger else holding.get(name)
        if delay is None or since is None or not noun.leaves(state[-1]):
            continue
        amount = value(delay.amount) if isinstance(delay.amount, Name) else delay.amount
        if isinstance(amount, int | float) and not isinstance(amount, bool) and amount > 0:
            yield (*path, name), Countdown(since, float(amount) if amount <= sys.float_info.max else math.inf)

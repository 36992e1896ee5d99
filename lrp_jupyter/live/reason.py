"""Reasons: answers to *why* and *why not*, as values first and as sentences second."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Reason"]


@dataclass(frozen=True, slots=True)
class Reason:
    """Why something happened in a tick, or did not; ``str()`` is the answer in a sentence or two.

    Parameters
    ----------
    code : str
        What kind of reason it is; stable. Of a transition: ``fired``, ``source-inactive``,
        ``machine-not-running``, ``earlier-fired``, ``outer-fired``, ``exit-took-parent``,
        ``condition-false``, ``not-boolean``, ``raised``, ``no-data``, ``delay-not-over``, ``unknown-event``,
        ``unknown-destination``, ``paused``, ``not-in-program``. Of a state that is active: ``fired``,
        ``spawned``, ``forced``, ``restarted``. Of a robot command: ``commanded``, ``limited``,
        ``disarmed``, ``watchdog``, ``stopped``, ``never``.
    tick : int
        The tick that the answer is about; the first is 1.
    time : float
        Seconds of the run.
    line : int
        The line of the program to look at first, from 1; 0 if there is none.
    facts : mapping
        What the answer is made of, as plain data; which ones depends on the code. ``lines``: every line that
        the answer mentions. ``values``: the values of the parts of a condition, by their text. ``decides``:
        the part that decides. ``last_true``: the tick in which a condition was last true, or None.

    Examples
    --------
    >>> from lrp_jupyter import Session
    >>> text = "(var n := [3]) (machine m (state a) (state b) (on [n > 4] a -> b go)) (spawn m a)"
    >>> with Session(text) as session:
    ...     session.run(1)
    ...     print(session.why_not("go"))
    True
    `go` (line 1) did not fire at 0.9 s: `n > 4` was False, since `n` was 3. It was never true before.
    """

    code: str
    tick: int
    time: float
    line: int
    sentence: str = field(repr=False)
    facts: Mapping[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        return self.sentence

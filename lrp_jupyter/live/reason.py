"""Reasons: answers to *why* and *why not*, as values first and as sentences second."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from lrp_jupyter.codes import CODES
from lrp_jupyter.interpreter.tick_reasons import ReasonCode

__all__ = ["EXPLANATIONS", "CommandCode", "Reason", "StateCode"]

StateCode = Literal["fired", "spawned", "forced", "restarted", "never"]
CommandCode = Literal["commanded", "limited", "disarmed", "watchdog", "stopped", "never"]


class _Meanings(Mapping[str, str]):
    """The meanings of the codes of reasons about one kind of thing; each text is read on demand."""

    def __init__(self, asked: str, codes: object) -> None:
        self._asked, self._codes = asked, get_args(codes)

    def __getitem__(self, code: str) -> str:
        if code not in self._codes:
            raise KeyError(code)
        return CODES[f"{self._asked}-{code}"].explanation

    def __iter__(self) -> Iterator[str]:
        return iter(self._codes)

    def __len__(self) -> int:
        return len(self._codes)


EXPLANATIONS: Mapping[str, Mapping[str, str]] = {
    asked: _Meanings(asked, codes)
    for asked, codes in (("transition", ReasonCode), ("state", StateCode), ("command", CommandCode))
}
"""Every code of a reason and its meaning, by what was asked about."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Why something happened in a tick, or did not; ``str()`` is the answer in a sentence or two.

    Parameters
    ----------
    code : str
        What kind of reason it is: stable, and explained in :data:`EXPLANATIONS` and by ``lrp explain``.
    tick : int
        The tick that the answer is about; the first is 1.
    time : float
        Seconds of the run.
    line : int
        The line of the program to look at first, from 1; 0 if there is none.
    facts : mapping
        The facts on which the answer is based, as plain data; which ones depends on the code. ``lines``:
        every line that the answer mentions. ``values``: the values of the parts of a condition, by their
        text. ``decides``: the part that decides, and ``decided``: its value, as text. ``last_true``: the tick
        in which the whole condition was last true; None if it never was. ``false_since``: instead, the first
        tick since which it is known not to have been true.

    Examples
    --------
    >>> from lrp_jupyter import Session
    >>> text = "(var n := [3]) (machine m (state a) (state b) (on [n > 4] a -> b go)) (spawn m a)"
    >>> with Session(text) as session:
    ...     session.run(1)
    ...     print(session.why_not("go"))
    True
    `go` (line 1) did not fire at 0.9 s: `n > 4` was False (`n` was 3). It was never true before.
    """

    code: ReasonCode | StateCode | CommandCode
    tick: int
    time: float
    line: int
    sentence: str = field(repr=False)
    facts: Mapping[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        return self.sentence

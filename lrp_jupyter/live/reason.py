"""Reasons: answers to *why* and *why not*, as values first and as sentences second."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["EXPLANATIONS", "Reason"]

EXPLANATIONS: Mapping[str, Mapping[str, str]] = {
    "transition": {
        "fired": "It fired in this tick.",
        "source-inactive": "The active state of its machine is not one that it leaves.",
        "machine-not-running": "Its machine was not running when the tick began.",
        "earlier-fired": "An earlier transition of the same machine was enabled, too, and fired first.",
        "outer-fired": "A transition of an outer machine fired first and ended its machine.",
        "exit-took-parent": "The `exit` of a machine beside its own fired first and ended both.",
        "condition-false": "It was tested, and its condition was False.",
        "not-boolean": "Its condition was neither True nor False. This is an issue.",
        "raised": "Its condition or delay raised an exception, or the delay is not a number. "
        "This is an issue.",
        "no-data": "Its condition needs a reading that had not arrived yet.",
        "delay-not-over": "Its state had not been active for long enough.",
        "unknown-event": "Its event is not defined. This is an issue.",
        "unknown-destination": "It was enabled, but its destination is not defined. This is an issue.",
        "paused": "The session is paused, so nothing is tested now.",
        "not-in-program": "The program of that tick had no such transition.",
    },
    "state": {
        "fired": "A transition entered it.",
        "spawned": "Its machine was spawned in it: at the start, or when an outer state was entered.",
        "forced": "A person forced it, by a transition or a teleport.",
        "restarted": "The program restarted, by a reset or an edit of an active state.",
        "never": "It has not been entered since the recording begins.",
    },
    "command": {
        "commanded": "A block gave the command, and nothing has changed it.",
        "limited": "A value of the command was beyond the limit of the robot and was reduced.",
        "disarmed": "The robot is disarmed, so the command was not sent.",
        "watchdog": "The robot was stopped because no further command followed in time.",
        "stopped": "The robot was stopped after the command: by a pause, a restart or a person.",
        "never": "The command has not been given.",
    },
}
"""Every code of a reason and its meaning, by what was asked about."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Why something happened in a tick, or did not; ``str()`` is the answer in a sentence or two.

    Parameters
    ----------
    code : str
        What kind of reason it is: stable, and explained in :data:`EXPLANATIONS`.
    tick : int
        The tick that the answer is about; the first is 1.
    time : float
        Seconds of the run.
    line : int
        The line of the program to look at first, from 1; 0 if there is none.
    facts : mapping
        What the answer is made of, as plain data; which ones depends on the code. ``lines``: every line that
        the answer mentions. ``values``: the values of the parts of a condition, by their text. ``decides``:
        the part that decides, and ``decided``: its value, as text. ``last_true``: the tick in which the
        whole condition was last true; None if it never was. ``false_since``: instead, the tick from which on
        it was not, as far as it is known.

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

    code: str
    tick: int
    time: float
    line: int
    sentence: str = field(repr=False)
    facts: Mapping[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        return self.sentence

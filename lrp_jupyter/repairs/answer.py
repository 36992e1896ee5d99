"""The answer of a search for the smallest change: what helps, and what does not, in sentences."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from lrp_jupyter.errors import Edit
from lrp_jupyter.live.why.wording import listed

_SHOWN = 3  # changes in the answer
_NAMED = 6  # places at which no change helps


@dataclass(frozen=True)
class Repair:
    """A change that makes a program pass more runs; `str` gives a sentence about it.

    Parameters
    ----------
    phrase : str
        What the change is: ```lightlim` 121 instead of 128 (line 7)``.
    line : int
        The first line that it changes.
    changes : tuple of Edit
        The changes of the text.
    passed, runs, before : int
        How many of the runs pass with the change, how many there are, and how many passed without it.
    text : str
        The whole program after the change.
    """

    phrase: str
    line: int
    changes: tuple[Edit, ...]
    passed: int
    runs: int
    before: int
    text: str

    @property
    def sentence(self) -> str:
        """What the change is, and in how many runs the program passes with it."""
        return f"{self.phrase} passes in {self.passed} of {self.runs} runs (now {self.before})."

    def __str__(self) -> str:
        return self.sentence


@dataclass(frozen=True)
class Repairs:
    """The result of :func:`repair`; true if a change was found. ``print(result)`` explains it.

    Parameters
    ----------
    repairs : tuple of Repair
        The best one first: the one that passes the most runs, and of several the smallest.
    passed, runs : int
        How many runs the program passes as it is, and how many there are.
    unhelpful : tuple of str
        The numbers of which no other value helps.
    tried : mapping of str to int
        How many places were tried, by the kind of change in words.
    made : int
        How many runs were made for this.
    complete : bool
        Whether everything was tried before the time was over.
    """

    repairs: tuple[Repair, ...]
    passed: int
    runs: int
    unhelpful: tuple[str, ...]
    tried: dict[str, int]
    made: int
    complete: bool

    def __bool__(self) -> bool:
        return bool(self.repairs)

    @property
    def first_sentence(self) -> str:
        """The best change, or that there is none."""
        return next(self._sentences())

    @property
    def shown(self) -> tuple[Repair, ...]:
        """The changes that the answer names."""
        return self.repairs[:_SHOWN]

    @property
    def remarks(self) -> str:
        """What the answer says beside these changes: what does not help, and what was tried."""
        return " ".join(self._remarks())

    def __str__(self) -> str:
        return " ".join(self._sentences())

    def _sentences(self) -> Iterator[str]:
        for place, each in enumerate(self.shown):
            yield f"{each.phrase} also passes in {each.passed} of them." if place else each.sentence
        yield from self._remarks()

    def _remarks(self) -> Iterator[str]:
        if self.passed == self.runs:
            yield f"The program passes as it is ({self.passed} of {self.runs} runs)."
            return
        if not (self.complete or self.tried):
            yield "The search ended before any change had been tried."
            return
        if not self.repairs:
            now = f"(now {self.passed} of {self.runs} runs)"
            yield f"No small change was found that makes the program pass {now}."
            kinds = listed([*self.tried], "and")
            yield f"Tried in {self.made} runs: {kinds}." if kinds else "There was nothing to try."
        elif self.unhelpful:
            yield f"Changing {listed([*self.unhelpful[:_NAMED]], 'or')} did not help."
        if not self.complete:
            yield "The search ended before everything had been tried."

"""Texts that the user may want instead of the present one: one at a time is asked about.

Until the user has chosen, such a text neither runs nor is overwritten in the files that contain it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from lrp_jupyter.widgets.protocol import ConflictView


@dataclass(frozen=True)
class Conflict:
    """A text that the user may want instead of the present one.

    `source`: where it comes from; a key of `_QUESTIONS`.
    `endings`: the kept files that are not overwritten until the user has chosen.
    `file`: the file that contains it, as a message shows it, if that was changed outside the lab.
    """

    source: str
    text: str
    endings: tuple[str, ...] = ()
    file: str = ""


_QUESTIONS = {
    "cell": (
        "The {given_in} and the lab have both changed `{name}`. Which text should be kept?",
        "Use the {given_in}'s text",
        "Keep the lab's text",
    ),
    "lab": (
        "The lab's last text of `{name}` differs from the {given_in}'s, which runs now. "
        "Which text should be kept?",
        "Use the lab's text",
        "Keep the {given_in}'s text",
    ),
    "view": (
        "The kernel ended before all that was typed into `{name}` was kept. Which text should be kept?",
        "Use the typed text",
        "Keep the present text",
    ),
    "stranger": (
        "The folder contains a text of `{name}` that you have not written here. It does not run. "
        "Read it before you use it.",
        "Use the folder's text",
        "Keep the present text",
    ),
    "file": (
        "`{file}` was changed outside this lab. Which text should be kept?",
        "Use the file's text",
        "Keep the lab's text",
    ),
}
"""By source of a conflict: the question and the labels of its two answers."""


class Conflicts:
    """Those that wait, in their order.

    `given_in`: where the text is that the program is opened with, in a word: a cell, or a link.
    """

    def __init__(self, given_in: str = "cell") -> None:
        self.number = 0
        """What distinguishes the one that is asked about from earlier ones."""
        self._given_in = given_in
        self._waiting: list[Conflict] = []

    def __iter__(self) -> Iterator[Conflict]:
        return iter(list(self._waiting))

    def __len__(self) -> int:
        return len(self._waiting)

    @property
    def first(self) -> Conflict | None:
        """The one that is asked about."""
        return self._waiting[0] if self._waiting else None

    @property
    def endings(self) -> set[str]:
        """The files that are not overwritten."""
        return {ending for each in self._waiting for ending in each.endings}

    def of(self, source: str) -> list[Conflict]:
        """Return those from a source."""
        return [each for each in self._waiting if each.source == source]

    def add(self, conflict: Conflict) -> None:
        """Ask about it when those before it have ended."""
        self._waiting.append(conflict)
        self.number += len(self._waiting) == 1

    def remove(self, conflict: Conflict) -> None:
        """Ask about it no longer."""
        self.number += self.first is conflict
        self._waiting.remove(conflict)

    def holding(self, ending: str) -> list[Conflict]:
        """Return those whose text a file contains."""
        return [each for each in self._waiting if ending in each.endings]

    def release(self, ending: str) -> None:
        """Let a file be overwritten."""
        self._waiting = [
            replace(each, endings=tuple(other for other in each.endings if other != ending))
            for each in self._waiting
        ]

    def question(self, name: str) -> ConflictView | None:
        """Return what the user of a program of this name is asked."""
        if self.first is None:
            return None
        sentence, use, keep = (
            text.format(name=name, file=self.first.file, given_in=self._given_in)
            for text in _QUESTIONS[self.first.source]
        )
        return {
            "number": self.number,
            "text": self.first.text,
            "sentence": sentence,
            "use": use,
            "keep": keep,
        }

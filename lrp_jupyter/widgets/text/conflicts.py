"""Texts that the user may want instead of the present one; the user is asked about one at a time.

Until the user has chosen, such a text does not run, and the file of the program is not overwritten if it may
contain it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import count

from lrp_jupyter.widgets.wire.protocol import ConflictView

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


@dataclass(frozen=True, eq=False)
class Conflict:
    """A text that the user may want instead of the present one."""

    source: str  # a key of `_QUESTIONS`
    text: str
    file: str = ""  # that contains it, as a message shows it, if it was changed outside the lab
    number: int = field(default_factory=count(1).__next__)  # distinguishes it from all others

    def question(self, name: str, given_in: str) -> ConflictView:
        """Return the question to the user about a program of this name, `given_in` a cell or a link."""
        sentence, use, keep = (
            text.format(name=name, file=self.file, given_in=given_in) for text in _QUESTIONS[self.source]
        )
        return {"number": self.number, "text": self.text, "sentence": sentence, "use": use, "keep": keep}

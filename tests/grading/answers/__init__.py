"""Answers to the challenges: a file for each, with programs that pass, that cheat, and that are wrong.

A line that begins with ``;;;`` begins a program: ``;;; solution``, ``;;; cheat: how`` (it has to fail), or
``;;; wrong: words`` (it has to fail, with a hint that has these words). A cheat or a wrong answer can be a
change of the solution: each line ``- text`` is replaced by the line ``+ text`` below it, or removed.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

__all__ = ["ANSWERS", "Answer"]


class Answer(NamedTuple):
    """A program for a challenge.

    Attributes
    ----------
    challenge : str
    kind : str
        ``"solution"``, ``"cheat"`` or ``"wrong"``.
    about : str
        How it cheats, or words of the hint that it has to get.
    text : str
    """

    challenge: str
    kind: str
    about: str
    text: str

    @property
    def id(self) -> str:
        """A name for the test."""
        return f"{self.challenge}: {self.about or self.kind}"


def _changed(solution: str, lines: list[str]) -> str:
    for index, line in enumerate(lines):
        if not line.startswith("- "):
            continue
        old = line.removeprefix("- ")
        following = lines[index + 1] if index + 1 < len(lines) else ""
        assert old in solution, f"the solution has no {old!r}"
        solution = solution.replace(old, following.removeprefix("+ ") if following.startswith("+ ") else "")
    return solution


def _read(path: Path) -> list[Answer]:
    answers: list[Answer] = []
    header, *sections = path.read_text(encoding="utf-8").split(";;; ")
    name = header.strip().removeprefix("; challenge: ")
    for section in sections:
        title, _, body = section.partition("\n")
        kind, _, about = title.partition(": ")
        lines = body.strip().splitlines()
        text = _changed(answers[0].text, lines) if body.lstrip().startswith("- ") else body
        answers.append(Answer(name, kind, about, text))
    return answers


ANSWERS = [answer for path in sorted(Path(__file__).parent.glob("*.lrp")) for answer in _read(path)]

"""Answers to the challenges: a file for each, with programs that pass, that cheat, and that are wrong.

A line that begins with ``;;;`` begins a program: ``;;; solution``, ``;;; cheat: how`` (it has to fail), or
``;;; wrong: words`` (it has to fail, with a hint that has these words). A cheat or a wrong answer can be a
change of the solution: each line ``- text`` is replaced by the line ``+ text`` below it, or removed.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

__all__ = ["ANSWERS", "Answer", "of_series"]

SOLUTIONS = Path(__file__).parents[3] / "notebooks" / "teachers" / "solutions"


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

    def check_hint(self, hints: tuple[str, ...]) -> None:
        """Assert that the first hint has its words, or the first one that comes from the run itself."""
        seen = [hint for hint in hints if not _NEVER.search(hint)]
        assert any(self.about in hint for hint in (*hints[:1], *seen[:1])), "\n".join(hints)


_NEVER = re.compile(r"^Line \d+: .* (never (enters|fires|tested|occurs)|is never spawned)")


def _changed(solution: str, lines: list[str]) -> str:
    for index, line in enumerate(lines):
        if not line.startswith("- "):
            continue
        old = line.removeprefix("- ")
        following = lines[index + 1] if index + 1 < len(lines) else ""
        assert old in solution, f"the solution has no {old!r}"
        solution = solution.replace(old, following.removeprefix("+ ") if following.startswith("+ ") else "")
    return solution


def _read(text: str, solution: str = "") -> list[Answer]:
    answers: list[Answer] = []
    header, *sections = text.split(";;; ")
    name = header.strip().removeprefix("; challenge: ")
    for section in sections:
        title, _, body = section.partition("\n")
        kind, _, about = title.partition(": ")
        lines = body.strip().splitlines()
        is_change = body.lstrip().startswith("- ")
        answers.append(
            Answer(name, kind, about, _changed(solution or answers[0].text, lines) if is_change else body)
        )
    return answers


def of_series() -> list[Answer]:
    """Return the cheats and wrong answers of the exercises and bugs, each file those of a notebook.

    What they change is the teachers' solution.
    """
    answers = []
    for path in sorted((Path(__file__).parent / "exercises").glob("*.lrp")):
        for part in re.split(r"^(?=; challenge: )", path.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]:
            name = part.partition("\n")[0].removeprefix("; challenge: ").replace(" ", "-")
            answers += _read(part, (SOLUTIONS / f"{name}.lrp").read_text(encoding="utf-8"))
    return answers


ANSWERS = [
    answer
    for path in sorted(Path(__file__).parent.glob("*.lrp"))
    for answer in _read(path.read_text(encoding="utf-8"))
]

"""The codes of findings, issues, reasons, notices and exit codes: what each means, and what to do.

Each is a file ``CODE.md`` in this directory: a heading, a line that says what kind of code it is, the
meaning; under *Example* the smallest program that brings it, with what has to be done in Python or in a shell
if running it is not enough; under *What to do* a remedy and, unless there is nothing to repair, the same
program repaired. The documentation has a page made of them.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from textwrap import indent
from typing import cast

from lrp_jupyter.errors import LRPError, Severity, did_you_mean

__all__ = ["CODES", "DOCUMENTATION", "FINDINGS", "Code", "address_of", "explain", "style_of"]

DOCUMENTATION = os.environ.get("LRP_DOCS", "").rstrip("/")
"""Where the documentation is published: the environment variable ``LRP_DOCS``, or an empty text."""

_FENCE = re.compile(r"^```(\w+)\n(.*?)\n```$", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Code:
    """What a code means.

    Parameters
    ----------
    code : str
        Never changes: ``LRP301``, ``transition-condition-false``, ``exit-2``.
    kind : str
        The severity of a finding or an issue, or what else it is the code of, in words.
    title, explanation, remedy : str
        A heading, and a few sentences each; Markdown.
    example, repaired : str
        Two programs: one that brings the code, and the same without it. Empty if there is none.
    script : str
        What has to be done with the example: Python, in which `text` is the example, or a command of a shell.
        Empty if checking or running it is enough.
    """

    code: str
    kind: str
    title: str
    explanation: str
    example: str = ""
    script: str = ""
    remedy: str = ""
    repaired: str = ""

    @property
    def severity(self) -> Severity:
        """The severity of a finding or an issue.

        An error cannot work; a warning works, but probably not as intended; a hint is worth a check.

        Raises
        ------
        ValueError
            It is the code of something else.
        """
        if self.kind not in ("error", "warning", "hint"):
            raise ValueError(f"`{self.code}` is not the code of a finding, so it has no severity.")
        return cast(Severity, self.kind)

    @property
    def address(self) -> str:
        """The address of its explanation in the documentation."""
        return address_of(self.code)

    def __str__(self) -> str:
        """Return the whole explanation as text."""
        parts = [f"{self.code}: {self.title} ({self.kind})", self.explanation]
        if self.example or self.script:
            parts += ["Example", *(indent(each, "    ") for each in (self.example, self.script) if each)]
        parts += ["What to do", self.remedy]
        if self.repaired:
            parts.append(indent(self.repaired, "    "))
        return "\n\n".join([*parts, *([self.address] if DOCUMENTATION else [])])


class _Codes(Mapping[str, Code]):
    """The codes that begin with a prefix; a file is read when its code is needed."""

    def __init__(self, prefix: str = "") -> None:
        self._prefix = prefix

    def __getitem__(self, code: str) -> Code:
        if code not in _names() or not code.startswith(self._prefix):
            raise KeyError(code)
        return _read(code)

    def __iter__(self) -> Iterator[str]:
        return (code for code in _names() if code.startswith(self._prefix))

    def __len__(self) -> int:
        return sum(1 for _ in self)


CODES: Mapping[str, Code] = _Codes()
"""Every code, in alphabetical order."""

FINDINGS: Mapping[str, Code] = _Codes("LRP")
"""The codes of findings and issues."""


def address_of(code: str) -> str:
    """Return the address of the explanation of a code; without :data:`DOCUMENTATION`, its place there."""
    return f"{DOCUMENTATION}/errors.html#{code}".lstrip("/")


def style_of(code: str, style: str) -> str:
    """Return a style of rich with which a terminal makes of a code a link to its explanation."""
    return f"{style} link {address_of(code)}" if DOCUMENTATION else style


def explain(word: str) -> tuple[Code, ...]:
    """Return the codes that a word names, as a whole or without what they begin with (``301``, ``fired``).

    Raises
    ------
    LRPError
        There is none; the message suggests the closest one.
    """
    wanted = word.strip().replace(" ", "-").casefold()
    short = {code: code.partition("-")[2] or code.removeprefix("LRP") for code in _names()}
    found = [code for code in _names() if wanted in (code.casefold(), short[code])]
    if not found:
        words = [each for each in (*short, *short.values()) if not each.isdigit()]
        hint = did_you_mean(word.upper(), FINDINGS) or did_you_mean(wanted, words)
        raise LRPError(f"There is no code `{word}`.{hint} `lrp explain` lists the codes.")
    return tuple(map(_read, found))


@cache
def _names() -> Mapping[str, None]:
    names = (entry.name for entry in files(__name__).iterdir())
    return dict.fromkeys(sorted(name.removesuffix(".md") for name in names if name.endswith(".md")))


@cache
def _read(code: str) -> Code:
    text = files(__name__).joinpath(f"{code}.md").read_text(encoding="utf-8")
    head, _, rest = text.partition("\n## Example\n")
    if not rest:
        head, _, rest = text.partition("\n## What to do\n")
        rest = f"\n## What to do\n{rest}"
    example, _, remedy = rest.partition("\n## What to do\n")
    title, kind, explanation = head.removeprefix("# ").split("\n\n", 2)
    blocks = dict(_FENCE.findall(example))
    return Code(
        code,
        kind.strip("*"),
        title,
        explanation.strip(),
        blocks.get("lrp", ""),
        blocks.get("python") or blocks.get("sh", ""),
        _FENCE.sub("", remedy).strip(),
        dict(_FENCE.findall(remedy)).get("lrp", ""),
    )

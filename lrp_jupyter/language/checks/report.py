"""The reporter, which collects the findings of a check."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from difflib import get_close_matches
from functools import cached_property, lru_cache

from lrp_jupyter.codes import FINDINGS
from lrp_jupyter.language.edits.form_places import Sheet
from lrp_jupyter.language.program import Edit, Finding, Fix, Name, Program, Span

COMPARED = 30_000
"""Names that one check compares to suggest one: 5,000 misspelt ones with 5,000 others would take minutes."""


class Reporter:
    """Collects the findings of one check; `names`: those available in the session's namespace."""

    def __init__(self, program: Program, names: Collection[str]) -> None:
        self.program = program
        self.names = names
        self.findings: list[Finding] = []
        self._compared = 0  # names compared so far in search of the most similar one

    @cached_property
    def sheet(self) -> Sheet:
        """The text with its forms, for edits."""
        return Sheet(self.program.text)

    def add(
        self,
        code: str,
        span: Span,
        message: str,
        fix: Fix | None = None,
        prefix: bool = False,
        creates: Fix | None = None,
    ) -> None:
        """Report a finding of the given code at a range of the text."""
        start, end = self.program.place(span.start), self.program.place(span.end)
        finding = Finding(code, FINDINGS[code].severity, message, *start, *end, fix, prefix, creates)
        self.findings.append(finding)

    def unknown(
        self,
        code: str,
        name: Name,
        problem: str,
        known: Iterable[str],
        remedy: str,
        creates: Fix | None = None,
    ) -> str | None:
        """Report an unknown name, and return the most similar known one, if there is one."""
        names = tuple(map(str, known))
        meant = self.nearest(name, names)
        message = f"{problem}. Did you mean `{meant}`?" if meant else f"{problem}. {remedy}."
        fix = replace(name.span, meant) if meant else None
        self.add(code, name.span, message, fix, any(each.startswith(name) for each in names), creates)
        return meant

    def nearest(self, name: str, known: Iterable[str]) -> str | None:
        """Return the known name most similar to `name`, if one is; none after :data:`COMPARED` names."""
        if self._compared > COMPARED:
            return None
        names = frozenset(map(str, known))
        self._compared += len(names)
        return nearest(str(name), names)

    def line(self, span: Span) -> int:
        """Return the line in which a range begins."""
        return self.program.place(span.start)[0]


def replace(span: Span, text: str, title: str = "") -> Fix:
    """Return the fix that replaces a range by `text`; its title may show more than that."""
    return Fix(title or f"Change to `{text}`", (Edit(span.start, span.end, text),))


@lru_cache(maxsize=500)
def nearest(name: str, known: frozenset[str]) -> str | None:
    """Return the known name most similar to `name`, if one is similar."""
    same = sorted(other for other in known if other.lower() == name.lower())
    swapped = sorted(other for other in known if len(name) > 2 and sorted(other) == sorted(name))
    close = same or swapped or get_close_matches(name, sorted(known), n=1, cutoff=0.7)
    begun = [other for other in known if len(name) > 1 and other.startswith(name)]
    if not (close or begun):  # `drive` for `driving`
        begun = [other for other in known if _have_one_stem(name, other)]
    return next(iter(close or (begun if len(begun) == 1 else [])), None)


def _have_one_stem(name: str, other: str) -> bool:
    """Return whether two words differ only in their endings."""
    common = next((at for at, pair in enumerate(zip(name, other, strict=False)) if pair[0] != pair[1]), 0)
    endings = name[common:] + other[common:]
    return common >= 4 and common >= min(len(name), len(other)) - 1 and endings.isalpha()

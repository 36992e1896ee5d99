"""The certain fixes of a text, applied one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from lrp_jupyter.errors import Finding


def apply_fixes(text: str, check: Callable[[str], Sequence[Finding]]) -> Iterator[tuple[str, Finding]]:
    """Yield the text after each fix, with the finding that it is for; `check` finds what is left."""
    tried = set()  # a fix that leaves the finding is not applied again
    while True:
        found = next((each for each in check(text) if each.fix and _identity(each) not in tried), None)
        if found is None or found.fix is None:
            return
        tried.add(_identity(found))
        text = found.fix.apply(text)
        yield text, found


def _identity(finding: Finding) -> tuple[str, str, int, int]:
    return finding.code, finding.message, finding.line, finding.column

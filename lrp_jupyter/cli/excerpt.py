"""Findings as text: location, message, the line of the source with carets, the fix; and how a run ended."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable

from rich.cells import cell_len
from rich.text import Text

from lrp_jupyter.cli.console import plain_console
from lrp_jupyter.codes import style_of
from lrp_jupyter.errors import Severity
from lrp_jupyter.language.program import Finding, line_starts
from lrp_jupyter.live.running.frame import Frame

COLOURS: dict[Severity, str] = {"error": "bold red", "warning": "bold yellow", "hint": "bold cyan"}
_TAB = 4
_WIDEST = 120  # characters of a line that are shown


def excerpt(text: str, line: int, column: int, end_line: int = 0, end_column: int = 0) -> list[str]:
    """Return one line of a text and, below it, carets from one column to another, both from 1.

    A range of several lines is marked to the end of its first line; without an end, the word there is marked.
    """
    starts = line_starts(text)
    if not 1 <= line <= len(starts):
        return []
    end = starts[line] if line < len(starts) else len(text)
    source = text[starts[line - 1] : end].rstrip("\r\n")
    first = min(max(column - 1, 0), len(source))
    if end_line == line:
        last = end_column - 1
    elif end_line > line:
        last = len(source)
    else:
        last = first
        while last < len(source) and (source[last].isalnum() or source[last] == "_"):
            last += 1
    if len(source) > _WIDEST:  # cut on both sides of the place
        start = max(0, min(first - _WIDEST // 3, len(source) - _WIDEST))
        end = start + _WIDEST
        left, right = "…" if start else "", "…" if end < len(source) else ""
        source = f"{left}{source[start:end]}{right}"
        first, last = (len(left) + min(place, end) - start for place in (first, last))
    before, marked = (_shown(part) for part in (source[:first], source[first : max(last, first)]))
    margin = max(4, len(str(line)))
    carets = " " * cell_len(before) + "^" * max(1, cell_len(marked.rstrip()))
    return [f" {line:>{margin}} | {_shown(source)}".rstrip(), f" {'':>{margin}} | {carets}"]


def _shown(text: str) -> str:
    """Return a line as a terminal shows it, without what would change the terminal."""
    return "".join(" " * _TAB if c == "\t" else c if c.isprintable() else "�" for c in text)


def finding_text(name: str, text: str, finding: Finding) -> Text:
    """Return a finding as text, with the line of the source that it is about."""
    out = Text()
    out.append(f"{name}:{finding.line}:{finding.column}: ", "bold")
    out.append(f"{finding.severity} {finding.code}", style_of(finding.code, COLOURS[finding.severity]))
    out.append(f": {finding.message}\n")
    for row in excerpt(text, finding.line, finding.column, finding.end_line, finding.end_column):
        head, bar, code = row.partition(" | ")
        out.append(head + bar, "dim")
        out.append(code + "\n", COLOURS[finding.severity] if code.strip().strip("^") == "" else "")
    if finding.fix is not None:
        out.append(f"      = fix: {finding.fix.title}\n", "green")
    return out


def print_findings(
    name: str, text: str, findings: Iterable[Finding], show: Callable[[Text], object] | None = None
) -> None:
    """Print the findings about a text, on stderr unless something else shows them."""
    show = show or plain_console(stderr=True).print
    for finding in findings:
        show(finding_text(name, text, finding))


def ran(name: str, frame: Frame) -> str:
    """Return how a run ended: its time, its ticks and what was active."""
    active = ", ".join("/".join(path) for path in frame.active) or "nothing"
    ticks = "1 tick" if frame.tick == 1 else f"{frame.tick} ticks"
    return f"{name}: {frame.time:.1f} s, {ticks}; {active} active"


def summary(findings: Iterable[Finding]) -> str:
    """Return the number of findings in words: ``2 errors, 1 warning``."""
    counts = Counter(finding.severity for finding in findings)
    words = [f"{counts[word]} {word}{'' if counts[word] == 1 else 's'}" for word in COLOURS if counts[word]]
    return ", ".join(words) or "no findings"

"""The events of a run: collected on the interpreter's thread, printed as lines by another thread."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Sequence

from rich.console import Console, RenderableType
from rich.text import Text

from lrp_jupyter.cli.excerpt import excerpt
from lrp_jupyter.codes import style_of
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.interpreter.trace_events import TraceEvent
from lrp_jupyter.language.program import Finding, Path
from lrp_jupyter.live.predicted import finding_of
from lrp_jupyter.live.trace import Trace

SHOWN = frozenset({"entered", "fired", "forced", "restarted", "issue", "paused", "resumed", "ended"})
"""The kinds of events that are printed."""


class EventCollector:
    """An observer that queues events for another thread, which pops them from the left."""

    def __init__(self, until: Callable[[Path], bool] | None = None, traced: bool = False) -> None:
        self.lines: deque[str] = deque()  # of the trace, not written yet
        self.pending: deque[TraceEvent] = deque()  # worth printing, not printed yet
        self.since: dict[Path, float] = {}  # when the active states were entered
        self.reached = threading.Event()  # a state was entered for which `until` returns True
        self._until = until
        self._trace = Trace(self.lines.append) if traced else None

    def __call__(self, event: TraceEvent) -> None:
        """Collect one event."""
        kind, path, _, now, _ = event
        if self._trace is not None:
            self._trace(event)
        if kind == "entered":
            self.since[path] = now
            if self._until is not None and self._until(path):
                self.reached.set()
        if kind in SHOWN:
            self.pending.append(event)


class EventPrinter:
    """Print events as lines of text; `quiet`: issues only, for the trace has the rest."""

    def __init__(self, console: Console, quiet: bool) -> None:
        self._console = console
        self._quiet = quiet
        self._fired: dict[Path, str] = {}
        self.told: tuple[str, Sequence[Finding]] = "", ()
        """A text, and the findings about it that are printed."""

    def print(self, what: RenderableType) -> None:
        """Print something on the console."""
        self._console.print(what)

    def write(self, event: TraceEvent, source: str) -> None:
        """Print one event; `source` is the text of the program."""
        head = f"{event.now:8.1f} s  "
        if isinstance(event.data, Issue):
            text, findings = self.told
            told = finding_of(event.data, findings) if text == source else None
            self.print(Text(head) + _issue(event.data, source, told))
        elif self._quiet:
            return
        elif event.kind == "fired":
            self._fired[event.path[:-1]] = event.data.label  # type: ignore[attr-defined]
        elif event.kind == "entered":
            name = self._fired.pop(event.path[:-1], "->")
            by = "" if "->" in name else f"  ({name})"  # a transition without a name has its arrow as label
            self.print(f"{head}{'/'.join(event.path)}{by}")
        else:
            self.print(f"{head}{event.kind} {event.data or '/'.join(event.path)}".rstrip())


def _issue(issue: Issue, source: str, told: Finding | None) -> Text:
    """Return an issue with its place; of one that a finding has told, only that it has occurred."""
    code = issue.code if told is None else told.code
    rows = "\n".join(excerpt(source, issue.line, issue.column))
    what = f": {issue.message}\n{rows}" if told is None else ", as said above"
    where = f" line {issue.line}{issue.where and f' {issue.where}'}"
    return Text.assemble((f"issue {code}", style_of(code, "bold red")), where, what)

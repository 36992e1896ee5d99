"""The display where there is no terminal: a line for everything that happens."""

from __future__ import annotations

from rich.console import Console, RenderableType
from rich.text import Text

from lrp_jupyter.cli.excerpt import excerpt
from lrp_jupyter.interpreter.events import TraceEvent
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.program import Path

__all__ = ["Lines"]


class Lines:
    """Writes what happens.

    Parameters
    ----------
    console : Console
    quiet : bool
        Only issues: the rest is in a trace.
    """

    def __init__(self, console: Console, quiet: bool) -> None:
        self._console = console
        self._quiet = quiet
        self._fired: dict[Path, str] = {}

    def say(self, what: RenderableType) -> None:
        """Write something."""
        self._console.print(what)

    def tell(self, event: TraceEvent, source: str) -> None:
        """Write what happened; `source` is the text of the program."""
        head = f"{event.now:8.1f} s  "
        if isinstance(event.data, Issue):
            self.say(Text(head) + _issue(event.data, source))
        elif self._quiet:
            return
        elif event.kind == "fired":
            self._fired[event.path[:-1]] = event.path[-1]
        elif event.kind == "entered":
            name = self._fired.pop(event.path[:-1], "->")
            by = "" if "->" in name else f"  ({name})"  # without a name it is called by what it does
            self.say(f"{head}{'/'.join(event.path)}{by}")
        else:
            self.say(f"{head}{event.kind} {event.data or '/'.join(event.path)}".rstrip())


def _issue(issue: Issue, source: str) -> Text:
    rows = "\n".join(excerpt(source, issue.line, issue.column))
    return Text.assemble((f"issue {issue.code}", "bold red"), f" line {issue.line}: {issue.message}\n{rows}")

"""The search for the smallest change that makes a program pass, as a page shows it."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from lrp_jupyter.errors import LRPError, sentence_of
from lrp_jupyter.grading.workers import Halt, HowRun
from lrp_jupyter.live.session import Session
from lrp_jupyter.repairs.answer import Repairs
from lrp_jupyter.repairs.repair import repaired
from lrp_jupyter.runs.kept_runs import KeptRun
from lrp_jupyter.widgets.views.goal import Goal
from lrp_jupyter.widgets.wire.protocol import SearchView

_SEEDS = 5
_SECONDS = 60.0  # of computing
_HOW = HowRun(limit=20, behind=True)


@dataclass(eq=False)
class _OneSearch:
    """One search. `made`, `planned`: runs."""

    text: str
    halt: Halt = field(default_factory=Halt)
    busy: bool = True
    made: int = 0
    planned: int = 0
    found: Repairs | None = None
    error: str = ""


class ShownSearch:
    """The last search for a program: on a thread of its own, with its runs in other processes."""

    def __init__(self) -> None:
        self._search: _OneSearch | None = None
        self._wake: Callable[[], None] = lambda: None

    def attach(self, wake: Callable[[], None]) -> None:
        """Have `wake` called when there is something to show."""
        self._wake = wake

    def view(self, session: Session, text: str, goal: Goal | None) -> SearchView | None:
        """Return what is shown beside a text; None where no changes are offered: they give answers away."""
        if not _is_offered(session, goal):
            return None
        search = self._search or _OneSearch(text, busy=False)
        found = search.found
        return {
            "busy": search.busy,
            "made": search.made,
            "planned": search.planned,
            "answer": "" if found is None else found.remarks,
            "changes": []
            if found is None
            else [{"sentence": each.sentence, "line": each.line} for each in found.shown],
            "stale": search.text != text,
            "error": search.error,
        }

    def begin(self, session: Session, text: str, goal: Goal | None, kept: Sequence[KeptRun]) -> None:
        """Begin a search; an earlier one ends.

        Raises LRPError: none is offered, or there is nothing to judge the program by.
        """
        if not _is_offered(session, goal):
            raise LRPError("No changes are suggested here: they would give the answer away.")
        task = None if goal is None else goal.task
        if task is None and not kept:
            raise LRPError("Keep a run first, and write what you expect of it: a change is judged by that.")
        self.stop()
        search = self._search = _OneSearch(text)
        how = _HOW._replace(namespace=session.namespace)

        def count(made: int, planned: int) -> None:
            search.made, search.planned = made, planned
            self._wake()

        def run() -> None:
            try:
                search.found = repaired(text, task, _SEEDS, how, _SECONDS, count, search.halt, kept)
            except LRPError as error:
                search.error = sentence_of(error)
            except Exception:
                search.error = traceback.format_exc()
            search.busy = False
            self._wake()

        threading.Thread(target=run, name="lrp search", daemon=True).start()
        self._wake()

    def stop(self) -> None:
        """End the search; what it has found so far is its answer."""
        if self._search is not None:
            self._search.halt.set()

    def changed(self, text: str, index: int) -> str:
        """Return the text with a change that was found.

        Raises LRPError: there is no such change any more.
        """
        search = self._search
        if search is None or search.found is None or search.text != text:
            raise LRPError("The program has changed since this search. Search again.")
        return search.found.repairs[index].text


def _is_offered(session: Session, goal: Goal | None) -> bool:
    has_processes = session.driver != "asyncio"
    return has_processes and (goal is None or goal.offers_changes)

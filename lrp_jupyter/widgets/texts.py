"""The texts of a session: the typed, the running, the held and the saved one.

The kernel never types into an editor: it assigns each text a revision and answers with the result. Every text
that is a valid program is saved at once, so that no work is lost.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from dataclasses import dataclass
from pathlib import Path as FilePath
from threading import Lock, RLock
from time import monotonic
from typing import Any

from lrp_jupyter.errors import SessionClosedError
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.diff import diff
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Finding, Path, Program
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.protocol import ConflictView, Difference, FindingView, range_of

__all__ = ["Texts", "Written", "finding_id"]

_KEPT = 50  # texts whose revision is known
_LATE = 0.25  # s after which a text is answered even if it is not applied yet
_SHOWING = 0.1  # s in which an applied program appears in a frame


@dataclass(eq=False)
class Written:
    """A text that arrived, with its result; the fields of an `AnswerMessage`."""

    view: str
    seq: int
    revision: int
    text: str
    noun: Program | None
    findings: list[FindingView]
    answer: Future[Any]
    deadline: float
    is_news: bool = True
    """Whether views that did not type it need the text."""
    applied: bool = False
    reason: str = ""
    pending: Difference | None = None
    done: float | None = None

    @property
    def accepted(self) -> bool:
        """Whether it is a valid program."""
        return self.noun is not None


class Texts:
    """See the head of this module.

    Parameters
    ----------
    folder : path, optional
        Where accepted texts are saved as ``NAME.lrp``; None: nowhere.
    """

    def __init__(self, folder: str | os.PathLike[str] | None = None) -> None:
        self.hold = False
        self.conflict: ConflictView | None = None
        self.waiting: deque[Written] = deque()
        self.text = ""
        self.revision = 0
        self.findings: tuple[Finding, ...] = ()
        self.noun: Program | None = None
        self.folder = None if folder is None else FilePath(folder)
        self._lock = RLock()
        self._saving = Lock()
        self._session: Session
        self._answered = Program()  # the running program, as known to the views
        self._revisions: dict[str, int] = {}
        self._saved: str | None = None
        self._unsaved: str | None = None

    def attach(
        self, session: Session, wake: Callable[[], None], clock: Callable[[], float] = monotonic
    ) -> None:
        """Attach to a session and use its text.

        Parameters
        ----------
        session : Session
        wake : callable
            Called when a text can be answered.
        clock : callable
            Returns the wall time in seconds.
        """
        with self._lock:
            self._session = session
            self._wake = wake
            self._clock = clock
            self.waiting.clear()
            self._number(session.text)
            self._answered = session.program
            self._judge(session.text)
            if self.noun is not None and self.text:
                self._unsaved = self.text

    # -- in ----------------------------------------------------------------------------------------

    def write(self, text: str, view: str = "", seq: int = 0) -> Written:
        """Make a text the editor's, and offer it to the session unless edits are held.

        Parameters
        ----------
        text : str
        view : str
            The view in which it was typed; empty if it came from a cell, a bundled program or a file.
        seq : int
            The number assigned by the view.
        """
        with self._lock:
            answer: Future[Any] = Future()
            try:
                if not self.hold:
                    noun, answer = self._session.offer(text)
                    self.noun, self.findings = noun, self._session.findings
                else:
                    self._judge(text)
                    answer.set_result(None)
            except SessionClosedError as error:  # the text is kept anyway
                self._judge(text)
                answer.set_exception(error)
            self._number(text)
            written = self._written(view, seq, answer, self._clock() + _LATE)
        answer.add_done_callback(lambda _: self._wake())
        return written

    def apply(self) -> None:
        """Apply the held text."""
        with self._lock:
            held, self.hold = self.hold, False
            try:
                written = self.write(self.text)
            finally:
                self.hold = held
            written.is_news = False

    def rename(self, kind: str, path: Path, name: str) -> None:
        """Rename an element and its references. Waits.

        Raises
        ------
        UnknownElementError
            There is no such element.
        ValueError
            The name cannot be used, or the text is not the running program.
        """
        with self._lock:
            if self.text != self._session.program.text:
                raise ValueError(
                    "The text is not the running program, so nothing can be renamed now. Apply it first."
                )
        self._session.rename(kind, path, name)

    def _written(self, view: str, seq: int, answer: Future[Any], deadline: float) -> Written:
        findings = [_finding_view(finding, self.text) for finding in self.findings]
        written = Written(view, seq, self.revision, self.text, self.noun, findings, answer, deadline)
        if self.noun is not None:
            self._unsaved = self.text
        self.waiting.append(written)
        return written

    def _number(self, text: str) -> None:
        self.revision += 1
        self.text = text
        self._revisions.pop(text, None)
        self._revisions[text] = self.revision
        if len(self._revisions) > _KEPT:
            del self._revisions[next(iter(self._revisions))]

    def _judge(self, text: str) -> None:
        """Check a text that is not offered to the session."""
        self.noun, self.findings = scan(text, f"<lrp {self._session.name}>")
        if self.noun is not None:
            self.findings = check(self.noun, self._session.namespace)

    # -- out: the publisher's thread ---------------------------------------------------------------

    @property
    def running_revision(self) -> int:
        """Return the revision of the running text."""
        return self._revisions.get(self._session.program.text, 0)

    def answers(self, now: float) -> list[Written]:
        """Return the texts that can be answered, or must be by now, and changes that came without a text."""
        with self._lock:
            ready = []
            while self.waiting and self._is_decided(self.waiting[0], now):
                ready.append(self.waiting.popleft())
            program = self._session.program
            if not self.waiting and (program is not self._answered or self._came_from_elsewhere()):
                if not ready:
                    ready.append(self._news(program))
                self._answered = program
            for written in ready:
                if self.hold and written.noun is not None and written.text != program.text:
                    written.pending = _difference_view(program, written.noun)
            return ready

    def _is_decided(self, written: Written, now: float) -> bool:
        """Return whether the session has applied or refused a text, and shows it if it is running."""
        answer = written.answer
        if not answer.done():
            if now < written.deadline:
                return False
            frame = self._session.frame
            written.reason = (
                frame.reason or f"The edit is applied as soon as the session is free ({frame.status})."
            )
            return True
        try:
            patch = answer.result()
        except CancelledError:
            written.reason = "A newer text replaced this one."
            return True
        except Exception as error:
            written.reason = str(error)
            return True
        if patch is None:
            written.applied = written.noun is not None and written.text == self._session.program.text
            return True
        written.applied, written.reason = patch.applied, patch.reason or ""
        written.done = now if written.done is None else written.done
        shown = self._session.program is written.noun or len(self.waiting) > 1
        return not patch.applied or shown or now - written.done > _SHOWING

    def _came_from_elsewhere(self) -> bool:
        """Return whether the session's text came from no view: another cell's edit, a rename, a rewind."""
        is_other = not self.hold and self._session.text != self.text
        return is_other and self._session.status != "closed"  # which accepts no text any more

    def _news(self, program: Program) -> Written:
        is_news = self._came_from_elsewhere()
        if is_news:
            self._number(self._session.text)
            self._judge(self.text)
        nothing: Future[Any] = Future()
        nothing.set_result(None)
        written = self._written("", 0, nothing, 0.0)
        self.waiting.remove(written)
        written.is_news, written.applied = is_news, self.text == program.text
        return written

    def everything(self) -> dict[str, Any]:
        """Return the fields of a `SnapshotMessage` that are about texts."""
        with self._lock:
            running = self._session.program
            waits = self.hold and self.noun is not None and self.text != running.text
            return {
                "text": self.text,
                "revision": self.revision,
                "running": running.text,
                "findings": [_finding_view(finding, self.text) for finding in self.findings],
                "pending": _difference_view(running, self.noun) if waits and self.noun is not None else None,
            }

    # -- files -------------------------------------------------------------------------------------

    def kept(self, name: str, ending: str) -> str | None:
        """Return a saved text: the lab's (``.lrp``), or that of the cell it came from (``.cell``)."""
        if self.folder is None:
            return None
        try:
            return (self.folder / f"{name}{ending}").read_bytes().decode()
        except (OSError, UnicodeDecodeError):
            return None

    def keep_cell(self, text: str) -> None:
        """Save the cell's text, to detect later whether it was changed."""
        self._write(text, ".cell")

    def end_conflict(self) -> str | None:
        """Save the cell's text as known; return it, or None if there was no conflict."""
        conflict, self.conflict = self.conflict, None
        if conflict is None:
            return None
        self.keep_cell(conflict["text"])
        return conflict["text"]

    def save(self) -> None:
        """Save the newest accepted text, if it is not saved yet."""
        with self._saving:  # otherwise one thread could move the other's new file away
            text = self._unsaved
            if text is not None and text != self._saved:
                self._write(text, ".lrp")
                self._saved = text

    def _write(self, text: str, ending: str) -> None:
        if self.folder is None:
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        file = self.folder / f"{self._session.name}{ending}"
        fresh = file.with_name(f"{file.name}~")
        fresh.write_bytes(text.encode())
        fresh.replace(file)  # the old file exists until the new one is complete


def finding_id(finding: Finding) -> str:
    """Return the identity of a finding among those of its text."""
    return f"{finding.code} {finding.line}:{finding.column} {finding.message}"


def _finding_view(finding: Finding, text: str) -> FindingView:
    """Return a finding of the checks about a text."""
    fix = finding.fix
    return {
        "id": finding_id(finding),
        "code": finding.code,
        "severity": finding.severity,
        "message": finding.message,
        "range": {
            "line": finding.line,
            "column": finding.column,
            "end_line": finding.end_line,
            "end_column": finding.end_column,
        },
        "fix": None
        if fix is None
        else {
            "title": fix.title,
            "edits": [{"range": range_of(text, e.start, e.end), "text": e.text} for e in fix.edits],
        },
    }


def _difference_view(old: Program, new: Program) -> Difference:
    """Return the changes that an edit would make."""
    changes = diff(old, new)
    return {
        "added": [str(element) for element in changes.added],
        "removed": [str(element) for element in changes.removed],
        "changed": [str(element) for element in changes.changed],
        "moved": [str(element) for element in changes.moved],
    }

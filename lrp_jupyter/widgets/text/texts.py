"""The texts of a session: the typed, the running and the held one.

Views send changes, which are merged in a :class:`~lrp_jupyter.widgets.text.document.Document`; a text from
elsewhere is such a change, too. Each text is judged, offered to the session, and answered with the result.
A text from elsewhere that may be newer, or not the user's, is a conflict: until the user has chosen, it is
neither run nor overwritten.
"""

from __future__ import annotations

import shlex
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import CancelledError, Future
from dataclasses import dataclass, field
from threading import RLock
from time import monotonic, time
from typing import Any

from lrp_jupyter.errors import LRPError, SessionClosedError
from lrp_jupyter.language.edits.rename import rename as renamed
from lrp_jupyter.language.half_typed import Cursor, Judgement
from lrp_jupyter.language.program import Path, Program
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.text.conditions import Conditions
from lrp_jupyter.widgets.text.conflicts import Conflict
from lrp_jupyter.widgets.text.document import Document, Update
from lrp_jupyter.widgets.text.finding_views import difference_view, finding_view
from lrp_jupyter.widgets.text.kept import Version, newest
from lrp_jupyter.widgets.wire.changes import TextChanges, with_line_feeds
from lrp_jupyter.widgets.wire.protocol import (
    CellView,
    ConflictView,
    Difference,
    FindingView,
    HandView,
    UpdateView,
)

Selection = tuple[int, int]
"""The anchor and the head of a selection, in UTF-16 units."""
Rename = tuple[str, Path, str]
"""The kind and the path of an element, and its new name."""

_LATE = 0.25  # s after which a text is answered even if it is not applied yet
_SHOWING = 0.1  # s in which an applied program appears in a frame
_PAUSE = 5.0  # s without typing that make a text a version


@dataclass(eq=False)
class Written:
    """A text that arrived, with its result; the fields of an `AnswerMessage`."""

    view: str
    seq: int
    revision: int
    text: str
    judgement: Judgement
    findings: list[FindingView]
    answer: Future[Any]
    deadline: float
    number: int = 0
    updates: list[UpdateView] = field(default_factory=list)
    applied: bool = False
    reason: str = ""
    running: str | None = None
    pending: Difference | None = None
    done: float | None = None


@dataclass(eq=False)
class _Hand:
    """A view with an editor: the number of its last message, and where the user's cursor is in it."""

    seq: int
    selection: Selection | None = None
    meant: bool = True
    cursors: Sequence[int] = ()  # its others

    def move(self, changes: Iterable[TextChanges], are_own: bool = False) -> None:
        """Keep the selection at its place while the text changes."""
        for each in changes:
            if self.selection is not None:
                anchor, head = self.selection
                self.selection = each.map_place(anchor, are_own), each.map_place(head, are_own)
            self.cursors = [each.map_place(place, are_own) for place in self.cursors]


class Texts:
    """See the module's docstring. `given_in`: where the program is opened from: a cell, a link, a file."""

    def __init__(self, given_in: str = "cell") -> None:
        self._given_in = given_in
        self.conditions = Conditions()
        self.lock = RLock()  # held while they change
        self.session: Session
        self.clock: Callable[[], float]
        self.conflicts: list[Conflict] = []  # the first one is asked about
        self.cell: str | None = None  # the last known text of the cell
        self.saved: str | None = None  # the last text that its user had written to a file, or into a new cell
        self.given = 0  # how often a cell, or a link, has given a text
        self.line = ""  # the first line of a cell with this program, without `%%lrp`
        self.accepted: str | None = None  # the last one that is a valid program
        self.versions: tuple[Version, ...] = ()  # earlier ones, the newest first
        self.waiting: deque[Written] = deque()
        self.document = Document()
        self.judgement = Judgement(None, ())  # what the text means with the cursors where they are
        self.running_revision = 0  # of the running text
        self._wake: Callable[[], None] = lambda: None
        self._answered = Program()  # the running program, as known to the views
        self._reason = ""  # of the last answer
        self._hands: dict[str, _Hand] = {}  # by view
        self._number = 0  # of the last answer
        self._typed = float("-inf")

    def attach(
        self, session: Session, wake: Callable[[], None], clock: Callable[[], float] = monotonic
    ) -> None:
        """Attach to a session and use its text; `wake` is called when a text can be answered."""
        with self.lock:
            is_first = not hasattr(self, "session")
            self.session = session
            self._wake = wake
            self.clock = clock
            self.waiting.clear()
            if is_first:
                self.document = Document(session.text)
            self._continue_with(session.text)
            self.document.told = self.running_revision = self.revision
            self._answered = session.program
            self.judgement = session.judge(self.text)
            if self.judgement.program is not None and self.text:
                self.accepted = self.text

    # -- in ----------------------------------------------------------------------------------------

    def write(self, text: str) -> None:
        """Continue with a text from elsewhere, with which what is typed into a view meanwhile is merged."""
        with self.lock:
            self._leave(text, is_typed=False)
            self._continue_with(text)
            self._offer()

    def follow(self, text: str) -> None:
        """Continue with a text that another program has written to the file of the program."""
        with self.lock:
            self.write(text)
            if self.accepted != text:
                self.accepted = None  # or the last program would replace it there

    def type(
        self,
        view: str,
        seq: int,
        base: int,
        updates: Sequence[TextChanges],
        selection: Selection | None = None,
        meant: bool = True,
        rename: Rename | None = None,
        cursors: Sequence[int] = (),
    ) -> None:
        """Merge what was typed into a view, and offer the text to the session unless edits are held.

        The arguments are the fields of a `TextMessage`; one that has already arrived is ignored. Raises
        ValueError: they are not changes of a text that is still known.
        """
        with self.lock:
            hand = self._hands.get(view)
            if hand is None or seq <= hand.seq:
                return
            hand.seq = seq
            self._adopt()
            running = self.session.program.text
            before = self.text
            merged, others = self.document.merge(view, base, updates)
            self._leave(self.text, is_typed=True, before=before)
            for name, each in self._hands.items():
                each.move(merged, name == view)
            hand.selection, hand.meant, hand.cursors = selection, meant, cursors
            hand.move(others)
            is_rename = rename is not None and before == running and not self.hold
            self._offer(view, seq, rename=rename if is_rename else None)

    def move_cursor(
        self,
        view: str,
        seq: int,
        revision: int,
        selection: Selection | None,
        meant: bool,
        cursors: Sequence[int] = (),
    ) -> None:
        """Move the cursor of a view, or leave its text, or mark the word there as finished.

        The arguments are the fields of a `CursorMessage`; one that is followed by a text is ignored.
        """
        with self.lock:
            hand = self._hands.get(view)
            if hand is None or seq != hand.seq or not self.document.knows(revision):
                return
            hand.selection, hand.meant, hand.cursors = selection, meant, cursors
            hand.move(update.changes for update in self.document.since(revision))
            if self.judgement.half_typed:
                self._offer()
        self._wake()

    def enter(self, view: str, seq: int) -> None:
        """Add a view with an editor. Its texts with numbers up to `seq` no longer count."""
        with self.lock:
            self._hands[view] = _Hand(max(seq, self._hands.get(view, _Hand(0)).seq))

    def leave(self, view: str) -> None:
        """Remove a view, and apply edits that wait for its cursor."""
        with self.lock:
            if self._hands.pop(view, None) is not None and self.judgement.half_typed:
                self._offer()

    @property
    def hold(self) -> bool:
        """Whether texts wait until they are applied."""
        return self.conditions.edits == "hold"

    def set_conditions(self, conditions: Conditions) -> None:
        """Change the conditions; a text that no longer waits is applied."""
        with self.lock:
            was_held, self.conditions = self.hold, conditions
            if was_held and not self.hold:
                self.apply()

    def apply(self) -> None:
        """Apply the held text."""
        with self.lock:
            self._offer(at_once=True)

    def _offer(
        self, view: str = "", seq: int = 0, rename: Rename | None = None, at_once: bool = False
    ) -> None:
        """Offer the text, unless held or half typed, or `at_once`; answer when the session has decided."""
        answer: Future[Any] = Future()
        for conflict in list(self.conflicts):
            if are_alike(conflict.text, self.text):  # the user has typed one of the texts to choose from
                self._end(conflict)
        cursors = [] if at_once else self._cursors()
        try:
            if at_once or not self.hold:
                self.judgement, answer = self._renamed(rename) or self.session.offer(self.text, *cursors)
            else:
                self.judgement = self.session.judge(self.text, *cursors)
                answer.set_result(None)
        except SessionClosedError as error:  # the text is kept anyway
            self.judgement = self.session.judge(self.text)
            answer.set_exception(error)
        self.waiting.append(self._written(view, seq, answer, self.clock() + _LATE))
        answer.add_done_callback(lambda _: self._wake())

    def _renamed(self, rename: Rename | None) -> tuple[Judgement, Future[Any]] | None:
        """Have the session rename an element, if the result is the present text."""
        if rename is not None:
            try:
                if renamed(self.session.program, *rename) == self.text:
                    return self.session.offer_rename(*rename)
            except (LRPError, ValueError):
                pass  # it is an edit like any other
        return None

    def _cursors(self) -> list[Cursor]:
        """Return where the text is being edited."""
        return [
            Cursor(self.document.offset(place), hand.meant)
            for hand in self._hands.values()
            if hand.selection is not None
            for place in (hand.selection[1], *hand.cursors)
        ]

    def _written(self, view: str, seq: int, answer: Future[Any], deadline: float) -> Written:
        if self.judgement.program is not None:
            self.accepted = self.text
        findings = [finding_view(finding, self.text) for finding in self.judgement.findings]
        return Written(view, seq, self.revision, self.text, self.judgement, findings, answer, deadline)

    def _continue_with(self, text: str) -> None:
        """Replace the document's text by one from elsewhere."""
        changes = self.document.replace(text)
        for hand in self._hands.values():
            hand.move(changes)

    def _leave(self, text: str, is_typed: bool, before: str | None = None) -> None:
        """Make the text `before`, or the present one, a version, unless the new one is a step of typing."""
        before = self.text if before is None else before
        now, since = self.clock(), self._typed
        self._typed = now
        was_cut = len(text) < len(before) / 2
        if text != before and (not is_typed or was_cut or now - since >= _PAUSE):
            self.add_version(before)

    def add_version(self, text: str) -> None:
        """Add an earlier text to the versions."""
        with self.lock:
            self.versions = newest([Version(text, time()), *self.versions])

    # -- out: the publisher's thread ---------------------------------------------------------------

    @property
    def text(self) -> str:
        """The text in the editors."""
        return self.document.text

    @property
    def revision(self) -> int:
        """The number of its last update."""
        return self.document.revision

    def hands(self) -> dict[str, HandView]:
        """Return where the users' cursors are, if several views have an editor."""
        with self.lock:
            if len(self._hands) < 2:
                return {}
            revision = self.revision
            return {
                view: {"revision": revision, "selection": hand.selection}
                for view, hand in self._hands.items()
            }

    def answers(self, now: float) -> list[Written]:
        """Return the texts that can or must be answered now, and changes that came without a text."""
        with self.lock:
            ready = []
            while self.waiting and self._is_decided(self.waiting[0], now):
                ready.append(self.waiting.popleft())
            program = self.session.program
            is_new = program is not self._answered or self._came_from_elsewhere()
            if is_new and not ready and not self.waiting:
                ready.append(self._news(program))
            for written in ready:
                told = self.document.told
                since = self.document.since(told)[: max(0, written.revision - told)]
                written.updates = [_update_view(update) for update in since]
                self.document.told = max(told, written.revision)
                self._number = written.number = self._number + 1
                if program.text == written.text:
                    self.running_revision = written.revision
                elif program is not self._answered:
                    self.running_revision, written.running = written.revision, with_line_feeds(program.text)
                written.pending = self._pending(written.text, written.judgement.program, program)
                self._answered, self._reason = program, written.reason
            return ready

    def _is_decided(self, written: Written, now: float) -> bool:
        """Return whether the session has applied or refused a text, and shows it if it is running."""
        answer = written.answer
        if not answer.done():
            if now < written.deadline:
                return False
            frame = self.session.frame
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
            program = written.judgement.program
            written.applied = program is not None and written.text == self.session.program.text
            return True
        if isinstance(patch, str):  # a rename
            written.applied = True
        else:
            written.applied, written.reason = patch.applied, patch.reason or ""
        written.done = now if written.done is None else written.done
        shown = self.session.program.text == written.text or len(self.waiting) > 1
        return not written.applied or shown or now - written.done > _SHOWING

    def _came_from_elsewhere(self) -> bool:
        """Return whether the session's text came from no view: another cell's edit, a rename, a rewind."""
        is_other = not self.hold and self.session.text != self.text
        return is_other and self.session.status != "closed"  # a closed session accepts no text

    def _adopt(self) -> bool:
        """Continue with the session's text, if no view sent it; return whether so."""
        is_news = self._came_from_elsewhere()
        if is_news:
            self._leave(self.session.text, is_typed=False)
            self._continue_with(self.session.text)
        return is_news

    def _news(self, program: Program) -> Written:
        if self._adopt():
            self.judgement = self.session.judge(self.text)
        nothing: Future[Any] = Future()
        nothing.set_result(None)
        written = self._written("", 0, nothing, 0.0)
        written.applied = self.text == program.text
        written.reason = self._reason if self.judgement.half_typed else ""
        return written

    def _pending(self, text: str, program: Program | None, running: Program) -> Difference | None:
        """Return what a held text would change."""
        waits = self.hold and text != running.text
        return difference_view(running, program) if waits and program is not None else None

    def everything(self, view: str, revision: int | None) -> dict[str, Any]:
        """Return what a `SnapshotMessage` says of texts to a view that knows this revision."""
        with self.lock:
            updates = None
            if revision is not None and self.document.knows(revision):
                updates = [_update_view(update) for update in self.document.since(revision)]
            running, judgement = self.session.program, self.judgement
            return {
                "document": self.document.name,
                "number": self._number,
                "seq": self._hands[view].seq if view in self._hands else 0,
                "text": with_line_feeds(self.text),
                "revision": self.revision,
                "updates": updates,
                "running": with_line_feeds(running.text),
                "findings": [finding_view(finding, self.text) for finding in judgement.findings],
                "accepted": judgement.program is not None,
                "half_typed": judgement.half_typed,
                "pending": self._pending(self.text, judgement.program, running),
            }

    # -- conflicts ---------------------------------------------------------------------------------

    @property
    def in_cell(self) -> CellView:
        """The cell that holds the program, as the kernel knows it."""
        with self.lock:
            line = self.line or shlex.quote(self.session.name)
            return {
                "given": self.given,
                "line": f"%%lrp {line}",
                "text": with_line_feeds(self.cell or ""),
                "is_saved": any(are_alike(self.text, saved) for saved in (self.cell, self.saved)),
            }

    @property
    def conflict(self) -> ConflictView | None:
        """The question to the user now."""
        with self.lock:
            first = next(iter(self.conflicts), None)
            return None if first is None else first.question(self.session.name, self._given_in)

    def ask(self, conflict: Conflict) -> None:
        """Ask about a text, unless it is the present one or already in question.

        It replaces an older one from the same source. It is a version at once: no file may contain it then.
        """
        with self.lock:
            if conflict.text in (self.text, *(other.text for other in self.conflicts)):
                return
            self.withdraw(conflict.source)
            self.conflicts.append(conflict)
            self.add_version(conflict.text)
            self._wake()

    def reconcile(self, text: str) -> None:
        """Reconcile the texts of the cell and the lab: the changed one wins; if both changed, ask."""
        with self.lock:
            self.given += 1
            self.withdraw("cell")
            if not (are_alike(text, self.text) or are_alike(text, self.cell)):
                if self.text.strip() and not are_alike(self.text, self.cell):
                    self.ask(Conflict("cell", text))
                    return
                self.write(text)
            self.cell = text

    def put_into_cell(self, text: str) -> None:
        """Note that a page has written this text into the cell, or has found it there."""
        with self.lock:
            self.cell = self.document.with_line_ends(text)

    def note_saved(self, text: str) -> None:
        """Note that a file of the user's choice, or a new cell, has this text."""
        with self.lock:
            self.saved = text
            self._wake()

    def recover(self, text: str) -> None:
        """Ask about the text of a view that has lost its kernel: it continues the text that the lab kept."""
        with self.lock:
            text = self.document.with_line_ends(text)
            if are_alike(text, self.text):  # it was saved with the notebook
                self.withdraw("lab")
            elif text.strip() and text not in (other.text for other in self.conflicts):
                self.withdraw("lab")
                self.ask(Conflict("view", text))

    def withdraw(self, source: str = "") -> None:
        """End the conflicts about texts from a source, or all, with the present text: those are versions."""
        with self.lock:
            for each in [each for each in self.conflicts if source in ("", each.source)]:
                self.conflicts.remove(each)
                self.add_version(each.text)

    def end_conflict(self, number: int | None, use: bool) -> None:
        """End the conflict of this number (None: the present one), with its text or with the present one."""
        with self.lock:
            conflict = next(iter(self.conflicts), None)
            if conflict is None or number not in (None, conflict.number):
                return
            self._end(conflict)
            self.add_version(conflict.text)
            if use:
                self.write(conflict.text)

    def _end(self, conflict: Conflict) -> None:
        self.conflicts.remove(conflict)
        if conflict.source == "cell":
            self.cell = conflict.text


def are_alike(text: str, other: str | None) -> bool:
    """Return whether two texts are equal except for line ends: a cell has its own, and a final newline."""
    return other is not None and text.splitlines() == other.splitlines()


def _update_view(update: Update) -> UpdateView:
    return {"view": update.view, "changes": update.changes.json()}

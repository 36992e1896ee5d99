"""Decide when the texts of a session are written to their files.

Every text is kept at once, so that no work is lost; keeping an unchanged text costs nothing. A failed write
is repeated. A file that was changed by another program is noticed within a second, and not overwritten before
the user has chosen. The text of a program that hangs is kept as well, so that the next kernel does not start
it.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from threading import Lock

from lrp_jupyter.errors import FileError
from lrp_jupyter.files import read_file, write_file
from lrp_jupyter.own import digest
from lrp_jupyter.widgets.text.conflicts import Conflict
from lrp_jupyter.widgets.text.kept import Kept, OverwritingError, Remembered, newest
from lrp_jupyter.widgets.text.texts import Texts, are_alike

_LOOK = 1.0  # s between two comparisons of the file with what was written
_AGAIN = 5.0  # s until a text that could not be kept is tried again
_WELL = 10.0  # s that a program must run after one of its blocks did not return


class Saver:
    """See the module's docstring. Without files, the texts are kept in memory only."""

    def __init__(self, texts: Texts, kept: Kept | None = None, home: str = "") -> None:
        self.texts = texts
        self.kept = kept
        self.problem = ""  # why the texts cannot be kept at the moment; empty if they are
        self.home = home if kept is None else kept.home  # not that of a program of the same name elsewhere
        self.follows = False  # whether what others write to the file is an edit, once told to `look`
        self.followed: str | None = None  # the last such text
        self.elsewhere: Callable[[], object] = lambda: None  # keeps every text, too
        self._lock = Lock()  # of the files, and of what follows
        self._stored: object = None
        self._looked = self._again = float("-inf")
        self._well = 0.0  # when the text that hung began to run well
        self._saved_as: dict[str, str] = {}  # the texts that this lab wrote to files chosen by the user
        self._remembered = Remembered() if kept is None else kept.remembered()
        texts.cell, texts.versions = self._remembered.cell, self._remembered.versions
        self.hung = self._remembered.hung

    def save_as(self, path: str | os.PathLike[str], replace: bool) -> bool:
        """Write the text to a file of the user's choice; return False if another file would be replaced."""
        file, text = os.path.expanduser(path), self.texts.text
        if not replace and (os.path.isfile(file) or os.path.islink(file)):
            there = read_file(file)
            known = self._saved_as.get(os.path.realpath(file))
            if there is None or (there != text and digest(there) != known):
                return False
        write_file(file, text)
        self._saved_as[os.path.realpath(file)] = digest(text)
        self.texts.note_saved(text)
        return True

    def first_texts(self, cell: str | None) -> list[str]:
        """Return the texts to start with, the newest last, and ask about other kept texts.

        The text of a cell starts, because it is what the user sees. Without one, the text that this user has
        written starts; a text that came with the folder never does.
        """
        if self.kept is None:
            return [cell] if cell else []
        texts, own = self.texts, [self._remembered.typed]
        accepted = self.kept.read(".lrp") or ""
        if self.kept.is_own(".lrp", accepted):
            own.append(accepted)
        elif accepted.strip() and not are_alike(accepted, cell) and (not cell or accepted != texts.cell):
            texts.ask(Conflict("stranger", accepted))
        found = [text for text in own if text and text.strip() and not are_alike(text, cell)]
        if not cell:
            return found[::-1]
        for text in reversed(found):
            texts.add_version(text)
        changed = [text for text in found if text != texts.cell]
        if changed:
            texts.ask(Conflict("lab", changed[0]))
        return [cell]

    def move(self, name: str) -> None:
        """Keep the texts under another name; the texts kept there before become versions."""
        self.save(at_once=True)
        texts = self.texts
        with self._lock, texts.lock:
            if self.kept is not None:
                self.kept = Kept(self.kept.folder, name)
                self.home = self.kept.home
                self._remembered, self._stored = self.kept.remembered(), None
                self.hung, unkept = self._remembered.hung, texts.versions if self.problem else ()
                texts.versions = newest([*unkept, *self._remembered.versions])
                for text in (self.kept.read(".lrp"), self._remembered.typed):
                    if text is not None:
                        texts.add_version(text)
            texts.withdraw()  # they were about the other name
            texts.cell = texts.accepted = None
            texts.line = ""

    def save(self, at_once: bool = False) -> None:
        """Keep the texts in their files; a failure is reported once, and tried again later, or `at_once`."""
        with self._lock:
            self.elsewhere()
            if self.kept is None or (self.texts.clock() < self._again and not at_once):
                return
            try:
                self._notice_hanging()
                self._save(self.kept)
                self.problem = ""
            except OverwritingError:
                self._looked = float("-inf")  # the next look says by what
            except FileError as error:
                self._again = self.texts.clock() + _AGAIN
                if not self.problem:
                    self.texts.session.output.print(f"The text is not kept. {error}")
                self.problem = str(error)

    def look(self) -> None:
        """Look now whether another program has changed the file."""
        self._looked = float("-inf")
        self.save(at_once=True)

    def _notice_hanging(self) -> None:
        """Remember the text of a program that hangs, so that it is not started again automatically."""
        frame, now = self.texts.session.frame, self.texts.clock()
        text = frame.program.text
        if frame.hung is not None:
            self.hung = text
        if frame.hung is not None or text != self.hung or frame.status != "running":
            self._well = now
        elif now - self._well > _WELL:
            self.hung = None

    def _save(self, kept: Kept) -> None:
        texts, now = self.texts, self.texts.clock()
        wanted = self._wanted()
        if wanted == self._stored and now - self._looked < (float("inf") if self.follows else _LOOK):
            return
        self._looked = now
        other = kept.changed(".lrp")
        if other is not None and other != texts.accepted:
            if self.follows:
                texts.follow(other)
                self.followed = other
            else:
                texts.ask(Conflict("file", other, kept.shown_file))
            wanted = self._wanted()
        accepted, remembered = wanted
        if accepted is not None:
            kept.write(".lrp", accepted)
        if remembered != self._remembered:
            kept.remember(remembered)
            self._remembered = remembered
        self._stored = wanted

    def _wanted(self) -> tuple[str | None, Remembered]:
        """Return the data to keep: the text, unless a question may concern the file, and the rest."""
        texts = self.texts
        with texts.lock:
            asked = [each for each in texts.conflicts if each.source != "cell"]
            accepted, typed = None if asked else texts.accepted, texts.text
            if not typed.strip() or typed in (accepted, texts.cell):
                typed = next((each.text for each in asked if each.source in ("lab", "view")), "")
            return accepted, Remembered(typed or None, texts.cell, self.hung, texts.versions)

"""Decide when the texts of a session are written to their files.

Every text is kept at once, so that no work is lost; what is kept already costs nothing. What could not be
written is tried again. A file that was changed by another program is noticed within a second, and not
overwritten before the user has chosen. The text of a program that hangs is kept as well, so that the next
kernel does not start it.
"""

from __future__ import annotations

import os
from threading import Lock
from time import time

from lrp_jupyter.errors import FileError
from lrp_jupyter.files import read_file, write_file
from lrp_jupyter.widgets.conflicts import Conflict
from lrp_jupyter.widgets.kept import Kept, Version, newest
from lrp_jupyter.widgets.texts import Texts, fingerprint

_LOOK = 1.0  # s between two comparisons of the file with what was written
_AGAIN = 5.0  # s until a text that could not be kept is tried again
_WELL = 10.0  # s that a program has to run after a block of it did not return


class Saver:
    """See the head of this module.

    `texts`: they continue with the text of the cell that was kept.
    `kept`: the files in which the texts are kept; None: in memory only.
    `home`: without files: what distinguishes this program from one of the same name elsewhere; default:
        nothing.
    """

    def __init__(self, texts: Texts, kept: Kept | None = None, home: str = "") -> None:
        self.texts = texts
        self.kept = kept
        self.problem = ""
        """Why the texts cannot be kept at the moment; empty if they are."""
        self._home = home
        self._lock = Lock()  # of the files, and of what follows
        self._stored: tuple[object, ...] = ()
        self._looked = self._again = float("-inf")
        self._hung: str | None = None
        self._well = 0.0  # since when the text that hung has run well
        self._saved_as: dict[str, tuple[int, int]] = {}  # what this lab wrote to files of the user's choice
        if kept is not None:
            texts.cell, self._hung = kept.read(".cell"), kept.read(".hung")

    @property
    def home(self) -> str:
        """What distinguishes this program from one of the same name elsewhere; empty if nothing does."""
        return self._home if self.kept is None else self.kept.home

    def save_as(self, path: str, replace: bool) -> bool:
        """Write the text to a file of the user's choice; return False if another file would be replaced.

        Raises FileError: it cannot be written.
        """
        file, text = os.path.expanduser(path), self.texts.text
        if not replace and (os.path.isfile(file) or os.path.islink(file)):
            there = read_file(file)
            known = self._saved_as.get(os.path.realpath(file))
            if there is None or (there != text and fingerprint(there) != known):
                return False
        write_file(file, text)
        self._saved_as[os.path.realpath(file)] = fingerprint(text)
        return True

    def move(self, name: str) -> None:
        """Keep the texts under another name from now on; what was kept there joins the versions."""
        self.save(at_once=True)
        texts = self.texts
        with self._lock, texts.lock:
            for conflict in texts.conflicts:  # it was about the other name
                texts.withdraw(conflict)
            texts.cell = texts.accepted = None
            if self.kept is None:
                return
            self.kept = Kept(self.kept.folder, name)
            self._hung, self._stored = self.kept.read(".hung"), ()
            for text in (self.kept.read(".lrp"), self.kept.read(".draft")):
                if text is not None:
                    texts.add_version(text)

    @property
    def versions(self) -> list[Version]:
        """The earlier texts, the newest first."""
        with self._lock:
            kept = [] if self.kept is None else self.kept.versions()
        with self.texts.lock:
            return newest([*self.texts.replaced, *kept])

    def save(self, at_once: bool = False) -> None:
        """Keep the texts in their files; what is kept already costs nothing.

        A failure is reported once, and tried again after some seconds, or `at_once`.
        """
        with self._lock:
            if self.kept is None or (self.texts.clock() < self._again and not at_once):
                return
            try:
                self._keep_hung(self.kept)
                self._save(self.kept)
                self.problem = ""
            except FileError as error:
                self._again = self.texts.clock() + _AGAIN
                if not self.problem:
                    self.texts.session.output.print(f"The text is not kept. {error}")
                self.problem = str(error)

    def _keep_hung(self, kept: Kept) -> None:
        """Keep the text of a program that hangs, so that it is not started again by itself."""
        frame, now = self.texts.session.frame, self.texts.clock()
        text = frame.program.text
        if frame.hung is not None:
            kept.write(".hung", text)
            self._hung = text
        if frame.hung is not None or text != self._hung or frame.status != "running":
            self._well = now
        elif now - self._well > _WELL:
            kept.remove(".hung")
            self._hung = None

    def _save(self, kept: Kept) -> None:
        texts = self.texts
        with texts.lock:
            accepted, typed, cell, versions = texts.accepted, texts.text, texts.cell, texts.replaced
            asked = texts.conflicts.endings
        now, wanted = texts.clock(), (accepted, typed, cell, versions, asked)
        if wanted == self._stored and now - self._looked < _LOOK:
            return
        self._looked = now
        other = kept.changed(".lrp")
        if other is not None and other != accepted:
            self._release(kept, ".lrp")
            texts.ask(Conflict("file", other, (".lrp",), kept.shown_file))
            return  # which is news to keep, too
        if accepted is not None and ".lrp" not in asked:
            kept.write(".lrp", accepted)
        is_kept = not typed.strip() or typed == cell or (typed == accepted and ".lrp" not in asked)
        if not is_kept:
            self._release(kept, ".draft")
            kept.write(".draft", typed)
        elif ".draft" not in asked:
            kept.remove(".draft")
        if cell is not None:
            kept.write(".cell", cell)
        if versions:
            kept.add_versions(versions)
            with texts.lock:
                texts.replaced = [each for each in texts.replaced if each not in versions]
        self._stored = wanted

    def _release(self, kept: Kept, ending: str) -> None:
        """Make a file free that conflicts hold: their texts are versions from now on."""
        with self.texts.lock:
            holding = self.texts.conflicts.holding(ending)
        if holding:
            kept.add_versions(Version(each.text, time()) for each in holding)
        with self.texts.lock:
            self.texts.conflicts.release(ending)

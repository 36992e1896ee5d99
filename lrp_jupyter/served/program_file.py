"""The file that ``lrp run`` was started with: what is typed into a page is written to it.

Only a valid program is; what is not one yet is kept in ``.lrp`` beside the file, as that of a notebook's lab.
"""

from __future__ import annotations

import os
from pathlib import Path

from lrp_jupyter.errors import LRPError
from lrp_jupyter.files import read_text, shown
from lrp_jupyter.own import digest
from lrp_jupyter.widgets.text.keeping import kept_texts
from lrp_jupyter.widgets.text.kept import Kept, Remembered

_TEXT = ".lrp"


class ProgramFile(Kept):
    """The files of a program whose text is a file of its user's choice; a link to it stays one."""

    def __init__(self, path: Path) -> None:
        self.path = Path(os.path.realpath(path))
        beside = kept_texts(self.path.parent, self.path.stem)
        self._keeps = beside is not None  # what is not a program
        super().__init__(self.path.parent if beside is None else beside.folder, self.path.stem)

    def file(self, ending: str) -> Path:
        """Return the path of a file."""
        return self.path if ending == _TEXT else super().file(ending)

    @property
    def shown_file(self) -> str:
        """The path of the text as a message shows it."""
        return shown(self.path.name)

    def read_again(self, ending: str = _TEXT) -> str | None:
        """Return the text that a file has now, which then still counts as a change."""
        if ending != _TEXT:
            return super().read_again(ending)
        try:
            return read_text(self.path)
        except LRPError:
            return None

    def write(self, ending: str, text: str) -> None:
        """Write a text to a file; one that was removed is written when there is something new to write."""
        _, known = self._known.get(ending, (None, ""))
        if ending == _TEXT and known == digest(text) and not self.path.exists():
            return
        super().write(ending, text)

    def is_own(self, ending: str, text: str) -> bool:
        """Return whether this user wrote the text: the file was named on the command line."""
        return ending == _TEXT or super().is_own(ending, text)

    def remembered(self) -> Remembered:
        """Return the data kept with the text."""
        return super().remembered() if self._keeps else Remembered()

    def remember(self, what: Remembered) -> None:
        """Keep this with the text."""
        if self._keeps:
            super().remember(what)

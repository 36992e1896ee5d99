"""The program of a run, as its pages see it: it stays with its file and its robot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.errors import LRPError
from lrp_jupyter.live.session import Session
from lrp_jupyter.served.program_file import ProgramFile
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Texts

_READ_ONLY = (
    "This page is read-only: `lrp run` was started with `--read-only`, so nothing can be changed from here."
)


class ServedProgram(PageConnection):
    """A session and the pages that show it.

    `text`: of the program, which need not be valid.
    `path`: of its file; None for a bundled program, whose text is kept nowhere.
    `follows`: whether a change of the file is an edit; else the pages ask what to do with it.
    `read_only`: whether pages only look; then nothing is written, and nothing asked.
    """

    def __init__(
        self, session: Session, text: str, path: Path | None, follows: bool = False, read_only: bool = False
    ) -> None:
        texts = Texts("file")
        self.file = None if path is None else ProgramFile(path)
        saver = Saver(texts, None if read_only else self.file)
        saver.follows = follows
        beside = Path() if path is None else path.parent
        saver.first_texts(text)
        super().__init__(session, saver, beside=beside)
        self.read_only = _READ_ONLY if read_only else ""
        self.looking.pauses = not read_only
        if text != texts.text:
            texts.write(text)

    def look(self, saved: str) -> bool:
        """Look whether another program has saved this text in the file; return whether so."""
        if self.file is None or self.file.read_again() != saved:  # it is being written: there will be another
            return False
        if self.read_only:
            self.texts.follow(saved)
            return True
        self.saver.look()
        is_followed = self.saver.followed == saved  # now, or before this was called
        if is_followed:
            self.saver.followed = None
        return is_followed

    def change_bridge(self, bridge: str | Bridge, **options: Any) -> None:
        """Refuse: the robot is that of the command."""
        raise LRPError("The robot was chosen with `lrp run --bridge`, and stays until the run ends.")

    def load(self, name: str, text: str) -> None:
        """Refuse: the text would replace that of the file."""
        raise LRPError(f"`lrp run` runs `{self.name}`. Open another program with another `lrp run`.")

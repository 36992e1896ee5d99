"""Source texts of programs: from a file, also at every save, from standard input, or bundled."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from lrp_jupyter import programs
from lrp_jupyter.errors import FileError, LRPError, did_you_mean, ended
from lrp_jupyter.files import decoded, guessed, read_data, read_text, shown, whole


class Source(NamedTuple):
    """A program's text and its origin."""

    name: str  # as given on the command line
    text: str
    path: Path | None = None  # of a file of the user's

    @property
    def challenge(self) -> str | None:
        """The challenge that the text's heading names: one that is registered, for a file would be run."""
        from lrp_jupyter.grading.challenges import challenge

        name = programs.heading(self.text).challenge
        if name is None:
            return None
        try:
            return challenge(name, "; only `--challenge` chooses a file").name
        except LRPError as error:
            line = programs.line_of(self.text, name)
            raise LRPError(f"`{shown(self.name)}`, line {line}: {error}") from None

    @property
    def world(self) -> str | None:
        """The world named in the text's heading; a file name is relative to the program's folder."""
        return programs.world_of(self.text, self.path.parent if self.path is not None else None)


def read_source(what: str) -> Source:
    """Read a file, a bundled program, or (``-``) standard input."""
    if what == "-":
        try:
            data = whole(sys.stdin.buffer)
        except OSError as error:
            raise FileError(f"Standard input cannot be read: {ended(str(error))}") from None
        return Source("<stdin>", decoded(data, "Standard input"))
    path = Path(what)
    if path.exists():
        return Source(what, read_text(path), path)
    if what in programs.names():
        return Source(what, programs.load(what))
    known = [*programs.names(), *sorted(str(each) for each in Path().glob("*.lrp"))]
    hint = did_you_mean(what, known) or did_you_mean(path.stem, known)
    hint = hint or f" Bundled programs: {', '.join(programs.names())}."
    raise FileError(f"`{what}` is neither a file nor a bundled program.{hint}")


_DEBOUNCE = 50  # ms without a change: editors write in several steps
_POLL = 500  # ms after which the file is read anyway: some file systems send no notifications


def may_hold_several(file: str) -> bool:
    """Return whether a file may hold several programs, each of which names its challenge."""
    return Path(file).is_dir() or file.lower().endswith((".ipynb", ".zip"))


def challenge_in(file: str) -> str | None:
    """Return the challenge that a program names in its heading; None for what may hold several programs."""
    if may_hold_several(file):
        return None
    if Path(file).is_file():  # in any encoding, as programs are read that are handed in
        return Source(file, guessed(read_data(file), f"`{shown(file)}`")[0], Path(file)).challenge
    return read_source(file).challenge


class Watch:
    """A thread that reads a file again whenever it is saved, and calls `saved` with each new text.

    Or with the error, once, when the file is gone or is not a text any more. The folder is watched, not the
    file: many editors save by replacing the file.
    """

    def __init__(self, path: Path, text: str, saved: Callable[[str | FileError], object]) -> None:
        self._path = path
        self._text: str | None = text
        self._is_gone = False
        self._saved = saved
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"watch {path.name}", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        from watchfiles import watch

        for _ in watch(
            self._path.absolute().parent,
            watch_filter=None,  # filtered out, changes to other files would postpone the look after `_POLL`
            debounce=_DEBOUNCE,
            step=_DEBOUNCE // 2,
            rust_timeout=_POLL,
            yield_on_timeout=True,
            recursive=False,
            stop_event=self._stop,
            raise_interrupt=False,
        ):
            try:
                text = self._settled_text()
            except FileError as error:
                if not self._is_gone:
                    self._is_gone = True
                    self._text = None  # whatever is there next is new
                    self._saved(error)
                continue
            self._is_gone = False
            if text != self._text:
                self._text = text
                self._saved(text)

    def _settled_text(self) -> str:
        """Read the file; again and again while it is being written, for half a text may be a program, too."""
        text = self._read()
        while text != self._text and not self._stop.wait(_DEBOUNCE / 1000):
            before, text = text, self._read()
            if text == before:
                break
        return text

    def _read(self) -> str:
        try:
            return read_text(self._path)
        except FileError:  # as may happen once, while an editor replaces the file
            self._stop.wait(_POLL / 1000)
            return read_text(self._path)

    def close(self) -> None:
        """Stop watching."""
        self._stop.set()
        self._thread.join(2)

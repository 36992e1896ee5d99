"""Source texts of programs: from a file, from standard input, or bundled.

With ``--watch`` every save of a file is a new text: live programming with any editor.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from difflib import get_close_matches
from pathlib import Path
from typing import NamedTuple

from lrp_jupyter import programs
from lrp_jupyter.errors import LRPError

__all__ = ["Source", "UnreadableError", "Watch", "read_file", "read_source"]


class UnreadableError(LRPError):
    """A file does not exist or is not text."""


class Source(NamedTuple):
    """A program's text and its origin.

    Parameters
    ----------
    name : str
        As given on the command line; findings and tracebacks show it.
    text : str
    path : Path or None
        None for a bundled program and for standard input.
    """

    name: str
    text: str
    path: Path | None = None

    @property
    def world(self) -> str | None:
        """The world named in the text's heading; a file name is relative to the program's folder."""
        world = programs.heading(self.text).world
        if world is not None and self.path is not None and world.endswith(".json"):
            return str(self.path.parent / world)
        return world


def read_source(what: str) -> Source:
    """Read a file, a bundled program, or (``-``) standard input.

    Raises
    ------
    UnreadableError
        The file cannot be read; the message lists the alternatives.
    """
    if what == "-":
        return Source("<stdin>", _decoded(sys.stdin.buffer.read(), "Standard input"))
    path = Path(what)
    if path.exists():
        return Source(what, read_file(path), path)
    if what in programs.names():
        return Source(what, programs.load(what))
    known = [*programs.names(), *sorted(str(each) for each in Path().glob("*.lrp"))]
    close = get_close_matches(what, known, n=1) or get_close_matches(path.stem, known, n=1)
    hint = f"Did you mean `{close[0]}`?" if close else f"Bundled programs: {', '.join(programs.names())}."
    raise UnreadableError(f"There is no file or bundled program `{what}`. {hint}")


def read_file(path: Path) -> str:
    """Return the text of a file, its line endings unchanged.

    Raises
    ------
    UnreadableError
        The file cannot be read or is not UTF-8.
    """
    try:
        return _decoded(path.read_bytes(), f"`{path}`")
    except OSError as error:
        raise UnreadableError(f"`{path}` cannot be read: {error.strerror or str(error)}.") from error


def _decoded(data: bytes, name: str) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UnreadableError(f"{name} is not valid UTF-8: byte {error.start} cannot be decoded.") from error


_DEBOUNCE = 50  # ms without a change: editors write in several steps
_POLL = 500  # ms after which the file is read anyway: some file systems send no notifications


class Watch:
    """A thread that reads a file again whenever it is saved.

    The folder is watched, not the file: many editors save by replacing the file.

    Parameters
    ----------
    path : Path
    text : str
        The text already read.
    saved : callable
        Called with each new text, on the watching thread.
    """

    def __init__(self, path: Path, text: str, saved: Callable[[str], object]) -> None:
        self._path = path
        self._text = text
        self._saved = saved
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"watch {path.name}", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        from watchfiles import watch

        for _ in watch(
            self._path.absolute().parent,
            watch_filter=lambda _, path: Path(path).name == self._path.name,
            debounce=_DEBOUNCE,
            step=_DEBOUNCE // 2,
            rust_timeout=_POLL,
            yield_on_timeout=True,
            recursive=False,
            stop_event=self._stop,
            raise_interrupt=False,
        ):
            try:
                text = read_file(self._path)
            except UnreadableError:  # for a moment or for good: the last text stays valid
                continue
            if text != self._text:
                self._text = text
                self._saved(text)

    def close(self) -> None:
        """Stop watching."""
        self._stop.set()
        self._thread.join(2)

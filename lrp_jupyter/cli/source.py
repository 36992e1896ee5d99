"""Texts of programs: from a file, from standard input, or bundled.

With ``--watch`` every save of a file is a new text: live programming with one's own editor.
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
    """There is no such file, or it is no text."""


class Source(NamedTuple):
    """A text and where it comes from.

    Parameters
    ----------
    name : str
        As it was asked for; findings and tracebacks show it.
    text : str
    path : Path or None
        None for a bundled program and for standard input.
    """

    name: str
    text: str
    path: Path | None = None

    @property
    def world(self) -> str | None:
        """The world that the text itself asks for; a file is looked for beside it."""
        world = programs.heading(self.text).world
        if world is not None and self.path is not None and world.endswith(".json"):
            return str(self.path.parent / world)
        return world


def read_source(what: str) -> Source:
    """Read a file, a bundled program, or (``-``) standard input.

    Raises
    ------
    UnreadableError
        The sentence says what there is instead.
    """
    if what == "-":
        return Source("<stdin>", _decoded(sys.stdin.buffer.read(), "standard input"))
    path = Path(what)
    if path.exists():
        return Source(what, read_file(path), path)
    if what in programs.names():
        return Source(what, programs.load(what))
    known = [*programs.names(), *sorted(str(each) for each in Path().glob("*.lrp"))]
    close = get_close_matches(what, known, n=1) or get_close_matches(path.stem, known, n=1)
    hint = f"; did you mean `{close[0]}`?" if close else f"; bundled are {', '.join(programs.names())}."
    raise UnreadableError(f"there is no file and no bundled program `{what}`{hint}")


def read_file(path: Path) -> str:
    """Read a text, line ends as they are.

    Raises
    ------
    UnreadableError
        With a sentence.
    """
    try:
        return _decoded(path.read_bytes(), f"`{path}`")
    except OSError as error:
        raise UnreadableError(
            f"`{path}` cannot be read: {(error.strerror or str(error)).lower()}."
        ) from error


def _decoded(data: bytes, name: str) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UnreadableError(f"{name} is not a text in UTF-8: byte {error.start} does not fit.") from error


_SETTLE = 50  # ms without a change: editors write in several steps
_LOOK = 500  # ms after which the file is read anyway: some file systems notify of nothing


class Watch:
    """A thread that reads a file again whenever it was saved.

    Its folder is watched, not the file: many editors save by putting a new file in its place.

    Parameters
    ----------
    path : Path
    text : str
        What is known of it already.
    saved : callable
        Gets each new text, on the watching thread.
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
            debounce=_SETTLE,
            step=_SETTLE // 2,
            rust_timeout=_LOOK,
            yield_on_timeout=True,
            recursive=False,
            stop_event=self._stop,
            raise_interrupt=False,
        ):
            try:
                text = read_file(self._path)
            except UnreadableError:  # for a moment, or for good: the last text counts
                continue
            if text != self._text:
                self._text = text
                self._saved(text)

    def close(self) -> None:
        """Watch no longer."""
        self._stop.set()
        self._thread.join(2)

"""Live programming with one's own editor: every save of a file is a new text."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path

from watchfiles import watch

from lrp_jupyter.cli.source import UnreadableError, read_file

__all__ = ["Watch"]

_SETTLE = 50  # ms without a change: editors write in several steps
_LOOK = 500  # ms after which it looks anyway: some file systems tell nothing


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

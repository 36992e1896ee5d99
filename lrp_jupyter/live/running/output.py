"""The printed output of blocks: buffered in the session and shown by the lab, not on stdout."""

from __future__ import annotations

import io
from collections import deque
from collections.abc import Callable
from threading import Lock
from typing import Any


class Output:
    """Buffer of the last lines printed; older ones are dropped, but counted. Thread-safe."""

    def __init__(self, lines: int = 1000) -> None:
        self.count = 0
        self.written: Callable[[str], object] | None = None
        """Called with every text that a block prints."""
        self._lines: deque[str] = deque(maxlen=lines)
        self._open = ""  # the last line, still incomplete
        self._lock = Lock()

    def print(self, *values: object, sep: str | None = None, end: str | None = None, **other: Any) -> None:
        """Print like Python's ``print``, into this buffer or into the `file` given."""
        if other.get("file") is not None:
            print(*values, sep=sep, end=end, **other)  # noqa: T201  (the block asked for that file)
            return
        text = io.StringIO()
        print(*values, sep=sep, end=end, file=text)
        self.write(text.getvalue())
        if self.written is not None:
            self.written(text.getvalue())

    def write(self, text: str) -> None:
        """Append text; every newline ends a line."""
        with self._lock:
            *lines, self._open = (self._open + text).split("\n")
            self._open = self._open[:10_000]
            self._lines.extend(line[:10_000] for line in lines)
            self.count += len(lines)

    def since(self, count: int) -> tuple[int, tuple[str, ...]]:
        """Return the current count, and the lines after the first `count` that are still kept."""
        with self._lock:
            new = min(self.count - count, len(self._lines))
            return self.count, tuple(self._lines)[len(self._lines) - new :] if new > 0 else ()

    def clear(self) -> None:
        """Drop all lines; the count continues."""
        with self._lock:
            self._lines.clear()
            self._open = ""

    def __str__(self) -> str:
        with self._lock:
            return "".join(f"{line}\n" for line in self._lines) + self._open

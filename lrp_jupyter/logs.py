"""Files that are written line by line while something runs, and read again later.

They are compressed if their name ends with ``.gz``. What was written before the end of a process that was
killed, or before a disk was full, is there and can be read.
"""

from __future__ import annotations

import gzip
import io
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import IO, cast

from lrp_jupyter.errors import FileError
from lrp_jupyter.files import open_regular, shown, unreadable, unwritable

_LARGEST = 500_000_000  # bytes of the content that is read
_LONGEST = 32_000_000  # bytes of a line
_GZIP = b"\x1f\x8b"
_KEPT = 1.0  # s of writing that a process which is killed may lose


class _Log(io.TextIOWrapper):
    """A file of lines, of which nothing older than a second is lost when the process is killed.

    What cannot be written is a FileError, once.
    """

    def __init__(self, path: str | os.PathLike[str], data: IO[bytes]) -> None:
        # a program may print half a character
        super().__init__(data, encoding="utf-8", errors="surrogatepass", newline="\n")
        self._path, self._failed, self._flushed = path, False, float("-inf")

    def write(self, text: str, /) -> int:
        with self._naming():
            count = super().write(text)
        if monotonic() > self._flushed + _KEPT:
            self.flush()
            self._flushed = monotonic()
        return count

    def flush(self) -> None:
        with self._naming():
            super().flush()

    def close(self) -> None:
        is_told = self._failed
        try:
            with self._naming():
                super().close()
        except FileError:
            if not is_told:
                raise

    @contextmanager
    def _naming(self) -> Iterator[None]:
        try:
            yield
        except (FileError, BrokenPipeError):
            raise
        except OSError as error:
            self._failed = True
            raise unwritable(self._path, error) from None


def unused(path: str | os.PathLike[str]) -> Path:
    """Return a file that does not exist: this one, or this one with a number, so none is overwritten."""
    file = Path(path)
    name, ending, rest = file.name.partition(".lrplog")
    free, count = file, 1
    while free.exists():
        count += 1
        free = file.with_name(f"{name} ({count}){ending}{rest}")
    return free


def open_log(path: str | os.PathLike[str]) -> IO[str]:
    """Open a file that is written line by line; compressed, if its name ends with ``.gz``.

    Raises FileError: it cannot be written; the message gives the reason.
    """
    try:
        opener = gzip.open if Path(path).suffix == ".gz" else open
        data = opener(path, "wb")
    except (OSError, ValueError) as error:
        raise unwritable(path, error) from None
    return _Log(path, cast("IO[bytes]", data))


def read_log(path: str | os.PathLike[str]) -> Iterator[bytes]:
    """Yield the lines of a file, with their newlines; of one that was cut off, the last one has none.

    Raises FileError: it cannot be read, is too large, has a line that is too long, or its name ends with
        ``.gz`` and its data is not compressed or damaged.
    """
    number = size = 0
    try:
        with open_regular(path) as stream, _decompressed(stream, path) as lines:
            while line := lines.readline(min(_LONGEST, _LARGEST) + 1):
                number, size = number + 1, size + len(line)
                if size > _LARGEST:
                    raise OSError(f"It contains more than {_LARGEST / 1e6:,.0f} MB.")
                if len(line) > _LONGEST:
                    raise at_line(shown(path), number, f"It is longer than {_LONGEST / 1e6:,.0f} MB.")
                yield line
    except EOFError:  # of the compressed data
        yield b""
    except FileError:
        raise
    except (gzip.BadGzipFile, zlib.error):
        raise unreadable(path, OSError(_damage(path))) from None
    except (OSError, ValueError) as error:  # a ValueError: there is a null character in its name
        raise unreadable(path, error) from None


def _decompressed(stream: IO[bytes], path: str | os.PathLike[str]) -> IO[bytes]:
    return cast("IO[bytes]", gzip.open(stream)) if Path(path).suffix == ".gz" else stream


def _damage(path: str | os.PathLike[str]) -> str:
    with open_regular(path) as stream:
        is_compressed = stream.read(len(_GZIP)) == _GZIP
    if is_compressed:
        return "Its compressed data is damaged"
    return "Its name ends with `.gz`, but it is not a gzip file"


def at_line(name: str, number: int, what: str) -> FileError:
    """Return an error about a line of a file: its name as shown, the number from 1, and a sentence."""
    return FileError(f"`{name}`, line {number}: {what}")

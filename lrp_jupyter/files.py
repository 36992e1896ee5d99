"""Files of a user: written as a whole or not at all, and never through a link.

A text is written beside its file, under a new random name, and then put in the file's place. Whoever prepared
the folder (it may come from elsewhere) cannot redirect the writing to another file, and a full disk leaves
the old file as it was.
"""

from __future__ import annotations

import gzip
import io
import os
import secrets
import stat
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic
from typing import IO, cast

from lrp_jupyter.errors import FileError, ended

__all__ = [
    "append_line",
    "at_line",
    "decoded",
    "open_log",
    "read_file",
    "read_log",
    "read_text",
    "shown",
    "write_file",
]

_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
_LARGEST = 32_000_000  # bytes that are read
_LARGEST_LOG = 500_000_000  # bytes of the content of a file of lines
_PART = 1_000_000  # bytes that are decompressed at a time
_GZIP = b"\x1f\x8b"


def write_file(path: str | os.PathLike[str], text: str) -> None:
    """Write a text to a file, as a whole or not at all; a link is replaced, not followed.

    Raises
    ------
    FileError
        It cannot be written; the message gives the reason.
    """
    file = Path(path)
    try:
        data = text.encode()
    except UnicodeEncodeError as error:
        line = text.count("\n", 0, error.start) + 1
        raise FileError(
            f"`{shown(path)}` cannot be written: Line {line} contains half a character "
            f"(`U+{ord(text[error.start]):04X}`), which no file can hold. Delete it there."
        ) from None
    try:
        mode = _mode_of(file)
        beside = file.with_name(f".{secrets.token_hex(8)}.lrp~")
        handle = os.open(beside, _FLAGS, 0o666)
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(data)
            if mode is not None:
                os.chmod(beside, mode)
            os.replace(beside, file)
        except BaseException:
            with suppress(OSError):
                os.unlink(beside)
            raise
    except FileError:
        raise
    except OSError as error:
        raise _unwritable(path, error) from error
    except ValueError:
        raise FileError(f"`{shown(path)}` cannot be the name of a file. Choose another name.") from None


def _unwritable(path: str | os.PathLike[str], error: OSError) -> FileError:
    return FileError(f"`{shown(path)}` cannot be written: {ended(error.strerror or str(error))}")


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
        """Write a line."""
        with self._naming():
            count = super().write(text)
        if monotonic() > self._flushed + _KEPT:
            self.flush()
            self._flushed = monotonic()
        return count

    def flush(self) -> None:
        """Write what is kept back."""
        with self._naming():
            super().flush()

    def close(self) -> None:
        """Write the rest, and close the file."""
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
            raise _unwritable(self._path, error) from None


def open_log(path: str | os.PathLike[str]) -> IO[str]:
    """Open a file that is written line by line; compressed, if its name ends with ``.gz``.

    Raises
    ------
    FileError
        It cannot be written; the message gives the reason.
    """
    try:
        opener = gzip.open if Path(path).suffix == ".gz" else open
        data = opener(path, "wb")
    except OSError as error:
        raise _unwritable(path, error) from None
    return _Log(path, cast("IO[bytes]", data))


def read_log(path: str | os.PathLike[str]) -> tuple[bytes, bool]:
    """Read a file of lines; return what is there of it, and whether its compressed data is complete.

    Raises
    ------
    FileError
        It cannot be read, is too large, or its name ends with ``.gz`` and its data is not compressed or
        damaged.
    """
    try:
        data = Path(path).read_bytes()
        content, is_whole = _gunzipped(data) if Path(path).suffix == ".gz" else (data, True)
    except OSError as error:
        raise FileError(f"`{shown(path)}` cannot be read: {ended(error.strerror or str(error))}") from None
    if len(content) > _LARGEST_LOG:
        limit = f"{_LARGEST_LOG / 1e6:,.0f} MB"
        raise FileError(f"`{shown(path)}` cannot be read: it contains more than {limit}.")
    return content, is_whole


def _gunzipped(data: bytes) -> tuple[bytes, bool]:
    """Return decompressed data, or as much as is there or allowed, and whether that is all."""
    content = bytearray()
    try:
        with gzip.open(io.BytesIO(data)) as stream:
            while part := stream.read1(_PART):
                content += part
                if len(content) > _LARGEST_LOG:
                    break
    except EOFError:
        return bytes(content), False
    except (OSError, zlib.error):
        reason = (
            "its compressed data is damaged"
            if data.startswith(_GZIP)
            else "its name ends with `.gz`, but it is not a gzip file"
        )
        raise OSError(reason) from None
    return bytes(content), True


def at_line(name: str, number: int, what: str) -> FileError:
    """Return an error that begins with a line of a file.

    Parameters
    ----------
    name : str
        Of the file, as it is shown.
    number : int
        Of the line, from 1.
    what : str
        A sentence.
    """
    return FileError(f"`{name}`, line {number}: {what}")


def append_line(path: str | os.PathLike[str], line: str) -> None:
    """Append a line to a file that only this user can read; never through a link.

    Raises
    ------
    OSError
        It cannot be written.
    """
    flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
    handle = os.open(path, flags, 0o600)
    with os.fdopen(handle, "a", encoding="utf-8") as stream:
        stream.write(f"{line}\n")


def _mode_of(file: Path) -> int | None:
    """Return the permissions of the file that is replaced; None if there is none, or a link."""
    try:
        if not stat.S_ISREG(os.stat(file).st_mode):  # a directory, or a device such as /dev/null
            raise FileError(f"`{shown(file)}` exists and is not a file. Choose another name.")
        mode = os.lstat(file).st_mode
    except FileNotFoundError:
        return None
    if not stat.S_ISREG(mode):
        return None
    if not mode & 0o222:
        raise FileError(f"`{shown(file)}` is write-protected. Make it writable, or choose another name.")
    return stat.S_IMODE(mode)


def read_file(path: str | os.PathLike[str]) -> str | None:
    """Return the text of a regular file; None if it is missing, a link, not a text or too large."""
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    try:
        handle = os.open(path, flags | getattr(os, "O_BINARY", 0))
        with os.fdopen(handle, "rb") as stream:
            status = os.fstat(handle)
            if not stat.S_ISREG(status.st_mode) or status.st_size > _LARGEST:
                return None
            return stream.read(_LARGEST).decode()
    except (OSError, ValueError):
        return None


def read_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a file that a person named, its line ends unchanged.

    Raises
    ------
    FileError
        The file cannot be read, or is not UTF-8.
    """
    try:
        data = Path(path).read_bytes()
    except (OSError, ValueError) as error:  # a ValueError: there is a null character in its name
        reason = getattr(error, "strerror", None) or str(error)
        raise FileError(f"`{shown(path)}` cannot be read: {ended(reason)}") from error
    return decoded(data, f"`{shown(path)}`")


def decoded(data: bytes, name: str) -> str:
    """Return bytes in UTF-8 as text; `name` says in the error where they are from."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileError(f"{name} is not valid UTF-8: byte {error.start} cannot be decoded.") from error


def shown(path: str | os.PathLike[str]) -> str:
    """Return a path as a message shows it: without control characters, and not endless."""
    text = "".join(each if each.isprintable() else f"<U+{ord(each):04X}>" for each in os.fspath(path))
    return text if len(text) <= 120 else f"{text[:60]}…{text[-58:]}"

"""Files of a user: written as a whole or not at all, and never through a link.

A text is written beside its file, under a new random name, and then put in the file's place. Whoever prepared
the folder (it may come from elsewhere) cannot redirect the writing to another file, and a full disk leaves
the old file as it was.
"""

from __future__ import annotations

import codecs
import os
import re
import secrets
import stat
import time
import traceback
import unicodedata
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from lrp_jupyter.errors import FileError, LRPError, ended, printable, sentence_of

_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
_READING = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
LARGEST = 32_000_000  # bytes of a text that are read
_WAITS = (0.01, 0.03, 0.1, 0.3)  # s
_NOT_IN_NAMES = set('/\\:*?"<>|')
_DEVICES = {"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))}
_OPEN_ELSEWHERE = (5, 32)  # what Windows calls it: denied, or shared


def write_file(
    path: str | os.PathLike[str], text: str, last: Callable[[Path], object] = lambda ready: None
) -> None:
    """Write a text to a file, as a whole or not at all; a link is replaced, not followed.

    `last` is called with the path of all that is ready; what it raises leaves the file as it is.
    Raises FileError: it cannot be written; the message gives the reason.
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
            last(beside)
            _replace(beside, file)
        except BaseException:
            with suppress(OSError):
                os.unlink(beside)
            raise
    except FileError:
        raise
    except (OSError, ValueError) as error:
        raise unwritable(path, error) from error


def _replace(beside: Path, file: Path) -> None:
    """Put a file in the place of another; Windows refuses that while a program has that one open."""
    for wait in _WAITS:
        try:
            return os.replace(beside, file)
        except PermissionError as error:
            if getattr(error, "winerror", None) not in _OPEN_ELSEWHERE:
                raise
        time.sleep(wait)
    return os.replace(beside, file)


def unwritable(path: str | os.PathLike[str], error: OSError | ValueError) -> FileError:
    """Return the error that a file cannot be written, with the reason."""
    if isinstance(error, ValueError):  # there is a null character in its name
        return FileError(f"`{shown(path)}` cannot be the name of a file. Choose another name.")
    return FileError(f"`{shown(path)}` cannot be written: {ended(error.strerror or str(error))}")


def can_be_file_name(name: str, longest: int) -> bool:
    """Return whether files can have this name, and an ending, on every system; it has no invisible parts."""
    return (
        0 < len(name) <= longest
        and name == name.strip(" .")
        and all(map(can_be_in_file_name, name))
        and name.partition(".")[0].lower() not in _DEVICES
    )


def can_be_in_file_name(character: str) -> bool:
    """Return whether a character can be in the name of a file on every system, and is visible."""
    return character not in _NOT_IN_NAMES and unicodedata.category(character)[0] != "C"


def append_line(path: str | os.PathLike[str], line: str) -> None:
    """Append a line to a file that only this user can read; never through a link.

    Raises OSError: it cannot be written.
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


def open_regular(path: str | os.PathLike[str], flags: int = 0) -> IO[bytes]:
    """Open a file for reading that is one: no device or pipe, which may have no end, or never a beginning.

    Raises OSError, ValueError: it cannot be read, or is something else; `unreadable` makes a sentence of it.
    """
    handle = os.open(path, _READING | flags)
    try:
        mode = os.fstat(handle).st_mode
        if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
            raise OSError("It is a device or a pipe, not a file.")
        return os.fdopen(handle, "rb")  # which says that a folder is one
    except BaseException:
        os.close(handle)
        raise


def whole(stream: IO[bytes]) -> bytes:
    """Return what a stream contains.

    Raises OSError: it contains more than 32 MB.
    """
    data = stream.read(LARGEST + 1)
    if len(data) > LARGEST:
        raise OSError(f"It contains more than {LARGEST / 1e6:,.0f} MB.")
    return data


def read_file(path: str | os.PathLike[str]) -> str | None:
    """Return the text of a regular file; None if it is missing, a link, not a text or too large."""
    try:
        with open_regular(path, getattr(os, "O_NOFOLLOW", 0)) as stream:
            return whole(stream).decode()
    except (OSError, ValueError):
        return None


def read_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a regular file that a person named, its line ends unchanged.

    Raises FileError: the file cannot be read, is a device or a pipe, is too large, or is not UTF-8.
    """
    return decoded(read_data(path), f"`{shown(path)}`")


def read_data(path: str | os.PathLike[str]) -> bytes:
    """Return what is in a regular file that a person named.

    Raises FileError: the file cannot be read, is a device or a pipe, or is too large.
    """
    try:
        with open_regular(path) as stream:
            return whole(stream)
    except (OSError, ValueError) as error:  # a ValueError: there is a null character in its name
        raise unreadable(path, error) from error


def run_python(path: str | os.PathLike[str], names: dict[str, Any]) -> None:
    """Run a Python file of the user with these global names.

    Raises FileError: the file cannot be read.
    Raises LRPError: it raised something; the message has the line of the file, and the cause is what it
        raised.
    """
    try:
        exec(compile(read_text(path), str(path), "exec"), names)
    except FileError:
        raise
    except (Exception, SystemExit) as error:
        raise LRPError(f"{shown(path)}{_line(error, str(path))}: {sentence_of(error)}") from error


def _line(error: BaseException, path: str) -> str:
    """Return which line of a file failed, in words."""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == path]
    line = error.lineno if isinstance(error, SyntaxError) else (lines or [None])[-1]
    return "" if line is None else f", line {line}"


def unreadable(path: str | os.PathLike[str], error: OSError | ValueError) -> FileError:
    """Return the error that a file cannot be read, with the reason."""
    reason = getattr(error, "strerror", None) or str(error)
    return FileError(f"`{shown(path)}` cannot be read: {ended(reason)}")


def decoded(data: bytes, name: str) -> str:
    """Return bytes in UTF-8 as text; `name` says in the error where they are from."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileError(f"{name} is not valid UTF-8: byte {error.start} cannot be decoded.") from error


_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),  # which begins with the mark of UTF-16
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_NOT_IN_TEXTS = re.compile("[\x00-\x08\x0e-\x1f\x7f]")


def guessed(data: bytes, name: str) -> tuple[str, str]:
    """Return bytes in any usual encoding as text and, where that is a guess, a sentence that says so.

    `name` says in the sentences where they are from.
    Raises FileError: they are not a text.
    """
    marked = next((encoding for mark, encoding in _MARKS if data.startswith(mark)), "")
    nulls = data.count(0) * 3 > len(data)  # every second byte of a text in UTF-16 that is mostly English
    wide = ("utf-16-le", "utf-16-be")[data[:1] == b"\0"] if nulls else ""
    for encoding in (marked,) if marked else (wide,) if wide else ("utf-8", "cp1252", "latin-1"):
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        is_certain = bool(marked) or encoding == "utf-8"
        if "\0" in text or not (is_certain or _NOT_IN_TEXTS.search(text) is None):
            break
        if is_certain:
            return text, ""
        said = {"cp1252": "Windows-1252", "latin-1": "Latin-1"}.get(encoding, "UTF-16")
        return (
            text,
            f"{name} is not UTF-8 and was read as {said}, which is a guess: look at its special letters.",
        )
    raise FileError(f"{name} is not a text: it has bytes that no text has. Save the program as text again.")


def shown(path: str | os.PathLike[str]) -> str:
    """Return a path as a message shows it: without control characters, and not endless."""
    text = printable(os.fspath(path))
    return text if len(text) <= 120 else f"{text[:60]}…{text[-58:]}"

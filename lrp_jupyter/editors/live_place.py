"""Where a run and an editor of the same user meet: a folder that no other user can read.

A run makes two files in it, both named after the program's file and the process: one with a key, and a
socket (on Windows, the name of a pipe). Whoever can read the key can ask.
"""

from __future__ import annotations

import os
import secrets
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from lrp_jupyter.errors import FileError
from lrp_jupyter.files import append_line, read_file, shown
from lrp_jupyter.own import digest


class LivePlace(NamedTuple):
    """Where one run is found, and the file with its key."""

    address: str
    key_file: Path

    @property
    def key(self) -> bytes:
        """The key; empty if the run has ended."""
        return (read_file(self.key_file) or "").strip().encode()

    @property
    def process(self) -> int:
        """The number of the process that runs."""
        return int(self.key_file.stem.rpartition("-")[2])

    def forget(self) -> None:
        """Remove what is left of the run."""
        for path in (self.key_file, self.key_file.with_suffix(".sock")):
            with suppress(OSError):
                path.unlink()


def new_place(program: Path) -> LivePlace:
    """Return the place of a run that begins, with a key; what is left of runs that were killed is removed.

    Raises FileError: this user cannot have such a folder.
    """
    *_, folder = _candidates()
    folder.mkdir(mode=0o700, exist_ok=True)
    if not _is_own(folder):
        raise FileError(
            f"`{shown(folder)}` is not a folder that only you can use, so editors cannot be told what runs. "
            "Remove it, or set XDG_RUNTIME_DIR to a folder of yours."
        )
    for place in places_of(program):
        if _has_ended(place.process):
            place.forget()
    place = _place(folder / f"{_name(program)}-{os.getpid()}.key")
    place.forget()
    append_line(place.key_file, secrets.token_hex(32))
    return place


def places_of(program: Path) -> list[LivePlace]:
    """Return where runs of a program's file may be found, the newest first."""
    found: list[tuple[float, Path]] = []
    for folder in filter(_is_own, _candidates()):
        for path in folder.glob(f"{_name(program)}-*.key"):
            with suppress(OSError):  # it ends at this moment
                found.append((path.stat().st_mtime, path))
    return [_place(path) for _, path in sorted(found, reverse=True)]


def _place(key_file: Path) -> LivePlace:
    if sys.platform == "win32":
        return LivePlace(rf"\\.\pipe\lrp-{key_file.stem}", key_file)
    return LivePlace(str(key_file.with_suffix(".sock")), key_file)


def _name(program: Path) -> str:
    return digest(os.path.realpath(program))[:24]


def _is_own(folder: Path) -> bool:
    """Return whether a folder is there, and only this user can use it."""
    try:
        found = folder.lstat()
    except OSError:
        return False
    if sys.platform == "win32":
        return True
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o077


def _candidates() -> Iterator[Path]:
    """Yield folders, the best one last: a socket's path may have about 100 characters."""
    if sys.platform == "win32":
        yield Path(tempfile.gettempdir()) / "lrp-jupyter"
        return
    for base in ("/tmp", tempfile.gettempdir()):
        if len(base) < 40:
            yield Path(base) / f"lrp-{os.getuid()}"
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    if os.path.isdir(runtime) and len(runtime) < 50:
        yield Path(runtime) / "lrp-jupyter"


def _has_ended(process: int) -> bool:
    """Return whether a process has ended; False where that cannot be known."""
    if sys.platform == "win32":  # where signal 0 is a key
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    except PermissionError:  # of another user now
        return True
    return False

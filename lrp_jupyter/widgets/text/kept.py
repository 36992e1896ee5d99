"""The two files of one program: what survives the kernel.

============= ============================================================================================
``.lrp``      the last accepted text
``.versions`` the other data, as JSON: the last texts that were replaced, with their times, and the other
              fields of `Remembered`
============= ============================================================================================

They are in ``.lrp`` beside the notebook, in this user's state folder, or nowhere: see `keeping.py`. Those in
``.lrp`` are hidden, and are passed on with the folder. A file therefore counts as the user's own only if its
hash is noted in this user's state folder, which is elsewhere. All other texts are shown, and never run
unasked. In a browser the files are in its storage, which is not passed on with a folder.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from lrp_jupyter import own
from lrp_jupyter.errors import FileError, LRPError
from lrp_jupyter.files import can_be_file_name, read_file, shown, write_file
from lrp_jupyter.own import digest

FOLDER = ".lrp"
"""The folder of kept texts, beside the notebook."""
_MOST_VERSIONS = 10
_MOST_CHARACTERS = 2_500_000  # of all versions together
_LATEST = 1e11  # s since 1970
_LONGEST_NAME = 100

_Signature = tuple[int, int, int]


class OverwritingError(Exception):
    """It would replace what another program has written since the last look."""


@dataclass(frozen=True)
class Version:
    """An earlier text of a program."""

    text: str
    when: float
    """When it was replaced, in seconds since 1970."""

    @property
    def key(self) -> str:
        """A short name that depends on the text alone."""
        return digest(self.text)[:16]

    def __str__(self) -> str:
        lines = self.text.strip().splitlines()
        when = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(self.when))
        return f"{when}, {len(lines)} line{'' if len(lines) == 1 else 's'}: {lines[0][:60] if lines else ''}"


@dataclass(frozen=True)
class Remembered:
    """The data kept with a program's accepted text."""

    typed: str | None = None  # the last typed text, while it is kept nowhere else
    cell: str | None = None  # the text of the cell, as last known to the lab
    hung: str | None = None  # the text of a program that hung, until it has run well
    versions: tuple[Version, ...] = ()  # the texts that were replaced, the newest first


def newest(versions: Iterable[Version]) -> tuple[Version, ...]:
    """Return the newest ten versions that are not empty, the newest first, each text once."""
    found: dict[str, Version] = {}
    length = 0
    for version in sorted(versions, key=lambda version: version.when, reverse=True):
        length += len(version.text)
        if len(found) == _MOST_VERSIONS or (found and length > _MOST_CHARACTERS):
            break
        if version.text.strip():
            found.setdefault(version.text, version)
    return tuple(found.values())


def checked_name(name: str) -> str:
    """Return the name of a program, or raise if it cannot name files on every system."""
    if not can_be_file_name(name, _LONGEST_NAME):
        raise LRPError(
            f"`{shown(name)}` is not a valid name for a program, because it is also the name of its files. "
            f"Use letters, digits, `_` and `-`, at most {_LONGEST_NAME} of them, and no name that Windows "
            "reserves, such as `con`."
        )
    return name


class Kept:
    """The files of one program, in a folder that is created with the first one. For one thread at a time."""

    def __init__(self, folder: str | os.PathLike[str], name: str) -> None:
        self.folder = Path(folder)
        self.name = name
        self.home = os.path.realpath(self.folder / name)  # not that of a program of the same name elsewhere
        self._known: dict[str, tuple[_Signature | None, str]] = {}  # by suffix: as last read or written here

    def file(self, ending: str) -> Path:
        """Return the path of a file."""
        return self.folder / f"{self.name}{ending}"

    @property
    def shown_file(self) -> str:
        """The path of the text as a message shows it: from the notebook, if the file is beside it."""
        file = self.file(".lrp")
        return f"{FOLDER}/{file.name}" if self.folder.name == FOLDER else shown(file)

    def read(self, ending: str) -> str | None:
        """Return the text of a file; None if it does not exist or cannot be read."""
        signature, text = self._signature(ending), self.read_again(ending)
        if text is not None:
            self._known[ending] = signature, digest(text)
        elif signature is not None:
            self._known.pop(ending, None)
        return text

    def read_again(self, ending: str) -> str | None:
        """Return the text that a file has now, which then still counts as a change."""
        return None if self.folder.is_symlink() else read_file(self.file(ending))

    def write(self, ending: str, text: str) -> None:
        """Write a text to a file, and note that this user wrote it.

        Raises FileError: it cannot be written; OverwritingError: it is not what was last read or written.
        """
        written, known = digest(text), self._known.get(ending)
        if known == (self._signature(ending), written) and self.is_own(ending, text):
            return
        if self.folder.is_symlink():
            raise FileError(f"`{shown(self.folder)}` is a link, so nothing is kept in it. Use a folder.")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except FileExistsError:
            raise FileError(
                f"`{shown(self.folder)}` is a file, so there can be no folder of that name. Rename it."
            ) from None
        except OSError as error:
            raise FileError(f"`{shown(self.folder)}` cannot be created: {error.strerror}.") from error

        signature: _Signature | None = None

        def still_known(ready: Path) -> None:
            nonlocal signature
            if sys.platform == "emscripten":  # no other program is there, and each look takes long
                return
            signature = _signature_of(os.lstat(ready))
            if known is None or self._signature(ending) in (None, known[0]):
                return
            there = self.read_again(ending)  # the signature may change without it
            if there is None or digest(there) != known[1]:
                raise OverwritingError

        write_file(self.file(ending), text, still_known)
        self._known[ending] = signature or self._signature(ending), written
        own.note_own(self.home + ending, written)

    def is_own(self, ending: str, text: str) -> bool:
        """Return whether this user wrote this text to the file, with this package."""
        return own.is_own(self.home + ending, digest(text))

    def changed(self, ending: str) -> str | None:
        """Return the text of a file if it was changed since it was read or written here."""
        known = self._known.get(ending)
        signature = self._signature(ending)
        if signature is None or (known is not None and known[0] == signature):
            return None
        text = self.read(ending)
        if text is None and self.file(ending).is_file() and not self.file(ending).is_symlink():
            raise FileError(
                f"`{shown(self.file(ending))}` was changed outside this lab and cannot be read: "
                "It is not valid UTF-8, or too large. Rename it."
            )
        return None if text is None or (known is not None and known[1] == digest(text)) else text

    def remembered(self) -> Remembered:
        """Return the data kept with the text; a text typed by someone else becomes a version."""
        text = self.read(".versions")
        try:
            found = json.loads(text or "{}")
            fields: Mapping[str, Any] = found if isinstance(found, dict) else {"versions": found}
            versions = [Version(**each) for each in fields.get("versions", ())]
            versions = [each for each in versions if isinstance(each.text, str) and 0 < each.when < _LATEST]
        except (ValueError, TypeError, RecursionError):  # another program wrote it
            return Remembered()
        kept = [fields.get(name) for name in ("typed", "cell", "hung")]
        typed, cell, hung = (each if isinstance(each, str) else None for each in kept)
        if typed is not None and text is not None and not self.is_own(".versions", text):
            versions.append(Version(typed, time.time()))
            typed = None
        return Remembered(typed, cell, hung, newest(versions))

    def remember(self, what: Remembered) -> None:
        """Keep this with the text; versions kept by another kernel stay."""
        versions = newest([*what.versions, *self.remembered().versions])
        self.write(".versions", json.dumps(asdict(replace(what, versions=versions))))

    def _signature(self, ending: str) -> _Signature | None:
        if self.folder.is_symlink():
            return None
        try:
            status = os.lstat(self.file(ending))
        except (OSError, ValueError):
            return None
        return _signature_of(status)


def _signature_of(status: os.stat_result) -> _Signature:
    return status.st_mtime_ns, status.st_size, status.st_ino

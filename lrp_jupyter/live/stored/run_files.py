"""The files of kept runs: recordings in a folder beside the program, named after it."""

from __future__ import annotations

import os
import re
from pathlib import Path

from lrp_jupyter.errors import FileError
from lrp_jupyter.files import unwritable
from lrp_jupyter.logs import unused

ENDINGS = (".lrplog", ".lrplog.gz")
_NAME = re.compile(r"[^\x00-\x1f/\\:*?\"<>|.][^\x00-\x1f/\\:*?\"<>|]{0,79}(?<![ .])")
"""What every file system takes as a name, and shows in a list."""


def runs_folder(program: str | os.PathLike[str]) -> Path:
    """Return the folder of the kept runs of a program, by its name or its file."""
    file = Path(program)
    return file.with_name(f"{file.name.removesuffix('.lrp')}.runs")


def check_name(name: str) -> None:
    """Raise FileError if a run cannot have a name."""
    if not _NAME.fullmatch(name):
        raise FileError(
            f"`{name[:80]}` cannot be the name of a run. Take at most 80 characters, without "
            '`/ \\ : * ? " < > |` and without a full stop at the beginning or the end.'
        )


def possible_name(name: str) -> str:
    """Return the name that is most like a text and that a run can have."""
    return re.sub(r"[\x00-\x1f/\\:*?\"<>|]", "-", name).lstrip(".")[:80].rstrip(" .") or "run"


def new_file(folder: str | os.PathLike[str], name: str) -> Path:
    """Return the file for a new run in a folder, which is made; if there is one, the name gets a number.

    Raises FileError: the folder cannot be made, or a run cannot have this name.
    """
    check_name(name)
    where = Path(folder)
    try:
        where.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(where, error) from None
    return unused(where / f"{name}.lrplog")


def name_of(file: Path) -> str:
    """Return the name of the run that a file has."""
    return file.name.partition(".lrplog")[0]

"""The files of kept runs: recordings in a folder beside the program, named after it."""

from __future__ import annotations

import os
from pathlib import Path

from lrp_jupyter.errors import FileError
from lrp_jupyter.files import can_be_file_name, can_be_in_file_name, shown, unwritable
from lrp_jupyter.logs import unused

ENDINGS = (".lrplog", ".lrplog.gz")
_LONGEST_NAME = 80


def runs_folder(program: str | os.PathLike[str]) -> Path:
    """Return the folder of the kept runs of a program, by its name or its file."""
    file = Path(program)
    return file.with_name(f"{file.name.removesuffix('.lrp')}.runs")


def check_name(name: str) -> None:
    """Raise FileError if a run cannot have a name."""
    if not can_be_file_name(name, _LONGEST_NAME):
        raise FileError(
            f"`{shown(name)}` cannot be the name of a run, because it is also the name of its file. Use at "
            f'most {_LONGEST_NAME} visible characters other than `/ \\ : * ? " < > |`, no full stop or space '
            "at the beginning or the end, and no name that Windows reserves, such as `con`."
        )


def possible_name(name: str) -> str:
    """Return the name that is most like a text and that a run can have."""
    made = "".join(each if can_be_in_file_name(each) else "-" for each in name)
    made = made.strip(" .")[:_LONGEST_NAME].rstrip(" .")
    return made if can_be_file_name(made, _LONGEST_NAME) else "run"


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
    return file.name.removesuffix(".gz").removesuffix(".lrplog")

"""Setting up an editor: the files that it needs, and what the user does next."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

from lrp_jupyter.editors.vscode_package import write_vscode_package
from lrp_jupyter.errors import FileError
from lrp_jupyter.files import shown, write_file

_FOLDER = Path(__file__).parent


class Editor(NamedTuple):
    """An editor: the file that it needs, and the sentence about what to do with it."""

    file: str
    then: str
    write: Callable[[Path, str], None]


def _snippet(source: str) -> Callable[[Path, str], None]:
    def write(file: Path, command: str) -> None:
        text = (_FOLDER / source).read_text("utf-8")
        write_file(file, text.replace('"lrp"', json.dumps(command), 1))

    return write


def _package(file: Path, command: str) -> None:
    write_vscode_package(file, version("lrp-jupyter"), command)


EDITORS = {
    "vscode": Editor("lrp.vsix", "Install it: `code --install-extension {file}`", _package),
}
"""By the name that ``lrp editor`` takes."""


def set_up(name: str, folder: Path) -> str:
    """Write the file of an editor into a folder; return what to do with it.

    Raises
    ------
    FileError
        There is such a file, which is not overwritten unless it is a package.
    """
    file, then, write = EDITORS[name]
    target = folder / file
    if target.exists() and target.suffix != ".vsix":
        raise FileError(f"`{shown(target)}` exists, and may have other settings. Name another folder.")
    folder.mkdir(parents=True, exist_ok=True)
    write(target, _command())
    return f"{shown(target)} is written. {then.format(file=shown(target))}"


def _command() -> str:
    """Return where `lrp` of this Python is."""
    beside = Path(sys.executable).with_name("lrp")
    return str(beside) if beside.exists() else shutil.which("lrp") or "lrp"

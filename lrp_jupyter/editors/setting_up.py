"""Setting up an editor: the files that it needs, and what the user does next."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

from lrp_jupyter.editors.vscode_package import write_vscode_package
from lrp_jupyter.errors import FileError
from lrp_jupyter.files import shown, write_file
from lrp_jupyter.process import PYTHON

_FOLDER = Path(__file__).parent


class EditorFile(NamedTuple):
    """The file that an editor needs, how it is written, given where `lrp` is, and what the user does then."""

    name: str
    write: Callable[[Path, str], None]
    then: str


def _package(file: Path, command: str) -> None:
    write_vscode_package(file, version("lrp-jupyter"), command)


def _settings(source: str) -> Callable[[Path, str], None]:
    """Return what writes a file of this folder in which `lrp` stands in double quotes once, to be found."""

    def write(file: Path, command: str) -> None:
        if file.exists():
            raise FileError(f"`{shown(file)}` exists, and is left as it is. Name another folder.")
        text = (_FOLDER / source).read_text("utf-8")
        write_file(file, text.replace('"lrp"', json.dumps(command, ensure_ascii=False), 1))

    return write


EDITORS = {
    "vscode": EditorFile("lrp.vsix", _package, "Install it: `code --install-extension {file}`"),
    "neovim": EditorFile(
        "lrp.lua", _settings("neovim/lrp.lua"), "Neovim reads it in `~/.config/nvim/after/plugin`."
    ),
    "helix": EditorFile(
        "languages.toml",
        _settings("helix/languages.toml"),
        "Helix reads `~/.config/helix/languages.toml`: put it there, or append it to yours.",
    ),
}
"""By the name that ``lrp editor`` takes."""


def set_up(name: str, folder: Path) -> str:
    """Write the file of an editor into a folder; return what to do with it.

    Raises
    ------
    FileError
        There are settings in that folder, which stay; or it cannot be written to.
    """
    file, write, then = EDITORS[name]
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / file
    write(target, _command())
    return f"{shown(target)} is written. {then.format(file=shown(target))}"


def _command() -> str:
    """Return where `lrp` of this Python is."""
    beside = Path(PYTHON).with_name("lrp")
    return str(beside) if beside.exists() else shutil.which("lrp") or "lrp"

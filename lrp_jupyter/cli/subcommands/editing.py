"""The commands for other editors."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from typer import Argument

from lrp_jupyter.cli.subcommands.application import command


class EditorName(StrEnum):
    """Editors that need a file."""

    vscode = "vscode"


@command()
def editor(
    name: Annotated[EditorName, Argument(metavar="NAME", help="`vscode`.")],
    folder: Annotated[Path, Argument(metavar="DIR", help="Folder of the file that is written.")] = Path(),
) -> None:
    """Set up an editor of your own for programs: write the file that it needs, and say what to do with it.

    **Exit code**: 0, or 2 when the file cannot be written.
    """
    from lrp_jupyter.editors.setting_up import set_up

    typer.echo(set_up(name.value, folder))

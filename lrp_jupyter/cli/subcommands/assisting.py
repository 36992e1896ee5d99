"""The commands for other editors: ``editor``, and ``language-server``, which they start."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from typer import Argument

from lrp_jupyter.cli.subcommands.application import BridgeOptions, CheckedBridge, command


class EditorName(StrEnum):
    """Editors that need a file."""

    vscode = "vscode"
    neovim = "neovim"
    helix = "helix"


@command()
def editor(
    name: Annotated[EditorName, Argument(help="The editor.")],
    folder: Annotated[Path, Argument(metavar="DIR", help="Folder of the file that is written.")] = Path(),
) -> None:
    """Set up an editor for programs: write the file that it needs, and say what to do with it.

    **Exit code**: 0, or 2 when the file cannot be written, or would replace settings of yours.
    """
    from lrp_jupyter.editors.setting_up import set_up

    typer.echo(set_up(name.value, folder))


@command("language-server")
def language_server(
    bridge: CheckedBridge = None,
    options: BridgeOptions = None,
) -> None:
    """Help an editor with programs: it starts this command, and talks to it over stdin and stdout.

    Findings with their fixes, completion, explanations, rename, format and more, in every editor that speaks
    the Language Server Protocol; and the values of a program that `lrp run --watch --socket` runs.
    """
    from lrp_jupyter.cli.language_server_command import serve_editor

    serve_editor(bridge, options or ())

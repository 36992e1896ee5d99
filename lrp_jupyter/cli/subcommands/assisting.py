"""The command that editors start: ``language-server``."""

from __future__ import annotations

from typing import Annotated

from typer import Option

from lrp_jupyter.cli import complete
from lrp_jupyter.cli.subcommands.application import BridgeOptions, command


@command("language-server")
def language_server(
    bridge: Annotated[
        str | None,
        Option(
            metavar="NAME",
            autocompletion=complete.bridges,
            help="Check for this robot: see `lrp bridges`. Default: the simulated one.",
        ),
    ] = None,
    options: BridgeOptions = None,
) -> None:
    """Help an editor with programs: it starts this command, and talks to it over stdin and stdout.

    Findings with their fixes, completion, explanations, rename, format and more, in every editor that speaks
    the Language Server Protocol; and the values of a program that `lrp run --watch --socket` runs.
    """
    from lrp_jupyter.cli.language_server_command import serve_editor

    serve_editor(bridge, options or ())

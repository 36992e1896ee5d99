"""The commands about the text of a program: ``check``, ``format`` and ``graph``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from lrp_jupyter.cli import complete
from lrp_jupyter.cli.subcommands.application import BridgeOptions, CheckedBridge, File, command


class Findings(StrEnum):
    """Output formats of ``lrp check``."""

    text = "text"
    json = "json"


class Drawing(StrEnum):
    """Output formats of ``lrp graph``."""

    svg = "svg"
    dot = "dot"
    mermaid = "mermaid"
    json = "json"


@command()
def check(
    files: Annotated[
        list[str],
        Argument(
            metavar="FILE…",
            help="Files, names of bundled programs, or `-` for stdin.",
            autocompletion=complete.sources,
        ),
    ],
    form: Annotated[
        Findings, Option("--format", help="Text for people or JSON for other programs.")
    ] = Findings.text,
    fix: Annotated[
        bool, Option("--fix", help="Apply every certain fix, write the files, and check again.")
    ] = False,
    bridge: CheckedBridge = None,
    options: BridgeOptions = None,
) -> None:
    """Check programs without running them.

    No robot is connected: `--bridge ros -o setup=robot.json` checks against what the set-up names.

    **Exit code**: 0 when there are no errors (there may be warnings and hints), 1 when there are, 2 when a
    file cannot be read or written.
    """
    from lrp_jupyter.cli.offline import check_files

    raise typer.Exit(check_files(files, form is Findings.json, fix, bridge, options or ()))


@command("format")
def format_(
    files: Annotated[
        list[str],
        Argument(
            metavar="FILE…",
            help="Files, or `-` to format stdin and print the result.",
            autocompletion=complete.sources,
        ),
    ],
    check: Annotated[
        bool, Option("--check", help="Write nothing; only list the files that would change.")
    ] = False,
) -> None:
    """Format the texts of programs: only white space changes.

    **Exit code**: 0, 1 when a text is not a valid program or, with `--check`, would change, 2 when a file
    cannot be read or written.
    """
    from lrp_jupyter.cli.offline import format_files

    raise typer.Exit(format_files(files, check))


@command()
def graph(
    file: File,
    machine: Annotated[
        str | None,
        Option(
            metavar="PATH",
            autocompletion=complete.machines,
            help="Draw one machine only: `follower/looking/lookalgo`.",
        ),
    ] = None,
    form: Annotated[
        Drawing | None, Option("--format", help="Default: by the output file's suffix, else `svg`.")
    ] = None,
    output: Annotated[
        Path | None, Option("--output", "-o", metavar="FILE", help="File to write. Default: stdout.")
    ] = None,
) -> None:
    """Draw the state machines of a program.

    **Exit code**: 0, 1 when the text is not a valid program, 2 when a file cannot be read or written.
    """
    from lrp_jupyter.cli.offline import draw_graph

    raise typer.Exit(draw_graph(file, machine, form.value if form else None, output))

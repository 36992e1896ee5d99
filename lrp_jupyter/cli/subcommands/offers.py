"""The commands that list and explain what there is: ``programs``, ``worlds``, ``bridges``, ``explain``."""

from __future__ import annotations

from typing import Annotated

from typer import Argument, Option

from lrp_jupyter.cli import complete
from lrp_jupyter.cli.subcommands.application import command


@command()
def programs(
    show: Annotated[
        str | None,
        Option(metavar="NAME", autocompletion=complete.bundled, help="Print the text of a program."),
    ] = None,
) -> None:
    """List the bundled programs."""
    from lrp_jupyter.cli.lists import list_programs

    list_programs(show)


@command()
def worlds(
    show: Annotated[
        str | None,
        Option(metavar="NAME|FILE", autocompletion=complete.worlds, help="Draw the map of a world."),
    ] = None,
    as_json: Annotated[
        str | None,
        Option(
            "--json",
            metavar="NAME|FILE",
            autocompletion=complete.worlds,
            help="Print a world as JSON, as a start for your own.",
        ),
    ] = None,
) -> None:
    """List the bundled worlds of the simulator."""
    from lrp_jupyter.cli.lists import list_worlds

    list_worlds(show or as_json, as_json is not None)


@command()
def bridges(
    name: Annotated[
        str | None,
        Argument(
            metavar="NAME|FILE.py", autocompletion=complete.bridges, help="List the options of this one."
        ),
    ] = None,
) -> None:
    """List the available robots, or the options of one."""
    from lrp_jupyter.cli.lists import list_bridges, list_options

    if name is None:
        list_bridges()
    else:
        list_options(name)


@command()
def explain(
    code: Annotated[
        str | None, Argument(metavar="CODE", help="`LRP301`, or another code.", autocompletion=complete.codes)
    ] = None,
) -> None:
    """Explain the code of a finding, an issue, a reason, a notice or an exit; without CODE, list them.

    **Exit code**: 0, or 2 when there is no such code.
    """
    from lrp_jupyter.cli.lists import explain_code

    explain_code(code)

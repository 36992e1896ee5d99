"""The commands that give out lab and lessons: ``lab``, ``sheets`` and ``site``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from lrp_jupyter.cli.subcommands.application import command


@command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def lab(
    ctx: typer.Context,
    folder: Annotated[
        Path, Option("--dir", metavar="FOLDER", help="Folder to copy the notebooks to.")
    ] = Path("lrp-notebooks"),
    browser: Annotated[bool, Option(help="Open a browser.")] = True,
) -> None:
    """Open JupyterLab on a copy of the notebooks, at the first one.

    Existing copies are never overwritten. Further options are passed to JupyterLab.
    """
    from lrp_jupyter.cli.lab_command import open_lab

    open_lab(folder.resolve(), browser, ctx.args)


@command()
def sheets(
    folder: Annotated[Path, Argument(metavar="DIR", help="Folder of the sheets; it is created.")],
    notebooks: Annotated[
        Path | None, Option(metavar="DIR", help="Notebooks of your own instead of those of the package.")
    ] = None,
    pdf: Annotated[
        bool, Option("--pdf", help="Print them to PDF, too, with Chromium or Chrome if one is installed.")
    ] = False,
) -> None:
    """Write a worksheet for each lesson, and cards for a lesson without computers, as pages to be printed.

    Each page needs no other file and no network: open it in a browser, and print it.
    """
    from lrp_jupyter.cli.lab_command import shipped_notebooks
    from lrp_jupyter.site.sheets import write_sheets

    written = write_sheets(notebooks or shipped_notebooks(), folder, pdf)
    typer.echo(f"{len(written)} sheets are in {folder}: {written[0].name} … {written[-1].name}")


@command()
def site(
    folder: Annotated[Path, Argument(metavar="DIR", help="Folder of the site; it is created.")],
    notebooks: Annotated[
        Path | None, Option(metavar="DIR", help="Notebooks of your own instead of those of the package.")
    ] = None,
    offline: Annotated[
        bool, Option("--offline", help="Include Python itself, so that no other address is needed.")
    ] = False,
    pyodide: Annotated[
        Path | None, Option(metavar="DIR", help="A folder with Pyodide, so that it need not be downloaded.")
    ] = None,
) -> None:
    """Build a web site of the lab and the notebooks that runs in the browser, without a server of its own.

    Any host of static pages can publish it; `python -m http.server --directory DIR` shows it here.
    """
    from tempfile import TemporaryDirectory

    from lrp_jupyter.cli.lab_command import copy_notebooks
    from lrp_jupyter.site.build import build_site

    with TemporaryDirectory(prefix="lrp-notebooks-") as own:
        if notebooks is None:
            copy_notebooks(Path(own))
        build_site(folder, notebooks or Path(own), offline=offline, pyodide=pyodide, say=typer.echo)
    typer.echo(
        f"The site is in {folder}. Try it: python -m http.server --bind 127.0.0.1 --directory {folder}"
    )

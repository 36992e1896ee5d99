"""Build a static site: a page with one lab, the notebooks, and all that they need to run in a browser."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from lrp_jupyter.errors import LRPError
from lrp_jupyter.site.notebooks import build_notebooks, check_installed, kernel_wheels
from lrp_jupyter.site.packages import collect
from lrp_jupyter.site.page import write_page
from lrp_jupyter.site.runtime import RUNTIME, Pyodide
from lrp_jupyter.site.wheel import pack


def build_site(
    folder: Path,
    notebooks: Path,
    *,
    offline: bool = False,
    pyodide: Path | None = None,
    say: Callable[[str], object] = lambda _: None,
) -> None:
    """Build the site in a folder; any web server, or a host of static pages, serves it from any address.

    `folder`: it is created, or replaced if it is a site already.
    `notebooks`: the folder of the notebooks.
    `offline`: whether Python itself is part of the site; otherwise browsers load it from where it is
        published.
    `pyodide`: a folder with files of Pyodide, instead of downloading them.
    `say`: called with a sentence about each step.
    Raises LRPError: something that is needed is not installed or cannot be downloaded, or the folder is not a
        site.
    """
    check_installed()
    if folder.exists() and any(folder.iterdir()) and not (folder / _MARK).is_file():
        raise LRPError(f"`{folder}` contains other files, which would be lost. Choose a new folder.")
    runtime = Pyodide(pyodide)
    folder.parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix=".lrp-site-", dir=folder.parent) as work:
        site = Path(work, "site")
        python = site / "python"
        python.mkdir(parents=True)
        say("Collecting the packages …")
        wheel = pack(Path(work))
        collect(
            runtime,
            [wheel, *kernel_wheels()],
            ["micropip", "ipython", "jedi", "comm", "networkx"],
            python,
            offline,
        )
        if offline:
            say("Copying Python …")
            runtime.copy(RUNTIME, python)
        write_page(site, wheel.name, offline)
        say("Building the notebooks …")
        build_notebooks(notebooks, site / "jupyter", offline)
        (site / _MARK).write_text("")
        shutil.rmtree(folder, ignore_errors=True)
        site.replace(folder)


_MARK = ".lrp-site"

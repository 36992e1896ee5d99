"""Build a static site: a page with one lab, the notebooks, and all that they need to run in a browser."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from lrp_jupyter import programs
from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading.challenges import challenges
from lrp_jupyter.site.lesson_pages import write_lessons
from lrp_jupyter.site.lessons import read_lessons
from lrp_jupyter.site.notebooks import build_notebooks, check_installed, kernel_wheels
from lrp_jupyter.site.packages import collect, pack
from lrp_jupyter.site.runtime import LOCK, RUNTIME, Pyodide

_MARK = ".lrp-site"
_STATIC = Path(__file__).parents[1] / "static"
_PACKAGES = ("lark", "pymunk")  # what the lab itself needs; what notebooks need besides is not loaded here


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
        names = ["micropip", "ipython", "jedi", "comm", "networkx"]
        collect(runtime, [wheel, *kernel_wheels()], names, python, offline)
        if offline:
            say("Copying Python …")
            runtime.copy(RUNTIME, python)
        version = _write_page(site, wheel.name, offline)
        write_lessons(read_lessons(notebooks), site, version)
        say("Building the notebooks …")
        build_notebooks(notebooks, site / "jupyter", offline)
        (site / _MARK).write_text("")
        shutil.rmtree(folder, ignore_errors=True)
        site.replace(folder)


def _write_page(site: Path, wheel: str, offline: bool) -> str:
    """Write the page into the folder of a site, whose packages are there already; return its version."""
    described = {
        "python": "python/" if offline else Pyodide.url,
        "lock": f"python/{LOCK}",
        "packages": _PACKAGES,
        "wheel": f"python/{wheel}",
        "programs": [
            {"name": name, "about": programs.heading(programs.load(name)).description}
            for name in programs.names()
        ],
        "challenges": [
            {"name": each.name, "task": each.assignment, "series": each.series} for each in challenges()
        ],
    }
    (site / "site.json").write_text(json.dumps(described), encoding="utf-8")
    for file in (_STATIC / "lab.js", _STATIC / "lab.css", *(_STATIC / "site").iterdir()):
        shutil.copyfile(file, site / file.name)
    version = _version(site)
    index = site / "index.html"
    index.write_text(index.read_text(encoding="utf-8").replace("VERSION", version), encoding="utf-8")
    return version


def _version(site: Path) -> str:
    """Return what changes whenever a file of the page, or a package, changes."""
    files = [file for file in sorted(site.iterdir()) if file.is_file()]
    content = b"".join(file.read_bytes() for file in [*files, site / "python" / LOCK])
    return hashlib.sha256(content).hexdigest()[:12]

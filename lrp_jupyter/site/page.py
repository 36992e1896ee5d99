"""The plain page of a site: one lab without a notebook, and what it has to know."""

from __future__ import annotations

import hashlib
import json
import shutil
from pathlib import Path

from lrp_jupyter import programs
from lrp_jupyter.grading.challenges import challenges
from lrp_jupyter.site.runtime import LOCK, Pyodide

_STATIC = Path(__file__).parents[1] / "static"
_PACKAGES = ("lark", "pymunk")
"""What the lab itself needs; what notebooks need besides is not loaded here."""


def write_page(site: Path, wheel: str, offline: bool) -> None:
    """Write the page into the folder of a site, whose packages are there already.

    `wheel`: the name of the wheel of this package.
    `offline`: whether Python itself is part of the site.
    """
    described = {
        "python": "python/" if offline else Pyodide.url,
        "lock": f"python/{LOCK}",
        "packages": _PACKAGES,
        "wheel": f"python/{wheel}",
        "programs": [
            {"name": name, "about": programs.heading(programs.load(name)).description}
            for name in programs.names()
        ],
        "challenges": [{"name": each.name, "task": each.task} for each in challenges()],
    }
    (site / "site.json").write_text(json.dumps(described), encoding="utf-8")
    for file in (_STATIC / "lab.js", _STATIC / "lab.css", *(_STATIC / "site").iterdir()):
        shutil.copyfile(file, site / file.name)
    index = site / "index.html"
    index.write_text(index.read_text(encoding="utf-8").replace("VERSION", _version(site)), encoding="utf-8")


def _version(site: Path) -> str:
    """Return what changes whenever a file of the page, or a package, changes."""
    files = [file for file in sorted(site.iterdir()) if file.is_file()]
    content = b"".join(file.read_bytes() for file in [*files, site / "python" / LOCK])
    return hashlib.sha256(content).hexdigest()[:12]

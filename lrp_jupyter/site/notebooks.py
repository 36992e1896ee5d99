"""The notebooks of a site: JupyterLite, which runs JupyterLab and its kernels in the browser."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from lrp_jupyter.errors import LRPError
from lrp_jupyter.process import python_of
from lrp_jupyter.site.runtime import LOCK, Pyodide

STORAGE = "lrp-notebooks"  # of the notebooks in a browser; the plain page writes notebooks into it, too
_KERNEL = "@jupyterlite/pyodide-kernel-extension"
_PRELOADED = ("micropip", "piplite", "ipykernel", "comm", "pyodide-kernel", "jedi", "ipython", "lrp-jupyter")


def check_installed() -> None:
    """Raise LRPError if JupyterLite is not installed."""
    if find_spec("jupyterlite_core") is None or find_spec("jupyterlite_pyodide_kernel") is None:
        raise LRPError('JupyterLite is not installed. Install it with `pip install "lrp-jupyter[site]"`.')


def kernel_wheels() -> list[Path]:
    """Return the wheels that the kernel of JupyterLite brings along."""
    for prefix in (sys.prefix, sys.base_prefix):
        folder = Path(prefix) / "share/jupyter/labextensions" / _KERNEL / "static/pypi"
        if folder.is_dir():
            return [
                wheel for wheel in sorted(folder.glob("*.whl")) if "widgetsnbextension-3" not in wheel.name
            ]
    raise LRPError("The kernel of JupyterLite is not complete. Install `jupyterlite-pyodide-kernel` again.")


def build_notebooks(notebooks: Path, folder: Path, offline: bool) -> None:
    """Build JupyterLite with the notebooks of a folder; Python is in the folder ``python`` beside it.

    Raises LRPError: JupyterLite cannot be built; its last words are the message.
    """
    settings = {
        "pyodideUrl": "./../python/pyodide.mjs" if offline else f"{Pyodide.url}pyodide.mjs",
        "loadPyodideOptions": {"lockFileURL": f"../python/{LOCK}", "packages": list(_PRELOADED)},
        "disablePyPIFallback": offline,
    }
    config = {
        "jupyter-lite-schema-version": 0,
        "jupyter-config-data": {
            "appName": "LRP",
            "contentsStorageName": STORAGE,
            "litePluginSettings": {f"{_KERNEL}:kernel": settings},
        },
    }
    with TemporaryDirectory(prefix="lrp-site-") as work:
        Path(work, "jupyter-lite.json").write_text(json.dumps(config), encoding="utf-8")
        copy_for_students(notebooks, Path(work, "files"))
        folders = ["--lite-dir", work, "--output-dir", str(folder.resolve())]
        options = ["--no-libarchive", "--no-sourcemaps", "--no-unused-shared-packages"]
        build = python_of("jupyterlite_core", "build", *folders, *options)
        done = subprocess.run(**build, cwd=work, capture_output=True, text=True, check=False)
    if done.returncode:
        raise LRPError(f"JupyterLite cannot be built: {(done.stderr or done.stdout).strip()[-800:]}")


def copy_for_students(notebooks: Path, folder: Path) -> None:
    """Copy notebooks to a new folder, for the kernel of JupyterLite; without what only teachers need."""
    shutil.copytree(notebooks, folder, ignore=shutil.ignore_patterns(".*", "teachers"))
    for notebook in folder.rglob("*.ipynb"):
        notebook.write_text(for_the_browser(notebook.read_text(encoding="utf-8")), encoding="utf-8")


def for_the_browser(notebook: str) -> str:
    """Return a notebook that asks for the kernel that JupyterLite has."""
    content = json.loads(notebook)
    content["metadata"]["kernelspec"] = {
        "display_name": "Python (Pyodide)",
        "language": "python",
        "name": "python",
    }
    return json.dumps(content, ensure_ascii=False, indent=1) + "\n"

"""``lrp lab``: JupyterLab on a copy of the notebooks that came with the package."""

from __future__ import annotations

import os
import shutil
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import typer

from lrp_jupyter.errors import LRPError

__all__ = ["copy_notebooks", "open_lab", "send_at_once", "shipped_notebooks"]

FIRST = "00-hello-live-robot.ipynb"


def shipped_notebooks() -> Path:
    """Find the folder of notebooks: in the wheel, or in the checkout of who works on the package."""
    package = Path(__file__).parent.parent
    for folder in (package / "notebooks", package.parent / "notebooks"):
        if (folder / FIRST).is_file():
            return folder
    raise LRPError("the notebooks did not come with this installation; install the package again")


def copy_notebooks(folder: Path) -> list[Path]:
    """Copy the notebooks and their pictures to a folder; what stands there already is left alone.

    Returns
    -------
    list of Path
        The copies made now.
    """
    copied = []
    source = shipped_notebooks()
    for file in sorted(source.rglob("*")):
        target = folder / file.relative_to(source)
        if file.suffix in (".ipynb", ".svg", ".png", ".json") and not target.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, target)
            copied.append(target)
    return copied


def open_lab(folder: Path, browser: bool, options: list[str]) -> None:
    """Run JupyterLab in this process until it is stopped.

    Raises
    ------
    LRPError
        JupyterLab is not installed, or the folder cannot be written.
    """
    if find_spec("jupyterlab") is None:
        raise LRPError('JupyterLab is not installed; `pip install "lrp-jupyter[lab]"` brings it')
    copied = copy_notebooks(folder)
    typer.echo(
        f"{len(copied)} files copied to {folder}" if copied else f"the notebooks are in {folder} already"
    )
    arguments = [f"--ServerApp.root_dir={folder}", f"--LabApp.default_url=/lab/tree/{FIRST}", *options]
    if not browser:
        arguments.append("--no-browser")
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        arguments.append("--allow-root")
    from jupyterlab.labapp import main

    send_at_once()
    main(arguments)


def send_at_once() -> None:
    """Have a Jupyter server of this process send each message of a kernel at once.

    It leaves Nagle's algorithm on, which adds tens of milliseconds to every answer of a lab.
    """
    from jupyter_server.services.kernels.websocket import KernelWebsocketHandler

    opened: Any = KernelWebsocketHandler.open

    async def open_at_once(self: Any, *arguments: str, **options: str) -> None:
        self.set_nodelay(True)
        await opened(self, *arguments, **options)

    KernelWebsocketHandler.open = open_at_once  # type: ignore[method-assign]

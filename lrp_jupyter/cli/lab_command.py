"""``lrp lab``: JupyterLab on a copy of the notebooks shipped with the package."""

from __future__ import annotations

import json
import os
import shutil
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import typer

from lrp_jupyter.errors import LRPError
from lrp_jupyter.files import write_file

FIRST = "00-hello-live-robot.ipynb"

_WORKSPACE = "lrp"
_SETTINGS = Path(__file__).with_name("jupyter")


def shipped_notebooks() -> Path:
    """Return the folder of the notebooks: in the installed package, or beside it in a checkout."""
    package = Path(__file__).parent.parent
    for folder in (package / "notebooks", package.parent / "notebooks"):
        if (folder / FIRST).is_file():
            return folder
    raise LRPError("This installation has no notebooks. Install the package again.")


def copy_notebooks(folder: Path) -> list[Path]:
    """Copy notebooks, pictures and example bridges to a folder, unless they exist; return the copies."""
    copied = []
    source = shipped_notebooks()
    for file in sorted(source.rglob("*")):
        target = folder / file.relative_to(source)
        wanted = file.suffix in (".ipynb", ".svg", ".png", ".json") or file.match("bridges/*.py")
        if wanted and not os.path.lexists(target):
            target.parent.mkdir(parents=True, exist_ok=True)
            if file.suffix == ".ipynb":
                write_file(target, _as_saved(file))
            else:
                shutil.copyfile(file, target)
            copied.append(target)
    return copied


def _as_saved(file: Path) -> str:
    """Return a notebook with the language of this kernel: Jupyter would write it, and call that a change."""
    notebook = json.loads(file.read_text("utf-8"))
    with suppress(ImportError):
        from ipykernel.ipkernel import IPythonKernel

        notebook["metadata"]["language_info"] = IPythonKernel.language_info
    return json.dumps(notebook, ensure_ascii=False, indent=1) + "\n"


def sign_notebooks() -> None:
    """Make Jupyter trust the notebooks of the package, so that their stored pictures are shown.

    A signature is that of a content: a copy that was changed is not trusted.
    """
    import nbformat
    from nbformat.sign import NotebookNotary

    notary: Any = NotebookNotary()  # type: ignore[no-untyped-call]
    for file in shipped_notebooks().rglob("*.ipynb"):
        notary.sign(nbformat.reads(_as_saved(file), as_version=4))  # type: ignore[no-untyped-call]


def fold_side_bar() -> None:
    """Create a workspace whose side bar is folded, which leaves its width to the lab, unless it exists."""
    from jupyterlab.commands import get_workspaces_dir
    from jupyterlab_server.workspaces_handler import WorkspacesManager

    workspaces = WorkspacesManager(get_workspaces_dir())
    with suppress(OSError, ValueError):  # unwritable or damaged: then the bar is as JupyterLab shows it
        if not workspaces.load(_WORKSPACE)["data"]:
            layout = {"layout-restorer:data": {"left": {"collapsed": True}}}
            workspaces.save(_WORKSPACE, json.dumps({"data": layout, "metadata": {"id": _WORKSPACE}}))


def use_settings() -> None:
    """Add this package's defaults to JupyterLab's: no question about news. The user's settings come first."""
    given = os.environ.get("JUPYTER_CONFIG_PATH")
    os.environ["JUPYTER_CONFIG_PATH"] = os.pathsep.join(filter(None, [given, str(_SETTINGS)]))


def open_lab(folder: Path, browser: bool, options: list[str]) -> None:
    """Run JupyterLab in this process until it is stopped."""
    if find_spec("jupyterlab") is None:
        raise LRPError('JupyterLab is not installed. Install it with `pip install "lrp-jupyter[lab]"`.')
    if folder.exists() and not folder.is_dir():
        raise LRPError(f"`{folder}` is a file, and the notebooks need a folder. Choose another with `--dir`.")
    copied = copy_notebooks(folder)
    typer.echo(
        f"{len(copied)} files copied to {folder}." if copied else f"The notebooks are in {folder} already."
    )
    sign_notebooks()
    fold_side_bar()
    use_settings()
    url = f"/lab/workspaces/{_WORKSPACE}/tree/{FIRST}"
    arguments = [f"--ServerApp.root_dir={folder}", f"--LabApp.default_url={url}", *options]
    if not browser:
        arguments.append("--no-browser")
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        arguments.append("--allow-root")
    from jupyterlab.labapp import main

    send_at_once()
    main(arguments)


def send_at_once() -> None:
    """Disable Nagle's algorithm on the kernel websockets of a Jupyter server in this process.

    The server leaves it on, which adds tens of milliseconds to every reply to a lab.
    """
    from jupyter_server.services.kernels.websocket import KernelWebsocketHandler

    opened: Any = KernelWebsocketHandler.open

    async def open_at_once(self: Any, *arguments: str, **options: str) -> None:
        self.set_nodelay(True)
        await opened(self, *arguments, **options)

    KernelWebsocketHandler.open = open_at_once  # type: ignore[method-assign]

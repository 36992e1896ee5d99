"""Decide where the texts of a program are kept: ``LRP_KEEP``.

============ =============================================================================================
``notebook`` in the folder ``.lrp`` beside the notebook, for all who open it there
``user``     in the state folder of the user who runs the kernel, separately for each folder of notebooks
``nothing``  in memory: they end with the kernel
============ =============================================================================================

Without ``LRP_KEEP``, texts are kept beside the notebook, with two exceptions, in which strangers may open the
same folder. Under Voila nothing is kept, so that no visitor gets the text of another. On a JupyterHub, texts
are kept for the user if the folder is in the user's home, and not at all elsewhere. A home there may contain
shared folders, and a kernel cannot see which ones are shared.

Programs of one name in one folder are one program, whichever notebook opens them. The kernel knows the name
of its notebook from some servers only, and as it was when the kernel started: one that is renamed would
lose its text. Where two notebooks differ, the lab asks which text to keep.
"""

from __future__ import annotations

import os
from pathlib import Path

from lrp_jupyter.errors import LRPError
from lrp_jupyter.files import shown
from lrp_jupyter.own import digest, state_folder
from lrp_jupyter.widgets.hosts import is_hub, is_voila
from lrp_jupyter.widgets.text.kept import FOLDER, Kept

WAYS = ("notebook", "user", "nothing")
"""The values of ``LRP_KEEP``."""


def kept_texts(folder: str | os.PathLike[str], name: str) -> Kept | None:
    """Return the files in which the texts of a program are kept; None if nothing is kept."""
    folder = Path(folder)
    way = os.environ.get("LRP_KEEP") or _default(folder)
    if way not in WAYS:
        raise LRPError(
            f"`LRP_KEEP` says where typed texts are kept, and `{shown(way)}` is not a place for them. "
            "Set it to `notebook`, `user` or `nothing`."
        )
    if way == "nothing":
        return None
    if way == "notebook":
        return Kept(folder / FOLDER, name)
    state = state_folder()
    if state is None:
        raise LRPError(
            "`LRP_KEEP` is `user`, but this user has no home folder in which texts could be kept. "
            "Set it to `notebook` or `nothing`."
        )
    return Kept(state / "texts" / digest(os.path.realpath(folder))[:32], name)


def _default(folder: Path) -> str:
    if is_voila():
        return "nothing"
    if is_hub():
        return "user" if _is_in_home(folder) else "nothing"
    return "notebook"


def _is_in_home(folder: Path) -> bool:
    try:
        return Path(os.path.realpath(folder)).is_relative_to(os.path.realpath(Path.home()))
    except RuntimeError:  # a user without a home
        return False

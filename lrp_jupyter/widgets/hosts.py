"""The program that started this kernel, and what it can show, from the environment and the running cell."""

from __future__ import annotations

import os
import sys
from typing import Any

from lrp_jupyter.errors import LRPError
from lrp_jupyter.files import shown


def is_voila() -> bool:
    """Return whether Voila started this kernel: for a visitor, or in advance (then it names no server)."""
    return os.environ.get("SERVER_SOFTWARE", "").startswith("voila/") or "VOILA_PREHEAT" in os.environ


def is_hub() -> bool:
    """Return whether this kernel belongs to a server that JupyterHub has started for one of its users."""
    return "JUPYTERHUB_USER" in os.environ


def debugger() -> str:
    """Return the beginning of the command that debugs an issue in a cell; empty where there are no cells."""
    if not sys.modules.get("IPython"):  # the page of a site has none
        return ""
    from IPython.core.getipython import get_ipython

    shell: Any = get_ipython()
    if shell is None or is_voila():
        return ""
    return "%lrp debug" if shell.find_line_magic("lrp") else "%load_ext lrp_jupyter\n%lrp debug"


def by_hand(name: str) -> str:
    """Return what to do, in words, where a page cannot write the text into the notebook; or an empty text."""
    if not sys.modules.get("IPython"):  # the page of a site has no notebook
        return ""
    marimo: Any = sys.modules.get("marimo")
    if is_voila() or (marimo is not None and marimo.running_in_notebook()):
        return "Save… in the menu More writes it to a file."
    return f"Run `%lrp save {name}` in a cell: it writes the text into a new one."


def is_static() -> bool:
    """Return whether the outputs of the running cell are only stored, and so pictures instead of widgets.

    Unless ``LRP_STATIC`` decides, it is detected: a client that does not answer ``input()`` has no page. Such
    a client is nbclient, with which nbconvert, papermill, nbmake, jupytext and Quarto execute notebooks.
    Voila uses it as well, but has pages.
    """
    wanted = os.environ.get("LRP_STATIC", "")
    if wanted not in ("", "0", "1"):
        raise LRPError(
            f"`LRP_STATIC` says whether a lab is stored as a picture, and `{shown(wanted)}` does not answer "
            "that. Set it to `1` or `0`."
        )
    return wanted == "1" if wanted else _is_unattended() and not is_voila()


def _is_unattended() -> bool:
    """Return whether the cell that runs was sent by a client that answers no ``input()``."""
    from IPython.core.getipython import get_ipython

    kernel: Any = getattr(get_ipython(), "kernel", None)
    message = kernel.get_parent() if hasattr(kernel, "get_parent") else None
    if not isinstance(message, dict) or message.get("header", {}).get("msg_type") != "execute_request":
        return False
    return message["content"].get("allow_stdin") is False

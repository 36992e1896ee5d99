"""What the environment of a kernel says about who started it.

JupyterLab, Notebook and VS Code run a kernel for one person. Voila starts one for every visitor of a
notebook; JupyterHub runs a server, and with it kernels, for every user that has logged in.
"""

from __future__ import annotations

import os

__all__ = ["is_hub", "is_voila"]


def is_voila() -> bool:
    """Return whether Voila started this kernel: for a visitor, or in advance (then it names no server)."""
    return os.environ.get("SERVER_SOFTWARE", "").startswith("voila/") or "VOILA_PREHEAT" in os.environ


def is_hub() -> bool:
    """Return whether this kernel belongs to a server that JupyterHub has started for one of its users."""
    return "JUPYTERHUB_USER" in os.environ

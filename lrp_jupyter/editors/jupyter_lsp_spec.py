"""The language server as jupyter-lsp finds it, by the entry point group ``jupyter_lsp_spec_v1``."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

from lrp_jupyter.process import PYTHON


def spec(_: object) -> dict[str, dict[str, Any]]:
    """Return the server, if it can be started."""
    if find_spec("pygls") is None:
        return {}
    return {
        "lrp": {
            "argv": [PYTHON, "-P", "-m", "lrp_jupyter", "language-server"],
            "languages": ["lrp"],
            "version": 2,
            "mime_types": ["text/x-lrp"],
            "display_name": "LRP",
            "requires_documents_on_disk": False,
        }
    }

"""The command line: ``lrp run | check | format | graph | grade | sweep`` and lists of what can be chosen.

A usage error or a fault in the user's files is one sentence on stderr and a documented exit code; a
traceback means a fault of this package. What a command needs is imported when it is called, so that
``lrp check`` does not wait for a physics engine.
"""

from __future__ import annotations

import io
import sys

from lrp_jupyter.cli.command_line import app
from lrp_jupyter.cli.console import Colours

__all__ = ["app", "main"]


def main() -> None:
    """Run the command given by the arguments of the process."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without `→` shows `?`
            if stream.isatty():
                setattr(sys, name, Colours(stream))
    app(prog_name="lrp")

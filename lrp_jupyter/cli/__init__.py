"""The command line: ``lrp run | check | graph | grade`` and lists of what there is.

Errors of usage and faults of a person's files are one sentence on stderr and a documented exit
code; a traceback means a fault of this package. Each command is a module, imported when it is
called, so that ``lrp check`` does not wait for a physics engine.
"""

from __future__ import annotations

import io
import sys

from lrp_jupyter.cli.commands import app

__all__ = ["app", "main"]


def main() -> None:
    """Run the command that the arguments of the process name."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without `→` shows `?`
    app(prog_name="lrp")

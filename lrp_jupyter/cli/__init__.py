"""The command line: ``lrp run | check | format | graph | grade | sweep`` and lists of what can be chosen.

A usage error or a fault in the user's files is one sentence on stderr and a documented exit code; a
traceback means a fault of this package. What a command needs is imported when it is called, so that
``lrp check`` does not wait for a physics engine.
"""

from __future__ import annotations

import io
import sys

from lrp_jupyter.cli.commands import app

__all__ = ["app", "main"]


def main() -> None:
    """Run the command given by the arguments of the process."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without `→` shows `?`
    app(prog_name="lrp")

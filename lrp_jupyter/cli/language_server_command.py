"""``lrp language-server``: serves an editor over stdin and stdout."""

from __future__ import annotations

import gc
import signal
import sys
from collections.abc import Sequence
from importlib.util import find_spec

import typer

from lrp_jupyter.bridges.discovery import choose_bridge, make_bridge
from lrp_jupyter.cli.run_options import pairs_of
from lrp_jupyter.errors import LRPError


def serve_editor(bridge: str | None, options: Sequence[str]) -> None:
    """Serve until the editor ends it. `options`: of the bridge, ``KEY=VALUE``."""
    if options and bridge is None:
        raise typer.BadParameter("--option is for a robot. Name it, as in `--bridge ros`.")
    if find_spec("pygls") is None:
        raise LRPError(
            'The language server needs pygls. Install it with `pip install "lrp-jupyter[editors]"`.'
        )
    from lrp_jupyter.editors.checked_robot import described
    from lrp_jupyter.editors.language_server import language_server

    robot = None
    if bridge is not None:
        made = make_bridge(choose_bridge(bridge), **dict(pairs_of(options, "--option")))
        made.alone = True
        robot = described(made)
    server = language_server(robot)
    if sys.stdin.isatty():
        typer.echo("This command is started by an editor, which talks to it. Ctrl-C ends it.", err=True)
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # at once: a thread waits for input
    gc.freeze()  # a full collection would take longer than a check, between a key and what is found
    gc.set_threshold(50_000, 20, 100)
    server.start_io()

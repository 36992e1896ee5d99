"""The lab in a web page without a notebook: Python runs in a worker of the page, and they exchange JSON.

The page shows one program at a time. Texts are kept in the folder of the worker, which the browser stores
for the page: nothing leaves the browser.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from lrp_jupyter import programs
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.sim.worlds import BUNDLED
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.wire.packing import packed

SendText = Callable[[str, "list[bytes]"], None]
"""Sends a message, as JSON, and its buffers to the page."""


class Opened:
    """The program that the page shows."""

    def __init__(self, connection: PageConnection, send: SendText) -> None:
        self._connection = connection
        self._send = send
        self._stored = asyncio.Event()

    def receive(self, message: str) -> None:
        """Handle a message of the page, in JSON; then the page says when what it has changed is `stored`."""
        self._stored.clear()
        if self._connection.goal is not None:
            self._connection.goal.stored = self._stored.wait
        self._connection.receive(self._pass, json.loads(message))

    def stored(self) -> None:
        """Note that the browser has stored what the last message has changed."""
        self._stored.set()

    def _pass(self, message: Any, buffers: list[bytes] | None) -> None:
        self._send(packed(message), buffers or [])

    def shared(self) -> str:
        """Return the name of the program, its text, the world of its robot and its challenge, as JSON."""
        bridge, goal = self._connection.session.bridge, self._connection.goal
        world = bridge.world.name if isinstance(bridge, SimBridge) else "none"
        return json.dumps(
            {
                "program": self._connection.name,
                "text": self._connection.texts.text,
                "world": world if world in (*BUNDLED, "none") and goal is None else "",
                "challenge": "" if goal is None else goal.task.name,
            }
        )

    def close(self) -> None:
        """Stop the program."""
        registry.forget(self._connection)


def open_program(wanted: str, send: SendText) -> Opened:
    """Open the program that an object in JSON names, from the address of the page.

    Its ``program`` is a name; it may have a ``text``, a ``world`` and a ``challenge``. With ``again`` the
    text that was kept here continues, as expected of a page that is loaded again. With ``hung`` it does not
    run until the user starts it. A lesson names a ``bridge``, a ``folder`` in which texts are kept, and a
    ``setup``, Python that defines what the program needs.
    """
    address: dict[str, Any] = json.loads(wanted)
    names: dict[str, Any] = {}
    if address.get("setup"):
        names["__name__"] = "__main__"  # as in a notebook
        exec(address["setup"], names)
    folder = Path(address.get("folder") or ".")
    folder.mkdir(parents=True, exist_ok=True)
    text: str = address.get("text") or ""
    task = challenge(address["challenge"]) if address.get("challenge") else None
    name: str = address.get("program") or ("follower" if task is None else task.name.replace(" ", "-"))
    if text:
        start = text
    elif task is not None:
        start = task.beginning
    else:
        start = programs.load(name)
    world = address.get("world") or programs.world_of(start, None)
    robot: dict[str, Any] = {"task": task}
    if task is None:
        robot = {"bridge": address["bridge"]} if address.get("bridge") else registry.robot_for(world)
    given = None if address.get("again") or not text else text
    reason = _HUNG if address.get("hung") else ""
    connection = registry.open_program(
        name, given, namespace=names, folder=folder, paused=reason, given_in="link", **robot
    )
    if not connection.texts.text.strip():  # nothing was kept
        connection.texts.write(start)
    return Opened(connection, send)


_HUNG = "Python did not answer and was started again. Correct what did not return, then run the program."

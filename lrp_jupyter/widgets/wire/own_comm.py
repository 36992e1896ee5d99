"""The comm of a lab, which does not interfere with cells.

A kernel treats a message to a widget like a cell: it calls the functions registered to run before and after
cells. After a cell, matplotlib shows all figures and closes them, so figures that another cell is drawing
would be lost. The kernel also handles the answer of a page where the widget last sent a message, which may be
behind a running cell. A lab is not a cell, sends messages all the time, and must be reachable meanwhile.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import comm
from comm.base_comm import BaseComm


class OwnComm:
    """Stands in for the comm that a kernel has opened: messages arrive unchanged, where they were sent."""

    def __init__(self, opened: BaseComm) -> None:
        self.comm_id = opened.comm_id
        self.send = opened.send
        self.close = opened.close
        self.on_close = opened.on_close
        self.handle_close = opened.handle_close
        self.handle_msg: Callable[[Any], None] = opened.handle_msg
        comm.get_comm_manager().register_comm(self)  # type: ignore[arg-type]

    def on_msg(self, callback: Callable[[Any], None]) -> None:
        """Set the function that handles messages."""
        self.handle_msg = callback

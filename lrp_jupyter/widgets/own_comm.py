"""The comm of a lab, which leaves the cells alone.

A kernel treats what a page sends to a widget as if it were a cell: it runs what is registered to run before
and after cells. After a cell, matplotlib shows all figures and closes them: those that another cell is just
drawing would be shown nowhere. It also handles an answer of a page where the widget has spoken last, which
may be behind a cell that runs. A lab is no cell, speaks all the time, and is to be reached while one runs.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import comm
from comm.base_comm import BaseComm


class OwnComm:
    """Stands in for the comm that a kernel has opened: messages come as they are, where they were sent."""

    def __init__(self, opened: BaseComm) -> None:
        self.comm_id = opened.comm_id
        self.send = opened.send
        self.close = opened.close
        self.on_close = opened.on_close
        self.handle_close = opened.handle_close
        self.handle_msg: Callable[[Any], None] = opened.handle_msg
        comm.get_comm_manager().register_comm(self)  # type: ignore[arg-type]

    def on_msg(self, callback: Callable[[Any], None]) -> None:
        """Handle messages by a function."""
        self.handle_msg = callback

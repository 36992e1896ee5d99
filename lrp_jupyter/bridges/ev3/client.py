"""The client of a Lego EV3 brick: every call ends in time, with a result or a `BridgeError`.

It sends and receives frames (:mod:`~lrp_jupyter.bridges.ev3.protocol`) on any line: WiFi, Bluetooth or USB.

A connection that fails once is lost for good. It is cut, not closed, so that nothing still under way reaches
the brick later, if the line can do that. Connect again for another one.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from functools import partial
from typing import NoReturn, TypeVar

from lrp_jupyter.bridges.ev3.lines import Line, reason
from lrp_jupyter.bridges.ev3.protocol import BrickReply, frame, split_replies
from lrp_jupyter.errors import BridgeError

ANSWER_TIME = 0.5
"""Seconds in which a brick must answer, or the connection is lost."""

Code = bytes | Callable[[], bytes]
"""A byte code, or a function that returns it.

The function is called when the frame is about to be sent, one at a time for a connection: frames leave in the
order in which their codes were made. Nothing is sent where it returns no code.
"""

_Value = TypeVar("_Value")


class BrickClient:
    """One connection to a brick, on a line which it closes. Any thread may call any method."""

    def __init__(self, line: Line) -> None:
        self._line = line
        self.place, self.serial = line.place, line.serial
        self.lost = ""  # why, a sentence; empty while connected
        self._sending = threading.Lock()  # held while the bytes of one frame go out
        self._asking = threading.Lock()  # held from a question to its answer
        self._counter = 0
        self._received = b""

    def command(self, code: Code, timeout: float = ANSWER_TIME) -> None:
        """Send a byte code, within `timeout` seconds, without waiting for the brick to perform it."""
        self._send(code, 0, False, time.monotonic() + timeout)

    def request(self, code: Code, size: int, timeout: float = ANSWER_TIME) -> bytes:
        """Send a byte code and return its answer of `size` bytes; a brick that refuses it stays connected."""
        deadline = time.monotonic() + timeout
        if not self._asking.acquire(timeout=timeout):
            raise BridgeError("The brick is still busy with another request.")
        try:
            counter = self._send(code, size, True, deadline)
            while True:
                for reply in self._receive(deadline):
                    if reply.counter == counter:  # others were given up
                        if not reply.ok:
                            raise BridgeError("The brick refused a command.")
                        return reply.data
        finally:
            self._asking.release()

    def lose(self, why: str) -> NoReturn:
        """Mark the connection as lost and raise a BridgeError; all waiting callers get the same one."""
        self.lost = self.lost or why
        self._line.cut()
        raise BridgeError(self.lost)

    def close(self) -> None:
        """Close the line. What was sent still arrives, unless the connection was lost."""
        self.lost = self.lost or "The connection is closed."
        free = self._sending.acquire(timeout=ANSWER_TIME)
        self._line.close()
        if free:
            self._sending.release()

    def _send(self, code: Code, size: int, reply: bool, deadline: float) -> int:
        if not self._sending.acquire(timeout=max(0.0, deadline - time.monotonic())):
            self.lose("The brick accepts no more commands.")
        try:
            made = code() if callable(code) else code
            if made:
                self._counter = self._counter % 0xFFFF + 1
                self._send_bytes(frame(self._counter, made, size, reply), deadline)
            return self._counter
        finally:
            self._sending.release()

    def _send_bytes(self, data: bytes, deadline: float) -> None:
        while data:
            sent = self._wait(partial(self._line.send, data), deadline, "accepts no commands")
            data = data[sent:]

    def _receive(self, deadline: float) -> list[BrickReply]:
        while True:
            try:
                replies, self._received = split_replies(self._received)
            except BridgeError as error:
                self.lose(str(error))
            if replies:
                return replies
            data = self._wait(self._line.receive, deadline, "does not answer")
            if not data:
                self.lose("The brick closed the connection.")
            self._received += data

    def _wait(self, act: Callable[[], _Value], deadline: float, complaint: str) -> _Value:
        while True:
            if self.lost:
                raise BridgeError(self.lost)
            try:
                return act()
            except TimeoutError:
                if time.monotonic() >= deadline:
                    self.lose(f"The brick {complaint}.")
            except OSError as error:
                self.lose(f"The connection to the brick broke: {reason(error)}.")

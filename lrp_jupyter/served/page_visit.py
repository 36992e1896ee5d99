"""A page that has shown the token, and its WebSocket: messages of the lab in both directions.

Buffers of a message come before it, each as a message of its own in bytes.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Sequence
from contextlib import suppress
from enum import IntEnum
from typing import Any

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from lrp_jupyter.served.allowance import Allowance
from lrp_jupyter.served.served_program import ServedProgram
from lrp_jupyter.widgets.wire.packing import packed

LARGEST = 1_000_000
"""Bytes of a message of a page."""
_MESSAGES = 300.0, 1200.0  # of a page: a second, and at once
_BYTES = 1.0 * LARGEST, 2.0 * LARGEST
_MOST_WAITING = 16_000_000  # bytes that wait to be sent to a page
_MOST_VIEWS = 8
_LOST = 3.0  # s of silence after which a view may come back over another connection
_LONGEST_NAME = 100  # of a view


class Closing(IntEnum):
    """Why this side closes a WebSocket; the page has a sentence for each."""

    STRANGE = 4400
    NO_TOKEN = 4401
    TOO_MUCH = 4408
    ENDED = 4410
    FULL = 4503


class PageVisit:
    """See the module's docstring. `owners`: which page has which view; one that comes back takes its own."""

    def __init__(
        self, socket: ServerConnection, program: ServedProgram, owners: dict[str, PageVisit], about: Any
    ) -> None:
        self._socket = socket
        self._program = program
        self._owners = owners
        self._loop = asyncio.get_running_loop()
        self._waiting: asyncio.Queue[str | bytes] = asyncio.Queue()
        self._size = 0  # of what waits
        self._heard = self._loop.time()
        self._messages, self._bytes = Allowance(*_MESSAGES), Allowance(*_BYTES)
        self._put(packed(about), ())

    async def run(self) -> None:
        """Pass messages on until the page goes, or does what no page does."""
        sending = asyncio.create_task(self._deliver())
        try:
            async for message in self._socket:
                reason = self._refusal(message) or self._receive(message)
                if reason is not None:
                    await self._socket.close(reason)
                    return
        except ConnectionClosed:
            pass
        finally:
            sending.cancel()
            for view in self._views():
                del self._owners[view]
                self._program.receive(_nowhere, {"type": "bye", "view": view})

    async def end(self) -> None:
        """Send what waits, and close: the run has ended."""
        with suppress(TimeoutError):
            await asyncio.wait_for(self._waiting.join(), 1)
        await self._socket.close(Closing.ENDED)

    def _views(self) -> list[str]:
        return [view for view, owner in self._owners.items() if owner is self]

    def _refusal(self, message: str | bytes) -> Closing | None:
        """Return why a message is too much."""
        may_come, may_weigh = self._messages.take(), self._bytes.take(len(message))
        return None if may_come and may_weigh else Closing.TOO_MUCH

    def _receive(self, message: str | bytes) -> Closing | None:
        """Pass a message on; return why it cannot be one of a page."""
        try:
            content = json.loads(message) if isinstance(message, str) else None
        except (ValueError, RecursionError):
            content = None
        if not isinstance(content, dict):
            return Closing.STRANGE
        view = content.get("view")
        if not (isinstance(view, str) and len(view) <= _LONGEST_NAME):
            return Closing.STRANGE
        self._heard = self._loop.time()
        owner = self._owners.get(view, self)
        if content.get("type") == "hello" and (owner is self or self._heard - owner._heard > _LOST):
            self._owners[view] = owner = self
            if len(self._views()) > _MOST_VIEWS:
                return Closing.STRANGE
        if owner is self:  # also of a view that was forgotten: stop means stop
            self._program.receive(self._send, content)
        return None

    def _send(self, message: Any, buffers: list[bytes] | None) -> None:
        """Have a message sent, from any thread; one that has no page any more is none."""
        text = packed(message)
        with suppress(RuntimeError):  # the server has ended
            self._loop.call_soon_threadsafe(self._put, text, buffers or ())

    def _put(self, text: str, buffers: Sequence[bytes]) -> None:
        size = len(text) + sum(map(len, buffers))
        if self._size and self._size + size > _MOST_WAITING:
            self._socket.transport.abort()  # it does not read; if it comes back, it gets everything
            return
        self._size += size
        messages: tuple[str | bytes, ...] = (*buffers, text)
        for each in messages:
            self._waiting.put_nowait(each)

    async def _deliver(self) -> None:
        with suppress(ConnectionClosed):
            while True:
                each = await self._waiting.get()
                await self._socket.send(each)
                self._size -= len(each)
                self._waiting.task_done()


def _nowhere(message: Any, buffers: list[bytes] | None) -> None:
    """Send nothing to a page that has gone."""

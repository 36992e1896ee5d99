"""The server of a run's page: a few files, and a WebSocket for those that know the token.

It has a thread of its own. The token comes in the first message of a WebSocket, never in a request, and
nothing is logged. A browser says which page asks (``Origin``), and by which name it has called this computer
(``Host``): only the page that was served here is answered.
"""

from __future__ import annotations

import asyncio
import hmac
import logging
import re
import secrets
import ssl
import threading
import traceback
from concurrent.futures import Future
from contextlib import AsyncExitStack
from functools import partial
from http import HTTPStatus
from pathlib import Path
from typing import ClassVar, Self

from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from lrp_jupyter.errors import FileError, LRPError
from lrp_jupyter.files import shown
from lrp_jupyter.served import page_files
from lrp_jupyter.served.doorway import Doorway, calls_us, is_loopback
from lrp_jupyter.served.page_visit import LARGEST, Closing, PageVisit
from lrp_jupyter.served.served_program import ServedProgram

_SOCKET = "/socket"
_FIRST_WORDS = 10.0  # s in which a page shows the token
_ALIVE = 10.0  # s from one sign of life of a page to the next
_MOST_PAGES, _MOST_CONNECTIONS = 16, 32
_SILENT = logging.Logger("lrp page", logging.CRITICAL + 1)  # a message may have the token


class PageServer:
    """A context manager that serves a program's page; it ends the program, then the pages.

    Raises
    ------
    LRPError
        The address is taken, or not one of this computer; the certificate cannot be used; or the `token`,
        which is not empty if its user has chosen it, can be guessed.
    """

    def __init__(
        self, program: ServedProgram, at: str, certificate: str = "", key: str = "", token: str = ""
    ) -> None:
        self.program = program
        self._doorway = Doorway.read(at)
        self._tls = _context(certificate, key) if certificate else None
        if token and not re.fullmatch(r"[\w-]{32,200}", token, re.ASCII):
            raise LRPError(
                "`LRP_TOKEN` is all that protects the page: it needs 32 letters and digits or more, as"
                " `openssl rand -hex 32` makes them."
            )
        self._token = token or secrets.token_urlsafe(32)
        self._shown_token = "$LRP_TOKEN" if token else self._token
        self._sockets = self._doorway.listen()
        self._names = self._doorway.names
        self._owners: dict[str, PageVisit] = {}
        self._visits: set[PageVisit] = set()
        self._ready: Future[None] = Future()
        self._thread = threading.Thread(target=self._run, name="lrp page", daemon=True)

    @property
    def link(self) -> str:
        """The address of the page, with its token, unless its user knows that already."""
        scheme = "http" if self._tls is None else "https"
        port = self._sockets[0].getsockname()[1]
        return f"{scheme}://{self._doorway.name}:{port}/#token={self._shown_token}"

    @property
    def is_open(self) -> bool:
        """Whether others on the network can read what the page and the program say to each other."""
        return self._tls is None and not is_loopback(self._sockets)

    def __enter__(self) -> Self:
        self._thread.start()
        self._ready.result()
        return self

    def __exit__(self, *_: object) -> None:
        self.program.close()  # which tells the pages how it has ended
        self._loop.call_soon_threadsafe(self._ended.set)
        self._thread.join()

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except BaseException as error:
            if self._ready.done():
                self.program.report(traceback.format_exc())
            else:
                self._ready.set_exception(error)

    async def _serve(self) -> None:
        self._loop, self._ended = asyncio.get_running_loop(), asyncio.Event()
        async with AsyncExitStack() as stack:
            for each in self._sockets:
                await stack.enter_async_context(
                    serve(
                        self._visit,
                        sock=each,
                        ssl=self._tls,
                        process_request=self._request,
                        process_response=_with_headers,
                        server_header=None,
                        compression=None,
                        max_size=LARGEST,
                        open_timeout=_FIRST_WORDS,
                        ping_interval=_ALIVE,
                        ping_timeout=_ALIVE,
                        close_timeout=1,
                        logger=_SILENT,
                        create_connection=_CountedConnection,
                        ssl_handshake_timeout=None if self._tls is None else _FIRST_WORDS,
                    )
                )
            self._ready.set_result(None)
            await self._ended.wait()
            await asyncio.gather(*(visit.end() for visit in self._visits))
            for spare in [*_CountedConnection.known]:  # as browsers keep them, for what they ask next
                spare.transport.abort()

    def _request(self, connection: ServerConnection, request: Request) -> Response | None:
        """Answer a request for a file; None for one of a WebSocket that may be opened."""
        hosts, origins = (request.headers.get_all(name) for name in ("Host", "Origin"))
        called = hosts[0] if len(hosts) == 1 else None
        if self._tls is None and not calls_us(called, self._names):  # a certificate has its names itself
            return page_files.plain_answer(
                HTTPStatus.MISDIRECTED_REQUEST, "This computer has no such name. Call it by its address."
            )
        if request.path.partition("?")[0] != _SOCKET:
            return page_files.answer(request)
        if len(origins) != 1 or origins[0].partition("://")[2] != called:
            return page_files.plain_answer(HTTPStatus.FORBIDDEN, "Only the page of this run is answered.")
        return None

    async def _visit(self, socket: ServerConnection) -> None:
        """Answer a page, if it shows the token."""
        try:
            refusal = await self._refusal(socket)
            if refusal is not None:
                await socket.close(refusal)
                return
            about = {
                "name": self.program.name,
                "file": self.program.file.shown_file if self.program.file else "",
                "read_only": bool(self.program.read_only),
            }
            visit = PageVisit(socket, self.program, self._owners, about)
            self._visits.add(visit)
            try:
                await visit.run()
            finally:
                self._visits.discard(visit)
        except ConnectionClosed:
            pass
        except Exception:
            self.program.report(traceback.format_exc())

    async def _refusal(self, socket: ServerConnection) -> Closing | None:
        """Return why a page is not answered."""
        try:
            token = await asyncio.wait_for(socket.recv(), _FIRST_WORDS)
        except TimeoutError:
            token = ""
        given = token.encode() if isinstance(token, str) else token
        if not hmac.compare_digest(given, self._token.encode()):
            return Closing.NO_TOKEN
        return Closing.FULL if len(self._visits) >= _MOST_PAGES else None


class _CountedConnection(ServerConnection):
    """A connection to a server that has not too many of them."""

    known: ClassVar[set[ServerConnection]] = set()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        super().connection_made(transport)
        self.known.add(self)
        if len(self.known) > _MOST_CONNECTIONS:
            self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        self.known.discard(self)
        super().connection_lost(exc)


def _with_headers(_: ServerConnection, request: Request, response: Response) -> None:
    response.headers.update(page_files.secure(request))


def _context(certificate: str, key: str) -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    for file in filter(None, (certificate, key)):
        if not Path(file).is_file():
            raise FileError(f"`{shown(file)}` cannot be read: There is no such file.")
    try:
        context.load_cert_chain(certificate, key or None, password=partial(str))
    except (OSError, ValueError) as error:
        reason = getattr(error, "reason", "") or getattr(error, "strerror", "") or str(error)
        raise FileError(
            f"`{shown(certificate)}` cannot be used as a certificate: {reason}. It has to be in PEM, without"
            " a password, with its key in the same file or in that of `--key`."
        ) from None
    return context

"""A network between two programs of this computer that can be cut: then nothing comes through."""

from __future__ import annotations

import socket
import threading
from contextlib import suppress
from typing import Self


class Network:
    """A context manager that passes connections to its port on to another one."""

    def __init__(self, port: int) -> None:
        self._port = port
        self._whole = threading.Event()
        self._whole.set()
        self._listening = socket.create_server(("127.0.0.1", 0))
        self._open: list[socket.socket] = [self._listening]
        self.port = int(self._listening.getsockname()[1])

    def __enter__(self) -> Self:
        threading.Thread(target=self._accept, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._whole.set()
        _end(*self._open)
        for each in self._open:
            each.close()

    def cut(self) -> None:
        """Pass nothing on, until it is mended."""
        self._whole.clear()

    def mend(self) -> None:
        """Pass new connections on again; those that were cut are lost."""
        _, *lost = self._open
        del self._open[1:]
        _end(*lost)
        self._whole.set()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                near, _ = self._listening.accept()
                self._open.append(near)
                threading.Thread(target=self._connect, args=(near,), daemon=True).start()

    def _connect(self, near: socket.socket) -> None:
        self._whole.wait()
        with suppress(OSError):
            far = socket.create_connection(("127.0.0.1", self._port))
            self._open.append(far)
            threading.Thread(target=self._pass, args=(far, near), daemon=True).start()
            self._pass(near, far)

    def _pass(self, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):
            while data := one.recv(65536):
                self._whole.wait()
                other.sendall(data)
        _end(one, other)


def _end(*sockets: socket.socket) -> None:
    for each in sockets:
        with suppress(OSError):  # it is over already
            each.shutdown(socket.SHUT_RDWR)

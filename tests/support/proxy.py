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
        self._sockets = [socket.create_server(("127.0.0.1", 0))]
        self._threads: list[threading.Thread] = []
        self.port = int(self._sockets[0].getsockname()[1])

    def __enter__(self) -> Self:
        self._start(self._accept, self._sockets[0])
        return self

    def __exit__(self, *_: object) -> None:
        self._end(self._sockets)
        self._whole.set()
        for each in self._threads:  # none is added any more once the first one has ended
            each.join()
        for each in self._sockets:
            each.close()

    def cut(self) -> None:
        """Pass nothing on, until it is mended."""
        self._whole.clear()

    def mend(self) -> None:
        """Pass new connections on again; those that were cut are lost."""
        self._end(self._sockets[1:])
        self._whole.set()

    def _start(self, job: object, *arguments: object) -> None:
        self._threads.append(threading.Thread(target=job, args=arguments))
        self._threads[-1].start()

    def _accept(self, listening: socket.socket) -> None:
        with suppress(OSError):
            while True:
                near, _ = listening.accept()
                self._sockets.append(near)
                self._start(self._connect, near)

    def _connect(self, near: socket.socket) -> None:
        self._whole.wait()
        with suppress(OSError):
            far = socket.create_connection(("127.0.0.1", self._port))
            self._sockets.append(far)
            self._start(self._pass, far, near)
            self._pass(near, far)

    def _pass(self, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):
            while data := one.recv(65536):
                self._whole.wait()
                other.sendall(data)
        self._end([one, other])

    @staticmethod
    def _end(sockets: list[socket.socket]) -> None:
        for each in sockets:
            with suppress(OSError):  # it is over already
                each.shutdown(socket.SHUT_RDWR)

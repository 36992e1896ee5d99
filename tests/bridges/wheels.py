"""A robot behind a socket, and the bridge to it that its owner would write; `python wheels.py` is the robot.

The robot drives as it was told last, for ever, and prints when it was told something else: the time by
`time.monotonic`, which all processes share, and the speed. Whoever connects may command it.
"""

from __future__ import annotations

import socket
import socketserver
import sys
import threading
import time

from lrp_jupyter import Bridge
from lrp_jupyter.bridges import Stopper


class WheelsBridge(Bridge):
    """The robot behind a socket."""

    name = "wheels"

    def __init__(self, port: int = 0, guarded: bool = True) -> None:
        self.port, self.guarded = port, guarded

    def open_interface(self) -> None:
        self.socket = socket.create_connection(("127.0.0.1", self.port), timeout=2)
        self.add_method("move", self.move)

    def close_interface(self) -> None:
        self.socket.close()

    def move(self, linear: float = 0.0) -> None:
        self.socket.sendall(f"{linear}\n".encode())

    def stopper(self) -> Stopper | None:
        return Stopper(WheelsBridge, {"port": self.port}) if self.guarded else None


class Wheels:
    """Stops the robot, for a bridge without a class of its own for that."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=2)

    def stop(self) -> None:
        self.socket.sendall(b"0\n")


def halt(port: int) -> None:
    """Stop the robot."""
    with socket.create_connection(("127.0.0.1", port), timeout=2) as connection:
        connection.sendall(b"0\n")


def main() -> None:
    speed, telling = 0.0, threading.Lock()

    class Driver(socketserver.StreamRequestHandler):
        def handle(self) -> None:
            nonlocal speed
            for line in self.rfile:
                with telling:
                    if float(line) != speed:
                        speed = float(line)
                        sys.stdout.write(f"{time.monotonic()} {speed}\n")
                        sys.stdout.flush()

    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Driver) as server:
        server.daemon_threads = True
        sys.stdout.write(f"{server.server_address[1]}\n")
        sys.stdout.flush()
        server.serve_forever()


if __name__ == "__main__":
    main()

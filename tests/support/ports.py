"""Ports for what is started later, or stopped and started again."""

from __future__ import annotations

import random
import socket

_CHANCE = random.SystemRandom()


def free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    """Return a free port above those that Linux gives to whoever connects: none takes it meanwhile."""
    while True:
        with socket.socket(socket.AF_INET, kind) as probe:
            try:
                probe.bind(("127.0.0.1", _CHANCE.randrange(61000, 65536)))
            except OSError:
                continue
            return int(probe.getsockname()[1])

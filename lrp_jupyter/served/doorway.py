"""Where a page is served: ``[HOST:]PORT``, its sockets, and the names by which browsers may call it.

A page from elsewhere can have a name of its own point to this computer, and then speak to what listens here
("DNS rebinding"). So a browser has to call the page by an address in numbers, or by a name of this computer.
"""

from __future__ import annotations

import errno
import re
import socket
from contextlib import suppress
from dataclasses import dataclass
from ipaddress import ip_address

from lrp_jupyter.errors import LRPError, ended

_LOOPBACK = ("127.0.0.1", "::1")
_EVERY = ("0.0.0.0", "::")
_NOT_HERE = (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT, errno.EPROTONOSUPPORT)
_TRIES = 20  # to find a port that is free for all addresses


@dataclass(frozen=True)
class Doorway:
    """The argument of ``--serve``; without a host the addresses of this computer that only it reaches."""

    host: str
    port: int  # 0: a free one

    @classmethod
    def read(cls, text: str) -> Doorway:
        """Return what ``[HOST:]PORT`` says, or raise an LRPError."""
        found = re.fullmatch(r"(?:(\[[\da-fA-F:.]+\]|[^\s:\[\]]+):)?(\d{1,5})", text.strip())
        if found is None or int(found[2]) > 65535:
            raise LRPError(
                f"--serve takes a port, or an address and a port, not `{text}`: write `--serve 8080`,"
                " `--serve 192.168.1.5:8080` or `--serve [::]:8080`."
            )
        return cls((found[1] or "").strip("[]"), int(found[2]))

    def listen(self) -> list[socket.socket]:
        """Return listening sockets, all on one port."""
        for last in (*[False] * (_TRIES if self.port == 0 else 0), True):
            opened: list[socket.socket] = []
            try:
                for address in self._addresses():
                    port = opened[0].getsockname()[1] if opened else self.port
                    try:
                        opened.append(_listening(address, port))
                    except OSError as error:
                        if not opened or error.errno not in _NOT_HERE:  # as without IPv6
                            raise
                return opened
            except OSError as error:
                for each in opened:
                    each.close()
                if last:
                    raise self._error(error) from None
        raise AssertionError

    def _addresses(self) -> list[str]:
        if not self.host:
            return list(_LOOPBACK)
        try:
            found = socket.getaddrinfo(self.host, self.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        except UnicodeError:
            raise OSError("It is not the name of a computer.") from None
        return list(dict.fromkeys(str(address[0]) for *_, address in found))

    def _error(self, error: OSError) -> LRPError:
        place = f"`{self.host}`, port {self.port}" if self.host else f"port {self.port}"
        reason = error.strerror or str(error)
        if error.errno == errno.EADDRINUSE:
            reason = "another program listens there. `--serve 0` takes a free port"
        return LRPError(f"The page cannot be served at {place}: {ended(reason)}")

    @property
    def name(self) -> str:
        """The address by which the link calls this computer."""
        host = self.host or _LOOPBACK[0]
        if host in _EVERY:
            host = _own_address()
        return f"[{host}]" if ":" in host else host

    @property
    def names(self) -> set[str]:
        """The names, beside addresses in numbers, by which a browser may call this computer."""
        own = socket.gethostname().lower()
        return {"localhost", self.host.lower(), own, f"{own.partition('.')[0]}.local"} - {""}


def is_loopback(sockets: list[socket.socket]) -> bool:
    """Return whether only this computer reaches all of these."""
    return all(ip_address(str(each.getsockname()[0]).partition("%")[0]).is_loopback for each in sockets)


def calls_us(host: str | None, names: set[str]) -> bool:
    """Return whether a browser that sends this ``Host`` has called this computer by its name or address."""
    found = re.fullmatch(r"(\[[\da-fA-F:.]+\]|[^:\[\]]+)(?::\d+)?", host or "")
    if found is None:
        return False
    name = found[1].strip("[]").rstrip(".").lower()
    with suppress(ValueError):
        return bool(ip_address(name))
    return name in names


def _listening(address: str, port: int) -> socket.socket:
    if ":" not in address:
        return socket.create_server((address, port))
    both = address == "::" and socket.has_dualstack_ipv6()
    return socket.create_server((address, port), family=socket.AF_INET6, dualstack_ipv6=both)


def _own_address() -> str:
    """Return an address by which others reach this computer; nothing is sent to find it."""
    with suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.connect(("192.0.2.1", 9))  # of documentation: the way there is that to other computers
        return str(probe.getsockname()[0])
    return socket.gethostname()

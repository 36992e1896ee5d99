"""Where a ROS robot is found: at an address, or in a domain in which the nodes of ROS 2 find one another."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from urllib.parse import urlsplit

from lrp_jupyter.errors import BridgeError

_HIGHEST = 232  # the ports of a higher one would be above 65535


def domain_number(number: int | str | None = None) -> int:
    """Return the number of a domain, 0 to 232; None: ``ROS_DOMAIN_ID`` of the environment, or 0."""
    source = "`domain`" if number is not None else "`ROS_DOMAIN_ID`"
    text = str(number if number is not None else os.environ.get("ROS_DOMAIN_ID") or 0).strip()
    if not (text.isascii() and text.isdigit() and int(text) <= _HIGHEST):
        raise BridgeError(f"{source} must be a number from 0 to {_HIGHEST}, not `{text}`.")
    return int(text)


@dataclass(frozen=True, slots=True)
class Address:
    """Where a robot is found."""

    scheme: str
    host: str  # empty: not given
    port: int
    path: str = ""  # from the first `/` on, with a query

    @property
    def url(self) -> str:
        """The whole address; of this machine if no host was given."""
        host = self.host or "127.0.0.1"
        return f"{self.scheme}://{f'[{host}]' if ':' in host else host}:{self.port}{self.path}"

    def __str__(self) -> str:
        if not self.host:
            return ""
        return self.url if self.path or self.scheme == "wss" else self.url.partition("//")[2]


def parse_address(
    host: str | None, port: int | str | None, default: int, schemes: tuple[str, ...] = ("ws", "wss")
) -> Address:
    """Read an address: ``turtle.local``, ``10.0.0.5:9090``, ``[fe80::1]:9090``, ``wss://turtle.local/rosbridge``.

    `port`: it replaces a port in `host`.
    `default`: the port if none is given; with ``wss`` it is 443, as in a browser.
    `schemes`: what may stand before ``://``; the first is the default. Only ``ws`` and ``wss`` have paths.
    """
    text = str(host or "").strip()
    shown = f"`{text}`{f', port {port}' if port else ''}"
    if text.count(":") > 1 and "://" not in text and not text.startswith("["):  # an IPv6 address
        text = f"[{text}]"
    scheme, mark, _ = text.rpartition("://")
    if mark and scheme not in schemes:
        known = " or ".join(f"`{name}://`" for name in schemes) or "a host without that"
        raise BridgeError(f"{shown} begins with `{scheme}://`, but only {known} can be connected to.")
    try:
        parts = urlsplit(text if mark else f"{schemes[0] if schemes else 'host'}://{text}")
        name, given = parts.hostname or "", parts.port
        number = int(port) if port is not None else given or (443 if parts.scheme == "wss" else default)
    except ValueError:
        name, number = "", -1
    if "@" in text:
        raise BridgeError(f"{shown} has a user name, which cannot be sent. Write the address without it.")
    path = parts.path.rstrip("/") if number > 0 else ""
    path += f"?{parts.query}" if number > 0 and parts.query else ""
    if path and parts.scheme not in ("ws", "wss"):
        raise BridgeError(f"{shown} has a path, which means nothing there. Write `host:port`.")
    is_name = re.fullmatch(r"[\w.%:-]*", name, re.ASCII) and not re.search(r"[\s#]|\?$", text)
    if not 0 < number < 65536 or (text and not name) or not is_name:
        raise BridgeError(f"{shown} is not an address. Write `host` or `host:port`.")
    return Address(parts.scheme, name, number, path)

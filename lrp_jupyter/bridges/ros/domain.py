"""The number of the domain in which the nodes of ROS 2 find one another."""

from __future__ import annotations

import os

from lrp_jupyter.errors import BridgeError

_HIGHEST = 232  # the ports of a higher one would be above 65535


def domain_number(number: int | str | None = None) -> int:
    """Return the number of a domain, 0 to 232; None: ``ROS_DOMAIN_ID`` of the environment, or 0."""
    source = "`domain`" if number is not None else "`ROS_DOMAIN_ID`"
    text = str(number if number is not None else os.environ.get("ROS_DOMAIN_ID") or 0).strip()
    if not (text.isascii() and text.isdigit() and int(text) <= _HIGHEST):
        raise BridgeError(f"{source} must be a number from 0 to {_HIGHEST}, not `{text}`.")
    return int(text)

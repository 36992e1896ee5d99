"""The network of DDS: one domain per number and process, and how its members are found.

What a ROS 2 node takes from the environment holds here too: ``ROS_LOCALHOST_ONLY``,
``ROS_AUTOMATIC_DISCOVERY_RANGE`` and ``ROS_STATIC_PEERS``. What ``CYCLONEDDS_URI`` says comes last and wins.
"""

from __future__ import annotations

import os
import socket
import threading
from dataclasses import dataclass
from typing import ClassVar
from xml.sax.saxutils import quoteattr

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain

from lrp_jupyter.errors import BridgeError, did_you_mean

_RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")


@dataclass
class DdsDomain:
    """A domain that this process takes part in; the participants of all bridges share it."""

    number: int
    config: str  # XML for Cyclone DDS
    users: int = 0  # that have entered and not left yet
    _entity: Domain | None = None

    _all: ClassVar[dict[int, DdsDomain]] = {}
    _lock: ClassVar[threading.Lock] = threading.Lock()

    @classmethod
    def enter(cls, number: int, host: str = "") -> DdsDomain:
        """Return the domain of this number, of which a robot at `host` is a member."""
        config = _configuration(host)
        with cls._lock:
            domain = cls._all.get(number)
            if domain is None:
                domain = cls(number, config)
                domain._start()
                cls._all[number] = domain
            elif domain.config != config:
                raise BridgeError(
                    f"Another bridge of this process uses domain {number} with another `host`."
                    " Close it first, or put the robots into domains of their own."
                )
            domain.users += 1
            return domain

    def leave(self) -> None:
        """Forget the domain, with the sockets and threads of DDS, when its last user leaves."""
        with self._lock:
            self.users -= 1
            if not self.users:
                del self._all[self.number]
                if self._entity is not None:
                    self._entity.__del__()  # cyclonedds has no other way to end something now

    def _start(self) -> None:
        try:
            self._entity = Domain(self.number, self.config)
        except DDSException as error:
            if error.code != DDSException.DDS_RETCODE_PRECONDITION_NOT_MET:
                raise BridgeError(
                    f"DDS cannot be started in domain {self.number}. Is there a network, and what"
                    " `CYCLONEDDS_URI` says right?"
                ) from error
            # other code in this process, such as a notebook that uses cyclonedds, has joined it already


def _configuration(host: str) -> str:
    environment = os.environ
    peers = [peer for peer in environment.get("ROS_STATIC_PEERS", "").split(";") if peer.strip()]
    peers += [host] if host else []
    is_local = environment.get("ROS_LOCALHOST_ONLY") == "1"
    reach = environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or "SYSTEM_DEFAULT"
    if reach not in _RANGES:
        raise BridgeError(
            f"`ROS_AUTOMATIC_DISCOVERY_RANGE` must be one of {', '.join(_RANGES)}, not `{reach}`."
            f"{did_you_mean(reach, _RANGES)}"
        )
    if reach == "OFF":
        raise BridgeError("`ROS_AUTOMATIC_DISCOVERY_RANGE` is OFF: no robot can be found. Set it to SUBNET.")
    addresses = [_address_of(peer.strip()) for peer in peers]
    general = ""
    if is_local:
        general += '<Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>'
    if is_local or reach == "LOCALHOST":
        general += "<AllowMulticast>false</AllowMulticast>"
        addresses.append("127.0.0.1")
    found = "".join(f"<Peer address={quoteattr(address)}/>" for address in dict.fromkeys(addresses))
    discovery = f"<ParticipantIndex>auto</ParticipantIndex><Peers>{found}</Peers>" if found else ""
    own = (
        f"<General>{general}</General><Discovery>{discovery}</Discovery>"
        "<Tracing><Verbosity>none</Verbosity></Tracing>"
    )
    return ",".join(filter(None, (own, environment.get("CYCLONEDDS_URI", ""))))


def _address_of(host: str) -> str:
    """Return the IPv4 address of a host."""
    try:
        return str(socket.getaddrinfo(host, None, socket.AF_INET, socket.SOCK_DGRAM)[0][4][0])
    except OSError:
        raise BridgeError(
            f"`{host}` has no IPv4 address. Is the name right, and the robot in this network?"
        ) from None

"""What of a bridge is connected to what, and every change of it.

A change is made at once on this side (the member is there, or gone), and by the link, soon, on the
other. Whoever makes it may wait a moment for what the robot says to it.
"""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

from lrp_jupyter.bridges.members import did_you_mean
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.link import TopicLink
from lrp_jupyter.bridges.ros.setup import Wire, load_setup, save_setup, setup_as_dict, setup_from_dict
from lrp_jupyter.errors import BridgeError

__all__ = ["Wiring"]


class Wiring:
    """The channels of a bridge.

    Owner: a person, the link and the loop may all change it; a lock keeps them apart.

    Attributes
    ----------
    path : str
        The file in which every change is kept; empty: none.
    """

    def __init__(self, offer: Callable[[Channel], None], withdraw: Callable[[str], None]) -> None:
        self.path = ""
        self.link: TopicLink | None = None
        self._offer, self._withdraw = offer, withdraw
        self._changing = threading.RLock()
        self._channels: dict[str, Channel] = {}

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Everything that is, or shall be, connected."""
        return tuple(self._channels.values())

    def as_dict(self) -> dict[str, Any]:
        """Give the set-up as JSON."""
        return setup_as_dict(channel.wire for channel in self.channels)

    def connect(self, wire: Wire, patience: float) -> None:
        """Connect a variable, and wait so many seconds for what the robot says to it.

        Raises
        ------
        BridgeError
            It cannot be; what was there before stays.
        """
        before, channel = self._put(wire)
        link = self.link
        if patience and link is not None and link.connected:
            channel.settled.wait(patience)
            if channel.problem and channel.handle is None and link.connected:
                with self._changing:
                    self._let_go(channel)
                    self._channels.pop(wire.variable, None)
                    if before is not None:
                        self._put(before)
                raise BridgeError(channel.problem)
        if before != wire:
            self._store()

    def remove(self, variable: str) -> None:
        """Let a variable go.

        Raises
        ------
        BridgeError
            There is none of that name.
        """
        with self._changing:
            if variable not in self._channels:
                raise BridgeError(
                    f"`{variable}` is connected to no topic.{did_you_mean(variable, self._channels)}"
                )
            self._let_go(self._channels.pop(variable))
            self._store()

    def take(self, setup: str | os.PathLike[str] | Mapping[str, object]) -> None:
        """Connect what a set-up says, and nothing else; from now on a file keeps every change.

        Raises
        ------
        BridgeError
            It is no set-up.
        """
        if isinstance(setup, Mapping):
            wires, path = setup_from_dict(setup), ""
        else:
            wires, path = load_setup(setup), os.fspath(setup)
        with self._changing:
            for channel in self.channels:
                self._let_go(channel)
            self._channels.clear()
            self.path = path
            for wire in wires:
                self._put(wire)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the set-up to a file, and from now on every change of it.

        Raises
        ------
        BridgeError
            The file cannot be written.
        """
        save_setup(path, [channel.wire for channel in self.channels])
        self.path = os.fspath(path)

    def renew(self, link: TopicLink) -> None:
        """Begin anew, with channels on which nothing has arrived yet, for another link."""
        with self._changing:
            self.link = link
            self._channels = {wire.variable: Channel(wire) for wire in [c.wire for c in self.channels]}
            for channel in self.channels:
                self._offer(channel)
                link.add(channel)

    def close(self) -> None:
        """End all connections; the channels stay set up."""
        link, self.link = self.link, None
        if link is not None:
            link.close()

    def stand_still(self, channel: Channel) -> None:
        """Publish a velocity of zero on a channel, if it carries velocities.

        Raises
        ------
        BridgeError
            It could not be sent.
        """
        link = self.link
        if link is not None and channel.message is not None and channel.is_velocity:
            link.send(channel, channel.message().as_dict(), urgent=True)

    def settle(self, patience: float) -> None:
        """Wait until the robot has answered for every channel, so many seconds at most."""
        end = time.monotonic() + patience
        for channel in self.channels:
            channel.settled.wait(max(0.0, end - time.monotonic()))

    def learned(self, channel: Channel) -> None:
        """Offer a channel whose type has become known. On the link's thread."""
        with self._changing:
            if self._channels.get(channel.wire.variable) is channel:
                self._offer(channel)

    def _put(self, wire: Wire) -> tuple[Wire | None, Channel]:
        """Note a connection that shall be; give what was there before."""
        link = self.link
        with self._changing:
            old = self._channels.get(wire.variable)
            if old is not None and old.wire == wire and not old.problem:
                return old.wire, old
            channel = Channel(wire)
            if link is not None:
                self._offer(channel)  # first: it may find that the name cannot be
            if old is not None:
                self._let_go(old, channel)
            self._channels[wire.variable] = channel
            if link is not None:
                link.add(channel)
            return old.wire if old is not None else None, channel

    def _let_go(self, channel: Channel, successor: Channel | None = None) -> None:
        link = self.link
        if link is None:
            return
        if channel.has_moved:
            with contextlib.suppress(BridgeError):  # it is lost: nobody can stop it here
                self.stand_still(channel)
        link.drop(channel)
        if successor is None:
            self._withdraw(channel.wire.variable)

    def _store(self) -> None:
        if self.path:
            self.save(self.path)

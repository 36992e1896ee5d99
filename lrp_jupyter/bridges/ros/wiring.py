"""The connections of a bridge, and their changes.

A change is applied at once on this side (the member is there, or gone), and soon, by the link, on the
other. The caller may wait a moment for the robot's answer.
"""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.link import TopicLink
from lrp_jupyter.bridges.ros.names import GraphNames
from lrp_jupyter.bridges.ros.ros_request import RosRequest
from lrp_jupyter.bridges.ros.setup import Wire, load_setup, save_setup, setup_as_dict, setup_from_dict
from lrp_jupyter.errors import BridgeError, did_you_mean


class Wiring:
    """The channels of a bridge.

    Owner: the threads of a person, the link and the loop may change it; a lock serializes them.
    """

    def __init__(
        self, names: GraphNames, offer: Callable[[Channel], None], withdraw: Callable[[str], None]
    ) -> None:
        self.path = ""  # the file to which every change is written
        self.link: TopicLink | None = None
        self.names = names
        self._offer, self._withdraw = offer, withdraw
        self._changing = threading.RLock()
        self._channels: dict[str, Channel] = {}
        self._owing: list[Channel] = []  # that were removed while the robot was lost, and in motion

    @property
    def channels(self) -> tuple[Channel, ...]:
        """All channels, connected or not yet."""
        return tuple(self._channels.values())

    @property
    def all_channels(self) -> tuple[Channel, ...]:
        """The channels, those of static transforms beside them, and removed ones until they are stopped."""
        static = (channel.static for channel in self.channels)
        owing = (channel for channel in self._owing if channel.owes_stop)
        return (*self.channels, *(channel for channel in static if channel is not None), *owing)

    def as_dict(self) -> dict[str, Any]:
        """Return the set-up in its JSON form."""
        return setup_as_dict(channel.written for channel in self.channels)

    def connect(self, wire: Wire, patience: float) -> None:
        """Connect a variable, and wait at most `patience` seconds for the robot's answer.

        Raises BridgeError: it cannot be connected; the previous connection stays.
        """
        before, channel = self._put(wire)
        link = self.link
        if patience and link is not None and link.connected:
            channel.answered.wait(patience)
            if channel.problem and channel.handle is None and link.connected:
                with self._changing:
                    self._remove(channel)
                    if before is not None:
                        self._put(before)
                raise BridgeError(channel.problem)
        if before != wire:
            self._store()

    def remove(self, variable: str) -> None:
        """Disconnect a variable."""
        with self._changing:
            if variable not in self._channels:
                raise BridgeError(
                    f"`{variable}` is connected to nothing.{did_you_mean(variable, self._channels)}"
                )
            self._remove(self._channels[variable])
            self._store()

    def load(self, setup: str | os.PathLike[str] | Mapping[str, object]) -> None:
        """Replace all connections by those of a set-up; later changes are written to its file."""
        if isinstance(setup, Mapping):
            wires, path = setup_from_dict(setup), ""
        else:
            wires, path = load_setup(setup), os.fspath(setup)
        with self._changing:
            for channel in self.channels:
                self._remove(channel)
            self.path = path
            for wire in wires:
                self._put(wire)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the set-up to a file, now and after every change."""
        save_setup(path, [channel.written for channel in self.channels])
        self.path = os.fspath(path)

    def attach(self, link: TopicLink) -> None:
        """Replace the link, with new channels on which nothing has arrived yet."""
        with self._changing:
            self.link = link
            self._channels = {each.wire.variable: self._channel(each.written) for each in self.channels}
            for channel in self.channels:
                self._offer(channel)

    def close(self) -> None:
        """End all connections; the channels stay set up."""
        link, self.link = self.link, None
        if link is not None:
            link.close()

    def stop(self, channel: Channel, goals: Iterable[RosRequest | None]) -> None:
        """Publish a velocity of zero, or what the set-up names for a stop, and cancel goals.

        `goals`: None among them: those of every client.

        Raises BridgeError: it was not sent.
        """
        if (link := self.link) is None:
            return
        if channel.is_velocity or channel.wire.at_stop is not None:
            link.send(channel, channel.stop_message(), urgent=True)
        for goal in goals:
            link.cancel(channel, goal)

    def say_in_tick(self, channel: Channel) -> None:
        """Publish what is published in every tick, if the robot can be reached."""
        link = self.link
        if link is not None and (message := channel.tick_message()) is not None:
            with contextlib.suppress(BridgeError):
                link.send(channel, message)

    def wait_for_answers(self, patience: float) -> None:
        """Wait until the robot has answered for every channel, at most `patience` seconds."""
        end = time.monotonic() + patience
        for channel in self.channels:
            channel.answered.wait(max(0.0, end - time.monotonic()))

    def learned(self, channel: Channel) -> None:
        """Register a channel whose type has become known. On the link's thread."""
        with self._changing:
            if self._channels.get(channel.wire.variable) is channel:
                self._offer(channel)

    def _put(self, wire: Wire) -> tuple[Wire | None, Channel]:
        """Add a connection; return the one that it replaces, and its channel."""
        link = self.link
        with self._changing:
            old = self._channels.get(wire.variable)
            if old is not None and old.written == wire and not old.problem:
                return old.written, old
            channel = self._channel(wire)
            if link is not None:
                self._offer(channel)  # first: it may refuse the name
            if old is not None:
                self._release(old)
            self._channels[wire.variable] = channel
            if link is not None:
                link.hurry()
            return old.written if old is not None else None, channel

    def _channel(self, wire: Wire) -> Channel:
        return Channel(wire, self.names.resolve)

    def _remove(self, channel: Channel) -> None:
        self._release(channel)
        self._channels.pop(channel.wire.variable, None)
        self._withdraw(channel.wire.variable)
        if self.link is not None:
            self.link.hurry()

    def _release(self, channel: Channel) -> None:
        """Stop what a channel has set in motion while the link still has it; it receives nothing more."""
        if channel.may_move:
            try:
                self.stop(channel, channel.unfinished)
            except BridgeError:  # it is lost: the link stops it as soon as it is found
                channel.owes_stop = True
                self._owing = [*(each for each in self._owing if each.owes_stop), channel]
        channel.forget()
        if channel.static is not None:
            channel.static.forget()

    def _store(self) -> None:
        if self.path:
            self.save(self.path)

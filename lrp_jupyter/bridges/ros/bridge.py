"""The bridge to ROS: topics become variables and methods of `robot`.

A person connects them once, in the panel, from Python or in a set-up file; a program uses them and
never knows of topics::

    ros = RosBridge(host="turtle.local")
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")

    (running [robot.move(linear_x=0.2)])
    (event there [robot.odom.x > 1])

Two back ends do the talking: rosbridge (the default; ROS 1 and 2, nothing of ROS needed here) and
rospy (ROS 1, where Python can import it).

Paper: §7.1.
Deviation: §7.1 asks for the class of a PhaROS package when the interpreter starts; here the address
of the robot takes that place, asked once.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping
from functools import partial
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge, ConnectionState
from lrp_jupyter.bridges.members import did_you_mean
from lrp_jupyter.bridges.message import Message, real_number
from lrp_jupyter.bridges.nodes import Limits
from lrp_jupyter.bridges.panel import Panel
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.link import TopicLink, Transport
from lrp_jupyter.bridges.ros.panel import Draft, draw_panel
from lrp_jupyter.bridges.ros.rosbridge import RosbridgeTransport
from lrp_jupyter.bridges.ros.rospy import RospyTransport
from lrp_jupyter.bridges.ros.setup import Direction, Wire, check_type, parse_address
from lrp_jupyter.bridges.ros.types import ReceivedMessage, RosMessage
from lrp_jupyter.bridges.ros.wiring import Wiring
from lrp_jupyter.errors import BridgeError, NoDataYet

__all__ = ["RosBridge"]

_BACKENDS = {"rosbridge": 9090, "rospy": 11311}  # with their ports
_SETTLE = 1.0  # seconds that a person waits for a new connection to be made
_SETTLE_ALL = 2.0  # … and that opening waits for those of the set-up


class RosBridge(Bridge):
    """A ROS robot.

    Parameters
    ----------
    backend : {"rosbridge", "rospy"}
    host : str, optional
        Of the rosbridge server or the ROS master, ``host`` or ``host:port``. Unless given:
        this machine or, with rospy, what ``ROS_MASTER_URI`` says.
    port : int, optional
        9090 for rosbridge, 11311 for rospy.
    setup : path or mapping, optional
        What is connected to what; see `lrp_jupyter.bridges.ros.setup`. A file is kept: what is
        changed later is written to it.
    patience : float
        Seconds that opening may take.

    Raises
    ------
    BridgeError
        An option or the set-up has a mistake; the sentence says which.
    """

    name = "ros"

    def __init__(
        self,
        backend: str = "rosbridge",
        host: str | None = None,
        port: int | str | None = None,
        setup: str | os.PathLike[str] | Mapping[str, object] | None = None,
        patience: float | str = 8.0,
    ) -> None:
        super().__init__()
        if backend not in _BACKENDS:
            names = " and ".join(f"`{name}`" for name in _BACKENDS)
            raise BridgeError(
                f"There is no back end `{backend}`, only {names}.{did_you_mean(backend, _BACKENDS)}"
            )
        self.backend = backend
        self._address = parse_address(host, port, _BACKENDS[backend])
        self._patience = real_number(_number(patience), "patience")
        self._draft = Draft()
        self.wiring = Wiring(self._offer, self._withdraw)
        self._in_tick = 0  # the thread of the tick that is under way: it must not wait
        if setup is not None:
            self.wiring.take(setup)

    # -- what is connected to what ----------------------------------------------------------------

    def subscribe(self, variable: str, topic: str, type: str = "") -> None:  # noqa: A002
        """Make the last message of a topic available as ``robot.<variable>``.

        Once: the same again does nothing; another topic takes the place of the first.

        Parameters
        ----------
        variable, topic : str
        type : str, optional
            That of the live topic unless given.

        Raises
        ------
        BridgeError
            A name is illegal, the type unknown, or the topic carries another one.
        """
        self.connect(Wire(variable, "subscription", topic, type))

    def publish(self, variable: str, topic: str, type: str = "", limits: Limits | None = None) -> None:  # noqa: A002
        """Make a topic available as ``robot.<variable>(…)``.

        Parameters
        ----------
        variable, topic : str
        type : str, optional
            That of the live topic unless given.
        limits : mapping of str to float or (float, float), optional
            ``{"linear": 0.5}``: numbers beyond are brought back to -0.5 ... 0.5, and that is shown.

        Raises
        ------
        BridgeError
            As for `subscribe`.
        """
        self.connect(Wire(variable, "publisher", topic, type, dict(limits or {})))

    def remove(self, variable: str) -> None:
        """End a subscription or publisher, and take the variable away.

        Raises
        ------
        BridgeError
            There is none of that name.
        """
        self.wiring.remove(variable)

    @property
    def setup(self) -> dict[str, Any]:
        """The set-up as JSON, to be stored with a notebook, say."""
        return self.wiring.as_dict()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the set-up to a file, and from now on every change of it.

        Raises
        ------
        BridgeError
            The file cannot be written.
        """
        self.wiring.save(path)

    def connect(self, wire: Wire, wait: bool = True) -> None:
        """Connect a variable and, unless told otherwise, wait a moment for what the robot says to it.

        Raises
        ------
        BridgeError
            It cannot be; what was there before stays.
        """
        may_wait = wait and threading.get_ident() != self._in_tick
        self.wiring.connect(wire, _SETTLE if may_wait else 0.0)

    # -- the robot --------------------------------------------------------------------------------

    def _offer(self, channel: Channel) -> None:
        """Make a channel a member of the robot; again when its type has become known.

        Raises
        ------
        BridgeError
            Its name is that of a part of the robot.
        """
        wire = channel.wire
        try:
            if wire.direction == "subscription":
                self.add_variable(
                    wire.variable,
                    partial(self._read, channel),
                    f"the last message on {wire.topic}",
                    type=channel.form.kind if channel.form is not None else channel.type,
                    age=channel.age,
                )
            else:
                self.add_method(
                    wire.variable,
                    partial(self._send, channel) if channel.message else partial(_refuse, channel),
                    f"publish a {channel.type or 'message'} on {wire.topic}",
                    message=channel.message,
                    velocity=channel.is_velocity,
                    limits=wire.limits if channel.message else None,
                )
        except ValueError as error:
            raise BridgeError(str(error)) from error

    def _withdraw(self, variable: str) -> None:
        if variable in self.nodes.table:
            self.remove_member(variable)

    def _read(self, channel: Channel) -> ReceivedMessage:
        arrival = channel.latched if self.latch else channel.latest
        if arrival is not None:
            return arrival.value
        if channel.problem:
            raise BridgeError(f"`robot.{channel.wire.variable}`: {channel.problem}")
        raise NoDataYet(f"`robot.{channel.wire.variable}` has no data yet.")

    def _send(self, channel: Channel, message: Message) -> None:
        link = self.wiring.link
        if link is None:
            raise BridgeError("The bridge `ros` is closed.")
        values = message.as_dict()
        channel.has_moved |= channel.is_velocity and _any_number(values)
        link.send(channel, values)
        channel.note()
        assert isinstance(message, RosMessage)
        channel.last_sent = message

    def stop(self) -> None:
        """Publish a velocity of zero wherever velocities go."""
        failures = []
        for channel in self.wiring.channels:
            try:
                self.wiring.stand_still(channel)
            except BridgeError as error:
                if channel.has_moved:
                    failures.append(str(error))
        if failures:
            raise BridgeError(f"{failures[0]} It is stopped as soon as it is found.")

    def sense(self, now: float) -> None:
        """Latch the last messages: a tick sees one world."""
        self._in_tick = threading.get_ident()
        for channel in self.wiring.channels:
            channel.latched = channel.latest

    def act(self, now: float) -> None:
        """Leave the tick."""
        self._in_tick = 0

    # -- the connection ---------------------------------------------------------------------------

    def open_interface(self) -> Panel:
        """Connect, and connect what the set-up says.

        Raises
        ------
        BridgeError
            There is no robot, or something is not installed.
        """
        self._start(searching=False)
        self.wiring.settle(_SETTLE_ALL)
        self.set_status(*self._told)
        return self.panel()

    def close_interface(self) -> None:
        """End all connections; the set-up stays."""
        self.wiring.close()

    def _start(self, searching: bool) -> None:
        """Make a link, with new channels for all that is set up."""
        link = TopicLink(self._make_transport(), self._report, self.wiring.learned)
        self._told = (ConnectionState.CONNECTING, f"connecting to {link.transport.place}")
        self.add_method("stop", self.stop, "publish a velocity of zero wherever velocities go")
        try:
            self.wiring.renew(link)
            if searching:
                link.search()
            else:
                link.open(self._patience)
        except BridgeError:
            self.wiring.link = None
            self.nodes.clear()
            raise

    def _make_transport(self) -> Transport:
        host, port = self._address
        if self.backend == "rospy":
            return RospyTransport(f"http://{host}:{port}" if host else "")
        return RosbridgeTransport(f"ws://{host or '127.0.0.1'}:{port}", self._warn)

    _told: tuple[ConnectionState, str] = (ConnectionState.DISCONNECTED, "not open")

    def _warn(self, sentence: str) -> None:
        self.safety.notice("fault", sentence)

    def _report(self, state: ConnectionState, sentence: str) -> None:
        """Show how the connection is; a robot that does not answer is stopped. On the link's thread."""
        before, self._told = self._told[0], (state, sentence)
        self.set_status(state, sentence)
        link = self.wiring.link
        if link is None or state not in (ConnectionState.LOST, ConnectionState.STALE):
            return
        if state is ConnectionState.LOST or link.transport.trouble():
            self.safety.notice("fault", sentence)
            if before is not ConnectionState.LOST:
                self.stop_all()

    # -- the panel --------------------------------------------------------------------------------

    @property
    def topics(self) -> Mapping[str, str]:
        """The live topics with their types, as they were a moment ago."""
        link = self.wiring.link
        return link.topics if link is not None else {}

    @property
    def address(self) -> str:
        """Where the robot is; empty: on this machine, or where the environment says."""
        host, port = self._address
        return f"{host}:{port}" if host else ""

    def panel(self) -> Panel:
        """Give the table of what is connected, the fields for a new one, and the live topics."""
        return draw_panel(
            status=self.status.sentence,
            backend=self.backend,
            address=self.address,
            setup=self.wiring.path,
            draft=self._draft,
            channels=self.wiring.channels,
            topics=self.topics,
        )

    def press(self, key: str, row: str = "", values: Mapping[str, str] | None = None) -> None:
        """Press a button: ``subscribe`` and ``publish`` take what stands in the fields, without waiting.

        Raises
        ------
        BridgeError
            A name is illegal, or there is no such button or row.
        """
        fields = values or {}
        variable = fields.get("variable", "").strip()
        if key in ("subscribe", "publish"):
            type_ = check_type(fields.get("type", ""), self.topics.values())
            direction: Direction = "subscription" if key == "subscribe" else "publisher"
            self.connect(Wire(variable, direction, fields.get("topic", ""), type_), wait=False)
            self._draft = Draft()
        elif key == "pick":
            self._draft = Draft(variable or row.rpartition("/")[2], row, self.topics.get(row, ""))
        elif key == "remove":
            self.remove(row)
        elif key == "save":
            path = fields.get("setup", "").strip() or self.wiring.path
            if not path:
                raise BridgeError("There is no file for the set-up. Name one.")
            self.save(path)
        else:
            super().press(key, row, values)

    def answer(self, key: str, value: str) -> None:
        """Take the robot's address, or the file with the set-up; an open bridge connects anew.

        Raises
        ------
        BridgeError
            It is no address, or no set-up.
        """
        if key == "setup":
            self.wiring.take(value)
        elif key == "host":
            address = parse_address(value, None, _BACKENDS[self.backend])
            if address == self._address:
                return
            self._address = address
            link = self.wiring.link
            if self.is_open and link is not None:
                self.stop_all()
                link.close()
                self.set_status(ConnectionState.CONNECTING, f"connecting to {value}")
                self._start(searching=True)
        else:
            super().answer(key, value)


def _number(text: float | str) -> object:
    """Give what was typed on a command line as a number, if it is one."""
    try:
        return float(text)
    except ValueError:
        return text


def _refuse(channel: Channel, *_arguments: object, **_fields: object) -> None:
    why = channel.problem or channel.waiting or "its type is not known yet"
    raise BridgeError(f"`robot.{channel.wire.variable}` was not sent: {why}")


def _any_number(value: object) -> bool:
    if isinstance(value, Mapping):
        return any(map(_any_number, value.values()))
    return isinstance(value, (int, float)) and value != 0

"""The bridge to ROS: topics become variables and methods of `robot`.

A person connects them once, in the panel, from Python or in a set-up file; a program uses them
without knowing of topics::

    ros = RosBridge(host="turtle.local")
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")

    (running [robot.move(linear_x=0.2)])
    (event there [robot.odom.x > 1])

Back ends communicate with ROS: rosbridge (ROS 1 and 2) and dds (ROS 2), which need no ROS installation here,
and rospy (ROS 1) and rclpy (ROS 2), where Python can import them. `lrp_jupyter.bridges.ros.backends` chooses
one of them.

Paper: §7.1.
Deviation: §7.1 asks for the class of a PhaROS package when the interpreter starts; here the address
of the robot replaces it, asked once.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Collection, Iterable, Mapping
from functools import partial
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge, ConnectionState
from lrp_jupyter.bridges.guarding.guard import Stopper
from lrp_jupyter.bridges.member_tree import Limits, RobotMethod, RobotVariable, companion_path
from lrp_jupyter.bridges.message import Message, moves, real_number
from lrp_jupyter.bridges.panel import Panel, number_in
from lrp_jupyter.bridges.ros.backends import Choice, check_backend, check_ros2, choose_backend, make_transport
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.clock import ProgramPace
from lrp_jupyter.bridges.ros.link import GUARD_NODE, TopicLink, Transport
from lrp_jupyter.bridges.ros.panel import STALE_AFTER, Draft, draw_panel
from lrp_jupyter.bridges.ros.setup import Direction, Wire, check_type
from lrp_jupyter.bridges.ros.types import ReceivedMessage, RosMessage
from lrp_jupyter.bridges.ros.wiring import Wiring
from lrp_jupyter.errors import BridgeError, NoDataYet, ended

_HERE = "lrp_jupyter.bridges.ros.bridge:RosBridge"
_ANSWER = 1.0  # seconds that a person waits for a new connection to be made
_ANSWER_ALL = 2.0  # … and that opening waits for those of the set-up


class RosBridge(Bridge):
    """A ROS robot.

    Parameters
    ----------
    backend : {"auto", "rosbridge", "rospy", "rclpy", "dds"}
        ``"auto"``: the one that the environment is set up for, else the first that answers.
    host : str, optional
        Of the rosbridge server or the ROS master, ``host`` or ``host:port``; of an encrypted server
        ``wss://host/path``. Default: this machine or, with rospy, the value of ``ROS_MASTER_URI``. With
        dds: of a robot that cannot be found by multicast; default: none.
    port : int, optional
        Default: 9090 for rosbridge (443 with ``wss://``), 11311 for rospy.
    setup : path or mapping, optional
        The connections; see `lrp_jupyter.bridges.ros.setup`. Later
        changes are written to a file.
    patience : float
        Seconds that opening may take.
    node : str
        Name of the node on this side; a rosbridge server has its own.
    domain : int, optional
        Of ROS 2 (`dds`, `rclpy`). Default: ``ROS_DOMAIN_ID`` of the environment, or 0.
    messages : str or iterable of str
        Folders with definitions of message types, ``package/msg/Type.msg`` (`dds`); in a text
        they are separated as in ``PATH``.

    Raises
    ------
    BridgeError
        An option or the set-up has a mistake; the message names it.
    """

    name = "ros"
    stops_when_found = True  # each velocity topic, as soon as it is connected again

    def __init__(
        self,
        backend: str = "auto",
        host: str | None = None,
        port: int | str | None = None,
        setup: str | os.PathLike[str] | Mapping[str, object] | None = None,
        patience: float = 8.0,
        node: str = "lrp",
        domain: int | str | None = None,
        messages: str | Iterable[str] = "",
    ) -> None:
        super().__init__()
        self.backend = check_backend(backend, host, port)
        self._host, self._port = (host or "").strip(), port
        self._domain, self._messages = check_ros2(backend, domain, messages)
        self._node = node
        self._chosen: Choice | None = None
        self._patience = real_number(patience, "patience")
        self._draft = Draft()
        self.wiring = Wiring(self._offer, self._withdraw)
        self._in_tick = 0  # the thread of the tick that is under way: it must not wait
        self._pace = ProgramPace()
        if setup is not None:
            self.wiring.load(setup)

    # -- what is connected to what ----------------------------------------------------------------

    def subscribe(
        self,
        variable: str,
        topic: str,
        type: str = "",  # noqa: A002
        stale_after: float | None = None,
    ) -> None:
        """Subscribe ``robot.<variable>`` to a topic; its value is the last message.

        Idempotent; another topic replaces the first.

        Parameters
        ----------
        variable, topic : str
        type : str, optional
            Default: that of the live topic.
        stale_after : float, optional
            Seconds after which the last message is too old to drive by: then the reading fails, and the robot
            is stopped until there is a new one. Default: it never is.

        Raises
        ------
        BridgeError
            A name is illegal, the type unknown, or the topic carries another one.
        """
        self.connect(Wire(variable, "subscription", topic, type, stale_after=stale_after))

    def publish(self, variable: str, topic: str, type: str = "", limits: Limits | None = None) -> None:  # noqa: A002
        """Register ``robot.<variable>(…)`` as the publisher of a topic.

        Parameters
        ----------
        variable, topic : str
        type : str, optional
            Default: that of the live topic.
        limits : mapping of str to float or (float, float), optional
            ``{"linear": 0.5}``: larger numbers are clamped to -0.5 ... 0.5, and that is shown.

        Raises
        ------
        BridgeError
            As for `subscribe`.
        """
        self.connect(Wire(variable, "publisher", topic, type, dict(limits or {})))

    def remove(self, variable: str) -> None:
        """Remove a variable and its subscription or publisher.

        Raises
        ------
        BridgeError
            There is no variable of that name.
        """
        self.wiring.remove(variable)

    @property
    def setup(self) -> dict[str, Any]:
        """The set-up in its JSON form."""
        return self.wiring.as_dict()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the set-up to a file, now and after every change.

        Raises
        ------
        BridgeError
            The file cannot be written.
        """
        self.wiring.save(path)

    def connect(self, wire: Wire, wait: bool = True) -> None:
        """Connect a variable and, if `wait`, wait a moment for the robot's answer.

        Raises BridgeError: it cannot be connected; the previous connection stays.
        """
        may_wait = wait and threading.get_ident() != self._in_tick
        self.wiring.connect(wire, _ANSWER if may_wait else 0.0)

    # -- the robot --------------------------------------------------------------------------------

    def _offer(self, channel: Channel) -> None:
        """Register a channel as a member of the robot; again when its type is known."""
        wire = channel.wire
        try:
            if wire.direction == "subscription":
                reading = RobotVariable(
                    self,
                    wire.variable,
                    partial(self._read, channel),
                    f"the last message on {wire.topic}",
                    "",
                    channel.form.kind if channel.form is not None else channel.type,
                    channel.age,
                    wire.stale_after,
                )
                new = partial(self._new_messages, wire.variable, lambda _: channel.backlog)
                self._add_reading(reading, new, channel.own)
                channel.hear(companion_path(wire.variable, "new") in self.messages_taken)
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
        assert isinstance(message, RosMessage)
        if channel.is_velocity and not channel.has_moved:
            channel.has_moved = moves(message.as_dict())
        link.send(channel, message)

    def stop(self) -> None:
        """Publish a velocity of zero on every velocity topic."""
        failures = []
        for channel in self.wiring.channels:
            try:
                self.wiring.stand_still(channel)
            except BridgeError as error:
                if channel.has_moved or self._node == GUARD_NODE:  # a guard stops what others have moved
                    failures.append(str(error))
        if failures:
            raise BridgeError(f"{failures[0]} It is stopped as soon as it is found.")

    guarded_by = (
        "If this program dies or hangs, a guard process stops the robot. If this computer sleeps or is cut"
        " off, nothing does, unless `lrp guard` runs on the robot or its driver stops it when commands stop."
    )

    @property
    def failsafe(self) -> str:
        """Who stops the robot when this program or this computer dies, and what no stop reaches."""
        sent = [channel for channel in self.wiring.channels if channel.wire.direction == "publisher"]
        reached = [f"`{channel.wire.topic}`" for channel in sent if channel.is_velocity]
        others = [f"`{channel.wire.topic}`" for channel in sent if not channel.is_velocity]
        if not others:
            return super().failsafe
        how = f"Every stop is a velocity of zero on {' and '.join(reached)}" if reached else "No stop is sent"
        return f"{super().failsafe} {how}: what a message on {' or '.join(others)} has begun goes on."

    def stopper(self) -> Stopper | None:
        """Return a bridge with the same velocity topics and a connection of its own."""
        topics = {
            channel.wire.variable: {"topic": channel.wire.topic, "type": channel.type}
            for channel in self.wiring.channels
            if channel.is_velocity and channel.type
        }
        if self._chosen is None or not topics:
            return None
        where: dict[str, Any] = {"backend": self._chosen.backend, "host": self._host, "port": self._port}
        if self._domain is not None or self._messages:
            where |= {"domain": self._domain, "messages": self._messages}
        return Stopper(_HERE, {**where, "node": GUARD_NODE, "setup": {"publishers": topics}})

    def drives(self, method: RobotMethod, arguments: dict[str, object]) -> bool:
        """Return whether a command is a velocity that is not zero: other topics may carry anything."""
        return method.velocity and super().drives(method, arguments)

    def sense(self, now: float) -> None:
        """Latch the last messages: a tick sees one world."""
        self._in_tick = threading.get_ident()
        self._pace.tick()
        link = self.wiring.link
        if link is not None and link.connected:
            link.transport.pace = self._pace.seconds
        for channel in self.wiring.channels:
            channel.latch()

    def act(self, now: float) -> None:
        """Mark the end of the tick."""
        self._in_tick = 0
        for channel in self.wiring.channels:
            channel.release()

    def take_messages(self, readings: Collection[str]) -> None:
        """Have the robot send every message on these topics; on others, the last one is enough."""
        super().take_messages(readings)
        for channel in self.wiring.channels:
            channel.hear(companion_path(channel.wire.variable, "new") in self.messages_taken)
        if (link := self.wiring.link) is not None:
            link.hurry()

    # -- the connection ---------------------------------------------------------------------------

    def open_interface(self) -> Panel:
        """Connect to the robot, and connect all channels of the set-up.

        Raises BridgeError: there is no robot, or a library is not installed.
        """
        self._start(searching=False)
        self.wiring.wait_for_answers(_ANSWER_ALL)
        return self.panel()

    def close_interface(self) -> None:
        """End all connections; the set-up stays."""
        self.wiring.close()

    def _start(self, searching: bool) -> None:
        """Create a link, with a new channel for each connection of the set-up."""
        place = f"The robot at `{self._host}`" if self._host else "The robot"
        wiring = self.wiring
        link = TopicLink(self._find, place, lambda: wiring.channels, self._report, wiring.learned, self._warn)
        try:
            wiring.attach(link)
            if searching:
                link.search()
            elif not link.open(self._patience):
                raise BridgeError(f"{link.place} did not answer within {self._patience:g} s.")
        except BridgeError:
            wiring.link = None
            self.nodes.clear()
            raise

    def _find(self) -> Transport:
        """Return the way to the robot. On the link's thread, because it may have to ask who answers."""
        self._chosen = choose_backend(self.backend, self._host, self._port, self._domain)
        transport = make_transport(
            self._chosen.backend, self._host, self._port, self._warn, self._domain, self._messages
        )
        transport.node = self._node
        return transport

    def _warn(self, sentence: str) -> None:
        self.safety.notice("fault", sentence)

    def _report(self, state: ConnectionState, sentence: str) -> None:
        """Apply a change of the connection; stop a robot that may not answer. On the link's thread."""
        if state is not ConnectionState.LOST:
            sentence = f"{sentence} Back end: {self.connected_by}."
        self.set_status(state, sentence)
        link = self.wiring.link
        if state is ConnectionState.STALE and link is not None and link.transport.trouble():
            self.safety.notice("fault", sentence)
            self.stop_all()

    # -- the panel --------------------------------------------------------------------------------

    @property
    def topics(self) -> Mapping[str, str]:
        """The live topics with their types, as they were a moment ago."""
        link = self.wiring.link
        return link.topics if link is not None else {}

    @property
    def round_trip(self) -> float | None:
        """Recent median of the seconds until the robot answers; None where it is not measured."""
        link = self.wiring.link
        return link.transport.round_trip if link is not None and link.connected else None

    @property
    def address(self) -> str:
        """The robot's address; empty: this machine, or the one that the environment names."""
        return f"{self._host}:{self._port}" if self._host and self._port else self._host

    @property
    def connected_by(self) -> str:
        """The back end, and why it is this one if it was chosen here."""
        chosen = self._chosen
        return self.backend if chosen is None else str(chosen)

    def panel(self) -> Panel:
        """Return the table of connections, the fields for a new one, and the live topics."""
        return draw_panel(
            status=self.status.sentence,
            backend=self.connected_by,
            address=self.address,
            round_trip=self.round_trip,
            setup=self.wiring.path,
            draft=self._draft,
            channels=self.wiring.channels,
            topics=self.topics,
        )

    def press(self, key: str, row: str = "", values: Mapping[str, str] | None = None) -> None:
        """Press a button: ``subscribe`` and ``publish`` use the values of the fields, without waiting.

        Raises BridgeError: a name is illegal, or there is no such button or row.
        """
        fields = values or {}
        variable = fields.get("variable", "").strip()
        if key in ("subscribe", "publish"):
            type_ = check_type(fields.get("type", ""), self.topics.values())
            direction: Direction = "subscription" if key == "subscribe" else "publisher"
            late = fields.get("stale_after", "").strip()
            if late and direction == "publisher":
                raise BridgeError(f"`{STALE_AFTER}` is for subscriptions. Leave it empty for a publisher.")
            stale_after = number_in(late, STALE_AFTER) if late else None
            wire = Wire(variable, direction, fields.get("topic", ""), type_, stale_after=stale_after)
            self.connect(wire, wait=False)
            self._draft = Draft()
        elif key == "pick":
            self._draft = Draft(variable or row.rpartition("/")[2], row, self.topics.get(row, ""))
        elif key == "remove":
            self.remove(row)
        elif key == "save":
            path = fields.get("setup", "").strip() or self.wiring.path
            if not path:
                raise BridgeError("The set-up has no file yet. Name one.")
            self.save(path)
        else:
            super().press(key, row, values)

    def answer(self, key: str, value: str) -> None:
        """Apply the robot's address, or the file with the set-up; an open bridge reconnects.

        Raises BridgeError: it is not an address, or not a set-up.
        """
        if key == "setup":
            self.wiring.load(value)
        elif key == "host":
            check_backend(self.backend, value, None)
            if value == self.address:
                return
            self._host, self._port = value.strip(), None
            link = self.wiring.link
            if self.is_open and link is not None:
                self.stop_all()
                link.close()
                self.set_status(ConnectionState.CONNECTING, f"Connecting to {value}.")
                self._start(searching=True)
        else:
            super().answer(key, value)


def _refuse(channel: Channel, *_arguments: object, **_fields: object) -> None:
    why = channel.problem or channel.waiting or "its type is not known yet"
    raise BridgeError(f"`robot.{channel.wire.variable}` was not sent: {ended(why)}")

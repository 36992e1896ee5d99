"""The bridge to ROS: topics become variables and methods of `robot`, actions and services tasks.

A person connects them once, in the panel, from Python or in a set-up file; a program uses them
without knowing of topics::

    ros = RosBridge(host="turtle.local")
    ros.subscribe("odom", "/odom")
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")
    ros.action("drive_to", "/move_base")
    ros.parameter("max_speed", "/max_speed")

    (running [robot.move(linear_x=0.2)])
    (event there [robot.odom.x > 1])
    (running [robot.drive_to(target_pose_pose_position_x=2.0)])
    (on [robot.drive_to.succeeded] going -> there)

Back ends communicate with ROS: rosbridge (ROS 1 and 2) and dds (ROS 2), which need no ROS installation here,
and rospy (ROS 1) and rclpy (ROS 2), where Python can import them. `lrp_jupyter.bridges.ros.backends` chooses
one of them.

Paper: §7.1.
Deviation: §7.1 asks for the class of a PhaROS package when the interpreter starts; here the address
of the robot replaces it, asked once.
"""

from __future__ import annotations

import contextlib
import math
import os
import threading
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, Literal

from lrp_jupyter.bridges.bridge import Bridge, ConnectionState, Task
from lrp_jupyter.bridges.guarding.guard import Stopper
from lrp_jupyter.bridges.member_tree import AgeLimit, Limits, RobotMethod, RobotVariable, companion_path
from lrp_jupyter.bridges.message import Message, moves, real_number
from lrp_jupyter.bridges.panel import Panel
from lrp_jupyter.bridges.ros.backends import (
    Choice,
    backend_here,
    check_backend,
    check_ros2,
    choose_backend,
    make_transport,
)
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.clock import ProgramPace, RobotClock
from lrp_jupyter.bridges.ros.link import GUARD_NODE, SIM_TIME, TopicLink, Transport, check_sent
from lrp_jupyter.bridges.ros.names import GraphNames
from lrp_jupyter.bridges.ros.outlets import StateOutlet
from lrp_jupyter.bridges.ros.panel import (
    STALE_AFTER,
    VELOCITY,
    Draft,
    draw_panel,
    may_be_velocity,
    stale_after_in,
    velocity_in,
)
from lrp_jupyter.bridges.ros.ros_request import RosRequest
from lrp_jupyter.bridges.ros.rosout import LogOutlet
from lrp_jupyter.bridges.ros.setup import (
    DESCRIPTION,
    KINDS,
    MEASURED,
    TASKS,
    Direction,
    Wire,
    check_type,
    name_for,
    setup_as_dict,
)
from lrp_jupyter.bridges.ros.sim_time import TOPIC as CLOCK_TOPIC
from lrp_jupyter.bridges.ros.sim_time import ClockChannel, SimTime
from lrp_jupyter.bridges.ros.transforms import Transform, TransformTree
from lrp_jupyter.bridges.ros.types import RosMessage
from lrp_jupyter.bridges.ros.types_here import TypesHere
from lrp_jupyter.bridges.ros.wiring import Wiring
from lrp_jupyter.bridges.tasks import RobotTask
from lrp_jupyter.errors import BridgeError, NoAnswerError, NoDataYet, ended

_HERE = "lrp_jupyter.bridges.ros.bridge:RosBridge"
_ANSWER = 1.0  # seconds that a person waits for a new connection to be made
_ANSWER_ALL = 2.0  # … and that opening waits for those of the set-up
_BUTTONS: Mapping[str, Direction] = {
    "subscribe": "subscription",
    "publish": "publisher",
    "action": "action",
    "service": "service",
    "parameter": "parameter",
}


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
        The connections, or a file with them, which ``lrp bridges ros`` describes. Later changes are written
        to the file.
    patience : float or "inf"
        Seconds for which opening waits for a master, a server or a robot that does not answer yet.
    node : str, optional
        Name of the node on this side, which no other node may have; a rosbridge server has its own.
        Default: one that begins with ``lrp_`` and differs each time.
    domain : int, optional
        Of ROS 2 (`dds`, `rclpy`). Default: ``ROS_DOMAIN_ID`` of the environment, or 0.
    messages : str or iterable of str
        Folders with definitions of message types, ``package/msg/Type.msg`` (`dds`); in a text
        they are separated as in ``PATH``.
    namespace : str, optional
        Of the node, as ``/robot1``: the topic ``odom`` is then ``/robot1/odom``. Default:
        ``ROS_NAMESPACE`` of the environment, or the root.
    remap : str, iterable of str, or mapping of str to str
        Rules ``from:=to`` that replace the names of topics, actions and services; in a text they are
        separated by spaces or commas.
    state_topic : str
        A topic for others: what happens in the run, as JSON in a ``std_msgs/String``. Default: none.
    sim_time : bool, optional
        Whether the time is that of ``/clock``: of a simulation, or of a bag. Default: what ``/use_sim_time``
        says in ROS 1 when the bridge is opened; in ROS 2, no.

    Raises
    ------
    BridgeError
        An option or the set-up has a mistake; the message names it.
    """

    name = "ros"
    about_options = DESCRIPTION
    stops_when_found = True  # each velocity topic, as soon as it is connected again

    def __init__(
        self,
        backend: str = "auto",
        host: str | None = None,
        port: int | str | None = None,
        setup: str | os.PathLike[str] | Mapping[str, object] | None = None,
        patience: float | Literal["inf"] = 8.0,
        node: str | None = None,
        domain: int | str | None = None,
        messages: str | Iterable[str] = "",
        namespace: str | None = None,
        remap: str | Iterable[str] | Mapping[str, str] = "",
        state_topic: str = "",
        sim_time: bool | None = None,
    ) -> None:
        super().__init__()
        self.backend = check_backend(backend, host, port)
        self._host, self._port = (host or "").strip(), port
        self._domain, self._messages = check_ros2(backend, domain, messages)
        self._is_guard = node == GUARD_NODE  # of which there may be many
        own_name = None if self._is_guard else node
        self.names = GraphNames(own_name, namespace, remap, stem=GUARD_NODE if self._is_guard else "lrp")
        self._chosen: Choice | None = None
        self._patience = math.inf if patience in ("inf", math.inf) else real_number(patience, "patience")
        self._draft = Draft()
        self.wiring = Wiring(self.names, self._offer, self._withdraw)
        self._log = LogOutlet()
        self._states = StateOutlet(self._global(state_topic)) if state_topic else None
        self.tells_why = self._states is not None
        self._in_tick = 0  # the thread of the tick that is under way: it must not wait
        self._pace = ProgramPace()
        self._wants_sim_time = sim_time
        self._time: ClockChannel | None = None  # while the time is that of `/clock`
        if setup is not None:
            self.wiring.load(setup)

    # -- what is connected to what ----------------------------------------------------------------

    def subscribe(
        self,
        variable: str,
        topic: str,
        type: str = "",  # noqa: A002
        stale_after: float | Literal["measured"] | None = MEASURED,
    ) -> None:
        """Subscribe ``robot.<variable>`` to a topic; its value is the last message.

        Idempotent; another topic replaces the first. Of transforms (``/tf``, with ``/tf_static``) it is a
        method: ``robot.tf("map", "base_link")`` is where the second frame is in the first.

        Parameters
        ----------
        variable, topic : str
        type : str, optional
            Default: that of the live topic.
        stale_after : float, None or "measured"
            Seconds after which the last message is too old to drive by: then the reading fails, and the robot
            is stopped until there is a new one. None: it never is. ``"measured"``: once messages came
            steadily, when none has come for a second more than twice the longest recent pause.

        Raises
        ------
        BridgeError
            A name is illegal, the type unknown, or the topic carries another one.
        """
        self.connect(Wire(variable, "subscription", topic, type, stale_after=stale_after))

    def publish(
        self,
        variable: str,
        topic: str,
        type: str = "",  # noqa: A002
        limits: Limits | None = None,
        at_stop: Mapping[str, object] | None = None,
        at_tick: Mapping[str, object] | None = None,
        velocity: bool | None = None,
    ) -> None:
        """Register ``robot.<variable>(…)`` as the publisher of a topic.

        Parameters
        ----------
        variable, topic : str
        type : str, optional
            Default: that of the live topic.
        limits : mapping of str to float or (float, float), optional
            ``{"linear": 0.5}``: larger numbers are clamped to -0.5 ... 0.5, and that is shown.
        at_stop : mapping of str to object, optional
            The fields of a message that is published whenever the robot is stopped; ``{}`` is one in which
            nothing is set. Default: of velocities, a zero; of other types, nothing is published.
        at_tick : mapping of str to object, optional
            The fields of a message that is published in every tick while the robot is armed, so that the
            robot's side knows that the program is there. Default: nothing is published.
        velocity : bool, optional
            Whether the robot moves by it until another one comes, and a message of zeros stops it. Default:
            for a twist, an Ackermann drive, and what is called ``move``.

        Raises
        ------
        BridgeError
            As for `subscribe`.
        """
        limits = dict(limits or {})
        sent: dict[str, Any] = {"velocity": velocity, "at_stop": at_stop, "at_tick": at_tick}
        self.connect(Wire(variable, "publisher", topic, type, limits, **sent))

    def action(self, variable: str, action: str, type: str = "", limits: Limits | None = None) -> None:  # noqa: A002
        """Register ``robot.<variable>(…)`` as a task: a goal of an action, which a stop cancels.

        Parameters
        ----------
        variable, action : str
        type : str, optional
            ``package/Type``. Default: that of the live action.
        limits : mapping of str to float or (float, float), optional
            As for `publish`, of the fields of a goal.

        Raises
        ------
        BridgeError
            As for `subscribe`; or the back end has no actions (`dds`).
        """
        self.connect(Wire(variable, "action", action, type, dict(limits or {})))

    def service(self, variable: str, service: str, type: str = "") -> None:  # noqa: A002
        """Register ``robot.<variable>(…)`` as a task: a call of a service, which cannot be cancelled.

        Parameters
        ----------
        variable, service : str
        type : str, optional
            ``package/Type``. Default: that of the live service.

        Raises
        ------
        BridgeError
            As for `action`.
        """
        self.connect(Wire(variable, "service", service, type))

    def parameter(self, variable: str, parameter: str) -> None:
        """Register ``robot.<variable>`` as the value of a parameter, which is followed.

        A number, a text, a truth value, or a tuple of them; a group of ROS 1 has those in it as fields.

        Parameters
        ----------
        variable : str
        parameter : str
            ``/max_speed``; in ROS 2, with its node: ``/controller:max_speed``.

        Raises
        ------
        BridgeError
            A name is illegal, or the back end has no parameters (`dds`).
        """
        self.connect(Wire(variable, "parameter", parameter))

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

    def _global(self, state_topic: str) -> str:
        try:
            return self.names.resolve(Wire("state", "publisher", state_topic).topic)
        except BridgeError as error:
            raise BridgeError(f"`state_topic`: {error}") from None

    def _types_here(self) -> TypesHere:
        backend = backend_here(self.backend, self._host, self._port, self._domain)
        return TypesHere(backend, self._messages)

    def check_set_up(self) -> bool:
        """Return whether there is a set-up; BridgeError: it limits or sends a field that does not exist."""
        channels = self.wiring.channels
        if self.is_open:  # the robot itself has told its types
            return bool(channels)
        here = self._types_here()
        for channel in channels:
            here.describe(channel)
            try:
                check_sent(channel)
            except BridgeError as error:
                place = f"`{channel.wire.direction}s.{channel.wire.variable}`"
                raise BridgeError(f"{self.wiring.path or 'The set-up'}, {place}: {error}") from None
        return bool(channels)

    def add_members(self) -> None:
        """Add what the set-up names, with the fields of the types that are known on this computer."""
        here = self._types_here()
        for channel in self.wiring.channels:
            here.describe(channel)
            self._offer(channel)

    def _offer(self, channel: Channel) -> None:
        """Register a channel as a member of the robot; again when its type is known."""
        wire = channel.wire
        try:
            if channel.tree is not None:
                self._offer_transforms(channel, channel.tree)
            elif wire.is_read:
                reading = RobotVariable(
                    self,
                    wire.variable,
                    partial(self._read, channel),
                    f"the {'last message on' if wire.kind == 'topic' else 'parameter'} {wire.topic}",
                    "",
                    channel.form.kind if channel.form is not None else channel.type or None,
                    lambda: channel.age(bool(self.latch)),
                    None if wire.stale_after is None else channel.age_limit,
                )
                self._add_reading(reading, partial(self._contents, channel), channel.own)
                channel.arrivals.hear(companion_path(wire.variable, "new") in self.messages_taken)
            elif wire.direction in TASKS:
                is_action = wire.direction == "action"
                self.add_task(
                    wire.variable,
                    partial(self._begin, channel) if channel.message else partial(_refuse, channel),
                    partial(self._cancel, channel) if is_action else None,
                    f"{'a goal of' if is_action else 'a call of'} {wire.topic}, {channel.type}".rstrip(", "),
                    message=channel.message,
                    limits=wire.limits if channel.message else None,
                    moves=is_action,
                    replaces=is_action,
                )
            else:
                self.add_method(
                    wire.variable,
                    partial(self._send, channel) if channel.message else partial(_refuse, channel),
                    f"publish a {channel.type or 'message'} on {wire.topic}",
                    message=channel.message,
                    velocity=channel.is_velocity,
                    limits=wire.limits if channel.message else None,
                    mover=wire.topic if channel.is_velocity else "",
                )
        except ValueError as error:
            raise BridgeError(f"`robot.{wire.variable}` cannot be connected: {error}") from error

    def _withdraw(self, variable: str) -> None:
        if variable in self.nodes.table:
            self.remove_member(variable)

    def _read(self, channel: Channel) -> object:
        arrival = channel.arrivals.seen(bool(self.latch))
        if arrival is not None:
            return arrival.value
        if channel.problem:
            raise BridgeError(f"`robot.{channel.wire.variable}`: {channel.problem}")
        why = f": {channel.waiting}" if channel.wire.direction == "parameter" else " has no data yet."
        raise NoDataYet(f"`robot.{channel.wire.variable}`{why}")

    def _offer_transforms(self, channel: Channel, tree: TransformTree) -> None:
        """Register the method that looks a frame up, and the age of what the program has looked up."""

        def oldest() -> tuple[float, AgeLimit]:
            return tree.oldest(channel.clock.now(), channel.limit_of)

        variable = channel.wire.variable
        age = RobotVariable(
            self,
            f"{variable}.age",
            lambda: oldest()[0],
            "seconds since the oldest transform arrived that the program has asked for",
            "s",
            float,
            lambda: oldest()[0],
            None if channel.wire.stale_after is None else lambda: oldest()[1],
            variable,
        )
        age.is_used = True
        self.add_method(
            variable,
            partial(self._transform, channel),
            "where the source frame is in the target frame: `x`, `y`, `yaw`, `translation`, …",
            command=False,
        )
        self.nodes.accompany(variable, age)

    def _transform(self, channel: Channel, target_frame: str, source_frame: str) -> Transform:
        """Return where a frame is in another one, by what the tick sees."""
        call = f"robot.{channel.wire.variable}"
        for frame in (target_frame, source_frame):
            if not isinstance(frame, str):
                raise BridgeError(
                    f'`{call}` takes the names of two frames, as in `{call}("map", "base_link")`.'
                )
        assert channel.tree is not None
        now, in_tick = channel.clock.now(), bool(self.latch)
        try:
            return channel.tree.lookup(target_frame, source_frame, now, in_tick, channel.limit_of)
        except (NoDataYet, BridgeError) as error:
            if channel.problem:
                raise BridgeError(f"`{call}`: {channel.problem}") from None
            raise type(error)(f"`{call}`: {error}") from None

    def _contents(self, channel: Channel) -> tuple[object, ...]:
        messages = self._new_messages(channel.wire.variable, channel.arrivals)
        return tuple(getattr(message, "_content", message) for message in messages)  # or values of parameters

    def _link(self) -> TopicLink:
        if self.wiring.link is None:
            raise BridgeError("The bridge `ros` is closed.")
        return self.wiring.link

    def _send(self, channel: Channel, message: Message) -> None:
        link = self._link()
        assert isinstance(message, RosMessage)
        if channel.is_velocity and not channel.has_moved:
            channel.has_moved = moves(message.as_dict())
        link.send(channel, message)

    def _begin(self, channel: Channel, task: Task, message: Message) -> None:
        """Ask for a goal, then cancel the one that it replaces: the robot does not stop between them."""
        link = self._link()
        assert isinstance(message, RosMessage)
        request = RosRequest(task, channel.wire.direction == "service", channel.decode)
        channel.requests.append(request)
        try:
            link.ask(channel, message, request)
        finally:
            if task.replaced is not None:
                self._cancel(channel, task.replaced)

    def _cancel(self, channel: Channel, task: Task) -> None:
        link = self.wiring.link
        for request in tuple(channel.requests):
            if request.task is task and link is not None and not request.is_over:
                link.cancel(channel, request)

    def stop(self) -> None:
        """Publish a velocity of zero on every velocity topic, and what the set-up names; cancel goals.

        Of our own goals, those that are not wanted any more: where all is stopped, none is; and where only a
        velocity is overdue, the tasks go on. A guard cancels the goals of every client.
        """
        if self.gone:
            return
        failures, is_guard = [], self._is_guard
        for channel in self.wiring.channels:
            goals = [request for request in channel.unfinished if not request.is_wanted()]
            is_everyone = is_guard and channel.wire.direction == "action"
            try:
                self.wiring.stop(channel, (None,) if is_everyone else goals)
            except BridgeError as error:
                if channel.may_move or is_guard:  # a guard stops what others have moved
                    failures.append(str(error))
        if failures:
            raise BridgeError(f"{failures[0]} It is stopped as soon as it is found.")

    def stop_mover(self, mover: str) -> None:
        """Publish a zero where the program gives no more velocities; what else it drives goes on."""
        velocities = {each.wire.topic: each for each in self.wiring.channels if each.is_velocity}
        if len(velocities) > 1 and mover in velocities:
            with contextlib.suppress(BridgeError):
                self.wiring.stop(velocities[mover], ())
                self.safety.moving(mover, False, mover)
                return
        super().stop_mover(mover)

    guarded_by = (
        "If this program dies or hangs, a guard process stops the robot. If this computer sleeps or is cut"
        " off, nothing does, unless `lrp guard` runs on the robot or its driver stops it when commands stop."
    )

    @property
    def failsafe(self) -> str:
        """Who stops the robot when this program or this computer dies, and what no stop reaches."""
        sent = [channel for channel in self.wiring.channels if not channel.wire.is_read]
        zeros = _names(each for each in sent if each.is_velocity and each.wire.at_stop is None)
        named = _names(channel for channel in sent if channel.wire.at_stop is not None)
        goals = _names(channel for channel in sent if channel.wire.direction == "action")
        moving = [channel for channel in sent if channel.wire.at_tick is None]  # the others begin nothing
        others = _names((channel for channel in moving if not _is_stopped(channel)), " or ")
        unheard = "".join(
            f" {channel.unheard[0].upper()}{ended(channel.unheard[1:])}"
            for channel in sent
            if channel.unheard
        )
        if not (others or named or goals):
            return f"{super().failsafe}{unheard}"
        does = (
            zeros and f"is a velocity of zero on {zeros}",
            goals and f"cancels the goals of {goals}",
            named and f"sends what the set-up says on {named}",
        )
        how = f"Every stop {' and '.join(filter(None, does))}" if any(does) else "No stop is sent"
        rest = f": what was sent to {others} and has begun goes on" if others else ""
        return f"{super().failsafe} {how}{rest}.{unheard}"

    def stopper(self) -> Stopper | None:
        """Return a bridge that can stop the same things, with a connection of its own."""
        stopped = [channel for channel in self.wiring.channels if channel.type and _is_stopped(channel)]
        if self._chosen is None or not stopped:
            return None
        setup = setup_as_dict(replace(each.wire, type=each.type, limits={}) for each in stopped)
        where: dict[str, Any] = {"backend": self._chosen.backend, "host": self._host, "port": self._port}
        if self._domain is not None or self._messages:
            where |= {"domain": self._domain, "messages": self._messages}
        own = {"node": GUARD_NODE, "namespace": self.names.namespace, "sim_time": False}
        return Stopper(_HERE, {**where, **own, "setup": setup})

    def drives(self, method: RobotMethod, arguments: dict[str, object]) -> bool:
        """Return whether a command is a velocity that is not zero, or a goal: other topics carry anything."""
        return (method.velocity or isinstance(method, RobotTask)) and super().drives(method, arguments)

    def sense(self, now: float) -> None:
        """Latch the last messages: a tick sees one world."""
        self._in_tick = threading.get_ident()
        self._pace.tick()
        link = self.wiring.link
        if link is not None and link.connected:
            link.transport.pace = self._pace.seconds
        moves = bool(self.safety.motion or self.requested.moving())
        for channel in self.wiring.channels:
            channel.motion.note(moves, channel.clock.now())
            channel.arrivals.latch()
            if channel.tree is not None:
                channel.tree.latch()
        if self._time is not None:
            self._judge_steps(self._time.time)

    def _judge_steps(self, time: SimTime) -> None:
        """Note that the time comes in steps that are longer than the period of the ticks."""
        if time.step > 1.5 * self.safety.period:
            text = (
                f"The time on `{CLOCK_TOPIC}` comes in steps of {time.step:.2g} s, so there are"
                f" {1 / time.step:.2g} ticks per second, not {1 / self.safety.period:.3g}."
            )
            self.safety.notice("fault", text, f"{CLOCK_TOPIC} step", renews=True)

    def act(self, now: float) -> None:
        """Mark the end of the tick, and publish what the set-up says is published in each."""
        self._in_tick, channels = 0, self.wiring.channels
        gone = self.safety.motion.keys() - {"", *(each.wire.topic for each in channels if each.is_velocity)}
        for mover in gone:  # it was stopped when it was disconnected
            self.safety.moving(mover, False, mover)
        for channel in channels:
            if channel.wire.at_tick is not None and self.safety.armed:
                self.wiring.say_in_tick(channel)

    def tell(self, told: Mapping[str, Any]) -> None:
        """Publish what happens in the run."""
        if self._states is not None:
            self._states.put(told)
        self._log.tell(told)

    def take_messages(self, readings: Collection[str]) -> None:
        """Have the robot send every message on these topics; on others, the last one is enough."""
        super().take_messages(readings)
        for channel in self.wiring.channels:
            channel.arrivals.hear(companion_path(channel.wire.variable, "new") in self.messages_taken)
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
        outlets = () if self._is_guard else tuple(filter(None, (self._log, self._states)))
        link = TopicLink(self._find, place, self._channels, self._report, wiring.learned, self._warn, outlets)
        link.has_sim_time, self._time = self._wants_sim_time, None
        try:
            wiring.attach(link)
            if searching:
                link.search()
            elif not link.open(self._patience, again=not self._is_guard):
                raise NoAnswerError(f"{link.place} did not answer within {self._patience:g} s.")
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
        transport.names = self.names
        transport.ending = self._end
        return transport

    def _channels(self) -> tuple[Channel, ...]:
        """Return the wanted connections, with that of `/clock` where it counts. On the link's thread."""
        link, is_open = self.wiring.link, self._wants_sim_time is None
        if self._time is not None:
            return self._time, *self.wiring.all_channels
        if link is None or not link.live:  # the robot is not found yet
            return self.wiring.all_channels
        if link.has_sim_time:
            reason = f"`{SIM_TIME}`" if is_open else "`sim_time`"
            self._time = ClockChannel(SimTime(self._went_back), reason)
            link.transport.clock.world = self._time.time
            return self._channels()
        if is_open and CLOCK_TOPIC in self.topics and link.transport.taken(CLOCK_TOPIC):
            text = (
                f"There is a time on `{CLOCK_TOPIC}`, but this program goes by that of its computer. If the"
                f" robot is simulated, or a bag is played, set `sim_time=true` (in ROS 1, `{SIM_TIME}`)."
            )
            self.safety.notice("fault", text, CLOCK_TOPIC)
        return self.wiring.all_channels

    @property
    def world_clock(self) -> SimTime | None:
        """The time on ``/clock``, where that is the robot's."""
        return None if self._time is None else self._time.time

    def world_time(self) -> float:
        """Return the time of ROS: that on ``/clock``, or else of this computer."""
        clock = RobotClock()
        clock.world = self.world_clock
        return clock.time_ns() / 1e9

    def _went_back(self, seconds: float) -> None:
        text = (
            f"The time on `{CLOCK_TOPIC}` went back by {seconds:.1f} s: a simulation was reset, or a bag"
            " began again. The program goes on, and its own time with it."
        )
        self.safety.notice("fault", text, CLOCK_TOPIC, renews=True)

    def _end(self, why: str) -> None:
        """Stop the robot for the last time; nothing moves it any more."""
        self.set_status(ConnectionState.LOST, why)
        self.stop_all()
        self.gone = why

    def _warn(self, sentence: str) -> None:
        self.safety.notice("fault", sentence)

    def _report(self, state: ConnectionState, sentence: str) -> None:
        """Apply a change of the connection; stop a robot that may not answer. On the link's thread."""
        if state is ConnectionState.CONNECTING:
            if self._patience == math.inf:
                sentence = f"Waiting for the robot: {sentence}"
            else:  # the rest follows then
                first = sentence.partition(". ")[0]
                sentence = f"Waiting for the robot, at most {self._patience:g} s: {ended(first)}"
        elif state is not ConnectionState.LOST:
            sentence = f"{sentence} Back end: {ended(self.connected_by)}"
        self.set_status(state, sentence)
        link = self.wiring.link
        if state is ConnectionState.STALE and link is not None and link.transport.trouble():
            self.safety.notice("fault", sentence)
            self.stop_all()

    @property
    def unreached(self) -> str:
        """Why a run that ends now did not have its robot, a sentence; empty: it had."""
        channels = self.wiring.all_channels
        if channels and not any(channel.has_worked or channel.works for channel in channels):
            return f"Nothing of the robot ever worked. {self.status.sentence}"
        return super().unreached

    # -- the panel --------------------------------------------------------------------------------

    @property
    def topics(self) -> Mapping[str, str]:
        """The live topics with their types, as they were a moment ago."""
        return self.live.get("topic", {})

    @property
    def live(self) -> Mapping[str, Mapping[str, str]]:
        """What is live, with types as far as they are known: ``topic``, ``action`` and ``service``."""
        link = self.wiring.link
        return link.live if link is not None else {}

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
        """Return the table of connections, the fields for a new one, and what is live."""
        return draw_panel(
            status=self.status.sentence,
            backend=self.connected_by,
            address=self.address,
            round_trip=self.round_trip,
            setup=self.wiring.path,
            draft=self._draft,
            channels=self.wiring.channels,
            live=self.live,
        )

    def press(self, key: str, row: str = "", values: Mapping[str, str] | None = None) -> None:
        """Press a button; those for a new connection use the values of the fields, without waiting.

        Raises BridgeError: a name is illegal, or there is no such button or row.
        """
        fields = values or {}
        variable = fields.get("variable", "").strip()
        if key in _BUTTONS:
            direction = _BUTTONS[key]
            live = self.live.get(KINDS[direction], {})
            type_ = check_type(fields.get("type", ""), direction, live.values())
            late = fields.get("stale_after", "").strip()
            speed = fields.get("velocity", "").strip()
            for label, text, kind in ((STALE_AFTER, late, "subscription"), (VELOCITY, speed, "publisher")):
                if text and direction != kind:
                    raise BridgeError(f"`{label}` is for {kind}s. Leave it empty for other connections.")
            said: dict[str, Any] = {"stale_after": stale_after_in(late), "velocity": velocity_in(speed)}
            wire = Wire(variable, direction, fields.get("topic", ""), type_, **said)
            self.connect(wire, wait=False)
            self._draft = Draft()
        elif key == "pick":
            types = filter(None, (names.get(row) for names in self.live.values()))
            taken = {each.wire.variable for each in self.wiring.channels if each.wire.topic != row}
            type_ = next(types, "")
            speed = "yes" if may_be_velocity(row, type_) else ""
            self._draft = Draft(variable or name_for(row, taken), row, type_, speed)
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


def _is_stopped(channel: Channel) -> bool:
    """Return whether a stop reaches what goes over a channel."""
    wire = channel.wire
    return channel.is_velocity or wire.direction == "action" or wire.at_stop is not None


def _names(channels: Iterable[Channel], conjunction: str = " and ") -> str:
    return conjunction.join(f"`{channel.wire.topic}`" for channel in channels)


def _refuse(channel: Channel, *_arguments: object, **_fields: object) -> None:
    why = channel.problem or channel.waiting or "its type is not known yet"
    raise BridgeError(f"`robot.{channel.wire.variable}` was not sent: {ended(why)}")

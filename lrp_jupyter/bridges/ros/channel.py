"""One variable of the robot and its topic, while the bridge is open.

Owner: messages arrive on one thread; what the connection decides (`problem`, `waiting`, `handle`, …)
belongs to the thread of the link. Each is replaced by one assignment; any thread may read it.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from typing import Any

from lrp_jupyter.bridges.latched_values import Arrival, Arrivals
from lrp_jupyter.bridges.member_tree import AgeLimit
from lrp_jupyter.bridges.ros.clock import RobotClock, Stamps
from lrp_jupyter.bridges.ros.parameters import as_reading
from lrp_jupyter.bridges.ros.rhythm import Motion, Rhythm
from lrp_jupyter.bridges.ros.ros_request import RosRequest
from lrp_jupyter.bridges.ros.setup import MEASURED, Wire
from lrp_jupyter.bridges.ros.transforms import TRANSFORMS, TransformTree
from lrp_jupyter.bridges.ros.types import VELOCITIES, Form, RosMessage, Types
from lrp_jupyter.errors import ended

_SWITCHED_OFF = (
    'If it may be silent for longer, say so: `"stale_after": null` in the set-up, `stale_after=None` in'
    " Python, or `never` as **Too old after** in the panel."
)

_STATIC = "_static"  # how the name of a topic ends that has the static transforms beside those of another


class Channel:
    """A wire with the state of its connection.

    `resolve`: returns the global name that a name means.
    `tree`: of what arrives, if that is static transforms beside others.
    """

    def __init__(
        self, wire: Wire, resolve: Callable[[str], str] = str, tree: TransformTree | None = None
    ) -> None:
        self.written = wire  # as the set-up has it
        self.wire = replace(wire, topic=resolve(wire.topic))
        self._resolve = resolve
        self.tree = tree  # of what arrives, if that is transforms
        self.static: Channel | None = None  # their other topic
        self.form: Form | None = None  # decodes messages or results, if the type is known
        self.feedback_form: Form | None = None  # … and those in between, of an action
        self.message: type[RosMessage] | None = None  # that is sent, if the type is known
        self.lists: Collection[str] = ()  # the fields of that that may have any number of numbers
        self.requests: deque[RosRequest] = deque(maxlen=20)  # the last ones
        self.arrivals = Arrivals[Any]()  # messages, or values of a parameter, by the clock
        self.live = False
        self.problem = ""  # why it cannot be connected, or is no longer connected
        self.waiting = "it is being connected"  # what is missing: the topic, its type, or messages
        self.is_unclear = False  # whether some number was infinite or NaN, and it is not known which
        self.is_asked_for = False  # whether the robot is being asked for what is missing
        self.commanders: tuple[str, ...] = ()  # of a publisher of velocities: who else publishes on its topic
        self.unheard = ""  # of a publisher of velocities: that no node hears it, a sentence
        self.clock = RobotClock()
        self.stamps = Stamps(self.clock)
        self.handle: object = None
        self.has_worked = False
        self.has_moved = False  # whether a nonzero velocity was sent: on a loss, a stop may not have arrived
        self.owes_stop = False  # as soon as there is a connection again
        self.answered = threading.Event()
        self.last_sent: RosMessage | None = None
        self.rhythm = Rhythm()  # of what arrives or is sent
        self.motion = Motion()  # of the robot
        self._under_way = 0.0  # s, for which the last message was
        self._told = ""  # the last value of a parameter, as text
        self.take_type(wire.type)

    def take_type(self, type_: str) -> None:
        """Take the type of the messages: of the set-up, or of the live topic; empty while it is unknown."""
        self.type = type_
        if type_ == TRANSFORMS and self.wire.direction == "subscription" and self.tree is None:
            self.tree = TransformTree()
            if not self.is_static:
                topic = f"{self.written.topic}{_STATIC}"
                static = replace(self.written, topic=topic, type=type_, stale_after=None)
                self.static = Channel(static, self._resolve, self.tree)

    @property
    def is_static(self) -> bool:
        """Whether transforms arrive that are published once, if there are any."""
        return self.tree is not None and self.written.topic.endswith(_STATIC)

    @property
    def takes_all(self) -> bool:
        """Whether every message counts, and not only the last one."""
        return self.tree is not None or self.arrivals.is_heard

    @property
    def is_velocity(self) -> bool:
        """Whether a message of zeros stops the robot."""
        said, is_move = self.wire.velocity, self.wire.variable.rpartition(".")[2] == "move"
        is_one = self.type in VELOCITIES or is_move if said is None else said
        return self.wire.direction == "publisher" and is_one

    @property
    def unfinished(self) -> tuple[RosRequest, ...]:
        """The goals of an action that the robot may be busy with."""
        if self.wire.direction != "action":
            return ()
        return tuple(request for request in tuple(self.requests) if not request.is_over)

    @property
    def works(self) -> bool:
        """Whether a message has arrived, or one can be sent to whoever is there."""
        if self.wire.is_read:
            return self.latest is not None
        return self.handle is not None and not (self.problem or self.waiting)

    @property
    def may_move(self) -> bool:
        """Whether it has set something in motion that a stop would end."""
        ends = self.wire.at_stop is not None and self.last_sent is not None
        return self.has_moved or ends or bool(self.unfinished)

    def stop_message(self) -> RosMessage | None:
        """Return what is published at a stop, if anything is; raises what is wrong with its fields."""
        if self.message is None or not (self.is_velocity or self.wire.at_stop is not None):
            return None
        return self.message(**(self.wire.at_stop or {}))

    def tick_message(self) -> RosMessage | None:
        """Return what is published in every tick, if anything is; raises what is wrong with its fields."""
        fields = self.wire.at_tick
        return None if self.message is None or fields is None else self.message(**fields)

    @property
    def latest(self) -> Arrival[Any] | None:
        """The last message, or value of a parameter; None again after the connection was lost."""
        return self.arrivals.last

    @property
    def expects(self) -> bool:
        """Whether it is a subscription without a message so far."""
        return self.wire.direction == "subscription" and self.latest is None and not self.is_static

    @property
    def own(self) -> tuple[str, ...]:
        """The fields of its messages; none while their type is not known."""
        return self.form.kind.__slots__ if self.form is not None else ()

    def learn(self, types: Types, messages: Sequence[str]) -> None:
        """Note the classes of its messages; BridgeError: a type is not known."""
        if self.wire.direction != "subscription":
            self.message, self.lists = types.message(messages[0]), types.lists(messages[0])
        if self.wire.direction != "publisher":
            *others, last = (types.form(message) for message in messages)
            self.form, self.feedback_form = last, others[-1] if others else None

    def decode(self, feedback: Any, result: Any) -> tuple[Any, Any]:
        """Return what has come of a request; ValueError: it is of another type."""
        forms = (self.feedback_form, feedback), (self.form, result)
        try:
            first, last = (raw if raw is None or form is None else form.decode(raw) for form, raw in forms)
        except (AttributeError, TypeError, ValueError) as error:
            why = ended(str(error))
            raise ValueError(
                f"The answer of `{self.wire.topic}` is not one of `{self.type}`: {why}"
            ) from error
        return first, last

    def lack(self) -> str:
        """Return why it cannot be used, in a sentence; empty if it can, or only a message is missing."""
        why = self.problem or self.waiting
        return f"`robot.{self.wire.variable}`: {ended(why)}" if why else ""

    def remark(self) -> str:
        """Return what is to be said of it where all is well; by default nothing."""
        return ""

    def receive(self, raw: Any, at: float | None = None) -> None:
        """Receive a raw message from the network; always on the same thread.

        `at`: when it arrived, by `time.monotonic`, if that was before there was this channel.
        """
        form = self.form
        if not self.live or form is None:  # a late message of a connection that is gone
            return
        unclear = form.unclear.count
        try:
            value = form.decode(raw)
        except (AttributeError, TypeError, ValueError) as error:
            self.problem = f"A message on `{self.wire.topic}` is not a `{self.type}`: {error}"
            return
        arrived = self.clock.now() if at is None or self.clock.world is not None else at
        try:
            if self.tree is not None:
                self.tree.put(value, arrived, self.is_static, self.motion)
            self.problem = ""
        except ValueError as error:
            self.problem = f"A message on `{self.wire.topic}` was not taken as a whole: {error}"
        self.is_unclear = self.is_unclear or form.unclear.count > unclear
        made = self.stamps.made_at(raw, arrived)
        self._under_way = arrived - made
        self.rhythm.note(arrived, has_reason=self.motion.excused(self.rhythm.last) > 0)
        self.arrivals.put(value, made, is_news=at is None)

    def take(self, value: Any) -> None:
        """Take the value of a parameter, if it is another one than before; on the link's thread."""
        told = repr(value)
        if self.latest is None or told != self._told:
            self._told = told
            self.arrivals.put(as_reading(value, self.wire.topic), self.clock.now())

    def sent(self, message: RosMessage) -> None:
        """Record a message that was sent, which may be a stop."""
        self.rhythm.note(self.clock.now())
        self.last_sent = message

    def forget(self) -> None:
        """Return to "no data yet"."""
        self.live = False
        self.arrivals.last = None
        if self.tree is not None:
            self.tree.forget(self.is_static)
        self.interrupt()

    def interrupt(self) -> None:
        """Count the silence that begins as no pause of the topic."""
        self.rhythm.interrupt()
        if self.tree is not None:
            self.tree.interrupt()

    def age(self, in_tick: bool = False) -> float | None:
        """Return the seconds since the last message was made or sent; None before the first.

        `in_tick`: it is the message that the tick sees.
        """
        seen, last = self.arrivals.seen(in_tick), self.rhythm.last
        if seen is not None:
            return max(0.0, self.clock.now() - seen.time)
        return None if last is None else self.clock.now() - last

    def age_limit(self) -> AgeLimit:
        """Return from which age on the last message is too old to drive by."""
        return self.limit_of(self.rhythm, self._under_way)

    def limit_of(self, rhythm: Rhythm, under_way: float = 0.0) -> AgeLimit:
        """Return that of what comes in a rhythm, and is under way for so long."""
        given = self.wire.stale_after
        if given != MEASURED:
            return AgeLimit(given)
        patience, period = rhythm.patience, rhythm.period
        if patience is None:
            return AgeLimit(None)
        pace = f"one came every {period:.2g} s" if period is not None else "they came steadily"
        how = f"Before, {pace}, with pauses of at most {rhythm.longest:.2g} s. {_SWITCHED_OFF}"
        return AgeLimit(patience + under_way + self.motion.excused(rhythm.last), how)

    def rate(self) -> float:
        """Return the recent messages per second; 0 when they have ceased."""
        return self.rhythm.rate(self.clock.now())

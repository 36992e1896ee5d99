"""The abstract bridge, which connects the ``robot`` of a program to a robot.

A bridge for a robot of one's own needs one method::

    class MyBot(Bridge):
        name = "mybot"

        def open_interface(self):
            self.robot_link = library.connect("10.0.0.7", on_light=self.light, on_end=self.ended)
            self.add_method("move", self.move, doc="m/s and rad/s", limits={"linear": 0.5})

        def light(self, brightness):            # on the library's thread, whenever one arrives
            self.feed("light.data", brightness, doc="0 dark ... 255 bright")

        def ended(self):
            self.set_status("lost", "The robot hung up.")

        def move(self, linear=0.0, angular=0.0):
            ...

What is fed has an age, and the robot does not drive on values that are too old: see `feed`. Where the robot
is asked for a value and answers at once, `add_variable` takes the function that asks. A connection that has
to be read by waiting has a base of its own, :class:`~lrp_jupyter.bridges.reconnecting.ReconnectingBridge`.

Two sides meet in the class. The author of a bridge overrides `open_interface` and, where wanted,
`add_members`, `close_interface`, `stop`, `sense`, `act`, `on_start`, `on_pause`, `on_resume`, `answer`,
`press`, `panel`, `tell`, `stopper`; for a robot in a world with a clock of its own, `advance`, `moment` and
`rewind`.
A session calls, on the interpreter's thread unless stated otherwise::

    bridge.open()                          # once
    bridge.on_start()                      # the program starts
    bridge.begin_tick(now, period)         # watchdogs fed, readings unlatched, sense(now), ages judged
    interpreter.step(now)
    bridge.end_tick(now)                   # act(now), command watchdog
    bridge.advance(seconds)                # only where bridge.time_step is not None: the world's time
    bridge.refresh(); bridge.members()     # between ticks, when a view needs it
    bridge.on_pause(); bridge.on_resume()
    bridge.check_watchdog(now)             # the monitor's thread, while the program runs
    bridge.stop_again()                    # the monitor's thread, also in a pause
    bridge.stop_all()                      # any thread: pause, restart, close, fault, the stop button
    bridge.close()

A restart of the program touches none of this: it only calls `stop_all`. A program never connects,
a bridge does it once.

Paper: §7.3.
Deviation: §7.3 generates a temporary class for ``robot``; here ``robot`` is one stable object that
looks up its members, so that members can come and go while a program holds it.
"""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, ClassVar

from lrp_jupyter.bridges.argument_values import kept
from lrp_jupyter.bridges.guarding.bounded import failure_of
from lrp_jupyter.bridges.guarding.safety import Notice
from lrp_jupyter.bridges.interface import Interface, part
from lrp_jupyter.bridges.member_tree import RobotMethod
from lrp_jupyter.bridges.members import Member, MemberError
from lrp_jupyter.bridges.message import Message, Twist
from lrp_jupyter.bridges.options import no_option
from lrp_jupyter.bridges.panel import STOP, Field, Panel
from lrp_jupyter.bridges.robot import Robot, attach
from lrp_jupyter.bridges.tasks import Command, Task, TaskState, arguments_of
from lrp_jupyter.bridges.world_clock import WorldClock
from lrp_jupyter.errors import BridgeError, NoDataYet, sentence_of

__all__ = [
    "Bridge",
    "BridgeError",
    "BridgeStatus",
    "ConnectionState",
    "Member",
    "MemberError",
    "Message",
    "NoDataYet",
    "Notice",
    "NullBridge",
    "Panel",
    "Robot",
    "SimulatedWorld",
    "Task",
    "TaskState",
    "Twist",
    "attach",
]


class ConnectionState(StrEnum):
    """The state of the connection between a bridge and its robot.

    Only two of them have consequences. ``LOST``: the robot does not answer; it is stopped once, as far as it
    can be reached, commands are refused, and when it is found it is stopped again before anything else.
    ``STALE``, where the base sets it: data are too old to drive on; the robot is stopped once, and nothing
    moves it until new ones arrive.
    """

    DISCONNECTED = "disconnected"
    CONNECTING = "connecting"
    CONNECTED = "connected"
    WAITING = "waiting for data"
    STALE = "stale"
    LOST = "lost"


@dataclass(frozen=True, slots=True)
class BridgeStatus:
    """The state of the connection, with a sentence for the user."""

    state: ConnectionState
    sentence: str


_CLOSING = 5.0  # s that closing a connection may take
_UP = (ConnectionState.CONNECTED, ConnectionState.WAITING, ConnectionState.STALE)
"""The states in which the robot answers."""


class Bridge(Interface, ABC):
    """Base of all bridges; see the module for who calls and who overrides what.

    Parameters
    ----------
    **options
        A subclass that takes options (an address, a world) has a constructor, which must not connect.

    Attributes
    ----------
    name : str
        Name under which the bridge is chosen; the name of the class where it is not given.
    hardware : bool
        Whether something real moves. Hardware opens disarmed: commands are recorded and shown, and
        sent after `arm`. A bridge is hardware unless its class sets this to False.
    time_step : float or None
        For a bridge with a world of its own: the seconds of one step of it. Its time passes in
        `advance` only. None where time passes by itself.
    stop_timeout : float or None
        Seconds that `stop` may take; None where it cannot block and is called directly.
    stops_when_found : bool
        Whether the bridge itself stops a robot that was lost, as the first thing over the new connection; if
        not, the base does when the status says that it is found.
    gone : str
        Why the robot will never be found again by this bridge, a sentence; empty: it may be.
    complete : bool
        Whether `add_members` adds every member that there will be, so that a program which uses another one
        is wrong, and the checks say so before it runs.
    alone : bool
        Whether no person can add members, as on the command line: then a set-up names all of them.
    tells_why : bool
        Whether `tell` is also told why a transition fired.
    robot : Robot
        What a program sees.
    safety : Safety
        Armed or not, the log of commands and notices.
    """

    gone: str = ""
    alone: bool = False
    tells_why: bool = False
    stops_when_found: ClassVar[bool] = False
    complete: ClassVar[bool] = False
    registry: ClassVar[dict[str, type[Bridge]]] = {}

    def __init_subclass__(cls, offered: bool = True, **kwargs: Any) -> None:
        """Register the class under its name, unless it is not to be `offered` to users."""
        super().__init_subclass__(**kwargs)
        if not cls.__dict__.get("name"):
            cls.name = cls.__name__.removesuffix("Bridge").lower() or cls.__name__.lower()
        if cls.name in ("none", "sim") and not cls.__module__.startswith("lrp_jupyter."):
            raise BridgeError(f"The name `{cls.name}` is taken. Give `{cls.__name__}` another `name`.")
        if offered:
            Bridge.registry[cls.name] = cls  # the newest definition wins: a notebook's cell is run again

    status_listener: Callable[[BridgeStatus], object] | None = None
    """Called with each new status, on whatever thread sets it."""

    _ticks = 0
    _ticks_in = 0  # the thread
    _late: BridgeStatus | None = None  # while data are too old to drive on
    _failed: tuple[str, BridgeStatus, BridgeStatus] | None = None
    """The hook because of which the robot is lost, with the status since then, and the one before."""
    _opened_panel: Panel | None = None

    _status = part(lambda bridge: BridgeStatus(ConnectionState.DISCONNECTED, f"`{bridge.name}` is not open."))
    _changing_status = part(lambda bridge: threading.Lock())

    # -- what the author of a bridge writes -------------------------------------------------------

    def add_members(self) -> None:
        """Add the members that are known without a connection; called before `open_interface`.

        It must not connect: the checks call it for a bridge that is never opened. Default: none.
        """

    def check_set_up(self) -> bool:
        """Return whether `add_members` adds all members that there will be, unless a person adds others.

        Then the command line checks a program against them. Default: where it adds all in any case.

        Raises
        ------
        BridgeError
            The options are wrong, as far as that is known without a connection.
        """
        return self.complete

    @abstractmethod
    def open_interface(self) -> Panel | None:
        """Connect and add the members; return the panel, if there is one.

        In bounded time, and without waiting for a person: a bridge that needs an answer returns a
        panel with a question, sets its status and connects in `answer`.

        Raises
        ------
        BridgeError
            The robot cannot be reached; the message contains what to do.
        """

    def close_interface(self) -> None:
        """Close the connection; the robot was stopped before."""

    def sense(self, now: float) -> None:
        """Before a tick: fetch what the readings of this tick are taken from, if that is of use."""

    def act(self, now: float) -> None:
        """After a tick: send what was collected, if commands are not sent at once."""

    def on_start(self) -> None:
        """React to the start, or restart, of the program."""

    def on_pause(self) -> None:
        """React to a pause, after the ``onpause`` actions; the robot was stopped before."""

    def on_resume(self) -> None:
        """React to the end of a pause. Nothing commanded before the pause is sent again."""

    def tell(self, told: Mapping[str, Any]) -> None:
        """Publish what has happened in the run, for those who follow it from outside. Default: nothing.

        Called after each tick or command in which something happened, in general on the thread that ticks: it
        must not wait. It is not a command: a disarmed bridge is told, too, and nothing of it is recorded or
        repeated. What it raises is a notice.

        Parameters
        ----------
        told : mapping
            Can be written as JSON; see `lrp_jupyter.live.teller`.
        """

    def panel(self) -> Panel | None:
        """Return the current panel.

        Default: the panel that `open_interface` returned; for hardware without one, its status and a stop.
        """
        if self._opened_panel is None and self.hardware and self._is_open:
            return Panel(
                self.name, fields=(Field("status", "Status", value=self.status.sentence),), buttons=(STOP,)
            )
        return self._opened_panel

    def answer(self, key: str, value: str) -> None:
        """Apply the answer to a question of the panel; on the command line ``--<key> VALUE``."""
        panel = self.panel()
        questions = [question.key for question in panel.questions] if panel is not None else []
        raise BridgeError(no_option(type(self), key, questions))

    def press(self, key: str, row: str = "", values: Mapping[str, str] | None = None) -> None:
        """Run the action of a button of the panel; ``"stop"`` stops the robot, on any thread.

        Parameters
        ----------
        key : str
            Of the button.
        row : str
            Key of the table row that contains the button.
        values : mapping of str to str, optional
            The values of the fields of the panel.
        """
        if key != "stop":
            raise BridgeError(f"The bridge `{self.name}` has no button `{key}`.")
        self.stop_all()

    @property
    def world_clock(self) -> WorldClock | None:
        """The clock of the robot's world, by which a session then runs; None: wall time. From any thread."""
        return None

    def world_time(self) -> float | None:
        """Return what the robot's clock shows, in seconds, for recordings. Default: None, it has none."""
        return None

    @property
    def simulated(self) -> SimulatedWorld | None:
        """The robot's world, if this package simulates it; None for every other world."""
        return None

    def advance(self, seconds: float) -> None:
        """Advance the bridge's own world by `seconds`, whole steps of `time_step`."""

    def moment(self) -> object:
        """Return a token for the present moment of the bridge's own world, for `rewind`."""
        return None

    def rewind(self, moment: object) -> None:
        """Rewind the bridge's own world to an earlier moment.

        The tasks of that time, the same `Task` objects, are under way again afterwards.

        Raises
        ------
        BridgeError
            Something real is armed: the past of a robot cannot be restored.
        """
        if self.hardware and self.safety.armed:
            raise BridgeError(f"`{self.name}` is armed: a real robot cannot step back. Disarm it first.")

    # -- life: called by a session ----------------------------------------------------------------

    @property
    def status(self) -> BridgeStatus:
        """The state of the connection; of one that is up, also whether its data are too old to drive on."""
        own, late = self._status, self._late
        if late is None or own.state in (ConnectionState.LOST, ConnectionState.DISCONNECTED):
            return own
        return late

    def set_status(self, state: ConnectionState | str, sentence: str = "") -> None:
        """Set the state of the connection; for authors of bridges, from any thread.

        ``"lost"`` stops the robot, once, and refuses its commands until the state is ``"connected"``,
        ``"waiting for data"`` or ``"stale"``; then a robot that had been commanded is stopped again, since
        it is not known what it has done meanwhile. Nothing is sent a second time. After `close` the call does
        nothing.

        Parameters
        ----------
        state : ConnectionState or str
        sentence : str, optional
            For the user: what has happened and, if something is wrong, what to do.

        Raises
        ------
        ValueError
            There is no such state.
        """
        connection = ConnectionState(state)
        if self.is_closed and connection is not ConnectionState.DISCONNECTED:
            return  # said by a connection that is gone
        status = BridgeStatus(connection, sentence or f"`{self.name}` is {connection.value}.")
        safety, is_lost = self.safety, connection is ConnectionState.LOST
        before, was_lost = self._status, bool(safety.lost)
        if was_lost and connection in _UP and safety.has_commanded and not self.stops_when_found:
            safety.has_commanded = not self.stop_all()  # before any command is allowed again
        with self._changing_status:
            if was_lost and not is_lost and self._status is not before:
                return  # it was lost again meanwhile
            began = is_lost and not safety.lost
            self._status = status
            if is_lost or connection in _UP:
                safety.lost = status.sentence if is_lost else ""
        if self.status_listener is not None:
            self.status_listener(status)
        if began and self._is_open:
            safety.notice("fault", status.sentence)
            self.stop_all()

    @property
    def unreached(self) -> str:
        """Why a run that ends now did not have its robot, a sentence; empty: it had."""
        return self.status.sentence if self.status.state is ConnectionState.LOST else ""

    def open(self) -> Panel | None:
        """Open the interface, once; return the panel.

        Raises
        ------
        BridgeError
            The robot cannot be reached; any other error of `open_interface` is its cause.
        """
        if self._is_open:
            return self.panel()
        self.is_closed, self.safety.lost = False, ""
        self.set_status(ConnectionState.CONNECTING)
        try:
            self.add_members()
            self._opened_panel = self.open_interface()
            self.offer_stop()
        except Exception as error:
            sentence = sentence_of(error)
            self.is_closed = True
            self._guard.end()
            self.set_status(ConnectionState.DISCONNECTED, sentence)
            if isinstance(error, BridgeError):
                raise
            raise BridgeError(f"The bridge `{self.name}` could not be opened: {sentence}") from error
        self._is_open = True
        if self.safety.armed:
            self._begin_guarding()
        if self._status.state is ConnectionState.CONNECTING:
            self.set_status(ConnectionState.CONNECTED)
        return self._opened_panel

    def close(self) -> None:
        """Stop the robot, then close the connection, in bounded time; idempotent. Never raises."""
        if not self._is_open:
            return
        stands = self.stop_all() or not self.in_motion
        self._is_open = False
        self._guard.end(stands)
        self.is_closed = True
        limit = None if self.stop_timeout is None else _CLOSING
        if failure := failure_of(self.close_interface, limit, "close the robot"):
            self.safety.notice("fault", f"Closing `{self.name}` failed: {failure}")
        self.requested.drop()
        self.nodes.clear()
        self.fed.clear()
        self._late, self._failed = None, None
        self.safety.blind = self.safety.lost = ""
        self.safety.has_commanded = False
        self.safety.rest()
        self.set_status(ConnectionState.DISCONNECTED, f"`{self.name}` is closed.")

    def begin_tick(self, now: float, period: float) -> None:
        """Begin the tick of time `now`; ticks come every `period` seconds. Never raises."""
        self._ticks += 1
        self.latch = self._ticks
        self.readings, self.answers, self.unstopped = {}, {}, False
        self._ticks_in = threading.get_ident()
        self.safety.tick(now, period)
        try:
            try:
                self.sense(now)
            finally:
                self.fed.latch()
            if states := self.requested.latch():
                self.readings |= states
            if self.nodes.timed or self._late is not None:
                self.judge_ages()
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            self.lose("sense", error)
        else:
            if self._failed is not None and self._failed[0] != "act":
                self._find_again()

    def send(self, method: RobotMethod, command: Command) -> object:
        """Send a command; what a robot that cannot be reproduced answers is kept with the tick's readings.

        With the arguments, if it is an error, or if the method only asks for something.
        """
        if self.simulated is not None or not self.latch or threading.get_ident() != self._ticks_in:
            return super().send(method, command)
        answer: object = None
        answers = self.answers.setdefault(method.path, [])
        try:
            result = super().send(method, command)
            is_asked = result is not None and not method.command
            answer = (arguments_of(command), result) if is_asked else result
            return result
        except Exception as error:
            kind = NoDataYet if isinstance(error, NoDataYet) else BridgeError
            answer = arguments_of(command), kind(str(error))  # without the frames
            raise
        finally:
            answers.append(kept(answer))
            if answer is not None:
                self.readings[f"{method.path}()"] = answers

    def judge_ages(self) -> None:
        """Let nothing move the robot while a reading is too old to drive on, or has never arrived."""
        late = [variable for variable in self.nodes.timed if variable.judge()]
        if not late:
            self._late, self.safety.blind = None, ""
            return
        stale = [variable for variable in late if variable.is_stale]
        sentence = (stale or late)[0].lateness
        began = self._late is None
        self._late = BridgeStatus(ConnectionState.STALE if stale else ConnectionState.WAITING, sentence)
        self.safety.blind = sentence
        if began:
            self.safety.notice("stale", f"{sentence} Until new data arrive, nothing moves the robot.")
            self.stop_all()

    def end_tick(self, now: float) -> None:
        """End the tick. Never raises."""
        stops = self.safety.stops
        try:
            self.act(now)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            self.lose("act", error)
        else:
            if self.safety.stops != stops:  # while it sent what was collected: the stop comes last
                self._stop_now()
            if self._failed is not None and self._failed[0] == "act":
                self._find_again()
        self.requested.end_tick()
        self.latch = 0  # between ticks a person reads what is there now
        for mover, sentence in self.safety.commands_overdue(now).items():
            self.safety.notice("command watchdog", sentence)
            self.stop_mover(mover)

    def check_watchdog(self, now: float) -> Notice | None:
        """Stop the robot if there are no more ticks; for the monitor's thread, while running.

        `now` is what the time should be by now, whether or not a clock of the robot's world says so.
        A bridge with a world of its own needs none: without ticks that world stands still.
        """
        sentence = self.safety.tick_overdue(now) if self.time_step is None else None
        if sentence is None:
            return None
        stopped = self.stop_all()
        return self.safety.notice("tick watchdog", f"{sentence}{': the robot was stopped' * stopped}.")

    def stop_again(self) -> None:
        """Stop the robot if the last stop failed, and no tick came since; for the monitor's thread."""
        if self.unstopped and self._is_open:
            self.unstopped = not self._stop_now()

    def lose(self, hook: str, error: BaseException) -> None:
        """Mark the robot as lost until a hook that failed works again; the loop keeps its rate."""
        sentence = sentence_of(error)
        if not isinstance(error, BridgeError):
            sentence = f"`{hook}` raised {sentence}"
        if self.safety.lost:
            self.safety.notice("fault", sentence)
            return
        before = self._status
        self.set_status(ConnectionState.LOST, sentence)
        self._failed = hook, self._status, before

    def _find_again(self) -> None:
        """Return to the status before a hook failed, unless there is a newer one."""
        assert self._failed is not None
        (_, since, before), self._failed = self._failed, None
        if self._status is since:
            self.set_status(before.state, before.sentence)


class SimulatedWorld(ABC):
    """The world of a robot, simulated by this package, so that it can be drawn, repeated and copied.

    Moments are those of its bridge: see `Bridge.moment`.
    """

    # -- now --------------------------------------------------------------------------------------

    @property
    @abstractmethod
    def picture(self) -> object:
        """Everything that is to be seen, a frozen value."""

    @property
    @abstractmethod
    def pose(self) -> tuple[float, float, float]:
        """Where the robot is, in metres, and its heading in radians."""

    @property
    @abstractmethod
    def others(self) -> Mapping[str, tuple[float, float, float]]:
        """Where further robots are, by their names."""

    @property
    @abstractmethod
    def movable(self) -> tuple[tuple[int, tuple[float, float, float]], ...]:
        """The numbers of the solids that can move, with where they are: x, y and angle."""

    @property
    @abstractmethod
    def touched(self) -> frozenset[str]:
        """Names of the solids that the robot touched in the tick before the last reading of its sensors."""

    @property
    @abstractmethod
    def is_at_start(self) -> bool:
        """Whether it is as after a reset: a new world of its JSON form would go on in the same way."""

    @abstractmethod
    def world_form(self) -> Mapping[str, Any]:
        """Return a JSON form, noise included."""

    @abstractmethod
    def sensed(self) -> object:
        """Return a token for the readings of the tick that has begun, for `readings_of`."""

    # -- the past ---------------------------------------------------------------------------------

    @abstractmethod
    def readings_of(self, sensed: object) -> Mapping[str, object]:
        """Return the readings of an earlier tick by path; those that are missing had no value."""

    @abstractmethod
    def picture_after(self, moment: object, next_moment: object) -> object:
        """Return the picture right after the tick between two moments; None if it cannot be reproduced."""

    @abstractmethod
    def animation(self, moments: Sequence[object], end: object) -> Callable[[], str]:
        """Return a function that draws how the robot moved as an animated SVG.

        It begins at the first of some moments that is of the same world as the end.

        Raises BridgeError: there is no such moment, or it is too long ago.
        """

    @abstractmethod
    def has_come_to(self, moment: object) -> bool:
        """Return whether as much was done to it as at a moment, maybe of another run."""

    @abstractmethod
    def forget(self, moment: object) -> None:
        """Drop what only `rewind` and `fork` to moments before this one need."""

    @abstractmethod
    def fork(self, moment: object) -> Bridge:
        """Return an open, independent copy of the robot, with its world at a moment.

        Raises BridgeError: the moment is too long ago.
        """

    @abstractmethod
    def repeat(self, what: object) -> None:
        """Do again what was done to it by hand."""


class NullBridge(Bridge):
    """No robot at all: programs that only compute."""

    name = "none"
    hardware = False
    stop_timeout = None

    def offer_stop(self) -> None:
        """Offer nothing: there is no robot that could stop."""

    def open_interface(self) -> None:
        """Nothing to connect."""

"""The conformance tests: rules of every bridge, to be run by the author of a new one.

In a notebook::

    from lrp_jupyter.bridges.conformance import check_bridge
    print(check_bridge(MyBot))

With pytest::

    class TestMyBot(BridgeConformance):
        def make_bridge(self):
            return MyBot(port="/dev/ttyUSB0")

        def silence(self):          # the robot sends no more
            broker.publish("robot/mute", "on")

        def cut(self):              # its connection breaks …
            broker.stop()

        def restore(self):          # … and all is as before
            broker.start()
            broker.publish("robot/mute", "off")

Unless the author says `moves`, no check moves the robot: commands are caught before they reach the bridge's
functions, and only `stop` is really called. What cannot be checked without the author's help is reported as
not checked, with what is missing.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

from lrp_jupyter.bridges.bridge import Bridge, BridgeStatus, ConnectionState, NullBridge
from lrp_jupyter.bridges.member_tree import RobotMethod, RobotVariable
from lrp_jupyter.bridges.members import MemberError
from lrp_jupyter.bridges.probes import (
    ConformanceError,
    NotChecked,
    ask_a_little,
    catch,
    commands,
    drive,
    drive_a_little,
    give,
    listen,
    messages,
    methods,
    read,
    require,
    spy,
    variables,
    within,
)
from lrp_jupyter.bridges.tasks import RobotTask
from lrp_jupyter.errors import BridgeError, ended

__all__ = [
    "BridgeConformance",
    "ConformanceError",
    "ConformanceReport",
    "NotChecked",
    "Outcome",
    "check_bridge",
]

Sent = list[tuple[RobotMethod, list[object]]]

_PERIOD = 0.05  # s between the ticks of the checks that take time
_SILENT = (ConnectionState.STALE, ConnectionState.LOST)
_DOWN = (ConnectionState.LOST, ConnectionState.CONNECTING, ConnectionState.DISCONNECTED)


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of one check, which is named by its rule.

    `problem`: how the bridge violates it; empty if it does not.
    `missing`: why it could not be checked; empty if it was.
    """

    check: str
    problem: str = ""
    missing: str = ""

    @property
    def passed(self) -> bool:
        """Whether it was checked, and the bridge keeps the rule."""
        return not (self.problem or self.missing)


@dataclass(frozen=True, slots=True)
class ConformanceReport:
    """The outcomes of `check_bridge`; its text is a readable list."""

    bridge: str
    outcomes: tuple[Outcome, ...]

    @property
    def passed(self) -> bool:
        """Whether no check failed; some may not have been possible."""
        return not self.problems

    @property
    def problems(self) -> tuple[Outcome, ...]:
        """The checks that failed."""
        return tuple(outcome for outcome in self.outcomes if outcome.problem)

    @property
    def unchecked(self) -> tuple[Outcome, ...]:
        """The checks that were not possible, with what is missing."""
        return tuple(outcome for outcome in self.outcomes if outcome.missing)

    def __bool__(self) -> bool:
        return self.passed

    def __str__(self) -> str:
        good = sum(outcome.passed for outcome in self.outcomes)
        head = [f"{self.bridge}: {good} of {len(self.outcomes)} checks passed"]
        head += [f"{len(self.problems)} failed"] if self.problems else []
        head += [f"{len(self.unchecked)} not checked"] if self.unchecked else []
        lines = [", ".join(head)]
        for outcome in self.outcomes:
            sign = "FAIL" if outcome.problem else "  ? " if outcome.missing else "ok  "
            lines.append(f"  {sign}  {outcome.check}")
            if not outcome.passed:
                lines.append(f"        {outcome.problem or f'Not checked: {outcome.missing}'}")
        return "\n".join(lines)

    __repr__ = __str__


class BridgeConformance:
    """The checks; a subclass defines with `make_bridge` which bridge they are for.

    Attributes
    ----------
    open_within, answer_within : float
        Seconds that opening may take, and anything else.
    stale_within, lost_within : float
        Seconds until it must be known that the data have stopped, or the robot is lost.
    moves : bool
        Whether the robot may be moved a little: it has room, and a person watches it.
    """

    open_within: ClassVar[float] = 15.0
    answer_within: ClassVar[float] = 1.5
    stale_within: ClassVar[float] = 2.0
    lost_within: ClassVar[float] = 6.0
    moves: bool = False

    # -- what an author defines -------------------------------------------------------------------

    def make_bridge(self) -> Bridge:
        """Return a new bridge to check, not open; called for each check."""
        raise NotImplementedError("Define `make_bridge` in a subclass. It returns the bridge to check.")

    def silence(self) -> None:
        """Make the robot, or what stands for it, send no more data over a connection that stays."""
        raise NotChecked("Define `silence` in a subclass, or pass it: it makes the robot send no more data.")

    def cut(self) -> None:
        """Break the connection to the robot: end its server, unplug it."""
        raise NotChecked("Define `cut` in a subclass, or pass it: it breaks the connection to the robot.")

    def restore(self) -> None:
        """Undo `silence` and `cut`."""
        raise NotChecked("Define `restore` in a subclass, or pass it: it undoes `cut`, so that it is found.")

    def move_a_little(self, bridge: Bridge) -> None:
        """Give the smallest command that moves the robot. Default: its first velocity command, slow."""
        drive_a_little(bridge)

    def ask_a_little(self, bridge: Bridge) -> None:
        """Ask for the smallest task that can be cancelled. Default: the first that takes one number."""
        ask_a_little(bridge)

    def has_moved(self, bridge: Bridge) -> bool | None:
        """Return whether that command has reached the robot; None: it cannot be seen from here."""
        return None

    def wait(self, seconds: float) -> None:
        """Let time pass, of the robot too. Default: sleep."""
        time.sleep(seconds)

    # -- opening and closing ----------------------------------------------------------------------

    def test_it_has_a_name(self) -> None:
        """It has a name by which it can be chosen."""
        name = self.make_bridge().name
        require(name.replace("-", "_").isidentifier(), f"{name!r} cannot be typed as the name of a bridge.")

    def test_open_connects_once(self) -> None:
        """Opening twice connects once, in bounded time."""
        bridge = self.make_bridge()
        calls = spy(bridge, "open_interface")
        with self._closing(bridge):
            within(self.open_within, "`open`", bridge.open)
            before = _given(bridge)
            within(self.answer_within, "The second `open`", bridge.open)
            require(len(calls) == 1, f"`open_interface` was called {len(calls)} times.")
            require(_given(bridge) == before, "The second `open` changed the members.")
            require(bridge.is_open, "It is not open after `open`.")

    def test_status_is_said_in_a_sentence(self) -> None:
        """Its status is one of the known states, with a sentence, whether open or not."""
        bridge = self.make_bridge()
        self._check_status(bridge)
        with self._opened(bridge):
            self._check_status(bridge)
        self._check_status(bridge)
        require(
            bridge.status.state is ConnectionState.DISCONNECTED,
            "A closed bridge does not have the status `disconnected`.",
        )

    def test_close_stops_first_and_once(self) -> None:
        """Closing stops the robot before it closes the connection; a second time does nothing."""
        bridge = self.make_bridge()
        with self._opened(bridge):
            calls = spy(bridge, "stop", "stop_all", "close_interface")
            within(self.answer_within, "`close`", bridge.close)
            require(bool(calls) and calls[0].startswith("stop"), "`close` did not stop the robot first.")
            require(calls.count("close_interface") == 1, "`close` did not call `close_interface` once.")
            del calls[:]
            within(self.answer_within, "The second `close`", bridge.close)
            require("close_interface" not in calls, "The second `close` closed again.")

    def test_close_before_open_does_nothing(self) -> None:
        """Closing a bridge that was never opened does nothing."""
        within(self.answer_within, "`close`", self.make_bridge().close)

    def test_it_opens_again_after_close(self) -> None:
        """It can be opened again after it was closed, with the same members."""
        bridge = self.make_bridge()
        with self._opened(bridge):
            before = _given(bridge)
        with self._opened(bridge):
            require(_given(bridge) == before, "The second connection has other members.")

    def test_no_thread_is_left(self) -> None:
        """Closing ends every thread that opening started."""
        before = set(threading.enumerate())
        with self._opened(self.make_bridge()):
            pass
        for _ in range(round(self.answer_within / _PERIOD)):  # `join` refuses a thread that is just starting
            if not (left := set(threading.enumerate()) - before):
                return
            time.sleep(_PERIOD)
        raise ConformanceError(f"The thread {left.pop().name!r} runs on after `close`.")

    # -- members ----------------------------------------------------------------------------------

    def test_members_are_documented(self) -> None:
        """Every member has a description, for completion and hover."""
        with self._opened() as bridge:
            bare = [f"`{member.name}`" for member in bridge.members() if not member.doc.strip()]
            require(not bare, f"These members have no description: {', '.join(bare)}.")

    def test_views_get_plain_data(self) -> None:
        """Members, panel and notices can be sent to a page as JSON."""
        with self._opened() as bridge:
            bridge.begin_tick(0.0, 0.1)
            bridge.refresh()
            bridge.end_tick(0.0)
            panel = bridge.panel()
            for what, value in (
                ("members", [member.as_dict() for member in bridge.members()]),
                ("panel", panel.as_dict() if panel is not None else None),
                ("notices", [notice.as_dict() for notice in bridge.safety.notices]),
            ):
                try:
                    json.dumps(value, allow_nan=False)
                except (TypeError, ValueError) as error:
                    raise ConformanceError(ended(f"The {what} cannot be written as JSON: {error}")) from error

    def test_members_can_be_described(self) -> None:
        """Every member is found by its name, and through `robot`."""
        with self._opened() as bridge:
            for member in bridge.members():
                require(bridge.describe(member.name).name == member.name, f"`{member.name}` is not found.")
                first = member.name.partition(".")[0]
                require(first in dir(bridge.robot), f"`{first}` is not listed by dir(robot).")

    def test_readings_come_in_time(self) -> None:
        """Every reading returns a value, or raises `NoDataYet` or a `BridgeError`, in bounded time."""
        with self._opened() as bridge:
            for variable in variables(bridge):
                within(self.answer_within, f"Reading `{variable.path}`", partial(read, variable))

    def test_one_tick_sees_one_world(self) -> None:
        """A reading does not change within a tick."""
        with self._opened() as bridge:
            bridge.begin_tick(0.0, 0.1)
            for variable in variables(bridge):
                first, second = read(variable), read(variable)
                same = first is second or first == second or (first != first and second != second)
                require(same, f"`{variable.path}` was {first!r}, then {second!r} in the same tick.")
            bridge.end_tick(0.0)

    def test_every_value_that_is_fed_comes_once(self) -> None:
        """Every value that is fed between two ticks is in `new` of the next one, once and in its order."""
        with self._opened() as bridge:
            for variable, new in messages(bridge):
                bridge.take_messages([new.path])
                self._ticks(bridge, _PERIOD, until=lambda: True)
                first, second, seen = object(), object(), list[object]()
                bridge.feed(variable.path, first)
                bridge.feed(variable.path, second)
                note = partial(_note_messages, new, seen)
                self._ticks(bridge, 2 * _PERIOD, until=lambda: False, act=note)
                came = [value for value in seen if value is first or value is second]
                require(
                    came == [first, second],
                    f"Two values were fed, and `robot.{new.path}` has {len(came)} of them.",
                )

    def test_an_unknown_member_is_answered_with_the_known_ones(self) -> None:
        """An unknown member is an error that lists the known ones; no member can be assigned."""
        with self._opened() as bridge:
            try:
                bridge.robot.no_such_member  # noqa: B018
            except MemberError as error:
                missing = [name for name in dir(bridge.robot) if name not in str(error)]
                require(not missing, f"The error does not name {', '.join(missing)}.")
            except Exception as error:
                raise ConformanceError(
                    ended(f"An unknown member raises {type(error).__name__}: {error}")
                ) from error
            else:
                raise ConformanceError("An unknown member raises no error.")
            for name in [*dir(bridge.robot), "no_such_member"]:
                try:
                    setattr(bridge.robot, name, 0)
                except AttributeError:
                    continue
                raise ConformanceError(f"`robot.{name}` can be assigned.")

    # -- safety -----------------------------------------------------------------------------------

    def test_hardware_opens_disarmed(self) -> None:
        """Hardware is disarmed until a person arms it."""
        with self._opened() as bridge:
            require(not (bridge.hardware and bridge.safety.armed), "Opening armed it.")

    def test_move_is_a_velocity_command(self) -> None:
        """Every member called `move` is a command, guarded by the command watchdog."""
        with self._opened() as bridge:
            for method in methods(bridge):
                if method.path.rpartition(".")[2] == "move":
                    require(method.command and method.velocity, f"`{method.path}` bypasses the safety.")

    def test_disarmed_sends_nothing(self) -> None:
        """While it is disarmed commands are recorded, and none is sent."""
        with self._opened() as bridge:
            bridge.disarm()
            for method in commands(bridge):
                recorded = bridge.safety.command_count
                sent = catch(method)
                give(bridge, method)
                require(not sent, f"`{method.path}` was sent.")
                require(bridge.safety.command_count == recorded + 1, f"`{method.path}` was not recorded.")

    def test_armed_sends(self) -> None:
        """Once armed, commands are sent."""
        with self._opened() as bridge:
            bridge.arm()
            bridge.begin_tick(0.0, 0.1)
            for method in commands(bridge):
                sent = catch(method)
                give(bridge, method)
                require(len(sent) == 1, f"`{method.path}` was sent {len(sent)} times.")

    def test_a_stop_holds_for_the_tick(self) -> None:
        """Once the robot is stopped, the commands of that tick are no longer sent."""
        with self._opened() as bridge:
            bridge.arm()
            bridge.begin_tick(0.0, 0.1)
            bridge.stop_all()
            for method in commands(bridge):
                sent = catch(method)
                give(bridge, method)
                require(not sent, f"`{method.path}` was sent after the stop.")

    def test_stop_all_works_on_any_thread(self) -> None:
        """`stop_all` works on another thread, in bounded time, before, while and after the bridge is open."""
        bridge = self.make_bridge()
        within(self.answer_within, "`stop_all` before `open`", bridge.stop_all)
        with self._opened(bridge):
            for armed in (False, True):
                (bridge.arm if armed else bridge.disarm)()
                calls = spy(bridge, "stop")
                took = within(self.answer_within, "`stop_all`", bridge.stop_all)
                notices = bridge.safety.notices
                why = notices[-1].text if notices else "`stop_all` returned False."
                require(took is not False, why)
                overridden = type(bridge).stop_all is not Bridge.stop_all
                require(bool(calls) or overridden, "`stop_all` did not call `stop`.")
        within(self.answer_within, "`stop_all` after `close`", bridge.stop_all)

    def test_going_on_after_a_pause_sends_nothing(self) -> None:
        """`on_pause` and `on_resume` end in time, and resuming the program sends no command."""
        with self._opened() as bridge:
            bridge.arm()
            bridge.on_start()
            bridge.begin_tick(0.0, 0.1)
            bridge.end_tick(0.0)
            bridge.stop_all()
            within(self.answer_within, "`on_pause`", bridge.on_pause)
            caught = [catch(method) for method in commands(bridge)]
            within(self.answer_within, "`on_resume`", bridge.on_resume)
            require(not any(caught), "`on_resume` sent a command.")

    def test_silence_stops_a_velocity(self) -> None:
        """A velocity command that is not repeated ends after half a second."""
        with self._opened() as bridge:
            velocities = [method for method in commands(bridge) if method.velocity]
            bridge.arm()
            for start, method in enumerate(velocities):
                catch(method)
                now = 10.0 * start
                bridge.begin_tick(now, 0.1)
                bridge.safety.moving(method.path, True, method.mover)
                bridge.end_tick(now)
                calls = spy(bridge, "stop")
                for tick in range(1, 7):
                    bridge.begin_tick(now + tick / 10, 0.1)
                    bridge.end_tick(now + tick / 10)
                require(bool(calls), f"`{method.path}` moved on without new commands.")

    def test_a_hanging_loop_stops_the_robot(self) -> None:
        """After half a second without a tick the robot is stopped, unless its world stops too."""
        with self._opened() as bridge:
            if bridge.time_step is not None:
                return
            bridge.arm()
            bridge.begin_tick(0.0, 0.1)
            calls = spy(bridge, "stop", "stop_all")
            require(bridge.check_watchdog(0.3) is None, "It was stopped too early.")
            require(bridge.check_watchdog(0.6) is not None, "The tick watchdog did not report it.")
            require(bool(calls), "The tick watchdog did not stop the robot.")

    def test_ticks_are_short_and_never_raise(self) -> None:
        """`sense` and `act` end in time and do not fail."""
        with self._opened() as bridge:
            for tick in range(3):
                now = tick / 10
                within(self.answer_within, "`sense`", partial(bridge.begin_tick, now, 0.1))
                within(self.answer_within, "`act`", partial(bridge.end_tick, now))
            faults = [notice.text for notice in bridge.safety.notices if notice.kind == "fault"]
            require(not faults, "; ".join(faults))

    def test_an_armed_robot_cannot_step_back(self) -> None:
        """Hardware refuses to step back while it is armed."""
        with self._opened() as bridge:
            if not bridge.hardware:
                return
            bridge.arm()
            try:
                bridge.rewind(bridge.moment())
            except BridgeError:
                return
            raise ConformanceError("`rewind` was not refused.")

    def test_a_program_can_stop_it(self) -> None:
        """`robot.stop()` stops it, in bounded time, and later commands of the tick are sent."""
        with self._opened() as bridge:
            if not commands(bridge):
                return
            stop = bridge.nodes.table.get("stop")
            require(isinstance(stop, RobotMethod) and stop.command, "It has no command `stop`.")
            assert isinstance(stop, RobotMethod)
            bridge.arm()
            bridge.begin_tick(0.0, 0.1)
            within(self.answer_within, "`robot.stop()`", stop)
            for method in [other for other in commands(bridge) if other is not stop]:
                sent = catch(method)
                give(bridge, method)
                require(bool(sent), f"After `robot.stop()`, `{method.path}` was not sent in the same tick.")

    # -- the robot itself -------------------------------------------------------------------------

    def test_readings_tell_their_age(self) -> None:
        """The bridge knows how old each reading is, so that the robot does not drive on old ones."""
        with self._opened() as bridge:
            if bridge.time_step is not None:
                return
            bare = [f"`{each.path}`" for each in variables(bridge) if not each.knows_age]
            if bare:
                raise NotChecked(
                    f"The age of {', '.join(bare)} is unknown: when the data stop, the robot drives on."
                    " `feed` the values, or give `add_variable` an `age` and `stale_after`."
                )

    def _need_room(self) -> None:
        if not self.moves:
            raise NotChecked(
                "It would move the robot. Give it room, then set `moves = True` or pass `move=True`."
            )

    def test_a_command_reaches_the_robot(self) -> None:
        """A command arrives at the bridge's function and at the robot, and a stop after it."""
        with self._opened() as bridge:
            if not commands(bridge):
                return
            self._need_room()
            bridge.arm()
            called = [listen(method) for method in commands(bridge)]
            reached = False

            def move(bridge: Bridge) -> None:
                nonlocal reached
                before = sum(map(len, called))  # a stop may be such a call, too
                self.move_a_little(bridge)
                reached = sum(map(len, called)) > before

            try:
                # again, if the robot's data were late just then: nothing moves it until new ones arrive
                self._ticks(bridge, self.stale_within, until=lambda: reached, act=move)
            except BridgeError as error:
                raise ConformanceError(str(error)) from error
            require(reached, "The command called no function of the bridge.")
            if self.has_moved(bridge) is not None:
                arrived = self._ticks(bridge, self.stale_within, until=lambda: bool(self.has_moved(bridge)))
                require(arrived, f"The command has not reached the robot within {self.stale_within:g} s.")
            stopped = within(self.answer_within, "`stop_all`", bridge.stop_all)
            faults = [notice.text for notice in bridge.safety.notices if notice.kind == "fault"]
            require(stopped is not False and not faults, "; ".join(faults) or "`stop_all` returned False.")

    def test_a_stop_cancels_a_task(self) -> None:
        """A task that is asked for begins, a stop cancels it in bounded time, and then it is not active."""
        with self._opened() as bridge:
            tasks = [task for task in commands(bridge) if isinstance(task, RobotTask) and task.work.cancel]
            if not tasks:
                return
            self._need_room()
            bridge.arm()
            begun, cancelled = ([spy(task.work, name) for task in tasks] for name in ("start", "cancel"))
            asked = self._ticks(bridge, self.stale_within, lambda: any(begun), self.ask_a_little)
            require(asked, "The task that was asked for has not begun.")
            within(self.answer_within, "`stop_all`", bridge.stop_all)
            require(any(cancelled), "`stop_all` has not cancelled the task.")
            over = self._ticks(
                bridge, self.answer_within, until=lambda: not any(task.active for task in tasks)
            )
            require(over, "After a stop the task is still active.")
            faults = [notice.text for notice in bridge.safety.notices if notice.kind == "fault"]
            require(not faults, "; ".join(faults))

    def test_data_that_cease_stop_the_robot(self) -> None:
        """Without new data the status is stale or lost, readings fail, and the robot stands."""
        with self._opened() as bridge:
            if bridge.time_step is not None or not variables(bridge):
                return
            self._require_hook("silence")
            heard, sent, calls = self._drive(bridge)
            if not heard:
                raise NotChecked(f"No reading has arrived within {self.stale_within:g} s. Is the robot on?")
            try:
                self.silence()
                known = self._ticks(
                    bridge, self.stale_within, lambda: bridge.status.state in _SILENT, _drive_all
                )
                require(
                    known,
                    f"{self.stale_within:g} s after the last data its status is"
                    f" `{bridge.status.state.value}`. `feed` the values, or give `add_variable` an `age` and"
                    " `stale_after`.",
                )
                self._check_standing(bridge, sent, calls)
                bridge.begin_tick(self._now, _PERIOD)
                timed = [each for each in heard if each.stale_after is not None or not each.knows_age]
                fresh = [f"`{each.path}` is {each.value!r}" for each in timed if read(each) is not None]
                bridge.end_tick(self._now)
                require(not fresh, f"{self.stale_within:g} s after the last data, {', '.join(fresh)}.")
            finally:
                self._restore()

    def test_a_cut_connection_is_a_lost_robot(self) -> None:
        """Without a connection the status is lost, that is logged, commands fail, and the robot stands."""
        bridge = self.make_bridge()
        if not _is_connected(bridge):
            return
        self._require_hook("cut")
        with self._opened(bridge):
            _, sent, calls = self._drive(bridge)
            try:
                self._lose(bridge)
                self._check_standing(bridge, sent, calls)
                notices = [notice.text for notice in bridge.safety.notices if notice.kind == "fault"]
                require(bool(notices), "No notice says that it was lost.")
                for method in commands(bridge):
                    got = catch(method)
                    try:
                        give(bridge, method)
                        failed = isinstance(method, RobotTask) and method.status == "lost"
                    except BridgeError:
                        failed = True
                    require(not got, f"`{method.path}` was sent to a lost robot.")
                    require(failed, f"`{method.path}` did not fail, though the robot is lost.")
            finally:
                self._restore()

    def test_a_robot_that_is_found_is_stopped_first(self) -> None:
        """A robot that is found again is stopped, and gets no command a second time."""
        bridge = self.make_bridge()
        if not _is_connected(bridge):
            return
        self._require_hook("cut")
        self._require_hook("restore")
        with self._opened(bridge):
            _, sent, calls = self._drive(bridge)
            self._lose(bridge)
            for method in commands(bridge):
                with suppress(BridgeError):
                    give(bridge, method)
            before = _moved(sent)
            del calls[:]
            self.restore()
            found = self._ticks(bridge, self.open_within, until=lambda: bridge.status.state not in _DOWN)
            require(found, f"It was not found within {self.open_within:g} s: {bridge.status.sentence}")
            require(bool(calls) or bridge.stops_when_found, "It was not stopped when it was found.")
            require(_moved(sent) == before, "A command was sent again when it was found.")

    # ---------------------------------------------------------------------------------------------

    _now = 0.0

    def _ticks(
        self,
        bridge: Bridge,
        seconds: float,
        until: Callable[[], bool],
        act: Callable[[Bridge], object] = lambda _: None,
    ) -> bool:
        """Tick as a session whose block acts, until something holds; return whether it does in time."""
        for _ in range(round(seconds / _PERIOD)):
            bridge.begin_tick(self._now, _PERIOD)
            act(bridge)
            bridge.end_tick(self._now)
            if bridge.time_step is not None:
                bridge.advance(_PERIOD)
            self._now += _PERIOD
            if until():
                return True
            self.wait(_PERIOD)
        return until()

    def _drive(self, bridge: Bridge) -> tuple[list[RobotVariable], Sent, list[str]]:
        """Drive until data arrive; return the variables with a value, what is caught, and calls of `stop`."""
        bridge.arm()
        sent = [(method, catch(method)) for method in commands(bridge) if method.velocity]
        if variables(bridge):
            self._ticks(bridge, self.stale_within, lambda: _has_heard(bridge), _drive_all)
        return _heard(bridge), sent, spy(bridge, "stop")

    def _lose(self, bridge: Bridge) -> None:
        """Cut the connection, and require that this is known."""
        self.cut()
        lost = self._ticks(
            bridge, self.lost_within, lambda: bridge.status.state is ConnectionState.LOST, _drive_all
        )
        require(
            lost,
            f"{self.lost_within:g} s after its connection was cut, its status is"
            f" `{bridge.status.state.value}`."
            ' Call `set_status("lost", …)` where the library reports it.',
        )

    def _check_standing(self, bridge: Bridge, sent: Sent, calls: list[str]) -> None:
        """Require that the robot was stopped, and that no further command moves it."""
        # with commands, or the command watchdog would stop it; another thread may be what stops it
        stopped = self._ticks(bridge, self.answer_within, lambda: bool(calls), _drive_all)
        require(stopped, "The robot was not stopped.")
        before = _moved(sent)
        self._ticks(bridge, 4 * _PERIOD, until=lambda: False, act=_drive_all)
        require(_moved(sent) == before, "Commands still move the robot.")

    def _require_hook(self, name: str) -> None:
        """Raise NotChecked for something that the author has not defined."""
        if getattr(type(self), name) is getattr(BridgeConformance, name) and name not in vars(self):
            getattr(self, name)()

    def _restore(self) -> None:
        with suppress(NotChecked):
            self.restore()

    def _check_status(self, bridge: Bridge) -> None:
        status: object = bridge.status
        require(isinstance(status, BridgeStatus), f"`status` is {status!r}, not a BridgeStatus.")
        require(bool(bridge.status.sentence.strip()), "The status has no sentence.")

    @contextmanager
    def _opened(self, bridge: Bridge | None = None) -> Iterator[Bridge]:
        bridge = bridge or self.make_bridge()
        with self._closing(bridge):
            within(self.open_within, "`open`", bridge.open)
            yield bridge

    @contextmanager
    def _closing(self, bridge: Bridge) -> Iterator[None]:
        try:
            yield
        finally:
            within(self.open_within, "`close`", bridge.close)


def _note_messages(new: RobotVariable, seen: list[object], _: Bridge) -> None:
    value = read(new)
    seen.extend(value if isinstance(value, tuple) else ())


def _is_connected(bridge: Bridge) -> bool:
    """Return whether a bridge has a connection that could break: neither a world of its own nor no robot."""
    return bridge.time_step is None and not isinstance(bridge, NullBridge)


def _given(bridge: Bridge) -> set[str]:
    """Return the members that the bridge adds by itself: what arrives may add a reading at any time."""
    return {
        node.path
        for node in bridge.nodes.members()
        if not (isinstance(node, RobotVariable) and node.getter is bridge.fed.getter(node.path))
    }


def _drive_all(bridge: Bridge) -> None:
    for method in commands(bridge):
        if method.velocity:
            with suppress(BridgeError):
                drive(bridge, method)


def _moved(sent: Sent) -> int:
    """Return how many commands to move were sent; a stop may be a command of zeros."""
    return sum(command != method.standstill() for method, got in sent for command in got)


def _heard(bridge: Bridge) -> list[RobotVariable]:
    return [variable for variable in variables(bridge) if read(variable) is not None]


def _has_heard(bridge: Bridge) -> bool:
    """Return whether data have arrived, and the robot is no longer stopped for want of them."""
    return bool(_heard(bridge)) and not bridge.safety.blind


def check_bridge(
    bridge: Bridge | Callable[[], Bridge],
    *,
    move: bool = False,
    silence: Callable[[], object] | None = None,
    cut: Callable[[], object] | None = None,
    restore: Callable[[], object] | None = None,
) -> ConformanceReport:
    """Run every check on a bridge and return a report; never raises because of the bridge.

    Parameters
    ----------
    bridge : Bridge, Bridge class or function that makes one
        From a class or function each check gets a new bridge. A bridge instance is
        opened and closed by each check, and is closed in the end.
    move : bool
        Whether the robot may be moved a little: it has room, and a person watches it.
    silence, cut, restore : callable, optional
        Make the robot send no more data; break its connection; undo both. What is not given is not checked.
    """
    make = (lambda: bridge) if isinstance(bridge, Bridge) else bridge
    hooks = {"make_bridge": make, "silence": silence, "cut": cut, "restore": restore}
    outcomes = []
    for name in [name for name in vars(BridgeConformance) if name.startswith("test_")]:
        checks = BridgeConformance()
        vars(checks).update({key: hook for key, hook in hooks.items() if hook is not None}, moves=move)
        check = getattr(checks, name)
        problem = missing = ""
        try:
            check()
        except ConformanceError as error:
            problem = str(error)
        except NotChecked as error:
            missing = str(error)
        except Exception as error:
            problem = f"{type(error).__name__}: {error}"
        outcomes.append(Outcome((check.__doc__ or name).strip(), problem, missing))
    title = getattr(bridge, "name", None) or getattr(bridge, "__name__", "bridge")
    return ConformanceReport(f"Bridge `{title}`", tuple(outcomes))

"""The conformance tests: rules of every bridge, to be run by the author of a new one.

In a notebook::

    from lrp_jupyter.bridges.conformance import check_bridge
    print(check_bridge(MyBot))

With pytest::

    class TestMyBot(BridgeConformance):
        def make_bridge(self):
            return MyBot(port="/dev/ttyUSB0")

No check moves the robot: commands are caught before they reach the bridge's functions. Only `stop`
is really called.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

from lrp_jupyter.bridges.bridge import Bridge, BridgeStatus, ConnectionState
from lrp_jupyter.bridges.members import MemberError
from lrp_jupyter.bridges.probes import (
    ConformanceError,
    catch,
    commands,
    give,
    methods,
    read,
    require,
    spy,
    variables,
    within,
)
from lrp_jupyter.errors import BridgeError, ended

__all__ = ["BridgeConformance", "ConformanceError", "ConformanceReport", "Outcome", "check_bridge"]


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of one check; `problem` is empty if it passed."""

    check: str
    problem: str = ""

    @property
    def passed(self) -> bool:
        """Whether the check passed."""
        return not self.problem


@dataclass(frozen=True, slots=True)
class ConformanceReport:
    """The outcomes of `check_bridge`; its text is a readable list."""

    bridge: str
    outcomes: tuple[Outcome, ...]

    @property
    def passed(self) -> bool:
        """Whether all checks passed."""
        return all(outcome.passed for outcome in self.outcomes)

    @property
    def problems(self) -> tuple[Outcome, ...]:
        """The checks that failed."""
        return tuple(outcome for outcome in self.outcomes if not outcome.passed)

    def __bool__(self) -> bool:
        return self.passed

    def __str__(self) -> str:
        good = len(self.outcomes) - len(self.problems)
        lines = [f"{self.bridge}: {good} of {len(self.outcomes)} checks passed"]
        for outcome in self.outcomes:
            lines.append(f"  {'ok  ' if outcome.passed else 'FAIL'}  {outcome.check}")
            if outcome.problem:
                lines.append(f"        {outcome.problem}")
        return "\n".join(lines)

    __repr__ = __str__


class BridgeConformance:
    """The checks; a subclass defines with `make_bridge` which bridge they are for.

    Attributes
    ----------
    open_within, answer_within : float
        Seconds that opening may take, and anything else.
    """

    open_within: ClassVar[float] = 15.0
    answer_within: ClassVar[float] = 1.5

    def make_bridge(self) -> Bridge:
        """Return a new bridge to check, not open; called for each check."""
        raise NotImplementedError("Define `make_bridge` in a subclass. It returns the bridge to check.")

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
            before = set(bridge.nodes.table)
            within(self.answer_within, "The second `open`", bridge.open)
            require(len(calls) == 1, f"`open_interface` was called {len(calls)} times.")
            require(set(bridge.nodes.table) == before, "The second `open` changed the members.")
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
            before = set(bridge.nodes.table)
        with self._opened(bridge):
            require(set(bridge.nodes.table) == before, "The second connection has other members.")

    def test_no_thread_is_left(self) -> None:
        """Closing ends every thread that opening started."""
        before = set(threading.enumerate())
        with self._opened(self.make_bridge()):
            pass
        for thread in set(threading.enumerate()) - before:
            thread.join(self.answer_within)
            require(not thread.is_alive(), f"The thread {thread.name!r} runs on after `close`.")

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

    def test_pause_stops(self) -> None:
        """Pausing the program stops the robot; resuming it sends no command."""
        with self._opened() as bridge:
            bridge.arm()
            bridge.on_start()
            bridge.begin_tick(0.0, 0.1)
            bridge.end_tick(0.0)
            calls = spy(bridge, "stop", "stop_all")
            within(self.answer_within, "`on_pause`", bridge.on_pause)
            require(bool(calls), "`on_pause` did not stop the robot.")
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

    # ---------------------------------------------------------------------------------------------

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


def check_bridge(bridge: Bridge | Callable[[], Bridge]) -> ConformanceReport:
    """Run every check on a bridge and return a report; never raises because of the bridge.

    Parameters
    ----------
    bridge : Bridge, Bridge class or function that makes one
        From a class or function each check gets a new bridge. A bridge instance is
        opened and closed by each check, and is closed in the end.
    """
    make = (lambda: bridge) if isinstance(bridge, Bridge) else bridge
    outcomes = []
    for name in [name for name in vars(BridgeConformance) if name.startswith("test_")]:
        checks = BridgeConformance()
        checks.make_bridge = make  # type: ignore[method-assign]
        check = getattr(checks, name)
        try:
            check()
        except ConformanceError as error:
            problem = str(error)
        except Exception as error:
            problem = f"{type(error).__name__}: {error}"
        else:
            problem = ""
        outcomes.append(Outcome((check.__doc__ or name).strip(), problem))
    title = getattr(bridge, "name", None) or getattr(bridge, "__name__", "bridge")
    return ConformanceReport(f"Bridge `{title}`", tuple(outcomes))

"""The public checks: good bridges pass all of them, and for each there is a bridge that fails it."""

from __future__ import annotations

import itertools
import threading
from types import SimpleNamespace
from typing import Any

import pytest

from lrp_jupyter.bridges import probes
from lrp_jupyter.bridges.bridge import Bridge, ConnectionState, NullBridge, Panel, Task, Twist
from lrp_jupyter.bridges.conformance import BridgeConformance, ConformanceError, NotChecked, check_bridge
from lrp_jupyter.bridges.message import Message
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError

AGES = "test_readings_tell_their_age"  # a remark, never a failure
CHECKS = sorted(name for name in vars(BridgeConformance) if name.startswith("test_"))


class TestNullBridge(BridgeConformance):
    moves = True

    def make_bridge(self) -> Bridge:
        return NullBridge()


class TestSimBridge(BridgeConformance):
    moves = True

    def make_bridge(self) -> Bridge:
        return SimBridge("line", noise={"light": 10})

    def has_moved(self, bridge: Bridge) -> bool:
        return bridge.pose != SimBridge("line").pose


class Good(Bridge):
    """A bridge with something of everything."""

    name = "test-good-bot"

    def __init__(self) -> None:
        self.done: list[object] = []

    def open_interface(self) -> Panel | None:
        self.add_variable("light.data", lambda: 7, "0 dark ... 255 bright")
        self.add_variable("slow", lambda: None, "never arrives")
        self.add_method("move", self.done.append, "drive", message=Twist)
        self.add_method("beep", self.beep, "sound a tone")
        return Panel("Good")

    def beep(self, seconds: float) -> None:
        self.done.append(seconds)


class Air:
    """What is between a bridge and its robot: here, both are in one time."""

    def __init__(self) -> None:
        self.time = 0.0
        self.robot_talks = self.connected = True
        self.arrived: list[object] = []
        self.listeners: list[Far] = []

    def wait(self, seconds: float) -> None:
        for thread in threading.enumerate():
            if thread.name.startswith("task "):
                thread.join()
        self.time += seconds
        for bridge in self.listeners:
            if bridge.is_open:
                bridge.hear()


class Far(Bridge):
    """A robot that is far away, with what a good bridge does about it."""

    name = "test-far"

    def __init__(self, air: Air) -> None:
        self.air = air
        self.fed.clock = lambda: air.time
        air.listeners.append(self)

    def add_members(self) -> None:
        self.feed("light.data", doc="0 dark ... 255 bright")
        self.feed("battery", doc="what is left", stale_after=None)
        self.add_method("move", self.move, "drive, in m/s", limits={"linear": 0.5})
        self.add_task("dock", self.dock, self.undock, "drive to the dock, in m/s")

    def open_interface(self) -> None:
        """Nothing to connect to but the air."""

    def dock(self, task: Task, speed: float) -> None:
        self.move(speed)

    def undock(self, task: Task) -> None:
        self.move()

    def hear(self) -> None:
        """What the thread of a library does."""
        if not self.air.connected:
            self.set_status("lost", "There is no air.")
        elif self.status.state is ConnectionState.LOST:
            self.set_status("connected")
        if self.air.connected and self.air.robot_talks:
            self.feed("light.data", 7)
            self.feed("battery", 0.8)

    def move(self, linear: float = 0.0) -> None:
        if self.air.connected:
            self.air.arrived.append(linear)

    def stop(self) -> None:
        self.move()


class FarConformance(BridgeConformance):
    open_within, stale_within, lost_within = 15.0, 2.0, 6.0  # s of the robot's time
    moves = True
    bridge: type[Bridge] = Far

    def make_bridge(self) -> Bridge:
        self.air = Air()
        return self.bridge(self.air)

    def silence(self) -> None:
        self.air.robot_talks = False

    def cut(self) -> None:
        self.air.connected = False

    def restore(self) -> None:
        self.air.robot_talks = self.air.connected = True

    def has_moved(self, bridge: Bridge) -> bool:
        return 0.05 in self.air.arrived

    def wait(self, seconds: float) -> None:
        self.air.wait(seconds)


class TestFar(FarConformance):
    """A good bridge passes everything."""


# -- bridges that are broken, each in one way -----------------------------------------------------


class BadName(Good):
    name = "my bot!"


class OpensTwice(Good):
    def open(self) -> Panel | None:
        return self.open_interface()


class MembersPileUp(Good):
    def open(self) -> Panel | None:
        panel = super().open()
        self.add_variable(f"extra{len(self.members())}", lambda: 1, "one more at each open")
        return panel


class NeverOpen(Good):
    is_open = False  # type: ignore[assignment]


class SpeechlessStatus(Good):
    def open_interface(self) -> None:
        self.set_status("connected", " ")


class ClosesWithoutStop(Good):
    def close(self) -> None:
        if self.is_open:
            self._is_open = False
            self.close_interface()
            self.set_status("disconnected")


class ClosesAgain(Good):
    def close(self) -> None:
        self._is_open = True
        super().close()


class CannotCloseUnopened(Good):
    def close(self) -> None:
        if not self.done and not self.is_open:
            raise BridgeError("it is not open")
        super().close()


class OpensOnlyOnce(Good):
    used = False

    def open_interface(self) -> None:
        if self.used:
            raise BridgeError("it was used already")
        self.used = True


class ForgetsMembers(Good):
    used = False

    def open_interface(self) -> None:
        if not self.used:
            self.add_variable("x", lambda: 1, "only the first time")
        self.used = True


class LeavesAThread(Good):
    def open_interface(self) -> None:
        self.end = threading.Event()
        threading.Thread(target=self.end.wait, args=(5,), daemon=True).start()


class Undocumented(Good):
    def open_interface(self) -> None:
        self.add_variable("x", lambda: 1)


class PanelWithAnObject(Good):
    def open_interface(self) -> Panel:
        return Panel("Bad", fields=(object(),))  # type: ignore[arg-type]


class MisnamedMember(Good):
    def describe(self, path: str) -> Any:
        return super().describe("light.data")


class HidesMembers(Good):
    def open(self) -> Panel | None:
        panel = super().open()
        self.robot = type("Mute", (), {"__dir__": lambda robot: []})()
        return panel


class HangingReading(Good):
    def open_interface(self) -> None:
        self.end = threading.Event()
        self.add_variable("x", lambda: self.end.wait(1), "takes its time")


class FlickeringReading(Good):
    def open_interface(self) -> None:
        count = itertools.count()
        self.add_variable("x", lambda: next(count), "changes all the time")

    def begin_tick(self, now: float, period: float) -> None:
        """Without the latch."""


class AnswersAnything(Good):
    def open(self) -> Panel | None:
        panel = super().open()
        self.robot = type("Anything", (), {"__getattr__": lambda robot, name: 0})()
        return panel


class Terse(Good):
    def open(self) -> Panel | None:
        panel = super().open()
        self.robot = type("Terse", (), {"light": 1})()
        return panel


class Assignable(Good):
    def open(self) -> Panel | None:
        panel = super().open()
        robot = self.robot
        body = {"__getattr__": lambda _, name: getattr(robot, name), "__dir__": lambda _: dir(robot)}
        self.robot = type("Open", (), body)()
        return panel


class ArmsItself(Good):
    def open_interface(self) -> None:
        self.arm()


class MoveAsQuestion(Good):
    def open_interface(self) -> None:
        self.add_method("move", self.done.append, "drive", message=Twist, command=False)


class SendsDisarmed(Good):
    def send(self, method: Any, command: Any) -> object:
        return method.perform(command)


class RecordsNothing(Good):
    def send(self, method: Any, command: Any) -> object:
        return super().send(method, command) if self.safety.armed else None


class SendsTwice(Good):
    def send(self, method: Any, command: Any) -> object:
        super().send(method, command)
        return super().send(method, command)


class IgnoresTheStop(Good):
    def stop_all(self) -> bool:
        self.stop()
        return True


class StopFails(Good):
    def stop(self) -> None:
        raise OSError("unplugged")


class StopRaises(Good):
    def stop_all(self) -> bool:
        raise OSError("unplugged")


class StopHangs(Good):
    end = threading.Event()

    def stop_all(self) -> bool:
        self.end.wait(1)
        return super().stop_all()


class StopOnlyWhenArmed(Good):
    def _stop_now(self) -> bool:
        return super()._stop_now() if self.safety.armed else True


class SendsAgainOnResume(Good):
    def on_resume(self) -> None:
        self.safety.held = False
        self.robot.move(linear=0.2)


class DrivesOnInSilence(Good):
    def end_tick(self, now: float) -> None:
        self.act(now)


class NotWatched(Good):
    def check_watchdog(self, now: float) -> None:
        return None


class Nervous(Good):
    def check_watchdog(self, now: float) -> Any:
        self.stop_all()
        return self.safety.notice("tick watchdog", "late")


class SaysButDoesNot(Good):
    def check_watchdog(self, now: float) -> Any:
        sentence = self.safety.tick_overdue(now)
        return sentence and self.safety.notice("tick watchdog", sentence)


class SenseFails(Good):
    def sense(self, now: float) -> None:
        raise OSError("unplugged")


class ActHangs(Good):
    end = threading.Event()

    def act(self, now: float) -> None:
        self.end.wait(1)


class StepsBackArmed(Good):
    def rewind(self, moment: object) -> None:
        """Pretends."""


class Deaf(Far):
    """The story of a robot that drove on: its receiving thread had died, and its values stayed."""

    def add_members(self) -> None:
        self.newest: int | None = None
        self.add_variable("light.data", lambda: self.newest, "0 dark ... 255 bright")
        self.add_method("move", self.move, "drive, in m/s", limits={"linear": 0.5})

    def hear(self) -> None:
        if self.air.connected and self.air.robot_talks:
            self.newest = 7


class OldReadings(Deaf):
    """It knows that it hears nothing, and its readings stay."""

    def hear(self) -> None:
        super().hear()
        if not self.air.robot_talks:
            self.set_status("lost", "The robot is silent.")


class LatchesItself(Far):
    def sense(self, now: float) -> None:
        self.fed.latch()  # so that it is fresh


class FeedsTwice(Far):
    def feed(self, name: str, value: object = None, **described: Any) -> None:
        super().feed(name, value, **described)
        if value is not None:
            super().feed(name, value)


class DrivesOnBlindly(Far):
    def judge_ages(self) -> None:
        super().judge_ages()
        self.safety.blind = ""


class OnlySays(Far):
    def judge_ages(self) -> None:
        if any(variable.judge() for variable in self.nodes.timed):
            self.set_status("stale")


class NoticesNoCut(Far):
    def hear(self) -> None:
        if self.air.connected and self.air.robot_talks:
            self.feed("light.data", 7)


class CommandsTheLost(Far):
    def send(self, method: Any, command: Any) -> object:
        self.safety.lost = ""
        return super().send(method, command)


class DrivesOnWhenFound(Far):
    stops_when_found = False

    def set_status(self, state: Any, sentence: str = "") -> None:
        self.safety.has_commanded = False
        super().set_status(state, sentence)


class SendsWhatIsLeft(Far):
    def set_status(self, state: Any, sentence: str = "") -> None:
        was_lost = bool(self.safety.lost)
        super().set_status(state, sentence)
        if was_lost and state == "connected":
            self.nodes.table["move"].perform(self.left)  # type: ignore[attr-defined]

    def send(self, method: Any, command: Any) -> object:
        if method.path == "move" and any(command.arguments.values()):
            self.left = command
        return super().send(method, command)


class NeverFound(Far):
    def hear(self) -> None:
        if not self.air.connected:
            self.set_status("lost", "There is no air.")
        else:
            self.feed("light.data", 7)


class MoveFails(Far):
    def move(self, linear: float = 0.0) -> None:
        raise OSError("unplugged")


class MoveIsForgotten(Far):
    def move(self, linear: float = 0.0) -> None:
        """Only pretends."""


class CallsNothing(Far):
    def send(self, method: Any, command: Any) -> object:
        return None


class NeverDocks(Far):
    def send(self, method: Any, command: Any) -> object:
        return None if method.path == "dock" else super().send(method, command)


class CannotUndock(Far):
    def undock(self, task: Task) -> None:
        raise OSError("unplugged")


class StopFailsAfterMoving(Far):
    def stop(self) -> None:
        if self.air.arrived:
            raise OSError("unplugged")


class StopIsAReading(Good):
    def add_members(self) -> None:
        self.add_variable("stop", lambda: 1, "where it stops")


class StopHoldsTheTick(Good):
    def add_members(self) -> None:
        self.add_method("stop", self.stop_all, "stop and hold")


BROKEN: list[tuple[type[Bridge], str, str]] = [
    (
        Deaf,
        "test_data_that_cease_stop_the_robot",
        "2 s after the last data its status is `connected`. `feed`",
    ),
    (OldReadings, "test_data_that_cease_stop_the_robot", "after the last data, `light.data` is 7."),
    (DrivesOnBlindly, "test_data_that_cease_stop_the_robot", "Commands still move the robot."),
    (OnlySays, "test_data_that_cease_stop_the_robot", "The robot was not stopped."),
    (NoticesNoCut, "test_a_cut_connection_is_a_lost_robot", "its status is `stale`. Call `set_status"),
    (CommandsTheLost, "test_a_cut_connection_is_a_lost_robot", "Commands still move the robot."),
    (DrivesOnWhenFound, "test_a_robot_that_is_found_is_stopped_first", "not stopped when it was found"),
    (SendsWhatIsLeft, "test_a_robot_that_is_found_is_stopped_first", "was sent again when it was found"),
    (NeverFound, "test_a_robot_that_is_found_is_stopped_first", "not found within 15 s: There is no air."),
    (MoveFails, "test_a_command_reaches_the_robot", "`robot.move` failed: OSError: unplugged"),
    (MoveIsForgotten, "test_a_command_reaches_the_robot", "not reached the robot within 2 s"),
    (CallsNothing, "test_a_command_reaches_the_robot", "called no function"),
    (StopFailsAfterMoving, "test_a_command_reaches_the_robot", "may not have stopped: OSError: unplugged"),
    (NeverDocks, "test_a_stop_cancels_a_task", "The task that was asked for has not begun."),
    (CannotUndock, "test_a_stop_cancels_a_task", "may not have stopped: OSError: unplugged"),
    (StopIsAReading, "test_a_program_can_stop_it", "has no command `stop`"),
    (
        StopHoldsTheTick,
        "test_a_program_can_stop_it",
        "After `robot.stop()`, `move` was not sent in the same tick.",
    ),
    (BadName, "test_it_has_a_name", "cannot be typed"),
    (OpensTwice, "test_open_connects_once", "was called 2 times"),
    (MembersPileUp, "test_open_connects_once", "The second `open` changed the members"),
    (NeverOpen, "test_open_connects_once", "not open after `open`"),
    (SpeechlessStatus, "test_status_is_said_in_a_sentence", "has no sentence"),
    (ClosesWithoutStop, "test_close_stops_first_and_once", "did not stop the robot first"),
    (ClosesAgain, "test_close_stops_first_and_once", "The second `close` closed again"),
    (
        CannotCloseUnopened,
        "test_close_before_open_does_nothing",
        "`close` raised BridgeError: it is not open",
    ),
    (OpensOnlyOnce, "test_it_opens_again_after_close", "`open` raised BridgeError: it was used already"),
    (ForgetsMembers, "test_it_opens_again_after_close", "has other members"),
    (LeavesAThread, "test_no_thread_is_left", "runs on after `close`"),
    (Undocumented, "test_members_are_documented", "These members have no description: `x`."),
    (PanelWithAnObject, "test_views_get_plain_data", "The panel cannot be written as JSON"),
    (MisnamedMember, "test_members_can_be_described", "`slow` is not found"),
    (HidesMembers, "test_members_can_be_described", "not listed by dir"),
    (HangingReading, "test_readings_come_in_time", "Reading `x` took more than"),
    (FlickeringReading, "test_one_tick_sees_one_world", "`x` was 0, then 1 in the same tick"),
    (AnswersAnything, "test_an_unknown_member_is_answered_with_the_known_ones", "raises no error"),
    (Terse, "test_an_unknown_member_is_answered_with_the_known_ones", "raises AttributeError"),
    (Assignable, "test_an_unknown_member_is_answered_with_the_known_ones", "can be assigned"),
    (ArmsItself, "test_hardware_opens_disarmed", "Opening armed it."),
    (MoveAsQuestion, "test_move_is_a_velocity_command", "bypasses the safety"),
    (SendsDisarmed, "test_disarmed_sends_nothing", "`move` was sent"),
    (RecordsNothing, "test_disarmed_sends_nothing", "`move` was not recorded"),
    (SendsTwice, "test_armed_sends", "was sent 2 times"),
    (IgnoresTheStop, "test_a_stop_holds_for_the_tick", "was sent after the stop"),
    (StopFails, "test_stop_all_works_on_any_thread", "may not have stopped: OSError: unplugged"),
    (StopRaises, "test_stop_all_works_on_any_thread", "raised OSError"),
    (StopHangs, "test_stop_all_works_on_any_thread", "took more than"),
    (StopOnlyWhenArmed, "test_stop_all_works_on_any_thread", "did not call `stop`"),
    (SendsAgainOnResume, "test_going_on_after_a_pause_sends_nothing", "`on_resume` sent a command"),
    (LatchesItself, "test_every_value_that_is_fed_comes_once", "`robot.light.new` has 0 of them"),
    (FeedsTwice, "test_every_value_that_is_fed_comes_once", "`robot.light.new` has 4 of them"),
    (DrivesOnInSilence, "test_silence_stops_a_velocity", "moved on without new commands"),
    (NotWatched, "test_a_hanging_loop_stops_the_robot", "did not report it"),
    (Nervous, "test_a_hanging_loop_stops_the_robot", "too early"),
    (SaysButDoesNot, "test_a_hanging_loop_stops_the_robot", "did not stop"),
    (SenseFails, "test_ticks_are_short_and_never_raise", "`sense` raised OSError: unplugged."),
    (ActHangs, "test_ticks_are_short_and_never_raise", "`act` took more than"),
    (StepsBackArmed, "test_an_armed_robot_cannot_step_back", "was not refused"),
]


class AnyConformance(FarConformance):
    def make_bridge(self) -> Bridge:
        return super().make_bridge() if issubclass(self.bridge, Far) else self.bridge()


@pytest.mark.parametrize(
    ("broken", "check", "problem"), BROKEN, ids=lambda value: getattr(value, "__name__", None)
)
def test_a_broken_bridge_fails_the_check(broken: type[Bridge], check: str, problem: str) -> None:
    hangs = "took more than" in problem or "runs on" in problem
    limits = {"answer_within": 0.2} if hangs else {}
    checks = type("Checks", (AnyConformance,), {"bridge": broken, **limits})()
    with pytest.raises(ConformanceError) as error:
        getattr(checks, check)()
    assert problem in str(error.value)


@pytest.mark.parametrize("check", ["test_open_connects_once", "test_it_opens_again_after_close"])
def test_an_undeclared_reading_may_arrive_at_any_time(check: str) -> None:
    numbers = itertools.count()

    class Surprised(Good):
        def open(self) -> Panel | None:
            panel = super().open()
            self.feed(f"heard{next(numbers)}", 1, doc="of something that is new")
            return panel

    getattr(type("Checks", (AnyConformance,), {"bridge": Surprised})(), check)()


def test_every_check_can_fail() -> None:
    assert sorted({check for _, check, _ in BROKEN}) == [check for check in CHECKS if check != AGES]


def test_a_report_is_a_list_to_read() -> None:
    report = check_bridge(Undocumented)
    assert not report.passed
    lines = str(report).splitlines()
    assert lines[0] == (
        f"Bridge `undocumented`: {len(CHECKS) - 6} of {len(CHECKS)} checks passed, 1 failed, 5 not checked"
    )
    assert "  FAIL  Every member has a description, for completion and hover." in lines
    assert "        These members have no description: `x`." in lines
    assert [outcome.problem for outcome in report.problems] == ["These members have no description: `x`."]
    assert repr(report) == str(report)


def test_a_good_bridge_has_a_clean_report_with_what_could_not_be_checked_and_is_closed() -> None:
    bridge = Good()
    report = check_bridge(bridge)
    assert report.passed
    assert "FAIL" not in str(report)
    assert len(report.outcomes) == len(CHECKS)
    assert not bridge.is_open
    assert all(isinstance(done, Message) and done == Twist() for done in bridge.done), "only stops reached it"
    missing = {outcome.missing for outcome in report.unchecked}
    assert {sentence.partition(",")[0].partition(":")[0] for sentence in missing} == {
        "The age of `light.data`",  # and of others
        "It would move the robot. Give it room",
        "Define `silence` in a subclass",
        "Define `cut` in a subclass",
    }
    assert not any(outcome.passed for outcome in report.unchecked)
    assert "  ?   A command arrives at the bridge's function and at the robot" in str(report)
    assert "        Not checked: It would move the robot." in str(report)


def test_what_the_author_gives_is_checked() -> None:
    air = Air()

    def patient(name: str) -> Any:
        return lambda: setattr(air, name, False)

    def restore() -> None:
        air.connected = air.robot_talks = True

    original, BridgeConformance.wait = BridgeConformance.wait, lambda _, seconds: air.wait(seconds)  # type: ignore[method-assign]
    try:
        report = check_bridge(
            lambda: Far(air),
            move=True,
            silence=patient("robot_talks"),
            cut=patient("connected"),
            restore=restore,
        )
    finally:
        BridgeConformance.wait = original  # type: ignore[method-assign]
    assert not report.problems + report.unchecked, str(report)
    assert 0.05 in air.arrived


def test_a_robot_that_says_nothing_cannot_be_silenced() -> None:
    class Mute(Far):
        def hear(self) -> None:
            """Nothing comes."""

    checks = type("Checks", (FarConformance,), {"bridge": Mute})()
    with pytest.raises(NotChecked, match=r"No reading has arrived within 2 s\. Is the robot on\?"):
        checks.test_data_that_cease_stop_the_robot()


class HeardLate(Far):
    """Its robot has been waited for when it is heard, in a tick."""

    def hear(self) -> None:
        if self.safety.now > 1.2:
            super().hear()

    def act(self, now: float) -> None:
        self.hear()


class HeldUp(FarConformance):
    bridge = HeardLate

    def silence(self) -> None:
        super().silence()
        self.air.time += 5.0


def test_a_machine_that_holds_up_the_checks_when_the_first_data_have_come_changes_nothing() -> None:
    HeldUp().test_data_that_cease_stop_the_robot()


def test_a_bridge_that_cannot_even_be_made_is_reported() -> None:
    def make() -> Bridge:
        raise OSError("no such port")

    report = check_bridge(make)
    assert not report.passed
    assert {outcome.problem for outcome in report.outcomes} == {"OSError: no such port"}


def test_the_checks_want_to_know_which_bridge() -> None:
    with pytest.raises(NotImplementedError, match="make_bridge"):
        BridgeConformance().make_bridge()


def test_a_robot_whose_data_are_late_when_it_is_to_be_moved_is_given_time() -> None:
    class Late(Good):
        def open_interface(self) -> Panel | None:
            ages = itertools.chain([9.0, 9.0], itertools.repeat(0.0))
            self.add_variable("scan", lambda: 7, "a reading", age=lambda: next(ages), stale_after=0.5)
            return super().open_interface()

    checks = BridgeConformance()
    checks.moves = True
    late = Late()
    checks.make_bridge = lambda: late  # type: ignore[method-assign]
    checks.wait = lambda _: None  # type: ignore[method-assign]
    checks.test_a_command_reaches_the_robot()
    assert [done for done in late.done if done != Twist()], "it was moved"


@pytest.mark.parametrize("hangs", [False, True])
def test_a_limit_of_time_does_not_count_while_the_machine_does_something_else(
    monkeypatch: pytest.MonkeyPatch, hangs: bool
) -> None:
    class Held:
        """A thread that ends with the last slice of time that it is waited for, however long each took."""

        def __init__(self, target: Any, **_: object) -> None:
            self.start, self.slices = target, list[float]()

        def join(self, seconds: float) -> None:
            self.slices.append(seconds)

        def is_alive(self) -> bool:
            assert sum(self.slices) == pytest.approx(0.5)
            return hangs

    monkeypatch.setattr(probes, "threading", SimpleNamespace(Thread=Held))
    if hangs:
        with pytest.raises(ConformanceError, match=r"It took more than 0\.5 s\."):
            probes.within(0.5, "It", lambda: "in time")
    else:
        assert probes.within(0.5, "It", lambda: "in time") == "in time"

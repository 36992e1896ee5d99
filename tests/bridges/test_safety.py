"""Safety is in the base class, so every bridge has it."""

from __future__ import annotations

import json
import threading
from contextlib import suppress
from operator import attrgetter
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.robots import Bare, Cart

from lrp_jupyter.bridges.bridge import Bridge, Twist
from lrp_jupyter.bridges.guarding import safety
from lrp_jupyter.bridges.guarding.safety import Origin, patience
from lrp_jupyter.errors import BridgeError


def tick(bridge: Bridge, now: float, period: float = 0.1) -> None:
    bridge.begin_tick(now, period)
    bridge.end_tick(now)


def meanwhile(bridge: Bridge, speed: float) -> None:
    """Drive in a tick on the thread of the program, while this one does something else."""

    def drive() -> None:
        bridge.begin_tick(0.1, 0.1)
        bridge.robot.move(linear=speed)
        bridge.end_tick(0.1)

    thread = threading.Thread(target=drive)
    thread.start()
    thread.join()


def texts(bridge: Bridge) -> list[str]:
    return [notice.text for notice in bridge.safety.notices]


# -- armed ----------------------------------------------------------------------------------------


def test_hardware_opens_disarmed_and_records_what_it_does_not_send(disarmed: Any) -> None:
    disarmed.robot.move(linear=0.2)
    assert disarmed.sent == []
    record = disarmed.safety.commands[-1]
    assert (record.name, record.arguments, record.sent) == ("move", {"linear": 0.2}, False)
    assert texts(disarmed) == ["`move` was not sent: the robot is disarmed."]


def test_arming_sends_from_then_on_and_nothing_of_before(disarmed: Any) -> None:
    disarmed.robot.move(linear=0.2)
    disarmed.arm()
    disarmed.arm()
    assert disarmed.sent == []
    disarmed.robot.move(linear=0.3)
    assert disarmed.sent == [(0.3, 0.0)]
    assert texts(disarmed)[1:] == [f"`test-cart` is armed: commands move the robot. {disarmed.failsafe}"]


def test_disarming_stops_the_robot_first(cart: Any) -> None:
    cart.robot.move(linear=0.2)
    cart.disarm()
    cart.disarm()
    cart.robot.move(linear=0.3)
    assert cart.sent == [(0.2, 0.0), (0.0, 0.0)]


def test_a_tick_that_begins_while_disarming_stops_the_robot_sends_nothing(cart: Any) -> None:
    def stop() -> None:  # it takes a while, and the program does not wait for it
        cart.sent.append("stop")
        meanwhile(cart, 0.3)

    cart.stop = stop
    cart.begin_tick(0.0, 0.1)
    cart.robot.move(linear=0.2)
    cart.end_tick(0.0)
    cart.disarm()
    assert cart.sent == [(0.2, 0.0), "stop"]


def test_a_question_is_answered_while_disarmed() -> None:
    bridge = Bare(
        lambda it: it.add_method("version", lambda: 3, "of the firmware", command=False), hardware=True
    )
    bridge.open()
    assert bridge.robot.version() == 3
    assert bridge.safety.commands == ()


def test_wrong_arguments_are_refused_while_disarmed_too(disarmed: Any) -> None:
    with pytest.raises(BridgeError, match="liner"):
        disarmed.robot.move(liner=1)


def test_the_same_notice_again_and_again_is_counted(disarmed: Any) -> None:
    for _ in range(50):
        disarmed.robot.move(linear=0.2)
    assert [notice.count for notice in disarmed.safety.notices] == [50]
    assert disarmed.safety.command_count == 50


def test_the_log_is_bounded_and_plain_data(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(safety, "COMMANDS", 200)
    cart = Cart()
    cart.open()
    for number in range(500):
        cart.robot.move(linear=number)
        cart.safety.notice("fault", f"Fault {number}.")
    assert len(cart.safety.notices) == 100
    assert len(cart.safety.commands) == 201
    json.dumps([entry.as_dict() for entry in (*cart.safety.commands, *cart.safety.notices)])


def test_an_argument_that_json_does_not_know_is_a_text_in_the_log(disarmed: Any) -> None:
    disarmed.robot.beep(object())
    json.dumps(disarmed.safety.commands[-1].as_dict())


# -- limits ---------------------------------------------------------------------------------------


def test_a_number_beyond_the_limit_is_brought_back_and_shown(cart: Any) -> None:
    cart.robot.move(linear=2)
    cart.robot.move(-2)
    assert cart.sent == [(0.5, 0.0), (-0.5, 0.0)]
    assert texts(cart)[1:] == ["`move`: linear 2 limited to 0.5.", "`move`: linear -2 limited to -0.5."]
    assert cart.safety.commands[-1].limited == ("`move`: linear -2 limited to -0.5.",)


def test_a_limit_is_said_once_for_each_line_whatever_is_asked_for(cart: Any) -> None:
    lines = iter([3, 3, 5, 3])
    cart.origin = lambda: Origin(7, "going.running", next(lines))
    for speed in (2, 3.5, 2, 0.7):
        cart.robot.move(linear=speed)
    first, second = cart.safety.notices[1:]
    assert (first.text, first.count, first.first) == (
        "`move`: linear 2 limited to 0.5.",
        3,
        (7, "going.running", 3, ()),
    )
    assert (second.text, second.count, second.first.line) == ("`move`: linear 2 limited to 0.5.", 1, 5)
    cart.safety.forget_notices("limited")
    assert len(cart.safety.notices) == 1


def test_a_number_within_the_limit_is_left_alone(cart: Any) -> None:
    cart.robot.move(linear=0.5)
    cart.robot.move(angular=9)
    assert cart.sent == [(0.5, 0.0), (0.0, 9)]
    assert len(texts(cart)) == 1


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "1", None, True])
def test_what_is_limited_must_be_a_number(cart: Any, value: object) -> None:
    with pytest.raises(BridgeError, match=r"`move\(linear=…\)` must be a"):
        cart.robot.move(linear=value)
    assert cart.sent == []


def limited() -> Bare:
    """Limits of a message."""

    def members(bridge: Any) -> None:
        limits = {"linear": (-0.1, 0.5), "angular.z": 1.0}
        bridge.add_method(
            "move",
            lambda msg: bridge.calls.append((msg.linear.x, msg.angular.z)),
            "drive",
            message=Twist,
            limits=limits,
        )

    bridge = Bare(members)
    bridge.open()
    return bridge


@given(st.floats(-5, 5), st.floats(-5, 5))
def test_nothing_beyond_the_limits_ever_reaches_the_robot(linear: float, angular: float) -> None:
    bridge = limited()
    bridge.robot.move(linear=linear, angular=angular)
    ((x, z),) = bridge.calls
    assert -0.1 <= x <= 0.5
    assert -1 <= z <= 1
    assert x == linear or bridge.safety.notices


def test_a_limit_that_is_upside_down_is_refused() -> None:
    with pytest.raises(ValueError, match="from the smaller to the larger"):
        Bare().add_method("lift", print, limits={"height": (1.0, 0.0)})


# -- the command watchdog -------------------------------------------------------------------------


def test_a_velocity_that_is_not_repeated_ends_after_half_a_second(cart: Any) -> None:
    cart.begin_tick(0.0, 0.1)
    cart.robot.move(linear=0.2)
    cart.end_tick(0.0)
    for number in range(1, 5):
        tick(cart, number / 10)
    assert cart.sent == [(0.2, 0.0)]
    tick(cart, 0.5)
    assert cart.sent[1:] == [(0.0, 0.0)]
    assert texts(cart)[-1] == "No command for 0.5 s. If it has to go on, put `move` into `running`."
    for number in range(6, 20):
        tick(cart, number / 10)
    assert len(cart.sent) == 2, "a robot that stands still needs no stop"


def test_a_velocity_that_is_repeated_continues(cart: Any) -> None:
    for number in range(30):
        cart.begin_tick(number / 10, 0.1)
        cart.robot.move(linear=0.2)
        cart.end_tick(number / 10)
    assert cart.sent == [(0.2, 0.0)] * 30


def test_a_slow_program_has_three_periods(cart: Any) -> None:
    cart.begin_tick(0.0, 1.0)
    cart.robot.move(linear=0.2)
    cart.end_tick(0.0)
    tick(cart, 1.0, 1.0)
    tick(cart, 2.0, 1.0)
    assert len(cart.sent) == 1
    tick(cart, 3.0, 1.0)
    assert texts(cart)[-1] == "No command for 3 s. If it has to go on, put `move` into `running`."


def test_standing_still_needs_no_repetition(cart: Any) -> None:
    cart.begin_tick(0.0, 0.1)
    cart.robot.move(linear=0.0)
    cart.end_tick(0.0)
    for number in range(1, 20):
        tick(cart, number / 10)
    assert cart.sent == [(0.0, 0.0)]


def test_a_motor_started_in_an_onentry_runs_on() -> None:
    bridge = Bare(lambda it: it.add_method("motorA.start", lambda speed: None, "turn"), notes="stop")
    bridge.open()
    bridge.begin_tick(0.0, 0.1)
    bridge.robot.motorA.start(50)
    for number in range(1, 50):
        tick(bridge, number / 10)
    assert bridge.calls == []


class Slipping(Bare, offered=False):
    """A robot whose `move` can fail after its wheels were set in motion; `error` is how."""

    error: BaseException | None = None

    def __init__(self) -> None:
        super().__init__(lambda it: it.add_method("move", it.move), notes="stop", hardware=True)
        self.open()
        self.arm()

    def move(self, linear: float = 0.0) -> None:
        """Drive."""
        if self.error is not None:
            raise self.error
        super().move(linear)

    @property
    def may_move(self) -> set[bool]:
        """What the guard is told, and the watchdog."""
        return {self.in_motion, bool(self.safety.motion)}


def test_a_command_that_fails_is_none_and_the_watchdog_runs_out_again_and_again() -> None:
    robot, stops = Slipping(), []
    robot.error = OSError("The wheels slip.")
    for number in range(15):
        robot.begin_tick(number / 10, 0.1)
        with pytest.raises(BridgeError, match="slip"):
            robot.robot.move(linear=0.2)
        robot.end_tick(number / 10)
        stops.append(len(robot.calls))
    assert stops == [0] * 5 + [1] * 6 + [2] * 4, "half a second after the first one, and so on"
    assert texts(robot)[-1] == "No `move` has succeeded for 0.5 s."


@pytest.mark.parametrize("error", [OSError("unplugged"), KeyboardInterrupt()], ids=["raises", "interrupted"])
def test_a_robot_stands_only_after_the_command_to_stand_has_returned(error: BaseException) -> None:
    robot = Slipping()
    robot.robot.move(linear=0.2)
    robot.error = error
    with pytest.raises((BridgeError, KeyboardInterrupt)):
        robot.robot.move(linear=0.0)
    assert robot.may_move == {True}
    robot.error = None
    robot.robot.move(linear=0.0)
    assert robot.may_move == {False}


@pytest.mark.parametrize("watchdog", ["command", "tick"])
def test_a_stop_that_fails_is_tried_again_until_it_succeeds(watchdog: str) -> None:
    bridge = Bare(lambda it: it.add_method("move", it.move, "drive"), notes="stop")
    bridge.failing["stop"] = OSError("unplugged")
    bridge.open()
    bridge.begin_tick(0.0, 0.1)
    bridge.robot.move(0.2)
    for number in range(1, 40):
        if number == 20:
            bridge.failing.clear()
        tick(bridge, number / 10) if watchdog == "command" else bridge.check_watchdog(number / 10)
        bridge.stop_again()
    assert bridge.calls.count("stop") >= 4
    assert not bridge.safety.motion
    watchdogs = [text for text in texts(bridge) if "stopped: OSError" not in text]
    assert (len(watchdogs) == 1) or watchdog == "command", "a silence is told once"


# -- the tick watchdog ----------------------------------------------------------------------------


def test_a_loop_that_hangs_stops_the_robot_once(cart: Any) -> None:
    cart.begin_tick(0.0, 0.1)
    cart.robot.move(linear=0.2)
    assert cart.check_watchdog(0.4) is None
    notice = cart.check_watchdog(0.6)
    assert notice.text == "No tick for 0.6 s: the robot was stopped."
    assert cart.check_watchdog(0.9) is None
    assert cart.sent == [(0.2, 0.0), (0.0, 0.0)]


def test_a_block_that_comes_back_after_the_stop_does_not_start_the_robot_again(cart: Any) -> None:
    cart.begin_tick(0.0, 0.1)
    cart.check_watchdog(1.0)
    cart.robot.move(linear=0.2)
    assert cart.sent == [(0.0, 0.0)]
    assert texts(cart)[-1] == "`move` was not sent: the robot was stopped in this tick."
    cart.begin_tick(1.1, 0.1)
    cart.robot.move(linear=0.2)
    assert cart.sent == [(0.0, 0.0), (0.2, 0.0)]
    assert cart.check_watchdog(1.2) is None


def test_without_ticks_nothing_is_watched(cart: Any) -> None:
    assert cart.check_watchdog(100.0) is None
    tick(cart, 0.0)
    cart.safety.rest()
    assert cart.check_watchdog(100.0) is None


def test_a_world_that_stands_still_without_ticks_is_not_watched() -> None:
    class World(Bare):
        name = "test-world"
        time_step = 0.01

    world = World()
    world.open()
    world.begin_tick(0.0, 0.1)
    assert world.check_watchdog(100.0) is None


@given(st.floats(0, 10))
def test_patience_is_half_a_second_or_three_periods(period: float) -> None:
    assert patience(period) >= 0.5
    assert patience(period) >= 3 * period
    assert patience(period) in (0.5, 3 * period)


# -- stop_all -------------------------------------------------------------------------------------


def test_driving_by_hand_continues_after_a_stop(cart: Any) -> None:
    cart.robot.move(linear=0.2)
    assert cart.stop_all() is True
    cart.robot.move(linear=0.3)
    assert cart.sent == [(0.2, 0.0), (0.0, 0.0), (0.3, 0.0)]


def test_the_stop_is_sent_while_disarmed(disarmed: Any) -> None:
    disarmed.stop_all()
    assert disarmed.sent == [(0.0, 0.0)]


def test_the_robot_is_stopped_before_anybody_is_told(cart: Any) -> None:
    cart.robot.move(linear=0.2)

    def recording(_what: object, _surely: bool) -> None:
        raise OSError("The disk is full.")

    cart.outside = recording
    with pytest.raises(OSError, match="disk"):
        cart.stop_all()
    assert cart.sent == [(0.2, 0.0), (0.0, 0.0)]


@pytest.mark.parametrize(
    ("timeout", "error"),
    [(None, OSError("unplugged")), (60.0, OSError("unplugged")), (60.0, KeyboardInterrupt("unplugged"))],
)
def test_a_stop_that_fails_does_not_raise_but_reports_it(timeout: float | None, error: BaseException) -> None:
    bridge = Bare(stop_timeout=timeout, notes="stop")
    bridge.failing["stop"] = error
    bridge.open()
    assert bridge.stop_all() is False
    assert texts(bridge) == [f"The robot may not have stopped: {type(error).__name__}: unplugged."]


def test_a_stop_that_hangs_does_not_hang_the_caller() -> None:
    go = threading.Event()
    bridge = Bare(stop=go.wait, stop_timeout=0.05)
    bridge.open()
    assert bridge.stop_all() is False
    assert texts(bridge) == ["The robot may not have stopped: no answer for 0.05 s."]
    go.set()


def test_a_robot_is_stopped_where_no_thread_can_be_started_any_more(
    cart: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_thread: threading.Thread) -> None:
        raise RuntimeError("can't create new thread at interpreter shutdown")

    cart.stop_timeout = 1.0
    cart.robot.move(linear=0.2)
    monkeypatch.setattr(threading.Thread, "start", refuse)
    assert cart.stop_all() is True
    assert cart.sent == [(0.2, 0.0), (0.0, 0.0)]


def test_a_velocity_without_defaults_stops_with_zeros() -> None:
    sent: list[tuple[float, ...]] = []

    def members(bridge: Any) -> None:
        bridge.add_method("move", turn, "speeds of the wheels")
        bridge.add_method("arm.move", lambda *angles, speed: sent.append((*angles, speed)), "lift")
        bridge.add_method("wink", lambda: sent.append((9.0,)), "no velocity")

    def turn(left: float, right: float, ramp: float = 0.5) -> None:
        sent.append((left, right, ramp))

    wheels = Bare(members)
    wheels.open()
    wheels.stop_all()
    assert sent == [(0.0, 0.0, 0.5), (0.0,)]


@pytest.mark.parametrize("error", [OSError("unplugged"), SystemExit("unplugged")])
def test_a_robot_that_cannot_be_stopped_leaves_no_other_one_moving(error: BaseException) -> None:
    sent: list[float] = []

    def unplugged(linear: float) -> None:
        raise error

    def members(bridge: Any) -> None:
        bridge.add_method("first.move", unplugged, "drive")
        bridge.add_method("second.move", sent.append, "drive")

    herd = Bare(members)
    herd.open()
    assert herd.stop_all() is False
    assert sent == [0.0]
    (told,) = texts(herd)
    assert told.startswith("The robot may not have stopped: ")
    assert f"{type(error).__name__}: unplugged" in told


def test_every_number_in_a_velocity_counts_as_movement() -> None:
    def stops_after(command: object) -> bool:
        arm = Bare(lambda it: it.add_method("move", lambda joints, note="": None, "joints"), notes="stop")
        arm.open()
        arm.begin_tick(0.0, 0.1)
        arm.robot.move(command)
        tick(arm, 1.0)
        return arm.calls == ["stop"]

    assert stops_after([0, 0.1])
    assert stops_after({"elbow": (0, 2)})
    assert not stops_after([0, 0.0])
    assert stops_after({"elbow": ()}), "what it does is unknown"
    assert stops_after("forward")


@pytest.mark.parametrize(
    ("function", "moves"),
    [
        (lambda: None, True),
        (lambda speed=0.3: None, True),
        (lambda linear=0.0, angular=0.0: None, False),
        (lambda linear=0.0, angular=None: None, False),
    ],
)
def test_a_velocity_is_judged_by_what_is_performed_also_where_no_number_is_written(
    function: Any, moves: bool
) -> None:
    robot = Bare(lambda it: it.add_method("forward", function, "drive", velocity=True), notes="stop")
    robot.open()
    robot.begin_tick(0.0, 0.1)
    robot.robot.forward()
    tick(robot, 1.0)
    assert robot.calls == ["stop"] * moves


@pytest.mark.parametrize("ticking", [True, False], ids=["in a tick", "by hand"])
def test_a_stop_while_a_command_is_under_way_is_the_last_word(ticking: bool) -> None:
    def move(linear: float) -> None:
        thread = threading.Thread(target=bridge.stop_all)
        thread.start()
        thread.join()
        bridge.calls.append("move")

    bridge = Bare(lambda it: it.add_method("move", move, "drive"), notes="stop")
    bridge.open()
    if ticking:
        bridge.begin_tick(0.0, 0.1)
    bridge.robot.move(0.2)
    assert bridge.calls == ["stop", "move", "stop"]


def test_a_stop_while_collected_commands_are_sent_is_the_last_word() -> None:
    def act(_: float) -> None:
        thread = threading.Thread(target=bridge.stop_all)
        thread.start()
        thread.join()
        bridge.calls.append("act")

    bridge = Bare(notes="stop")
    bridge.open()
    bridge.act = act  # type: ignore[method-assign]
    tick(bridge, 0.0)
    assert bridge.calls == ["stop", "act", "stop"]


@pytest.mark.parametrize("timeout", [None, 1.0])
@pytest.mark.parametrize("armed", [True, False])
def test_a_stop_may_use_the_robot_as_a_program_does(timeout: float | None, armed: bool) -> None:
    cart = Cart(stop_timeout=timeout)
    cart.open()
    cart.stop = lambda: cart.robot.move(linear=0.0)  # type: ignore[method-assign]
    cart.arm()
    cart.begin_tick(0.0, 0.1)
    cart.robot.move(linear=0.2)
    assert cart.stop_all() if armed else cart.disarm() is None
    assert cart.sent == [(0.2, 0.0), (0.0, 0.0)]


@pytest.mark.parametrize("timeout", [None, 1.0])
@pytest.mark.parametrize("called", ["stop_all", "disarm", "close", "robot.stop"])
def test_a_stop_that_calls_itself_is_told_and_has_an_end(timeout: float | None, called: str) -> None:
    def stop() -> None:
        threads.add(threading.get_ident())
        with suppress(BridgeError):
            attrgetter(called)(cart)()

    threads = set[int]()
    cart = Cart(stop_timeout=timeout)
    cart.open()
    cart.arm()
    cart.robot.move(linear=0.2)
    cart.stop = stop  # type: ignore[method-assign]
    assert cart.stop_all() is False
    assert len(threads) == 1
    assert f"The robot may not have stopped: {safety._CIRCULAR}" in texts(cart)


def test_a_command_during_a_stop_still_moves_the_robot_for_the_guard(cart: Any) -> None:
    def stop() -> None:  # the next tick begins meanwhile
        meanwhile(cart, 0.3)

    cart.begin_tick(0.0, 0.1)
    cart.robot.move(linear=0.2)
    cart.end_tick(0.0)
    cart.stop = stop
    assert cart.stop_all() is True
    assert cart.in_motion
    del cart.stop
    cart.stop_all()
    assert not cart.in_motion
    cart.disarm()

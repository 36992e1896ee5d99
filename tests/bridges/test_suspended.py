"""A program that was suspended does not drive on by itself; here by a clock that jumps."""

from __future__ import annotations

import errno
import sys
import threading
import time
from collections.abc import Callable
from types import SimpleNamespace

import pytest
from support.robots import Cart
from support.waiting import until

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.guarding import guard
from lrp_jupyter.bridges.guarding.guard import UNGUARDED, Stopper, now
from lrp_jupyter.live.session import Session


@pytest.fixture
def sleep(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Have some seconds pass in which nothing of this process runs."""

    def pass_(seconds: float = 3.2) -> None:
        later = guard.now() + seconds
        monkeypatch.setattr(guard, "now", lambda: later)

    return pass_


def texts(bridge: Bridge, kind: str = "guard") -> list[str]:
    return [notice.text for notice in bridge.safety.notices if notice.kind == kind]


def test_a_program_that_was_suspended_is_paused_before_it_sends_anything(cart, sleep):
    """Also where nobody stopped the robot meanwhile."""
    with Session("(machine m (state s (running [robot.move(linear=0.2)])))(spawn m s)", cart) as session:
        session.run(0.35)
        driven = len(cart.sent)
        assert cart.sent == [(0.2, 0.0)] * driven
        sleep()
        session.run(1)
        assert set(cart.sent[driven:]) == {(0.0, 0.0)}
        assert session.status == "paused"
        assert session.frame.reason.startswith("This program was suspended for 3.2 s: the robot was stopped.")
        assert texts(cart) == [session.frame.reason]
        session.run(0.15)  # a person goes on
        assert cart.sent[-1] == (0.2, 0.0)


@pytest.mark.parametrize(("seconds", "drives"), [(0.79, True), (0.81, False)])
def test_a_program_is_suspended_that_was_away_nearly_as_long_as_its_guard_waits(cart, sleep, seconds, drives):
    cart.robot.move(linear=0.2)
    cart._guard._end.set()
    cart._guard._thread.join()
    sleep(seconds)
    cart.robot.move(linear=0.3)
    assert (cart.sent[-1] == (0.3, 0.0)) == drives


def test_a_suspension_right_after_a_check_is_found_by_the_next_one(cart, sleep, monkeypatch):
    ours = cart._guard
    ours._end.set()
    ours._thread.join()
    cart.robot.move(linear=0.3)
    check = ours.check
    with monkeypatch.context() as patched:
        patched.setattr(ours, "check", lambda: (check(), sleep()))
        ours._turn(threading.Event())
    cart.robot.move(linear=0.4)
    assert cart.sent == [(0.3, 0.0), (0.0, 0.0)]
    (told,) = texts(cart)
    assert told.startswith("This program was suspended for 3.2 s")


def test_a_program_that_was_suspended_while_its_robot_stood_goes_on(cart, sleep):
    cart.robot.move(linear=0.2)
    cart.robot.move()
    until(lambda: not cart._guard._moved, "a beat says so")
    sleep()
    cart.robot.move(linear=0.3)
    cart._guard.check()  # as its thread does that wakes up later
    assert cart.sent[-1] == (0.3, 0.0)
    assert texts(cart) == []


class NotedLock:
    """A lock that knows how often it was asked for."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.asked: list[None] = []

    def __enter__(self) -> None:
        self.asked.append(None)
        self.lock.acquire()

    def __exit__(self, *_: object) -> None:
        self.lock.release()


def test_a_suspension_is_told_once_although_two_threads_notice_it(cart, sleep, monkeypatch):
    ours, stop, stops, stopped = cart._guard, cart.stop, threading.Event(), threading.Event()
    cart.robot.move(linear=0.2)
    ours._end.set()
    ours._thread.join()

    def slow_stop() -> None:
        stops.set()
        assert stopped.wait(60)
        stop()

    process = SimpleNamespace(stopped=threading.Event(), known=threading.Event(), fate="", reaches=True)
    process.unanswered, process.beat, process.problem, process.end = 0, lambda _moves: None, str, str
    monkeypatch.setattr(cart, "stop", slow_stop)
    monkeypatch.setattr(ours, "_process", process)
    monkeypatch.setattr(ours, "_lapsing", lock := NotedLock())
    sleep()
    by_command = threading.Thread(target=ours.check)
    by_command.start()
    assert stops.wait(60)
    process.stopped.set()  # it reports now that it stopped the robot
    by_beat = threading.Thread(target=ours._turn, args=(threading.Event(),))
    by_beat.start()
    until(lambda: len(lock.asked) == 2 or not by_beat.is_alive())  # it waits, or does it all once more
    stopped.set()
    by_command.join()
    by_beat.join()
    [told] = texts(cart)
    assert told.startswith("This program was suspended for 3.2 s, and the guard stopped the robot.")


def test_a_watchdog_that_stopped_the_robot_first_changes_nothing(cart, sleep):
    cart.robot.move(linear=0.2)
    sleep()
    cart.stop_all()
    cart.robot.move(linear=0.3)
    assert (0.3, 0.0) not in cart.sent
    held = texts(cart, "held")
    assert held[0].startswith("`move` was not sent: ")


def test_a_person_who_drives_by_hand_goes_on_by_arming(cart, sleep):
    cart.robot.move(linear=0.2)
    sleep()
    cart.robot.move(linear=0.3)
    cart.robot.move(linear=0.3)
    assert (0.3, 0.0) not in cart.sent
    cart.arm()
    cart.robot.move(linear=0.3)
    assert cart.sent[-1] == (0.3, 0.0)


def test_a_system_that_names_a_clock_which_it_does_not_have_has_another(monkeypatch):
    """A browser is one."""

    def refuse(_clock: int) -> float:
        raise OSError(errno.EINVAL, "Invalid argument")

    before = time.monotonic()
    monkeypatch.setattr(time, "clock_gettime", refuse)
    assert before <= now() <= time.monotonic()


def test_no_process_guards_a_robot_without_a_stopper_and_arming_says_so(cart):
    assert cart.failsafe == UNGUARDED
    assert texts(cart, "armed")[0].endswith(UNGUARDED)
    assert cart._guard._process is None


def test_no_process_guards_a_robot_in_a_browser(monkeypatch):
    monkeypatch.setattr(sys, "platform", "emscripten")
    cart = Cart(stopper=lambda: Stopper("nowhere:nothing"))
    cart.open()
    cart.arm()
    assert "A page of a browser has neither processes nor threads." in texts(cart, "armed")[0]
    assert cart._guard._process is None
    cart.robot.move(linear=0.3)
    assert cart.sent == [(0.3, 0.0)]


def test_a_simulated_robot_has_neither_a_guard_nor_a_sentence():
    with Session("", "sim", world="empty") as session:
        session.bridge.open()
        session.bridge.disarm()
        session.bridge.arm()
        assert session.bridge.failsafe == ""
        assert not session.bridge._guard.is_on

"""`robot.X.new` and `robot.X.age`: every message since the last tick, once; and how old the last one is."""

from __future__ import annotations

import json
import math
import threading
from pathlib import Path
from typing import Any

import pytest
from support.robots import Bare, Buggy, Cart

from lrp_jupyter import check
from lrp_jupyter.bridges.latched_values import MOST
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session

QUEUE = """(var queue := [()])
(machine m
  (state idle)
  (state hit)
  (on [9 in robot.light.new] idle -> hit pressed)
  (state end))
(machine keeper (state k (running [queue = queue + robot.light.new])))
(spawn m idle)
(spawn keeper k)"""


def queue_of(session: Session) -> Any:
    return session.variables["queue"]


@pytest.fixture
def session() -> Any:
    with Session(QUEUE, Buggy(), clock=VirtualClock()) as session:
        yield session


def test_every_value_since_the_last_tick_is_there_once_oldest_first(session: Session) -> None:
    feed = session.bridge.feed
    session.run(0.2)
    assert session.issues == ()  # nothing has arrived yet: there is nothing to say about that
    assert session.bridge.robot.light.age == math.inf
    for values in ((1, 2, 2), (), (3,), (4, 9, 5), ()):
        for value in values:
            feed("light.data", value)
        session.run(0.1)
    assert queue_of(session) == (1, 2, 2, 3, 4, 9, 5)
    assert session.frame.active == (("m", "hit"), ("keeper", "k"))


def test_what_arrived_in_a_pause_waits_for_the_next_tick(session: Session) -> None:
    session.run(0.1)
    session.bridge.feed("light.data", 9)
    session.bridge.feed("light.data", 0)  # a press that is shorter than a tick
    session.run(0.1)
    assert session.frame.active == (("m", "hit"), ("keeper", "k"))


def test_a_value_that_came_before_the_first_tick_counts(session: Session) -> None:
    session.bridge.open()
    session.bridge.feed("light.data", 1)
    session.run(0.3)
    assert queue_of(session) == (1,)


def test_more_than_a_tick_takes_are_dropped_and_counted(session: Session) -> None:
    session.run(0.1)
    for extra in (250, 1):
        for value in range(MOST + extra):
            session.bridge.feed("light.data", 10_000 * extra + value)
        session.run(0.1)
        notice = session.bridge.safety.notices[-1]
        how_many = {1: "1 message was"}.get(extra, f"{extra} messages were")
        assert notice.text == (
            f"`robot.light.new`: {how_many} dropped, since a tick takes at most the last 1,000."
        )
    assert (notice.kind, notice.count) == ("dropped", 2)
    kept = session.variables["queue"]
    assert (len(kept), kept[0], kept[-1]) == (2 * MOST, 2_500_250, 10_000 + MOST)


def test_an_edit_that_names_it_is_enough_and_nothing_is_kept_for_a_program_that_does_not(
    session: Session,
) -> None:
    bridge = session.bridge
    session.edit(QUEUE.replace("robot.light.new", "()"))
    session.run(0.1)
    bridge.feed("light.data", 1)
    assert not bridge.fed.of("light.data").is_heard
    session.edit(QUEUE)
    bridge.feed("light.data", 2)
    session.run(0.1)
    assert queue_of(session) == (1, 2)  # the one before the edit is not older than the last tick


def test_many_threads_feed_and_no_value_is_lost_or_doubled(session: Session) -> None:
    session.run(0.1)

    def feed(first: int) -> None:
        for value in range(first, 10_000, 8):
            session.bridge.feed("light.data", 100 + value)

    threads = [threading.Thread(target=feed, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        session.run(0.1)
    session.run(0.1)
    dropped = [each for each in session.bridge.safety.notices if each.kind == "dropped"]
    kept = session.variables["queue"]
    assert len(set(kept)) == len(kept)
    assert dropped or sorted(kept) == list(range(100, 10_100))


def test_ages_are_those_of_the_readings_and_infinite_before_the_first() -> None:
    buggy, cart = Buggy(), Cart()
    for robot in (buggy, cart):
        robot.open()
    buggy.feed("light.data", 1)
    buggy.time += 0.4
    assert buggy.robot.light.age == pytest.approx(0.4)
    buggy.time += 10
    buggy.begin_tick(0.0, 0.1)
    assert buggy.robot.light.age == pytest.approx(10.4)  # stale, and this is how to find that out
    buggy.end_tick(0.0)
    for now in (1.0, 2.0):
        cart.begin_tick(now, 0.1)
        assert (cart.robot.light.age, cart.robot.light.new) == (0.0, (7,))  # it is asked, so it is new
        cart.end_tick(now)


def test_a_member_of_the_bridge_is_preferred_and_what_is_removed_goes_with_its_reading() -> None:
    class Old(Bare, offered=False):
        def add_members(self) -> None:
            self.add_variable("light.age", lambda: "an age of its own")
            self.feed("light.data")
            self.add_method("light.new", lambda: "a method")
            self.feed("bumper.data")
            self.add_variable("bumper.new.count", lambda: 5)

    old = Old()
    old.open()
    assert (old.robot.light.age, old.robot.light.new(), old.robot.bumper.new.count) == (
        "an age of its own",
        "a method",
        5,
    )
    old.remove_member("bumper.data")
    assert dir(old.robot.bumper) == ["new"]
    buggy = Buggy()
    buggy.open()
    assert [member.name for member in buggy.members()] == ["light.data", "battery", "move", "beep", "stop"]
    assert dir(buggy.robot.light) == ["age", "data", "new"]
    assert (buggy.describe("light.new").type, buggy.describe("light.age").unit) == ("tuple", "s")
    with pytest.raises(
        AttributeError, match=r"^`robot\.light` has no `nw`; it has `data`\. Did you mean `new`\?$"
    ):
        _ = buggy.robot.light.nw
    buggy.remove_member("light.data")
    assert "light" not in dir(buggy.robot)


def test_a_run_with_messages_is_repeated_from_its_file_and_in_forks(session: Session, tmp_path: Path) -> None:
    path = tmp_path / "run.lrplog"
    with session.record(path):
        for value in (1, 2.5, math.inf, {"x": [1]}, 9, 7):
            session.bridge.feed("light.data", value)
            session.bridge.feed("light.data", value)
            session.run(0.1)
    asked = [json.loads(line).get("readings") for line in path.read_text().splitlines()]
    assert [each["light.new"]["tuple"] for each in asked if each][1] == [2.5, 2.5]
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert queue_of(again.session) == queue_of(session)
    with session.fork(4) as fork:
        assert len(fork.variables["queue"]) == 8
        assert len(session.variables["queue"]) == 12
    assert session.why_not("pressed", at=5).facts["values"] == {"robot.light.new": "(9, 9)"}


def test_a_function_of_the_notebook_has_them_from_its_second_call_on() -> None:
    program = "(var all := [()]) (machine m (state s (running [all = all + take(robot)])))(spawn m s)"
    names = {"take": lambda robot: robot.light.new}
    with Session(program, Buggy(), clock=VirtualClock(), namespace=names) as session:
        for value in range(4):
            session.bridge.open()
            session.bridge.feed("light.data", value)
            session.run(0.1)
        assert session.variables["all"] == (1, 2, 3)


def test_a_bridge_may_have_words_of_its_own_for_hearing(session: Session) -> None:
    class Ear(Buggy, offered=False):
        heard, hear, taken = None, None, None

    ear = Ear()
    with Session(QUEUE, ear, clock=VirtualClock()) as listening:
        listening.bridge.open()
        listening.bridge.feed("light.data", 4)
        listening.run(0.1)
        assert (queue_of(listening), ear.heard, ear.hear, ear.taken) == ((4,), None, None, None)


# -- the simulated robot --------------------------------------------------------------------------

TAPPING = """(var seen := [()])
(machine m
  (state to (running [robot.move(linear=0.3)]))
  (state back (running [robot.move(linear=-0.3)]))
  (on [True in robot.bumper.new] to -> back bumped)
  (ontime 400 back -> to))
(machine keeper (state k (running [seen = seen + robot.bumper.new])))
(spawn m to)
(spawn keeper k)"""


def tapping() -> Session:
    return Session(TAPPING, "sim", world="walls", clock=VirtualClock())


def test_the_bumper_tells_each_press_and_release_once_also_after_a_rewind_and_in_a_fork() -> None:
    with tapping() as session:
        session.bridge.place_robot((0.3, 0.3, math.pi))
        session.run(8)
        seen = session.variables["seen"]
        assert len(seen) > 4
        assert seen == tuple(number % 2 == 0 for number in range(len(seen)))
        middle = session.frame.tick // 2
        with session.fork(middle) as fork:
            fork.run((session.frame.tick - middle) / 10)
            assert fork.variables["seen"] == seen
        session.rewind(session.frame.tick - middle)
        session.run(8 - middle / 10)
        assert session.variables["seen"] == seen


def test_a_run_with_presses_is_repeated_from_its_file_which_has_only_the_readings(tmp_path: Path) -> None:
    path = tmp_path / "run.lrplog"
    with tapping() as session, session.record(path):
        session.bridge.place_robot((0.3, 0.3, math.pi))
        session.run(4)
        seen = session.variables["seen"]
        reasons = [session.why_not("bumped", at=tick) for tick in range(1, session.frame.tick + 1)]
    recorded = [json.loads(line).get("readings", {}) for line in path.read_text().splitlines()]
    assert not [name for each in recorded for name in each if name.endswith((".new", ".age"))]
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert again.session.variables["seen"] == seen
    told = [reason.facts.get("values") for reason in reasons if reason.code == "fired"]
    assert told == [{"robot.bumper.new": "(True,)"}] * seen.count(True)


def test_a_press_that_is_shorter_than_a_tick_is_seen() -> None:
    bridge = SimBridge("walls")
    bridge.open()
    simulation = bridge.simulation
    simulation.place((0.2, 0.3, math.pi))
    bridge.begin_tick(0.0, 0.1)
    bridge.end_tick(0.0)
    for linear in (0.3, -0.3):
        simulation.drive(linear)
        while (simulation.robot.memory.pressed_at == simulation.steps) is not (linear > 0):
            bridge.advance(0.01)
    bridge.begin_tick(1.0, 0.1)
    assert (bridge.robot.bumper.data, bridge.robot.bumper.new) == (True, (True, False))
    bridge.end_tick(1.0)
    bridge.advance(0.1)
    bridge.begin_tick(2.0, 0.1)
    assert (bridge.robot.bumper.data, bridge.robot.bumper.new) == (False, ())
    assert bridge.robot.light.new == (bridge.robot.light.data,)
    bridge.close()


# -- what the checks and the page know ------------------------------------------------------------


def test_the_checks_know_them_and_name_the_reading_where_something_is_wrong() -> None:
    program = "; world: walls\n(machine m (state a (running [{}])))(spawn m a)"

    def messages(block: str) -> list[str]:
        return [finding.message for finding in check(program.format(block)) if finding.code[:4] == "LRP5"]

    assert messages("print(robot.bumper.new, robot.light.age)") == []
    assert messages("print(robot.light.value)") == ["`robot.light` has no `value`. Write `robot.light.data`."]
    assert messages("print(robot.light.age > 'x')") == [
        "`robot.light.age` is a number, not a text. Compare it with a number."
    ]

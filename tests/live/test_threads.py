import asyncio
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest
from support.robots import Bare
from support.waiting import until

from lrp_jupyter.errors import LRPError, SessionTimeoutError
from lrp_jupyter.interpreter.faults import Interrupted
from lrp_jupyter.live import clock
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.running import driver, monitor
from lrp_jupyter.live.running.commands import Call, Pause, Step

DRIVE = "(machine m (state a (running [robot.move(linear=0.2)]))) (spawn m a)"
COUNT = "(var n := [0]) (machine m (state a (running [n = n + 1]))) (spawn m a)"
BLINK = "(machine m (state a) (state b) (ontime 20 a -> b) (ontime 20 b -> a)) (spawn m a)"
GATED = "(machine m (state a (running [entered.set()] [gate.wait(60)] [after.set()]))) (spawn m a)"
ENDLESS = """
(machine m
  (state a (running [entered.set()] [while True: pass]))
  (state b)
  (on done a -> b)
  (event done [len(stop) > 0]))
(spawn m a)
"""
LONG = 120.0  # seconds; reached only when something is wrong, however busy the machine is


class Gates(dict):
    """A namespace of events, made as blocks ask for them."""

    def __init__(self):
        super().__init__(entered=threading.Event(), gate=threading.Event(), after=threading.Event())
        self.stop = self["stop"] = []


@pytest.fixture
def gates():
    made = Gates()
    yield made
    made["gate"].set()


@pytest.fixture
def held(session, gates, monkeypatch):
    """Start a program, wait until a block holds it up, then shorten how long calls wait."""

    def start(text):
        made = session(text, namespace=gates)
        made.start()
        assert gates["entered"].wait(LONG)
        for module in (driver, monitor):
            monkeypatch.setattr(module, "PATIENCE", 0.05)
        return made

    return start


@pytest.fixture
def pushcart():
    """A robot that notes what is done to it."""
    return Bare(notes="stop on_pause")


def test_a_started_program_runs_by_itself(session):
    blinking = session(BLINK, rate=100)
    blinking.start()
    frame = blinking.wait_for("b", LONG)
    assert frame.count_of("a") - frame.count_of("b") == frame.is_active("a"), "they alternate"
    assert blinking.wait_for("m/a", LONG).status == "running"


def test_waiting_for_a_state_that_is_not_entered_ends_with_a_sentence(session):
    blinking = session(BLINK, rate=100)
    blinking.start()
    with pytest.raises(SessionTimeoutError, match=r"`c` was not entered within 0.01 s"):
        blinking.wait_for("c", 0.01)


def test_waiting_while_nothing_runs_is_refused(session):
    with pytest.raises(LRPError, match="start"):
        session(BLINK).wait_for("b")


def test_a_visit_too_short_to_see_is_waited_for(session):
    passing = session(
        "(machine m (state a) (state b) (ontime 50 a -> b) (eps b -> a)) (spawn m a)", rate=0
    )  # again and again: it may have begun before anybody waits
    passing.start()
    assert passing.wait_for("b", LONG).count_of("b") >= 1


@pytest.mark.parametrize("speed", [1, 10])
def test_time_passes_for_a_program_as_on_the_wall_or_faster(session, monkeypatch, speed):
    wall = [7.0]
    monkeypatch.setattr(clock, "monotonic", lambda: wall[0])
    counting = session(COUNT, "sim", speed=speed, rate=100)
    counting.start()
    for _ in range(3):
        counting.wait_for(lambda frame: frame.time > speed * (wall[0] - 7.0) - 0.02, LONG)
        assert counting.frame.time <= speed * (wall[0] - 7.0)
        wall[0] += 0.2


@pytest.mark.parametrize(("bridge", "rate"), [("none", 0), ("none", 10), ("sim", 10)])
def test_on_a_virtual_clock_a_thread_runs_without_waiting(session, bridge, rate):
    blinking = session(BLINK, bridge, VirtualClock(), rate)
    blinking.start()
    frame = blinking.wait_for(lambda frame: frame.time > 2 * LONG, LONG)  # waiting, it would never come
    assert frame.count_of("b") > 100


def test_paused_time_does_not_pass_and_a_step_is_one_tick(session):
    counting = session(COUNT, rate=100)
    counting.start()
    counting.wait_for(lambda frame: frame.tick >= 3, LONG)
    counting.pause()
    before = counting.frame
    counting.step()
    counting.step()
    after = counting.frame
    assert (after.tick - before.tick, after.status) == (2, "paused")
    assert after.time - before.time == pytest.approx(0.02)


def test_a_call_from_another_thread_is_applied_when_it_returns(session):
    counting = session(COUNT, rate=0)
    counting.start()
    for value in range(1000, 50_000, 7000):
        counting.set_variable("n", str(value))
        assert counting.frame.numbers[("n",)] >= value
    counting.pause()
    assert counting.frame.status == "paused"


def test_a_call_that_a_block_holds_up_ends_with_the_blocks_name_and_is_done_later(held, gates):
    holding = held(GATED)
    with pytest.raises(SessionTimeoutError, match=r"The command `pause` waits: `a.running` has not returned"):
        holding.pause()
    gates["gate"].set()
    assert holding.wait_for(lambda frame: frame.status == "paused", LONG)


def test_an_edit_that_a_block_holds_up_raises_nothing_and_is_done_later(held, gates):
    holding = held(GATED)
    findings = holding.edit(GATED + "\n(machine other (state x)) (spawn other x)")
    assert "LRP690" in [finding.code for finding in findings]
    gates["gate"].set()
    assert holding.wait_for("other/x", LONG)


def test_submitting_does_not_wait(session, gates):
    holding = session(GATED, namespace=gates)
    holding.start()
    assert gates["entered"].wait(LONG)
    answer = holding.submit(Pause("later"))
    assert not answer.done()
    gates["gate"].set()
    answer.result(LONG)
    assert (holding.frame.status, holding.frame.reason) == ("paused", "later")


def test_commands_are_applied_between_ticks_only(session, gates):
    holding = session(GATED, namespace=gates)
    holding.start()
    assert gates["entered"].wait(LONG)
    answers = [holding.submit(command) for command in (Pause(), Step(), Step())]
    assert not any(answer.done() for answer in answers)
    gates["gate"].set()
    answers[-1].result(LONG)
    assert holding.frame.status == "paused"


def test_a_block_that_does_not_return_is_shown_and_stops_the_robot(session, gates, pushcart):
    holding = session(GATED, pushcart, namespace=gates, hung_after=0.02)
    holding.start()
    frame = holding.wait_for(lambda frame: frame.status == "hung", LONG)
    assert "`a.running` has run for" in frame.reason
    assert frame.hung.where == "a.running"
    assert frame.hung.seconds >= 0.0
    until(lambda: "stop" in pushcart.calls)
    gates["gate"].set()
    assert holding.wait_for(lambda frame: frame.status == "running", LONG).hung is None


def test_an_interrupted_block_becomes_an_issue_and_the_program_continues(session, gates):
    endless = session(ENDLESS, namespace=gates, rate=100)
    endless.start()
    assert gates["entered"].wait(LONG)
    gates.stop.append(True)
    while not endless.interrupt():
        pass
    frame = endless.wait_for("b", LONG)
    (issue,) = frame.issues
    assert "interrupted" in issue.message
    assert issue.element.path == ("m", "a")


def test_there_is_nothing_to_interrupt_in_a_program_that_runs_well(session):
    assert not session(COUNT).interrupt()


def test_a_block_that_raises_a_keyboard_interrupt_pauses_the_thread_and_does_not_end_it(session, gates):
    def give_up():
        raise KeyboardInterrupt

    stopping = session(COUNT.replace("n + 1", "n + 1; give_up()"), namespace={"give_up": give_up})
    stopping.start()
    frame = stopping.wait_for(lambda frame: frame.status == "paused", LONG)
    assert frame.reason == "The program raised `KeyboardInterrupt`, as Ctrl-C does."
    stopping.edit(COUNT)
    stopping.resume()
    assert stopping.wait_for(lambda frame: frame.numbers.get(("n",), 0) > 2, LONG)


def test_a_block_that_raises_a_keyboard_interrupt_pauses_a_run_on_another_thread(session):
    def give_up():
        raise KeyboardInterrupt

    stopping = session(COUNT.replace("n + 1", "n + 1; give_up()"), namespace={"give_up": give_up})
    with ThreadPoolExecutor(1) as pool:
        assert not pool.submit(stopping.run, 1).result(LONG)
    assert (stopping.status, stopping.frame.tick) == ("paused", 1)
    assert stopping.frame.reason == "The program raised `KeyboardInterrupt`, as Ctrl-C does."


def test_a_keyboard_interrupt_raised_by_a_command_on_the_thread_does_not_reach_the_caller(session, gates):
    def wait():
        gates["entered"].set()
        assert gates["gate"].wait(LONG)

    def give_up():
        raise KeyboardInterrupt

    running = session(COUNT)
    running.start()
    first = running.submit(Call(wait))
    assert gates["entered"].wait(LONG)
    answers = [first, *(running.submit(Call(each)) for each in (lambda: 1, give_up, lambda: 2))]
    gates["gate"].set()
    assert [answer.result(LONG) for answer in (answers[1], answers[3])] == [1, 2]
    with pytest.raises(LRPError):
        answers[2].result(LONG)
    assert running.fault == ""


def test_an_interruption_that_comes_too_late_does_no_harm(session, monkeypatch):
    counting = session(COUNT, "sim", rate=100)
    ended = counting.bridge.end_tick
    late = [Interrupted()]

    def end_tick(now):
        ended(now)
        if late:
            raise late.pop()

    monkeypatch.setattr(counting.bridge, "end_tick", end_tick)
    counting.start()
    frame = counting.wait_for(lambda frame: frame.tick > 5, LONG)
    assert (frame.status, frame.issues, late) == ("running", (), [])


def test_stopping_a_program_that_never_returns_ends_its_thread(held):
    endless = held(ENDLESS)
    endless.stop()
    assert endless.status == "stopped"


def test_stopping_the_robot_does_not_wait_for_the_block(session, gates, pushcart):
    holding = session(GATED, pushcart, namespace=gates)
    holding.start()
    assert gates["entered"].wait(LONG)
    holding.stop_robot()
    assert pushcart.calls == ["stop"]
    gates["gate"].set()
    assert holding.wait_for(lambda frame: frame.status == "paused", LONG).reason == "The robot was stopped."
    until(lambda: "on_pause" in pushcart.calls)


def test_a_stop_that_fails_in_a_pause_is_tried_again_until_it_succeeds(session, pushcart):
    counting = session(COUNT, pushcart)
    counting.start()
    pushcart.failing["stop"] = OSError("unplugged")
    counting.pause()
    until(lambda: pushcart.calls.count("stop") > 2, "it is not tried again")
    pushcart.failing.clear()
    until(lambda: not pushcart.unstopped)


def test_no_tick_begins_while_the_end_of_a_run_stops_the_robot(session):
    def stop():  # it takes as long as the program might go on
        until(lambda: not driving._driver.running, "the program goes on")
        cart.calls.append("stop")

    cart = Bare(lambda it: it.add_method("move", it.move), stop=stop)
    driving = session(DRIVE, cart, rate=100)
    driving.start()
    until(lambda: 0.2 in cart.calls)
    driving.stop()
    assert cart.calls[-1] == "stop"
    assert cart.safety.notices == ()


def test_a_robot_that_is_not_watched_pauses(session, pushcart):
    counting = session(COUNT, pushcart, dead_man=0.05)
    counting.start()
    frame = counting.wait_for(lambda frame: frame.status == "paused", LONG)
    assert "not been watched" in frame.reason
    assert "stop" in pushcart.calls


def test_a_robot_that_is_not_watched_stops_although_a_block_has_not_returned(session, pushcart, gates):
    text = "(machine m (state a (onentry [gate.wait()]))) (spawn m a)"
    session(text, pushcart, rate=0.01, namespace=gates, dead_man=0.05, hung_after=LONG).start()
    until(lambda: "stop" in pushcart.calls)


def test_a_program_that_was_stopped_starts_from_the_beginning(session):
    counting = session(COUNT, rate=100)
    counting.start()
    counting.wait_for(lambda frame: frame.tick > 9, LONG)
    counting.stop()
    tick = counting.frame.tick
    counting.start()
    frame = counting.wait_for(lambda frame: frame.tick > tick and frame.active, LONG)
    assert frame.numbers[("n",)] <= frame.tick - tick


def test_starting_twice_makes_one_thread(session):
    counting = session(COUNT)
    counting.start()
    before = set(threading.enumerate())
    counting.start()
    assert before.issuperset(threading.enumerate())


def test_a_run_suspends_the_thread_and_hands_back_to_it(session, gates):
    gates["seen"] = seen = []
    gates["me"] = threading.get_ident
    counting = session(
        "(machine m (state a (running [seen.append(me())]))) (spawn m a)", namespace=gates, rate=100
    )
    counting.start()
    counting.wait_for(lambda frame: frame.tick >= 3, LONG)
    ticks = counting.frame.tick
    assert counting.run(5)
    here = [ident == threading.get_ident() for ident in seen]
    first = here.index(True)
    assert here[first : first + 500] == [True] * 500
    assert first >= ticks - 1
    tick = counting.frame.tick
    assert counting.wait_for(lambda frame: frame.tick > tick + 2, LONG).status == "running"


def test_calls_from_other_threads_are_executed_within_a_run(session):
    done = threading.Event()
    counting = session(COUNT)

    def other():
        counting.set_variable("n", "-1000000000")
        done.set()

    def started(_frame):
        if not thread.is_alive() and not done.is_set():
            thread.start()
        return done.is_set()

    thread = threading.Thread(target=other)
    assert counting.run(until=started)
    thread.join(LONG)
    assert counting.frame.numbers[("n",)] < 0


def test_what_a_block_asks_of_its_own_session_is_done_after_the_tick(session, gates):
    asking = session(
        "(machine m (state a (running [session.transition_to('b')] [after.set()])) (state b)) (spawn m a)",
        namespace=gates,
    )
    gates["session"] = asking
    asking.start()
    assert asking.wait_for("b", LONG)
    assert gates["after"].is_set()


def test_a_fault_of_our_own_in_the_thread_stops_the_robot_and_is_reported(session, pushcart, monkeypatch):
    counting = session(COUNT, pushcart, rate=100)
    counting.start()
    counting.wait_for("a", LONG)
    monkeypatch.setattr(type(counting.interpreter), "step", lambda *_: {}["our own mistake"])
    frame = counting.wait_for(lambda frame: frame.status == "broken", LONG)
    assert frame.issues == ()
    assert "our own mistake" in counting.fault
    assert "stop" in pushcart.calls


def test_a_program_that_runs_free_lets_others_run(session, monkeypatch):
    pauses = []
    monkeypatch.setattr(driver, "time", SimpleNamespace(sleep=lambda s: pauses.append(s) or time.sleep(s)))
    counting = session(COUNT, rate=0)
    counting.start()
    counting.wait_for(lambda frame: frame.tick > 5000, LONG)
    assert pauses  # without them others would wait 5 ms for the interpreter lock
    assert max(pauses) < 0.001


def test_frames_are_few_however_many_ticks_there_are(session):
    counting = session(COUNT, rate=0)
    frames = []
    counting.listen(lambda: frames.append(counting.frame))
    counting.start()
    frame = counting.wait_for(lambda frame: frame.tick > 5000, LONG)
    assert len(frames) <= 60 * frame.time + 5


def test_a_place_without_threads_runs_a_program_by_asyncio(session):
    async def scenario():
        blinking = session(BLINK, rate=100, driver="asyncio")
        before = set(threading.enumerate())
        blinking.start()
        while blinking.frame.count_of("b") < 2:
            await asyncio.sleep(0.005)
        blinking.pause()
        tick = blinking.frame.tick
        blinking.step()
        assert (blinking.frame.tick, blinking.status) == (tick + 1, "paused")
        blinking.resume()
        while blinking.frame.tick < tick + 3:
            await asyncio.sleep(0.005)
        assert before.issuperset(threading.enumerate())
        blinking.close()

    asyncio.run(scenario())


def test_a_session_starts_again_after_its_event_loop_has_ended(session):
    blinking = session(BLINK, rate=100, driver="asyncio")

    async def run(ticks):
        blinking.start()
        end = blinking.frame.tick + ticks
        while blinking.frame.tick < end:
            await asyncio.sleep(0.005)

    asyncio.run(run(2))
    blinking.pause()
    assert blinking.status == "paused", "commands are applied although no task runs any more"
    asyncio.run(asyncio.wait_for(run(2), LONG))


def test_a_session_closes_from_inside_one_of_its_blocks(session, gates):
    closing = session(
        "(machine m (state a (onentry [session.close()]))) (spawn m a)", namespace=gates, rate=100
    )
    gates["session"] = closing
    closing.start()
    with pytest.raises(LRPError, match="closed"):
        closing.wait_for("nothing", LONG)


def test_a_pause_at_an_issue_is_visible_in_the_frame(session):
    failing = session("(machine m (state a (running [1 / 0]))) (spawn m a)", on_issue="pause", rate=1000)
    failing.start()
    frame = failing.wait_for(lambda frame: frame.status == "paused", LONG)
    assert "ZeroDivisionError" in frame.reason

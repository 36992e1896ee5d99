"""The edges of the loop: what it tells its bridge, what it refuses, how it stands still and goes on."""

import pytest
from support.robots import Bare

from lrp_jupyter.errors import BridgeError, LRPError, SessionClosedError
from lrp_jupyter.interpreter.faults import Interrupted
from lrp_jupyter.live import clock as clocks
from lrp_jupyter.live.clock import LAG

COUNT = "(var n := [0]) (machine m (state a (running [n = n + 1]))) (spawn m a)"
DRIVE = "(machine m (state a (running [robot.move(linear=0.2)]))) (spawn m a)"


@pytest.fixture
def diary():
    """A robot that notes the calls of a session."""
    return Bare(notes="on_start on_pause on_resume stop rewind")


@pytest.fixture
def wall(monkeypatch):
    """A wall clock that the test moves by hand."""
    now = [100.0]
    monkeypatch.setattr(clocks, "monotonic", lambda: now[0])
    return now


def turn(session, wall, seconds, times=1):
    """Let time pass on the wall, and the loop do what is due, so many times."""
    for _ in range(times):
        wall[0] += seconds
        session._loop.turn()


# -- the bridge


def test_the_bridge_hook_of_the_start_is_called_once_and_then_those_of_pauses(session, diary):
    running = session(COUNT, diary)
    running.resume()
    running.pause()
    running.resume()
    assert diary.calls == ["on_start", "stop", "on_pause", "on_resume"]


@pytest.mark.parametrize("act", ["onresume", "by hand"])
@pytest.mark.parametrize("robot", ["sim", Bare(lambda robot: robot.add_method("move", robot.move))])
def test_what_is_commanded_after_a_stop_and_before_the_next_tick_moves_the_robot(session, robot, act):
    once = DRIVE.replace("running", "onentry")
    running = session(f"(onresume [robot.move(linear=0.3)]) {once}" if act == "onresume" else once, robot)
    running.run(0.3)
    running.resume()
    running.pause()
    if act == "by hand":
        running.bridge.robot.move(linear=0.3)
    running.run(0.2)
    assert running.bridge.safety.notices == ()
    if running.bridge.simulated is None:
        assert running.bridge.calls[-1] == 0.3
    else:
        assert running.bridge.simulation.robot.command == (0.3, 0.0)


def test_a_first_step_is_a_start_for_the_bridge(session, diary):
    stepped = session(COUNT, diary)
    stepped.step()
    stepped.step()
    stepped.resume()
    assert diary.calls == ["on_start", "on_resume"]


def test_a_pause_at_an_issue_is_one_for_the_bridge(session, diary):
    faulty = session(COUNT.replace("n + 1", "n / 0"), diary, on_issue="pause")
    faulty.run(1)
    assert diary.calls == ["on_start", "stop", "on_pause"]


@pytest.mark.parametrize("hook", ["on_start", "on_pause"])
def test_a_bridge_whose_hook_fails_is_lost_and_its_robot_stopped(session, diary, hook):
    def fail():
        diary.calls.append(hook)
        raise OSError("the cable is gone")

    fail.__name__ = hook
    setattr(diary, hook, fail)
    running = session(COUNT, diary)
    running.open()
    running.resume()
    running.pause()
    assert diary.calls[diary.calls.index(hook) + 1] == "stop"
    assert diary.status.state == "lost"
    assert "the cable is gone" in running.frame.bridge


def test_an_edit_that_restarts_the_program_stops_the_robot_and_another_does_not(session, diary):
    running = session(COUNT, diary)
    running.run(1)
    running.edit(COUNT.replace("n := [0]", "n := [5]"))
    assert "stop" not in diary.calls
    running.edit(COUNT.replace("n + 1", "n + 2"))
    assert diary.calls[-1] == "stop"


def test_an_armed_robot_is_not_taken_back_whatever_its_bridge_says(session, diary):
    diary.hardware = True
    running = session(COUNT, diary)
    running.run(1)
    diary.arm()
    with pytest.raises(BridgeError, match="armed"):
        running.rewind(3)
    assert "rewind" not in diary.calls


# -- what a stop has ended


def motorist(robot):
    """Add a velocity, a motor that turns on, and what moves nothing."""
    robot.add_method("move", robot.move)
    robot.add_method("motor.start", lambda speed: robot.calls.append(speed), mover="motor")
    robot.add_method("motor.stop", lambda: robot.calls.append("motor.stop"), mover="motor")
    robot.add_method("lamp", lambda: robot.calls.append("lamp"))


def paused(running):
    running.resume()
    running.pause()


ONCE = "(machine m (state driving (onentry [robot.{}])) (state resting)) (spawn m driving)"
MOVE, MOTOR = ONCE.format("move(linear=0.1)"), ONCE.format("motor.start(50)")
INSIDE = """(machine m
  (state driving (onentry [robot.motor.start(50)] (spawn inner one))
    (machine inner (state one) (state two) (ontime 300 one -> two))))
(spawn m driving)"""


@pytest.mark.parametrize("robot", [None, Bare(motorist)], ids=["simulated", "without a world"])
def test_who_set_a_robot_in_motion_only_once_is_told_after_a_pause(session, robot):
    running = session(MOVE, "sim" if robot is None else robot)
    running.run(0.3)
    told = running.bridge.safety
    paused(running)
    assert told.notices == (), "it is not known yet whether the program commands it again"
    running.run(0.1)
    (notice,) = told.notices
    assert (notice.kind, notice.first.block, notice.first.line) == ("stopped", "driving.onentry", 1)
    assert notice.text == (
        "`move` ended when the robot was stopped, for instance by a pause, and `onentry` of `driving` does "
        "not run again. Put `move` into `running`, or into `onresume` to repeat it after a pause."
    )
    paused(running)  # what stood already is no news
    running.run(1)
    assert told.notices == (notice,)


@pytest.mark.parametrize(
    ("text", "stop"),
    [
        (MOTOR, paused),
        (INSIDE, paused),
        (MOTOR, lambda running: running.stop_robot()),
        (MOTOR, lambda running: running.bridge.stop_all()),
        (MOTOR, lambda running: (running.bridge.disarm(), running.run(0.5), running.bridge.arm())),
        (MOTOR, lambda running: (paused(running), running.bridge.stop_all(), running.step())),
        (f"(onresume [robot.lamp()]) {MOTOR}", paused),
    ],
    ids=["pause", "inside it goes on", "stop robot", "by hand", "disarmed", "step", "onresume of others"],
)
def test_a_motor_that_stands_since_a_stop_is_told_however_long_it_turned(session, text, stop):
    running = session(text, Bare(motorist))
    running.run(2)
    stop(running)
    running.run(1)
    kinds = [each.kind for each in running.bridge.safety.notices]
    assert [kind for kind in kinds if "armed" not in kind] == ["stopped"]


@pytest.mark.parametrize(
    ("text", "stop"),
    [
        (DRIVE, paused),
        (f"{MOVE} (onresume [robot.move(linear=0.1)])", paused),
        (f"{MOVE} (onresume [robot.stop()])", paused),
        (f"{MOTOR} (onresume [robot.motor.start(20)])", paused),
        (f"{MOTOR} (onpause [robot.motor.stop()])", paused),
        (ONCE.format("move(linear=0.0)"), paused),
        (ONCE.format("motor.start(0)"), paused),
        (ONCE.format("lamp()"), paused),
        (MOVE.replace("(state resting)", "(state resting) (ontime 400 driving -> resting)"), paused),
        (MOVE.replace("(state resting)", "(ontime 400 driving -> driving)"), paused),
        (MOTOR, lambda running: running.reset()),
        (MOTOR, lambda running: (paused(running), running.reset())),
        (MOTOR, lambda running: (paused(running), running.transition_to("resting"))),
        (MOTOR, lambda running: None),
    ],
)
def test_of_what_goes_on_or_was_to_end_nothing_is_told(session, text, stop):
    running = session(text, Bare(motorist))
    running.run(0.4)
    stop(running)
    running.run(0.3)
    assert [each.text for each in running.bridge.safety.notices] == []


def test_of_a_pause_that_is_gone_back_behind_nothing_is_told(session):
    running = session(MOVE, "sim", world="empty")
    running.run(0.3)
    paused(running)
    running.rewind(1)
    running.run(0.2)
    assert running.bridge.simulation.robot.command == (0.1, 0.0)
    assert running.bridge.safety.notices == ()


# -- time


@pytest.mark.parametrize("bridge", ["none", "sim"])
def test_a_fast_run_may_be_late_by_as_much_of_the_wall_as_any_other(session, wall, bridge):
    fast = session(COUNT, bridge, speed=10)
    fast.resume()
    turn(fast, wall, 0.01, times=5)
    turn(fast, wall, 0.9 * LAG)
    turn(fast, wall, 0, times=50)
    assert fast._loop.timing.now == pytest.approx(10 * (0.05 + 0.9 * LAG), abs=0.1), "no time is lost"


@pytest.mark.parametrize("bridge", ["none", "sim"])
def test_a_program_that_goes_back_while_it_runs_goes_on_from_there(session, wall, bridge):
    running = session(COUNT, bridge)
    running.resume()
    turn(running, wall, 0.1, times=20)
    running.rewind(7)
    frame = running.frame
    assert frame.status == "running"
    turn(running, wall, 0)
    assert running.interpreter.tick == frame.tick + 1, "the first tick undone is done again, at once"
    turn(running, wall, 0.1)
    assert running._loop.timing.now == pytest.approx(frame.time + 0.1)
    assert running.interpreter.tick == frame.tick + 2


def test_going_back_further_than_the_journal_reaches_changes_nothing(session, monkeypatch):
    monkeypatch.setattr("lrp_jupyter.interpreter.journal.EDITS", 300)
    edited = session(DRIVE, "sim", world="empty")
    edited.run(1)
    for _ in range(310):  # each saves the whole state, and only so many are kept
        edited.reset()
        edited.step()
    before = (edited.frame.tick, edited.frame.time, edited.frame.robot.robots[0].pose)
    with pytest.raises(ValueError, match=r"Cannot go back 315 ticks: only 3\d\d can be undone\."):
        edited.rewind(315)
    assert (edited.frame.tick, edited.frame.time, edited.frame.robot.robots[0].pose) == before


def test_after_a_pause_no_time_has_passed_and_the_next_tick_is_not_late(session, wall):
    paused = session(COUNT)
    paused.resume()
    turn(paused, wall, 0.05, times=5)
    paused.pause()
    now, tick = paused._loop.timing.now, paused.interpreter.tick
    turn(paused, wall, 5, times=5)
    assert (paused._loop.timing.now, paused.interpreter.tick) == (now, tick)
    paused.resume()
    turn(paused, wall, 0)
    assert paused._loop.timing.now == now


def test_a_run_in_virtual_time_leaves_the_clock_where_it_ended(session, wall):
    running = session(COUNT)
    running.resume()
    running.run(10)
    assert running.status == "running"
    turn(running, wall, 0)
    assert running.frame.time == pytest.approx(10, abs=0.1)
    assert running.interpreter.tick == 101


# -- status


def test_a_pause_names_the_newest_issue_of_its_tick(session):
    faulty = session(
        "(machine old (state a (running [1 / 0])))"
        "(machine new (state a) (state b (onentry [len(5)])) (ontime 300 a -> b))"
        "(spawn old a) (spawn new a)",
        on_issue="pause",
    )
    reasons = []
    for _ in range(6):
        faulty.run(1)
        reasons.append("len()" if "len()" in faulty.frame.reason else faulty.frame.reason)
    division = "ZeroDivisionError: division by zero"
    assert reasons == [division, division, division, "len()", division, division]


def test_of_issues_that_are_new_in_one_tick_the_last_one_is_the_newest(session):
    faulty = session("(machine m (state a (running [1 / 0] [len(5)])))(spawn m a)", on_issue="pause")
    faulty.run(1)
    assert "len()" in faulty.frame.reason
    assert faulty.frame.paused_by is faulty.issues[1]
    assert "len()" in str(faulty.interpreter.issues.newest)


def test_a_session_that_is_stopped_stays_so_until_it_starts_from_the_beginning(session):
    counting = session(COUNT)
    counting.run(1)
    counting.stop()
    counting.step()
    counting.resume()
    assert counting.status == "stopped"
    counting.run(0.2)
    assert counting.frame.numbers["n",] == 2


def test_a_session_that_is_started_again_without_running_yet_is_ready(session):
    counting = session(COUNT)
    counting.run(1)
    counting.stop()
    counting.start(paused=True)
    assert (counting.status, counting.frame.active) == ("ready", ())


def test_a_reason_given_later_replaces_that_of_a_pause_and_none_does_not(session):
    paused = session(COUNT)
    paused.resume()
    paused.pause("the first")
    paused.pause()
    assert paused.frame.reason == "the first"
    paused.pause("the second")
    assert paused.frame.reason == "the second"


def test_what_is_closed_cannot_be_stopped_or_started(session):
    closed = session(COUNT)
    closed.close()
    closed.stop()
    assert closed.status == "closed"
    with pytest.raises(SessionClosedError):
        closed.resume()
    assert closed.status == "closed"


def test_a_fault_of_our_own_stops_the_robot_and_is_in_the_frame_at_once(session, diary, monkeypatch):
    broken = session(COUNT, diary)
    broken.run(0.3)
    frames = []
    monkeypatch.setattr(type(broken.interpreter), "step", lambda *_: {}["our own mistake"])
    broken.resume()
    broken.listen(lambda: frames.append(broken.frame.status))
    broken._loop.turn()
    assert diary.calls[-1] == "stop"
    assert frames == ["broken"]
    with pytest.raises(LRPError, match="The session itself failed"):
        broken.pause()


def test_a_session_that_is_stopped_while_it_breaks_stays_stopped(session, monkeypatch):
    stopped = session(COUNT)
    stopped.resume()

    def stop_and_fail(*_):
        stopped._loop.halt("stopped")
        raise RuntimeError("our own mistake")

    monkeypatch.setattr(type(stopped.interpreter), "step", stop_and_fail)
    stopped._loop.turn()
    assert stopped.status == "stopped"
    assert "our own mistake" in stopped.fault


def test_a_keyboard_interrupt_on_the_main_thread_pauses_and_reaches_whoever_turns_the_loop(session):
    def press():
        raise KeyboardInterrupt

    running = session("(machine m (state a (onentry [press()]))) (spawn m a)", namespace={"press": press})
    running.resume()
    with pytest.raises(KeyboardInterrupt):
        running._loop.turn()
    assert running.status == "paused"
    assert "keyboard" in running.frame.reason
    assert running.frame.tick == 1, "the tick is whole"


def test_an_interruption_that_comes_too_late_ends_a_run_and_does_no_harm(session, monkeypatch):
    def interrupted(*_):
        raise Interrupted

    running = session(COUNT)
    with monkeypatch.context() as late:
        late.setattr(type(running.interpreter), "step", interrupted)
        assert not running.run(1)
    assert (running.status, running.fault) == ("paused", "")
    assert running.run(1)


def test_the_rate_reached_is_that_of_a_running_program(session, monkeypatch):
    now = [0.0]
    for module in ("loop", "timing"):
        monkeypatch.setattr(f"lrp_jupyter.live.running.{module}.perf_counter", lambda: now[0])
    running = session(COUNT, clock=clocks.VirtualClock())
    running.resume()

    def go_on(turns):
        for _ in range(turns):
            running._loop.turn()
            running._loop.timing.clock.rebase(running._loop.timing.clock.now() + 0.1)
            now[0] += 0.1

    go_on(30)
    assert running.frame.achieved_rate == pytest.approx(10, rel=0.2)
    assert running.frame.achieved_speed == pytest.approx(1, rel=0.2)
    running.pause()
    assert (running.frame.achieved_rate, running.frame.achieved_speed) == (0, 0)
    now[0] += 10
    running.resume()
    go_on(3)
    assert running.frame.achieved_rate == pytest.approx(10, rel=0.2), "the pause does not count"


@pytest.mark.parametrize("act", ["resume", "step"])
def test_a_program_that_is_paused_before_its_start_starts_once(session, act):
    calls = []
    waiting = session(COUNT)
    waiting.bridge.on_start = lambda: calls.append("start")
    waiting.bridge.on_resume = lambda: calls.append("resume")
    waiting.open()
    waiting.pause("Not yet.")
    assert (waiting.status, waiting.frame.reason, waiting.frame.tick) == ("paused", "Not yet.", 0)
    getattr(waiting, act)()
    waiting.pause()
    waiting.resume()
    assert calls == ["start", "resume"]

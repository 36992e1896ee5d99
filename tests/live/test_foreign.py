"""Whatever foreign code does, the loop lives on, and says what happened."""

import threading

import pytest
from support.robots import Bare
from support.waiting import until

from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.faults import Interrupted
from lrp_jupyter.interpreter.run import Run
from lrp_jupyter.live.running.commands import Call, Pause, Resume
from lrp_jupyter.live.running.driver import LoopThread

LONG = 120
REPORT = "A subscriber of a session raised an exception and is not called again:"
COUNT = "(var n := [0]) (machine m (state a (running [n = n + 1]))) (spawn m a)"


@pytest.fixture
def reported(capsys):
    """Return the headlines on stderr, and the types of the exceptions below them."""

    def read():
        return [line for line in capsys.readouterr().err.splitlines() if line[:1].isupper()]

    return read


KINDS = [RuntimeError, SystemExit, MemoryError, RecursionError]
EVERY = pytest.mark.parametrize("raises", [*KINDS, KeyboardInterrupt], indirect=True)


@pytest.fixture(params=KINDS, ids=lambda kind: kind.__name__)
def raises(request):
    def fail(*_):
        raise request.param

    fail.kind = request.param
    return fail


def ticks_on(running):
    tick = running.frame.tick
    return running.wait_for(lambda frame: frame.tick > tick + 3, LONG)


@EVERY
@pytest.mark.parametrize("subscribe", ["listen", "observe"])
def test_a_subscriber_that_raises_is_reported_once_and_the_loop_lives_on(
    counting, reported, raises, subscribe
):
    getattr(counting, subscribe)(raises)
    assert ticks_on(counting).status == "running"
    counting.stop()  # a frame can be seen before its subscribers are called
    assert reported() == [REPORT, "Traceback (most recent call last):", raises.kind.__name__]


@pytest.mark.parametrize("hook", ["sense", "act", "on_start"])
def test_a_hook_that_raises_loses_the_robot_and_the_loop_lives_on(session, raises, hook):
    raises.__name__ = hook
    counting = session(COUNT, Bare(**{hook: raises}), rate=100)
    counting.start()
    assert ticks_on(counting).status == "running"
    faults = [notice.text for notice in counting.bridge.safety.notices if notice.kind == "fault"]
    assert any(f"`{hook}` raised {raises.kind.__name__}" in fault for fault in faults)
    if hook == "on_start":  # it is called once; the next reading of the sensors finds the robot again
        assert counting.bridge.status.state == "connected"
    else:
        assert counting.bridge.status.state == "lost"
        assert faults[0] in counting.frame.bridge


@pytest.fixture
def counting(session):
    """A program that counts."""
    made = session(COUNT, rate=100)
    made.start()
    ticks_on(made)
    return made


@pytest.fixture
def impatient(session):
    """A program that counts, and hangs soon."""
    made = session(COUNT, rate=100, hung_after=0.1)
    made.start()
    ticks_on(made)
    return made


def endless(*_):
    while True:
        pass


def hangs(running, words):
    running.wait_for(lambda frame: frame.status == "hung" and frame.reason.startswith(words), LONG)


@pytest.mark.parametrize("hook", ["sense", "act", "moment", "advance", "on_resume"])
def test_a_hook_that_does_not_return_is_interrupted_for_an_edit(session, hook):
    robot = Bare(time_step=0.01 if hook in ("moment", "advance") else None)
    counting = session(COUNT, robot, rate=100, hung_after=0.1)
    counting.start()
    ticks_on(counting)
    counting.pause()
    setattr(robot, hook, endless)
    counting.submit(Resume())
    hangs(counting, "The robot has not answered for")
    setattr(robot, hook, lambda *_: None)
    counting.edit(COUNT.replace("n + 1", "n + 2"))
    assert "n + 2" in ticks_on(counting).program.text
    was_lost = any(notice.kind == "fault" for notice in counting.bridge.safety.notices)
    assert was_lost == (robot.time_step is None)
    assert counting.bridge.status.state == "connected", "it is found again as soon as the hook returns"


def test_an_observer_that_does_not_return_is_named_and_interrupted_for_an_edit(impatient, reported):
    impatient.observe(endless)
    hangs(impatient, "An observer has not returned for")
    impatient.edit(COUNT.replace("n + 1", "n + 2"))
    assert "n + 2" in ticks_on(impatient).program.text
    assert reported()[0] == REPORT


def test_a_function_called_between_two_ticks_that_does_not_return_is_interrupted_for_an_edit(impatient):
    answer = impatient.submit(Call(endless))
    hangs(impatient, "A command has not returned for")
    impatient.edit(COUNT.replace("n + 1", "n + 2"))
    assert "n + 2" in ticks_on(impatient).program.text
    with pytest.raises(LRPError, match="did not return"):
        answer.result(LONG)


def test_an_observer_is_removed_on_the_thread_of_the_loop_and_between_two_ticks(counting, monkeypatch):
    threads = []
    loop = counting._loop
    end = counting.observe(lambda event: None)
    rebind = Run.rebind

    def noted(run):
        threads.append((threading.get_ident(), loop.ticking is not None))
        rebind(run)

    monkeypatch.setattr(Run, "rebind", noted)
    end()
    assert threads == [(counting._driver._thread, False)]
    counting.close()
    end()


def test_an_observer_that_raises_before_observe_has_returned_is_removed(session, reported, monkeypatch):
    counting = session(COUNT, rate=100)
    counting.start()
    do = counting._driver.do

    def late(command):
        result = do(command)
        ticks_on(counting)
        return result

    def fail(event):
        raise RuntimeError

    monkeypatch.setattr(counting._driver, "do", late)
    counting.observe(fail)
    assert ticks_on(counting).status == "running"
    assert reported() == [REPORT, "Traceback (most recent call last):", "RuntimeError"]


def test_a_listener_that_returns_on_no_thread_is_interrupted_for_an_edit(impatient, reported):
    gate = threading.Event()

    def wait():
        while not gate.wait(0.01):
            pass

    end = impatient.listen(wait)
    hangs(impatient, "A listener has not returned for")
    impatient.edit(COUNT.replace("n + 1", "n + 2"))
    assert "n + 2" in ticks_on(impatient).program.text
    assert reported()[0] == REPORT
    end()
    gate.set()


def test_a_listener_may_edit_the_program(counting):
    end = counting.listen(lambda: counting.edit(COUNT.replace("n + 1", "n + 2")))
    assert "n + 2" in counting.wait_for(lambda frame: "n + 2" in frame.program.text, LONG).program.text
    assert ticks_on(counting).status == "running"
    end()


def test_an_expression_that_exits_is_refused_and_the_loop_lives_on(counting):
    with pytest.raises(LRPError, match="SystemExit"):
        counting.set_variable("n", "exit()")
    assert ticks_on(counting).status == "running"


@EVERY
def test_what_escapes_everywhere_else_breaks_the_session_visibly(counting, monkeypatch, raises):
    monkeypatch.setattr(type(counting._loop), "turn", raises)
    counting.submit(Pause())
    assert counting.wait_for(lambda frame: frame.status == "broken", LONG)
    assert raises.kind.__name__ in counting.frame.reason
    assert raises.kind.__name__ in counting.fault
    monkeypatch.undo()
    motor = counting._driver._motor
    assert isinstance(motor, LoopThread)
    assert motor.ident is not None, "its thread lives"


def test_a_fault_that_cannot_even_be_published_breaks_the_session_visibly(counting, monkeypatch):
    motor = counting._driver._motor

    def fail(*_, **__):
        raise RuntimeError

    with monkeypatch.context() as fault:
        fault.setattr(type(counting._loop), "publish", fail)
        fault.setattr(counting.bridge, "stop_all", fail)
        until(lambda: counting.status == "broken")
        assert "RuntimeError" in counting.frame.reason
    assert motor.ident is not None, "its thread lives"
    counting.start()
    assert ticks_on(counting).status == "running"


def test_an_interruption_that_comes_too_late_does_no_harm(session, monkeypatch):
    counting = session(COUNT, rate=100)
    counting.start()
    turn, late = type(counting._loop).turn, [Interrupted()]

    def interrupted(loop):
        if late:
            raise late.pop()
        return turn(loop)

    monkeypatch.setattr(type(counting._loop), "turn", interrupted)
    assert ticks_on(counting).status == "running"
    assert not late
    assert counting.fault == ""


def broken_by(counting, monkeypatch):
    """Break a session by a fault of its own, which is then gone."""
    with monkeypatch.context() as fault:
        fault.setattr(type(counting.interpreter), "step", lambda *_: {}["our own mistake"])
        counting.wait_for(lambda frame: frame.status == "broken", LONG)


def test_a_broken_session_starts_again_with_the_last_text(session, monkeypatch):
    events = []
    counting = session(COUNT, rate=100)
    counting.observe(lambda event: events.append(event.kind))
    counting.start()
    ticks_on(counting)
    broken_by(counting, monkeypatch)
    counting.edit(COUNT.replace("state a", "state b").replace("m a", "m b"))
    assert counting.status == "broken", "an edit does not start it by itself"
    counting.start()
    frame = counting.wait_for("b", LONG)
    assert (frame.status, frame.reason, counting.fault, frame.issues) == ("running", "", "", ())
    assert counting.program.text == counting.text
    events.clear()
    ticks_on(counting)
    assert "changed" in events, "observers stay"
    counting.rewind(2)
    counting.edit(COUNT)
    assert counting.wait_for("a", LONG)


def test_a_broken_session_that_is_reset_is_ready_to_start(counting, monkeypatch):
    broken_by(counting, monkeypatch)
    counting.edit("(machine")
    counting.reset()
    assert (counting.status, counting.frame.active, counting.text) == ("ready", (), "(machine")
    counting.resume()
    assert counting.wait_for("a", LONG)
    broken_by(counting, monkeypatch)
    counting.stop()
    assert counting.status == "stopped"
    counting.start()
    assert ticks_on(counting).status == "running"

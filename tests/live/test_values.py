"""Values in frames: whatever their `repr` does, the loop lives, is watched, and keeps its rate."""

import queue
import threading
from contextlib import nullcontext

import pytest

from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.running import values
from lrp_jupyter.live.running.values import ValueTexts
from lrp_jupyter.live.session import Session

LONG = 120
SHOWN = "(var v := [make()]) (var n := [0]) (machine m (state a (running [n = n + 1]))) (spawn m a)"


def ticks_on(running):
    tick = running.frame.tick
    return running.wait_for(lambda frame: frame.tick > tick + 3, LONG)


def test_a_repr_that_does_not_return_is_reported_stops_the_robot_and_can_be_interrupted(session):
    stops, calls = [], []

    class Endless:
        def __repr__(self):
            calls.append(self)
            while True:
                pass

    running = session(SHOWN, rate=100, hung_after=0.2, namespace={"make": Endless})
    running.bridge.stop = lambda: stops.append(running.frame.tick)
    running.start()
    frame = running.wait_for(lambda frame: frame.status == "hung", LONG)
    assert "`v.__repr__`" in frame.reason
    assert stops
    assert running.interrupt()
    running.wait_for(lambda frame: "did not return" in frame.variables.get(("v",), ""), LONG)
    ticks_on(running)
    assert len(calls) == 1, "it is not called again"


@pytest.mark.parametrize("end", ["close", "stop"])
def test_no_repr_runs_when_the_session_ends(session, end):
    calls = []

    class Counted:
        def __repr__(self):
            calls.append(threading.current_thread())
            return "Counted()"

    running = session(SHOWN, rate=100, namespace={"make": Counted})
    running.start()
    ticks_on(running)
    running.pause()
    before = len(calls)
    getattr(running, end)()
    assert len(calls) == before
    assert running.frame.variables["v",] == "Counted()"
    assert set(calls) == {calls[0]}, "only the loop's thread calls it"


@pytest.mark.slow
def test_a_command_that_does_not_return_is_reported(session):
    gate = threading.Event()
    running = session(SHOWN, rate=100, hung_after=0.2, namespace={"make": int, "wait": gate.wait})
    running.start()
    ticks_on(running)
    with pytest.raises(TimeoutError):
        running.set_variable("n", "wait()")
    assert running.wait_for(lambda frame: frame.status == "hung", LONG)
    gate.set()
    assert running.wait_for(lambda frame: frame.status == "running", LONG)


def test_a_listener_that_does_not_return_is_reported(session):
    gate = threading.Event()
    running = session(SHOWN, rate=100, hung_after=0.2, namespace={"make": int})
    running.start()
    ticks_on(running)
    thread = running._driver._thread
    running.listen(lambda: threading.get_ident() == thread and gate.wait())
    frame = running.wait_for(lambda frame: frame.status == "hung", LONG)
    assert frame.reason.startswith("A listener has not returned")
    gate.set()
    assert running.wait_for(lambda frame: frame.status == "running", LONG)


@pytest.mark.parametrize("text", ["after", ""])
def test_rendering_takes_a_small_share_of_the_time(monkeypatch, text):
    now = [0.0]
    monkeypatch.setattr(values, "perf_counter", lambda: now[0])

    class Costly:
        count = 0

        def __init__(self, cost):
            self.cost = cost

        def __repr__(self):
            Costly.count += 1
            now[0] += self.cost
            return text

    texts = ValueTexts(lambda name: nullcontext())
    scene = [(("first",), Costly(0.16)), (("second",), Costly(0.0)), (("third",), Costly(0.01)), (("n",), 3)]
    rendering = 0.0
    while now[0] < 60:
        before = now[0]
        shown = texts.of(scene, now=False)
        rendering += now[0] - before
        now[0] += 1 / 60
    assert rendering < 60 / 8
    assert shown["n",] == "3"
    assert Costly.count > 60, "and still they are rendered"
    count = Costly.count
    texts.of(scene, now=True)
    assert Costly.count == count + 3, "at a pause nothing is left out"
    texts.of(scene, now=True, foreign=False)
    assert Costly.count == count + 3


def test_a_caller_who_runs_the_program_sees_its_present_values_however_long_their_texts_take(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(values, "perf_counter", lambda: now[0])

    class Slow(list):
        def __repr__(self):
            now[0] += 0.01
            return f"Slow({len(self)})"

    program = "(var v := [make()]) (machine m (state a (running [v.append(0)]))) (spawn m a)"
    with Session(program, "none", clock=VirtualClock(), namespace={"make": Slow}) as running:
        running.resume()  # a pause would render all
        for _ in range(5):
            running.run(0.1)
            assert running.status == "running"
            assert running.frame.variables["v",] == f"Slow({len(running.frame.values['v',])})"
        assert running.run(1, until=lambda frame: frame.variables["v",] == "Slow(8)")


def test_a_repr_of_c_that_was_interrupted_is_not_called_again(session):
    texts = queue.SimpleQueue()
    running = session(
        SHOWN, rate=100, hung_after=0.2, namespace={"make": type("Slow", (), {"__repr__": texts.get})}
    )
    running.start()
    assert running.wait_for(lambda frame: frame.hung, LONG).hung.where == "v.__repr__"
    assert running.interrupt()
    texts.put("the text")
    running.wait_for(lambda frame: frame.status == "running", LONG)
    running.pause()  # which renders all values
    assert running.frame.variables["v",] == "<Slow: not shown, because `__repr__` did not return>"


def test_a_value_that_looks_like_a_number_and_is_none_does_no_harm(session):
    def never(*_):
        raise SystemExit

    strange = type("Strange", (float,), {"__float__": never, "__repr__": never, "__class__": property(never)})
    running = session(SHOWN, rate=100, namespace={"make": strange})
    running.start()
    frame = ticks_on(running)
    assert frame.status == "running"
    assert frame.numbers["v",] == 0.0
    assert frame.variables["v",] == "<Strange: no text, SystemExit>"

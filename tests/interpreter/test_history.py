"""The past that is read from the journal is what was seen when it was present."""

from types import SimpleNamespace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.story import started
from support.wild import command, moment, obey, program

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.facts import Commanded, Discarded, Entered, Faulted, Fired, Spawned
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse

slow = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
NESTED = """(var n := [0])
(machine m
  (state a (onentry (spawn k s)) (running [n += 1])
    (machine k (var own := [n]) (state s) (state t (running [1 / 0])) (ontime 200 s -> t)))
  (state b)
  (ontime 400 a -> b back) (eps b -> a))
(spawn m a)"""


def seen(state):
    return (
        state.active,
        {path: value for path, value in state.variables.items() if not callable(value)},
        state.program.text,
    )


@slow
@given(program, st.lists(command, max_size=40), st.booleans())
def test_every_moment_of_the_past_is_as_it_was(text, orders, keep):
    robot = SimpleNamespace(light=0)
    i = Interpreter(parse(text), robot, on_active_edit="keep" if keep else "restart")
    before, after = {}, {0: ((), {}, text)}
    for order in orders:
        present = (*moment(i), i.program.text)
        try:
            obey(i, robot, order)
        except (UnknownElementError, SyntaxError, NameError, ValueError):
            continue
        if order[0] == "step":
            before[i.tick], after[i.tick] = present, (*moment(i), i.program.text)
        if order[0] in ("step", "rewind") and i.tick:
            assert i.history.time(i.tick) == i.now
    for tick in i.history.ticks:
        assert seen(i.history.state(tick)) == after[tick], f"after tick {tick}"
        assert seen(i.history.state(tick, before=True)) == before[tick], f"before tick {tick}"


def test_what_a_command_has_written_is_there_when_the_next_tick_begins_though_a_function_writes_it_too():
    function = "def f():\n  nonlocal n\n  n += 1\nf()"
    text = f"(var n := [0]) (machine m (state a) (state b (onentry [n += 1]) (running [{function}])))"
    i = Interpreter(parse(f"{text} (spawn m a)"))
    i.transition_to("m/b", 0.0)
    i.step(0.0)
    assert i.history.state(1, before=True).variables["n",] == 1


@pytest.mark.slow
@slow
@given(program, st.lists(command, max_size=40))
def test_the_facts_of_a_tick_are_the_events_of_it(text, orders):
    robots = SimpleNamespace(light=0), SimpleNamespace(light=0)
    quiet, watched = Interpreter(parse(text), robots[0]), Interpreter(parse(text), robots[1])
    events = []
    watched.observe(events.append)
    for order in orders:
        for i, robot in zip((quiet, watched), robots, strict=True):
            events.clear()
            try:
                obey(i, robot, order)
            except (UnknownElementError, SyntaxError, NameError, ValueError):
                break
        else:
            if order[0] == "step":
                assert quiet.history.time(quiet.tick) == quiet.now
                compare(quiet.history.facts(quiet.tick), events)


def compare(facts, events):
    def paths(kind):
        return [event.path for event in events if event.kind == kind]

    def of(*kinds):
        return [fact for fact in facts if isinstance(fact, kinds)]

    assert [(*fact.machine, fact.transition.path[-1]) for fact in of(Fired)] == paths("fired")
    assert [fact.path for fact in of(Fired, Entered)] == paths("entered")
    assert [fact.machine for fact in of(Spawned)] == paths("spawned")
    assert [fact.machine for fact in of(Discarded)] == paths("discarded")


def test_the_facts_of_a_tick_name_what_fired_and_who_spawned():
    i = started(NESTED, 7)
    assert i.history.facts(1) == [
        Spawned(("m",), (), ("m",)),
        Entered(("m", "a"), ("m", "a")),
        Spawned(("m", "a", "k"), ("m", "a"), ("m", "a", "k")),
        Entered(("m", "a", "k", "s"), ("m", "a", "k", "s")),
    ]
    when, fired = i.history.told(2)[0]
    assert (fired.label, fired.source, fired.state[-1]) == ("200:s->t", "s", "t")
    assert (when, i.history.time(when)) == (3, 0.2)
    fault, *others = i.history.facts(4)
    assert isinstance(fault, Faulted)
    assert fault.message == "ZeroDivisionError: division by zero"
    assert others == []


def test_a_fault_that_is_known_already_is_a_fact_of_every_tick():
    i = started(NESTED.replace("400", "4000"), 8)
    assert sum(isinstance(fact, Faulted) for _, fact in i.history.told()) == 6


def test_a_command_belongs_to_the_time_before_a_tick():
    i = started(NESTED, 3)
    i.set_variable("n", "40")
    i.step(0.3)
    assert i.history.facts(3.5) == [Commanded("assigned", "n")]
    assert i.history.state(3).variables["n",] == 3
    assert i.history.state(4, before=True).variables["n",] == 40
    assert i.history.state(4).variables["n",] == 41


def test_what_comes_after_the_last_tick_is_known_before_the_next():
    i = started(NESTED, 3)
    i.transition_to("m/b")
    assert [type(fact) for fact in i.history.facts(3.5)] == [Discarded, Entered, Commanded]


def test_going_back_takes_what_was_undone_out_of_the_past():
    i = started(NESTED, 6)
    assert isinstance(i.history.facts(5)[0], Fired)
    i.rewind(3)
    assert i.history.ticks == range(1, 4)
    i.teleport_to("m/b")
    i.step(0.3)
    assert i.history.facts(4)[0].label == "eps:b->a"


def test_only_what_the_journal_holds_is_known():
    i = started(NESTED, 30, journal=10)
    assert (i.history.ticks.start, i.history.ticks.stop) == (21, 31)
    i.history.state(20)
    with pytest.raises(ValueError, match="Ask about ticks 21 to 30"):
        i.history.state(19)


def test_the_past_follows_a_new_run():
    i = started(NESTED, 5)
    i.renew(parse(NESTED), 1.0)
    assert list(i.history.ticks) == []
    i.step(1.0)
    assert len(i.history.facts(1)) == 4


def test_what_is_dropped_and_what_is_undone_is_forgotten():
    i = started(NESTED, 30, journal=10)
    assert sorted({when for when, _ in i.history.told()}) == [21, 23, 24, 25, 26, 28, 29, 30]
    for tick in range(30, 37):
        i.step(tick / 10)
    assert i.history.told()[0].when > 27
    assert i.history.time(28) == pytest.approx(2.7)
    with pytest.raises(KeyError):
        i.history.time(27)
    i.rewind(3)
    i.step(9.0)
    assert (i.history.time(35), i.history.time(34)) == (9.0, pytest.approx(3.3))
    assert i.history.written(35) != i.history.written(34)

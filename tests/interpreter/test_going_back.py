"""Going back, in combination with everything that acts between ticks."""

import pytest
from support.story import active, started
from support.tables import every

from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.journal import SavedState
from lrp_jupyter.language.parser import parse

TIMED = """(var n := [0])
(machine m
  (state a (running [n += 1]) (onentry (spawn k s))
    (machine k (var own := [n]) (state s) (state t) (ontime 300 s -> t)))
  (state b)
  (ontime 500 a -> b) (ontime 200 b -> a))
(spawn m a)"""


def moment(i):
    return active(i), dict(i.variables), i.now, i.tick, i.program.text


def records_since_the_last_tick(i):
    journal = i._run.journal
    return journal.log[journal.ends()[0] + 1 :]


def test_the_time_after_going_back_is_that_of_the_last_tick_left():
    i = started(TIMED, 3)
    i.pause(now=5.0)
    i.rewind(0)
    assert i.now == 0.2
    i.set_variable("n", "7", now=6.0)
    i.step(7.0)
    i.reset(now=8.0)
    i.rewind(1)
    assert (i.now, i.variables["n"]) == (0.2, 3)
    i.step(0.25)
    i.rewind(4)
    assert (i.now, i.tick, i.active) == (0.0, 0, ())


def test_a_timer_continues_from_where_it_was():
    i = started(TIMED, 4)
    assert active(i) == ["m/a/k/t"]
    i.rewind(1)
    assert (active(i), i.entered("m/a/k/s")) == (["m/a/k/s"], 0.0)
    i.step(0.2999)
    assert active(i) == ["m/a/k/s"]
    i.step(0.3)
    assert active(i) == ["m/a/k/t"]


@every(
    "command",
    [
        lambda i: i.teleport_to("m/b", now=0.25),
        lambda i: i.transition_to("m/a", now=0.25),
        lambda i: i.transition_to("m/a/k/t", now=0.25),
        lambda i: i.teleport_to("other/x", now=0.25),
        lambda i: i.reset(now=0.25),
        lambda i: i.set_variable("m/a/k/own", "'set'", now=0.25),
        lambda i: i.set_variable("n", "(n := n + 1) + 1"),
        lambda i: i.rename("machine", "m", "mm"),
        lambda i: i.rename("variable", "m/a/k/own", "mine"),
        lambda i: i.patch(parse(i.program.text.replace("n += 1", "n += 10"))),
        lambda i: i.patch(parse(i.program.text.replace("own := [n]", "own := [n + 100]"))),
        lambda i: i.patch(parse(i.program.text + "(spawn other x)")),
        lambda i: i.patch(parse(i.program.text.replace("(var n := [0])", "(var k := [0])"))),
    ],
)
def test_any_command_is_undone_whatever_ran_after_it(command):
    i = started(TIMED + "(machine other (state x) (state y) (eps x -> y))", 3)
    before = moment(i)
    command(i)
    i.rewind(0)
    assert moment(i) == before
    for others in (0, 1, 4):
        command(i)
        for _ in range(others):
            i.teleport_to(i.active[0] if i.active else "other/y")
        for tick in range(3, 9):
            i.step(tick / 10)
        i.rewind(6)
        assert moment(i) == before
    i.step(0.3)
    assert active(i) == ["m/a/k/t"]


def test_what_was_forced_before_the_first_tick_is_undone_with_it():
    i = started(TIMED, 0)
    i.teleport_to("m/a/k/t")
    i.step(0.0)
    i.rewind(0)
    assert active(i) == ["m/a/k/t"]
    i.rewind(1)
    assert (active(i), dict(i.variables)) == ([], {})
    i.step(0.0)
    assert active(i) == ["m/a/k/s"]


def test_top_level_spawns_that_wait_for_the_next_tick_wait_again():
    i = started("(machine m (state a))(machine k (state s))(spawn m a)(spawn k s)", 0)
    i.transition_to("m/a")
    i.step(0.0)
    i.step(0.1)
    i.rewind(1)
    assert active(i) == ["m/a", "k/s"]
    i.rewind(1)
    i.step(0.0)
    assert active(i) == ["m/a", "k/s"]


def test_variables_of_a_discarded_machine_are_restored_though_a_closure_changed_them_later():
    i = started(
        """(var hook := [None])
        (machine m
          (state a (onentry (spawn k s)) (onexit [hook()])
            (machine k (var n := [1])
              (state s (onentry [
                def hook():
                  nonlocal n
                  n += 1]))))
          (state b (running [hook()]))
          (ontime 100 a -> b))
        (spawn m a)"""
    )
    assert i.variables["m/a/k/n"] == 1
    for tick in (1, 2, 3):
        i.step(tick / 10)
    i.rewind(3)
    assert (active(i), i.variables["m/a/k/n"]) == (["m/a/k/s"], 1)


def test_a_variable_that_had_no_value_has_none_again():
    i = started(
        """(var n := [1])(var k := [1])
        (machine m (state a) (state b (running [del n] [del k])) (eps a -> b))(spawn m a)"""
    )
    i.step(0.1)
    i.teleport_to("m/b")
    i.rewind(0)
    assert dict(i.variables) == {}
    i.rewind(1)
    assert dict(i.variables) == {("n",): 1, ("k",): 1}


def test_many_commands_without_a_tick_are_remembered_as_one():
    i = started(TIMED, 2)
    i.set_variable("n", "50")
    for value in range(100):
        i.patch(parse(TIMED.replace("300", str(300 + value))))
        i.teleport_to("m/b" if value % 2 else "m/a")
    records = records_since_the_last_tick(i)
    assert len(records) < 2_000
    assert sum(isinstance(item, SavedState) for item in records) == 1
    i.rewind(0)
    assert (i.variables["n"], i.program.text) == (2, TIMED)


def test_pausing_is_not_undone_and_stepping_works_while_paused():
    i = started(TIMED, 3)
    i.pause()
    i.rewind(2)
    assert i.paused
    i.step(0.1)
    assert (i.paused, i.tick) == (True, 2)


def test_an_observer_gets_a_second_run_like_the_first():
    i, seen = started(TIMED, 2), []
    i.observe(seen.append)
    for tick in range(2, 7):
        i.step(tick / 10)
    first, seen[:] = list(seen), []
    i.rewind(5)
    assert not seen
    for tick in range(2, 7):
        i.step(tick / 10)
    assert seen == first


def test_the_journal_holds_on_to_no_more_than_some_hundred_programs(monkeypatch):
    monkeypatch.setattr("lrp_jupyter.interpreter.journal.EDITS", 3)
    text = "(var n := [0])(machine m (state a (running [n += 1])))(spawn m a)"
    i = started(text, ticks=0)
    for tick in range(10):  # the start is a snapshot too, and so is every edit
        i.step(tick / 10)
        if tick in (2, 4, 6, 8):
            i.patch(parse(text + f"; {tick}"))
    assert i.journal == 6, "back to the edit before the last three"
    i.rewind(6)
    assert (i.variables["n"], i.program.text) == (4, text + "; 2")
    for tick in range(4, 8):
        i.step(tick / 10)
        i.patch(parse(text + f"; again {tick}"))
    i.step(0.8)
    assert i.journal == 3
    i.rewind(3)
    assert i.variables["n"] == 6


def test_a_journal_reaches_as_far_as_it_is_bound_and_its_log_stays_as_long():
    program = parse("(var n := [0])(machine m (state a (running [n += 1])))(spawn m a)")
    i = Interpreter(program, journal=10)
    for tick in range(95):
        i.step(tick / 10)
        assert i.journal == min(tick + 1, 10)
        assert len(i._run.journal.log) < 110, "20 ticks of four items, and what the first one began"
    with pytest.raises(ValueError, match="the journal holds 10"):
        i.rewind(11)
    i.rewind(10)
    assert (i.variables["n"], i.now, i.tick, i.journal) == (85, 8.4, 85, 0)
    i.step(8.5)
    i.rewind(1)
    assert (i.variables["n"], i.now, i.journal) == (85, 8.4, 0)


def test_a_journal_drops_what_is_too_old_after_going_back_too():
    program = parse("(var n := [0])(machine m (state a (running [n += 1])))(spawn m a)")
    for back in range(11):
        i = Interpreter(program, journal=10)
        for tick in range(25):
            i.step(tick / 10)
        i.rewind(back)
        for tick in range(25 - back, 57):
            i.step(tick / 10)
            assert i.journal == min(10, 10 - back + tick + 1 - (25 - back)), (back, tick)
            assert len(i._run.journal.log) < 90
        i.rewind(10)
        assert (i.variables["n"], i.now, i.tick) == (47, 4.6, 47)
        i.step(4.7)
        i.rewind(1)
        assert (i.variables["n"], i.now, i.tick) == (47, 4.6, 47)


def test_a_tick_in_which_nothing_changed_costs_the_journal_one_number():
    i = started(
        "(var n := [0])(machine m (state a (running [n])) (state b) (on [n > 5] a -> b))(spawn m a)", 3
    )
    before = len(i._run.journal.log)
    for tick in range(3, 13):
        i.step(tick / 10)
    assert i._run.journal.log[before:] == [tick / 10 for tick in range(3, 13)]


def test_what_a_function_writes_is_undone_in_whatever_order_blocks_write_it_too():
    i = started(
        """(var n := [0])(var hook := [None])
        (machine first (state a (running [n += 1])))
        (machine second (state a (onentry [
            def hook():
              nonlocal n
              n += 10]) (running [hook()])))
        (machine third (state a (running [n += 100])))
        (spawn first a)(spawn second a)(spawn third a)"""
    )
    for tick in range(1, 4):
        i.step(tick / 10)
    assert i.variables["n"] == 444
    for left in (333, 222, 111):
        i.rewind(1)
        assert i.variables["n"] == left


# a function writes `n` from the third tick on; who ticks before and after it writes it too, or not
LATE = """(var n := [0])(var hook := [None])
    (machine before (state a (running [%s])))
    (machine m (state a) (state b (onentry [
        def hook():
          nonlocal n
          n += 10] [hook()]) (running [hook()]))
      (ontime 200 a -> b))
    (machine after (state a (running [%s])))
    (spawn before a)(spawn m a)(spawn after a)"""


@every("before", [0, 1])
@every("after", [0, 100])
def test_what_a_function_of_a_state_entered_later_writes_is_undone_from_its_first_tick_on(before, after):
    i = started(LATE % ("n += 1" if before else "0", "n += 100" if after else "0"))
    values = [i.variables["n"]]
    for tick in range(1, 6):
        i.step(tick / 10)
        values.append(i.variables["n"])
    each = before + after
    assert values == [each, 2 * each, 3 * each + 20, 4 * each + 30, 5 * each + 40, 6 * each + 50]
    for value in reversed(values[:-1]):
        i.rewind(1)
        assert i.variables["n"] == value


def test_a_change_in_the_tick_in_which_a_state_is_entered_that_may_write_too_is_an_event():
    i = started(LATE.replace("[hook()]", "[0]") % ("n += 1", "0"))
    seen = []
    i.observe(lambda event: seen.append((event.path, event.data)))
    for tick in range(1, 5):
        i.step(tick / 10)
    assert [value for path, value in seen if path == ("n",)] == [2, 3, 4, 5]


def test_what_a_function_writes_is_undone_when_an_observer_has_come_and_gone():
    i = started(
        """(var n := [0])(var hook := [None])
        (machine m (state a (onentry [
            def hook():
              nonlocal n
              n += 10]) (running [hook()])))
        (spawn m a)"""
    )
    i.step(0.1)
    i.observe(lambda event: None)()
    for tick in range(2, 4):
        i.step(tick / 10)
    i.rewind(2)
    assert i.variables["n"] == 20


def test_a_change_that_is_repeated_after_going_back_is_an_event_again():
    i = started("(var n := [0])(machine m (state a (running [n += 1])))(spawn m a)")
    seen = []
    i.observe(lambda event: seen.append(event.data))
    i.step(0.1)
    i.rewind(1)
    i.step(0.1)
    assert seen == [2, 2]


def test_what_an_expression_from_outside_writes_is_undone():
    i = started("(var n := [1])(var k := [2])(machine m (state a))(spawn m a)")
    i.set_variable("n", "[k := value for value in (5, 6)][-1] + (n := 9)")
    assert dict(i.variables) == {("n",): 15, ("k",): 6}
    i.rewind(0)
    assert dict(i.variables) == {("n",): 1, ("k",): 2}


@every("undone", range(1, 10))
def test_a_journal_that_is_full_keeps_whole_ticks_after_going_back_and_elsewhere_again(undone):
    states = "(state a (running [n += 1] [n += 1] [n += 1])) (state b (running [n += 1]))"
    i = started(f"(var n := [0]) (machine m {states}) (spawn m a)", 10, journal=10)
    i.rewind(undone)
    i.teleport_to("m/b")
    moments = {}
    for _ in range(25):
        i.step(i.now + 0.1)
        moments[i.tick] = moment(i)
    assert i.journal == 10
    i.rewind(10)
    assert moment(i) == moments[i.tick]


def test_going_back_in_a_new_run_undoes_no_rename_of_the_run_before():
    i = started(TIMED, 5)
    i.rename("state", "m/b", "c")
    i.renew(i.program, 1.0)
    i.step(1.1)
    i.step(1.2)
    moved = i.moved
    i.rewind(1)
    assert i.moved == moved

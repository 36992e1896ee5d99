"""Machines as parts, conditions that have to hold, effects and computed names, over edits and forks."""

import pytest
from support.story import PERIOD, active, robot, started
from support.tables import every

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element

TWO = """(var k := [1])
(machine n (var v := [k]) (state x) (state y))
(machine m
  (state a (onentry (spawn n x)))
  (state b (onentry (spawn n x (var v := [k + 10]))))
  (on n.y for 300 a -> b))
(spawn m a)"""
HELD = """(var v := [1]) (event e [v == 1])
(machine n (state x)) (machine m (state a (onentry (spawn n x))) (state b) (on {} for 300 a -> b late))
(spawn m a)"""


def edited(i, *changes):
    text = i.program.text
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return i.patch(parse(text))


def fork(i):
    copy = Interpreter(i.program, robot())
    copy.begin(i.snapshot())
    return copy


def run(i, *times):
    for time in times:
        i.step(time)
    return active(i)


def test_the_first_tick_has_no_time_before_it():
    i = Interpreter(parse("(var t := [dt]) (machine m (state a (running [t = t, dt]))) (spawn m a)"), robot())
    i.step(5.0)
    i.step(5.5)
    assert i.variables["t"] == ((0.0, 0.0), 0.5)


def test_a_fork_counts_dt_from_the_last_tick_as_the_run_does():
    i = started("(var t := [0]) (machine m (state a (running [t = dt]))) (spawn m a)", 2)
    i.pause(now=0.15)
    copy = fork(i)
    for each in (i, copy):
        each.step(0.2)
        assert each.variables["t"] == 0.1


def test_an_edit_of_a_fork_initialises_what_an_edit_of_the_run_does():
    text = "(var k := [1]) (var f := [(lambda: k) and [0]]) (var g := [1 / k if k else h])"
    i = started(f"{text} (machine m (state a (running [f.append(k)]))) (spawn m a)", 3)
    for each in (fork(i), i):
        edited(each, ("(spawn", "(event e [True]) (spawn"))
        assert each.variables["f"] == [0, 1, 1, 1]


def test_an_edit_initialises_no_variable_that_a_block_has_deleted():
    i = started("(var n := [1]) (var k := [n]) (machine m (state a (onentry [del k]))) (spawn m a)")
    edited(i, ("(spawn", "(event e [True]) (spawn"))
    assert ("k",) not in i.variables


@every(
    "names",
    [
        *(("state", "m/a", "c"), ("machine", "m", "p"), ("transition", "m/late", "soon")),
        *(("event", "e", "f"), ("variable", "v", "w")),
    ],
)
@every("condition", ["e", "[v == 1]", "n.x"])
def test_a_rename_keeps_since_when_a_condition_holds(condition, names):
    i = started(HELD.format(condition), 3)
    i.rename(*names)
    assert run(i, 0.3)[0].endswith("b")


@every(
    "change",
    [("300", "[100 + 100]"), ("late", "soon"), ("(state b)", "(state b) (state c (onentry (spawn n x)))")],
)
@every("condition", ["e", "[v == 1]", "n.x"])
def test_an_edit_of_other_things_keeps_since_when_a_condition_holds(condition, change):
    i = started(HELD.format(condition).replace("a ->", "{a c} ->"), 3)
    assert not edited(i, change).restarted
    assert run(i, 0.3)[0].startswith("m/b" if change[1] != "soon" else "m/a")


def test_a_count_that_is_taken_away_and_put_back_begins_then():
    text = HELD.format("[v == 1]")
    i = started(text, 2)
    i.patch(parse(text.replace("for 300 ", "")))
    i.set_variable("v", "0")
    i.step(0.2)
    i.patch(parse(text))
    i.set_variable("v", "1")
    assert run(i, 0.3, 0.4, 0.5) == ["m/a/n/x"]
    assert run(i, 0.6) == ["m/b"]


@every("condition", ["e", "[v == 1]"])
def test_a_watched_condition_has_to_hold_as_long(condition):
    i, seen = started(HELD.format(condition), 1), []
    for tick in range(1, 4):
        assert active(i) == ["m/a/n/x"]
        i.watch_test(Element("transition", ("m", "late")), seen.append)
        i.step(tick * PERIOD)
    assert active(i) == ["m/b"]
    assert [each.value for each in seen] == [True] * 3


def test_what_a_setting_reads_is_what_its_variable_was_computed_from():
    i = started(TWO.replace("(spawn m a)", "(spawn m b)").replace("[k + 10]", "[g]") + "(var g := [5])")
    i.set_variable("k", "3")
    assert not i.outdated
    i.set_variable("g", "3")
    assert {path: each.source for path, each in i.outdated.items()} == {("m", "b", "n", "v"): ("g",)}


@every("force", [Interpreter.transition_to, Interpreter.teleport_to])
def test_a_state_is_forced_where_its_path_says_else_where_its_machine_runs(force):
    i = started(TWO)
    force(i, "n/y")
    assert active(i) == ["m/a/n/y"]
    force(i, "m/b/n/y")
    assert active(i) == ["m/b/n/y"]
    assert i.variables["m/b/n/v"] == 11
    force(i, "m/a")
    force(i, "y")
    assert active(i) == ["m/a/n/y"]
    i = Interpreter(parse(TWO), robot())
    with pytest.raises(UnknownElementError, match="m/a/n/y"):
        force(i, "n/y")
    force(i, "m/b/n/y")
    assert active(i) == ["m/b/n/y"]

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
        i.watch_test(Element("transition", ("m", "late")), ("m",), seen.append)
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


def issues(i):
    return [(each.code, each.line, each.column, each.count) for each in i.issues if not each.resolved]


def test_a_transition_fires_although_its_effect_fails():
    text = (
        "(var n := [0]) (machine m (state a) (state b)\n (eps a -> b (effect [1 / n] [n += 1])))(spawn m a)"
    )
    i = started(text, 2)
    assert active(i) == ["m/b"]
    assert i.variables["n"] == 1
    assert [(each.element, each.line) for each in i.issues] == [(Element("effect", ("m", "eps:a->b")), 2)]


def test_an_effect_that_works_again_resolves_its_issue():
    text = "(var n := [0]) (machine m (state a) (eps {a} -> a (effect [1 / n])))(spawn m a)"
    i = started(text, 3)
    assert issues(i) == [("LRP601", 1, 60, 2)]
    i.set_variable("n", "1")
    i.step(0.3)
    assert issues(i) == []


@every("delay", ["k", "['x']", "[None]", "missing", "[missing]"])
@every("condition", ["e", "[True]", "n.x"])
def test_a_delay_that_is_none_is_one_issue_of_the_transition(delay, condition):
    text = HELD.format(condition).replace("300", delay) + "(var k := [[]])"
    i = started(text, 3)
    assert [(each.element, each.line, each.count) for each in i.issues] == [
        (Element("transition", ("m", "late")), 2, 3)
    ]
    i.patch(parse(text.replace(f"for {delay}", "for 200")))
    assert issues(i) == []
    assert run(i, 0.3) == ["m/b"], "it has held all the time"


def test_a_condition_that_fails_ends_the_time_for_which_it_held():
    text = "(machine m (state a) (state b) (on [1 / robot.light == 1] for 200 a -> b)) (spawn m a)"
    bot = robot()
    i = Interpreter(parse(text), bot)
    for tick, light in enumerate([1, 1, 0, 1, 1, 1]):
        assert active(i) != ["m/b"]
        bot.light = light
        i.step(tick * PERIOD)
    assert active(i) == ["m/b"]
    assert [(each.code, each.resolved) for each in i.issues] == [("LRP601", True)]


@every(
    "place", ["(running [1 / v])", "(event e [1 / v > 9]) (on e x -> y)", "(on [1 / v > 0] for 9000 x -> x)"]
)
def test_an_issue_of_a_shared_machine_is_open_until_the_instance_that_fails_recovers(place):
    form = f"(state x {place}) (state y)" if "running" in place else f"(state x) (state y) {place}"
    text = f"(machine n (var v := [0]) {form}) (machine m (state a (onentry (spawn n x))))"
    text += "(machine o (state a (onentry (spawn n x (var v := [2]))))) (spawn m a) (spawn o a)"
    i, seen = started(text), []
    i.observe(lambda event: seen.append(event.kind) if event.kind == "issue" else None)
    run(i, 0.1, 0.2, 0.3)
    assert [(each.count, each.resolved) for each in i.issues] == [(4, False)]
    i.set_variable("m/a/n/v", "1")
    i.step(0.4)
    assert [(each.count, each.resolved) for each in i.issues] == [(4, True)]
    assert seen == []


def test_the_issue_of_an_instance_that_is_gone_is_over_when_another_one_runs_well():
    text = "(machine n (var v := [0]) (state x (running [1 / v]))) (machine m (state a (onentry (spawn n x)))"
    text += "(state b) (ontime 200 a -> b)) (spawn m a) (spawn n x (var v := [1]))"
    i = started(text, 2)
    assert len(issues(i)) == 1
    run(i, 0.2, 0.3)
    assert issues(i) == []


def test_a_variable_of_a_machine_that_does_not_run_is_an_issue_that_says_so():
    text = (
        "(var k := [0]) (machine n (var v := [1]) (state x))\n(machine m (state a (running [k = (\n n.{})])))"
    )
    text += "(spawn m a)"
    i = started(text.format("v"))
    assert issues(i) == [("LRP601", 3, 2, 1)]
    assert i.issues[0].message == "`n` is not running, so `n.v` has no value."
    i.patch(parse(text.format("nope") + "(spawn n x)"))
    run(i, 0.1, 0.2)
    assert [each.message for each in i.issues][-1] == "The machine `n` has no variable `nope`."
    assert started(text.format("state")).variables["k"] is None


@every("block", ["n", "k = n", "n.v = 3", "del n.v", "n == 'x'", "n()", "n.state.v"])
def test_a_machine_is_only_read(block):
    text = f"(var k := [0]) (machine n (var v := [1]) (state x)) (machine m (state a (running [{block}])))"
    i = started(f"{text} (spawn m a) (spawn n x)", 2)
    assert i.variables["n/v"] == 1
    fork(i).step(0.3)


@every("force", [Interpreter.transition_to, Interpreter.teleport_to])
def test_forcing_inside_one_of_two_machines_spawns_the_other(force):
    text = """(machine arm (var v := [1]) (state go) (state done))
    (machine m (state idle) (state join)
     (state fetch (onentry (spawn left go) (spawn arm go (var v := [2])))
      (machine left (state go) (state done)))
     (on [left.state == "done" and arm.state == "done"] fetch -> join))
    (spawn m idle)"""
    i = started(text)
    force(i, "arm/done")
    assert active(i) == ["m/fetch/left/go", "m/fetch/arm/done"]
    assert i.variables["m/fetch/arm/v"] == 2
    force(i, "m/fetch/left/done")
    assert active(i) == ["m/fetch/left/done", "m/fetch/arm/done"]
    i.step(0.1)
    assert active(i) == ["m/join"]


def test_forced_states_begin_to_count_then():
    i = started(HELD.format("[v == 1]"), 3)
    i.transition_to("m/a")
    assert run(i, 0.3, 0.4, 0.5) == ["m/a/n/x"]
    assert run(i, 0.6) == ["m/b"]


@every("renamed", [("variable", "kp", "gain"), ("variable", "pid", "controller")])
def test_a_function_keeps_its_variables_through_a_rename_and_an_edit(renamed):
    text = "(var kp := [4]) (var pid := [lambda: kp]) (var out := [0])"
    i = started(f"{text} (machine m (state a (running [out = pid()]))) (spawn m a)")
    i.rename(*renamed)
    before = i.program.text
    i.patch(parse(before.replace("(var kp := [4])", "").replace("(var gain := [4])", "")))
    i.patch(parse(before))
    i.patch(parse(before.replace("[4]", "[9]")))
    i.step(0.1)
    assert i.variables["out"] == 9
    i.rewind(1)
    i.patch(parse(before.replace("[4]", "[7]")))
    i.step(0.1)
    assert i.variables["out"] == 7


def test_a_transition_that_is_fired_by_hand_has_its_effect_first():
    text = "(var log := ['']) (machine n (var v := ['v']) (state x (onexit [log += 'x'])))"
    text += "(machine m (state a (onentry (spawn n x)) (onexit [log += 'a']))"
    i = started(
        text
        + "(state b (onentry [log += 'b'])) (on [False] a -> b go (effect [log += n.v] [1 / 0]))) (spawn m a)"
    )
    i.fire("m/go")
    assert (active(i), i.variables["log"]) == (["m/b"], "vxab")
    assert [each.element.kind for each in i.issues] == ["effect"]
    i.rewind(0)
    assert (active(i), i.variables["log"]) == (["m/a/n/x"], "")


def test_a_debugger_sees_what_names_mean_at_a_fault():
    text = "(event e [n.v > 2]) (machine n (var v := [3]) (state x)) (spawn n x) (spawn m a)"
    i = started(f"{text} (machine m (state a (running [e, n, 1 / dt])))")
    names = i.traceback_of(i.issues[0], i.assign).tb_frame.f_locals
    assert (names["e"], names["n"].v, names["dt"]) == (True, 3, 0.0)
    i.set_variable("n/v", "1")
    assert names["e"] is False
    assert not any("(" in name or "." in name for name in names)


@every("delay", [200, 9000])
def test_a_function_computes_names_in_a_fork_as_in_the_run(delay):
    text = "(var f := [None]) (var k := [0]) (event e [q.v > 0]) (spawn q x)"
    text += "(machine q (var v := [3]) (state x))"
    text += "(machine m (state a (onentry (spawn n x))) (state b) (ontime 200 a -> b)) (spawn m a)"
    text += "(machine n (state x (onentry [f = lambda: (e, q.v, q.state, dt)])))"
    text += "(machine o (state x (running [k = f()]))) (spawn o x)"
    i = started(text.replace("200", str(delay)), 4)
    copy = fork(i)
    for each in (i, copy):
        each.set_variable("q/v", "-1")
        each.step(0.6)
        assert each.variables["k"] == (False, -1, "x", 0.3)


def test_a_function_computes_names_after_its_machine_was_removed():
    text = "(var f := [None]) (var k := [0]) (event e [q.v > 0]) (spawn q x)\n"
    text += "(machine q (var v := [3]) (state x))"
    text += "(machine m (state a (running [k = f()]) (onentry (spawn n x))) (state b (running [k = f()]))"
    text += "(ontime 200 a -> b)) (spawn m a)\n"
    part = "(machine n (state x (onentry [f = lambda: (e, q.v, q.state)])))"
    i = started(text + part, 4)
    i.patch(parse(text))
    i.set_variable("q/v", "-1")
    i.step(0.5)
    assert i.variables["k"] == (False, -1, "x")


def test_a_machine_or_an_event_called_robot_hides_nothing():
    text = "(event print [True]) (machine robot (state a (running [print(robot)]))) (spawn robot a)"
    seen = []
    i = Interpreter(parse(text), robot="the robot", output=seen.append)
    i.step(0.0)
    assert (seen, list(i.issues)) == (["the robot"], [])

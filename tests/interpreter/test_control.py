"""Pause, reset, forced states, variables, observers: what acts between ticks."""

import builtins

import pytest
from support import story
from support.story import active, robot
from support.tables import every

from lrp_jupyter.errors import NoDataYet, UnknownElementError
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.trace_events import EVENT_KINDS
from lrp_jupyter.language.parser import parse

NESTED = """
(var log := [""])
(machine m
  (state a (onentry [log += "A"]) (onexit [log += "a"]))
  (state b (onentry [log += "B"] (spawn n x) (spawn k s)) (onexit [log += "b"])
    (machine k (state s (onentry [log += "S"]) (onexit [log += "s"])))
    (machine n (var depth := [1])
      (state x (onentry [log += "X"]) (onexit [log += "x"]))
      (state y (onentry [log += "Y"] (spawn o z)) (onexit [log += "y"])
        (machine o (state z (onentry [log += "Z"]) (onexit [log += "z"])) (state w (onentry [log += "W"]))))))
  (state c))
(machine other (state o) (state p))
(spawn m a)
(spawn other o)
"""


def started(text=NESTED, ticks=1, **options):
    return story.started(text, ticks, **options)


def log(i):
    return i.variables["log"]


def test_nothing_is_active_before_the_first_tick():
    i = started(ticks=0)
    assert i.active == ()
    assert dict(i.variables) == {}


def test_transition_here_leaves_and_enters_with_all_actions_and_spawns():
    i = started()
    i.transition_to(("m", "b"))
    assert active(i) == ["m/b/n/x", "m/b/k/s", "other/o"]
    assert log(i) == "AaBXS"


def test_teleport_runs_no_action_of_any_state_but_does_the_spawns():
    i = started()
    i.teleport_to("m/b")
    assert active(i) == ["m/b/n/x", "m/b/k/s", "other/o"]
    assert log(i) == "A"
    i.teleport_to("m/a")
    assert (active(i), log(i)) == (["m/a", "other/o"], "A")


def test_forcing_the_active_state_leaves_and_enters_it():
    i = started()
    i.transition_to("m/a", now=0.05)
    assert log(i) == "AaA"
    assert i.entered("m/a") == 0.05


def test_a_target_in_an_inactive_nested_machine_makes_the_states_around_it_active():
    i = started()
    i.transition_to("m/b/n/y")
    assert active(i) == ["m/b/n/y/o/z", "m/b/k/s", "other/o"], "b spawns all that it spawns"
    assert log(i) == "AaBYZS"
    assert i.variables["m/b/n/depth"] == 1


def test_teleport_deep_down_initialises_variables_and_runs_nothing():
    i = started()
    i.teleport_to("m/b/n/y/o/w")
    assert active(i) == ["m/b/n/y/o/w", "m/b/k/s", "other/o"]
    assert log(i) == "A"
    assert i.variables["m/b/n/depth"] == 1


def test_an_enclosing_state_that_is_active_stays_and_so_do_the_siblings():
    i = started()
    i.transition_to("m/b")
    i.transition_to("m/b/n/y")
    assert active(i) == ["m/b/n/y/o/z", "m/b/k/s", "other/o"]
    assert log(i) == "AaBXSxYZ"
    i.transition_to("m/b/n/x")
    i.teleport_to("m/b/n/y/o/w")
    assert active(i) == ["m/b/n/y/o/w", "m/b/k/s", "other/o"]


def test_only_the_missing_machine_is_created():
    i = started(
        "(machine m (state a (machine n (state x)) (machine k (state s)) (onentry (spawn k s))))(spawn m a)"
    )
    i.transition_to("m/a/n/x")
    assert active(i) == ["m/a/k/s", "m/a/n/x"]


def test_forcing_with_nothing_active_starts_the_program_there():
    i = started(ticks=0)
    i.transition_to("m/c")
    assert active(i) == ["m/c"]
    assert log(i) == ""
    i.step(0.1)
    assert active(i) == ["m/c", "other/o"], "the other top-level spawns start at the next tick"
    i.step(0.2)
    assert active(i) == ["m/c", "other/o"]


def test_forcing_into_a_root_machine_that_does_not_run_starts_it():
    i = started(NESTED.replace("(spawn other o)", ""))
    i.transition_to("other/p")
    assert active(i) == ["m/a", "other/p"]
    patch = i.patch(parse(NESTED.replace("(spawn other o)", "; a comment")))
    assert not patch.restarted


@every("force", [Interpreter.transition_to, Interpreter.teleport_to])
@every("path", ["m/nowhere", "nowhere/a", "m", "", "m/a/n/x"])
def test_an_unknown_target_raises_and_changes_nothing(force, path):
    i = started()
    with pytest.raises(UnknownElementError) as refusal:
        force(i, path)
    why = "`m` is a machine, not a state." if path == "m" else f"There is no state `{path}`."
    assert str(refusal.value).startswith(why)
    assert (active(i), log(i)) == (["m/a", "other/o"], "A")


def test_a_forced_state_can_be_named_by_its_path_as_spawned():
    i = started("(machine h (state p) (state q))(machine m (state a (onentry (spawn h p))))(spawn m a)")
    i.transition_to("m/a/h/q")
    assert active(i) == ["m/a/h/q"]


@every("path", ["h/q", "m/a/h/q"])
@every("force", [Interpreter.transition_to, Interpreter.teleport_to])
def test_a_forced_state_is_reported_first_by_its_path_as_spawned(force, path):
    i = started("(machine h (state p) (state q))(machine m (state a (onentry (spawn h p))))(spawn m a)")
    seen = []
    i.observe(seen.append)
    force(i, path)
    assert [(e.kind, e.path) for e in seen] == [
        ("forced", ("m", "a", "h", "q")),
        ("left", ("m", "a", "h", "p")),
        ("entered", ("m", "a", "h", "q")),
    ]


def test_spawns_that_wait_for_the_next_tick_go_with_a_rename():
    i = started(ticks=0)
    i.transition_to("m/c")
    i.rename("machine", "other", "another")
    i.rename("state", "another/o", "oh")
    i.rename("machine", "m", "mm")
    i.step(0.1)
    assert active(i) == ["mm/c", "another/oh"]
    assert not i.patch(parse(i.program.text + "; the same")).restarted


def test_discarded_variables_are_reported_without_a_journal_too():
    i, seen = started(journal=0), []
    i.transition_to("m/b/n/y")
    i.observe(lambda event: seen.append((event.kind, event.path[-1])))
    i.set_variable("m/b/n/depth", "5")
    i.transition_to("m/a")
    assert seen == [
        ("changed", "depth"), ("forced", "a"),
        ("left", "s"), ("discarded", "k"),
        ("left", "z"), ("discarded", "o"), ("left", "y"), ("discarded", "n"), ("left", "b"),
        ("entered", "a"), ("changed", "log"),
    ]  # fmt: skip


def test_what_an_onexit_writes_is_an_event_before_its_machine_is_discarded():
    i, seen = (
        started(
            """(machine m
          (state a (onentry (spawn n x)) (machine n (var k := [1]) (state x (onexit [k = 7]))))
          (state b)
          (ontime 100 a -> b))
        (spawn m a)"""
        ),
        [],
    )
    i.observe(lambda event: seen.append((event.kind, event.path, event.data)))
    i.step(0.1)
    inner = ("m", "a", "n")
    assert seen[:3] == [
        ("left", (*inner, "x"), None), ("changed", (*inner, "k"), 7), ("discarded", inner, None),
    ]  # fmt: skip


def test_a_spawn_that_is_removed_while_it_waits_does_not_start():
    i = started(ticks=0)
    i.transition_to("m/c")
    i.patch(parse(NESTED.replace("(spawn other o)", "(spawn other p)")))
    assert active(i) == ["m/c", "other/p"], "an added one is started now"
    i.reset()
    i.transition_to("m/c")
    i.patch(parse(NESTED.replace("(spawn other o)", "")))
    i.step(0.2)
    assert active(i) == ["m/c"]


def test_reset_runs_no_onexit_and_starts_again_at_the_next_tick():
    i = started()
    i.reset()
    assert i.active == ()
    assert dict(i.variables) == {}
    i.step(0.1)
    assert log(i) == "A"


PAUSE = """(var log := [""])(machine m (state a))(spawn m a)
(onpause [log += "p"] [log += "q"])(onresume [log += "r"] [1 / 0])"""


def test_pause_and_resume_run_their_actions_once():
    i = started(PAUSE)
    i.pause()
    i.pause()
    assert i.paused
    assert log(i) == "pq"
    i.resume()
    i.resume()
    assert not i.paused
    assert log(i) == "pqr"
    assert [(issue.code, issue.line) for issue in i.issues] == [("LRP601", 2)]


def test_pause_runs_no_action_while_nothing_is_active():
    i = started(PAUSE, ticks=0)
    i.pause()
    i.resume()
    assert not i.issues


def test_a_paused_program_that_restarts_stays_paused():
    i = started(PAUSE)
    i.pause()
    i.reset()
    assert i.paused


def test_pause_on_issue_completes_the_tick_first():
    i = started("(var n := [0])(machine m (state a (running [1 / 0] [n += 1])))(spawn m a)", on_issue="pause")
    assert i.paused
    assert i.variables["n"] == 1
    assert isinstance(i.issues.raised(i.issues[0]).error, ZeroDivisionError)
    i.resume()
    i.step(0.2)
    assert (i.paused, i.variables["n"]) == (True, 2), "at every occurrence"


def test_set_variable_evaluates_in_the_scope_of_the_variable():
    i = started("(var n := [2])(machine m (var k := [5]) (state a))(spawn m a)", namespace={"seven": 7})
    i.set_variable("m/k", " n * k + seven ")
    assert i.variables["m/k"] == 17
    i.set_variable(("n",), "[x for x in range(n)]")
    assert i.variables["n"] == [0, 1]


def test_a_variable_is_read_and_set_by_a_name_that_only_one_has():
    i = started("(var n := [2])(machine m (var k := [5]) (state a))(spawn m a)")
    assert (i.variables["k"], "k" in i.variables) == (5, True)
    i.set_variable("k", "n + k")
    assert i.variables["m/k"] == 7
    with pytest.raises(UnknownElementError, match="Did you mean `m/k`"):
        i.variables["m/kk"]


@every("path", ["q", "m/n", "q/k", ""])
def test_a_variable_that_does_not_live_cannot_be_set(path):
    i = started("(var n := [2])(machine m (var k := [5]) (state a))(spawn m a)")
    with pytest.raises(UnknownElementError):
        i.set_variable(path, "1")


@every(
    ("expression", "error"),
    [
        ("1 +", SyntaxError),
        ("n = 3", SyntaxError),
        ("", SyntaxError),
        ("(yield)", SyntaxError),
        ("n" + ".a" * 100_000, SyntaxError),
        ("1 / 0", ZeroDivisionError),
        ("nope", NameError),
    ],
)
def test_an_expression_that_fails_leaves_the_variable(expression, error):
    i = started("(var n := [2])(machine m (state a))(spawn m a)")
    with pytest.raises(error):
        i.set_variable("n", expression)
    assert i.variables["n"] == 2


def test_time_never_goes_back():
    i = started(ticks=3)
    with pytest.raises(ValueError, match="Time cannot go back"):
        i.step(0.1)
    with pytest.raises(ValueError, match="Time cannot go back"):
        i.step(float("nan"))


def test_keyboard_interrupt_passes_when_the_tick_is_whole():
    i = started(
        "(var n := [0])(machine m (state a (running [raise KeyboardInterrupt] [n += 1])))(spawn m a)", ticks=0
    )
    with pytest.raises(KeyboardInterrupt):
        i.step(0.0)
    assert i.variables["n"] == 1
    assert not i.issues


def test_nothing_is_written_into_the_namespace():
    space = {"gain": 3}
    i = started(
        "(var n := [gain])(machine m (state a (running [local = gain; n = local])))(spawn m a)",
        2,
        namespace=space,
    )
    assert i.variables["n"] == 3
    space["gain"] = 4
    i.step(0.2)
    assert i.variables["n"] == 4
    assert space == {"gain": 4, "__builtins__": builtins}, "as `exec` adds it"


def test_an_lrp_variable_wins_over_a_name_of_the_namespace():
    i = started("(var gain := [1])(machine m (state a))(spawn m a)", namespace={"gain": 9})
    i.set_variable("gain", "gain + 1")
    assert i.variables["gain"] == 2


def test_print_writes_to_the_given_output():
    said = []
    started(
        '(machine m (state a (onentry [print("hello", 3)])))(spawn m a)',
        output=lambda *words: said.append(words),
    )
    assert said == [("hello", 3)]


def test_every_kind_of_event_is_reported_in_order():
    i = Interpreter(parse(PAUSE.replace("[1 / 0]", "[nope]")), robot())
    seen = []
    stop = i.observe(seen.append)
    i.step(0.0)
    i.pause()
    i.resume()
    i.transition_to("m/a")
    i.patch(parse(PAUSE))
    i.reset()
    assert [e.kind for e in seen] == [
        "started", "spawned", "entered", "changed",
        "paused", "changed", "issue", "resumed", "changed",
        "forced", "left", "entered", "patched", "restarted",
    ]  # fmt: skip
    assert {e.kind for e in seen} <= set(EVENT_KINDS)
    stop()
    stop()
    i.step(0.1)
    assert len(seen) == 14


def test_a_late_observer_gets_only_what_is_new():
    i = started(
        "(var n := [0])(var k := [1])(machine m (state a (running [n += 1])))(spawn m a)", 3, journal=0
    )
    seen = []
    i.observe(seen.append)
    i.step(0.3)
    assert [(e.kind, e.path, e.data) for e in seen] == [("changed", ("n",), 4)]


def test_numpy_conditions_hold_when_they_are_true():
    numpy = pytest.importorskip("numpy")
    text = """(machine m (state a) (state b)
      (on [np.bool_(False)] a -> a) (on [np.float64(3) > 2] a -> b))(spawn m a)"""
    i = started(text, 2, namespace={"np": numpy})
    assert active(i) == ["m/b"]
    assert not i.issues


def test_a_traceback_shows_the_line_of_the_program():
    i = started("(machine m\n  (state a (running [x = 1\n    y = x / 0])))\n(spawn m a)", 2)
    (issue,) = i.issues
    assert (issue.line, issue.column) == (3, 9)
    assert "y = x / 0" in issue.traceback
    assert "a.running" in issue.traceback
    assert "interpreter" not in issue.traceback


def test_an_issue_is_resolved_and_reopened():
    i = started("(var n := [0])(machine m (state a (running [n += 1] [1 / (n % 3)])))(spawn m a)", 3)
    assert [issue.resolved for issue in i.issues] == [False]
    i.step(0.3)
    assert [issue.resolved for issue in i.issues] == [True]
    i.step(0.4)
    i.step(0.5)
    (issue,) = i.issues
    assert (issue.resolved, issue.count, issue.first_tick, issue.last_tick) == (False, 2, 3, 6)


def test_going_back_needs_a_journal_that_reaches_so_far():
    i = started(ticks=5, journal=3)
    with pytest.raises(ValueError, match="the journal holds 3"):
        i.rewind(4)
    i.rewind(3)
    assert i.tick == 2
    with pytest.raises(ValueError, match="no journal"):
        started(journal=0).rewind(1)


def test_going_back_undoes_what_was_done_between_ticks():
    i = started("(var n := [0])(machine m (state a (running [n += 1])) (state b))(spawn m a)", 3)
    i.set_variable("n", "100")
    i.transition_to("m/b")
    i.rewind(0)
    assert (active(i), i.variables["n"], i.tick) == (["m/a"], 3, 3)
    i.set_variable("n", "100")
    i.reset()
    i.step(0.3)
    i.step(0.4)
    i.rewind(2)
    assert (active(i), i.variables["n"], i.now) == (["m/a"], 3, 0.2)
    i.rewind(3)
    assert (i.active, dict(i.variables), i.tick) == ((), {}, 0)


def test_after_going_back_the_program_runs_on_as_before():
    i = started(ticks=1)
    i.transition_to("m/b")
    i.step(0.1)
    i.rewind(1)
    assert active(i) == ["m/a", "other/o"]
    i.transition_to("m/b")
    assert log(i) == "AaBXS"


def test_variables_are_a_mapping_by_path_or_by_text():
    i = started(
        "(var n := [0])(var none := [1 / 0])(machine m (state a (onentry (spawn h p))))"
        "(machine h (var k := [1]) (state p))(spawn m a)"
    )
    assert dict(i.variables) == {("n",): 0, ("m", "a", "h", "k"): 1}
    assert (len(i.variables), repr(i.variables)) == (2, "{'n': 0, 'm/a/h/k': 1}")
    assert i.variables["h/k"] == 1, "by its path of definition as well"
    for path in ("none", ("none",), "nothing", "m/n"):
        with pytest.raises(KeyError, match=r"none|nothing|m/n"):
            i.variables[path]


def test_issues_are_a_sequence():
    i = started("(machine m (state a (running [1 / 0])) (on nope a -> a))(spawn m a)", 3)
    first, second = i.issues
    assert i.issues[0] == first
    assert i.issues[-1:] == (second,)
    assert (first.code, second.code, str(first.element)) == ("LRP603", "LRP601", "transition `m/nope:a->a`")
    assert str(second) == "1:31: LRP601 ZeroDivisionError: division by zero (3 times)"
    assert repr(i.issues).startswith("IssueLog([Issue(")
    i.issues.clear()
    assert not i.issues
    i.step(0.3)
    assert [issue.count for issue in i.issues] == [1, 1]


def test_what_cannot_be_shown_is_an_issue_all_the_same():
    text = """(machine m (state a (running [
      class Odd(Exception):
          def __str__(self): raise ValueError
      raise Odd]))
      (event strange [
        class Odd:
          def __repr__(self): raise ValueError
        Odd()])
      (event long ["x" * 1000])
      (on strange a -> a) (on long a -> a))(spawn m a)"""
    strange, long, odd = (issue.message for issue in started(text, 2).issues)
    assert "not a value of type `Odd`" in strange
    assert "not 'xxxx" in long
    assert len(long) < 130
    assert odd.endswith("Odd: <exception str() failed>")


def test_an_exception_that_never_enters_the_block_is_located_at_the_element():
    i = started("(machine m\n  (state a\n    (running [len()])))(spawn m a)", 2)
    (issue,) = i.issues
    assert (issue.line, issue.column) == (3, 15)


def test_a_nonlocal_whose_variable_is_gone_is_an_issue_when_it_runs():
    i = started("(machine m (state a (running [\n def f():\n  nonlocal gone\n f()])))(spawn m a)", 2)
    (issue,) = i.issues
    assert (issue.code, issue.resolved) == ("LRP606", False)
    assert "gone" in issue.message
    i = started("(machine m (state a)(ontime [\n def f():\n  nonlocal gone\n f()] a -> a))(spawn m a)", 2)
    assert [issue.code for issue in i.issues] == ["LRP606"]


def test_a_reading_that_has_not_arrived_is_not_a_fault_of_a_condition():
    class Robot:
        @property
        def light(self):
            raise NoDataYet("no data yet on /light")

    text = """(machine m (event bright [robot.light > 3]) (state a (running [robot.light])) (on bright a -> a)
      (on [robot.light > 3] a -> a) (ontime [robot.light] a -> a))(spawn m a)"""
    i = Interpreter(parse(text), Robot())
    for tick in range(3):
        i.step(tick / 10)
    assert [(issue.code, issue.element.kind) for issue in i.issues] == [("LRP610", "running")]


@every(
    ("before", "after", "is_a_change"),
    [("0.5", "0.25 * 2", False), ("'ab'", "''.join('ab')", False), ("1", "1.0", True), ("1", "True", True)],
)
def test_a_variable_has_changed_if_its_value_or_type_is_another(before, after, is_a_change):
    states = f"(state a) (state b (running [n = {after}])) (eps a -> b)"
    text = f"(var n := [{before}])(machine m {states})(spawn m a)"
    i = Interpreter(parse(text))
    i.step(0.0)
    seen = []
    i.observe(lambda event: seen.append(event.kind))
    i.step(0.1)
    assert seen.count("changed") == is_a_change


COLLECTIONS = """
from array import array
from collections import Counter, OrderedDict, defaultdict, deque
from types import SimpleNamespace
"""


def changes(initial, action, ticks=1, **options):
    """How often an observer hears of a change of `v` when a state does something to it, in each tick."""
    text = f"(var v := [{COLLECTIONS}{initial}\n]) (machine m (state a (running [{action}]))) (spawn m a)"
    i = Interpreter(parse(text), **options)
    i.step(0.0)
    seen = []
    i.observe(seen.append)
    for tick in range(ticks):
        i.step(tick + 1.0)
    assert not i.issues
    assert {event.path for event in seen} <= {("v",)}
    return len(seen)


@every(
    ("initial", "action"),
    [
        ("[]", "v.append(1)"),
        ("[1, 2]", "v[0] += 1"),
        ("[1, 2]", "v.reverse()"),
        ("[1, True]", "v[0], v[1] = v[1], v[0]"),
        ("list(range(1000))", "v[100] += 1"),
        ("list(range(1000))", "v.append(1)"),
        ("{}", "v[len(v)] = 1"),
        ("{'a': 1}", "v['a'] += 1"),
        ("OrderedDict(a=1, b=2)", "v.move_to_end(next(iter(v)))"),
        ("defaultdict(int)", "v['a'] += 1"),
        ("Counter()", "v.update('a')"),
        ("set()", "v.add(len(v))"),
        ("{1}", "v.add(v.pop() + 1)"),
        ("set(range(1000))", "v.pop()"),
        ("bytearray(3)", "v[0] += 1"),
        ("deque([1, 2], maxlen=2)", "v.rotate()"),
        ("array('d', [0])", "v[0] += 1"),
        ("[[0] * 10 for _ in range(10)]", "v[9][9] += 1"),
        ("[[[1]]]", "v[0][0][0] += 1"),
        ("{'a': {'b': [0]}}", "v['a']['b'][0] += 1"),
        ("(1, ([], 2))", "v[1][0].append(1)"),
        ("[SimpleNamespace()]", "v[0] = type(v[0])()"),
        ("[[1]]", "v[0] = [1]"),
        ("[]", "v.append(v)"),
    ],
)
def test_a_change_in_place_is_a_change(initial, action):
    assert changes(initial, action, ticks=3) == 3


@every(
    ("initial", "action"),
    [
        ("[0.5]", "v[0] = 0.25 * 2"),
        ("[1]", "v.append(v.pop())"),
        ("{1, 2}", "v.add(1)"),
        ("([], 1)", "v[0].clear()"),
        ("SimpleNamespace(n=1)", "v.n += 1"),
        ("[SimpleNamespace(n=1)]", "v[0].n += 1"),
        ("list(range(1000))", "v[900] += 1"),
        ("[[[[1]]]]", "v[0][0][0][0] += 1"),
    ],
)
def test_what_is_equal_or_inside_an_object_or_far_back_or_deep_is_not_seen_to_change(initial, action):
    assert changes(initial, action, ticks=3) == 0


def test_a_collection_is_compared_without_running_foreign_code():
    def fail(*_):
        raise AssertionError("This must not run.")

    strange = type("Kind", (type,), {"__eq__": fail, "__hash__": fail})
    value = strange("Value", (list,), {"__eq__": fail, "__hash__": fail, "__len__": fail, "__repr__": fail})()
    names = {"make": lambda: value}
    assert changes("[make(), (make(), 1)]", "v[0] = v[1][0]", namespace=names) == 0
    assert changes("[make()]", "v.insert(0, 1)", namespace=names) == 1
    assert changes("[1]", "v.insert(0, make())", namespace=names) == 1
    assert changes("make()", "v = make() if v is None else None", ticks=2, namespace=names) == 2


def test_an_observer_hears_of_a_change_in_place_again_after_a_rewind():
    i = Interpreter(parse("(var v := [[]]) (machine m (state a (running [v.append(1)]))) (spawn m a)"))
    for tick in range(3):
        i.step(float(tick))
    seen = []
    i.observe(seen.append)
    i.rewind(1)
    assert i.variables["v"] == [1, 1, 1], "a list is not undone"
    i.step(2.0)
    assert [(event.kind, event.tick, event.path) for event in seen] == [("changed", 3, ("v",))]


def test_no_collection_is_read_without_an_observer(monkeypatch):
    def read(value):
        raise AssertionError("The parts were read.")

    monkeypatch.setattr("lrp_jupyter.interpreter.run.parts_of", read)
    leaking = "def add():\n nonlocal v\n v = [*v, 1]\nadd()"
    started(f"(var v := [[]]) (machine m (state a (running [v.append(1)] [{leaking}]))) (spawn m a)", 3)


def test_an_observer_sees_changes_of_state_that_were_bound_before_it_came_and_after_others_left():
    i = Interpreter(parse("(machine m (state a) (state b) (eps a -> b t) (eps b -> a u))(spawn m a)"))
    for tick in range(4):
        i.step(tick / 10)
    seen = []
    stop = i.observe(lambda event: seen.append((event.kind, event.path[-1])))
    i.step(0.4)
    stop()
    i.step(0.5)
    assert seen == [("left", "b"), ("fired", "u"), ("entered", "a")]


def test_an_issue_of_an_onexit_comes_before_left_and_one_of_an_onentry_after_entered():
    text = "(machine m (state a (onexit [1 / 0])) (state b (onentry [gone])) (eps a -> b t))(spawn m a)"
    i = Interpreter(parse(text))
    seen = []
    i.observe(lambda event: seen.append(event.kind))
    i.step(0.0)
    seen.clear()
    i.step(0.1)
    assert seen == ["issue", "left", "fired", "entered", "issue"]


def test_one_observer_may_leave_while_others_stay():
    i = started(ticks=0)
    first, second = [], []
    stop = i.observe(first.append)
    i.observe(second.append)
    stop()
    i.step(0.0)
    assert not first
    assert second


def test_an_edit_moves_an_issue_with_its_text():
    text = "(machine m (state a (running [1 / 0])))(spawn m a)"
    i = started(text, 2)
    i.patch(parse("\n\n   " + text))
    (issue,) = i.issues
    assert (issue.line, issue.column, issue.resolved) == (3, 34, False)


def test_a_repeated_definition_is_an_issue_until_it_is_removed():
    twice = "(var n := [1])(var n := [2])(machine m (state a) (state a (onentry [n = 5])))(spawn m a)"
    i = started(twice, 2)
    assert [(issue.code, issue.element.kind) for issue in i.issues] == [
        ("LRP609", "variable"),
        ("LRP609", "state"),
    ]
    assert i.variables["n"] == 1
    i.patch(parse(twice + "; still"))
    assert [issue.count for issue in i.issues] == [1, 1]
    i.patch(parse("(var n := [1])(machine m (state a))(spawn m a)"))
    assert all(issue.resolved for issue in i.issues)


@every(
    ("kind", "path", "new", "active_after"),
    [
        ("state", "m/b", "bee", ["m/bee/n/x", "m/bee/k/s", "other/o"]),
        ("machine", "m/b/n", "nn", ["m/b/nn/x", "m/b/k/s", "other/o"]),
        ("machine", "m", "mm", ["mm/b/n/x", "mm/b/k/s", "other/o"]),
        ("state", "m/a", "start", ["m/b/n/x", "m/b/k/s", "other/o"]),
        ("variable", "log", "diary", ["m/b/n/x", "m/b/k/s", "other/o"]),
        ("variable", "m/b/n/depth", "d", ["m/b/n/x", "m/b/k/s", "other/o"]),
    ],
)
def test_an_explicit_rename_carries_everything_over(kind, path, new, active_after):
    i = started()
    i.transition_to("m/b", now=0.05)
    text, before = i.program.text, sorted(map(str, i.variables.values()))
    renamed = i.rename(kind, path, new)
    assert renamed == i.program.text != text
    assert active(i) == active_after
    assert sorted(map(str, i.variables.values())) == before
    i.step(0.1)
    assert active(i) == active_after
    assert not i.issues
    back = (*path.split("/")[:-1], new)
    assert i.rename(kind, back, path.split("/")[-1]) == text
    assert not i.patch(parse(text + " ")).restarted
    assert active(i) == ["m/b/n/x", "m/b/k/s", "other/o"]
    i.rewind(1)
    assert i.program.text == text


def test_a_rename_that_cannot_be_changes_nothing():
    i = started()
    text = i.program.text
    with pytest.raises(ValueError, match="taken"):
        i.rename("state", "m/b", "a")
    with pytest.raises(UnknownElementError):
        i.rename("state", "m/zzz", "a")
    assert i.program.text == text


def test_a_spawn_that_works_again_resolves_its_issue():
    text = """
    (machine first (state a (onentry (spawn second a))) (state b) (ontime 200 a -> b))
    (machine second (state a (onentry (spawn first b))) (ontime 300 a -> a))
    (spawn first a)(spawn second a)"""
    i = started(text)
    assert active(i) == ["first/a/second/a", "second/a/first/b"], "a machine does not run inside itself"
    assert [(issue.code, issue.resolved) for issue in i.issues] == [("LRP608", False)]
    for tick in range(1, 4):
        i.step(tick / 10)
    assert active(i) == ["first/b", "second/a/first/b"]
    assert [(issue.code, issue.resolved) for issue in i.issues] == [("LRP608", True)]


def test_an_exit_that_leads_somewhere_again_resolves_its_issue():
    text = """(machine first (state a (onentry (spawn helper h))) (state b) (ontime 300 a -> b))
    (machine second (state a) (state c (onentry (spawn helper h))) (state home) (ontime 500 a -> c))
    (machine helper (state h) (exit [True] h -> home))
    (spawn first a)(spawn second a)"""
    i = started(text, 3)
    assert [(issue.code, issue.resolved) for issue in i.issues] == [("LRP604", False)]
    assert "The machine `first` has no state `home`." in i.issues[0].message
    for tick in range(3, 8):
        i.step(tick / 10)
    assert active(i) == ["first/b", "second/home"]
    assert [(issue.code, issue.resolved) for issue in i.issues] == [("LRP604", True)]


def test_an_exit_in_a_root_machine_leads_nowhere():
    i = started("(machine m (state a) (exit [True] a -> a))(spawn m a)", 2)
    assert "is not nested in a state" in i.issues[0].message
    assert active(i) == ["m/a"]


def test_the_journal_knows_how_far_back_it_reaches():
    i = started(ticks=4, journal=3)
    assert i.journal == 3
    assert started(journal=0).journal == 0


def test_an_unset_variable_shows_itself():
    i = started("(var n := [1])(machine m (state a) (state b (running [del n])) (eps a -> b))(spawn m a)")
    seen = []
    i.observe(seen.append)
    i.step(0.1)
    assert repr(seen[-1].data) == "<unset>"
    i.rewind(1)
    assert i.variables["n"] == 1


def test_reading_a_variable_whose_initialiser_failed_is_reported():
    i = started("(var n := [1 / 0])(machine m (state a (running [n])))(spawn m a)", 2)
    assert i.issues[1].message == "`n` has no value. Assign one first."


def test_a_name_without_a_value_is_known_by_its_place_not_by_the_words_of_the_exception():
    block = "raise NameError('no free variable', name='n')"
    i = started(f"(machine m (state a (running [{block}])))(spawn m a)", 2)
    assert i.issues[0].message.startswith("`n` is not defined here.")


def test_a_condition_that_holds_does_not_hide_a_missing_destination():
    i = started("(machine m (state a) (on [True] a -> nowhere))(spawn m a)", ticks=0)
    seen = []
    i.observe(seen.append)
    for tick in range(3):
        i.step(tick / 10)
    assert [event.kind for event in seen] == ["started", "spawned", "entered", "issue"]
    assert [(issue.count, issue.resolved) for issue in i.issues] == [(3, False)]


def test_a_fault_in_a_function_of_the_namespace_is_located_where_the_block_calls_it():
    def fail():
        raise OSError("no robot")

    i = started("(machine m\n (state a (running [1;\n fail()])))(spawn m a)", 2, namespace={"fail": fail})
    (issue,) = i.issues
    assert (issue.line, issue.column, issue.message) == (3, 2, "OSError: no robot")


def test_forcing_through_states_whose_actions_fail_continues():
    text = (
        "(machine m (state z) (state a (onentry [1 / 0]) (machine n (state x) (state y))))(spawn m nowhere)"
    )
    i = started(text)
    i.transition_to("m/a/n/y")
    assert active(i) == ["m/a/n/y"]
    assert [(issue.code, issue.resolved) for issue in i.issues] == [("LRP604", False), ("LRP601", False)]


def test_two_interpreters_share_the_plan_of_one_program():
    program = parse(NESTED)
    one, two = Interpreter(program), Interpreter(program)
    one.step(0.0)
    assert two.active == ()
    two.step(5.0)
    assert one.active == two.active

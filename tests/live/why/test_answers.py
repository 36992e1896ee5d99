"""What an answer says, and what it does not say: it never guesses."""

import pytest
from support.robots import Courier
from support.tables import every

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.message import Twist
from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.history import History
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session
from lrp_jupyter.live.why import evaluation

LISTS = """(var seen := [[]])
(machine m
  (state a (running [seen.append(1)]))
  (state b)
  (on [len(seen) > 100] a -> b full)
  (on [ask(seen)] a -> b asked))
(spawn m a)"""
TWICE = (
    "(machine m (state a) (state b) (on [False] a -> b) (on [False] b -> a go) (eps b -> a go))(spawn m a)"
)


def session(text, bridge="none", **options):
    return Session(text, bridge, clock=VirtualClock(), **options)


def test_what_was_changed_in_place_is_known_by_running_the_tick_again():
    with session(LISTS, namespace={"ask": lambda seen: len(seen) > 50}) as live:
        live.run(2)
        answer = live.why_not("full", at=5)
        assert answer.facts["values"] == {"seen": "[1, 1, 1, 1]", "len(seen)": 4}
        assert answer.facts["decides"] == "len(seen) > 100"
        assert len(live.frame.values["seen"]) == 20, "and this session has not noticed"
        assert "`ask(seen)` was False" in str(live.why_not("asked", at=5))


class Sonar(Bridge):
    """A robot that cannot be copied."""

    name = "sonar"
    hardware = False
    stop_timeout = None
    called = 0

    def open_interface(self):
        self.add_variable("range", lambda: 3)
        self.add_variable("other", lambda: 4)
        self.add_method("move", self.move)

    def move(self, linear=0.0):
        Sonar.called += 1


def test_a_value_that_was_not_recorded_is_not_guessed():
    with session(LISTS, Sonar, namespace={"ask": len}) as live:
        live.run(2)
        answer = live.why_not("full", at=5)
        assert answer.code == "condition-false"
        assert "values" not in answer.facts
        assert "not known: `seen` may have been changed in place." in str(answer)


def test_the_readings_of_a_robot_that_cannot_be_copied_are_those_of_the_tick():
    text = "(machine m (state a) (state b) (on [robot.range > 5] a -> b far))(spawn m a)"
    with session(text, Sonar) as live:
        live.run(1)
        answer = live.why_not("far", at=5)
        assert answer.facts["values"] == {"robot.range": 3}
        assert dict(live.at(5).readings) == {"range": 3}


def test_looking_back_never_commands_a_robot():
    text = """(machine m
      (state a (running [robot.move(0.1)])) (state b)
      (on [robot.range > 5] a -> b far))
    (spawn m a)"""
    with session(text, Sonar) as live:
        live.run(2)
        before = Sonar.called
        for tick in range(1, 20):
            live.at(tick)
            live.why_not("far", at=tick)
            live.why("robot.move", at=tick)
        with live.fork(10, inputs=True) as fork:
            fork.run(5)
            assert fork.frame.readings == {"range": 3}
        assert Sonar.called == before


def test_a_name_that_several_transitions_have_is_refused_with_their_paths():
    with session(TWICE) as live:
        live.run(1)
        with pytest.raises(UnknownElementError, match="no transition `nothing`"):
            live.why_not("nothing")
        assert live.why_not("go").code == "source-inactive"
        assert live.why_not("m/go#2").code == "source-inactive"


def test_what_does_not_exist_is_named_with_what_was_probably_meant():
    with session(LISTS, namespace={"ask": len}) as live:
        with pytest.raises(ValueError, match="No tick has run yet"):
            live.why_not("full")
        live.run(1)
        with pytest.raises(UnknownElementError, match="Did you mean `full`"):
            live.why_not("ful")
        with pytest.raises(UnknownElementError, match="no state or command `c`"):
            live.why("c")
        with pytest.raises(UnknownElementError, match="no command `mov`"):
            live.why("robot.mov")
        with pytest.raises(ValueError, match="ticks 1 to 10"):
            live.why_not("full", at=99)


@every(
    ("ask", "sentence"),
    [
        (lambda s: s.explain("seen"), "`seen` is a variable, not a transition, state or command. "),
        (lambda s: s.explain("xyz"), "There is no transition, state or command `xyz`. There are: `full`, "),
        (lambda s: s.why_not("a"), "`a` is a state, not a transition. Ask `why` about it."),
        (lambda s: s.why_not("robot.move"), "`robot.move` is a command, not a transition. Ask `why` "),
        (lambda s: s.why("full"), "`full` is a transition, not a state or command. Ask `why_not` about it."),
        (
            lambda s: s.why("m"),
            "`m` is a machine, not a state or command. There are: `a`, `b`, ",
        ),
        (lambda s: s.why("move"), "There is no state or command `move`. Did you mean `robot.move`?"),
        (lambda s: s.why("robot.light.data"), "`robot` has no command `light.data`. There are: `move`"),
        (lambda s: s.pause_when("full"), '`full` is a transition, not a state. Pass `fires="full"`.'),
        (lambda s: s.pause_when(event="bump"), "There is no event `bump`. The program has no event."),
    ],
)
def test_a_name_of_something_else_is_told_with_what_to_do(ask, sentence):
    with session(LISTS, "sim", world="empty", namespace={"ask": len}) as live:
        live.run(1)
        with pytest.raises(UnknownElementError) as caught:
            ask(live)
        assert str(caught.value).startswith(sentence)


def test_an_answer_about_a_tick_before_an_edit_is_about_the_program_of_then():
    text = (
        "(var n := [0])(machine m (state a (running [n += 1])) (state b) (on [n > 50] a -> b go))(spawn m a)"
    )
    with session(text) as live:
        live.run(1)
        live.edit(text.replace("n > 50", "n > 70"))
        live.run(1)
        assert live.why_not("go", at=5).facts["decides"] == "n > 50"
        assert live.why_not("go").facts["decides"] == "n > 70"


def test_the_last_time_that_a_condition_was_true_is_found_in_another_state():
    text = """(var n := [0])
    (machine m
      (state a (running [n += 1])) (state b (running [n += 1]))
      (on [n == 3] b -> a never) (ontime 500 a -> b))
    (spawn m a)"""
    with session(text) as live:
        live.run(2)
        answer = live.why_not("never")
        assert answer.facts["last_true"] == 4
        assert "It was last true at 0.3 s, when `a` was active." in str(answer)


def test_a_moment_is_a_tick_or_a_time_for_every_question():
    with session(LISTS, namespace={"ask": len}) as live:
        live.run(1)
        for ask in (live.why_not, live.explain):
            assert ask("full", at=0.55) == ask("full", at=6) != ask("full", at=5)
        assert live.why("a", at=0.55) == live.why("a", at=6)
        assert live.at(0.55).tick == 6


@every(
    ("at", "sentence"),
    [
        ("x", "must be the number of a tick, or a time in seconds, not str."),
        (True, "must be the number of a tick, or a time in seconds, not bool."),
        (-0.5, "must be a time in seconds, 0 or more, not -0.5."),
        (float("nan"), "must be a time in seconds, 0 or more, not nan."),
    ],
)
def test_what_is_neither_a_tick_nor_a_time_is_refused(at, sentence):
    with session(LISTS, namespace={"ask": len}) as live:
        live.run(1)
        calls = (
            lambda: live.why_not("full", at=at),
            lambda: live.why("a", at=at),
            lambda: live.explain("full", at=at),
            lambda: live.at(at),
        )
        for call in calls:
            with pytest.raises((TypeError, ValueError)) as caught:
                call()
            assert str(caught.value).endswith(sentence)


def test_reading_the_past_leaves_the_session_as_it_was():
    with session(LISTS, namespace={"ask": len}, on_issue="record") as live:
        live.run(1)
        before = live.frame
        live.why_not("full", at=3), live.at(3), live.fork(3).close()
        assert live.frame.variables == before.variables
        live.rewind(5)
        assert live.frame.tick == 5


class Drawing(Bridge):
    """A robot with a velocity and a pen."""

    name = "drawing"
    hardware = False

    def open_interface(self) -> None:
        """Add a velocity and a pen."""
        self.add_method("move", lambda velocity: None, message=Twist, velocity=True)
        self.add_method("pen", lambda down=True: None)


@every(
    ("call", "told"),
    [
        ("robot.move(linear=0.2)", "`robot.move(linear=0.2)`"),
        ("robot.move(angular=-1)", "`robot.move(angular=-1.0)`"),
        ("robot.move()", "`robot.move(linear=0.0, angular=0.0)`"),
        ("robot.pen(False)", "`robot.pen(down=False)`"),
        ("robot.pen('no')", "`robot.pen(down='no')`"),
    ],
)
def test_a_command_is_told_as_a_program_writes_it(call, told):
    with session(f"(machine m (state a (onentry [{call}]))) (spawn m a)", Drawing()) as live:
        live.run(0.3)
        name = call.partition("(")[0]
        assert told in str(live.why(name))
        assert [each.text for each in live.timeline().happenings if each.kind == "command"] == [
            f"{told}, line 1."
        ]


def test_what_onresume_commands_is_not_ended_by_the_pause_before_it():
    state = "(state a (onentry [robot.move(linear=0.1)]))"
    text = f"(onresume [robot.move(linear=0.2)]) (machine m {state}) (spawn m a)"
    with session(text, Drawing()) as live:
        live.run(0.3)
        live.resume(), live.pause()
        assert live.why("robot.move").code == "stopped"
        live.run(0.2)
        assert (live.why("robot.move").code, live.why("robot.move").facts["block"]) == (
            "commanded",
            "onresume",
        )
        live.resume(), live.pause()
        assert live.why("robot.move").code == "stopped"


INNER = """(machine m
  (state a (onentry (spawn i x)) (machine i (state x) (state y) (on [True] x -> y go)))
  (state b)
  (ontime 300 a -> b))
(spawn m a)"""


def test_a_machine_whose_end_is_not_remembered_is_not_said_to_have_never_run():
    with session(INNER) as live:
        live.run(5)
        assert "It ended at" in str(live.why_not("go"))
    with session(INNER, journal=20) as live:
        live.run(5)
        first = live.frame.tick - 19
        assert f"`i` was not running. It has not been spawned since tick {first}." in str(live.why_not("go"))


def test_a_machine_that_waits_for_its_spawner_was_never_spawned():
    with session(INNER.replace("(spawn m a)", "(spawn m b)")) as live:
        live.run(1)
        assert "`i` was not running. It had never been spawned." in str(live.why_not("go"))


CLOCK = """(var then := [0]) (var seen := [[]])
(machine m
  (state a (running [import time; then = time.perf_counter(); seen.append(1)]))
  (state b)
  (on [len(seen) > 100] a -> b full))
(spawn m a)"""


def test_a_tick_that_cannot_be_repeated_has_an_answer_without_values():
    with session(CLOCK) as live:
        live.run(3)
        with pytest.raises(ValueError, match="cannot be repeated exactly: `then` had another value"):
            live.fork(10)
        answer = live.why_not("full", at=10)
        assert answer.code == "condition-false"
        assert "The values of its parts are not known: `seen` may have been changed in place." in str(answer)


def test_what_a_notebook_changed_later_does_not_change_an_answer():
    names = {"limit": 100}
    program = "(var n := [50])(machine m (state a)(state b)(on [n > limit] a -> b go))(spawn m a)"
    with session(program, namespace=names) as live:
        live.run(0.5)
        names["limit"] = 40
        answer = live.why_not("go", at=4)
        assert answer.facts["values"] == {"n": 50, "limit": 100}
        assert str(answer).endswith("It was never true before.")
        live.run(0.1)
        names["limit"] = 60
        for _ in range(2):
            assert live.why("b").facts["values"] == {"n": 50, "limit": 40}
            assert live.why_not("go", at=4).facts["values"] == {"n": 50, "limit": 100}
            live.run(1)


@every(
    ("condition", "told"),
    [
        ("not a", "`a` was True. The whole condition was never true before."),
        ("not n", "`n` was 3."),
        ("b or not (a and n == 3)", "`b or not (a and n == 3)` was False (`b` was False, `a` was True"),
        ("not (b or a)", "`a` was True."),
        ("a and not (n > 2)", "`n > 2` was True (`n` was 3). The whole condition was never true before."),
        ("not not b", "`b` was False."),
        ("a and n > 5", "`n > 5` was False (`n` was 3). The whole condition was never true before."),
        ("n > 5", "`n > 5` was False (`n` was 3). It was never true before."),
    ],
)
def test_the_part_that_decides_has_its_own_value_also_below_a_not(condition, told):
    text = f"""(var a := [True]) (var b := [False]) (var n := [3])
    (machine m (state s) (state t) (on [{condition}] s -> t go))
    (spawn m s)"""
    with session(text) as live:
        live.run(0.5)
        assert f"did not fire at 0.4 s: {told}" in str(live.why_not("go"))


def test_a_negation_that_fires_is_explained_by_what_was_false():
    with session(
        "(var a := [False]) (machine m (state s) (state t) (on [not a] s -> t go)) (spawn m s)"
    ) as live:
        live.run(0.5)
        assert str(live.why("t")).endswith("because `a` was False.")
        assert live.why_not("go", at=2).facts["decided"] == "False"


RENAMED = """(var n := [0])
(machine m
  (state a) (state b (running [n += 1]))
  (on [n == 0] a -> b go) (on [n > 50] b -> a back) (on [n > 60] b -> a later))
(spawn m a)"""


def test_a_state_that_was_renamed_was_entered_under_its_former_name():
    with session(RENAMED) as live:
        live.run(0.5)
        live.rename("state", "m/b", "busy")
        entered = "`busy` (then called `b`) was entered at 0.1 s by `go` (line 4), from `a`, because `n == 0`"
        assert str(live.why("busy")).startswith(entered), "before the next tick"
        live.run(0.5)
        live.rename("machine", "m", "mm")
        live.run(0.5)
        for at in (None, 4, 10):
            assert str(live.why("busy", at=at)).startswith(entered)
        assert live.why("b", at=4).code == "fired"
        assert "`mm` was in `busy`, entered at 0.1 s by `go` (line 4)" in str(live.why_not("go"))


def test_a_transition_that_was_renamed_is_answered_for_earlier_ticks():
    with session(RENAMED) as live:
        live.run(0.5)
        live.rename("transition", "m/back", "home")
        assert live.why_not("home").code == "condition-false"
        live.run(0.5)
        assert live.why_not("home", at=4).facts["decides"] == "n > 50"
        assert live.why_not("back", at=4).facts["decides"] == "n > 50"


TWINS = """(machine m
  (state a (onentry (spawn inner s)) (machine inner (state s) (on [False] s -> s one)))
  (state b (onentry (spawn inner s)) (machine inner (state s) (on [False] s -> s two)))
  (ontime 300 a -> b ab))
(spawn m a)"""


def test_machines_of_one_name_are_not_taken_for_each_other():
    with session(TWINS) as live:
        live.run(1)
        one, two = "m/a/inner/one", "m/b/inner/two"
        assert "It had never been spawned." in str(live.why_not(two, at=1))
        assert "`s` was entered in this very tick, when `inner` started." in str(live.why_not(two, at=4))
        assert "It ended at 0.3 s, because `ab` (line 4) left `a`." in str(live.why_not(one))


def test_a_restart_ends_a_machine_and_starts_one():
    with session(INNER) as live:
        live.run(0.2)
        live.edit(live.text.replace("(spawn m a)", "(spawn m b)"))
        live.run(0.2)
        ended = (
            "`i` was not running. It ended at 0.1 s, when the program restarted (`(spawn m a)` was changed"
        )
        assert ended in str(live.why_not("go"))
        live.reset()
        live.run(0.1)
        assert "`m` was spawned in `b` in this very tick, when the program restarted." in str(
            live.why_not("m/300:a->b")
        )


LEFT = """(machine m
  (state a (onentry (spawn i x) (spawn k p))
    (machine i (state x) (exit [True] x -> b leave))
    (machine k (state p) (on [False] p -> p go)))
  (state b))
(spawn m a)"""


def test_an_exit_ends_the_machines_of_the_state_that_it_takes_the_outer_machine_from():
    with session(LEFT) as live:
        live.run(0.3)
        assert "It ended at 0.1 s, because `leave` (line 3) left `a`." in str(live.why_not("go"))


def test_a_machine_that_ended_by_hand_was_ended_by_no_transition():
    with session(INNER) as live:
        live.run(0.2)
        live.transition_to("m/b")
        live.run(0.1)
        assert "It ended at 0.1 s, by hand." in str(live.why_not("go"))


BESIDE = "(machine m (state a) (state b)) (machine k (state c))\n(spawn m a)"


def test_what_an_edit_starts_was_neither_there_at_the_start_nor_started_by_hand():
    with session(BESIDE) as live:
        live.run(0.5)
        live.edit(live.text + "\n(spawn k c)")
        live.transition_to("m/b")
        added = "`c` was entered at 0.5 s because an edit added `(spawn k c)` (line 3)."
        assert str(live.why("c")) == added
        assert live.why("b").code == "forced"
        live.run(0.1)
        assert str(live.why("c")) == added


def test_a_state_was_entered_by_hand_when_its_timer_started():
    with session(BESIDE.replace("(state b)", "(state b) (on [False] a -> b go)")) as live:
        live.run(0.5)
        live.teleport_to("m/b")
        assert (str(live.why("b")), live.why("b").time) == (
            "`b` was entered at 0.5 s by hand (teleport), not by the program.",
            0.5,
        )
        live.run(0.1)
        assert "entered at 0.5 s by hand" in str(live.why_not("go"))
        assert "entered at 0.5 s by hand" in str(live.why("b"))


COUNTER = """(var n := [0])
(machine m
  (state s (running [n += 1]))
  (state t)
  (on [n == 8] t -> s go))
(spawn m s)"""


def test_the_last_time_that_a_condition_was_true_may_be_before_a_restart():
    with session(COUNTER) as live:
        live.run(1.2)
        live.reset()
        live.run(0.2)
        live.teleport_to("m/t")
        live.run(0.1)
        answer = live.why_not("go")
        assert (answer.facts["values"], answer.facts["last_true"]) == ({"n": 2}, 9)


PULSE = """(var n := [5])
(machine m (state a (onentry [n = 5])) (state b) (on [n == 5] a -> b go) (on [n > 9] b -> a back))
(machine other (state x (running [n = 0])))
(spawn m a) (spawn other x)"""


def test_a_condition_that_was_true_only_when_its_state_was_entered_was_true():
    with session(PULSE) as live:
        live.run(0.5)
        assert str(live.why_not("go")).endswith("It was last true at 0 s, when `a` was entered.")
        live.teleport_to("m/b")
        live.set_variable("n", 10)
        live.run(0.3)
        live.rename("state", "m/a", "begin")
        live.run(0.1)
        answer = live.why_not("go")
        assert str(answer).endswith("It was last true at 0.5 s, when `a` was entered.")
        assert "`go` was enabled, so `a` did not act." in str(
            live.why_not("go", at=answer.facts["last_true"])
        )
        live.edit(live.text.replace("n == 5", "n == 5.0"))
        live.run(0.1)
        assert "when `a` was entered" not in str(live.why_not("go"))


def test_what_is_inside_a_state_that_could_be_left_at_once_did_not_act_either():
    text = """(machine m
      (state a)
      (state b (onentry (spawn inner x))
        (machine inner (state x (onentry (spawn deep s)) (machine deep (state s)))))
      (state c)
      (ontime 200 a -> b)
      (on [True] b -> c go))
    (spawn m a)"""
    with session(text) as live:
        live.run(0.3)
        assert str(live.why("b")).endswith("`go` (line 7) could leave it at once, so it did not act.")
        for inside in ("x", "s"):
            assert str(live.why(inside)).endswith(
                "`go` (line 7) could leave `b` at once, so nothing in `b` acted."
            )


AGAIN = """(var delay := [400])
(machine m
  (state idle)
  (state out (onentry (spawn inner s))
    (machine inner
      (var n := [5])
      (state s (onentry [n = 0]) (running [n += 1]))
      (state t)
      (ontime delay s -> t)
      (on [n == 2] t -> s two)
      (on [n == 5] t -> s five)))
  (ontime 300 idle -> out)
  (ontime 600 out -> idle))
(spawn m idle)"""


def test_a_condition_is_looked_up_in_the_variables_of_the_machine_that_ran_then():
    with session(AGAIN) as live:
        live.run(0.9)
        assert live.why_not("two").facts["last_true"] == 6
        five = "`n == 5` was False (`n` was 4). It was never true before."
        assert str(live.why_not("five")).endswith(five), "though 5 was its first value, before any tick"
        live.set_variable("delay", 100)
        live.run(0.7)
        answer = live.why_not("two")
        assert (answer.facts["values"], answer.facts["last_true"]) == ({"n": 1}, 6)
        assert live.why_not("five").facts["last_true"] is None


def test_a_condition_is_followed_over_renames_of_what_it_reads():
    with session(AGAIN) as live:
        live.run(0.8)
        live.rename("variable", "m/out/inner/n", "count")
        live.rename("machine", "m/out/inner", "within")
        live.rename("state", "m/out/within/s", "begin")
        live.run(0.1)
        assert str(live.why_not("two")).endswith(
            "`count == 2` was False (`count` was 4). It was last true at 0.5 s, when `s` was active."
        )


def test_a_boolean_of_numpy_counts_as_the_last_time_that_a_condition_was_true():
    numbers = pytest.importorskip("numpy")
    with session(COUNTER.replace("[0]", "[number(0)]"), namespace={"number": numbers.float64}) as live:
        live.run(1.2)
        live.teleport_to("m/t")
        live.run(0.1)
        answer = str(live.why_not("go"))
        assert "`n == 8` was False" in answer
        assert "It was last true at 0.8 s, when `s` was active." in answer


@pytest.mark.parametrize("name", ["two", "m/600:out->idle", "idle"])
def test_the_journal_is_read_back_to_a_tick_once_for_an_answer(monkeypatch, name):
    read, state = [], History.state

    def counted(self, tick, **options):
        read.append((tick, options.get("before")))
        return state(self, tick, **options)

    monkeypatch.setattr(History, "state", counted)
    with session(AGAIN) as live:
        live.run(3)
        read.clear()
        live.explain(name, at=9)
    assert read
    assert len(read) == len(set(read))


def test_a_moment_in_a_question_is_a_tick_or_a_time_that_is_remembered():
    with session(COUNTER, journal=20) as live:
        live.run(4)
        for ask in (live.why_not, live.explain):
            assert ask("go", at=3.15).tick == ask("go", at=32).tick == 32
            for wrong in ("3", True, [1]):
                with pytest.raises(
                    TypeError, match="`at` must be the number of a tick, or a time in seconds, not "
                ):
                    ask("go", at=wrong)
            for wrong in (float("nan"), -0.5):
                with pytest.raises(ValueError, match="`at` must be a time in seconds, 0 or more, not"):
                    ask("go", at=wrong)
            with pytest.raises(ValueError, match=r"1.5 s is not remembered. Ask about 2 s or later."):
                ask("go", at=1.5)


@every(
    ("ask", "name", "told"),
    [
        ("why", "go", "`go` is a transition, not a state or command. Ask `why_not` about it."),
        ("why_not", "m/s", "`m/s` is a state, not a transition. Ask `why` about it."),
        ("explain", "m", "`m` is a machine, not a transition, state or command. There are: `go`, `s`, `t`."),
        ("explain", "n", "`n` is a variable, not a transition, state or command. There are: `go`, `s`"),
        ("explain", "goo", "There is no transition, state or command `goo`. Did you mean `go`?"),
    ],
)
def test_a_name_of_another_kind_is_not_offered_again(ask, name, told):
    with session(COUNTER) as live:
        live.run(1)
        with pytest.raises(UnknownElementError) as raised:
            getattr(live, ask)(name)
        assert str(raised.value).startswith(told)


def test_the_path_of_a_transition_may_be_a_list():
    with session(COUNTER) as live:
        live.run(1)
        assert live.why_not(["m", "go"]).code == "source-inactive"


DRIVING = """(machine m
  (state a (running [robot.move(linear=0.5)]))
  (state b)
  (ontime 500 a -> b))
(spawn m a)"""


def test_a_robot_that_was_disarmed_or_stopped_after_its_last_command_does_not_obey_it_any_more():
    with session(DRIVING, "sim", world="empty") as live:
        live.run(0.3)
        live.call(live.bridge.disarm)
        answer = live.why("robot.move")
        assert (answer.code, str(answer).partition(" Then ")[2]) == (
            "stopped",
            "the robot was stopped at 0.3 s. It is disarmed.",
        )
        assert live.why("robot.move", at=2).code == "commanded"
        live.call(live.bridge.arm)
        live.run(0.1)
        assert live.why("robot.move").code == "commanded"
        live.run(0.5)
        live.stop()
        assert "Then the robot was stopped at 0.9 s." in str(live.why("robot.move"))


def test_a_command_by_hand_was_given_by_no_block():
    with session(COUNTER, "sim", world="empty") as live:
        live.run(0.2)
        live.call(lambda: live.bridge.robot.move(linear=0.25))
        assert str(live.why("robot.move")).startswith(
            "The last command was `robot.move(linear=0.25)`, given by hand at 0.1 s."
        )


@every(
    ("running", "where"),
    [
        ("[n = 1; robot.move(0.1)]", "It appears in line 4."),
        ("[\n    if n:\n      robot.move(0.1)]", "It appears in line 6."),
        ("[n = 'robot.move'] # robot.move()", "It does not appear in the program."),
        ("[robot.mover(1)]", "It does not appear in the program."),
    ],
)
def test_a_command_that_was_not_given_is_looked_for_in_the_blocks(running, where):
    text = f"(var n := [0])\n(machine m\n  (state s)\n  (state t (running {running}\n)))\n(spawn m s)"
    with session(text, "sim", world="empty") as live:
        live.run(0.2)
        assert str(live.why("robot.move")) == f"`robot.move` has not been called. {where}"


def test_a_number_of_numpy_is_told_as_a_number():
    numbers = pytest.importorskip("numpy")
    text = """(var f := [numbers.float64(1) / 3]) (var yes := [numbers.bool_(True)])
    (machine m (state a) (state b) (on [f > 1] a -> b go) (on [not yes] a -> b no))
    (spawn m a)"""
    with session(text, namespace={"numbers": numbers}) as live:
        live.run(0.2)
        answer = live.why_not("go")
        assert "`f > 1` was False (`f` was 0.333333)." in str(answer)
        assert type(answer.facts["values"]["f"]) is float
        assert "`yes` was True." in str(live.why_not("no"))


@every(
    ("condition", "told"),
    [
        ("a and n > 2 and b is a or b", "`a and n > 2 and b is a or b` was False"),
        ("a and (b or n > 5 or not a)", "`b or n > 5 or not a` was False"),
        ("b or not (a and n)", "`b or not (a and n)` was False"),
        ("b or (a and (b or n == 1))", "`b or a and (b or n == 1)` was False"),
        ("not (b if b else a) or b", "`not (b if b else a) or b` was False"),
    ],
)
def test_the_part_that_decides_has_no_parentheses_that_it_does_not_need(condition, told):
    text = f"""(var a := [True]) (var b := [False]) (var n := [3])
    (machine m (state s) (state t) (on [{condition}] s -> t go))
    (spawn m s)"""
    with session(text) as live:
        live.run(0.2)
        assert told in str(live.why_not("go"))


WORDS = """(var s := ["x"])
(machine m
  (state a) (state b) (state c)
  (on [True] {b c d} -> a back)
  (on [False] *-{a b} -> c wild)
  (on [False] *-{a b} -> a twice)
  (ontime [s] a -> b late)
  (on [
    y = 1
    y > 1] a -> b long))
(spawn m a)"""


def test_answers_list_states_and_name_delays_as_one_writes_in_english():
    with session(WORDS) as live:
        live.run(0.2)
        assert "it leaves `b`, `c` or `d`, but `m` was in `a`" in str(live.why_not("back"))
        assert "it leaves a state other than `a`, `b` or `c`, but" in str(live.why_not("wild"))
        assert "it leaves a state other than `a` or `b`, but" in str(live.why_not("twice"))
        assert "its delay is `s`. A delay must be a number" in str(live.why_not("late"))
        assert "did not fire at 0.1 s: `y = 1 …` was False. The" in str(live.why_not("long"))


def test_a_state_that_was_not_entered_is_explained_by_an_exit_that_leads_to_it_too():
    with session(LEFT.replace("[True]", "[1 > 2]")) as live:
        live.run(0.3)
        assert str(live.why("b")) == (
            "`b` has not been entered. `leave` (line 3) did not fire at 0.2 s: `1 > 2` was False. "
            "It was never true before."
        )


def test_a_state_of_a_machine_that_does_not_run_needs_the_machine_first():
    with session(INNER.replace("(spawn m a)", "(spawn m b)")) as live:
        live.run(0.3)
        assert str(live.why("y")) == (
            "`y` has not been entered: `i` was not running. It had never been spawned. "
            "It is spawned when `a` is entered (line 2)."
        )


SHARED = """(machine i (state x) (on [False] x -> x go))
(machine m
  (state a (onentry (spawn i x)))
  (state b)
  (state c (onentry (spawn i x))))
(machine n (state a (onentry (spawn i x))) (state b))
(spawn m b)
(spawn n b)"""


def test_every_state_that_spawns_a_machine_that_does_not_run_is_named_so_that_it_is_known():
    with session(SHARED) as live:
        live.run(0.1)
        assert str(live.why_not("go")).endswith(
            "It is spawned when `m/a` is entered (line 3), when `c` is entered (line 5) "
            "or when `n/a` is entered (line 6)."
        )


def test_a_state_to_which_nothing_leads_is_said_to_be_one():
    with session(BESIDE) as live:
        live.run(0.3)
        assert str(live.why("b")) == "`b` has not been entered. No transition leads to it."


def test_a_state_that_was_entered_later_had_not_been_entered_by_then():
    with session(RENAMED.replace("n == 0", "n == 0 and 1 > 0")) as live:
        live.run(0.3)
        assert str(live.why("b", at=1)).startswith(
            "`b` had not been entered by 0 s: `m` was spawned in `a` in this"
        )
        live.edit(live.text.replace("(state a)", "(state a) (state c)"))
        live.run(0.1)
        had = "`c` had not been entered by 0.1 s. The program of tick 2 had no such state."
        assert str(live.why("c", at=2)) == had


def test_a_state_that_is_active_for_longer_than_is_remembered_was_entered():
    with session(BESIDE.replace("(state b)", "(state b) (ontime 300 a -> b)"), journal=20) as live:
        live.run(5)
        how = "How is unknown: only ticks from 31 onward are remembered."
        assert str(live.why("b")) == f"`b` was entered at 0.3 s. {how}"
        assert str(live.why("a")).startswith(
            "`a` has not been entered (only ticks from 31 onward are remembered)."
        )


def test_times_are_told_to_the_millisecond():
    text = "(machine m (state a) (state b) (ontime 60 a -> b) (on [False] b -> a back)) (spawn m a)"
    with session(text, rate=30) as live:
        live.run(0.2)
        told = "`b` was entered at 0.067 s by `60:a->b` (line 1), from `a`, 66.667 ms after `a` was entered."
        assert str(live.why("b")) == told
        assert str(live.why_not("back")).startswith("`back` (line 1) did not fire at 0.167 s: `False`")


def test_a_condition_that_was_true_before_it_was_the_condition_is_said_to_have_been():
    text = """(var n := [0])
    (machine m (state a (running [n += 1])) (state b) (on [n > 50] a -> b go))
    (spawn m a)"""
    with session(text) as live:
        live.run(0.6)
        live.edit(text.replace("n > 50", "n < 3"))
        live.run(0.2)
        edited = "It was last true at 0.2 s, before an edit made it the condition."
        assert str(live.why_not("go")).endswith(edited)
        live.rename("variable", "n", "count")
        live.run(0.1)
        assert str(live.why_not("go")).endswith(f"`count < 3` was False (`count` was 8). {edited}")


def test_how_long_a_condition_was_not_true_is_told_as_far_as_it_is_known(monkeypatch):
    with session(COUNTER, journal=20) as live:
        live.run(4)
        live.teleport_to("m/t")
        live.run(0.1)
        reason = live.why_not("go")
        assert str(reason).endswith("It was not true at any time still recorded (since 2.1 s).")
        assert (reason.facts["false_since"], "last_true" in reason.facts) == (22, False)
        monkeypatch.setattr(evaluation, "_SEARCH", 0.0)
        assert "true since" not in str(live.why_not("go"))


def test_a_time_that_is_still_to_come_is_refused():
    with session(COUNTER) as live:
        live.run(2)
        assert live.explain("go", at=2.0).tick == 20
        for ask in (live.at, lambda at: live.explain("go", at), lambda at: live.why("s", at)):
            with pytest.raises(ValueError, match=r"^99 s is later than the run, which is at 2 s\.$"):
                ask(99.0)


TASKS = """(machine courier
  (state going (running [robot.go(1)]))
  (state there)
  (on [robot.go.succeeded] going -> there ok)
  (on [robot.go.failed] going -> there bad)
  (on [robot.go.succeeded] there -> going again))
(spawn courier going)"""


def test_what_became_of_a_task_is_said_and_that_its_outcome_ends_with_the_state():
    bot = Courier()
    with session(TASKS, bot) as live:
        live.run(0.5)
        assert "`robot.go` had been under way since 0 s." in str(live.why_not("ok"))
        bot.next().update("aborted", reason="no path")
        live.run(0.5)
        fired = "because `robot.go.failed` was True. `robot.go` was aborted at 0.5 s: no path."
        assert str(live.why_not("bad", at=6)).endswith(fired)
        assert str(live.why("there")).endswith(fired)
        for answer in (live.why_not("again"), live.why("robot.go")):
            assert "`robot.go` was not asked for; until 0.5 s its outcome was `aborted`, which ended" in str(
                answer
            )

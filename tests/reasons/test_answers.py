"""What an answer says, and what it does not say: it never guesses."""

import pytest

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.message import Twist
from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session

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
        assert answer.facts["values"] == {"seen": "[1, 1, 1]", "len(seen)": 3}
        assert answer.facts["decides"] == "len(seen) > 100"
        assert len(live.frame.values["seen"]) == 19, "and this session has not noticed"
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
        with pytest.raises(UnknownElementError, match="no state `c`"):
            live.why("c")
        with pytest.raises(UnknownElementError, match="no command `mov`"):
            live.why("robot.mov")
        with pytest.raises(ValueError, match="ticks 1 to 10"):
            live.why_not("full", at=99)


@pytest.mark.parametrize(
    ("ask", "sentence"),
    [
        (lambda s: s.explain("seen"), "`seen` is a variable, not a transition, state or command. "),
        (lambda s: s.explain("xyz"), "There is no transition, state or command `xyz`. There are: `full`, "),
        (lambda s: s.why_not("a"), "`a` is a state, not a transition. Ask `why` about it."),
        (lambda s: s.why_not("robot.move"), "`robot.move` is a command, not a transition. Ask `why` "),
        (lambda s: s.why("full"), "`full` is a transition, not a state. Ask `why_not` about it."),
        (lambda s: s.why("m"), "`m` is a machine, not a state. There are: `a`, `b`."),
        (lambda s: s.why("move"), "There is no state `move`. Did you mean `robot.move`?"),
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
        assert answer.facts["last_true"] == 5
        assert "It was last true at 0.4 s, when `a` was active." in str(answer)


def test_a_moment_is_a_tick_or_a_time_for_every_question():
    with session(LISTS, namespace={"ask": len}) as live:
        live.run(1)
        for ask in (live.why_not, live.explain):
            assert ask("full", at=0.55) == ask("full", at=6) != ask("full", at=5)
        assert live.why("a", at=0.55) == live.why("a", at=6)
        assert live.at(0.55).tick == 6


@pytest.mark.parametrize(
    ("at", "sentence"),
    [
        ("x", "is the number of a tick, or a time in seconds, not str."),
        (True, "is the number of a tick, or a time in seconds, not bool."),
        (-0.5, "is a time in seconds of 0 or more, not -0.5."),
        (float("nan"), "is a time in seconds of 0 or more, not nan."),
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


@pytest.mark.parametrize(
    ("call", "told"),
    [
        ("robot.move(linear=0.2)", "`robot.move(linear=0.2)`"),
        ("robot.move(angular=-1)", "`robot.move(angular=-1.0)`"),
        ("robot.move()", "`robot.move(linear=0.0, angular=0.0)`"),
        ("robot.pen(False)", "`robot.pen(down=False)`"),
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
        assert f"`i` was not running. It was not spawned since tick {first}." in str(live.why_not("go"))


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

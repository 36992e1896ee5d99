"""The triggers of transitions, and their descriptions."""

from __future__ import annotations

from support.tables import every

from lrp_jupyter.interpreter.tree import _TESTS
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Block, Name
from lrp_jupyter.language.triggers import FORMS, Condition, Delay, Epsilon, Occurrence, Trigger

WRITTEN = [
    ("on hit", Occurrence(Name("hit")), "hit", "on"),
    ("on [ x > 1 ]", Condition(Block("x > 1")), "[x > 1]", "on"),
    ("ontime 100", Delay(100), "100 ms", "ontime"),
    ("ontime d", Delay(Name("d")), "after d", "ontime"),
    ("ontime [2 * d]", Delay(Block("2 * d")), "after [2 * d]", "ontime"),
    ("eps", Epsilon(), "ε", "eps"),
]


@every(("written", "trigger", "arrow", "style"), WRITTEN)
def test_a_trigger_is_read_shown_and_printed(written: str, trigger: Trigger, arrow: str, style: str) -> None:
    program = parse(f"(machine m (state a) (state b) ({written} a -> b)) (spawn m a)")
    (transition,) = program.machines[0].transitions
    assert transition.trigger == trigger
    assert (transition.arrow_text, transition.style, transition.kind) == (arrow, style, written.split()[0])
    assert parse(to_source(program)) == program


def test_an_arrow_tells_how_long_its_trigger_has_to_hold_and_that_there_is_an_effect() -> None:
    waits = {"2000": "2 s", "1500": "1500 ms", "d": "d", "[2 * d]": "[2 * d]"}
    for delay, shown in waits.items():
        program = parse(f"(machine m (on near for {delay} a -> b (effect [x = 1])))")
        assert program.machines[0].transitions[0].arrow_text == f"near for {shown} /"
    (after,) = parse("(machine m (ontime 2000 a -> b (effect [x = 1])))").machines[0].transitions
    assert after.arrow_text == "2000 ms /"


def test_an_exit_leads_outward_whatever_it_waits_for() -> None:
    program = parse("(machine m (exit hit a -> b) (exit [True] a -> b))")
    one, other = program.machines[0].transitions
    assert (one.trigger, other.trigger) == (Occurrence(Name("hit")), Condition(Block("True")))
    assert one.outward
    assert (one.kind, one.style, one.arrow_text) == ("exit", "exit", "hit")


def test_the_interpreter_can_test_every_kind_of_trigger() -> None:
    assert {trigger.__name__ for trigger in _TESTS} == {each.__name__ for each in Trigger.__subclasses__()}


def test_every_trigger_has_a_form() -> None:
    assert {trigger.keyword for trigger in Trigger.__subclasses__()} | {"exit"} == set(FORMS)

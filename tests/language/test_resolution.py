"""What the names of a program mean, by lexical scope."""

from __future__ import annotations

from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element
from lrp_jupyter.language.resolution import resolve

NESTED = """\
(var x := [1]) (event go [True])
(machine m
  (var x := [x + 1]) (var y := [x]) (event go [x])
  (state a (onentry [x] (spawn tool rest) (spawn n rest)) (machine n (state rest) (exit go rest -> b)))
  (state b)
  (on go a -> b) (ontime y b -> a) (on gone a -> b))
(machine tool (state rest) (on go rest -> away) (exit go rest -> b))
(spawn m a) (spawn gone a) (spawn tool gone)"""


def test_a_program_is_resolved_once() -> None:
    program = parse(NESTED)
    assert resolve(program) is resolve(program)


def test_an_initialiser_sees_the_scope_before_its_own_variable() -> None:
    names = resolve(parse(NESTED))
    machine = names.by_path["m",]
    seen = {path[-1]: dict(names.blocks[Element("variable", path)][0].visible) for path in MACHINE_VARIABLES}
    assert seen == {"x": {"x": names.top}, "y": {"x": machine}}


MACHINE_VARIABLES = [("m", "x"), ("m", "y")]


def test_an_event_and_the_variable_of_a_delay_are_found_in_the_nearest_scope() -> None:
    names = resolve(parse(NESTED))
    machine, tool = names.by_path["m",], names.by_path["tool",]
    assert [arrow.owner for arrow in names.arrows[machine]] == [machine, machine, None]
    assert [arrow.owner for arrow in names.arrows[tool]] == [names.top, names.top]
    assert [arrow.unresolved_trigger for arrow in names.arrows[machine]] == [
        None,
        None,
        ("unknown event", "There is no event `gone`."),
    ]


def test_an_exit_leads_into_every_machine_whose_states_spawn_its_own() -> None:
    names = resolve(parse(NESTED))
    machine = names.by_path["m",]
    homes = {arrow.scope.path: arrow.homes for arrows in names.arrows.values() for arrow in arrows[-1:]}
    assert homes[("m", "a", "n")] == homes[("tool",)] == (machine,)


def test_an_unresolved_spawn_has_a_reason() -> None:
    names = resolve(parse(NESTED))
    assert [spawning.unresolved for spawning in names.spawns] == [
        None,
        ("unknown machine", "There is no machine `gone` that can be spawned here."),
        ("unknown state", "The machine `tool` has no state `gone`."),
        None,
        None,
    ]
    assert {scope.path: starts for scope, starts in names.starts.items()} == {
        ("m",): ("a",),
        ("tool",): ("rest",),
        ("m", "a", "n"): ("rest",),
    }


def test_a_path_as_spawned_leads_to_the_machine_that_it_means() -> None:
    names = resolve(parse(NESTED))
    assert names.defined(("m", "a", "tool")) == ("tool",)
    assert names.defined(("m", "a", "n")) == ("m", "a", "n")
    assert names.defined(("gone", "a", "n")) == ("gone", "a", "n")


def test_of_two_definitions_of_a_name_the_first_counts() -> None:
    program = parse("(event e [1]) (event e [2]) (machine m (state a (machine n) (machine n)) (state a))")
    names = resolve(program)
    assert names.top.event("e") is program.events[0]
    assert [str(repeat.element) for repeat in names.repeats] == [
        "event `e`",
        "state `m/a`",
        "machine `m/a/n`",
    ]

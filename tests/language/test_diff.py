"""What an edit changes, by meaning."""

from __future__ import annotations

from collections.abc import Sequence

from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.language.diff import ChangeSet, diff
from lrp_jupyter.language.program import (
    Block,
    Element,
    Event,
    Machine,
    Name,
    Program,
    Spawn,
    State,
    Transition,
    Variable,
)
from lrp_jupyter.language.triggers import Condition, Delay, Epsilon, Occurrence


def var(name: str, text: str = "1") -> Variable:
    return Variable(Name(name), Block(text))


def event(name: str, text: str = "True") -> Event:
    return Event(Name(name), Block(text))


def on(trigger: str, source: str, destination: str, name: str | None = None) -> Transition:
    return Transition(
        Occurrence(Name(trigger)), (Name(source),), False, Name(destination), name and Name(name)
    )


def machine(name: str = "m", **parts: Sequence[object]) -> Machine:
    return Machine(Name(name), **{kind: tuple(items) for kind, items in parts.items()})  # type: ignore[arg-type]


def state(name: str, **parts: Sequence[object]) -> State:
    return State(Name(name), **{kind: tuple(items) for kind, items in parts.items()})  # type: ignore[arg-type]


def program(*machines: Machine, **parts: Sequence[object]) -> Program:
    return Program(machines=machines, **{kind: tuple(items) for kind, items in parts.items()})  # type: ignore[arg-type]


def with_transitions(*transitions: Transition) -> Program:
    return program(machine(transitions=transitions))


def with_states(*states: State) -> Program:
    return program(machine(states=states))


def element(kind: str, *path: str) -> tuple[Element, ...]:
    return (Element(kind, path),)


def test_layout_and_comments_are_not_a_change() -> None:
    old = program(machine(states=[state("a", running=[Block("x = 1")])]))
    new = program(machine(states=[state("a", running=[Block("\n  x=1  # one\n")])]))
    assert diff(old, new) == ChangeSet()
    assert str(diff(old, new)) == "nothing changed"


def test_a_changed_action_is_an_element_under_its_state() -> None:
    old = program(machine(states=[state("a", running=[Block("x = 1")], onexit=[Block("y")])]))
    spawn = Spawn(Name("n"), Name("b"))
    new = program(machine(states=[state("a", running=[Block("x = 2")], onentry=[spawn])]))
    changes = diff(old, new)
    assert changes.changed == (
        Element("onentry", ("m", "a")),
        Element("running", ("m", "a")),
        Element("onexit", ("m", "a")),
    )
    assert not changes.added
    assert not changes.removed


def test_change_sets_read_as_sentences() -> None:
    old = program(machine("follower", states=[state("moving")]), onpause=[Block("1")])
    new = program(
        machine("follower", states=[state("moving", running=[Block("1")]), state("x")]),
        onresume=[Block("1")],
        onend=[Block("1")],
    )
    assert str(diff(old, new)) == (
        "`running` of `follower/moving` changed; `onpause` changed; `onresume` changed; `onend` changed; "
        "state `follower/x` added"
    )


def test_initialisers_and_conditions_are_content() -> None:
    old = program(variables=[var("v")], events=[event("e")])
    new = program(variables=[var("v", "2")], events=[event("e", "False")])
    assert diff(old, new) == ChangeSet(changed=(Element("variable", ("v",)), Element("event", ("e",))))


def test_of_an_addition_only_the_outermost_element_is_named() -> None:
    inner = machine("n", states=[state("b")], variables=[var("v")])
    changes = diff(with_states(state("a")), with_states(state("a", machines=[inner])))
    assert changes == ChangeSet(added=element("machine", "m", "a", "n"))


def test_changes_inside_a_nested_machine_have_its_path() -> None:
    def nested(text: str) -> Program:
        return program(machine(states=[state("a", machines=[machine("n", variables=[var("v", text)])])]))

    assert diff(nested("1"), nested("2")).changed == element("variable", "m", "a", "n", "v")


def test_a_renamed_state_is_removed_and_added() -> None:
    changes = diff(with_states(state("a")), with_states(state("b")))
    assert changes == ChangeSet(added=element("state", "m", "b"), removed=element("state", "m", "a"))


def test_a_variable_moved_to_another_machine_is_removed_and_added() -> None:
    changes = diff(program(machine(), variables=[var("v")]), program(machine(variables=[var("v")])))
    assert changes == ChangeSet(added=element("variable", "m", "v"), removed=element("variable", "v"))


def test_of_two_definitions_of_a_name_only_the_first_counts() -> None:
    old = program(machine(states=[state("a"), state("a", running=[Block("1")])]))
    assert not diff(old, with_states(state("a")))


def test_the_condition_is_content_of_a_transition() -> None:
    changes = diff(
        with_transitions(on("e", "a", "b", "t")),
        with_transitions(on("f", "a", "b", "t")),
    )
    assert changes == ChangeSet(changed=element("transition", "m", "t"))


def test_a_changed_nameless_transition_has_its_new_label() -> None:
    changes = diff(with_transitions(on("e", "a", "b")), with_transitions(on("f", "a", "b")))
    assert changes == ChangeSet(changed=element("transition", "m", "on:a->b"))
    assert str(changes) == "transition `m/f:a->b` changed"


def test_another_destination_is_another_transition() -> None:
    changes = diff(
        with_transitions(on("e", "a", "b", "t")),
        with_transitions(on("e", "a", "c", "t")),
    )
    assert changes == ChangeSet(
        added=element("transition", "m", "t"), removed=element("transition", "m", "t")
    )


def test_the_order_of_sources_means_nothing() -> None:
    def two(*sources: str) -> Program:
        names = tuple(map(Name, sources))
        return program(machine(transitions=[Transition(Occurrence(Name("e")), names, False, Name("c"))]))

    assert not diff(two("a", "b"), two("b", "a"))


def test_equal_transitions_are_distinguished_by_their_order() -> None:
    old = with_transitions(on("e", "a", "b", "t"), on("f", "a", "b", "t"))
    assert diff(old, with_transitions(on("e", "a", "b", "t"))).removed == (
        Element("transition", ("m", "t#2")),
    )


def test_as_few_transitions_as_possible_have_moved() -> None:
    names = [on("e", "a", "b", name) for name in "pqrst"]
    moved = diff(program(machine(transitions=names)), program(machine(transitions=names[1:] + names[:1])))
    assert moved == ChangeSet(moved=element("transition", "m", "p"))


def test_an_element_added_in_front_moves_none() -> None:
    old, new = program(variables=[var("b"), var("c")]), program(variables=[var("a"), var("b"), var("c")])
    assert diff(old, new) == ChangeSet(added=element("variable", "a"))


def test_variables_move_too_since_they_are_initialised_in_order() -> None:
    old, new = program(variables=[var("a"), var("b")]), program(variables=[var("b"), var("a")])
    assert len(diff(old, new).moved) == 1


def test_the_order_of_states_events_and_machines_means_nothing() -> None:
    parts = {"states": [state("a"), state("b")], "events": [event("e"), event("f")]}
    swapped = {kind: items[::-1] for kind, items in parts.items()}
    old, new = program(machine(**parts), machine("n")), program(machine("n"), machine(**swapped))
    assert not diff(old, new)


def test_top_level_spawns_are_a_set() -> None:
    one, two = Spawn(Name("m"), Name("a")), Spawn(Name("n"), Name("b"))
    assert not diff(program(spawns=[one, two, one]), program(spawns=[two, one]))
    assert diff(program(spawns=[one]), program(spawns=[two])) == ChangeSet(
        added=element("spawn", "n", "b"), removed=element("spawn", "m", "a")
    )


names = st.sampled_from("abc")
blocks = st.builds(Block, st.sampled_from(["1", "2", " 1", "x = 1"]))


def some(part: st.SearchStrategy[object], size: int = 2) -> st.SearchStrategy[tuple[object, ...]]:
    return st.lists(part, max_size=size).map(tuple)


a_name = st.builds(Name, names)
variables = st.builds(Variable, a_name, blocks)
events = st.builds(Event, a_name, blocks)
transitions = st.builds(
    Transition,
    st.builds(Occurrence, a_name)
    | st.builds(Condition, blocks)
    | st.builds(Delay, a_name | blocks | st.integers(0, 2))
    | st.builds(Epsilon),
    some(a_name),
    st.booleans(),
    a_name,
    st.none() | a_name,
    st.booleans(),
).filter(lambda transition: transition.wildcard or transition.sources)
spawns = st.builds(Spawn, a_name, a_name)


actions = some(blocks, 1)


def machines(nested: st.SearchStrategy[tuple[object, ...]]) -> st.SearchStrategy[object]:
    states = st.builds(State, a_name, some(blocks | spawns), actions, actions, nested)
    return st.builds(Machine, a_name, some(variables), some(events), some(states), some(transitions))


nested = some(machines(st.just(())))
programs = st.builds(
    Program, some(variables), some(events, 1), some(machines(nested)), some(spawns), actions, actions
)


@given(programs, programs)
def test_what_one_way_adds_the_other_way_removes_each_element_once(a: Program, b: Program) -> None:
    assert not diff(a, a)
    there, back = diff(a, b), diff(b, a)
    assert set(there.added) == set(back.removed)
    assert set(there.removed) == set(back.added)
    assert len(there.changed) == len(back.changed)
    assert len(there.moved) == len(back.moved)
    assert bool(there) == bool(back)
    assert not (a == b and there)
    for elements in (there.added, there.removed, there.changed, there.moved):
        assert len(set(elements)) == len(elements)
    assert not set(there.added) & set(there.changed + there.moved)

"""Acts on a state graph: each changes the program by just what it means, and the text nowhere else."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from programs import blocks, events, names, some, spawns, transitions, variables
from support.tables import every

from lrp_jupyter import programs as bundled
from lrp_jupyter.errors import LRPError, edited
from lrp_jupyter.language.edits import drawing, nesting
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import (
    Block,
    Machine,
    Name,
    Path,
    Program,
    State,
    Transition,
    Variable,
)
from lrp_jupyter.language.reading.tokens import tokenize
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.triggers import Condition, Delay, Epsilon, Occurrence

GAPS = [" ", "\n", "\r\n  ", "\n\t", " ; a comment ) of (state a)\n", "\n\n # [another\n      ", "   "]


def least(strategy: st.SearchStrategy[Any], size: int) -> st.SearchStrategy[tuple[Any, ...]]:
    return st.lists(strategy, min_size=size, max_size=3).map(tuple)


def machine_of(states: st.SearchStrategy[State]) -> st.SearchStrategy[Machine]:
    arrows = least(transitions(), 1)
    return st.builds(Machine, names, some(variables), some(events), least(states, 2), arrows)


def state_of(machines: st.SearchStrategy[Machine]) -> st.SearchStrategy[State]:
    return st.builds(State, names, some(blocks | spawns), some(blocks, 1), some(blocks, 1), some(machines, 1))


machines = st.recursive(
    machine_of(st.builds(State, names, some(blocks | spawns))),
    lambda inner: machine_of(state_of(inner)),
    max_leaves=3,
)
programs = st.builds(Program, some(variables), some(events), least(machines, 1), some(spawns), some(blocks))


@st.composite
def texts(draw: st.DrawFn) -> str:
    """A program's text with any white space and comments between its tokens."""
    source = to_source(draw(programs))
    tokens = tokenize(source)
    gaps = Random(draw(st.integers(0, 999))).choices(GAPS, k=len(tokens) + 1)
    parts = [gap + source[start:end] for gap, (_, start, end) in zip(gaps, tokens, strict=False)]
    return "".join(parts) + gaps[-1]


Place = tuple[Path, Machine]


def machines_of(program: Program) -> list[Place]:
    """Every machine that a path leads to: of equal paths the first."""
    found: dict[Path, Machine] = {}
    for path, machine in program.walk():
        found.setdefault(path, machine)
    by_path = resolve(program).by_path
    return [(path, scope.noun) for path in found if (scope := by_path.get(path)) and scope.noun]


def draw_machine(data: st.DataObject, program: Program, condition: Callable[[Machine], Any]) -> Place:
    found = [(path, machine) for path, machine in machines_of(program) if condition(machine)]
    assume(found)
    return data.draw(st.sampled_from(found))


def draw_state(data: st.DataObject, machine: Machine) -> str:
    return data.draw(st.sampled_from([str(state.name) for state in machine.states]))


def draw_transition(data: st.DataObject, program: Program) -> tuple[Path, Machine, int]:
    path, machine = draw_machine(data, program, lambda machine: machine.transitions)
    return path, machine, data.draw(st.integers(0, len(machine.transitions) - 1))


def changed(program: Program, old: Any, new: Any) -> Program:
    """The program with the element at a place of the text replaced, whatever is inside; by None: removed."""

    def within(items: tuple[Any, ...]) -> tuple[Any, ...]:
        found = (new if getattr(item, "span", None) == old.span else inside(item) for item in items)
        return tuple(item for item in found if item is not None)

    def inside(item: Any) -> Any:
        if isinstance(item, Program):
            return replace(item, machines=within(item.machines), spawns=within(item.spawns))
        if isinstance(item, Machine):
            return replace(item, states=within(item.states), transitions=within(item.transitions))
        if isinstance(item, State):
            return replace(item, onentry=within(item.onentry), machines=within(item.machines))
        return item

    return inside(program)


def comments(text: str) -> list[str]:
    """What is neither white space nor a token."""
    found, last = [], 0
    for _, start, end in [*tokenize(text), ("", len(text), len(text))]:
        found += [line.strip() for line in text[last:start].splitlines() if line.strip()]
        last = end
    return found


def applied(text: str, edits: list[Any]) -> str:
    """The text after edits, which lie in order and do not overlap."""
    assert all(one.end <= other.start for one, other in pairwise(edits))
    assert all(one.start < other.start for one, other in pairwise(edits))
    return edited(text, edits)


def after(act: Callable[..., Any], text: str, *arguments: object) -> str | None:
    """The text after an act, or None if it is refused."""
    try:
        edits = act(text, *arguments)
    except (ValueError, LRPError):
        return None
    return applied(text, edits)


def added(text: str, edits: list[Any]) -> bool:
    """Whether edits only add to a text, and leave every line end and comment."""
    return all(edit.start == edit.end for edit in edits) and comments(applied(text, edits)) == comments(text)


def transitions_plus(machine: Machine, *more: Transition) -> Machine:
    return replace(machine, transitions=(*machine.transitions, *more))


# -- laws ------------------------------------------------------------------------------------------------

Law = Callable[[str, st.DataObject], None]
LAWS: list[Law] = []


def law(law: Law) -> Law:
    """Add a law that holds of any text."""
    LAWS.append(law)
    return law


@law
def a_new_state_is_the_last_one_of_its_machine(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine = draw_machine(data, program, lambda machine: machine.states)
    edits = drawing.new_state(text, path, "fresh")
    assert added(text, edits)
    grown = replace(machine, states=(*machine.states, State(Name("fresh"))))
    assert parse(applied(text, edits)) == changed(program, machine, grown)


@law
def a_new_transition_is_the_last_one_of_its_machine(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine = draw_machine(data, program, lambda machine: machine.states)
    source, destination = draw_state(data, machine), draw_state(data, machine)
    trigger, written = data.draw(
        st.sampled_from([(Epsilon(), ""), (Delay(2500), "2.5 s"), (Occurrence(Name("bump")), "bump")])
    )
    edits = drawing.new_transition(text, path, source, destination, written)
    assert added(text, edits)
    new = Transition(trigger, (Name(source),), False, Name(destination))
    assert parse(applied(text, edits)) == changed(program, machine, transitions_plus(machine, new))


@law
def a_transition_to_nothing_makes_its_state(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine = draw_machine(data, program, lambda machine: machine.states)
    source = draw_state(data, machine)
    edits = drawing.new_transition(text, path, source, "fresh", "300")
    assert added(text, edits)
    new = Transition(Delay(300), (Name(source),), False, Name("fresh"))
    grown = replace(transitions_plus(machine, new), states=(*machine.states, State(Name("fresh"))))
    assert parse(applied(text, edits)) == changed(program, machine, grown)


@law
def deleting_a_transition_deletes_nothing_else(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine, index = draw_transition(data, program)
    old = machine.transitions[index]
    result = after(drawing.delete_transition, text, (*path, machine.ids[index]))
    if result is None:
        return
    assert parse(result) == changed(program, old, None)
    inside = comments(text[slice(*old.span)])
    assert sorted([*comments(result), *inside]) == sorted(comments(text))


@law
def deleting_a_state_deletes_its_transitions(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine = draw_machine(data, program, lambda machine: machine.states)
    name = draw_state(data, machine)
    result = after(drawing.delete_state, text, (*path, name))
    if result is None:
        return
    assert parse(result) == without_state(program, path, machine, name)
    kept = comments(result)
    assert all(kept.count(each) <= comments(text).count(each) for each in kept)


def without_state(program: Program, path: Path, machine: Machine, name: str) -> Program:
    names = resolve(program)
    scope = names.by_path[path]
    others = [str(state.name) for state in machine.states if state.name != name]
    expected = program
    for spawning in names.spawns:
        if spawning.machine is scope and spawning.noun.state == name:
            new = replace(spawning.noun, state=Name(others[0])) if others else None
            expected = changed(expected, spawning.noun, new)
    for arrows in names.arrows.values():
        for arrow in arrows:
            noun = arrow.noun
            left = tuple(source for source in noun.sources if source != name)
            if noun.destination == name and set(arrow.homes) == {scope}:
                expected = changed(expected, noun, None)
            elif arrow.scope is scope and left != noun.sources:
                gone = not left and not noun.wildcard
                expected = changed(expected, noun, None if gone else replace(noun, sources=left))
    state = next(state for state in machine.states if state.name == name)
    return changed(expected, state, None)


@law
def a_transition_gets_another_destination(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine, index = draw_transition(data, program)
    old = machine.transitions[index]
    name = draw_state(data, machine)
    result = after(drawing.retarget, text, (*path, machine.ids[index]), "destination", name)
    if result is None:
        return
    assert parse(result) == changed(program, old, replace(old, destination=Name(name)))
    assert len(result) - len(text) == len(name) - len(old.destination)


@law
def a_transition_gets_another_source(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine, index = draw_transition(data, program)
    old = machine.transitions[index]
    name = data.draw(st.sampled_from(["*", *(str(state.name) for state in machine.states)]))
    before = data.draw(st.sampled_from(old.sources or ("*",)))
    result = after(drawing.retarget, text, (*path, machine.ids[index]), "source", name, before)
    if result is None:
        return
    group = name != "*" and not old.wildcard and len(old.sources) > 1
    if not group:
        sources: tuple[str, ...] = () if name == "*" else (name,)
    elif name in old.sources and name != before:
        sources = tuple(source for source in old.sources if source != before)
    else:
        sources = tuple(name if source == before else source for source in old.sources)
    new = replace(old, sources=tuple(map(Name, sources)), wildcard=name == "*")
    assert parse(result) == changed(program, old, new)


@law
def a_reversed_transition_reversed_again_is_the_same_text(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine, index = draw_transition(data, program)
    old = machine.transitions[index]
    result = after(drawing.reverse, text, (*path, machine.ids[index]))
    if result is None:
        return
    new = replace(old, sources=(old.destination,), destination=old.sources[0])
    then = parse(result)
    assert then == changed(program, old, new)
    turned = resolve(then).by_path[path].noun
    assert turned is not None
    if not text[slice(*old.span)].count("{"):  # the brackets of a group with one name go
        assert applied(result, drawing.reverse(result, (*path, turned.ids[index]))) == text


@law
def a_transition_gets_another_trigger_a_time_to_hold_and_an_effect(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine, index = draw_transition(data, program)
    old = machine.transitions[index]
    bump, block, two = Occurrence(Name("bump")), parse("(var x := [y = 1])").variables[0].initial, Delay(2000)
    cases: list[tuple[Callable[..., Any], str, Transition]] = [
        (drawing.set_trigger, "on bump", replace(old, trigger=bump, hold=None)),
        (drawing.set_trigger, "x > 3 for 2 s", replace(old, trigger=Condition(Block("x > 3")), hold=two)),
        (drawing.set_hold, "2 s", replace(old, hold=two)),
        (drawing.set_hold, "", replace(old, hold=None)),
        (drawing.set_effect, "y = 1", replace(old, effect=(block,))),
        (drawing.set_effect, "[y = 1] [y = 1]", replace(old, effect=(block, block))),
        (drawing.set_effect, "", replace(old, effect=())),
    ]
    act, written, new = data.draw(st.sampled_from(cases))
    result = after(act, text, (*path, machine.ids[index]), written)
    if result is None:
        assert act is drawing.set_hold or old.outward
        return
    assert parse(result) == changed(program, old, new)


@law
def a_setting_is_added_changed_and_removed(text: str, data: st.DataObject) -> None:
    program = parse(text)
    first = {(each.spawner, each.noun.machine): each for each in reversed(resolve(program).spawns)}
    assume(first)
    spawning = data.draw(st.sampled_from([*first.values()]))
    old = spawning.noun
    name = data.draw(st.sampled_from(["fresh", *(str(setting.name) for setting in old.settings)]))
    edits = drawing.set_setting(text, spawning.spawner, str(old.machine), name, "1 + 1")
    changed_text = applied(text, edits)
    new = Variable(Name(name), Block("1 + 1"))
    at = next((index for index, each in enumerate(old.settings) if each.name == name), len(old.settings))
    assert parse(changed_text) == changed(
        program, old, replace(old, settings=(*old.settings[:at], new, *old.settings[at + 1 :]))
    )
    without = applied(
        changed_text, drawing.set_setting(changed_text, spawning.spawner, str(old.machine), name, "")
    )
    left = (*old.settings[:at], *old.settings[at + 1 :])
    assert parse(without) == changed(program, old, replace(old, settings=left))


@law
def a_new_form_is_the_last_one_of_its_kind(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine = draw_machine(data, program, lambda machine: machine.states)
    name = draw_state(data, machine)
    state = next(state for state in machine.states if state.name == name)
    event = parse("(event fresh [x > 1])").events[0]
    running = parse("(machine m (state s (running [\nif x:\n  y = 1])))").machines[0].states[0].running
    inside = Machine(Name("fresh"))
    cases: list[tuple[Path, str, object, object]] = [
        ((), "event fresh [x > 1]", program, replace(program, events=(*program.events, event))),
        (path, "(event fresh [x > 1])", machine, replace(machine, events=(*machine.events, event))),
        (
            (*path, name),
            "running [\nif x:\n  y = 1]",
            state,
            replace(state, running=(*state.running, *running)),
        ),
        ((*path, name), "machine fresh", state, replace(state, machines=(*state.machines, inside))),
    ]
    where, form, old, new = data.draw(st.sampled_from(cases))
    edits = drawing.new_form(text, where, form)
    assert added(text, edits)
    expected = new if old is program else changed(program, old, new)
    assert parse(applied(text, edits)) == expected


@law
def a_state_that_is_nested_and_unnested_is_as_before(text: str, data: st.DataObject) -> None:
    program = parse(text)
    path, machine = draw_machine(data, program, lambda machine: len(machine.states) > 1)
    name, into = draw_state(data, machine), draw_state(data, machine)
    if name == into:
        return
    state = resolve(program).by_path[path].states[name]
    target = resolve(program).by_path[path].states[into]
    result = after(nesting.nest, text, (*path, name), into)
    if result is None:
        return
    nested = parse(result)
    inner = str(target.machines[0].name) if target.machines else f"in_{into}"
    home = resolve(nested).by_path[(*path, into, inner)]
    assert home.noun is not None
    assert home.noun.states[-1] == state
    assert (
        name not in resolve(nested).by_path[path].states
        or [str(each.name) for each in machine.states].count(name) > 1
    )
    kept = comments(result)
    assert sorted(kept) == sorted(comments(text)) or name in text
    out = after(nesting.unnest, result, (*path, into, inner, name))
    if out is None:
        return
    back = parse(out)
    there = resolve(back).by_path[path].noun
    assert there is not None
    assert there.states[-1] == state


@pytest.mark.slow
@given(texts(), st.data())
def test_an_act_changes_just_what_it_means(text: str, data: st.DataObject) -> None:
    for each in LAWS:
        each(text, data)


# -- examples --------------------------------------------------------------------------------------------


def drawn(text: str, *acts: tuple[Any, ...]) -> str:
    for act, *arguments in acts:
        text = applied(text, act(text, *arguments))
    return text


def test_the_first_state_of_an_empty_program_makes_its_machine_and_spawn() -> None:
    assert drawn("", (drawing.new_state, (), "a")) == "(machine main\n  (state a))\n\n(spawn main a)\n"
    assert drawn("; note", (drawing.new_state, (), "a")).startswith("; note\n\n(machine main")


def test_the_first_state_is_the_start_of_the_machine_that_is_spawned_already() -> None:
    for text, machine, expected in (
        ("(spawn rover driving)", (), "(machine rover\n  (state a))\n\n(spawn rover a)"),
        ("(machine m)\n(spawn m x)", ("m",), "(machine m\n  (state a))\n(spawn m a)"),
        (
            "(machine m (state b (onentry (spawn in_b x)) (machine in_b)))",
            ("m", "b", "in_b"),
            "(machine m (state b (onentry (spawn in_b a)) (machine in_b (state a))))",
        ),
        (
            "(machine m (state b)) (spawn m b)",
            (),
            "(machine m (state b))\n\n(machine main\n  (state a)) (spawn m b)\n(spawn main a)\n",
        ),
    ):
        assert drawn(text, (drawing.new_state, machine, "a")) == expected


def test_crlf_comments_and_indentation_are_kept() -> None:
    text = "(machine m ; top\r\n\t(state a)   ; first\r\n\r\n\t; the end\r\n)\r\n(spawn m a)"
    text = drawn(text, (drawing.new_transition, ("m",), "a", "b", "bump"), (drawing.new_state, ("m",), "c"))
    assert text == (
        "(machine m ; top\r\n\t(state a)   ; first\r\n\t(state b)\r\n\t(state c)\r\n"
        "\t(on bump a -> b)\r\n\r\n\t; the end\r\n)\r\n(spawn m a)"
    )
    text = drawn(text, (drawing.delete_state, ("m", "b")), (drawing.delete_state, ("m", "c")))
    assert text == "(machine m ; top\r\n\t(state a)   ; first\r\n\r\n\t; the end\r\n)\r\n(spawn m a)"


def test_a_bracket_does_not_end_in_a_comment_when_the_last_form_is_removed() -> None:
    text = "(machine m (state a)\n  ; why\n  (eps a -> a t))"
    assert drawn(text, (drawing.delete_transition, ("m", "t"))) == "(machine m (state a)\n  ; why\n  )"


def test_forms_on_one_line_stay_on_it() -> None:
    text = "(machine m (state a) (state b) (eps a -> b)) (spawn m a)"
    acts = (drawing.new_state, ("m",), "c"), (drawing.new_transition, ("m",), "b", "c", "2 s")
    assert drawn(text, *acts) == (
        "(machine m (state a) (state b) (state c) (eps a -> b) (ontime 2000 b -> c)) (spawn m a)"
    )


@every(
    ("written", "form"),
    [
        ("", "(eps a -> a)"),
        ("eps", "(eps a -> a)"),
        ("300", "(ontime 300 a -> a)"),
        ("0.5 s", "(ontime 500 a -> a)"),
        ("300ms", "(ontime 300 a -> a)"),
        ("time", "(ontime time a -> a)"),
        ("ontime [time * 2]", "(ontime [time * 2] a -> a)"),
        ("ontime 2 s", "(ontime 2000 a -> a)"),
        ("bump", "(on bump a -> a)"),
        ("on", "(on on a -> a)"),
        ("[n > 1]", "(on [n > 1] a -> a)"),
        ("n > 1", "(on [n > 1] a -> a)"),
        ("[n] == [1]", "(on [[n] == [1]] a -> a)"),
        ("True", "(on [True] a -> a)"),
        ("robot.bumper.data", "(on [robot.bumper.data] a -> a)"),
    ],
)
def test_what_is_written_at_an_arrow_becomes_a_trigger(written: str, form: str) -> None:
    text = "(var time := [1]) (machine m (state a))"
    assert form in drawn(text, (drawing.new_transition, ("m",), "a", "a", written))


@every(
    ("act", "sentence"),
    [
        ((drawing.new_state, ("m",), "a"), "is taken by another state"),
        ((drawing.new_state, ("m",), "a b"), "is not a valid name"),
        ((drawing.new_state, ("m",), ""), "is not a valid name"),
        ((drawing.new_state, ("q",), "a"), "There is no machine `q`"),
        ((drawing.new_transition, ("m",), "a", "b", "bump a -> a) (on x"), "Unmatched"),
        ((drawing.new_transition, ("m",), "*", "b", ""), "eps"),
        ((drawing.new_transition, ("m",), "q", "b", ""), "There is no state `m/q`"),
        ((drawing.new_form, ("m", "a"), "event e [1]"), "event"),
        ((drawing.new_form, (), "var x := [1]) (var y := [2]"), "more than one form"),
        ((drawing.new_form, (), "var x := [1]) ; "), "ends with a comment"),
        ((drawing.new_form, ("m",), "event e [1] # x"), "ends with a comment"),
        ((drawing.new_form, ("m",), "(event e [1]"), "`(event e [1]` is not closed"),
        ((drawing.change_transition, ("m", "on:a->b"), "(state c)"), "is not a transition"),
        ((drawing.retarget, ("m", "on:a->b"), "destination", "q"), "There is no state `q`"),
        ((drawing.reverse, ("m", "on:*->a")), "cannot be reversed"),
        ((nesting.nest, ("m", "a"), "a"), "cannot be inside itself"),
        ((nesting.nest, ("m", "b"), "a"), "would lead from `a` into itself"),
        ((nesting.nest, ("m", "c"), "a"), "needs a condition"),
        ((nesting.unnest, ("m", "a")), "is not inside another state"),
    ],
)
def test_an_act_that_would_break_a_program_is_refused(act: tuple[Any, ...], sentence: str) -> None:
    text = (
        "(machine m (state a) (state b) (state c)"
        " (on bump a -> b) (on bump *-> a) (ontime 3 c -> b)) (spawn m a)"
    )
    with pytest.raises((ValueError, LRPError), match=re.escape(sentence)):
        drawn(text, act)


def test_a_nested_state_uses_an_exit_to_leave_and_is_entered_through_the_state_around_it() -> None:
    text = """\
(machine m
  (state a (running [x = '''
 as it is
''']))
  (state b)
  (state c)
  (on bump a -> c)   ; out
  (ontime 9 c -> a)
  (eps a -> a))
(spawn m a)
"""
    nested = drawn(text, (nesting.nest, ("m", "a"), "b"))
    assert (
        nested
        == """\
(machine m
  (state b
    (onentry (spawn in_b a))
    (machine in_b
      (state a (running [x = '''
 as it is
''']))
      (exit bump a -> c)
      (eps a -> a)))
  (state c)
  ; out
  (ontime 9 c -> b))
(spawn m b)
"""
    )


def test_a_second_state_joins_the_first_and_its_exit_to_it_becomes_a_transition() -> None:
    text = "(machine m (state t) (state a) (state b) (on go a -> b)) (spawn m t)"
    nested = drawn(text, (nesting.nest, ("m", "a"), "t"), (nesting.nest, ("m", "b"), "t"))
    assert parse(nested) == parse(
        "(machine m (state t (onentry (spawn in_t a))"
        " (machine in_t (state a) (state b) (on go a -> b)))) (spawn m t)"
    )


@every(
    "act",
    [
        (nesting.unnest, ("m", "t", "n", "a")),
        (nesting.nest, ("m", "s"), "t"),
    ],
)
def test_a_name_that_would_mean_something_else_is_refused(act: tuple[Any, ...]) -> None:
    text = (
        "(var n := [1]) (machine m (state t (machine n (var n := [2]) (state a (running [n = n + 1]))))"
        " (state s (running [n = n + 1])))"
    )
    with pytest.raises(ValueError, match="`n`"):
        drawn(text, act)


@every(
    ("use", "sentence"),
    [
        ("(on n.a t -> s)", "Line 2 asks whether `n` is in `a`. Change that first, then move `a`."),
        ("(event e [n.state in ('b', 'a')])", "Line 2 asks whether `n` is in `a`."),
    ],
)
def test_a_state_that_is_asked_for_stays_in_its_machine(use: str, sentence: str) -> None:
    text = (
        "(machine m (state t (onentry (spawn n a)) (machine n (var e := [1]) (state a) (state b)))"
        f" (state s)\n{use})"
    )
    for act in ((nesting.nest, ("m", "t", "n", "a"), "b"), (nesting.unnest, ("m", "t", "n", "a"))):
        with pytest.raises(ValueError, match=re.escape(sentence)):
            drawn(text, act)


@every("use", ["(running [y = here])", "(onentry (spawn n a))", "(running [n.state])"])
def test_an_event_or_a_machine_of_the_state_around_holds_a_state_there(use: str) -> None:
    text = (
        f"(machine m (state t (machine o (event here [1]) (state a {use}) (state b)) (machine n (state a))))"
    )
    with pytest.raises(ValueError, match=r"`a` uses `(n`, a machine|here`, an event) inside `t`"):
        drawn(text, (nesting.unnest, ("m", "t", "o", "a")))


@every(
    ("use", "inner", "sentence"),
    [
        ("(running [near])", "(var near := [1])", "`near` would mean the variable of `m/t/n`"),
        ("(running [near])", "(event near [1])", "`near` would mean the event of `m/t/n`"),
        ("(running [o.state])", "(var o := [1])", "`o` would mean the variable of `m/t/n`"),
    ],
)
def test_what_a_block_reads_is_not_hidden_by_a_move(use: str, inner: str, sentence: str) -> None:
    text = (
        "(event near [1]) (machine o (state x))"
        f" (machine m (state t (machine n {inner} (state b))) (state a {use}))"
    )
    with pytest.raises(ValueError, match=re.escape(sentence)):
        drawn(text, (nesting.nest, ("m", "a"), "t"))


def test_the_start_moves_to_another_state() -> None:
    text = "(machine m (state a) (state b)) (spawn m a)"
    assert drawn(text, (drawing.start_in, ("m", "b"))).endswith("(spawn m b)")
    assert drawn(text, (drawing.delete_state, ("m", "a"))).endswith("(spawn m b)")
    assert drawn("(machine m (state a))", (drawing.start_in, ("m", "a"))).endswith("\n\n(spawn m a)\n")


@every(
    ("sources", "left"),
    [
        ("{a b}", "b"),
        ("{a b c}", "{b c}"),
        ("{b a c}", "{b c}"),
        ("{b c a}", "{b c}"),
        ("*-{a}", "*"),
        ("*-{a a}", "*"),
        ("*-{a b}", "*-{b}"),
        ("*-{b a c}", "*-{b c}"),
    ],
)
def test_a_deleted_state_is_taken_from_several_sources_or_exceptions(sources: str, left: str) -> None:
    text = "(machine m (state a) (state b) (state c) (state d) (ontime 5 SOURCES -> d go)) (spawn m b)"
    done = drawn(text.replace("SOURCES", sources), (drawing.delete_state, ("m", "a")))
    assert parse(done) == parse(text.replace("(state a) ", "").replace("SOURCES", left))


def test_deleting_a_machine_deletes_its_spawns() -> None:
    text = "(machine m (state t (onentry (spawn n a)) (machine n (state a)))) (spawn m t)"
    assert drawn(text, (drawing.delete_machine, ("m", "t", "n"))) == "(machine m (state t)) (spawn m t)"


def test_bundled_programs_are_drawn_on_without_a_change_elsewhere() -> None:
    text = bundled.load("stopwatch")
    done = drawn(text, (drawing.new_state, ("watch",), "set"), (drawing.delete_state, ("watch", "set")))
    assert done == text

"""What becomes of each element when an edit, or a rename, makes another program of a program."""

from __future__ import annotations

import pytest
from support.tables import every

from lrp_jupyter.language.diff import diff
from lrp_jupyter.language.edits.rename import rename
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element
from lrp_jupyter.language.successors import Successors, after_rename

BLINK = "(machine m (var d := [1]) (state on) (state off) {transitions}) (spawn m on)"


def transition(id_: str, *machine: str) -> Element:
    return Element("transition", (*(machine or ("m",)), id_))


def edit(old: str, new: str) -> Successors:
    return diff(parse(BLINK.format(transitions=old)), parse(BLINK.format(transitions=new))).successors


@every(
    ("old", "new", "id_"),
    [
        ("(ontime 100 on -> off)", "(ontime 300 on -> off)", "ontime:on->off"),
        ("(ontime 100 on -> off)", "(ontime d on -> off)", "ontime:on->off"),
        ("(on [d == 1] * -> off)", "(on go * -> off)", "on:*->off"),
        ("(eps {on off} -> on)", "(eps {on  off} -> on)", "eps:{on off}->on"),
        ("(on go on -> off t)", "(on stop on -> off t)", "t"),
    ],
)
def test_an_edit_of_its_trigger_keeps_a_transition(old: str, new: str, id_: str) -> None:
    assert edit(old, new).of(transition(id_)) == transition(id_)


def test_the_order_of_sources_is_not_part_of_a_transition() -> None:
    successors = edit("(eps {on off} -> on)", "(eps {off on} -> on)")
    assert successors.of(transition("eps:{on off}->on")) == transition("eps:{off on}->on")


def test_another_destination_makes_another_transition() -> None:
    assert edit("(eps on -> off)", "(eps on -> on)").of(transition("eps:on->off")) is None


def test_of_two_transitions_with_one_name_each_keeps_its_own() -> None:
    successors = edit("(eps on -> off t) (eps off -> on t)", "(eps off -> on t)")
    assert successors.of(transition("t")) is None
    assert successors.of(transition("t#2")) == transition("t")


def test_the_label_is_shown_and_is_not_part_of_the_identity() -> None:
    old = parse(BLINK.format(transitions="(ontime 100 on -> off)"))
    new = parse(BLINK.format(transitions="(ontime 300 on -> off)"))
    (element,) = diff(old, new).changed
    assert element == transition("ontime:on->off")
    assert str(element) == "transition `m/300:on->off`"
    assert {element: 1} == {transition("ontime:on->off"): 1}
    (kept,) = diff(old, new).successors.carry({old.machines[0].elements(("m",))[0]: 5})
    assert str(kept) == "transition `m/300:on->off`"


NESTED = (
    "(machine m (state a (onentry (spawn n x)) (machine n (state x) (exit [True] x -> b)))"
    " (state b) (on go a -> b) (eps {a b} -> a back)) (event go [True]) (spawn m a)"
)


def test_what_is_inside_a_renamed_state_moves_along() -> None:
    old = parse(NESTED)
    successors = after_rename(old, parse(rename(old, "state", ("m", "a"), "first")))
    kept = {
        Element("state", ("m", "a")): 1,
        Element("state", ("m", "a", "n", "x")): 2,
        Element("onentry", ("m", "a")): 3,
        Element("spawn", ("m", "a", "n")): 4,
        transition("on:a->b"): 5,
        transition("back"): 6,
        transition("exit:x->b", "m", "a", "n"): 7,
        Element("state", ("m", "b")): 8,
    }
    assert successors.carry(kept) == {
        Element("state", ("m", "first")): 1,
        Element("state", ("m", "first", "n", "x")): 2,
        Element("onentry", ("m", "first")): 3,
        Element("spawn", ("m", "first", "n")): 4,
        transition("on:first->b"): 5,
        transition("back"): 6,
        transition("exit:x->b", "m", "first", "n"): 7,
        Element("state", ("m", "b")): 8,
    }


def test_what_is_inside_a_machine_that_is_gone_is_gone() -> None:
    successors = diff(parse(NESTED), parse("(machine other (state a))")).successors
    assert successors.path("state", ("m", "b")) is None
    assert successors.path("state", ("m", "a", "n", "x")) is None


def test_a_typed_name_renames_everything_inside() -> None:
    old, new = parse(NESTED), parse(NESTED.replace("(state a", "(state first"))
    successors = diff(old, new).successors
    assert successors.path("state", ("m", "a")) is None
    assert successors.carry({Element("state", ("m", "a", "n", "x")): 1}) == {}
    assert successors.of(transition("on:a->b")) == transition("on:a->b")


def test_a_removed_variable_does_not_remove_a_state_of_the_same_name() -> None:
    old = parse("(machine m (var a := [1]) (state a (running [1])))")
    successors = diff(old, parse("(machine m (state a (running [1])))")).successors
    assert successors.path("variable", ("m", "a")) is None
    assert successors.path("state", ("m", "a")) == ("m", "a")
    assert successors.path("running", ("m", "a")) == ("m", "a")


def test_a_renamed_variable_is_shown_by_its_new_name_in_the_label_of_a_delay() -> None:
    old = parse(BLINK.format(transitions="(ontime d on -> off)"))
    successors = after_rename(old, parse(rename(old, "variable", ("m", "d"), "pause")))
    (kept,) = successors.carry({old.machines[0].elements(("m",))[0]: 5})
    assert str(kept) == "transition `m/pause:on->off`"


@every("id_", ["t", "t#2"])
def test_one_of_two_transitions_with_the_same_name_is_not_renamed(id_: str) -> None:
    program = parse("(machine m (eps on -> off t) (eps off -> on t))")
    with pytest.raises(ValueError, match="not the only one of this name"):
        rename(program, "transition", ("m", id_), "u")

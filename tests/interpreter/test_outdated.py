"""What was computed from a variable that was assigned by hand since is known; an edit computes it anew."""

from support.story import started

from lrp_jupyter.interpreter.variables import Outdated
from lrp_jupyter.language.parser import parse

TEXT = """(var most := [100])
(var half := [most / 2])
(machine m
  (state a
    (onentry (spawn look left))
    (machine look
      (var time := [most])
      (var other := [x = most; x + 1])
      (state left (running [most += 0])))))
(spawn m a)
"""
TIME, OTHER = ("m", "a", "look", "time"), ("m", "a", "look", "other")


def test_an_assignment_by_hand_leaves_what_was_computed_and_an_edit_computes_it_anew():
    i = started(TEXT, 3)
    assert i.outdated == {}
    i.set_variable("most", "200", 0.25)
    assert i.outdated == {
        ("half",): Outdated(("most",), 0.0, "most / 2"),
        TIME: Outdated(("most",), 0.0, "most"),
        OTHER: Outdated(("most",), 0.0, ""),
    }
    assert (i.variables[TIME], i.variables[OTHER], i.variables["half"]) == (100, 101, 50)
    i.set_variable(TIME, "most", 0.28)
    assert set(i.outdated) == {("half",), OTHER}
    i.rewind(0)
    assert (i.outdated, i.variables["most"]) == ({}, 100)
    i.step(0.3)
    assert i.outdated == {}
    i.set_variable("most", "200", 0.32)
    i.patch(parse(TEXT.replace("100", "300")), 0.35)
    assert (i.outdated, i.variables[TIME], i.variables["half"]) == ({}, 300, 150)


def test_what_is_assigned_and_computed_while_time_stands_still_is_told_apart_by_its_order():
    i = started(TEXT, 3)
    half = ("half",)
    for value in ("200", "300"):
        i.set_variable("most", value, 0.25)
        assert half in i.outdated
        i.set_variable(half, "most / 2", 0.25)
        assert half not in i.outdated
    i.patch(parse(TEXT.replace("100", "400")), 0.25)
    assert i.outdated == {}
    i.set_variable("most", "500", 0.25)
    assert half in i.outdated


def test_what_an_edit_computed_counts_no_longer_when_it_is_undone():
    i = started(TEXT, 3)
    i.patch(parse(TEXT.replace("100", "400")), 0.28)
    i.rewind(1)
    assert i.variables["half"] == 50
    i.assign("most", 200, 0.25)
    assert ("half",) in i.outdated


def test_a_machine_that_is_spawned_again_computes_its_variables_again():
    i = started(TEXT, 3)
    i.assign("most", 200, 0.25)
    i.transition_to("m/a", 0.28)
    assert set(i.outdated) == {("half",)}
    assert i.variables[TIME] == 200


def test_a_program_that_begins_again_has_nothing_that_is_outdated():
    i = started(TEXT, 3)
    i.assign("most", 200, 0.25)
    assert i.outdated
    i.reset(0.3)
    assert i.outdated == {}
    i.step(0.3)
    assert i.outdated == {}

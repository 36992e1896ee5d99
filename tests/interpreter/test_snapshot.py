"""A run that begins from a snapshot goes on as the run that it was taken of; neither notices the other."""

from threading import Lock
from types import SimpleNamespace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.story import started
from support.tables import every
from support.wild import command, moment, obey, program

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse

slow = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
REFUSED = (UnknownElementError, SyntaxError, NameError, ValueError)


def nested(value):
    """A list or a dict in which each value is in the one before."""
    for _ in range(5000):
        value = type(value)([("next", value)])
    return value


def copied(i, robot=None):
    copy = Interpreter(i.program, robot)
    copy.begin(i.snapshot())
    return copy


def followed(i, robot, orders):
    """What is seen after each order."""
    moments = []
    for order in orders:
        try:
            obey(i, robot, order)
        except REFUSED as error:
            moments.append(type(error))
        moments.append((*moment(i), i.tick, i.now, {path: c.times for path, c in i.visits.items()}))
    return moments


@pytest.mark.slow
@slow
@given(program, st.lists(command, max_size=20), st.lists(command, max_size=20))
def test_a_copy_goes_on_as_the_run_does(text, before, after):
    after = [order for order in after if order[0] != "rewind"]
    robots = SimpleNamespace(light=0), SimpleNamespace(light=0)
    i = Interpreter(parse(text), robots[0])
    followed(i, robots[0], before)
    robots[1].light = robots[0].light
    copy = copied(i, robots[1])
    present = moment(i)
    assert moment(copy) == present
    way = followed(copy, robots[1], after)
    assert moment(i) == present, "the run does not notice"
    assert followed(i, robots[0], after) == way


def test_a_list_is_copied_with_what_shares_it():
    i = started("(var a := [[1]])(var b := [(a,)])(machine m (state s (running [a.append(2)])))(spawn m s)")
    copy = copied(i)
    i.step(0.1)
    assert (i.variables["a"], copy.variables["a"]) == ([1, 2, 2], [1, 2])
    copy.step(0.1)
    copy.step(0.2)
    assert copy.variables["b"] == ([1, 2, 2, 2],)
    assert copy.variables["b"][0] is copy.variables["a"]
    assert i.variables["a"] == [1, 2, 2]


def test_a_function_writes_the_variables_of_its_own_run():
    i = started(
        """(var n := [0])(var f := [None])
        (machine m (state s
          (onentry [
            def f():
              nonlocal n
              n += 1])
          (running [f()])))
        (spawn m s)"""
    )
    copy = copied(i)
    for tick in (1, 2, 3):
        copy.step(tick / 10)
    assert (copy.variables["n"], i.variables["n"]) == (4, 1)
    copy.rewind(2)
    assert copy.variables["n"] == 2, "the copy of a variable that a function writes is compared, too"


def test_a_function_that_calls_itself_is_copied():
    i = started(
        """(var f := [
          def fac(k):
            return 1 if k == 0 else k * fac(k - 1)
          fac])(var n := [0])
        (machine m (state s (running [n = f(5)])))(spawn m s)"""
    )
    copy = copied(i)
    copy.step(0.1)
    assert copy.variables["n"] == 120


def test_what_cannot_be_copied_is_shared_and_named():
    i = started("(var g := [(k for k in 'abc')])(var n := [[]])(machine m (state s))(spawn m s)")
    snapshot = i.snapshot()
    assert snapshot.shared == ("generator",)
    copy = copied(i)
    assert copy.variables["g"] is i.variables["g"]
    assert copy.variables["n"] is not i.variables["n"]


class Odd:
    """Its reduction is not what Python asks for."""

    def __reduce_ex__(self, protocol):
        return (1,)


class Hostile:
    """Its parts cannot be read."""

    def __reduce_ex__(self, protocol):
        return Hostile, (), None, (1 / 0 for _ in "a")


def copied_with(value):
    """The value of `n` in a copy of a run in which it is this one, and in which `m` is copied."""
    i = started("(var n := [[]])(var m := [[]])(machine m (state s))(spawn m s)")
    i.assign(i.variables.path("n"), value, 0.0)
    copy = copied(i)
    assert copy.variables["m"] is not i.variables["m"]
    return copy.variables["n"]


@every("value", [Odd(), Hostile()])
def test_a_value_whose_copy_fails_is_shared_and_the_others_are_copied(value):
    assert copied_with(value) is value


@every("value", [nested([]), nested({})])
def test_a_value_nested_too_deeply_for_this_python_is_shared_and_any_other_is_copied(value):
    assert type(copied_with(value)) is type(value)


def test_what_refuses_to_be_copied_lets_nothing_be_read_twice():
    read = []

    class Copied:
        def __reduce_ex__(self, protocol):
            read.append(self)
            return list, ()

    i = started("(var n := [[]])(machine m (state s))(spawn m s)")
    i.assign(i.variables.path("n"), [each for _ in range(100) for each in (Copied(), Lock())], 0.0)
    assert i.snapshot().shared == ("lock",)
    assert len(read) == 100


def test_the_robot_is_that_of_the_copy():
    i = started("(var r := [robot])(machine m (state s (running [r.light])))(spawn m s)")
    other = SimpleNamespace(light=1)
    assert copied(i, other).variables["r"] is other


def test_one_snapshot_serves_many_runs():
    i = started("(var a := [[]])(machine m (state s (running [a.append(1)])))(spawn m s)", 2)
    snapshot = i.snapshot()
    i.step(0.2)
    for ticks in (1, 3):
        copy = Interpreter(i.program)
        copy.begin(snapshot)
        for tick in range(ticks):
            copy.step(0.3 + tick / 10)
        assert copy.variables["a"] == [1] * (2 + ticks)


def test_going_back_ends_at_the_snapshot():
    copy = copied(started("(machine m (state s))(spawn m s)", 5))
    copy.step(0.5)
    assert (copy.tick, copy.journal, list(copy.history.ticks)) == (6, 1, [6])
    copy.rewind(1)
    assert copy.tick == 5

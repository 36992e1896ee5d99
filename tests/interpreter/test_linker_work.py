"""The work of linking grows with the program, not with its square."""

import sys
import tracemalloc
from collections import Counter
from itertools import pairwise

from lrp_jupyter import parse
from lrp_jupyter.interpreter.linker import link


def chain(states: int) -> str:
    """Return a machine whose states follow each other by timeouts."""
    names = [f"s{i}" for i in range(states)]
    arrows = [f"(ontime 100 {a} -> {b})" for a, b in pairwise(names)]
    return f"(machine m {' '.join(f'(state {name})' for name in names)} {' '.join(arrows)}) (spawn m s0)"


def variables(count: int) -> str:
    """Return a program with as many variables, each of which reads the one before."""
    return "(var v0 := [0]) " + " ".join(f"(var v{i} := [v{i - 1}])" for i in range(1, count))


def calls(function, *arguments) -> int:
    """Count the calls of functions, of Python and of C, that a call makes: a measure without a clock."""
    counted = Counter()

    def count(frame, kind, detail):
        counted["call"] += kind in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        function(*arguments)
    finally:
        sys.setprofile(before)
    return counted["call"]


def memory(function, *arguments) -> int:
    """Return the bytes that a call has occupied at most."""
    tracemalloc.start()
    try:
        function(*arguments)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_a_machine_four_times_as_long_is_at_most_six_times_the_work():
    link(parse(chain(20)))  # imports
    short, long = parse(chain(100)), parse(chain(400))
    assert calls(link, long) < 6 * calls(link, short)


def test_four_times_as_many_variables_occupy_at_most_six_times_the_memory():
    link(parse(variables(800)))  # compiles the blocks, which are cached
    short, long = parse(variables(200)), parse(variables(800))
    assert memory(link, long) < 6 * memory(link, short)


def test_a_wildcard_and_a_named_source_leave_a_state_in_the_order_of_the_text():
    program = parse(
        "(machine m (state a) (state b) (state c)"
        " (ontime 1 {a b} -> c first) (ontime 2 *-{b} -> c second) (ontime 3 b -> a third)) (spawn m a)"
    )
    states = link(program).machines[("m",)].states
    leaving = {name: [edge.label for edge in state.edges] for name, state in states.items()}
    assert leaving == {"a": ["first", "second"], "b": ["first", "third"], "c": []}

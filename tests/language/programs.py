"""Programs for Hypothesis: any noun of the language, with blocks of any layout."""

from __future__ import annotations

from keyword import iskeyword
from typing import Any

from hypothesis import strategies as st

from lrp_jupyter.language.program import (
    Block,
    Event,
    Machine,
    Name,
    Program,
    Spawn,
    State,
    Transition,
    Variable,
)
from lrp_jupyter.language.triggers import Condition, Delay, Epsilon, InState, Occurrence, Trigger

NAMES = ["a", "b", "moving", "état", "end", "on", "for", "state", "x1", "_"]
VALUES = [
    "1",
    "a + b",
    " x ",
    "[1, [2]]",
    "'it\\'s ]'",
    'f"{a!r:>{b}} ]"',
    "(1,\n 2)",
    "# a comment ]\n  1 # and ] another\n",
    "'''\n ]\n   '''",
    "lambda x: x[0]",
    "a.state == 'b' and elapsed > dt",
    "moving.x1 or on",
    "x := 5 if a else 2",
]
ACTIONS = [
    "",
    "  # nothing ] yet\n",
    "a = 1\n b = 2",
    "\n    if a:\n        b = '''\n x'''\n    else:\n        pass\n  ",
    "for i in a:\r\n        print(i)\r\n        b = i\r\n",
    "def f():\n   nonlocal a\n   a = [1]\nf()",
    "a = 1; b = \\\n  2",
    "if a: b = 1\n\telif_ = 3".replace("elif_", "x"),
    "return [a\n,b]",
    "a.b = end(état)",
    "with a as b:\n\n  # deep\n    pass\n",
]
names = st.sampled_from(NAMES).map(Name)
values = st.sampled_from(VALUES[:-1]).map(Block)
blocks = st.sampled_from(VALUES[:-1] + ACTIONS).map(Block)


def some(strategy: st.SearchStrategy[Any], most: int = 3) -> st.SearchStrategy[tuple[Any, ...]]:
    return st.lists(strategy, max_size=most).map(tuple)


variables = st.builds(Variable, names.filter(lambda name: not iskeyword(name)), values)
events = st.builds(Event, names, values)
spawns = st.builds(Spawn, names, names, some(variables, 2))
triggers = st.builds(Occurrence, names) | st.builds(Condition, values) | st.builds(InState, names, names)
delays = st.builds(Delay, st.integers(0, 10**9) | names | values)


@st.composite
def transitions(draw: st.DrawFn) -> Transition:
    kind = draw(st.sampled_from(["on", "ontime", "eps", "exit"]))
    hold = None
    if kind == "ontime":
        trigger: Trigger = draw(delays)
    elif kind == "eps":
        trigger = Epsilon()
    else:
        trigger = draw(triggers)
        hold = draw(st.none() | delays)
    sources = draw(st.lists(names, min_size=1, max_size=1 if kind == "exit" else 3).map(tuple))
    wildcard = kind != "exit" and draw(st.booleans())
    if wildcard and kind != "eps" and draw(st.booleans()):
        sources = ()
    name, effect = draw(st.none() | names), draw(some(blocks, 2))
    return Transition(trigger, sources, wildcard, draw(names), name, kind == "exit", hold, effect)


def states(machines: st.SearchStrategy[Machine]) -> st.SearchStrategy[State]:
    return st.builds(State, names, some(blocks | spawns), some(blocks), some(blocks), some(machines, 2))


def machine_of(states: st.SearchStrategy[State]) -> st.SearchStrategy[Machine]:
    return st.builds(Machine, names, some(variables), some(events), some(states), some(transitions()))


machines = st.recursive(
    machine_of(st.builds(State, names, some(blocks | spawns), some(blocks), some(blocks))),
    lambda inner: machine_of(states(inner)),
    max_leaves=4,
)
programs = st.builds(
    Program, some(variables), some(events), some(machines, 2), some(spawns), some(blocks), some(blocks)
)

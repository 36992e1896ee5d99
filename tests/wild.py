"""Strategies for programs that run, edits of them, and commands: few names, so that they meet.

A program here runs and nests more often than not, and any of its names may dangle, be hidden or be
given twice.
"""

import re

from hypothesis import strategies as st

from lrp_jupyter.language.parser import parse, scan

STATES = ["a", "b", "c"]
MACHINES = ["m", "n", "o"]
ACTIONS = [
    "n += 1",
    "k = n",
    "n -= 1; k",
    "1 / (n % 2)",
    "nope",
    "x: int = n\nn = x + 1",
    "",
    "robot.light",
    "del k",
    "k += 1",
    "k = [k for n in range(3)]",
    "if n > 3: return\nn += 2",
    "def f():\n  nonlocal n\n  n += 1\nf()",
    "[(n := n + i) for i in range(2)]",
]
CONDITIONS = [
    "n > 2",
    "n % 2 == 0",
    "n % 3 == 1",
    "True",
    "False",
    "5",
    "robot.light == 1",
    "k > n",
    "nope",
    "n == k",
    "return n > 1",
    "n += 1; n > 4",
]
VALUES = ["0", "1", "n + 1", "nope", "[n]", "n", "return 2"]
DELAYS = ["0", "100", "250", "n", "k", "[n * 100]", "['x']", "[True]", "nope"]

state = st.sampled_from(STATES)
machine = st.sampled_from(MACHINES)
names = st.sampled_from(["", "", " t", " u"])


def block(texts):
    return st.sampled_from(texts).map(lambda text: f"[{text}]")


action = block(ACTIONS)
source = st.one_of(state, state, st.just("*"), st.just("*-{b}"), st.just("*-{c nope}"), st.just("{a c}"))
spawn = st.builds("(spawn {} {})".format, machine, state)
variable = st.builds("(var {} := {})".format, st.sampled_from(["n", "k"]), block(VALUES))
event = st.builds("(event {} {})".format, st.sampled_from(["e", "f"]), block(CONDITIONS))
condition = st.one_of(st.sampled_from(["e", "f", "nope"]), block(CONDITIONS), block(CONDITIONS))
transition = st.one_of(
    st.builds("(on {} {} -> {}{})".format, condition, source, state, names),
    st.builds("(ontime {} {} -> {}{})".format, st.sampled_from(DELAYS), source, state, names),
    st.builds("(eps {} -> {}{})".format, st.sampled_from([*STATES, "{a b}", "*-{a}"]), state, names),
)
exit_ = st.builds("(exit {} {} -> {}{})".format, condition, state, state, names)


@st.composite
def state_of(draw, name, depth):
    """A state; if it contains machines, it mostly spawns the first of them."""
    inner = [draw(machine_of(draw(machine), depth + 1)) for _ in range(draw(_HOW_MANY[depth]))]
    parts = [f"(onentry {draw(spawn)})" if f == "spawn" else f"({f} {draw(action)})" for f in draw(_FORMS)]
    spawns = [f"(onentry (spawn {text.split()[1]} {draw(state)}))" for text in inner if draw(_MOSTLY)]
    here = draw(st.integers(0, len(parts)))
    return f"(state {name} {' '.join([*parts[:here], *spawns, *parts[here:], *inner])})"


_MOSTLY = st.sampled_from([True] * 5 + [False])
_HOW_MANY = [st.sampled_from([0, 0, 1, 1, 2]), st.sampled_from([0, 0, 0, 1]), st.sampled_from([0] * 5 + [1])]
_HOW_MANY += [st.just(0)]
_FORMS = st.sampled_from(
    [
        (),
        ("running",),
        ("onentry",),
        ("onexit",),
        ("onentry", "running"),
        ("running", "running", "onexit"),
        ("onentry", "onentry", "running"),
        ("onentry", "onexit"),
        ("spawn", "running"),
    ]
)


_FEW = st.sampled_from([0, 0, 1])
_PRESENT = [st.sampled_from(["abc", "abc", "acb", "ab", "abca"]), st.sampled_from(["ab", "ba", "ac", "a"])]


@st.composite
def machine_of(draw, name, depth=0):
    """A machine with the state `a` and most of the others, the deeper the smaller."""
    present = draw(_PRESENT[min(depth, 1)])
    states = [draw(state_of(one, depth)) for one in present]
    arrows = transition if depth == 0 else st.one_of(transition, transition, exit_)
    parts = [
        *(draw(variable) for _ in range(draw(_FEW))),
        *(draw(event) for _ in range(draw(_FEW))),
        *(draw(arrows) for _ in range(draw(st.integers(1, 5 - depth)))),
    ]
    return f"(machine {name}\n  " + "\n  ".join([*parts, *states]) + ")"


@st.composite
def programs(draw):
    """A program that spawns `m`, and often more."""
    machines = [draw(machine_of("m")), *(draw(machine_of(n, 1)) for n in MACHINES[1:] if draw(st.booleans()))]
    parts = draw(st.permutations(machines))
    parts = [*draw(st.lists(variable, max_size=1)), *draw(st.lists(event, max_size=2)), *parts]
    parts += [f"(onpause {draw(action)})", f"(onresume {draw(action)})"] if draw(st.booleans()) else []
    spawns = [f"(spawn m {draw(st.sampled_from('aaab'))})", *draw(st.lists(spawn, max_size=2))]
    return "(var n := [0])(var k := [1])\n" + "\n".join([*parts, *draw(st.permutations(spawns))])


program = programs()
path = st.lists(st.sampled_from([*MACHINES, *STATES]), min_size=1, max_size=4).map(tuple)
place = st.tuples(machine, state) | st.tuples(machine, state, machine, state) | path
renaming = st.one_of(
    st.tuples(st.just("state"), place, st.sampled_from([*STATES, "d"])),
    st.tuples(st.just("machine"), st.tuples(machine), st.sampled_from([*MACHINES, "p"])),
    st.tuples(st.just("machine"), st.tuples(machine, state, machine), st.sampled_from([*MACHINES, "p"])),
    st.tuples(
        st.just("variable"), st.sampled_from([("n",), ("k",), ("m", "n")]), st.sampled_from(["n", "v"])
    ),
    st.tuples(st.just("event"), st.sampled_from([("e",), ("m", "e")]), st.sampled_from(["f", "g"])),
)
command = st.one_of(
    st.tuples(st.just("step"), st.integers(0, 3)),
    st.tuples(st.just("step"), st.integers(0, 3)),
    st.tuples(st.just("light"), st.sampled_from([0, 1])),
    st.tuples(st.just("patch"), program),
    st.tuples(st.just("change"), st.tuples(st.integers(0, 200), st.sampled_from(["n += 3", "n > 1", "d"]))),
    st.tuples(st.just("transition_to"), place),
    st.tuples(st.just("teleport_to"), place),
    st.tuples(st.just("set_variable"), st.tuples(path, st.sampled_from(["n", "k", "1", "nope", "("]))),
    st.tuples(st.just("rename"), renaming),
    st.tuples(st.just("reset"), st.none()),
    st.tuples(st.just("pause"), st.none()),
    st.tuples(st.just("resume"), st.none()),
    st.tuples(st.just("rewind"), st.integers(0, 4)),
)


BLOCK = re.compile(r"\[[^\[\]]*\]|\b[abc]\b")


def moment(i):
    return i.active, {path: value for path, value in i.variables.items() if not callable(value)}


def changed(text, number, new):
    """Put something else into one block, or another name in the place of a state's."""
    places = [m for m in BLOCK.finditer(text) if m[0].startswith("[") == (len(new) > 1)]
    if not places:
        return text
    place = places[number % len(places)]
    return text[: place.start()] + (f"[{new}]" if len(new) > 1 else new) + text[place.end() :]


def obey(i, robot, order):
    kind, argument = order
    if kind == "step":
        i.step(i.now + argument / 10)
    elif kind == "light":
        robot.light = argument
    elif kind == "patch":
        i.patch(parse(argument))
    elif kind == "change":
        program, _ = scan(changed(i.program.text, *argument))
        if program is not None:
            i.patch(program)
    elif kind in ("set_variable", "rename"):
        getattr(i, kind)(*argument)
    elif argument is None:
        getattr(i, kind)()
    else:
        getattr(i, kind)(argument)

"""Strategies for programs that run, edits of them, and commands: few names, so that they meet."""

from hypothesis import strategies as st

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
]
CONDITIONS = ["n > 2", "n % 2 == 0", "True", "False", "5", "robot.light == 1", "k > n", "nope", "n == k"]
VALUES = ["0", "1", "n + 1", "nope", "[n]", "n"]
DELAYS = ["0", "100", "250", "n", "k", "[n * 100]", "['x']", "[True]", "nope"]

state = st.sampled_from(STATES)
machine = st.sampled_from(MACHINES)
names = st.sampled_from(["", " t", " u"])


def block(texts):
    return st.sampled_from(texts).map(lambda text: f"[{text}]")


action = block(ACTIONS)
source = st.one_of(state, st.just("*"), st.just("*-{b}"), st.just("{a c}"))
spawn = st.builds("(spawn {} {})".format, machine, state)
variable = st.builds("(var {} := {})".format, st.sampled_from(["n", "k"]), block(VALUES))
event = st.builds("(event e {})".format, block(CONDITIONS))
condition = st.one_of(st.just("e"), st.just("nope"), block(CONDITIONS))
transition = st.one_of(
    st.builds("(on {} {} -> {}{})".format, condition, source, state, names),
    st.builds("(ontime {} {} -> {}{})".format, st.sampled_from(DELAYS), source, state, names),
    st.builds("(eps {} -> {}{})".format, state, state, names),
    st.builds("(exit {} {} -> {}{})".format, condition, state, state, names),
)


def states(machines):
    item = st.one_of(
        st.builds("(onentry {})".format, st.one_of(action, spawn)),
        st.builds("(running {})".format, action),
        st.builds("(onexit {})".format, action),
        machines,
    )
    return st.builds("(state {} {})".format, state, st.lists(item, max_size=4).map(" ".join))


def machine_of(inner):
    item = st.one_of(variable, event, states(inner), states(inner), transition, transition)
    return st.builds(
        "(machine {}\n  {})".format, machine, st.lists(item, min_size=2, max_size=9).map("\n  ".join)
    )


machines = st.recursive(
    st.builds("(machine {} (state a) (state b))".format, machine), machine_of, max_leaves=4
)
top = st.one_of(
    variable,
    event,
    machine_of(machines),
    machine_of(machines),
    spawn,
    st.builds("(onpause {})".format, action),
)
program = st.builds(
    "(var n := [0])(var k := [1])\n{}\n(spawn m a)".format,
    st.lists(top, min_size=1, max_size=5).map("\n".join),
)

path = st.lists(st.sampled_from([*MACHINES, *STATES]), min_size=1, max_size=4).map(tuple)
command = st.one_of(
    st.tuples(st.just("step"), st.integers(0, 3)),
    st.tuples(st.just("step"), st.integers(0, 3)),
    st.tuples(st.just("light"), st.sampled_from([0, 1])),
    st.tuples(st.just("patch"), program),
    st.tuples(st.just("transition_to"), path),
    st.tuples(st.just("teleport_to"), path),
    st.tuples(st.just("set_variable"), st.tuples(path, st.sampled_from(["n", "k", "1", "nope", "("]))),
    st.tuples(st.just("reset"), st.none()),
    st.tuples(st.just("pause"), st.none()),
    st.tuples(st.just("resume"), st.none()),
    st.tuples(st.just("rewind"), st.integers(0, 4)),
)

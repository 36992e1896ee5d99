"""Strategies for programs that run, edits of them, and commands: few names, so that they meet.

A program here runs and nests more often than not, and any of its names may dangle, be hidden or be
given twice. At the end come programs for a robot, and hostile ones.
"""

import re

from hypothesis import strategies as st

from lrp_jupyter import programs as bundled
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
    "k = len([k for n in range(3)])",
    "if n > 3: return\nn += 2",
    "def f():\n  nonlocal n\n  n += 1\nf()",
    "[(n := n + i) for i in range(2)]",
    "n += f",
    "k = elapsed",
    "n += 1 + dt",
    "k = m.state",
    "n = o.n + 1",
    "def g(): return e, n.state, elapsed\nk = g()",
    "k = [e for e in (1, 2)] + [f for _ in (1, 2)]",
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
    "e",
    "not e and elapsed > 0.1",
    "elapsed >= 0.2",
    "m.state == 'a'",
    "n.state != 'b' and dt > 0",
    "o.k == n",
]
VALUES = ["0", "1", "n + 1", "nope", "[n]", "n", "return 2", "elapsed", "m.state", "[f, k]"]
DELAYS = ["0", "100", "250", "n", "k", "[n * 100]", "['x']", "[True]", "nope"]

state = st.sampled_from(STATES)
machine = st.sampled_from(MACHINES)
names = st.sampled_from(["", "", " t", " u"])


def block(texts):
    return st.sampled_from(texts).map(lambda text: f"[{text}]")


action = block(ACTIONS)
source = st.one_of(state, state, st.just("*"), st.just("*-{b}"), st.just("*-{c nope}"), st.just("{a c}"))
variable = st.builds("(var {} := {})".format, st.sampled_from(["n", "k"]), block(VALUES))
settings = st.lists(variable, max_size=2).map("".join) | st.just("")
spawn = st.builds("(spawn {} {}{})".format, machine, state, settings)
event = st.builds("(event {} {})".format, st.sampled_from(["e", "f"]), block(CONDITIONS))
condition = st.builds(
    "{}{}".format,
    st.one_of(
        st.sampled_from(["e", "f", "nope"]),
        st.builds("{}.{}".format, machine, state),
        block(CONDITIONS),
        block(CONDITIONS),
    ),
    st.sampled_from(["", "", " for 100", " for 200", " for [n * 100]", " for k", " for ['x']"]),
)
tail = st.builds("{}{}".format, names, st.just("") | st.just("") | action.map(" (effect {})".format))
transition = st.one_of(
    st.builds("(on {} {} -> {}{})".format, condition, source, state, tail),
    st.builds("(ontime {} {} -> {}{})".format, st.sampled_from(DELAYS), source, state, tail),
    st.builds("(eps {} -> {}{})".format, st.sampled_from([*STATES, "{a b}", "*-{a}"]), state, tail),
)
near = st.sampled_from("aabbc")
outcome = st.builds(
    "(on n.{}{} {} -> {}{})".format, near, st.sampled_from(["", "", " for 100"]), near, near, tail
)
exit_ = st.builds("(exit {} {} -> {}{})".format, condition, state, state, tail)


@st.composite
def state_of(draw, name, depth, uses=""):
    """A state; it mostly spawns the machines that it contains, and the one that it `uses`."""
    inner = [draw(machine_of(draw(machine), depth + 1)) for _ in range(draw(_HOW_MANY[depth]))]
    parts = [f"(onentry {draw(spawn)})" if f == "spawn" else f"({f} {draw(action)})" for f in draw(_FORMS)]
    spawned = [*(text.split()[1] for text in inner), *uses]
    spawns = [f"(onentry (spawn {one} {draw(state)}{draw(settings)}))" for one in spawned if draw(_MOSTLY)]
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
def machine_of(draw, name, depth=0, uses=""):
    """A machine with the state `a` and most of the others, the deeper the smaller."""
    present = draw(_PRESENT[min(depth, 1)])
    states = [draw(state_of(one, depth, uses)) for one in present]
    arrows = transition if depth == 0 else st.one_of(transition, transition, exit_)
    arrows = st.one_of(outcome, outcome, transition) if uses else arrows
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
    hooks = ("onpause", "onresume", "onend")
    parts += [f"({hook} {draw(action)})" for hook in hooks] if draw(st.booleans()) else []
    spawns = [f"(spawn m {draw(st.sampled_from('aaab'))})", *draw(st.lists(spawn, max_size=2))]
    return "(var n := [0])(var k := [1])\n" + "\n".join([*parts, *draw(st.permutations(spawns))])


@st.composite
def shared(draw):
    """A program with a machine that others use, each mostly in all its states."""
    own = draw(variable)
    part = draw(machine_of("n", 2)).replace("(machine n", f"(machine n {own}", 1)
    users = [draw(machine_of(name, 1, "n")) for name in draw(st.sampled_from(["m", "mo"]))]
    parts = draw(st.permutations([part, *users, draw(event)]))
    spawns = ["(spawn m a)(spawn o a)", *draw(st.lists(spawn, max_size=1))]
    return "(var n := [0])(var k := [1])\n" + "\n".join([*parts, *spawns])


program = programs() | shared()
path = st.lists(st.sampled_from([*MACHINES, *STATES]), min_size=1, max_size=4).map(tuple)
place = st.tuples(machine, state) | st.tuples(machine, state, machine, state) | path
arrow = st.sampled_from(["t", "u", "on:a->b", "eps:a->b", "ontime:b->c", "exit:a->b"])
renaming = st.one_of(
    st.tuples(st.just("state"), place, st.sampled_from([*STATES, "d"])),
    st.tuples(st.just("machine"), st.tuples(machine), st.sampled_from([*MACHINES, "p"])),
    st.tuples(st.just("machine"), st.tuples(machine, state, machine), st.sampled_from([*MACHINES, "p"])),
    st.tuples(
        st.just("variable"), st.sampled_from([("n",), ("k",), ("m", "n")]), st.sampled_from(["n", "v"])
    ),
    st.tuples(st.just("event"), st.sampled_from([("e",), ("m", "e")]), st.sampled_from(["f", "g"])),
)
change = st.tuples(st.integers(0, 200), st.sampled_from(["n += 3", "n > 1", "d"]))
command = st.one_of(
    st.tuples(st.just("step"), st.integers(0, 3)),
    st.tuples(st.just("step"), st.integers(0, 3)),
    st.tuples(st.just("light"), st.sampled_from([0, 1])),
    st.tuples(st.just("patch"), program),
    st.tuples(st.just("change"), change),
    st.tuples(st.just("transition_to"), place),
    st.tuples(st.just("teleport_to"), place),
    st.tuples(st.just("fire"), st.tuples(machine, arrow) | st.tuples(machine, state, machine, arrow)),
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


# -- of a session with a robot

BUNDLED = {name: bundled.load(name) for name in bundled.names()}
ROVING = """(var n := [0])
(var speed := [0.3])
(var seen := [[]])
(var bumps := [0])
(var count := [None])
(event dark [robot.light.data < 150])
(event bump [robot.bumper.data])
(machine m
  (var k := [n])
  (state drive
    (onentry [
      def count():
        nonlocal bumps
        bumps += 1])
    (running [robot.move(linear=speed, angular=0.2)] [n += 1]))
  (state turn
    (onentry [seen.append(robot.odom.x)] (spawn inner left) (spawn beat low))
    (running [robot.move(angular=1.5)])
    (onexit [robot.stop()])
    (machine inner
      (var own := [len(seen)])
      (state left (onentry [own += 1]))
      (state right (running [1 / (n % 4)]))
      (ontime 300 left -> right flip)
      (on [own > 3] right -> left)
      (exit [n % 11 == 0] right -> back out)))
  (state back (running [robot.drive_by(-0.3 * speed)]) (onexit [count()]))
  (on bump *-{back} -> back hit)
  (on dark drive -> turn dim (effect [robot.turn_by(speed)]))
  (on [robot.drive_by.succeeded] back -> drive backed)
  (on [robot.turn_by.failed and robot.turn_by.since > 0.2] turn -> drive)
  (on beat.high for 200 turn -> drive beaten (effect [n += beat.beats]))
  (ontime 900 turn -> drive again)
  (ontime [400 + n % 3] back -> turn away))
(machine watch
  (state idle)
  (state busy
    (running [n += gain + len(marks)] [robot.say(n // 20)])
    (onentry (spawn beat low (var every := [0.1 + speed]))))
  (on [n > 40] idle -> busy) (eps busy -> idle))
(machine beat
  (var every := [0.4])
  (var beats := [0])
  (state low (running [beats += 1]))
  (state high (onexit [beats = 0]))
  (on [elapsed >= every and not bump] low -> high)
  (ontime 300 high -> low))
(onpause [n += 100])
(onend [n += 1000] [robot.lamp(n > 1500)])
(spawn m drive)
(spawn watch idle)
"""
ROVING_EDITS = [
    ("n += 1", "n += 2"),
    ("n += 2", "n += 1"),
    ("0.2)]", "0.4)]"),
    ("900", "500"),
    ("500", "900"),
    ("< 150", "< 90"),
    ("(state idle)", "(state idle (running [speed]))"),
    ("[n]", "[n"),
    ("(spawn watch idle)", ""),
    ("every := [0.4]", "every := [0.2]"),
    ("0.1 + speed", "0.2 + speed"),
    ("for 200", "for [n]"),
    ("n += beat.beats", "n += 2 * beat.beats"),
    ("(eps busy -> idle)", "(ontime 200 busy -> idle)"),
    ("-0.3 * speed", "-0.9 * speed"),
    ("[robot.drive_by(-0.9 * speed)]", "[robot.drive_to(0.2, 0.1)]"),
    ("(running [robot.drive_by(", "(onentry [robot.drive_by("),
    ("(state back", "(state bac"),
    ("(state bac ", "(state back "),
]
somewhere = place | st.sampled_from(
    ["drive", "turn", "back", "m/turn/inner/right", "watch/busy", "a", "nope", ""]
)
variable_path = st.sampled_from(["n", "k", "m/k", "speed", "seen", "nope", ""])
expression = st.sampled_from(
    ["n + 7", "0", "len(seen)", "[n]", "None", "'x'", "nope", "(", "", "1 / 0", "-1"]
)
waited_for = st.one_of(
    st.tuples(st.just("entered"), somewhere),
    st.tuples(st.just("left"), somewhere),
    st.tuples(st.just("fires"), st.sampled_from(["t", "u", "hit", "dim", "again", "nope"])),
    st.tuples(st.just("event"), st.sampled_from(["e", "f", "dark", "bump"])),
    st.tuples(st.just("condition"), st.sampled_from(["n > 3", "n % 5 == 0", "robot.light", "nope", "("])),
)

# -- hostile

NASTY = [
    *("raise SystemExit", "raise BaseException", "raise GeneratorExit", "raise StopIteration", "exit()"),
    *("raise MemoryError", "raise RecursionError", "def f(): f()\nf()", "import sys; sys.exit(3)"),
    "raise type('E', (Exception,), {'__str__': lambda s: 1/0})",
    "raise type('E', (Exception,), {'__str__': lambda s: 5})",
    "raise type('E', (BaseException,), {'__new__': lambda *a: 1})",
    "raise ExceptionGroup('g', [ValueError(1)])",
    "raise ValueError('\\ud800 ' * 1000)",
    "print('x' * 10**6)",
    "print('\\x1b[2J\\x00\\ud800')",
    *("n = '\\ud800'", "n = bytearray(10**7)", "n = 10**5000", "n = []\nn.append(n)", "n = float('inf')"),
    "n = type('V', (), {'__repr__': lambda s: 1/0})()",
    "n = type('V', (), {'__repr__': lambda s: 5})()",
    "n = type('V', (), {'__repr__': lambda s: exit()})()",
    "n = type('V', (), {'__bool__': lambda s: 1/0})()",
    "n = type('V', (), {'__eq__': lambda s, o: 1/0, '__hash__': lambda s: 1/0})()",
    "n = type('V', (int,), {'__float__': lambda s: 1/0, '__repr__': lambda s: exit()})(3)",
    "n = type('V', (float,), {'__float__': lambda s: exit(), '__eq__': lambda s, o: 1/0})(3)",
    "n = type('V', (str,), {'__repr__': lambda s: 1/0, '__len__': lambda s: -1})('x')",
    "n = type('V', (), {'__class__': property(lambda s: 1/0)})()",
    "n = type('V', (), {'__getattribute__': lambda s, k: 1/0})()",
    "n = type('M', (type,), {'__repr__': lambda s: 1/0, '__instancecheck__': lambda s, o: 1/0})('V', (), {})",
    "n = type('V', (), {'__module__': 5, '__qualname__': '\\ud800'})()",
    *("n = (i for i in iter(int, 1))", "n = robot", "n = print", "n = lambda: n", "n = globals", "n = type"),
    "robot.move(linear=float('nan'), angular=float('inf'))",
    *("robot.move(linear='fast')", "robot.move(linear=10**400)", "robot.light = 5", "robot.__class__ = int"),
    *("del robot.move", "robot = 5", "print = 5", "del n", "assert n, n", "eval('1/0')", "n = vars()"),
    "import threading; threading.Thread(target=lambda: None).start()",
    "import sys; sys.stdout.write('x'); sys.stderr.write('')",
    "import warnings; warnings.warn('x')",
    *("async def f(): pass\nn = f()\nn.close()", "__import__('nope')", "locals().clear()"),
]
"""Blocks that end, somehow."""
_TWO = "(state b) (ontime 100 a -> b) (ontime 100 b -> a)"
FORMS = [
    f"(var n := [0])(machine m (state a (running [{{}}])) {_TWO})(spawn m a)",
    "(var n := [0])(machine m (state a (onentry [{}])) (state b (onexit [{}]))"
    " (eps a -> b) (ontime 100 b -> a))(spawn m a)",
    "(var n := [{}])(machine m (state a (running [n])) (state b) (on [n] a -> b))(spawn m a)",
    "(var n := [0])(event e [{}\nn])(machine m (state a) (state b) (on e a -> b t) (on [n > 1] *-> a))"
    "(spawn m a)",
    "(var n := [0])(machine m (state a (running [{}])) (state b) (ontime [n] a -> b) (ontime n b -> a))"
    "(spawn m a)",
    "(var n := [0])(onpause [{}])(onresume [{}])(onend [{}])(machine m (state a (running [n])))(spawn m a)",
    "(var n := [1])(machine m (state a (onentry (spawn o x)) (machine o (var k := [{}\nn])"
    " (state x (running [{}])) (exit [k] x -> b))) (state b) (ontime 50 b -> a))(spawn m a)",
]
WORDS = [
    *"()[]{}*;#\"'\\,.:=<>-",
    *("->", "*->", ":=", "=>", "[[", "]]", '"""', "\n", "\r\n", "\t", "  ", "\x00", "\ufeff", "\u2028"),
    *("machine", "state", "var", "event", "on", "eps", "ontime", "exit", "spawn", "running", "onentry"),
    *("onexit", "onpause", "onresume", "onend", "a", "b", "m", "n", "robot", "0", "1e999", "9" * 40, "µ"),
    *("μ", "ſ"),
    *("lambda", "while True: pass", "def f():", "return", "yield", "await x", "f'{", "0x", "\N{ROBOT FACE}"),
    *("import os", "nonlocal n", "global n", "del n", "\u202e", "\ud800", "ℌ", "\x0c", "1_0", "1__0", "→"),
]

hostile = st.builds(
    lambda form, block: form.replace("{}", block.replace("\n", "\n  ")),
    st.sampled_from(FORMS),
    st.sampled_from(NASTY),
)


@st.composite
def damages(draw):
    """A program with pieces put in or taken out, or words in a row."""
    text = draw(st.sampled_from([ROVING, *BUNDLED.values(), ""]) | hostile)
    for _ in range(draw(st.integers(1, 5))):
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.sampled_from([0, 0, 1, 2, 5, 30])))
        other = draw(st.integers(0, len(text)))
        piece = draw(st.sampled_from(["", *WORDS, text[other : other + 40]]))
        text = text[:start] + piece + text[end:]
    return text


damaged = damages() | st.lists(st.sampled_from(WORDS), max_size=60).map("".join)
text = st.sampled_from([ROVING, *BUNDLED.values()]) | program

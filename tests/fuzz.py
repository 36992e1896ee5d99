"""A fuzzer: random texts, and random edits and commands on a running session, hostile blocks included.

``python tests/fuzz.py --texts 20000 --edits 10000 --seed 1`` prints what it did and the slowest calls; a
violation ends it with the line that repeats it. Tests run a short one.

Nothing may escape but the documented exceptions; no call may last longer than three seconds; a session
must go on after whatever was typed.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from time import perf_counter
from typing import Any

import lrp_jupyter
from lrp_jupyter.errors import LRPError
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.parser import scan
from lrp_jupyter.live.session import Session

LONGEST = 3.0
"""Wall seconds that a call may last."""
PROGRAMS = [
    path.read_text(encoding="utf-8")
    for path in sorted((Path(lrp_jupyter.__file__).parent / "programs").glob("*.lrp"))
]
HARMLESS = """
(var n := [0])
(machine m (state a (running [n += 1])) (state b) (ontime 100 a -> b) (ontime 100 b -> a))
(spawn m a)
"""
WORDS = [
    *"()[]{}*;#\"'\\,.:=<>-",
    *("->", "*->", ":=", "=>", "[[", "]]", '"""', "\n", "\r\n", "\t", " ", "  ", "\x00", "\ufeff", "\u2028"),
    *("machine", "state", "var", "event", "on", "eps", "ontime", "exit", "spawn", "running", "onentry"),
    *("onexit", "onpause", "onresume", "a", "b", "m", "n", "robot", "0", "1e999", "9" * 40, "µ", "μ", "ſ"),
    *("lambda", "while True: pass", "def f():", "return", "yield", "await x", "f'{", "0x", "\N{ROBOT FACE}"),
    *("import os", "nonlocal n", "global n", "del n", "\u202e", "\ud800", "ℌ", "\x0c", "1_0", "1__0", "→"),
]

HANGING = [
    "while True: pass",
    "while True:\n  try:\n    while True: pass\n  except BaseException: pass",
    "while True:\n  try: pass\n  finally: continue",
    "n = sum(1 for _ in iter(int, 1))",
    "def f():\n  while True: yield 1\nfor _ in f(): pass",
    "while not robot.bumper.data: pass",
    "while True: print(1)",
    "n = max(n for n in iter(int, 1))",
]
"""Blocks that do not return, and can be interrupted: not inside one call of C."""
NASTY = [
    "raise SystemExit",
    "raise KeyboardInterrupt",
    "raise BaseException",
    "raise GeneratorExit",
    "raise type('E', (BaseException,), {})",
    "raise type('E', (Exception,), {'__str__': lambda s: 1/0})",
    "raise type('E', (Exception,), {'__str__': lambda s: 5})",
    "raise type('E', (BaseException,), {'__new__': lambda *a: 1})",
    "raise ExceptionGroup('g', [ValueError(1)])",
    "raise StopIteration",
    "raise MemoryError",
    "raise RecursionError",
    "def f(): f()\nf()",
    "exit()",
    "quit()",
    "import sys; sys.exit(3)",
    "n = '\\ud800'",
    "raise ValueError('\\ud800 ' * 1000)",
    "print('x' * 10**6)",
    "print('\\x1b[2J\\x00\\ud800')",
    "n = 'x' * 10**7",
    "n = bytearray(10**7)",
    "n = list(range(10**6))",
    "n = {i: i for i in range(10**5)}",
    "n = []\nn.append(n)",
    "n = 10**5000",
    "n = -float('nan')",
    "n = float('inf')",
    "n = type('V', (), {'__repr__': lambda s: 1/0})()",
    "n = type('V', (), {'__repr__': lambda s: 5})()",
    "n = type('V', (), {'__repr__': lambda s: 'x' * 10**7})()",
    "n = type('V', (), {'__repr__': lambda s: exit()})()",
    "n = type('V', (), {'__repr__': lambda s: (yield)})()",
    "n = type('V', (), {'__bool__': lambda s: 1/0})()",
    "n = type('V', (), {'__eq__': lambda s, o: 1/0, '__hash__': lambda s: 1/0})()",
    "n = type('V', (int,), {'__float__': lambda s: 1/0, '__repr__': lambda s: exit()})(3)",
    "n = type('V', (float,), {'__float__': lambda s: exit(), '__eq__': lambda s, o: 1/0})(3)",
    "n = type('V', (str,), {'__repr__': lambda s: 1/0, '__len__': lambda s: -1})('x')",
    "n = type('V', (), {'__class__': property(lambda s: 1/0)})()",
    "n = type('V', (), {'__getattribute__': lambda s, k: 1/0})()",
    "n = type('V', (), {'__del__': lambda s: 1/0 and None})",
    "n = type('M', (type,), {'__repr__': lambda s: 1/0, '__instancecheck__': lambda s, o: 1/0})('V', (), {})",
    "n = type('V', (), {'__module__': 5, '__qualname__': '\\ud800'})()",
    "n = (i for i in iter(int, 1))",
    "n = robot",
    "n = print",
    "n = lambda: n",
    "n = globals",
    "n = type",
    "robot.move(linear=float('nan'), angular=float('inf'))",
    "robot.move(linear='fast')",
    "robot.move(linear=10**400)",
    "robot.light = 5",
    "robot.__class__ = int",
    "del robot.move",
    "robot = 5",
    "print = 5",
    "del n",
    "import threading; threading.Thread(target=lambda: None).start()",
    "import gc; gc.collect()",
    "import sys; sys.stdout.write('x'); sys.stderr.write('')",
    "import warnings; warnings.warn('x')",
    "assert n, n",
    "async def f(): pass\nn = f()\nn.close()",
    "eval('1/0')",
    "exec('while False: pass')",
    "__import__('nope')",
    "locals().clear()",
    "n = __name__",
    "n = vars()",
]
"""Blocks that end, somehow."""
TWO = "(state b) (ontime 100 a -> b) (ontime 100 b -> a)"
FORMS = [
    f"(var n := [0])(machine m (state a (running [{{}}])) {TWO})(spawn m a)",
    "(var n := [0])(machine m (state a (onentry [{}])) (state b (onexit [{}]))"
    " (eps a -> b) (ontime 100 b -> a))(spawn m a)",
    "(var n := [{}])(machine m (state a (running [n])) (state b) (on [n] a -> b))(spawn m a)",
    "(var n := [0])(event e [{}\nn])(machine m (state a) (state b) (on e a -> b t) (on [n > 1] *-> a))"
    "(spawn m a)",
    "(var n := [0])(machine m (state a (running [{}])) (state b) (ontime [n] a -> b) (ontime n b -> a))"
    "(spawn m a)",
    "(var n := [0])(onpause [{}])(onresume [{}])(machine m (state a (running [n])))(spawn m a)",
    "(var n := [1])(machine m (state a (onentry (spawn o x)) (machine o (var k := [{}\nn])"
    " (state x (running [{}])) (exit [k] x -> b))) (state b) (ontime 50 b -> a))(spawn m a)",
]
EXPRESSIONS = [
    "n + 1",
    "0",
    "None",
    "'x'",
    "nope",
    "(",
    "",
    "[1] * 3",
    "1/0",
    "exit()",
    "lambda: 0",
    "robot",
    "10**9",
]
PATHS = [
    "m",
    "a",
    "b",
    "m/a",
    "m/a/o/x",
    "n",
    "m/n",
    "m/k",
    "nope",
    "",
    "follower/moving",
    "/",
    "a/b/c/d",
    "µ",
]
NUMBERS = [0, 1, 10, 50, 100, 0.01, -1, float("nan"), float("inf"), 1e-308, 1e308, 7.5]


class ViolationError(AssertionError):
    """Something happened that must not."""


class Stopwatch:
    """The durations of calls, in wall seconds, by name; one that is too long is a violation."""

    def __init__(self) -> None:
        self.longest: dict[str, float] = {}
        self.counts: Counter[str] = Counter()

    def time(
        self, what: str, function: Callable[[], Any], allowed: tuple[type[BaseException], ...] = ()
    ) -> Any:
        """Call a function; return its result, or None if it raised what is allowed."""
        start = perf_counter()
        try:
            return function()
        except allowed:
            return None
        except BaseException as error:
            raise ViolationError(f"`{what}` raised {type(error).__name__}: {error}") from error
        finally:
            taken = perf_counter() - start
            self.counts[what] += 1
            self.longest[what] = max(taken, self.longest.get(what, 0.0))
            if taken > LONGEST:
                raise ViolationError(f"`{what}` lasted {taken:.1f} s.")


def random_text(draw: random.Random) -> str:
    """Return a random text: a damaged program, or words in a row."""
    if draw.random() < 0.15:
        return "".join(draw.choices(WORDS, k=draw.randint(0, 60)))
    if draw.random() < 0.03:
        return draw.choice(WORDS) * draw.choice([10, 1_000, 50_000])
    text = draw.choice([*PROGRAMS, HARMLESS, hostile(draw)])
    for _ in range(draw.choice([1, 1, 1, 2, 5, 20])):
        start = draw.randint(0, len(text))
        end = min(len(text), start + draw.choice([0, 0, 1, 2, 5, 30]))
        other = draw.randint(0, len(text))
        piece = draw.choice(
            [
                "",
                draw.choice(WORDS),
                draw.choice(WORDS),
                draw.choice(NASTY),
                text[other : other + draw.randint(1, 80)],
            ]
        )
        text = text[:start] + piece + text[end:]
    return text


def hostile(draw: random.Random, hanging: float = 0.0) -> str:
    """Return a valid program with a hostile block; `hanging`: the probability that it does not return."""
    blocks = HANGING if draw.random() < hanging else NASTY
    return draw.choice(FORMS).replace("{}", draw.choice(blocks).replace("\n", "\n  "))


def fuzz_texts(count: int, seed: int, watch: Stopwatch) -> None:
    """Scan, check and mend random texts."""
    for number in range(count):
        text = random_text(random.Random(f"{seed} text {number}"))
        try:
            fuzz_text(text, watch)
        except ViolationError as violation:
            raise ViolationError(f"{violation} (seed {seed}, text {number})\n{text[:2000]!r}") from violation


def fuzz_text(text: str, watch: Stopwatch) -> None:
    """Scan and check a text: the findings are in it, and their fixes can be applied."""
    program, findings = watch.time("scan", lambda: scan(text))
    if (program is None) != any(finding.severity == "error" for finding in findings):
        raise ViolationError(f"A program and errors, or neither: {findings}.")
    if program is not None:
        if program.text != text:
            raise ViolationError("The program is not that of the text.")
        findings = watch.time("check", lambda: check(program))
    lines = text.count("\n") + text.count("\r") + 2
    for finding in findings:
        if not (1 <= finding.line <= finding.end_line <= lines and finding.column >= 1 and finding.message):
            raise ViolationError(f"A finding outside the text: {finding!r}.")
        for start, end, _ in finding.fix.edits if finding.fix else ():
            if not 0 <= start <= end <= len(text):
                raise ViolationError(f"A fix outside the text: {finding!r}.")


class Victim:
    """A session with a thread of its own that is edited and commanded at random."""

    REFUSALS = (LRPError, ValueError, TypeError, SyntaxError, KeyError)

    def __init__(self, draw: random.Random, watch: Stopwatch) -> None:
        self.draw = draw
        self.watch = watch
        self.session = Session(
            HARMLESS,
            "sim",
            world="empty",
            rate=50,
            name="fuzz",
            on_issue=draw.choice(["record", "pause"]),
            journal=draw.choice([0, 10, 1000]),
            on_active_edit=draw.choice(["restart", "keep"]),
            hung_after=0.5,
        )
        self.session.start()

    def edit(self) -> None:
        """Edit the program."""
        draw = self.draw
        text = hostile(draw, 0.02) if draw.random() < 0.6 else random_text(draw)
        self.watch.time("edit", lambda: self.session.edit(text))
        if self.session.text != text:
            raise ViolationError("The text was lost.")
        if draw.random() < 0.5:  # let it run
            tick = self.session.frame.tick
            with suppress(LRPError):
                self.session.wait_for(lambda frame: frame.tick > tick, timeout=0.1)

    def command(self) -> None:
        """Give the session a random command."""
        draw, session = self.draw, self.session
        path, number = draw.choice(PATHS), draw.choice(NUMBERS)
        name, function = draw.choice(
            [
                ("pause", session.pause),
                ("resume", session.resume),
                ("resume", session.resume),
                ("step", session.step),
                ("reset", session.reset),
                ("interrupt", session.interrupt),
                ("stop_robot", session.stop_robot),
                ("transition_to", lambda: session.transition_to(path)),
                ("teleport_to", lambda: session.teleport_to(path)),
                ("set_variable", lambda: session.set_variable(path, draw.choice(EXPRESSIONS))),
                ("rename", lambda: session.rename("state", path, draw.choice(["z", "µ", "class", ""]))),
                ("rewind", lambda: session.rewind(draw.choice([0, 1, 3, 100, -1]))),
                ("rate", lambda: setattr(session, "rate", number)),
                ("speed", lambda: setattr(session, "speed", number)),
                (
                    "frame",
                    lambda: (session.frame.variables, session.issues, repr(session.frame), repr(session)),
                ),
                ("reset_world", session.bridge.reset_world),
            ]
        )
        # an expression's own errors come through
        self.watch.time(name, function, (Exception,) if name == "set_variable" else self.REFUSALS)

    def check(self) -> None:
        """Raise ViolationError unless a harmless program runs as if nothing had happened."""
        session, watch = self.session, self.watch
        watch.time("edit", lambda: session.edit(HARMLESS))
        for name, value in (("rate", 50), ("speed", 1.0)):
            watch.time(name, lambda name=name, value=value: setattr(session, name, value))
        watch.time("reset", session.reset)
        watch.time("resume", session.resume)
        tick = session.frame.tick
        watch.time(
            "the harmless program ticks",
            lambda: session.wait_for(
                lambda frame: frame.tick > tick + 2 and bool(frame.active), timeout=LONGEST
            ),
        )
        if session.fault:
            raise ViolationError(f"The session is broken:\n{session.fault}")


def fuzz_edits(count: int, seed: int, watch: Stopwatch, length: int = 25) -> None:
    """Edit and command sessions at random, `count` edits in all, `length` on each session."""
    for number in range(-(-count // length)):
        draw = random.Random(f"{seed} edits {number}")
        victim, done = Victim(draw, watch), []
        try:
            for _ in range(length):
                done.append("edit")
                victim.edit()
                done[-1] += f" {victim.session.text[:300]!r}"
                for _ in range(draw.choice([0, 1, 1, 2])):
                    done.append("command")
                    victim.command()
            victim.check()
            watch.time("close", victim.session.close)
        except ViolationError as violation:
            raise ViolationError(
                f"{violation} (seed {seed}, session {number})\n" + "\n".join(done[-6:])
            ) from violation
        finally:
            victim.session.close()


def main() -> int:
    """Run the fuzzer with the options of the command line."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    options.add_argument("--texts", type=int, default=20_000)
    options.add_argument("--edits", type=int, default=10_000)
    options.add_argument("--seed", type=int, default=1)
    chosen = options.parse_args()
    watch, start = Stopwatch(), perf_counter()
    fuzz_texts(chosen.texts, chosen.seed, watch)
    print(f"{chosen.texts} texts in {perf_counter() - start:.0f} s", flush=True)
    fuzz_edits(chosen.edits, chosen.seed, watch)
    print(f"{chosen.edits} edits, {sum(watch.counts.values())} calls in {perf_counter() - start:.0f} s")
    for name, seconds in sorted(watch.longest.items(), key=lambda item: -item[1]):
        print(f"{name:30} {watch.counts[name]:7} calls, longest {seconds:6.3f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())

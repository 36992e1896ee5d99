"""Programs of any size."""

import random
from pathlib import Path

PROGRAMS = Path(__file__).parent.parent / "programs"


def table1() -> str:
    """The program of the paper's Table 1."""
    return (PROGRAMS / "table1.lrp").read_text(encoding="utf-8")


def nest(depth: int) -> str:
    """Machines inside each other, each with one transition that never fires and one action."""
    inner = "(state s (running [1])) (state t) (on [False] s -> t)"
    for _ in range(depth - 1):
        inner = (
            f"(state s (running [1]) (machine m {inner}) (onentry (spawn m s))) (state t) (on [False] s -> t)"
        )
    return f"(machine m {inner})\n(spawn m s)"


def ring(states: int) -> str:
    """States in a ring, each left at every tick."""
    body = "".join(
        f"(state s{n} (onentry [1]) (onexit [1]))\n(on [True] s{n} -> s{(n + 1) % states})\n"
        for n in range(states)
    )
    return f"(machine m {body})\n(spawn m s0)"


def blocks(states: int) -> str:
    """States in a ring, each with a condition and actions of its own, all of which use variables.

    A state is entered and acts in one tick, and is left in the next one.
    """
    body = "".join(
        f"""
  (state s{n}
    (onentry [left = {n}])
    (running [left = left - {n + 1}])
    (onexit [seen = seen + 1]))
  (on [left < 0 and seen >= {n}] s{n} -> s{(n + 1) % states})"""
        for n in range(states)
    )
    return f"(var seen := [0])\n(machine m\n  (var left := [0]){body})\n(spawn m s0)"


def long(lines: int) -> str:
    """A program of about so many lines, as a person would lay it out."""
    parts = ["(var speed := [0.1])", "(machine robot", "  (state rest)", ")", "(spawn robot rest)"]
    count = 0
    while len(parts) < lines:
        count += 1
        parts += [
            f"(machine part{count}",
            f"  ; part {count} of the program",
            f"  (var left{count} := [{count}])",
            f"  (event seen{count} [robot.light.data > {count} and left{count}])",
            "  (state look",
            f"    (onentry [left{count} = {count} + 1])",
            "    (running [",
            f"      turn = left{count} * speed",
            "      robot.move(angular=turn)",
            "    ]))",
            "  (state go",
            "    (running [robot.move(linear=speed)])",
            f"    (onexit [left{count} = 0]))",
            f"  (on seen{count} look -> go found{count})",
            f"  (ontime {count + 100} go -> look)",
            ")",
            f"(spawn part{count} look)",
        ]
    return "\n".join(parts)


def varied(blocks: int) -> str:
    """A program of two lines for each block, no two of which are equal; its states are in rings of ten."""
    parts = ["(var speed := [0.1])"]
    for n in range((blocks - 1) // 4):
        if n % 10 == 0:
            parts.append(f"{')' if n else ''}\n(machine part{n}")
        after = n + 1 if n % 10 < 9 and n + 1 < (blocks - 1) // 4 else n - n % 10
        parts += [
            f"  (var left{n} := [{n} * 2])",
            f"  (event seen{n} [robot.light.data > {n} and left{n}])",
            f"  (state look{n}",
            f"    (onentry [left{n} = {n} + 1])",
            "    (running [",
            f"      turn = left{n} * speed",
            f"      robot.move(angular=turn, linear={n})",
            "    ]))",
        ]
        parts.append(f"  (on seen{n} look{n} -> look{after} found{n})")
    return "\n".join([*parts, ")", "(spawn part0 look0)"])


def linked(states: int, across: int) -> str:
    """States in a ring, and as many transitions across it as wanted."""
    dice = random.Random(3)
    pairs = [(n, (n + 1) % states) for n in range(states)]
    pairs += [(dice.randrange(states), dice.randrange(states)) for _ in range(across)]
    return _machine(states, pairs)


def complete(states: int) -> str:
    """A transition from every state to every other one."""
    return _machine(states, [(a, b) for a in range(states) for b in range(states) if a != b])


def _machine(states: int, pairs: list[tuple[int, int]]) -> str:
    nodes = " ".join(f"(state s{n})" for n in range(states))
    edges = " ".join(f"(on e s{a} -> s{b})" for a, b in pairs)
    return f"(machine m (event e [True]) {nodes} {edges})\n(spawn m s0)"

"""Read the expectations in the comments of test programs.

A line ``;> 3: m/b  n=2 m/k=5`` expects, after tick 3 (ticks come every 100 ms, the first at 0), just
the active state ``m/b`` and those values; ``nothing`` means no active state, ``k=-`` no value.
``;> 3 robot.light = 200`` sets an attribute of the robot before tick 3. ``;> 3 events: left m/a,
fired m/go, entered m/b`` expects these events in tick 3, in order. ``;> issue LRP601 line 4`` expects
an issue at the end, and no issue may come that is not expected.

In ``tests/edits`` a line ``;;; kept``, ``;;; restart: reason`` or ``;;; not applied: reason`` separates
the versions of a program and states the effect of the edit to the next one; ``;;; kept: reason`` is a patch
that was applied with a remark, and a line ``;;; policy keep`` at the top chooses the policy.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace

from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse

HERE = Path(__file__).parents[1]
PERIOD = 0.1
ORDINARY = ("spawned", "discarded", "entered", "left", "fired")
"""The kinds of events that a reference interpreter has, too."""


@dataclass
class Expectations:
    """What one version of a program is expected to do."""

    text: str
    active: dict[int, tuple[str, ...]] = field(default_factory=dict)
    values: dict[int, dict[str, str]] = field(default_factory=dict)
    events: dict[int, list[str]] = field(default_factory=dict)
    inputs: dict[int, list[tuple[str, object]]] = field(default_factory=dict)
    issues: set[tuple[str, int]] = field(default_factory=set)

    @property
    def last_tick(self) -> int:
        return max([0, *self.active, *self.events])


def read(text: str) -> Expectations:
    story = Expectations(text)
    for line in text.splitlines():
        if not line.startswith(";>"):
            continue
        said = line[2:].strip()
        if match := re.fullmatch(r"issue (LRP\d+) line (\d+)", said):
            story.issues.add((match[1], int(match[2])))
        elif match := re.fullmatch(r"(\d+) robot\.(\w+) = (.*)", said):
            story.inputs.setdefault(int(match[1]), []).append((match[2], eval(match[3])))
        elif match := re.fullmatch(r"(\d+) events: (.*)", said):
            story.events[int(match[1])] = match[2].split(", ")
        elif match := re.fullmatch(r"(\d+): (.*)", said):
            words = re.findall(r"[\w/]+=(?:\S+)|\S+", match[2])
            tick = int(match[1])
            story.values[tick] = dict(word.split("=", 1) for word in words if "=" in word)
            story.active[tick] = tuple(word for word in words if "=" not in word and word != "nothing")
        else:
            raise ValueError(f"no expectation: {line}")
    return story


def started(text: str, ticks: int = 1, **options) -> Interpreter:
    """An interpreter after its first ticks."""
    i = Interpreter(parse(text), robot(), **options)
    for tick in range(ticks):
        i.step(tick * PERIOD)
    return i


def active(i: Interpreter) -> list[str]:
    return ["/".join(path) for path in i.active]


def no_label(event: tuple[str, tuple[str, ...]]) -> tuple[str, tuple[str, ...]]:
    """An event without the label of the transition that fired."""
    return (event[0], event[1][:-1]) if event[0] == "fired" else event


def robot() -> SimpleNamespace:
    return SimpleNamespace(light=0, bumper=False)


def run_until(step, story: Expectations, bot, look, first: int = 1, last: int | None = None) -> None:
    """Step through the ticks of a story; `look(tick)` returns the active states and the variables."""
    for tick in range(first, (last or story.last_tick) + 1):
        for name, value in story.inputs.get(tick, ()):
            setattr(bot, name, value)
        step((tick - 1) * PERIOD)
        active, variables = look()
        if tick in story.active:
            assert active == story.active[tick], f"after tick {tick}"
        for name, expected in story.values.get(tick, {}).items():
            actual = variables.get(tuple(name.split("/")), "-")
            assert (actual == "-") if expected == "-" else (actual == eval(expected)), (
                f"{name} after tick {tick}"
            )

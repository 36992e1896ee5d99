"""The elements of an LRP program, as frozen values.

Every element compares by *meaning*: positions in the text, white space and comments do not count, inside or
outside blocks. So ``parse(to_source(p)) == p``, and an edit that only moves lines makes an equal program.

Paper: §3.1, §3.2.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate
from typing import NamedTuple

from lrp_jupyter.errors import Edit, Finding, Fix
from lrp_jupyter.language.display import Displayed
from lrp_jupyter.language.python.scanner import LINE_END
from lrp_jupyter.language.source import NOWHERE, Block, Name, Span
from lrp_jupyter.language.triggers import Delay, TransitionKind, Trigger

__all__ = [
    "Action",
    "Block",
    "Edit",
    "Element",
    "Event",
    "Finding",
    "Fix",
    "Machine",
    "Name",
    "Path",
    "Program",
    "Span",
    "Spawn",
    "State",
    "Transition",
    "Variable",
    "path_text",
]

Path = tuple[str, ...]


class _Identity(NamedTuple):
    kind: str
    path: Path


class Element(_Identity):
    """The identity of one part of a program: it survives every edit that keeps the part.

    ``kind`` is ``variable``, ``event``, ``machine``, ``state``, ``transition`` or ``spawn``; the
    actions of a state (``onentry``, ``running``, ``onexit``) are elements too, under the path of
    their state, and so are the ``effect`` of a transition, under its path, and the program's ``onpause``,
    ``onresume`` and ``onend`` (empty path). A ``setting`` is a variable in a spawn, under the path of the
    latter. The last name of a transition's path is its :attr:`Transition.id`.
    """

    label: str = ""
    """Text shown instead of the path's last name; not part of the identity."""

    @property
    def shown(self) -> Path:
        """The path to display: with a transition's label instead of its id."""
        return (*self.path[:-1], self.label) if self.label else self.path

    def __str__(self) -> str:
        return f"{self.kind} `{path_text(self.shown)}`" if self.path else self.kind


def effect_of(transition: Element) -> Element:
    """Return the element of the effect of a transition."""
    found = Element("effect", transition.path)
    if transition.label:
        found.label = transition.label
    return found


def path_text(path: Path) -> str:
    """Return a path as text: ``follower/looking/lookalgo``."""
    return "/".join(path)


@dataclass(frozen=True, slots=True)
class Variable:
    """``(var NAME := [expression])``."""

    name: Name
    initial: Block
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class Event:
    """``(event NAME [condition])``."""

    name: Name
    condition: Block
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class Spawn:
    """``(spawn MACHINE STATE (var NAME := [expression]) …)``.

    `settings`: the expressions that initialise variables of the machine instead of their own, for this use.
    """

    machine: Name
    state: Name
    settings: tuple[Variable, ...] = ()
    span: Span = field(default=NOWHERE, compare=False)

    @property
    def identity(self) -> tuple[str, str]:
        """The names of the machine and of its start state."""
        return str(self.machine), str(self.state)


Action = Block | Spawn
"""One item of an ``onentry``."""


@dataclass(frozen=True, slots=True)
class Transition:
    """A transition: its trigger, its sources and its destination.

    `trigger`: an event, a condition, a delay, or nothing.
    `sources`: the states it leaves; for a wildcard, those that it does *not* leave.
    `wildcard`: whether its source is ``*`` or ``*-{…}``.
    `name`: the transition's own name.
    `outward`: whether it is an ``exit``, which leads to a state of the outer machine.
    `hold`: how long its trigger must have been true; None if it fires at once.
    `effect`: what is done when it fires, before anything is left.
    """

    trigger: Trigger
    sources: tuple[Name, ...]
    wildcard: bool
    destination: Name
    name: Name | None = None
    outward: bool = False
    hold: Delay | None = None
    effect: tuple[Block, ...] = ()
    span: Span = field(default=NOWHERE, compare=False)

    @property
    def kind(self) -> TransitionKind:
        """The keyword of its form: ``on``, ``ontime``, ``eps`` or ``exit``."""
        return "exit" if self.outward else self.trigger.keyword

    @property
    def style(self) -> str:
        """The style of its arrow in a picture."""
        return "wildcard" if self.wildcard else self.kind

    @property
    def source_text(self) -> str:
        """The sources as the language writes them: ``a``, ``*``, ``*-{a b}``, ``{a b}``."""
        group = "{" + " ".join(self.sources) + "}"
        if self.wildcard:
            return "*-" + group if self.sources else "*"
        return str(self.sources[0]) if len(self.sources) == 1 else group

    @property
    def own_states(self) -> tuple[Name, ...]:
        """The states of its own machine that it names."""
        return self.sources if self.outward else (*self.sources, self.destination)

    @property
    def trigger_text(self) -> str:
        """When it fires, as the language writes it, ``eps`` for nothing."""
        hold = f" for {self.hold.text}" if self.hold else ""
        return (str(self.trigger.text) or self.trigger.keyword) + hold

    @property
    def arrow_text(self) -> str:
        """When it fires, as the text of its arrow in a picture."""
        text = self.trigger.arrow + (f" for {self.hold.duration}" if self.hold else "")
        if self.wildcard and self.sources:
            text += " (not " + ", ".join(self.sources) + ")"
        return text + (" /" if self.effect else "")

    @property
    def content(self) -> tuple[Trigger, Delay | None]:
        """When it fires: what an edit can change without making it another transition."""
        return self.trigger, self.hold

    @property
    def id(self) -> str:
        """What identifies it within its machine: its name, else ``kind:from->to``.

        It does not depend on the trigger, so an edit of the condition or delay keeps it.
        """
        return str(self.name or f"{self.kind}:{self.source_text}->{self.destination}")

    @property
    def label(self) -> str:
        """The name under which it is displayed: its name, else ``condition:from->to``."""
        return str(self.name or f"{self.trigger_text}:{self.source_text}->{self.destination}")

    @property
    def identity(self) -> tuple[str, frozenset[str], bool, str, str | None]:
        """Kind, sources, destination and name. Paper: §6.1, footnote 5."""
        return (self.kind, frozenset(self.sources), self.wildcard, self.destination, self.name)

    def leaves(self, state: str) -> bool:
        """Return whether `state` is among its sources.

        A wildcard does not leave its own destination.
        Deviation: §3.1 counts every state; §3.2 lists all but the destination.
        """
        if self.wildcard:
            return state != self.destination and state not in self.sources
        return state in self.sources


@dataclass(frozen=True, slots=True)
class State:
    """``(state NAME …)``: actions and nested machines."""

    name: Name
    onentry: tuple[Action, ...] = ()
    running: tuple[Block, ...] = ()
    onexit: tuple[Block, ...] = ()
    machines: tuple[Machine, ...] = ()
    span: Span = field(default=NOWHERE, compare=False)

    @property
    def actions(self) -> dict[str, tuple[Action, ...]]:
        """What it does, by the keyword of its form."""
        return {"onentry": self.onentry, "running": self.running, "onexit": self.onexit}


@dataclass(frozen=True)
class Machine(Displayed):
    """``(machine NAME …)``; each tuple keeps the order of the text."""

    name: Name
    variables: tuple[Variable, ...] = ()
    events: tuple[Event, ...] = ()
    states: tuple[State, ...] = ()
    transitions: tuple[Transition, ...] = ()
    span: Span = field(default=NOWHERE, compare=False)

    @cached_property
    def ids(self) -> tuple[str, ...]:
        """The ids of the transitions, made distinct: a second `t` is `t#2`."""
        return _distinct(transition.id for transition in self.transitions)

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """The labels of the transitions, made distinct in the same way."""
        return _distinct(transition.label for transition in self.transitions)

    def elements(self, path: Path) -> tuple[Element, ...]:
        """Return the elements of the transitions of this machine, whose path is given."""
        found = tuple([Element("transition", (*path, id_)) for id_ in self.ids])
        if not all(each.name for each in self.transitions):  # id and label of a named one are its name
            for element, label in zip(found, self.labels, strict=True):
                if label != element.path[-1]:
                    element.label = label
        return found


@dataclass(frozen=True)
class Program(Displayed):
    """A whole program, as made by :func:`~lrp_jupyter.language.parser.parse`.

    Each tuple keeps the order of the text.
    """

    variables: tuple[Variable, ...] = ()
    events: tuple[Event, ...] = ()
    machines: tuple[Machine, ...] = ()
    spawns: tuple[Spawn, ...] = ()
    onpause: tuple[Block, ...] = ()
    onresume: tuple[Block, ...] = ()
    onend: tuple[Block, ...] = ()
    text: str = field(default="", compare=False, repr=False)
    filename: str = field(default="<lrp>", compare=False)

    @cached_property
    def _line_starts(self) -> list[int]:
        return line_starts(self.text)

    @property
    def hooks(self) -> dict[str, tuple[Block, ...]]:
        """The actions of the program as a whole, by their kind."""
        return {"onpause": self.onpause, "onresume": self.onresume, "onend": self.onend}

    @property
    def main(self) -> str:
        """The name of the machine that it spawns first, or else of the first one; empty if there is none."""
        names = [str(machine.name) for machine in self.machines]
        spawned = [str(spawn.machine) for spawn in self.spawns]
        return next((name for name in (*spawned, *names) if name in names), "")

    def place(self, offset: int) -> tuple[int, int]:
        """Return the line and column of a character offset, both from 1."""
        line = bisect_right(self._line_starts, offset)
        return line, offset - self._line_starts[line - 1] + 1

    def place_of_bytes(self, line: int, offset: int) -> tuple[int, int] | None:
        """Return the line and column, both from 1, of an offset in bytes of UTF-8 from the start of a line.

        Compiled code counts in bytes. None if the text has no such line.
        """
        if line > len(self._line_starts):
            return None
        start = self._line_starts[line - 1]
        before = self.text[start : start + offset].encode("utf-8", "replace")[:offset]
        return line, len(before.decode("utf-8", "ignore")) + 1

    def walk(self) -> Iterator[tuple[Path, Machine]]:
        """Yield every machine with its path, outer before inner, in the order of the text."""

        def inside(prefix: Path, machines: tuple[Machine, ...]) -> Iterator[tuple[Path, Machine]]:
            for machine in machines:
                path = (*prefix, str(machine.name))
                yield path, machine
                for state in machine.states:
                    yield from inside((*path, str(state.name)), state.machines)

        yield from inside((), self.machines)


def _distinct(names: Iterable[str]) -> tuple[str, ...]:
    seen: dict[str, int] = {}
    distinct = []
    for name in names:
        seen[name] = count = seen.get(name, 0) + 1
        distinct.append(name if count == 1 else f"{name}#{count}")
    return tuple(distinct)


def line_starts(text: str) -> list[int]:
    """Return the offsets at which the lines of a text begin; LF, CRLF and CR end a line."""
    if "\r" in text:
        return [0, *(match.end() for match in LINE_END.finditer(text))]
    lines = text.split("\n")
    return list(accumulate((len(line) + 1 for line in lines[:-1]), initial=0))

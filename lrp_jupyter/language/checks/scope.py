"""Who sees what: the machines of a program with their names resolved, as the checks need them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, TypeVar

from lrp_jupyter.language.program import (
    Event,
    Machine,
    Name,
    Path,
    Program,
    Spawn,
    State,
    Transition,
    Variable,
)

__all__ = ["Definition", "Repeat", "Scope", "resolve"]

Definition = Variable | Event | State | Machine
_Defined = TypeVar("_Defined", Variable, Event, State, Machine)


class Repeat(NamedTuple):
    """A second definition of a name; the first counts and this one is looked at no further."""

    kind: str
    scope: Scope
    first: Definition
    again: Definition


@dataclass(eq=False, slots=True)
class Scope:
    """A machine, or the top level of the program, with what is defined in it.

    Parameters
    ----------
    path : tuple of str
        Empty for the top level.
    outer : Scope or None
        The machine around it, or the top level; None for the top level.
    state : str
        The state of `outer` in which it stands; empty for a root machine.
    variables, events, states : dict
        Its own ones by name, the first definitions only.
    machines : dict of str to dict of str to Scope
        By state, then by name; at the top level under the empty state.
    transitions : tuple of Transition
    visible : dict of str to Scope
        Where each variable is defined that its blocks see.
    """

    path: Path
    outer: Scope | None = None
    state: str = ""
    variables: dict[str, Variable] = field(default_factory=dict)
    events: dict[str, Event] = field(default_factory=dict)
    states: dict[str, State] = field(default_factory=dict)
    machines: dict[str, dict[str, Scope]] = field(default_factory=dict)
    transitions: tuple[Transition, ...] = ()
    visible: dict[str, Scope] = field(default_factory=dict)
    name: Name | None = None

    def walk(self) -> Iterator[Scope]:
        """Yield itself and every machine inside, outer before inner."""
        yield self
        for machines in self.machines.values():
            for machine in machines.values():
                yield from machine.walk()

    def outwards(self) -> Iterator[Scope]:
        """Yield itself and what encloses it, up to the top level."""
        scope: Scope | None = self
        while scope is not None:
            yield scope
            scope = scope.outer

    def event(self, name: str) -> Event | None:
        """Find the event that a transition of this machine means. Paper: §3.1."""
        return next((scope.events[name] for scope in self.outwards() if name in scope.events), None)

    def machine(self, state: str, name: str) -> Scope | None:
        """Find the machine that a spawn by `state` means. Paper: §3.1.

        Its own machines come first, then those around it, up to the top level; never the machine of the
        state itself, nor one that encloses it.
        """
        return next((here[name] for here in self._around(state) if self._can_spawn(here.get(name))), None)

    def spawnable(self, state: str) -> set[str]:
        """Find the names of the machines that a state can spawn."""
        around = self._around(state)
        return {name for here in around for name, machine in here.items() if self._can_spawn(machine)}

    def _around(self, state: str) -> Iterator[dict[str, Scope]]:
        for scope in self.outwards():
            yield scope.machines.get(state, {})
            state = scope.state

    def _can_spawn(self, machine: Scope | None) -> bool:
        return machine is not None and machine not in self.outwards()

    def spawns(self) -> Iterator[tuple[str, Spawn]]:
        """Yield every spawn of its states, with the state's name."""
        for state in self.states.values():
            for item in state.onentry:
                if isinstance(item, Spawn):
                    yield str(state.name), item


def resolve(program: Program) -> tuple[Scope, list[Repeat]]:
    """Build the scopes of a program, and list what is defined twice."""
    repeats: list[Repeat] = []
    top = Scope(())
    _define(top, program, repeats)
    _machines(top, "", program.machines, repeats)
    return top, repeats


def _define(scope: Scope, noun: Program | Machine, repeats: list[Repeat]) -> None:
    scope.variables = _first("variable", scope, noun.variables, repeats)
    scope.events = _first("event", scope, noun.events, repeats)
    around = scope.outer.visible if scope.outer else {}
    scope.visible = around | dict.fromkeys(scope.variables, scope)


def _machines(scope: Scope, state: str, machines: Sequence[Machine], repeats: list[Repeat]) -> None:
    if not machines:
        return
    inner = scope.machines[state] = {}
    for noun in _first("machine", scope, machines, repeats).values():
        path = (*scope.path, state, str(noun.name)) if state else (str(noun.name),)
        machine = inner[path[-1]] = Scope(path, scope, state, transitions=noun.transitions, name=noun.name)
        _define(machine, noun, repeats)
        machine.states = _first("state", machine, noun.states, repeats)
        for name, part in machine.states.items():
            _machines(machine, name, part.machines, repeats)


def _first(
    kind: str, scope: Scope, definitions: Sequence[_Defined], repeats: list[Repeat]
) -> dict[str, _Defined]:
    found: dict[str, _Defined] = {}
    for definition in definitions:
        first = found.setdefault(str(definition.name), definition)
        if first is not definition:
            repeats.append(Repeat(kind, scope, first, definition))
    return found

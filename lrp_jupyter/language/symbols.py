"""What every name of a program refers to, by lexical scope: for going to a definition, and for renaming.

Paper: §3.1 (scope of actions, spawn), §9 (refactorings).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from lrp_jupyter.language.blocks import block_names
from lrp_jupyter.language.checks.scope import Scope, resolve
from lrp_jupyter.language.program import (
    Block,
    Element,
    Machine,
    Name,
    Path,
    Program,
    Span,
    Spawn,
    Transition,
)

__all__ = ["Symbol", "Use", "symbols"]


class Use(NamedTuple):
    """One place of the text where a name refers to something.

    ``symbol`` is None where that is no part of the program: a local name of a block, a builtin, or nothing at
    all. ``imported`` is the module's name where the name is bound by ``import``, else empty.
    """

    name: str
    span: Span
    symbol: Symbol | None
    imported: str = ""


@dataclass(eq=False)
class Symbol:
    """Something that has a name: where it is defined, and where it is meant."""

    element: Element
    definition: Span
    references: list[Span] = field(default_factory=list)


def symbols(program: Program) -> tuple[list[Symbol], list[Use]]:
    """Resolve every name of a program.

    Returns
    -------
    symbols : list of Symbol
        What is defined, in the order of the text. Second definitions of a name are left out.
    uses : list of Use
        Every name that is used, in the order of the text.
    """
    resolver = _Resolver(program)
    return sorted(resolver.symbols.values(), key=lambda symbol: symbol.definition), sorted(
        resolver.uses, key=lambda use: use.span
    )


class _Resolver:
    def __init__(self, program: Program) -> None:
        self.symbols: dict[Element, Symbol] = {}
        self.uses: list[Use] = []
        top, _ = resolve(program)
        scopes = list(top.walk())
        for scope in scopes:
            self.define(scope)
        self.spawners: dict[Path, list[Scope]] = {}
        for scope in scopes:
            for state, spawn in scope.spawns():
                self.spawn(spawn, scope, state)
        for spawn in program.spawns:
            self.spawn(spawn, top, "")
        for block in (*program.onpause, *program.onresume):
            self.block(block, top.visible)
        for scope in scopes:
            self.names(scope)

    # Definitions

    def define(self, scope: Scope) -> None:
        for kind, names in (("variable", scope.variables), ("event", scope.events), ("state", scope.states)):
            for noun in names.values():
                self.symbol(kind, (*scope.path, str(noun.name)), noun.name)
        if scope.name is not None:
            self.symbol("machine", scope.path, scope.name)
            labels = Machine(scope.name, transitions=scope.transitions).labels
            for label, transition in zip(labels, scope.transitions, strict=True):
                if transition.name is not None:
                    self.symbol("transition", (*scope.path, label), transition.name)

    def symbol(self, kind: str, path: Path, name: Name) -> None:
        element = Element(kind, path)
        self.symbols[element] = Symbol(element, name.span)

    # Uses

    def use(self, name: Name, kind: str, scope: Scope | None, imported: str = "") -> None:
        """Note that a name means an element of a scope; None if it means nothing."""
        self.refer(str(name), name.span, kind, scope, imported)

    def refer(self, name: str, span: Span, kind: str, scope: Scope | None, imported: str = "") -> None:
        symbol = None if scope is None else self.symbols.get(Element(kind, (*scope.path, name)))
        if symbol is not None:
            symbol.references.append(span)
        self.uses.append(Use(name, span, symbol, imported))

    def spawn(self, spawn: Spawn, spawner: Scope, state: str) -> None:
        target = spawner.machine(state, spawn.machine)
        if target is None:
            self.uses.append(Use(str(spawn.machine), spawn.machine.span, None))
        else:
            symbol = self.symbols[Element("machine", target.path)]
            symbol.references.append(spawn.machine.span)
            self.uses.append(Use(str(spawn.machine), spawn.machine.span, symbol))
            self.spawners.setdefault(target.path, []).append(spawner)
        self.use(spawn.state, "state", target)

    def names(self, scope: Scope) -> None:
        """Resolve the names in the transitions and blocks of a machine."""
        visible = dict(scope.outer.visible) if scope.outer else {}
        for variable in scope.variables.values():
            self.block(variable.initial, visible)  # it sees the scope before its own variable
            visible[str(variable.name)] = scope
        for event in scope.events.values():
            self.block(event.condition, scope.visible)
        for state in scope.states.values():
            for action in (*state.onentry, *state.running, *state.onexit):
                if isinstance(action, Block):
                    self.block(action, scope.visible)
        for transition in scope.transitions:
            self.transition(transition, scope)

    def transition(self, transition: Transition, scope: Scope) -> None:
        trigger = transition.trigger
        if isinstance(trigger, Block):
            self.block(trigger, scope.visible)
        elif isinstance(trigger, Name) and transition.kind == "ontime":
            self.use(trigger, "variable", scope.visible.get(trigger))
        elif isinstance(trigger, Name):
            self.use(trigger, "event", next((s for s in scope.outwards() if trigger in s.events), None))
        for source in transition.sources:
            self.use(source, "state", scope)
        for target in self.targets(transition, scope):
            self.use(transition.destination, "state", target)

    def targets(self, transition: Transition, scope: Scope) -> Iterator[Scope | None]:
        """Yield the machines among whose states the destination is: for `exit` those that spawn this one."""
        if transition.kind == "exit":
            yield from dict.fromkeys(self.spawners.get(scope.path, ())) or (None,)
        else:
            yield scope

    def block(self, block: Block, visible: Mapping[str, Scope]) -> None:
        for place in block_names(block).places:
            span = Span(place.start, place.end)
            self.refer(place.name, span, "variable", visible.get(place.name), place.imported)

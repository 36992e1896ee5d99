"""Resolution of the names of a program by lexical scope, once per program.

The linker, the checks, renaming, completion and the graphs all use it; none of them resolves names itself.

Paper: §3.1 (scope of actions, events and spawns), §6.2 (dangling references).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, islice
from typing import Literal, NamedTuple, TypeVar

from lrp_jupyter.language.blocks.builtin_names import PROVIDED, TIMES
from lrp_jupyter.language.program import (
    Block,
    Element,
    Event,
    Machine,
    Name,
    Path,
    Program,
    Spawn,
    State,
    Transition,
    Variable,
    effect_of,
)
from lrp_jupyter.language.triggers import InState, Purpose

Definition = Variable | Event | State | Machine
MOST = 100
"""Places of a machine that are listed: each use of a machine that uses others multiplies them."""
HOLD = 2
"""The ordinal of the block after ``for``; that of the condition is 0, and 1 is the transition itself."""
_NOTHING: Mapping[str, Scope] = {}
_Defined = TypeVar("_Defined", Variable, Event, State, Machine)

_Unknown = Literal["unknown event", "unknown state", "unknown machine", "unknown variable"]
_UNKNOWN: dict[str, _Unknown] = {"event": "unknown event", "variable": "unknown variable"}


class Unresolved(NamedTuple):
    """Why a reference cannot be resolved: the kind of fault, and a sentence."""

    kind: _Unknown
    message: str


class Repeat(NamedTuple):
    """A second definition of a name. The first one counts; this one is ignored."""

    element: Element
    scope: Scope
    first: Definition
    again: Definition


@dataclass(eq=False, repr=False, slots=True)
class Scope:
    """The top level of a program or a machine, with what is defined in it.

    `path`: empty for the top level.
    `outer`: the machine around it, or the top level; None for the top level.
    `state`: the state of `outer` that contains it; empty for a root machine.
    `noun`: None for the top level.
    `variables`, `events`, `states`: its own definitions by name, only the first of each name.
    `machines`: by state, then by name; at the top level under the empty state.
    `visible`, `visible_events`: the scope that defines each variable visible to its blocks, and each event
        usable by its transitions.
    """

    path: Path
    outer: Scope | None = None
    state: str = ""
    noun: Machine | None = None
    variables: dict[str, Variable] = field(default_factory=dict)
    events: dict[str, Event] = field(default_factory=dict)
    states: dict[str, State] = field(default_factory=dict)
    machines: dict[str, dict[str, Scope]] = field(default_factory=dict)
    visible: dict[str, Scope] = field(default_factory=dict)
    visible_events: dict[str, Scope] = field(default_factory=dict)
    _called: dict[str, tuple[Scope, ...]] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"Scope({self.path!r})"

    @property
    def name(self) -> Name | None:
        """The machine's name; None for the top level."""
        return self.noun.name if self.noun else None

    @property
    def transitions(self) -> tuple[Transition, ...]:
        """The machine's transitions, in the order of the text."""
        return self.noun.transitions if self.noun else ()

    def path_of(self, kind: str, name: str) -> Path:
        """Return the path of the definition of a name in this scope; the scope's own path for a machine."""
        return self.path if kind == "machine" else (*self.path, name)

    def walk(self) -> Iterator[Scope]:
        """Yield itself and every machine inside, outer before inner."""
        yield self
        for machines in self.machines.values():
            for machine in machines.values():
                yield from machine.walk()

    def dissolve(self) -> None:
        """Drop the references to other scopes."""
        self.outer = None
        self.machines = {}
        self.visible = {}
        self.visible_events = {}
        self._called = {}

    def outwards(self) -> Iterator[Scope]:
        """Yield itself and what encloses it, up to the top level."""
        scope: Scope | None = self
        while scope is not None:
            yield scope
            scope = scope.outer

    def owner(self, kind: Literal["event", "variable"], name: str) -> Scope | None:
        """Return the scope that defines the event or variable that a name refers to here."""
        return (self.visible_events if kind == "event" else self.visible).get(name)

    def event(self, name: str) -> Event | None:
        """Return the event that a name in a transition of this machine refers to. Paper: §3.1."""
        owner = self.visible_events.get(name)
        return owner.events[name] if owner else None

    def machine(self, state: str, name: str) -> Scope | None:
        """Return the machine that a spawn by `state` refers to. Paper: §3.1.

        The machines in the state come first, then those around it, up to the top level; never the machine
        of the state itself, nor one that encloses it.
        """
        return next((here[name] for here in self._around(state) if self._can_spawn(here.get(name))), None)

    def spawnable(self, state: str) -> set[str]:
        """Return the names of the machines that a state can spawn."""
        around = self._around(state)
        return {name for here in around for name, machine in here.items() if self._can_spawn(machine)}

    def callable_names(self) -> set[str]:
        """Return the names that refer to machines in its blocks."""
        return set().union(*map(self.spawnable, ("", *self.states)))

    def machines_called(self, name: str) -> tuple[Scope, ...]:
        """Return the machines that a name refers to in a block, each as for a spawn by some state."""
        called = self._called.get(name)
        if called is None:
            found = (self.machine(state, name) for state in ("", *self.states))
            called = tuple(dict.fromkeys(machine for machine in found if machine is not None))
            self._called[name] = called
        return called

    def _around(self, state: str) -> Iterator[dict[str, Scope]]:
        for scope in self.outwards():
            yield scope.machines.get(state, {})
            state = scope.state

    def _can_spawn(self, machine: Scope | None) -> bool:
        return machine is not None and machine not in self.outwards()


class PlacedBlock(NamedTuple):
    """A block of an element, at an index of its items, with the scope of each variable visible to it."""

    element: Element
    ordinal: int
    block: Block
    purpose: Purpose
    scope: Scope
    visible: Mapping[str, Scope]

    def event(self, name: str) -> Scope | None:
        """Return the scope that defines the event whose value a name means here; a variable hides it."""
        itself = self.element.kind == "event" and self.element.path[-1] == name
        hidden = itself or name in self.visible or name in PROVIDED
        return None if hidden else self.scope.owner("event", name)

    def machines(self, name: str) -> tuple[Scope, ...]:
        """Return the machines that a name can mean here; a variable hides them."""
        hidden = name in self.visible or name in PROVIDED
        return () if hidden else self.scope.machines_called(name)

    def is_computed(self, name: str) -> bool:
        """Return whether a name alone means the value of an event, or a time, here."""
        return self.event(name) is not None or (name in TIMES and name not in self.visible)


class Spawning(NamedTuple):
    """A spawn by a state of `scope`, or at the top level, at an index of its items, and what it refers to."""

    element: Element
    ordinal: int
    noun: Spawn
    scope: Scope
    state: str
    machine: Scope | None

    @property
    def spawner(self) -> Path:
        """Path of the spawning state; empty for the top level."""
        return (*self.scope.path, self.state) if self.state else ()

    @property
    def settings(self) -> dict[Element, Variable]:
        """The settings by element; the first of two of the same variable."""
        named = {str(setting.name): setting for setting in reversed(self.noun.settings)}
        return {Element("setting", (*self.element.path, name)): named[name] for name in reversed(named)}

    @property
    def unresolved(self) -> Unresolved | None:
        """Why nothing can be spawned, or None."""
        name, machine = self.noun.machine, self.machine
        if machine is None:
            message = f"There is no machine `{name}` that can be spawned here."
            return Unresolved("unknown machine", message)
        if self.noun.state not in machine.states:
            message = f"The machine `{machine.path[-1]}` has no state `{self.noun.state}`."
            return Unresolved("unknown state", message)
        return None


class Arrow(NamedTuple):
    """A transition and what its names refer to.

    `owner`: the scope that defines the event or variable that it names.
    `watched`: the machine whose state it names, for each of its sources that can spawn it.
    `homes`: the machines among whose states its destination is looked up: its own; for `exit` those whose
        states spawn its own machine.
    """

    element: Element
    noun: Transition
    scope: Scope
    owner: Scope | None
    watched: Mapping[str, Scope]
    homes: tuple[Scope, ...]

    @property
    def label(self) -> str:
        """The transition's label, distinct within its machine."""
        return self.element.shown[-1]

    @property
    def tested(self) -> tuple[Block, Scope] | None:
        """The block of its condition, event or delay, and the scope in which that is evaluated, or None."""
        trigger = self.noun.trigger
        if trigger.block is not None:
            return trigger.block[1], self.scope
        if trigger.reference is None or self.owner is None:
            return None
        kind, name = trigger.reference
        return (self.owner.events[name].condition, self.owner) if kind == "event" else None

    @property
    def unresolved_trigger(self) -> Unresolved | None:
        """Why its event, the variable of its delay or the state of a machine cannot be resolved, or None."""
        trigger = self.noun.trigger
        reference = trigger.reference
        if reference is None or self.owner is not None:
            return None
        kind, name = reference
        if not isinstance(trigger, InState):
            return Unresolved(_UNKNOWN[kind], f"There is no {kind} `{name}`.")
        if not self.watched:
            return Unresolved("unknown machine", f"There is no machine `{name}` that can be spawned there.")
        if not any(trigger.state in machine.states for machine in self.watched.values()):
            return Unresolved("unknown state", f"The machine `{name}` has no state `{trigger.state}`.")
        return None

    @property
    def unresolved_hold(self) -> Unresolved | None:
        """Why the variable after its ``for`` cannot be resolved, or None."""
        reference = self.noun.hold and self.noun.hold.reference
        if not reference or self.scope.owner("variable", reference[1]) is not None:
            return None
        return Unresolved("unknown variable", f"There is no variable `{reference[1]}`.")


class Resolution:
    """The names of one program, resolved. Made by :func:`resolve`.

    Its scopes live as long as it does. They refer to each other in cycles, which it breaks at its end:
    otherwise each edit would leave thousands of objects to the garbage collector, which stops all threads.

    `top`: the top level.
    `scopes`: the top level and every machine, outer before inner.
    `repeats`: second definitions of a name, in the order of the text.
    """

    def __init__(self, program: Program) -> None:
        self.scopes: tuple[Scope, ...] = ()
        self._spawns = program.spawns
        self.hooks = program.hooks
        repeats: list[Repeat] = []
        self.top = Scope(())
        _define(self.top, program, repeats)
        _machines(self.top, "", program.machines, repeats)
        self.scopes = tuple(self.top.walk())
        self.repeats = tuple(repeats)
        self._defined: dict[Path, Path] = {}
        self._shared: dict[Path, bool] = {}

    def __del__(self) -> None:
        for scope in self.scopes:
            scope.dissolve()

    @cached_property
    def computed(self) -> tuple[frozenset[str], frozenset[str]]:
        """The names that mean a computed value in some block, and the names of the machines."""
        events = (name for scope in self.scopes for name in scope.events)
        machines = (scope.path[-1] for scope in self.scopes if scope.noun)
        return TIMES.union(events) - PROVIDED, frozenset(machines) - PROVIDED

    @cached_property
    def by_path(self) -> dict[Path, Scope]:
        """Every scope by its path."""
        return {scope.path: scope for scope in self.scopes}

    @cached_property
    def spawns(self) -> tuple[Spawning, ...]:
        """Every spawn, those at the top level first."""
        found = []
        for place, spawn in enumerate(self._spawns):
            element = Element("spawn", (str(spawn.machine),))
            found.append(Spawning(element, place, spawn, self.top, "", self.top.machine("", spawn.machine)))
        for scope in self.scopes:
            for name, state in scope.states.items():
                for place, item in enumerate(state.onentry):
                    if isinstance(item, Spawn):
                        element = Element("spawn", (*scope.path, name, str(item.machine)))
                        machine = scope.machine(name, item.machine)
                        found.append(Spawning(element, place, item, scope, name, machine))
        return tuple(found)

    @cached_property
    def spawners(self) -> dict[Scope, tuple[Scope, ...]]:
        """For each machine that is spawned, the scopes whose states (or top level) spawn it."""
        found: dict[Scope, dict[Scope, None]] = {}
        for spawn in self.spawns:
            if spawn.machine is not None:
                found.setdefault(spawn.machine, {})[spawn.scope] = None
        return {machine: tuple(scopes) for machine, scopes in found.items()}

    @cached_property
    def starts(self) -> dict[Scope, tuple[str, ...]]:
        """For each machine that is spawned, the states in which it starts."""
        found: dict[Scope, dict[str, None]] = {}
        for spawn in self.spawns:
            if spawn.machine is not None and spawn.noun.state in spawn.machine.states:
                found.setdefault(spawn.machine, {})[str(spawn.noun.state)] = None
        return {machine: tuple(names) for machine, names in found.items()}

    @cached_property
    def arrows(self) -> dict[Scope, tuple[Arrow, ...]]:
        """The transitions of every machine, in the order of the text."""
        return {scope: tuple(self._arrows(scope)) for scope in self.scopes}

    def arrow(self, element: Element) -> Arrow | None:
        """Return a transition; None if the program does not have it."""
        scope = self.by_path.get(element.path[:-1])
        arrows = self.arrows[scope] if scope is not None else ()
        return next((arrow for arrow in arrows if arrow.element == element), None)

    def _arrows(self, scope: Scope) -> Iterator[Arrow]:
        if scope.noun is None:
            return
        here = (scope,)
        elements = scope.noun.elements(scope.path)
        for element, noun in zip(elements, scope.noun.transitions, strict=True):
            reference = noun.trigger.reference
            owner, watched = None, _NOTHING
            if reference is not None and reference[0] != "machine":
                owner = scope.owner(reference[0], reference[1])
            elif reference is not None:
                sources = filter(noun.leaves, scope.states)
                found = ((source, scope.machine(source, reference[1])) for source in sources)
                watched = {source: machine for source, machine in found if machine is not None}
            homes = self.outside(scope) if noun.outward else here
            yield Arrow(element, noun, scope, owner, watched, homes)

    def outside(self, scope: Scope) -> tuple[Scope, ...]:
        """Return the machines that an ``exit`` of a machine can lead into: those that spawn it."""
        return tuple(home for home in self.spawners.get(scope, ()) if home.noun)

    @property
    def all_blocks(self) -> Iterator[PlacedBlock]:
        """The blocks of all elements."""
        return chain.from_iterable(self.blocks.values())

    @cached_property
    def blocks(self) -> dict[Element, tuple[PlacedBlock, ...]]:
        """The blocks of every element that has any, with the variables visible to them."""
        found: dict[Element, tuple[PlacedBlock, ...]] = {}
        for scope in self.scopes:
            path, visible = scope.path, scope.visible
            places = {name: place for place, name in enumerate(scope.variables)}
            for name, variable in scope.variables.items():
                element = Element("variable", (*path, name))
                before = _EarlierVariables(scope, places, places[name])
                found[element] = (PlacedBlock(element, 0, variable.initial, "initialiser", scope, before),)
            for name, event in scope.events.items():
                element = Element("event", (*path, name))
                found[element] = (PlacedBlock(element, 0, event.condition, "condition", scope, visible),)
            for element, noun, *_ in self.arrows[scope]:
                tested = ((0, noun.trigger), (HOLD, noun.hold)) if noun.hold else ((0, noun.trigger),)
                placed = [
                    PlacedBlock(element, ordinal, each.block[1], each.block[0], scope, visible)
                    for ordinal, each in tested
                    if each.block is not None
                ]
                if placed:
                    found[element] = tuple(placed)
                if noun.effect:
                    _actions(found, effect_of(element), noun.effect, scope)
            for name, state in scope.states.items():
                inside = (*path, name)
                for kind, items in state.actions.items():
                    if items:
                        _actions(found, Element(kind, inside), items, scope)
        for hook, blocks in self.hooks.items():
            _actions(found, Element(hook, ()), blocks, self.top)
        for spawning in self.spawns:
            for element, setting in spawning.settings.items():
                scope, block = spawning.scope, setting.initial
                found.setdefault(
                    element, (PlacedBlock(element, 0, block, "initialiser", scope, scope.visible),)
                )
        return found

    def elements(self) -> Iterator[Element]:
        """Yield every element of the program, in an order that depends only on its structure."""
        for scope in self.scopes:
            if scope.noun:
                yield Element("machine", scope.path)
            yield from (Element("variable", (*scope.path, name)) for name in scope.variables)
            yield from (Element("event", (*scope.path, name)) for name in scope.events)
            for name in scope.states:
                for kind in ("state", "onentry", "running", "onexit"):
                    yield Element(kind, (*scope.path, name))
            for arrow in self.arrows[scope]:
                yield arrow.element
                if arrow.noun.effect:
                    yield effect_of(arrow.element)
        for spawning in self.spawns:
            yield spawning.element
            yield from spawning.settings
        yield from (Element(kind, ()) for kind in self.hooks)

    def places(self, machine: Path) -> tuple[Path, ...]:
        """Return the paths as spawned that a machine, by path of definition, can have; at most :data:`MOST`.

        Where nothing spawns a machine that is nested in a state, its place is there.
        """
        return tuple(islice(self._places(machine, ()), MOST))

    def _places(self, machine: Path, inside: tuple[Path, ...]) -> Iterator[Path]:
        scope = self.by_path[machine]
        uses = [each for each in self.spawns if each.machine is scope]
        spawners = dict.fromkeys(each.spawner for each in uses) if uses else {machine[:-1]: None}
        for spawner in spawners:
            if not spawner:
                yield machine[-1:]
            elif spawner[:-1] not in inside:
                outer = self._places(spawner[:-1], (*inside, machine))
                yield from ((*place, spawner[-1], machine[-1]) for place in outer)

    def is_shared(self, machine: Path) -> bool:
        """Return whether a machine, by path of definition, can run in several places."""
        found = self._shared.get(machine)
        if found is None:
            places = self._places(machine, ()) if machine in self.by_path and machine else ()
            found = self._shared[machine] = len([*islice(places, 2)]) > 1
        return found

    def around(self, spawned: Path) -> tuple[Path, ...]:
        """Return the states around a machine, whose path is as spawned, by their paths of definition."""
        ends = range(1, len(spawned) - 1, 2)
        return tuple([(*self.defined(spawned[:end]), spawned[end]) for end in ends])

    def defined(self, spawned: Path) -> Path:
        """Return where the machine with a path *as spawned* is defined; its own path if it is not defined."""
        found = self._defined.get(spawned)
        if found is None:
            scope: Scope | None = self.top.machines.get("", {}).get(spawned[0]) if spawned else None
            for at in range(1, len(spawned) - 1, 2):
                scope = None if scope is None else scope.machine(spawned[at], spawned[at + 1])
            found = self._defined[spawned] = spawned if scope is None else scope.path
        return found


def resolve(program: Program) -> Resolution:
    """Return the resolved names of a program; the result is cached with the program."""
    kept: dict[str, Resolution] = program.__dict__
    found = kept.get("_resolution")
    if found is None:
        found = kept["_resolution"] = Resolution(program)
    return found


class _EarlierVariables(Mapping[str, Scope]):
    """The variables visible to an initialiser: those outside its scope, and the earlier ones in it.

    A view, because a copy for each of 10,000 variables would be fifty million entries.
    """

    def __init__(self, scope: Scope, places: Mapping[str, int], end: int) -> None:
        self._scope = scope
        self._outside: Mapping[str, Scope] = scope.outer.visible if scope.outer else {}
        self._places = places
        self._end = end

    def __getitem__(self, name: str) -> Scope:
        return self._scope if self._places.get(name, self._end) < self._end else self._outside[name]

    def __iter__(self) -> Iterator[str]:
        yield from self._outside
        earlier = islice(self._places, self._end)
        yield from (name for name in earlier if name not in self._outside)

    def __len__(self) -> int:
        return sum(1 for _ in self)


def _actions(
    found: dict[Element, tuple[PlacedBlock, ...]],
    element: Element,
    items: Sequence[Block | Spawn],
    scope: Scope,
) -> None:
    found[element] = tuple(
        [
            PlacedBlock(element, ordinal, item, "action", scope, scope.visible)
            for ordinal, item in enumerate(items)
            if isinstance(item, Block)
        ]
    )


def _define(scope: Scope, noun: Program | Machine, repeats: list[Repeat]) -> None:
    scope.variables = _first("variable", scope, scope.path, noun.variables, repeats)
    scope.events = _first("event", scope, scope.path, noun.events, repeats)
    outer = scope.outer
    scope.visible = _seen(outer.visible if outer else {}, scope.variables, scope)
    scope.visible_events = _seen(outer.visible_events if outer else {}, scope.events, scope)


def _seen(around: dict[str, Scope], own: Mapping[str, object], scope: Scope) -> dict[str, Scope]:
    return around | dict.fromkeys(own, scope) if own else around


def _machines(scope: Scope, state: str, machines: Sequence[Machine], repeats: list[Repeat]) -> None:
    if not machines:
        return
    inner = scope.machines[state] = {}
    around = (*scope.path, state) if state else ()
    for name, noun in _first("machine", scope, around, machines, repeats).items():
        machine = inner[name] = Scope((*around, name), scope, state, noun)
        _define(machine, noun, repeats)
        machine.states = _first("state", machine, machine.path, noun.states, repeats)
        for part_name, part in machine.states.items():
            _machines(machine, part_name, part.machines, repeats)


def _first(
    kind: str, scope: Scope, path: Path, definitions: Sequence[_Defined], repeats: list[Repeat]
) -> dict[str, _Defined]:
    """Return the first definition of each name; the others are repeats."""
    found: dict[str, _Defined] = {}
    for definition in definitions:
        name = str(definition.name)
        first = found.setdefault(name, definition)
        if first is not definition:
            repeats.append(Repeat(Element(kind, (*path, name)), scope, first, definition))
    return found

"""From a program to a plan: names resolved, blocks compiled, nothing running yet.

A plan is immutable and belongs to one program. An edit links the whole new program (compiled
blocks are cached, so this is cheap) and the interpreter swaps plans between two ticks; no plan
is ever patched in place. What does not resolve is kept as a sentence and becomes an issue when
the interpreter tries it, never before. Paper: §5.2, §6.2.
"""

from __future__ import annotations

import linecache
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import CodeType
from typing import NamedTuple

from lrp_jupyter.interpreter.issues import IssueKind
from lrp_jupyter.language.blocks import compile_block
from lrp_jupyter.language.program import (
    Block,
    Element,
    Event,
    Machine,
    Path,
    Program,
    Spawn,
    State,
    Transition,
    Variable,
)

__all__ = [
    "BlockPlan",
    "Broken",
    "EdgePlan",
    "EventPlan",
    "MachinePlan",
    "Plan",
    "Site",
    "SpawnPlan",
    "StatePlan",
    "VariablePlan",
    "link",
    "show_in_tracebacks",
]


@dataclass(frozen=True, slots=True)
class Broken:
    """Why something does not resolve; an issue once it is tried."""

    kind: IssueKind
    message: str


class Site(NamedTuple):
    """What a fault is charged to: an element, which of its blocks (from 0), where it stands."""

    element: Element
    ordinal: int
    offset: int


@dataclass(frozen=True, slots=True, eq=False)
class BlockPlan:
    """A compiled block."""

    site: Site
    code: CodeType | Broken


@dataclass(frozen=True, slots=True, eq=False)
class VariablePlan:
    """A variable and its initialiser, which sees the scope before the variable itself."""

    name: str
    noun: Variable
    initial: BlockPlan


@dataclass(frozen=True, slots=True, eq=False)
class EventPlan:
    """An event and the machine in whose scope its block runs (None: the top level)."""

    owner: Path
    block: BlockPlan


@dataclass(frozen=True, slots=True, eq=False)
class SpawnPlan:
    """A spawn, its machine resolved lexically; `start` is looked up when it is done."""

    site: Site
    start: str
    target: MachinePlan | Broken

    @property
    def identity(self) -> tuple[str, str]:
        """What it spawns, by name."""
        return self.site.element.path[-1], self.start

    @property
    def resolves(self) -> bool:
        """Whether machine and start state exist."""
        return not isinstance(self.target, Broken) and self.start in self.target.states


@dataclass(frozen=True, slots=True, eq=False)
class EdgePlan:
    """A transition; `test` is an event, an inline block, a delay in milliseconds, or None for `eps`."""

    site: Site
    label: str
    noun: Transition
    test: EventPlan | BlockPlan | str | int | Broken | None


@dataclass(slots=True, eq=False)
class StatePlan:
    """A state: its actions, and the edges that leave it in the order of the text."""

    name: str
    path: Path
    noun: State
    onentry: tuple[BlockPlan | SpawnPlan, ...] = ()
    running: tuple[BlockPlan, ...] = ()
    onexit: tuple[BlockPlan, ...] = ()
    edges: tuple[EdgePlan, ...] = ()
    machines: dict[str, MachinePlan] = field(default_factory=dict)


@dataclass(slots=True, eq=False)
class MachinePlan:
    """A machine; `outer` is the machine around it (None at the top level)."""

    name: str
    path: Path
    noun: Machine
    outer: MachinePlan | None
    variables: tuple[VariablePlan, ...] = ()
    events: dict[str, EventPlan] = field(default_factory=dict)
    states: dict[str, StatePlan] = field(default_factory=dict)


@dataclass(slots=True, eq=False)
class Plan:
    """A linked program."""

    program: Program
    variables: tuple[VariablePlan, ...] = ()
    events: dict[str, EventPlan] = field(default_factory=dict)
    machines: dict[Path, MachinePlan] = field(default_factory=dict)
    spawns: tuple[SpawnPlan, ...] = ()
    onpause: tuple[BlockPlan, ...] = ()
    onresume: tuple[BlockPlan, ...] = ()
    duplicates: tuple[Site, ...] = ()
    dangling: set[tuple[Element, IssueKind]] = field(default_factory=set)
    places: dict[Element, int] = field(default_factory=dict)

    def state(self, path: Path) -> StatePlan | None:
        """Find the state with this path of definition."""
        machine = self.machines.get(path[:-1])
        return machine.states.get(path[-1]) if machine else None


def link(program: Program) -> Plan:
    """Resolve every name of a program and compile its blocks.

    The plan is kept with the program: whoever has a text checked can link it there and then, on a
    thread of its own, so that the loop stands still only for the swap.
    """
    kept: dict[str, Plan] = program.__dict__
    if "_plan" not in kept:
        kept["_plan"] = _Linker(program).link()
    return kept["_plan"]


def show_in_tracebacks(program: Program) -> None:
    """Register the text with :mod:`linecache`: tracebacks and debuggers show the lines that run."""
    text = program.text.encode("utf-8", "replace").decode()  # a traceback cannot hold half a character
    lines = [line.rstrip() + "\n" for line in _LINE_END.split(text)]  # else its carets stand askew
    linecache.cache[program.filename] = (len(program.text), None, lines, program.filename)


_LINE_END = re.compile(r"\r\n|\r|\n")


class _Linker:
    def __init__(self, program: Program) -> None:
        self.plan = Plan(program)
        self.duplicates: list[Site] = []

    def link(self) -> Plan:
        plan, program = self.plan, self.plan.program
        plan.variables = self._variables((), program.variables, frozenset())
        scope = frozenset(variable.name for variable in plan.variables)
        plan.events = self._events((), program.events, scope)
        tops = self._machines((), program.machines, None)
        for machine in tops.values():
            self._fill(machine, scope, (tops,))
        plan.spawns = tuple(self._spawn((), spawn, (tops,), None) for spawn in program.spawns)
        plan.onpause = tuple(self._blocks(Element("onpause", ()), program.onpause, scope))
        plan.onresume = tuple(self._blocks(Element("onresume", ()), program.onresume, scope))
        plan.duplicates = tuple(self.duplicates)
        plan.dangling = set(self._dangling())
        return plan

    def _dangling(self) -> Iterator[tuple[Element, IssueKind]]:
        """Yield what would be an issue if it were tried now."""
        spawns = list(self.plan.spawns)
        for machine in self.plan.machines.values():
            for state in machine.states.values():
                spawns += (item for item in state.onentry if isinstance(item, SpawnPlan))
                for edge in state.edges:
                    if isinstance(edge.test, Broken):
                        yield edge.site.element, edge.test.kind
                    if edge.noun.kind != "exit" and edge.noun.destination not in machine.states:
                        yield edge.site.element, "unknown state"
        for spawn in spawns:
            if isinstance(spawn.target, Broken):
                yield spawn.site.element, spawn.target.kind
            elif not spawn.resolves:
                yield spawn.site.element, "unknown state"

    def _first(self, element: Element, offset: int, known: Mapping[str, object]) -> bool:
        """Whether this definition counts: the first one of a name does."""
        if element.path[-1] in known:
            self.duplicates.append(Site(element, -1, offset))  # none of its blocks: no run resolves it
            return False
        self.plan.places[element] = offset
        return True

    def _machines(
        self, path: Path, nouns: tuple[Machine, ...], outer: MachinePlan | None
    ) -> dict[str, MachinePlan]:
        machines: dict[str, MachinePlan] = {}
        for noun in nouns:
            inner = (*path, str(noun.name))
            if self._first(Element("machine", inner), noun.span.start, machines):
                machines[inner[-1]] = plan = MachinePlan(inner[-1], inner, noun, outer)
                self.plan.machines[inner] = plan
        return machines

    def _fill(
        self, plan: MachinePlan, scope: frozenset[str], around: tuple[Mapping[str, MachinePlan], ...]
    ) -> None:
        """Link the inside of a machine; `around`: the machines that can be spawned, inside first."""
        noun = plan.noun
        plan.variables = self._variables(plan.path, noun.variables, scope)
        scope |= {variable.name for variable in plan.variables}
        plan.events = self._events(plan.path, noun.events, scope)
        for state in noun.states:
            path = (*plan.path, str(state.name))
            if self._first(Element("state", path), state.span.start, plan.states):
                plan.states[path[-1]] = StatePlan(path[-1], path, state)
        edges = [
            self._edge(plan, label, transition, scope)
            for label, transition in zip(noun.labels, noun.transitions, strict=True)
        ]
        for state_plan in plan.states.values():
            state_plan.edges = tuple(edge for edge in edges if edge.noun.leaves(state_plan.name))
            state_plan.machines = self._machines(state_plan.path, state_plan.noun.machines, plan)
            inside = (state_plan.machines, *around)
            for machine in state_plan.machines.values():
                self._fill(machine, scope, inside)
            self._actions(state_plan, plan, scope, inside)

    def _actions(
        self,
        state: StatePlan,
        machine: MachinePlan,
        scope: frozenset[str],
        around: tuple[Mapping[str, MachinePlan], ...],
    ) -> None:
        entry = Element("onentry", state.path)
        items: list[BlockPlan | SpawnPlan] = []
        for ordinal, item in enumerate(state.noun.onentry):
            if isinstance(item, Spawn):
                items.append(self._spawn(state.path, item, around, machine))
            else:
                items.append(self._block(entry, ordinal, item, scope))
        state.onentry = tuple(items)
        self.plan.places[entry] = state.noun.span.start
        state.running = tuple(self._blocks(Element("running", state.path), state.noun.running, scope))
        state.onexit = tuple(self._blocks(Element("onexit", state.path), state.noun.onexit, scope))

    def _variables(
        self, path: Path, nouns: tuple[Variable, ...], scope: frozenset[str]
    ) -> tuple[VariablePlan, ...]:
        variables: dict[str, VariablePlan] = {}
        for noun in nouns:
            name = str(noun.name)
            element = Element("variable", (*path, name))
            if self._first(element, noun.span.start, variables):
                block = self._block(element, 0, noun.initial, scope | variables.keys())
                variables[name] = VariablePlan(name, noun, block)
        return tuple(variables.values())

    def _events(self, path: Path, nouns: tuple[Event, ...], scope: frozenset[str]) -> dict[str, EventPlan]:
        events: dict[str, EventPlan] = {}
        for noun in nouns:
            element = Element("event", (*path, str(noun.name)))
            if self._first(element, noun.span.start, events):
                events[element.path[-1]] = EventPlan(path, self._block(element, 0, noun.condition, scope))
        return events

    def _blocks(
        self, element: Element, blocks: tuple[Block, ...], scope: frozenset[str]
    ) -> Iterator[BlockPlan]:
        for ordinal, block in enumerate(blocks):
            yield self._block(element, ordinal, block, scope)

    def _block(self, element: Element, ordinal: int, block: Block, scope: frozenset[str]) -> BlockPlan:
        self.plan.places.setdefault(element, block.span.start)
        code: CodeType | Broken
        try:
            code = compile_block(block, scope, self.plan.program.filename)
        except SyntaxError as error:  # a `nonlocal` whose variable is gone, say: no error of the text
            code = Broken("unknown variable", f"the block cannot be linked: {error.msg}")
        else:
            name = ".".join((*element.path[-1:], element.kind))
            code = code.replace(co_name=name, co_qualname=name)
        return BlockPlan(Site(element, ordinal, block.span.start), code)

    def _edge(self, machine: MachinePlan, label: str, noun: Transition, scope: frozenset[str]) -> EdgePlan:
        element = Element("transition", (*machine.path, label))
        self.plan.places[element] = noun.span.start
        trigger = noun.trigger
        test: EventPlan | BlockPlan | str | int | Broken | None
        if isinstance(trigger, Block):
            test = self._block(element, 0, trigger, scope)
        elif trigger is None or isinstance(trigger, int):
            test = trigger
        elif noun.kind == "ontime":
            name = str(trigger)
            test = name if name in scope else Broken("unknown variable", f"there is no variable `{name}`")
        else:
            test = self._event(machine, str(trigger))
        return EdgePlan(Site(element, 0, noun.span.start), label, noun, test)

    def _event(self, machine: MachinePlan | None, name: str) -> EventPlan | Broken:
        while machine is not None:
            if name in machine.events:
                return machine.events[name]
            machine = machine.outer
        return self.plan.events.get(name) or Broken("unknown event", f"there is no event `{name}`")

    def _spawn(
        self,
        path: Path,
        noun: Spawn,
        around: tuple[Mapping[str, MachinePlan], ...],
        spawner: MachinePlan | None,
    ) -> SpawnPlan:
        name, start = str(noun.machine), str(noun.state)
        element = Element("spawn", (*path, name))
        self.plan.places.setdefault(element, noun.span.start)
        enclosing = set()
        while spawner is not None:
            enclosing.add(spawner.path)
            spawner = spawner.outer
        found = next((m[name] for m in around if name in m and m[name].path not in enclosing), None)
        target = found or Broken(
            "unknown machine", f"there is no machine `{name}` that could be spawned here"
        )
        return SpawnPlan(Site(element, 0, noun.span.start), start, target)

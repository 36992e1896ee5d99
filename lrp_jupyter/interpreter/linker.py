"""The linker: compiles a program to a plan, with names resolved and blocks compiled.

A plan is immutable and belongs to one program, which caches it. It is a tree: elements that could form a
cycle refer to machines by path, so that an old plan is freed as soon as it is replaced, without the garbage
collector, whose collections stop the loop. An edit links the whole new program (compiled blocks are cached,
so this is cheap) and the interpreter swaps plans between two ticks; a plan is never patched in place. An
unresolved reference is kept as a sentence and becomes an issue only when the interpreter tries it. Paper:
§5.2, §6.2.
"""

from __future__ import annotations

import linecache
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import CodeType
from typing import NamedTuple

from lrp_jupyter.interpreter.cells import captures_of
from lrp_jupyter.interpreter.issues import IssueKind
from lrp_jupyter.language.blocks.block import compile_block, words_of
from lrp_jupyter.language.blocks.computed_names import value_cell
from lrp_jupyter.language.program import (
    Element,
    Event,
    Path,
    Program,
    State,
    Transition,
    Variable,
    effect_of,
)
from lrp_jupyter.language.python.scanner import LINE_END
from lrp_jupyter.language.resolution import Arrow, PlacedBlock, Resolution, Scope, Spawning, resolve
from lrp_jupyter.language.triggers import Delay


@dataclass(frozen=True, slots=True)
class Broken:
    """Why a reference does not resolve; becomes an issue once it is tried."""

    kind: IssueKind
    message: str


class Site(NamedTuple):
    """The place of a fault: an element, the index of its block, and the offset in the text."""

    element: Element
    ordinal: int
    offset: int


@dataclass(slots=True, eq=False)
class BlockPlan:
    """A compiled block."""

    site: Site
    code: CodeType | Broken

    @property
    def reads(self) -> tuple[str, ...]:
        """The names that it mentions: variables, and names provided to every program."""
        return () if isinstance(self.code, Broken) else self.code.co_freevars


@dataclass(frozen=True, slots=True, eq=False)
class VariablePlan:
    """A variable and its initialiser, which sees the scope before the variable itself."""

    name: str
    noun: Variable
    initial: BlockPlan
    captures: tuple[str, ...] = field(init=False)
    """The names to which functions in its initialiser refer."""

    def __post_init__(self) -> None:
        code = self.initial.code
        captures = () if isinstance(code, Broken) else captures_of(code)
        object.__setattr__(self, "captures", captures)


@dataclass(frozen=True, slots=True, eq=False)
class EventPlan:
    """An event and the machine in whose scope its block runs (None: the top level)."""

    owner: Path
    noun: Event
    block: BlockPlan


@dataclass(frozen=True, slots=True, eq=False)
class SpawnPlan:
    """A spawn with its machine resolved lexically, by path; `start` is looked up when it is executed.

    `resolves`: whether machine and start state exist.
    `settings`: for variables of the machine, the initialisers of this use, which see the scope of the spawn.
    `inside`: of a machine started alone, the states around it, as spawned; see ``alone``.
    """

    site: Site
    start: str
    target: Path | Broken
    resolves: bool
    settings: Mapping[str, VariablePlan]
    inside: Path = ()

    @property
    def identity(self) -> tuple[str, str]:
        """The names of the machine and of its start state."""
        return self.site.element.path[-1], self.start


@dataclass(frozen=True, slots=True, eq=False)
class EdgePlan:
    """A transition.

    `test`: the event or block to test, the reason for its absence, or None.
    `watched`: for a machine's state, the machine by the name of the source that spawns it.
    `hold`: the block after ``for``, the reason for the absence of the variable there, or None.
    """

    site: Site
    label: str
    noun: Transition
    test: EventPlan | BlockPlan | Broken | None
    watched: Mapping[str, Path]
    hold: BlockPlan | Broken | None
    effect: tuple[BlockPlan, ...]

    def means(self, source: str) -> object:
        """Return what it tests in a source: while that stays the same, its time of holding goes on."""
        test = self.test
        if isinstance(test, EventPlan):
            return test.noun.condition
        return self.noun.trigger, self.watched.get(source)


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
    waits: bool = False
    """Whether a transition that leaves it waits for a time."""
    departs: bool = False
    """Whether leaving it needs more than its onexit: it has times to end, or to remember."""


@dataclass(slots=True, eq=False)
class MachinePlan:
    """A machine; `outer` is the path of the enclosing machine (empty at the top level)."""

    name: str
    path: Path
    outer: Path
    variables: tuple[VariablePlan, ...] = ()
    events: dict[str, EventPlan] = field(default_factory=dict)
    states: dict[str, StatePlan] = field(default_factory=dict)


@dataclass(slots=True, eq=False)
class Plan:
    """A linked program."""

    variables: tuple[VariablePlan, ...] = ()
    events: dict[str, EventPlan] = field(default_factory=dict)
    machines: dict[Path, MachinePlan] = field(default_factory=dict)
    spawns: tuple[SpawnPlan, ...] = ()
    hooks: Mapping[str, tuple[BlockPlan, ...]] = field(default_factory=dict)
    duplicates: tuple[Site, ...] = ()
    dangling: set[tuple[Element, IssueKind]] = field(default_factory=set)
    places: dict[Element, int] = field(default_factory=dict)
    blocks: tuple[BlockPlan, ...] = ()
    alone: SpawnPlan | None = None

    @property
    def beginning(self) -> tuple[SpawnPlan, ...]:
        """What a run begins with: the spawns at the top level, or the machine that is started alone."""
        return self.spawns if self.alone is None else (self.alone,)

    def tests(self) -> Iterator[tuple[Element, object]]:
        """Yield each transition, for each of its sources, and what it tests there."""
        for machine in self.machines.values():
            for state in machine.states.values():
                yield from ((edge.site.element, edge.means(state.name)) for edge in state.edges)

    def state(self, path: Path) -> StatePlan | None:
        """Return the state with this path of definition, or None."""
        machine = self.machines.get(path[:-1])
        return machine.states.get(path[-1]) if machine else None


def spawn_of(items: Iterable[object], machine: Path) -> SpawnPlan | None:
    """Return the spawn of a machine, by path of definition, among some items, or None."""
    return next((item for item in items if isinstance(item, SpawnPlan) and item.target == machine), None)


def link(program: Program) -> Plan:
    """Resolve every name of a program and compile its blocks.

    The plan is cached with the program: a caller that checks a text on another thread can also link it there,
    so that the loop is blocked only for the swap.
    """
    kept: dict[str, Plan] = program.__dict__
    if "_plan" not in kept:
        kept["_plan"] = _Linker(program).link()
    return kept["_plan"]


def show_in_tracebacks(program: Program) -> None:
    """Register the text with :mod:`linecache`: tracebacks and debuggers show the lines that run."""
    text = program.text.encode("utf-8", "replace").decode()  # a traceback cannot contain a lone surrogate
    lines = [line.rstrip() + "\n" for line in LINE_END.split(text)]  # otherwise carets are misaligned
    linecache.cache[program.filename] = (len(program.text), None, lines, program.filename)


def compiled(place: PlacedBlock, names: Resolution, filename: str, name: str) -> CodeType:
    """Compile a block of a program, or one that is evaluated in a scope of it.

    Raises SyntaxError: a `nonlocal` whose variable was removed, which the parser cannot know.
    """
    words = words_of(place.block)
    values, machines = names.computed
    return compile_block(
        place.block,
        place.visible,
        filename,
        name,
        frozenset([word for word in words & values if place.is_computed(word)]),
        frozenset([word for word in words & machines if place.machines(word)]),
    )


class _Linker:
    def __init__(self, program: Program) -> None:
        self.plan = Plan()
        self.filename = program.filename
        self.names = resolve(program)
        self.machines: dict[Scope, MachinePlan] = {}
        self.blocks: list[BlockPlan] = []
        self.spawns: dict[Path, dict[int, SpawnPlan]] = {}  # by the path of the state that spawns

    def link(self) -> Plan:
        plan, names = self.plan, self.names
        plan.duplicates = tuple(  # their blocks never run, so no run resolves their issue
            [Site(repeat.element, -1, repeat.again.span.start) for repeat in names.repeats]
        )
        for scope in names.scopes:
            if scope.noun is not None:
                outer = scope.outer.path if scope.outer else ()
                machine = MachinePlan(scope.path[-1], scope.path, outer)
                self.machines[scope] = plan.machines[scope.path] = machine
                plan.places[Element("machine", scope.path)] = scope.noun.span.start
        for spawning in names.spawns:
            self.spawns.setdefault(spawning.spawner, {})[spawning.ordinal] = self._spawn(spawning)
        plan.variables, plan.events = self._variables(names.top), self._events(names.top)
        for scope, machine in self.machines.items():
            machine.variables, machine.events = self._variables(scope), self._events(scope)
        for scope, machine in self.machines.items():
            self._fill(scope, machine)
        plan.spawns = tuple(self.spawns.get((), {}).values())
        plan.hooks = {kind: self._blocks(Element(kind, ())) for kind in names.hooks}
        # When copied all at once, the code of the blocks is contiguous in memory instead of scattered among
        # leftovers of the compiler: a ring of 1,000 states runs a third faster.
        for block in self.blocks:
            if not isinstance(block.code, Broken):
                block.code = block.code.replace()
        plan.blocks = tuple(self.blocks)
        return plan

    def _fill(self, scope: Scope, machine: MachinePlan) -> None:
        """Link the states and transitions of a machine."""
        leaving: dict[str, list[EdgePlan]] = {name: [] for name in scope.states}
        for arrow in self.names.arrows[scope]:
            edge = self._edge(arrow)
            for source in leaving if edge.noun.wildcard else dict.fromkeys(map(str, edge.noun.sources)):
                if source in leaving and edge.noun.leaves(source):
                    leaving[source].append(edge)
        for name, noun in scope.states.items():
            path = (*scope.path, name)
            state = machine.states[name] = StatePlan(name, path, noun)
            self.plan.places[Element("state", path)] = noun.span.start
            entry = Element("onentry", path)
            self.plan.places[entry] = noun.span.start
            state.onentry = self._entry(entry)
            if noun.running:
                state.running = self._blocks(Element("running", path))
            if noun.onexit:
                state.onexit = self._blocks(Element("onexit", path))
            state.edges = tuple(leaving[name])
            holds = any(edge.noun.hold for edge in state.edges)
            state.waits = holds or any(isinstance(edge.noun.trigger, Delay) for edge in state.edges)
            state.departs = holds or any(
                name.endswith(value_cell("")) for block in state.onexit for name in block.reads
            )

    def _entry(self, element: Element) -> tuple[BlockPlan | SpawnPlan, ...]:
        """Link the onentry items of a state: blocks and spawns, in the order of the text."""
        blocks = self._blocks(element)
        spawns = self.spawns.get(element.path)
        if spawns is None:
            return blocks
        items: dict[int, BlockPlan | SpawnPlan] = {**spawns}
        items.update((block.site.ordinal, block) for block in blocks)
        return tuple([items[ordinal] for ordinal in sorted(items)])

    def _variables(self, scope: Scope) -> tuple[VariablePlan, ...]:
        variables = []
        for name, noun in scope.variables.items():
            element = Element("variable", (*scope.path, name))
            self.plan.places[element] = noun.span.start
            variables.append(VariablePlan(name, noun, self._blocks(element)[0]))
        return tuple(variables)

    def _events(self, scope: Scope) -> dict[str, EventPlan]:
        events = {}
        for name, noun in scope.events.items():
            element = Element("event", (*scope.path, name))
            self.plan.places[element] = noun.span.start
            events[name] = EventPlan(scope.path, noun, self._blocks(element)[0])
        return events

    def _blocks(self, element: Element) -> tuple[BlockPlan, ...]:
        return tuple([self._block(code) for code in self.names.blocks.get(element, ())])

    def _block(self, place: PlacedBlock) -> BlockPlan:
        element, ordinal, block = place.element, place.ordinal, place.block
        self.plan.places.setdefault(element, block.span.start)
        name = f"{element.shown[-1]}.{element.kind}" if element.path else element.kind
        code: CodeType | Broken
        try:
            code = compiled(place, self.names, self.filename, name)
        except SyntaxError as error:  # such as a `nonlocal` whose variable was removed: the text is correct
            code = Broken("unknown variable", f"The block cannot be linked: {error.msg}.")
        self.blocks.append(BlockPlan(Site(element, ordinal, block.span.start), code))
        return self.blocks[-1]

    def _edge(self, arrow: Arrow) -> EdgePlan:
        element, noun = arrow.element, arrow.noun
        self.plan.places[element] = noun.span.start
        if not noun.outward and noun.destination not in arrow.scope.states:
            self.plan.dangling.add((element, "unknown state"))
        reference, owner, blocks = noun.trigger.reference, arrow.owner, self._blocks(element)
        test: EventPlan | BlockPlan | Broken | None = None
        unresolved = arrow.unresolved_trigger
        if unresolved is not None:
            self.plan.dangling.add((element, unresolved.kind))
            test = Broken(*unresolved)
        elif noun.trigger.block is not None:
            test = blocks[0]
        elif reference is not None and reference[0] == "event" and owner is not None:
            events = self.machines[owner].events if owner.noun else self.plan.events
            test = events[reference[1]]
        watched = {source: machine.path for source, machine in arrow.watched.items()}
        effect = self._blocks(effect_of(element)) if noun.effect else ()
        site = Site(element, 0, noun.span.start)
        hold: BlockPlan | Broken | None = None
        if noun.hold is not None and noun.hold.block is not None:
            hold = blocks[-1]
        elif arrow.unresolved_hold is not None:
            self.plan.dangling.add((element, arrow.unresolved_hold.kind))
            hold = Broken(*arrow.unresolved_hold)
        return EdgePlan(site, arrow.label, noun, test, watched, hold, effect)

    def _spawn(self, spawning: Spawning) -> SpawnPlan:
        element, noun, unresolved = spawning.element, spawning.noun, spawning.unresolved
        self.plan.places.setdefault(element, noun.span.start)
        if unresolved is not None:
            self.plan.dangling.add((element, unresolved.kind))
        target: Path | Broken
        if spawning.machine is None:
            assert unresolved is not None
            target = Broken(*unresolved)
        else:
            target = spawning.machine.path
        settings = {}
        for setting, variable in spawning.settings.items():
            self.plan.places[setting] = variable.span.start
            name = setting.path[-1]
            settings[name] = VariablePlan(name, variable, self._blocks(setting)[0])
        site = Site(element, 0, noun.span.start)
        return SpawnPlan(site, str(noun.state), target, unresolved is None, settings)

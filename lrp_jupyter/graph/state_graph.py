"""The program as a graph: states are nodes, transitions and spawns are edges.

A node is the path of a state as *defined*, ``("follower", "looking", "lookalgo", "lookleft")``.
A wildcard is expanded into one edge for every state that it leaves, because reachability must
follow them; with ``expand=False`` it is a single edge from a node ``*``, as pictures show it.

What refers to nothing is kept: its edge says why in ``dangling``, and a state that does not
exist is a node of kind ``missing``. The node ``()`` stands for the program itself: its edges
are the spawns at top level.

Paper: §3.1 (kinds of transitions, the fictional state ``*``).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import networkx as nx

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.language.program import (
    Block,
    Machine,
    Path,
    Program,
    Spawn,
    State,
    Transition,
    path_text,
)

if TYPE_CHECKING:
    StateGraph = nx.MultiDiGraph[Path]
else:
    StateGraph = nx.MultiDiGraph

__all__ = [
    "ANY",
    "PROGRAM",
    "arrow_text",
    "distinct_states",
    "events_in_scope",
    "find_machine",
    "outer_states",
    "start_states",
    "state_graph",
    "unreachable",
    "unspawned",
    "why_dangling",
]

ANY = "*"
"""Name of the fictional state that wildcards leave; no state can be called so."""
PROGRAM: Path = ()
"""The node of the program itself."""


def find_machine(program: Program, path: Sequence[str]) -> Machine:
    """Return the machine at a path.

    Parameters
    ----------
    program : Program
    path : sequence of str
        Names of machines and states in turn, as machines are *defined*.

    Raises
    ------
    UnknownElementError
        No machine is defined there.
    """
    wanted = tuple(path)
    for found, machine in program.walk():
        if found == wanted:
            return machine
    raise UnknownElementError(f"there is no machine `{path_text(wanted)}`")


def distinct_states(machine: Machine) -> dict[str, State]:
    """States of a machine by name, in the order of the text; of equal names the first counts."""
    states: dict[str, State] = {}
    for state in machine.states:
        states.setdefault(str(state.name), state)
    return states


def state_graph(program: Program, *, expand: bool = True) -> StateGraph:
    """Build the graph of all states of a program.

    Parameters
    ----------
    program : Program
    expand : bool
        Whether a wildcard becomes one edge for every state that it leaves (the default), or one
        edge from the node ``*`` of its machine.

    Returns
    -------
    networkx.MultiDiGraph
        Nodes have ``kind`` (``program``, ``state``, ``any``, ``missing``), ``name``, ``machine``
        (path) and ``machines`` (paths of the nested ones). Edges have the transition's label as
        key (``spawn MACHINE`` for a spawn) and ``kind`` (``on``, ``ontime``, ``eps``, ``exit``,
        ``spawn``), ``label``, ``condition`` (as written), ``text`` (as pictures show it),
        ``wildcard``, ``order`` (place in the machine) and ``dangling`` (why it cannot be taken, or
        None).
    """
    graph = _with_spawns(program)
    spawners = _spawners(graph)
    for path, machine in _machines(program).items():
        events = events_in_scope(program, path)
        for order, (label, transition) in enumerate(zip(machine.labels, machine.transitions, strict=True)):
            for source in _sources(graph, path, machine, transition, expand):
                for target, reason in _targets(spawners, path, transition):
                    dangling = reason or why_dangling(
                        transition,
                        source_exists=_ensure(graph, source) != "missing",
                        target_exists=_ensure(graph, target) == "state",
                        events=events,
                    )
                    graph.add_edge(
                        source,
                        target,
                        key=label,
                        kind=transition.kind,
                        label=label,
                        condition=transition.trigger_text,
                        text=arrow_text(transition),
                        wildcard=transition.wildcard,
                        order=order,
                        dangling=dangling,
                    )
    return graph


def _machines(program: Program) -> dict[Path, Machine]:
    machines: dict[Path, Machine] = {}
    for path, machine in program.walk():
        machines.setdefault(path, machine)
    return machines


def _with_spawns(program: Program) -> StateGraph:
    """Every state as a node, every spawn as an edge; no transitions yet."""
    graph: StateGraph = nx.MultiDiGraph()
    graph.add_node(PROGRAM, kind="program", name="", machine=(), machines=())
    machines = _machines(program)
    spawns: list[tuple[Path, Spawn, int]] = [(PROGRAM, spawn, i) for i, spawn in enumerate(program.spawns)]
    for path, machine in machines.items():
        for name, state in distinct_states(machine).items():
            inner = tuple((*path, name, str(nested.name)) for nested in state.machines)
            graph.add_node((*path, name), kind="state", name=name, machine=path, machines=inner)
            items = (item for item in state.onentry if isinstance(item, Spawn))
            spawns.extend(((*path, name), spawn, i) for i, spawn in enumerate(items))
    for source, spawn, order in spawns:
        found = _spawned_machine(machines, source, str(spawn.machine))
        target = (*(found or (*source, str(spawn.machine))), str(spawn.state))
        dangling = None
        if found is None:
            dangling = f"no machine `{spawn.machine}` can be spawned here"
        elif _ensure(graph, target) == "missing":
            dangling = f"`{spawn.machine}` has no state `{spawn.state}`"
        _ensure(graph, target)
        label = f"spawn {spawn.machine}"
        graph.add_edge(
            source,
            target,
            key=label,
            kind="spawn",
            label=label,
            condition="",
            text="",
            wildcard=False,
            order=order,
            dangling=dangling,
        )
    return graph


def _spawned_machine(machines: dict[Path, Machine], source: Path, name: str) -> Path | None:
    """Resolve a spawn lexically: in the state itself, then outward, never an enclosing machine."""
    for end in range(len(source), -1, -2):
        path = (*source[:end], name)
        if path in machines and path != source[: len(path)]:
            return path
    return None


def _spawners(graph: StateGraph) -> dict[Path, list[Path]]:
    """For each machine the states (or the program) that spawn it."""
    spawners: dict[Path, list[Path]] = {}
    for source, target, data in graph.edges(data=True):
        if data["kind"] == "spawn":
            spawners.setdefault(target[:-1], []).append(source)
    return spawners


def _ensure(graph: StateGraph, path: Path) -> str:
    """Return the kind of a node; one that does not exist yet becomes a missing state."""
    if path not in graph:
        graph.add_node(path, kind="missing", name=path[-1], machine=path[:-1], machines=())
    return str(graph.nodes[path]["kind"])


def _sources(
    graph: StateGraph, path: Path, machine: Machine, transition: Transition, expand: bool
) -> list[Path]:
    if not transition.wildcard:
        return [(*path, str(name)) for name in dict.fromkeys(transition.sources)]
    if expand:
        return [(*path, name) for name in distinct_states(machine) if transition.leaves(name)]
    graph.add_node((*path, ANY), kind="any", name=ANY, machine=path, machines=())
    return [(*path, ANY)]


def _targets(
    spawners: dict[Path, list[Path]], path: Path, transition: Transition
) -> list[tuple[Path, str | None]]:
    """Where a transition leads; an ``exit`` leads out of every machine that spawns its own."""
    name = str(transition.destination)
    if transition.kind != "exit":
        return [((*path, name), None)]
    outer = dict.fromkeys(spawner[:-1] for spawner in spawners.get(path, ()) if spawner)
    if not outer:
        return [((*path[:-2], name), "no state spawns this machine, so there is nothing to exit to")]
    return [((*machine, name), None) for machine in outer]


def events_in_scope(program: Program, path: Path) -> frozenset[str]:
    """Names of the events that a transition of the machine at `path` can use."""
    names = {str(event.name) for event in program.events}
    machines: tuple[Machine, ...] = program.machines
    for index in range(0, len(path), 2):
        found = next((machine for machine in machines if machine.name == path[index]), None)
        if found is None:
            break
        names.update(str(event.name) for event in found.events)
        state = distinct_states(found).get(path[index + 1]) if index + 1 < len(path) else None
        machines = state.machines if state else ()
    return frozenset(names)


def arrow_text(transition: Transition) -> str:
    """Say when a transition is taken, as its arrow in a picture does."""
    if transition.kind == "eps":
        text = "ε"
    elif transition.kind == "ontime":
        trigger = transition.trigger
        text = f"{trigger} ms" if isinstance(trigger, int) else f"after {transition.trigger_text}"
    elif isinstance(transition.trigger, Block):
        text = f"[{transition.trigger.text.strip()}]"
    else:
        text = transition.trigger_text
    if transition.wildcard and transition.sources:
        text += " (not " + ", ".join(transition.sources) + ")"
    return text


def why_dangling(
    transition: Transition, *, source_exists: bool, target_exists: bool, events: frozenset[str] | None
) -> str | None:
    """Say why a transition can never be taken, or None.

    Parameters
    ----------
    transition : Transition
    source_exists, target_exists : bool
    events : frozenset of str or None
        Names of the events in scope; None where they are not known.
    """
    if not target_exists:
        return f"there is no state `{transition.destination}`"
    if not source_exists:
        return f"a state that it leaves does not exist: `{transition.source_text}`"
    needs_event = transition.kind in ("on", "exit") and not isinstance(transition.trigger, Block)
    if needs_event and events is not None and str(transition.trigger) not in events:
        return f"there is no event `{transition.trigger}`"
    return None


def start_states(program: Program) -> dict[Path, tuple[str, ...]]:
    """For each machine that is spawned somewhere, the states in which it starts."""
    starts: dict[Path, dict[str, None]] = {}
    for _, target, data in _with_spawns(program).edges(data=True):
        if data["dangling"] is None:
            starts.setdefault(target[:-1], {})[target[-1]] = None
    return {path: tuple(names) for path, names in starts.items()}


def outer_states(program: Program, path: Path) -> frozenset[str]:
    """Names of the states that an ``exit`` of the machine at `path` can lead to."""
    machines = _machines(program)
    spawners = _spawners(_with_spawns(program)).get(path, ())
    return frozenset(
        name for spawner in spawners if spawner for name in distinct_states(machines[spawner[:-1]])
    )


def unreachable(program: Program) -> tuple[Path, ...]:
    """States that no run can ever make active, in the order of the text.

    Conditions are taken to be possible: what cannot be reached in this graph cannot be reached
    at all, except by forcing. A transition or spawn that dangles leads nowhere.
    """
    graph = state_graph(program)
    usable = nx.subgraph_view(graph, filter_edge=lambda a, b, key: graph.edges[a, b, key]["dangling"] is None)
    reached = nx.descendants(usable, PROGRAM)
    return tuple(
        path for path, data in graph.nodes(data=True) if data["kind"] == "state" and path not in reached
    )


def unspawned(program: Program) -> tuple[Path, ...]:
    """Machines that nothing spawns, in the order of the text."""
    spawned = start_states(program)
    return tuple(path for path in _machines(program) if path not in spawned)

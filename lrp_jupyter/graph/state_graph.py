"""The program as a graph: states are nodes, transitions and spawns are edges.

A node is the path of a state as *defined*, ``("follower", "looking", "lookalgo", "lookleft")``.
A wildcard is expanded into one edge for every state that it leaves, because reachability follows
edges; with ``expand=False`` it is a single edge from a node ``*``, as in pictures.

Unresolved references are kept: the ``dangling`` attribute of an edge holds the reason, and a state
that does not exist is a node of kind ``missing``. The node ``()`` is the program itself: its edges are
the spawns at top level.

Paper: §3.1 (kinds of transitions, the fictional state ``*``).
"""

from __future__ import annotations

from collections.abc import Container, Iterable
from itertools import takewhile
from typing import TYPE_CHECKING

from lrp_jupyter.arguments import A_PROGRAM, check_type
from lrp_jupyter.graph.labels import arrow_text
from lrp_jupyter.language.lookup import definition_of, find
from lrp_jupyter.language.program import Machine, Path, Program, State, Transition, path_text
from lrp_jupyter.language.resolution import Arrow, Resolution, resolve

if TYPE_CHECKING:
    import networkx as nx

    StateGraph = nx.MultiDiGraph[Path]

ANY = "*"  # name of the fictional state that wildcards leave; not a valid name of a real state
PROGRAM: Path = ()  # the node of the program itself


def find_machine(program: Program, path: str | Path) -> Machine:
    """Return a machine, by name or path.

    Raises UnknownElementError: there is none, or there are several.
    """
    found = definition_of(program, find(program, "machine", path))
    assert isinstance(found, Machine)
    return found


def distinct_states(machine: Machine) -> dict[str, State]:
    """Return the states of a machine by name, in the order of the text; of equal names the first counts."""
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
        ``spawn``), ``label``, ``condition`` (as written), ``text`` and ``style`` (as in pictures),
        ``wildcard``, ``order`` (index in the machine) and ``dangling`` (why it can never fire, or
        None).
    """
    check_type("program", program, Program, A_PROGRAM)
    names = resolve(program)
    graph = _states_and_spawns(names)
    for scope, arrows in names.arrows.items():
        events = frozenset(scope.visible_events)
        for order, arrow in enumerate(arrows):
            noun = arrow.noun
            for source in _sources(graph, arrow, expand):
                for target, reason in _targets(arrow):
                    dangling = reason or why_dangling(
                        noun,
                        source_exists=_ensure(graph, source) != "missing",
                        target_exists=_ensure(graph, target) == "state",
                        events=events,
                    )
                    graph.add_edge(
                        source,
                        target,
                        key=arrow.label,
                        kind=noun.kind,
                        label=arrow.label,
                        condition=noun.trigger_text,
                        text=arrow_text(noun),
                        style=noun.style,
                        wildcard=noun.wildcard,
                        order=order,
                        dangling=dangling,
                    )
    return graph


def _states_and_spawns(names: Resolution) -> StateGraph:
    """Return every state as a node and every spawn as an edge; no transitions yet."""
    import networkx as nx  # slow to import, and needed only here

    graph: StateGraph = nx.MultiDiGraph()
    graph.add_node(PROGRAM, kind="program", name="", machine=(), machines=())
    for scope in names.scopes:
        for name, state in scope.states.items():
            inner = tuple((*scope.path, name, str(nested.name)) for nested in state.machines)
            graph.add_node((*scope.path, name), kind="state", name=name, machine=scope.path, machines=inner)
    for spawning in names.spawns:
        noun, source = spawning.noun, spawning.spawner
        machine = spawning.machine.path if spawning.machine else (*source, str(noun.machine))
        target = (*machine, str(noun.state))
        dangling = None
        if spawning.machine is None:
            dangling = f"No machine `{noun.machine}` can be spawned here."
        elif spawning.unresolved:
            dangling = f"The machine `{noun.machine}` has no state `{noun.state}`."
        _ensure(graph, target)
        label = f"spawn {noun.machine}"
        graph.add_edge(
            source,
            target,
            key=label,
            kind="spawn",
            label=label,
            condition="",
            text="",
            style="spawn",
            wildcard=False,
            order=spawning.ordinal,
            dangling=dangling,
        )
    return graph


def _ensure(graph: StateGraph, path: Path) -> str:
    """Return the kind of a node; one that does not exist yet becomes a missing state."""
    if path not in graph:
        graph.add_node(path, kind="missing", name=path[-1], machine=path[:-1], machines=())
    return str(graph.nodes[path]["kind"])


def _sources(graph: StateGraph, arrow: Arrow, expand: bool) -> list[Path]:
    noun, path = arrow.noun, arrow.scope.path
    if not noun.wildcard:
        return [(*path, str(name)) for name in dict.fromkeys(noun.sources)]
    if expand:
        return [(*path, name) for name in arrow.scope.states if noun.leaves(name)]
    graph.add_node((*path, ANY), kind="any", name=ANY, machine=path, machines=())
    return [(*path, ANY)]


def _targets(arrow: Arrow) -> list[tuple[Path, str | None]]:
    """Return where a transition leads; an ``exit`` leads out of every machine that spawns its own."""
    name = str(arrow.noun.destination)
    if not arrow.homes:
        return [((*arrow.scope.path[:-2], name), NO_EXIT)]
    return [((*home.path, name), None) for home in arrow.homes]


NO_EXIT = "No state spawns this machine, so there is nothing to exit to."


def events_in_scope(program: Program, path: Path) -> frozenset[str]:
    """Return the names of the events that a transition of the machine at `path` can use."""
    names = resolve(program)
    return frozenset(names.by_path.get(path, names.top).visible_events)


def why_dangling(
    transition: Transition, *, source_exists: bool, target_exists: bool, events: Container[str] | None
) -> str | None:
    """Return why a transition can never fire, or None; `events` in scope are None where they are unknown."""
    if not target_exists:
        return f"There is no state `{transition.destination}`."
    if not source_exists:
        return f"A state that it leaves does not exist: `{transition.source_text}`."
    kind, name = transition.trigger.reference or ("", "")
    if kind == "event" and events is not None and name not in events:
        return f"There is no event `{name}`."
    return None


def start_states(program: Program) -> dict[Path, tuple[str, ...]]:
    """Return, for each machine that is spawned somewhere, the states in which it starts."""
    return {scope.path: starts for scope, starts in resolve(program).starts.items()}


def outer_states(program: Program, path: Path) -> frozenset[str]:
    """Return the names of the states that an ``exit`` of the machine at `path` can lead to."""
    names = resolve(program)
    scope = names.by_path.get(path)
    return frozenset(name for home in names.outside(scope) for name in home.states) if scope else frozenset()


def unreachable(program: Program) -> tuple[Path, ...]:
    """Return the states that no run can ever make active, in the order of the text.

    Every condition is assumed to be satisfiable: what cannot be reached in this graph cannot be reached
    at all, except by forcing. Dangling transitions and spawns are ignored.
    """
    import networkx as nx  # slow to import, and needed only here

    graph = state_graph(program)
    usable = nx.subgraph_view(graph, filter_edge=lambda a, b, key: graph.edges[a, b, key]["dangling"] is None)
    reached = nx.descendants(usable, PROGRAM)
    return tuple(
        path for path, data in graph.nodes(data=True) if data["kind"] == "state" and path not in reached
    )


def unspawned(program: Program) -> tuple[Path, ...]:
    """Return the machines that nothing spawns, in the order of the text."""
    names = resolve(program)
    return tuple(scope.path for scope in names.scopes if scope.noun and scope not in names.starts)


class DefinedPaths:
    """Maps paths of running elements to the paths of their definitions.

    A running element is named by the way it was spawned, a node of the graph by where it is defined; they
    differ where a machine is spawned from elsewhere than the state that contains it.
    """

    def __init__(self, program: Program) -> None:
        self.machine = resolve(program).defined

    def member(self, spawned: Path) -> Path:
        """Return the path of a state or variable: its own name after the path of its machine."""
        return (*self.machine(spawned[:-1]), spawned[-1]) if len(spawned) > 1 else spawned

    def active_states(self, innermost: tuple[Path, ...]) -> list[str]:
        """Return the paths of all active states, outer ones included, as text, each once, in order."""
        every = (path[:end] for path in innermost for end in range(2, len(path) + 1, 2))
        return list(dict.fromkeys(path_text(self.member(path)) for path in every))

    def users(self, innermost: Iterable[Path]) -> dict[str, str]:
        """Return in which states a machine runs that runs in several, by the paths of its active states.

        As the text of a tag: without the names with which the paths of all these states begin and end.
        """
        running: dict[Path, dict[Path, str]] = {}  # by machine, by the path as spawned: the active state
        for path in innermost:
            for end in range(2, len(path) + 1, 2):
                spawned = path[: end - 1]
                running.setdefault(self.machine(spawned), {})[spawned] = path[end - 1]
        users: dict[str, str] = {}
        for machine, instances in running.items():
            if len(instances) == 1:
                continue
            begin = _shared(spawned[:-1] for spawned in instances)
            end = _shared(spawned[-2:begin:-1] for spawned in instances)
            for spawned, state in instances.items():
                user = path_text(spawned[begin : len(spawned) - 1 - end]) or "top level"
                at = path_text((*machine, state))
                users[at] = f"{users[at]}, {user}" if at in users else user
        return users


def _shared(paths: Iterable[Path]) -> int:
    """Return how many names the paths begin with that are the same in all of them."""
    return sum(1 for _ in takewhile(lambda names: len(set(names)) == 1, zip(*paths, strict=False)))

"""Forced states: *transition here*, *teleport here* and *fire now*. Paper: §6.4.

They affect only the part of the tree below the innermost running machine that contains the target. Missing
machines on the path down are created, and the states around the target are entered with all else that they
spawn: the result is a configuration that the program can reach.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Literal

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.linker import SpawnPlan, StatePlan, spawn_of
from lrp_jupyter.interpreter.run import Run
from lrp_jupyter.interpreter.trace_events import TraceEvent
from lrp_jupyter.interpreter.tree import Activation, Edge, Row, bind_block, chained
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.lookup import find, places_called
from lrp_jupyter.language.program import Path, path_text
from lrp_jupyter.language.resolution import resolve

How = Literal["transition", "teleport", "fire"]


def find_state(run: Run, wanted: str | Path) -> Path:
    """Return the path of a state as spawned: in a running instance of its machine, or where one can run.

    Raises UnknownElementError: there is none, or there are several.
    """
    path, named = find(run.program, "state", wanted).path, as_path(wanted)
    machine = path[:-1]
    running = [act.path for act in run.walk() if act.defined == machine]
    return (*_chosen(run, machine, named, running), path[-1])


def find_edge(run: Run, wanted: str | Path) -> tuple[Path, Edge]:
    """Return where a transition leads from the active state, by path as spawned, and the transition.

    Raises UnknownElementError: there is no such transition, or there are several.
    Raises ValueError: the active state is not one of its sources, or it leads nowhere.
    """
    element = find(run.program, "transition", wanted)
    edges = (edge for act in run.walk() for edge in chained(act.row.edge))
    found = {edge.path: edge for edge in edges if edge.plan.site.element == element}
    machine = _chosen(run, element.path[:-1], as_path(wanted), list(found)) if found else ()
    if machine not in found:
        arrow = resolve(run.program).arrow(element)
        source = arrow and arrow.noun.source_text
        raise ValueError(f"None of the states that `{element.shown[-1]}` leaves is active: {source}.")
    edge = found[machine]
    if edge.target is None:
        raise ValueError(edge.missing)
    return (*edge.home.path, edge.target.name), edge


def _chosen(run: Run, machine: Path, named: Path, running: Sequence[Path]) -> Path:
    """Return the instance of a machine that the path of an element in it means, or where one can run.

    Raises UnknownElementError: several are possible.
    """
    places = places_called(run.program, machine, named[:-1], running) or [machine]
    if len(places) > 1:
        texts = [path_text((*place, named[-1])) for place in places]
        raise UnknownElementError.ambiguous("states", path_text(named), texts)
    return places[0]


def force(run: Run, where: Path, how: How, edge: Edge | None = None) -> StatePlan:
    """Make the state with a path as spawned active; all but a teleport run the onexit and onentry actions.

    Return the state.

    `edge`: the transition that is followed, with its effect.
    """
    run.remember()
    before = len(run.events)
    if edge is not None:
        for block in edge.plan.effect:
            run.attempt(bind_block(run, block, edge.act), block.site, edge.act)
    target = _go(run, where, blocks=how != "teleport")
    if run.observers:
        run.events.insert(before, TraceEvent("forced", where, run.ticks, run.now, how))
    return target


def _go(run: Run, where: Path, *, blocks: bool) -> StatePlan:
    """Leave the states in the way, then enter those on the path; `blocks`: with their actions."""
    defined = resolve(run.program).defined
    ends = range(1, len(where), 2)
    way = [run.plan.machines[defined(where[:end])].states[where[end]] for end in ends]
    depth = max((index for index, end in enumerate(ends) if where[:end] in run.live), default=-1)
    act = run.live[where[: ends[depth]]] if depth >= 0 else None
    if isinstance(act, Activation) and act.state is way[depth] and depth < len(way) - 1:
        _create(run, act, way[depth + 1 :], blocks)  # the enclosing state is active already, and stays
    elif isinstance(act, Activation):
        (run.leave if blocks else partial(_leave, run))(act)
        _enter(run, act, way[depth:], blocks)
    else:
        _enter(run, _root(run, way[0]), way, blocks)
    return way[-1]


def _root(run: Run, state: StatePlan) -> Activation:
    """Create a root machine as a top-level spawn does; if nothing is active, the program starts with it."""
    machine = run.plan.machines[state.path[:-1]]
    own = spawn_of(run.plan.spawns, machine.path)
    if not run.roots:
        if not run.started:
            run.begin()
        first = (spawn for spawn in run.plan.beginning if spawn.inside[:1] != machine.path)
        run.pending = frozenset(spawn.identity for spawn in first)
    run.pending -= {identity for identity in run.pending if identity[0] == machine.name}
    return run.create(machine, None, own, state)


def _create(run: Run, parent: Activation, way: Sequence[StatePlan], blocks: bool) -> None:
    """Create the machine of the first state on a way in a machine whose state contains or spawns it."""
    machine = run.plan.machines[way[0].path[:-1]]
    act = run.create(machine, parent, spawn_of(parent.state.onentry, machine.path), way[0])
    _enter(run, act, way, blocks)


def _enter(run: Run, act: Activation, way: Sequence[StatePlan], blocks: bool) -> None:
    """Enter the first state on a way and those inside it, with what they spawn; `blocks`: with actions."""
    row, inside = run.row(act, way[0]), way[1:]
    own = spawn_of(row.state.onentry, inside[0].path[:-1]) if inside else None
    run.enter(act, Row(row.state, row.path, row.count))
    act.row = row
    for action, plan in zip(chained(row.onentry), row.state.onentry, strict=True):
        if plan is own:
            _create(run, act, inside, blocks)
        elif isinstance(plan, SpawnPlan):
            run.spawn(act, plan, None if blocks else partial(_start, run))
        elif blocks:
            run.do(replace(action, next=None))
    if inside and own is None:
        _create(run, act, inside, blocks)


def _start(run: Run, act: Activation, row: Row) -> None:
    """Enter the start state of a machine without any action."""
    _enter(run, act, [row.state], blocks=False)


def _leave(run: Run, act: Activation) -> None:
    """Leave a state without running any onexit."""
    run.depart(act)
    run.discard(act, partial(_leave, run))
    run.has_left(act)

"""Forced states: *transition here*, *teleport here* and *fire now*. Paper: §6.4.

They affect only the part of the tree below the innermost running machine that contains the target. Missing
machines on the path down are created: enclosing states become active without their spawns, so that only the
path to the target is created.
"""

from __future__ import annotations

from functools import partial
from typing import Literal

from lrp_jupyter.interpreter.linker import SpawnPlan, StatePlan
from lrp_jupyter.interpreter.run import Run
from lrp_jupyter.interpreter.trace_events import TraceEvent
from lrp_jupyter.interpreter.tree import Activation, Row, chained
from lrp_jupyter.language.lookup import find
from lrp_jupyter.language.program import Path
from lrp_jupyter.language.resolution import resolve

How = Literal["transition", "teleport", "fire"]


def find_state(run: Run, wanted: str | Path) -> StatePlan:
    """Return a state.

    Raises UnknownElementError: there is none, or there are several.
    """
    *machine, name = find(run.program, "state", wanted).path
    return run.plan.machines[tuple(machine)].states[name]


def find_destination(run: Run, wanted: str | Path) -> StatePlan:
    """Return the state to which a transition leads from the active state of its machine.

    Raises UnknownElementError: there is no such transition, or there are several.
    Raises ValueError: the active state is not one of its sources, or it leads nowhere.
    """
    element = find(run.program, "transition", wanted)
    act = run.live.get(element.path[:-1])
    edges = chained(act.row.edge) if isinstance(act, Activation) else ()
    edge = next((each for each in edges if each.plan.site.element == element), None)
    if edge is None:
        arrow = resolve(run.program).arrow(element)
        source = arrow and arrow.noun.source_text
        raise ValueError(f"None of the states that `{element.shown[-1]}` leaves is active: {source}.")
    if edge.target is None:
        raise ValueError(edge.missing)
    return edge.target


def force(run: Run, target: StatePlan, how: How) -> None:
    """Make `target` active; all but a teleport run the onexit and onentry actions on the path."""
    run.remember()
    before = len(run.events)
    _go(run, target, blocks=how != "teleport")
    if run.observers:  # the target's path as spawned is only known now
        where = (*run.live[target.path[:-1]].path, target.name)
        run.events.insert(before, TraceEvent("forced", where, run.ticks, run.now, how))


def _go(run: Run, target: StatePlan, *, blocks: bool) -> None:
    """Leave the states in the way, then enter those on the path; `blocks`: with their actions."""
    way = [target]
    while (outer := run.plan.state(way[0].path[:-2])) is not None:
        way.insert(0, outer)
    depth = max((i for i, state in enumerate(way) if state.path[:-1] in run.live), default=-1)
    act = run.live.get(way[depth].path[:-1]) if depth >= 0 else None
    above = depth < len(way) - 1
    if isinstance(act, Activation) and act.state is way[depth] and above:
        depth += 1  # the enclosing state is already active and stays
    elif isinstance(act, Activation):
        (run.leave if blocks else partial(_leave, run))(act)
        _enter(run, act, way[depth], target, blocks)
        depth += 1
    else:
        depth = 0
    for state in way[depth:]:
        act = _create(run, state, act if isinstance(act, Activation) else None)
        _enter(run, act, state, target, blocks)


def _create(run: Run, state: StatePlan, parent: Activation | None) -> Activation:
    machine = run.plan.machines[state.path[:-1]]
    if parent is not None:
        return run.create(machine, parent, None, state)
    # A root machine starts as if by a top-level spawn; if nothing is active, the program starts with it.
    spawns = [spawn.identity for spawn in run.plan.spawns]
    own = next((identity for identity in spawns if identity[0] == machine.name), None)
    if not run.roots:
        if not run.started:
            run.begin()
        run.pending = frozenset(spawns)
    run.pending -= {identity for identity in run.pending if identity[0] == machine.name}
    return run.create(machine, None, own, state)


def _enter(run: Run, act: Activation, state: StatePlan, target: StatePlan, blocks: bool) -> None:
    """Enter a state on the path, or the target; only the target executes its spawns."""
    row = run.row(act, state)
    if blocks and state is target:
        run.enter(act, row)
    else:
        _enter_partly(run, act, row, blocks=blocks, spawns=state is target)


def _enter_partly(run: Run, act: Activation, row: Row, *, blocks: bool, spawns: bool) -> None:
    """Enter a state with only its blocks, only its spawns (recursively), or neither."""
    run.enter(act, Row(row.state, row.path, row.count))
    act.row = row
    for action, plan in zip(chained(row.onentry), row.state.onentry, strict=True):
        if isinstance(plan, SpawnPlan):
            if spawns:
                run.spawn(act, plan, partial(_enter_partly, run, blocks=blocks, spawns=True))
        elif blocks:
            run.attempt(action.call, plan.site)


def _leave(run: Run, act: Activation) -> None:
    """Leave a state without running any onexit."""
    run.discard(act, partial(_leave, run))
    run.emit("left", act.row.path)

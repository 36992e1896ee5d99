"""Forced states: *transition here* and *teleport here*. Paper: §6.4.

Both touch only what lies below the innermost running machine that contains the target. What is
missing on the way down is created: enclosing states become active without their spawns, so that
the way to the target is the only thing that is made.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.linker import StatePlan
from lrp_jupyter.interpreter.tree import Activation
from lrp_jupyter.language.program import Path, path_text

if TYPE_CHECKING:
    from lrp_jupyter.interpreter.run import Run

__all__ = ["find_state", "force"]


def find_state(run: Run, path: Path) -> StatePlan:
    """Find a state by its path of definition, or by its path as spawned.

    Raises
    ------
    UnknownElementError
        If there is none.
    """
    state = run.plan.state(path)
    if state is None:
        for root in run.roots:
            for act in root.walk():
                if act.path == path[:-1]:
                    state = act.machine.states.get(path[-1])
    if state is None:
        raise UnknownElementError(f"there is no state `{path_text(path)}`")
    return state


def force(run: Run, target: StatePlan, *, blocks: bool) -> None:
    """Make `target` active; `blocks`: run the onexit and onentry actions on the way."""
    way = [target]
    while (outer := run.plan.state(way[0].path[:-2])) is not None:
        way.insert(0, outer)
    depth = max((i for i, state in enumerate(way) if state.path[:-1] in run.live), default=-1)
    if depth < 0:
        act = _start_root(run, way[0])
        _enter(run, act, way[0], last=len(way) == 1, blocks=blocks)
        depth = 0
    else:
        act = run.live[way[depth].path[:-1]]  # type: ignore[assignment]
        if act.state is not way[depth] or depth == len(way) - 1:
            run.leave(act, blocks=blocks)
            _enter(run, act, way[depth], last=depth == len(way) - 1, blocks=blocks)
    for i, state in enumerate(way[depth + 1 :], depth + 1):
        machine = run.plan.machines[state.path[:-1]]
        act = run.create(machine, act, None, state)
        _enter(run, act, state, last=i == len(way) - 1, blocks=blocks)


def _enter(run: Run, act: Activation, state: StatePlan, *, last: bool, blocks: bool) -> None:
    run.enter(act, state, blocks=blocks, spawns=last)


def _start_root(run: Run, state: StatePlan) -> Activation:
    """Start the root machine of `state` as a top-level spawn does."""
    machine = run.plan.machines[state.path[:-1]]
    spawns = [spawn.identity for spawn in run.plan.spawns]
    own = next((identity for identity in spawns if identity[0] == machine.name), None)
    if not run.roots:
        if not run.started:
            run.begin()
        run.pending = frozenset(identity for identity in spawns if identity[0] != machine.name)
    else:
        run.pending -= {own} if own else set()
    return run.create(machine, None, own, state)

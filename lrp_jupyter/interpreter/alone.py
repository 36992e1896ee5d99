"""A machine started alone: what a run begins with instead of the spawns at the top level of the program.

The machines around it exist, in the states on the path to it, so that it finds their variables, and do not
run: they have no actions and no transitions. Its own `exit` leads one of them to another state, where nothing
happens.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from lrp_jupyter.errors import LRPError, UnknownElementError
from lrp_jupyter.interpreter.linker import Broken, Plan, Site, SpawnPlan, link
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.lookup import find, is_spawned, places_called
from lrp_jupyter.language.program import Element, Path, Program, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.successors import Successors


class Alone(NamedTuple):
    """A machine by path as spawned, and its first state; without one, that in which the program spawns it."""

    machine: Path
    state: str = ""

    @property
    def path(self) -> Path:
        """The path of the machine, or of the state."""
        return (*self.machine, self.state) if self.state else self.machine

    def is_inside(self, machine: Path) -> bool:
        """Return whether it is inside a machine, by path as spawned, which then does not run."""
        return len(machine) < len(self.machine) and self.machine[: len(machine)] == machine

    def after(self, before: Program, successors: Successors) -> Alone:
        """Return what it is after an edit of the program `before`."""
        state = (*resolve(before).defined(self.machine), self.state)
        name = (successors.path("state", state) or state)[-1] if self.state else ""
        return Alone(successors.instance(before, self.machine), name)


def alone(program: Program, wanted: str | Path) -> Alone:
    """Return the machine that a path of it, or of one of its states, means.

    Raises UnknownElementError: there is no such machine or state, or there are several.
    Raises LRPError: no state is named, and the program does not say which is the first.
    """
    path, element = as_path(wanted), find(program, ("machine", "state"), wanted)
    machine, named, state = element.path, path, ""
    if element.kind == "state":
        machine, named, state = element.path[:-1], path[:-1], path[-1]
    places = [named]
    if resolve(program).defined(named) != machine or not is_spawned(program, named):
        places = places_called(program, machine, named) or [machine]
    if len(places) > 1:
        texts = [path_text(Alone(place, state).path) for place in places]
        raise UnknownElementError.ambiguous(f"{element.kind}s", path_text(path), texts)
    found = Alone(places[0], state)
    spawn = _spawn(program, link(program), found)
    if isinstance(spawn.target, Broken):
        raise LRPError(spawn.target.message)
    return found


def linked(program: Program, start: Alone | None) -> Plan:
    """Return the plan of a program that begins with a machine alone; without one, with its own spawns."""
    plan = link(program)
    return plan if start is None else replace(plan, alone=_spawn(program, plan, start))


def _spawn(program: Program, plan: Plan, start: Alone) -> SpawnPlan:
    """Return how a machine is spawned alone, with the settings of the program's own spawn, if it has one."""
    path, names = start.machine, resolve(program)
    target, around = names.defined(path), names.around(path)
    spawner = plan.state(around[-1]) if around else None
    items = () if around and spawner is None else spawner.onentry if spawner else plan.spawns
    own = [item for item in items if isinstance(item, SpawnPlan) and item.target == target]
    first, problem = _first(program, start, [item.start for item in own if item.resolves])
    site = own[0].site if own else Site(Element("spawn", (*around[-1], path[-1]) if around else path), 0, 0)
    found = Broken("unknown machine", problem) if problem else target
    return SpawnPlan(site, first, found, not problem, own[0].settings if own else {}, path[:-1])


def _first(program: Program, start: Alone, spawned: list[str]) -> tuple[str, str]:
    """Return the first state, and why there is none.

    `spawned`: the states in which the program spawns it at this place.
    """
    names, text = resolve(program), path_text(start.machine)
    machine = names.by_path.get(names.defined(start.machine))
    if machine is None or machine.noun is None or not is_spawned(program, start.machine):
        return start.state, f"There is no machine `{text}` to start alone."
    known = dict.fromkeys(spawned or names.starts.get(machine, ()))
    first = start.state or (next(iter(known)) if len(known) == 1 else "")
    if first in machine.states:
        return first, ""
    listed = ", ".join(f"`{text}/{state}`" for state in known or machine.states)
    line = program.place(machine.noun.span.start)[0]
    how = "is spawned in several states" if known else "is never spawned"
    what = f"has no state `{first}`" if first else how
    return first, f"`{text}` (line {line}) {what}. To start it alone, name one of {listed}."

"""Live patching: decide the effect of an edit on a running program, then apply it.

:func:`decide` compares the running program with the new plan and changes nothing; :func:`adopt` swaps the
plans and carries over the tree of activations, and :func:`carry_issues` the issues, both with the same map
from old elements to new ones. This happens between two ticks, so an edit is applied as a whole or not at all.
Paper: §6.1.

Deviation: §6.1 restarts whenever the active state is gone. Here the old program keeps running until the new
one can start, so that a half-typed name does not stop the robot.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import CellType
from typing import Literal

from lrp_jupyter.interpreter.cells import Slot
from lrp_jupyter.interpreter.issues import Issue, IssueLog
from lrp_jupyter.interpreter.linker import Plan, SpawnPlan, StatePlan, VariablePlan, link
from lrp_jupyter.interpreter.run import Run
from lrp_jupyter.interpreter.tree import Activation, Environment
from lrp_jupyter.language.diff import ChangeSet
from lrp_jupyter.language.program import Element, Path, Program, Spawn
from lrp_jupyter.language.successors import Successors, is_inside

Policy = Literal["restart", "keep"]


@dataclass(frozen=True, slots=True)
class Patch:
    """The effect of an edit.

    `changes`: the differences in meaning.
    `applied`: if false, the old program keeps running, or a program without the part that is still being
        typed.
    `restarted`: whether the program starts again at the next tick.
    `reason`: a sentence about why it restarted, was not applied, or was applied only in part.
    """

    changes: ChangeSet
    applied: bool
    restarted: bool = False
    reason: str | None = None

    @property
    def successors(self) -> Successors:
        """The map from elements of the old program to those of the new one."""
        return self.changes.successors


@dataclass(frozen=True, slots=True)
class Decision:
    """The decision about a new plan."""

    apply: bool = True
    restart: bool = False
    reason: str | None = None


def decide(run: Run, plan: Plan, policy: Policy) -> Decision:
    """Decide the effect of an edit to `plan`, according to the table in the language reference."""
    startable = any(spawn.resolves for spawn in plan.spawns)
    acts = [*run.walk()]
    for act in acts:
        machine = plan.machines.get(act.machine.path)
        if machine is None or act.place[-1] not in machine.states:
            gone = f"The machine `{act.machine.name}`" if machine is None else f"`{act.place[-1]}`"
            if startable:
                return Decision(restart=True, reason=f"{gone} is active and was removed or renamed.")
            return Decision(
                apply=False,
                reason=f"{gone} is active but missing from the new text, where no `spawn` can start. "
                "The old program keeps running.",
            )
    new_spawns = {spawn.identity for spawn in plan.spawns}
    lost = [act.spawn for act in run.roots if act.spawn is not None and act.spawn not in new_spawns]
    if lost and startable:
        return Decision(restart=True, reason=f"`(spawn {' '.join(lost[0])})` was changed or removed.")
    reason = None
    if policy == "restart":
        for act in acts:
            new = plan.machines[act.machine.path].states[act.place[-1]]
            part = _changed_part(act.state, new)
            if part is not None:
                reason = f"`{act.place[-1]}` is active and its {part} changed."
                break
    if reason and startable:
        return Decision(restart=True, reason=reason)
    if lost:
        return Decision(reason=f"`(spawn {' '.join(lost[0])})` was removed. What it started keeps running.")
    return Decision(reason=reason and f"{reason} No `spawn` can start, so the program keeps running.")


def _changed_part(old: StatePlan, new: StatePlan) -> str | None:
    if old.noun.onentry != new.noun.onentry:
        before, after = ([x for x in s.noun.onentry if not isinstance(x, Spawn)] for s in (old, new))
        return "`onentry`" if before != after else "`spawn`"
    if old.noun.running != new.noun.running:
        return "`running`"
    return "`onexit`" if old.noun.onexit != new.noun.onexit else None


def adopt(run: Run, program: Program, successors: Successors, *, renamed: bool = False) -> None:
    """Swap plans and carry over the running machines; every active state must exist in `program`.

    After an explicit rename nothing is initialised or spawned: only names have changed. Otherwise, variables
    computed from a variable whose initialiser has changed are recomputed, so that an edited number takes
    effect at once. Paper: §4 (increasing `maxlook` immediately widens the sweeps).
    """
    old, plan = run.plan, link(program)
    run.replace_program(program, successors)
    run.pending = frozenset(_spawn_now(successors, identity) for identity in run.pending)
    reinitialised: set[Slot] | None = None if renamed else set()
    if run.started:
        _carry(run, run.globals, old.variables, plan.variables, run.base, successors, reinitialised)
    added: list[tuple[Activation, SpawnPlan]] = []
    live: dict[Path, Environment] = {(): run.globals}
    for act in [*run.walk()]:  # outer ones come first
        before, state, here = act.machine, act.state, act.place
        there = successors.path("state", here) or here
        act.machine = machine = plan.machines[there[:-1]]
        added += ((act, spawn) for spawn in _added_spawns(state, machine.states[there[-1]]))
        act.place = there
        act.path = (*act.parent.full_path, machine.name) if act.parent else (machine.name,)
        if act.spawn is not None:
            act.spawn = _spawn_now(successors, act.spawn)
        act.outer = live[machine.outer]
        live[machine.path] = act
        _carry(run, act, before.variables, machine.variables, act.outer.visible, successors, reinitialised)
    run.live = live
    run.rebind()
    if not renamed:
        for act, spawn in added:
            run.spawn(act, spawn)
        _spawn_added(run, old, plan)


def _spawn_now(successors: Successors, identity: tuple[str, str]) -> tuple[str, str]:
    """Return the names in a top-level spawn after the edit."""
    machine = successors.path("machine", identity[:1]) or identity
    state = successors.path("state", identity) or identity
    return machine[0], state[-1]


def _carry(
    run: Run,
    environment: Environment,
    old: tuple[VariablePlan, ...],
    new: tuple[VariablePlan, ...],
    outer: dict[str, Slot],
    successors: Successors,
    reinitialised: set[Slot] | None,
) -> None:
    """Keep the cells of remaining variables; initialise new, changed and dependent ones.

    `reinitialised`: the variables that have been reinitialised so far; None to reinitialise nothing.
    """
    kept = {}
    for variable in old:
        path = successors.path("variable", variable.initial.site.element.path)
        if path is not None:
            kept[path[-1]] = (variable.noun.initial, environment.own[variable.name])
    environment.own, environment.visible = {}, dict(outer)
    for variable in new:
        initial, slot = kept.get(variable.name) or (None, Slot(CellType()))
        visible = environment.visible
        if reinitialised is not None and (
            initial != variable.noun.initial
            or any(visible.get(name) in reinitialised for name in variable.reads)
        ):
            has_changed = run.evaluate(variable, visible, slot)
            if has_changed and initial is not None:
                reinitialised.add(slot)
        visible[variable.name] = environment.own[variable.name] = slot


def _added_spawns(old: StatePlan, new: StatePlan) -> list[SpawnPlan]:
    """Return the spawns of machines that `old` does not spawn; a different start state does not count."""
    known = {item.identity[0] for item in old.onentry if isinstance(item, SpawnPlan)}
    return [item for item in new.onentry if isinstance(item, SpawnPlan) and item.identity[0] not in known]


def _spawn_added(run: Run, old: Plan, plan: Plan) -> None:
    """Start the top-level spawns that are new, or that resolve only now."""
    if not run.roots:
        return  # the next tick does them all
    running = {act.spawn for act in run.roots} | run.pending
    tried = {spawn.identity: spawn.resolves for spawn in old.spawns}
    for spawn in plan.spawns:
        dangled = not tried.get(spawn.identity, False)
        if spawn.identity not in running and dangled and (spawn.resolves or spawn.identity not in tried):
            run.spawn(None, spawn)


def carry_issues(
    issues: IssueLog,
    before: Program,
    program: Program,
    successors: Successors = Successors(),  # noqa: B008  (a frozen value)
    changed: tuple[Element, ...] = (),
) -> None:
    """Resolve issues of removed, changed or repaired elements; move the others with the text. Paper: §6.2."""
    old, plan = link(before), link(program)
    twice = {site.element: site.offset for site in plan.duplicates}

    def over(issue: Issue) -> bool:
        element = successors.of(issue.element)
        if element is None or element not in plan.places or any(is_inside(element, c) for c in changed):
            return True
        dangled = (issue.element, issue.kind) in old.dangling
        return (dangled and (element, issue.kind) not in plan.dangling) or (
            issue.kind == "defined twice" and element not in twice
        )

    def place(issue: Issue) -> tuple[int, int]:
        element = successors.of(issue.element)
        if element is None:
            return issue.line, issue.column
        if issue.kind == "defined twice" and element in twice:
            return program.place(twice[element])
        here, there = old.places.get(issue.element), plan.places.get(element)
        if here is None or there is None:
            return issue.line, issue.column
        (line, column), (new_line, new_column) = before.place(here), program.place(there)
        same_line = issue.line == line
        return issue.line + new_line - line, issue.column + (new_column - column if same_line else 0)

    issues.resolve(lambda _, issue: over(issue))
    issues.move(place, successors)

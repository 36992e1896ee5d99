"""Live patching: decide the effect of an edit on a running program, then apply it.

:func:`decide` compares the running program with the new plan and changes nothing; :func:`adopt` swaps the
plans and carries over the tree of activations, and :func:`carry_issues` the issues, both with the same map
from old elements to new ones. This happens between two ticks, so an edit is applied as a whole or not at all.
Paper: §6.1.

Deviation: §6.1 restarts whenever the active state is gone. Here the old program keeps running until the new
one can start, so that a half-typed name does not stop the robot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import CellType, MappingProxyType
from typing import Literal

from lrp_jupyter.interpreter.cells import Slot, content, put
from lrp_jupyter.interpreter.issues import Issue, IssueLog
from lrp_jupyter.interpreter.linker import Plan, SpawnPlan, StatePlan, VariablePlan, link
from lrp_jupyter.interpreter.run import Run, meant
from lrp_jupyter.interpreter.trace_events import UNSET
from lrp_jupyter.interpreter.tree import Activation, Environment
from lrp_jupyter.language.diff import ChangeSet, unset
from lrp_jupyter.language.program import Block, Element, Path, Program, Spawn, path_text
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
    startable = any(spawn.resolves for spawn in plan.beginning)
    acts = [*run.walk()]
    for act in acts:
        machine = plan.machines.get(act.machine.path)
        if machine is None or act.place[-1] not in machine.states:
            gone = f"The machine `{act.machine.name}`" if machine is None else f"`{act.place[-1]}`"
            if startable:
                return Decision(restart=True, reason=f"{gone} is active and was removed or renamed.")
            return Decision(
                apply=False,
                reason=f"{gone} is active but missing from the new text, where {_unable(run)}. "
                "The old program keeps running.",
            )
    new_spawns = {spawn.identity for spawn in plan.spawns}
    roots = run.roots if run.alone is None else ()
    lost = [act.spawn for act in roots if act.spawn is not None and act.spawn not in new_spawns]
    if lost and startable:
        return Decision(restart=True, reason=f"`(spawn {' '.join(lost[0])})` was changed or removed.")
    reason = None
    if policy == "restart":
        for act in acts:
            if run.is_around(act):
                continue
            new = plan.machines[act.machine.path].states[act.place[-1]]
            part = _changed_part(act.state, new)
            if part is not None:
                reason = f"`{act.place[-1]}` is active and its {part} changed."
                break
    if reason and startable:
        return Decision(restart=True, reason=reason)
    if lost:
        return Decision(reason=f"`(spawn {' '.join(lost[0])})` was removed. What it started keeps running.")
    if reason:
        unable = _unable(run)
        reason += f" {unable[0].upper()}{unable[1:]}, so the program keeps running."
    return Decision(reason=reason)


def _unable(run: Run) -> str:
    """Return that the program cannot begin, as a part of a sentence."""
    return "no `spawn` can start" if run.alone is None else f"`{path_text(run.alone.path)}` cannot start"


def _changed_part(old: StatePlan, new: StatePlan) -> str | None:
    if unset(old.noun.onentry) != unset(new.noun.onentry):
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
    old = run.plan
    run.replace_program(program, successors)
    plan = run.plan
    run.pending = frozenset(_spawn_now(successors, identity) for identity in run.pending)
    carrier = _Carrier(run, successors, renamed)
    if run.started:
        carrier.carry(run.globals, old.variables, plan.variables, run.base)
    added: list[tuple[Activation, SpawnPlan]] = []
    live: dict[Path, Environment] = {(): run.globals}
    acts = [*run.walk()]
    settings = {act: act.settings(old) for act in acts}
    paths = [act.path for act in acts]
    for act in acts:  # outer ones come first
        before, state, here = act.machine, act.state, act.place
        there = successors.path("state", here) or here
        act.machine = machine = plan.machines[there[:-1]]
        spawned = {child.defined for child in act.children}  # it may have lost its spawn earlier
        new = [] if run.is_around(act) else _added_spawns(state, machine.states[there[-1]])
        added += ((act, spawn) for spawn in new if spawn.target not in spawned)
        act.place = there
        act.path = (*act.parent.full_path, machine.name) if act.parent else (machine.name,)
        if act.spawn is not None:
            act.spawn = _spawn_now(successors, act.spawn)
        act.outer = outer = (act.parent or run.globals).around(machine.outer)
        live[act.path] = act
        then, now = settings[act], act.settings(plan)
        if then is None or now is None:  # nothing spawns it any more: it keeps what it has
            then = now = {}
        carrier.carry(act, before.variables, machine.variables, outer.visible, then, now)
        _carry_holding(act, state, successors, renamed)
    run.live = live
    run.rebind()
    if run.visits is not None:
        run.visits.renamed(
            {path: act.path for path, act in zip(paths, acts, strict=True) if path != act.path}
        )
    if not renamed:
        for act, spawn in added:
            run.spawn(act, spawn)
        _spawn_added(run, old, plan)


def _spawn_now(successors: Successors, identity: tuple[str, str]) -> tuple[str, str]:
    """Return the names in a top-level spawn after the edit."""
    machine = successors.path("machine", identity[:1]) or identity
    state = successors.path("state", identity) or identity
    return machine[0], state[-1]


_Settings = Mapping[str, VariablePlan]


def _carry_holding(act: Activation, state: StatePlan, successors: Successors, renamed: bool) -> None:
    """Keep since when the triggers of transitions hold, unless they mean something else now."""
    if not act.holding:
        return
    before = {edge.site.element.path[-1]: edge for edge in state.edges}
    after = {edge.site.element: edge for edge in act.state.edges}
    kept = {}
    for name, since in act.holding.items():
        element = successors.of(before[name].site.element)
        edge = after.get(element) if element is not None else None
        if edge is None or edge.noun.hold is None:
            continue
        if renamed or edge.means(act.state.name) == before[name].means(state.name):
            kept[edge.site.element.path[-1]] = since
    act.holding = kept


class _Carrier:
    """Carries variables over an edit: keeps the cells, and initialises new, changed and dependent ones.

    `renamed`: the edit has only changed names.
    """

    def __init__(self, run: Run, successors: Successors, renamed: bool) -> None:
        self.run, self.successors, self.renamed = run, successors, renamed
        self.reinitialised: set[Slot] = set()

    def carry(
        self,
        environment: Environment,
        old: tuple[VariablePlan, ...],
        new: tuple[VariablePlan, ...],
        outer: dict[str, Slot],
        settings_before: _Settings = MappingProxyType({}),
        settings: _Settings = MappingProxyType({}),
    ) -> None:
        """Carry the variables of one machine, with its settings before and after."""
        kept: dict[str, tuple[_Source, Slot]] = {}
        for variable in old:
            path = self.successors.path("variable", variable.initial.site.element.path)
            slot = environment.own[variable.name]
            if path is None:
                environment.lost = {**environment.lost, variable.name: slot}
            else:
                kept[path[-1]] = _source(variable, settings_before.get(variable.name)), slot
        environment.own, environment.visible = {}, dict(outer)
        for variable in new:
            setting = settings.get(variable.name)
            source, slot = kept.get(variable.name) or (None, _returned(environment, variable.name))
            if self._is_outdated(environment, variable, setting, source, slot):
                self.run.log_attributes(slot, "captured", "computed")
                has_changed = self.run.evaluate(environment, setting, variable, slot)
                if has_changed and source is not None:
                    self.reinitialised.add(slot)
            environment.visible[variable.name] = environment.own[variable.name] = slot

    def _is_outdated(
        self,
        environment: Environment,
        variable: VariablePlan,
        setting: VariablePlan | None,
        source: _Source | None,
        slot: Slot,
    ) -> bool:
        """Return whether a variable is to be initialised, again or for the first time."""
        home = environment if setting is None else environment.parent or self.run.globals
        plan = setting or variable
        reads = plan.initial.reads
        is_missing = content(slot.cell) is UNSET and not slot.is_computed
        needed = reads if is_missing else plan.captures
        if any(each not in slot.captured for each in meant(needed, home.visible)):
            return True  # what its functions refer to has been declared, or hidden, since
        return not self.renamed and (
            source != _source(variable, setting)
            or any(home.visible.get(name) in self.reinitialised for name in reads)
        )


_Source = tuple[bool, Block]


def _source(variable: VariablePlan, setting: VariablePlan | None) -> _Source:
    """Return what initialises a variable, and whether that is a setting."""
    return setting is not None, (setting or variable).noun.initial


def _returned(environment: Environment, name: str) -> Slot:
    """Return an empty variable: the one that was removed, if any, because functions may refer to it."""
    slot = environment.lost.get(name) or Slot(CellType())
    environment.lost = {other: lost for other, lost in environment.lost.items() if other != name}
    put(slot.cell, UNSET)
    slot.last, slot.computed = UNSET, Slot.NEVER
    return slot


def _added_spawns(old: StatePlan, new: StatePlan) -> list[SpawnPlan]:
    """Return the spawns of machines that `old` does not spawn; a different start state does not count."""
    known = {item.identity[0] for item in old.onentry if isinstance(item, SpawnPlan)}
    return [item for item in new.onentry if isinstance(item, SpawnPlan) and item.identity[0] not in known]


def _spawn_added(run: Run, old: Plan, plan: Plan) -> None:
    """Start the top-level spawns that are new, or that resolve only now."""
    if not run.roots or run.alone is not None:
        return  # the next tick does them all; or they do not begin the run
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
    issues.move(place, successors, before)

"""3xx: references to what does not exist, each with the most similar name, if there is one.

The references are returned as they were probably meant, so that one misspelt name is one finding, and
not also an unreachable state.

Paper: §6.2, §9.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from lrp_jupyter.language.checks.creations import new_event, new_machine, new_state, new_variable
from lrp_jupyter.language.checks.report import Reporter, replace
from lrp_jupyter.language.program import (
    Edit,
    Event,
    Fix,
    Name,
    Span,
    Spawn,
    Transition,
    Variable,
    path_text,
)
from lrp_jupyter.language.resolution import Arrow, Resolution, Scope, Spawning
from lrp_jupyter.language.spellings import ANY_WORDS, NO_EVENTS
from lrp_jupyter.language.triggers import InState

_OPENING = re.compile(r"\(\s*(?:[;#][^\r\n]*\s+)*(\w+)")
"""Matches a form from its bracket to its keyword, across comments."""


_FEW = 5
"""States of a machine that are listed."""
_Targets = list[tuple[Scope, str]]


class MeantSpawn(NamedTuple):
    """A spawn as it is probably meant, by a state of `scope` or at the top level; `start`: if it is known."""

    noun: Spawn
    scope: Scope
    state: str
    machine: Scope
    start: str | None


class MeantArrow(NamedTuple):
    """A transition as it is probably meant.

    `sources`: the states that it names, or that a wildcard leaves out. Here and among the targets may be
        states that do not exist yet: what only they lead to does not count as unreachable.
    `targets`: several for an `exit` of a machine that is spawned from several.
    `sound`: whether all its references resolve as written.
    """

    noun: Transition
    sources: list[str]
    event: Event | None
    targets: _Targets
    sound: bool


@dataclass(slots=True)
class Links:
    """What the references of a program probably mean; `guess`: a spawn may mean any machine."""

    spawned: list[MeantSpawn] = field(default_factory=list)
    guess: bool = False
    arrows: dict[Scope, list[MeantArrow]] = field(default_factory=dict)


def check_references(report: Reporter, names: Resolution) -> Links:
    """Report every dangling reference, and return what all references probably mean."""
    return _References(report, names).links


class _References:
    def __init__(self, report: Reporter, names: Resolution) -> None:
        self.report = report
        self.scopes = names.scopes
        self.links = Links()
        for spawning in names.spawns:
            self._spawn(spawning)
        spawners: dict[Scope, dict[Scope, None]] = {}
        for spawned in self.links.spawned:
            spawners.setdefault(spawned.machine, {})[spawned.scope] = None
        for scope, arrows in names.arrows.items():
            self.links.arrows.setdefault(scope, [])
            for arrow in arrows:
                home = self._home(arrow)
                of = home or scope
                around = [outer for outer in spawners.get(of, [of.outer]) if outer and outer.path]
                meant = self._misplaced(arrow, home, around) if home else self._arrow(arrow, around)
                self.links.arrows.setdefault(of, []).append(meant)

    def _spawn(self, spawning: Spawning) -> None:
        noun, scope, state, machine = spawning.noun, spawning.scope, spawning.state, spawning.machine
        name = noun.machine
        swapped = scope.machine(state, str(noun.state)) if machine is None else None
        if swapped and name in swapped.states:
            message = f"The machine comes before its state. Write `(spawn {swapped.name} {name})`."
            first, second = noun.machine.span, noun.state.span
            edits = Edit(*first, str(noun.state)), Edit(*second, str(name))
            fix = Fix("Swap them", edits)
            self.report.add("LRP304", Span(first.start, second.end), message, fix)
            self.links.spawned.append(MeantSpawn(noun, scope, state, swapped, str(name)))
            return
        if machine is None:
            problem = f"There is no machine `{name}` that can be spawned here"
            creates = None
            if name in scope.path[::2]:
                remedy = "A machine can spawn neither itself nor a machine that contains it"
            else:
                around = scope.states.get(state)
                creates = new_machine(self.report, around, name, noun.state)
                remedy = self._elsewhere(lambda other: other.name == name) or f"Define `(machine {name} …)`"
            spawnable = scope.spawnable(state)
            meant = self.report.unknown("LRP304", name, problem, spawnable, remedy, creates)
            self.links.guess |= meant is None
            machine = scope.machine(state, meant) if meant else None
        if machine is not None:
            start = self._state("LRP305", noun.state, machine)
            known = start if start in machine.states else None
            self.links.spawned.append(MeantSpawn(noun, scope, state, machine, known))
            self._settings(noun, machine)

    def _settings(self, noun: Spawn, machine: Scope) -> None:
        first: dict[str, Variable] = {}
        for setting in noun.settings:
            name = setting.name
            before = first.setdefault(str(name), setting)
            if before is not setting:
                line = self.report.line(before.name.span)
                message = f"This spawn sets `{name}` already, in line {line}, and only the first one counts."
                fix = Fix("Remove it", (Edit(*setting.span, ""),))
                self.report.add("LRP201", name.span, f"{message} Remove this one.", fix)
            elif name not in machine.variables:
                problem = f"`{machine.name}` has no variable `{name}`"
                remedy = f"Define `(var {name} := [value])` in it"
                creates = new_variable(self.report, name, around=machine.noun)
                known = machine.variables.keys() - {str(other.name) for other in noun.settings}
                self.report.unknown("LRP311", name, problem, known, remedy, creates)

    def _arrow(self, arrow: Arrow, around: list[Scope]) -> MeantArrow:
        before = len(self.report.findings)
        noun, scope, event = arrow.noun, arrow.scope, None
        lead = self._exit if noun.outward else self._destination
        meant = self._swapped(arrow)
        if meant:
            event, state = meant
            return MeantArrow(noun, [state], event, lead(scope, around, noun), False)
        sources = [self._state("LRP302", source, scope) for source in noun.sources]
        if noun.trigger.reference is not None:
            kind, name = noun.trigger.reference
            if kind == "event":
                event = self._event(arrow, name)
            elif kind == "machine":
                self._watched(arrow)
            elif arrow.owner is None:
                self._delay(scope, name)
        held = noun.hold and noun.hold.reference
        if held and arrow.unresolved_hold is not None:
            self._delay(scope, held[1])
        targets = lead(scope, around, noun)
        return MeantArrow(noun, sources, event, targets, len(self.report.findings) == before)

    def _home(self, arrow: Arrow) -> Scope | None:
        """Return the machine to which a transition belongs that is in another one; else None."""
        noun, scope = arrow.noun, arrow.scope
        names = set(noun.own_states)
        if not noun.sources or noun.wildcard or not names.isdisjoint(scope.states):
            return None
        homes = [other for other in self.scopes if names.issubset(other.states)]
        return homes[0] if len(homes) == 1 else None

    def _misplaced(self, arrow: Arrow, home: Scope, around: list[Scope]) -> MeantArrow:
        """Report a transition that belongs to another machine; return it as it is meant there."""
        noun, last = arrow.noun, arrow.noun.destination
        named = dict.fromkeys(f"`{name}`" for name in noun.own_states)
        message = (
            f"{' and '.join(named)} {'are states' if len(named) > 1 else 'is a state'} of `{home.name}`, "
            f"not of `{arrow.scope.name}`. Move this transition into `{home.name}`."
        )
        self.report.add("LRP302", Span(noun.sources[0].span.start, last.span.end), message)
        targets = [(outer, str(last)) for outer in (around if noun.outward else [home])]
        return MeantArrow(noun, list(map(str, noun.sources)), None, targets, False)

    def _swapped(self, arrow: Arrow) -> tuple[Event | None, str] | None:
        """Report a transition whose event and source have changed places; return what they are."""
        noun, scope = arrow.noun, arrow.scope
        reference = noun.trigger.reference
        if reference is None or arrow.owner is not None or len(noun.sources) != 1 or noun.wildcard:
            return None
        if isinstance(noun.trigger, InState):
            return None
        (kind, first), second = reference, noun.sources[0]
        known = scope.visible_events if kind == "event" else scope.visible
        if first not in scope.states or second in scope.states or second not in known:
            return None
        what = "event" if kind == "event" else "delay"
        message = f"The {what} comes before the source state. Write `{second} {first}`."
        edits = Edit(*first.span, str(second)), Edit(*second.span, str(first))
        self.report.add("LRP301", Span(first.span.start, second.span.end), message, Fix("Swap them", edits))
        return (scope.event(second) if kind == "event" else None), str(first)

    def _state(self, code: str, name: Name, machine: Scope) -> str:
        if name in machine.states:
            return name
        problem = f"`{machine.name}` has no state `{name}`"
        if code == "LRP302" and name.lower() in ANY_WORDS:
            self.report.add(code, name.span, f"{problem}. Write `*` for any state.", replace(name.span, "*"))
            return name
        remedy = f"Define `(state {name})` in it"
        if code == "LRP305" and 0 < len(machine.states) <= _FEW:
            *others, last = (f"`{state}`" for state in machine.states)
            known = f"{', '.join(others)} and {last}" if others else last
            choice = "one of these" if others else "that"
            remedy = f"It has only {known}. Write {choice}, or define `(state {name})` in it"
        creates = new_state(self.report, machine.noun, name)
        return self.report.unknown(code, name, problem, machine.states, remedy, creates) or name

    def _event(self, arrow: Arrow, name: Name) -> Event | None:
        scope = arrow.scope
        if arrow.owner is not None:
            return arrow.owner.events[name]
        if name in scope.visible:
            message = f"`{name}` is a variable, not an event. Write `[{name}]` to test it."
            self.report.add("LRP301", name.span, message, replace(name.span, f"[{name}]"))
            return None
        machines = scope.machines_called(name)
        if machines:
            example = f"{name}.{next(iter(machines[0].states), 'STATE')}"
            message = f"`{name}` is a machine, not an event. Write the state to wait for: `{example}`."
            self.report.add("LRP301", name.span, message)
            return None
        remedy = NO_EVENTS.get(name.lower(), "").rstrip(".") or f"Define `(event {name} […])`"
        remedy = self._elsewhere(lambda other: name in other.events) or remedy
        problem = f"There is no event `{name}` here"
        creates = new_event(self.report, scope.noun, name)
        meant = self.report.unknown("LRP301", name, problem, scope.visible_events, remedy, creates)
        return scope.event(meant) if meant else None

    def _watched(self, arrow: Arrow) -> None:
        """Report an unknown machine or state of a machine as a condition."""
        noun, scope, trigger = arrow.noun, arrow.scope, arrow.noun.trigger
        assert isinstance(trigger, InState)
        name, state = trigger.machine, trigger.state
        sources = list(filter(noun.leaves, scope.states))
        machines = list(dict.fromkeys(arrow.watched.values()))
        if not sources:  # a finding by itself
            machines += scope.machines_called(name)
        if machines:
            states = [known for machine in machines for known in machine.states]
            if state not in states:
                problem, remedy = f"`{name}` has no state `{state}`", f"Define `(state {state})` in it"
                creates = new_state(self.report, machines[0].noun, state)
                self.report.unknown("LRP310", state, problem, states, remedy, creates)
            return
        whole = Span(name.span.start, state.span.end)
        if name in scope.visible or name in self.report.names or name == "robot":
            text = f"[{name}.{state}]"
            message = f"`{name}` is not a machine. Write `{text}` to test its `{state}`."
            self.report.add("LRP309", whole, message, replace(whole, text))
            return
        problem = f"There is no machine `{name}` that can be spawned there"
        known = {machine for source in sources for machine in scope.spawnable(source)}
        if name in scope.path[::2]:
            remedy, creates = "A machine can wait only for one that its own states spawn", None
        else:
            elsewhere = self._elsewhere(lambda other: other.name == name)
            remedy = elsewhere or f"Define `(machine {name} …)`"
            around = scope.states[sources[0]] if len(sources) == 1 else None
            creates = new_machine(self.report, around, name, state)
        self.report.unknown("LRP309", name, problem, known, remedy, creates)

    def _delay(self, scope: Scope, name: Name) -> None:
        if name in self.report.names:
            remedy = f"Write `[{name}]` to use the notebook's variable."
            message = f"`{name}` is not a variable of the program. {remedy}"
            self.report.add("LRP308", name.span, message, replace(name.span, f"[{name}]"))
            return
        elsewhere = self._elsewhere(lambda other: name in other.variables)
        remedy = elsewhere or f"Define `(var {name} := [1000])`, in milliseconds"
        problem = f"There is no variable `{name}` here"
        creates = new_variable(self.report, name, 1000)
        self.report.unknown("LRP308", name, problem, scope.visible, remedy, creates)

    def _destination(self, scope: Scope, around: list[Scope], transition: Transition) -> _Targets:
        name = transition.destination
        outside = [(outer, str(name)) for outer in around if name in outer.states]
        if name in scope.states or not outside:
            return [(scope, self._state("LRP303", name, scope))]
        message = (
            f"`{name}` is a state of `{outside[0][0].name}`, outside `{scope.name}`. "
            f"Write `(exit condition source -> {name})` to leave for it."
        )
        certain = transition.trigger.can_exit and len(transition.sources) == 1 and not transition.wildcard
        self.report.add("LRP303", name.span, message, self._keyword(transition, "exit") if certain else None)
        return outside

    def _exit(self, scope: Scope, around: list[Scope], transition: Transition) -> _Targets:
        name = transition.destination
        inside = [(scope, str(name))] if name in scope.states else []
        fix = self._keyword(transition, transition.trigger.keyword) if inside else None
        if not around:
            message = f"No state spawns `{scope.name}`, so `exit` leads nowhere. Write `(on …)`."
            self.report.add("LRP307", transition.span, message, fix)
            return inside
        targets = [(outer, str(name)) for outer in around if name in outer.states]
        machines = " or ".join(f"`{outer.name}`" for outer in around)
        if inside and not targets:
            problem = f"`{name}` is in `{scope.name}`, but `exit` leads to a state of {machines}"
            message = f"{problem}. Write `(on …)`."
            self.report.add("LRP306", name.span, message, fix)
            return inside
        lacking = [outer for outer in around if name not in outer.states]
        if not lacking:
            return targets
        if targets:
            others = " and ".join(f"`{outer.name}`" for outer in lacking)
            message = f"`{scope.name}` is also spawned in {others}, where there is no `{name}`"
            creates = new_state(self.report, lacking[0].noun, name)
            remedy = f"Define `(state {name})` there"
            self.report.add("LRP306", name.span, f"{message}. {remedy}.", creates=creates)
            return targets + [(outer, str(name)) for outer in lacking]
        problem = f"`exit` leads to a state of {machines}, where there is no `{name}`"
        known = [state for outer in around for state in outer.states]
        remedy, creates = f"Define `(state {name})` there", new_state(self.report, around[0].noun, name)
        meant = self.report.unknown("LRP306", name, problem, known, remedy, creates)
        return [(outer, meant or name) for outer in around]

    def _keyword(self, transition: Transition, keyword: str) -> Fix | None:
        """Return the fix that changes the keyword of a transition."""
        found = _OPENING.match(self.report.program.text, transition.span.start)
        return replace(Span(*found.span(1)), keyword) if found else None

    def _elsewhere(self, defines: Callable[[Scope], bool]) -> str | None:
        """Return a remedy for a name that is defined, but out of scope here; else None."""
        path = next((scope.path for scope in self.scopes if defines(scope)), None)
        return (
            f"The definition at `{path_text(path)}` is out of scope here. Move it outward" if path else None
        )

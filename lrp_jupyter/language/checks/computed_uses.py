"""Names in blocks that mean an event, a machine or a time: what hides them, and what they cannot do.

Paper: §5.1.1.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Mapping

from lrp_jupyter.errors import Edit, Fix
from lrp_jupyter.language.blocks.builtin_names import TIMES
from lrp_jupyter.language.checks.block_facts import facts_of
from lrp_jupyter.language.checks.defined_names import BUILTINS
from lrp_jupyter.language.checks.report import Reporter, replace
from lrp_jupyter.language.checks.uses import NameUse, uses_of
from lrp_jupyter.language.program import Event, Name, Span, Variable
from lrp_jupyter.language.resolution import PlacedBlock, Resolution, Scope


def means(place: PlacedBlock, name: str, outside: frozenset[str]) -> bool:
    """Return whether a name means an event, a machine or a time in a block; `outside` is the notebook's."""
    return name not in outside and (place.is_computed(name) or bool(place.machines(name)))


def meanings(scope: Scope, names: Resolution) -> tuple[str, ...]:
    """Return the names that mean an event, a machine or a time in the blocks of a scope."""
    return (*scope.visible_events, *TIMES, *(names.computed[1] & scope.callable_names()))


def _is_lost(place: PlacedBlock, use: NameUse) -> bool:
    return use.role == "stated" or (use.role == "value" and place.purpose == "action")


def check_computed(report: Reporter, names: Resolution) -> None:
    """Report what is wrong with the uses of events, machines and times in blocks."""
    _ComputedUses(report, names).check()


class _ComputedUses:
    def __init__(self, report: Reporter, names: Resolution) -> None:
        self.report, self.names, self.outside = report, names, frozenset(report.names)
        self.told: set[int] = set()
        """The names, by identity, that hide something and are reported."""
        self.read: dict[tuple[Scope, str], list[tuple[Scope, str]]] = {}
        """The events that the block of each event reads."""

    def check(self) -> None:
        events, machines = self.names.computed
        for scope in self.names.scopes:
            defined: tuple[Variable | Event, ...] = (*scope.variables.values(), *scope.events.values())
            for noun in defined:
                if noun.name in TIMES:
                    self._hides_time(noun.name, "event" if isinstance(noun, Event) else "variable")
        for place in self.names.all_blocks:
            for name in dict.fromkeys(word.name for word in facts_of(place.block.text).reads):
                if name not in events and name not in machines:
                    continue
                if name in place.visible:
                    self._hidden(place, name)
                elif means(place, name, self.outside):
                    self._uses(place, name)
        self._cycles()

    # What is hidden

    def _hides_time(self, name: Name, kind: str) -> None:
        since = "the state was entered" if name == "elapsed" else "the last tick"
        message = f"The {kind} `{name}` hides the seconds since {since} from all blocks here."
        self.report.add("LRP208", name.span, f"{message} Give it another name.")

    def _hidden(self, place: PlacedBlock, name: str) -> None:
        """Report a variable that hides an event or a machine from a block that names it."""
        variable = place.visible[name].variables[name].name
        event, machines = place._replace(visible={}).event(name), place.scope.machines_called(name)
        first: Name | None = None
        if event is not None:
            kind, first = "event", event.events[name].name
        elif machines and any(use.names for use in uses_of(name, place.block.text)):
            kind, first = "machine", machines[0].name
        if first is not None:
            where = f"the {kind} `{name}` of line {self.report.line(first.span)} from the block in line"
            self._tell("LRP207", variable, f"The variable `{name}` hides {where} {self._line(place)}")

    def _tell(self, code: str, name: Name, problem: str, which: str = "one of them") -> None:
        if id(name) not in self.told:
            self.told.add(id(name))
            self.report.add(code, name.span, f"{problem}. Give {which} another name.")

    def _line(self, place: PlacedBlock) -> int:
        return self.report.line(place.block.span)

    # What is used

    def _uses(self, place: PlacedBlock, name: str) -> None:
        owner, machines = place.event(name), place.machines(name)
        if owner is not None:
            if machines:
                problem = f"`{name}` is an event and a machine, and in blocks the name alone is the event"
                self._tell("LRP207", owner.events[name].name, problem)
            if place.element.kind == "event":
                key = place.scope, place.element.path[-1]
                self.read.setdefault(key, []).append((owner, name))
        for use in uses_of(name, place.block.text):
            if machines and use.names:
                self._member(place, name, use, machines)
            elif not use.names:
                self._alone(place, name, use, owner is None and bool(machines))

    def _alone(self, place: PlacedBlock, name: str, use: NameUse, is_machine: bool) -> None:
        """Check the use of a name without a member."""
        if use.role == "called" and use.call is not None:
            if name not in BUILTINS:
                self._called(place, name, use, is_machine)
        elif _is_lost(place, use):
            self._lost(place, use)
        elif is_machine and use.role in ("compared", "tested", "computed", "value"):
            fix = None
            if use.other is not None and use.other.kind == "text":
                at = place.block.at(Span(use.span.end, use.span.end))
                fix = Fix(f"Change to `{name}.state`", (Edit(*at, ".state"),))
            message = f"`{name}` is a machine. Compare its state: `{name}.state`."
            self._add("LRP533", place, use.span, message, fix)

    def _lost(self, place: PlacedBlock, use: NameUse) -> None:
        text = place.block.text[slice(*use.span)]
        message = f"This only names `{text}` and does nothing. Use its value, or remove it."
        self._add("LRP507", place, use.span, message)

    def _called(self, place: PlacedBlock, name: str, use: NameUse, is_machine: bool) -> None:
        assert use.call is not None
        fix = None
        if is_machine:
            what, remedy = "a machine", f"`(spawn {name} STATE)` in an `onentry` runs it"
        else:
            what = "a number of seconds" if place.event(name) is None else "an event"
            remedy = f"Write `{name}`"
            if not use.call.arguments and not use.call.is_open:
                fix = Fix(f"Change to `{name}`", (Edit(*place.block.at(use.call.brackets), ""),))
        self._add("LRP502", place, use.span, f"`{name}` is {what}, not a function. {remedy}.", fix)

    def _member(self, place: PlacedBlock, name: str, use: NameUse, machines: tuple[Scope, ...]) -> None:
        """Check the use of a member of a machine."""
        member, span = use.names[0], use.spans[0]
        whole = Span(span.start - len(name) - 1, span.end)
        states = ChainMap(*(machine.states for machine in machines))
        variables = ChainMap(*(machine.variables for machine in machines))
        if use.role in ("assigned", "deleted") and len(use.names) == 1:
            remedy = f"Assign `{member}` inside `{name}`"
            if member == "state":
                remedy = f"A transition of `{name}` enters another state"
            message = f"`{name}.{member}` can only be read here. {remedy}."
            self._add("LRP534", place, use.span, message)
        elif member == "state" and place.purpose == "condition" and use.role == "value":
            text = f'{name}.state == "{next(iter(states), "STATE")}"'
            message = f"A condition must be a truth value, not the name of a state. Compare it: `{text}`."
            self._add("LRP508", place, use.span, message)
        elif member == "state":
            self._compared_state(place, name, use, states)
        elif member not in variables and not member.startswith("__"):
            problem = f"`{name}` has no variable `{member}`"
            if member in states:
                text = f'{name}.state == "{member}"'
                is_test = len(use.names) == 1 and use.role in ("tested", "value")
                fix = replace(place.block.at(use.span), text) if is_test else None
                message = f"`{member}` is a state of `{name}`, not a variable. Write `{text}`."
                self._add("LRP532", place, whole, message, fix)
                return
            meant = self.report.nearest(member, [*variables, "state"])
            remedy = f"Did you mean `{meant}`?" if meant else f"Define `(var {member} := [value])` in it."
            fix = replace(place.block.at(span), meant) if meant else None
            prefix = any(known.startswith(member) for known in (*variables, "state"))
            self._add("LRP532", place, span, f"{problem}. {remedy}", fix, prefix)
        elif _is_lost(place, use):
            self._lost(place, use)

    def _compared_state(
        self, place: PlacedBlock, name: str, use: NameUse, states: Mapping[str, object]
    ) -> None:
        other = use.other
        if _is_lost(place, use):
            self._lost(place, use)
        if len(use.names) > 1 or other is None or other.sign not in ("==", "!=") or other.value in states:
            return
        meant = self.report.nearest(other.value, states) if isinstance(other.value, str) else None
        fix, remedy = None, "Write the name of one of its states"
        if meant is not None:
            quote = place.block.text[other.span.end - 1]
            fix = replace(place.block.at(other.span), f"{quote}{meant}{quote}")
            remedy = f"Did you mean `{meant}`?"
        shown = place.block.text[slice(*other.span)].replace("`", "'")
        message = f"`{name}` has no state `{shown}`. {remedy}"
        prefix = any(known.startswith(str(other.value)) for known in states)
        self._add("LRP535", place, other.span, message if meant else f"{message}.", fix, prefix)

    def _add(
        self,
        code: str,
        place: PlacedBlock,
        span: Span,
        message: str,
        fix: Fix | None = None,
        prefix: bool = False,
    ) -> None:
        self.report.add(code, place.block.at(span), message, fix, prefix)

    # What cannot end

    def _cycles(self) -> None:
        """Report events whose blocks read each other in a circle."""
        done: set[tuple[Scope, str]] = set()
        for first in self.read:
            path = {first: iter(self.read[first])} if first not in done else {}
            while path:
                last = next(reversed(path))
                event = next(path[last], None)
                if event is None:
                    del path[last]
                    done.add(last)
                elif event in path:
                    events = list(path)
                    self._cycle(events[events.index(event) :])
                elif event not in done:
                    path[event] = iter(self.read.get(event, ()))

    def _cycle(self, events: list[tuple[Scope, str]]) -> None:
        scope, name = events[0]
        read = [f"`{each}`" for _, each in [*events[1:], events[0]]]
        through = ", ".join([*read[:2], "…", read[-1]] if len(read) > 4 else read)
        message = f"The event `{name}` reads {through}, and so itself. Remove one of these reads."
        self.report.add("LRP312", scope.events[name].name.span, message)

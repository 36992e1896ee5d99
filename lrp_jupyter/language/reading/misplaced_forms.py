"""The right place for a transition or a state that is in the wrong form: among the others of its machine.

The states that a transition names determine its machine. There it is put where it least disturbs the order of
the sources of the other transitions, compared with the order of the states.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.program import Span, State, Transition
from lrp_jupyter.language.reading.elements_of_forms import Part


class Members(NamedTuple):
    """A machine of a wrong text: its range, its states, and its transitions."""

    span: Span
    states: tuple[State, ...]
    transitions: tuple[Transition, ...]

    @property
    def names(self) -> list[str]:
        """The names of its states."""
        return [str(state.name) for state in self.states]

    @property
    def used(self) -> set[str]:
        """The states that its transitions name."""
        return {str(name) for transition in self.transitions for name in transition.own_states}


class Stray(NamedTuple):
    """A form in the wrong form, with the index of its finding."""

    finding: int
    node: Part
    start: int
    end: int


def members(parts: Sequence[Part], span: Span) -> Members:
    """Return the machine that has these parts."""
    return Members(
        span,
        tuple([part for part in parts if isinstance(part, State)]),
        tuple([part for part in parts if isinstance(part, Transition)]),
    )


def relocated(stray: Stray, machines: Sequence[Members], text: str) -> tuple[Edit, ...]:
    """Return the edits that move a form into the machine to which it belongs; none if that is not certain."""
    node, start, end = stray.node, stray.start, stray.end
    before = len(text[:start].rstrip())
    gone, moved = Edit(before, end, ""), text[start:end]
    machines = [machine for machine in machines if not start < machine.span.start < end]
    around = [machine for machine in machines if machine.span.start < start < machine.span.end]
    if isinstance(node, Transition):
        homes = [machine for machine in machines if set(node.own_states).issubset(machine.names)]
        homes = [machine for machine in homes if machine in around][:1] or homes
        if len(homes) != 1 or node.wildcard:
            return ()
        return gone, _among(homes[0], node, moved, text)
    if isinstance(node, State) and not around:
        name = str(node.name)
        homes = [each for each in machines if name in each.used and name not in each.names]
        if len(homes) == 1:
            close = homes[0].span.end - 1
            return Edit(close, close, f" {moved}"), gone
    return ()


def _among(machine: Members, node: Transition, moved: str, text: str) -> Edit:
    """Return the edit that inserts a transition among those of a machine."""
    order = {name: rank for rank, name in enumerate(machine.names)}

    def rank(transition: Transition) -> int | None:
        return None if transition.wildcard else order.get(str(transition.sources[0]))

    mine = order[str(node.sources[0])]
    ranks = [rank(transition) for transition in machine.transitions]

    def disturbed(place: int) -> int:
        earlier = sum(each is not None and each > mine for each in ranks[:place])
        return earlier + sum(each is not None and each < mine for each in ranks[place:])

    place = min(range(len(ranks) + 1), key=disturbed)
    if place:
        after = machine.transitions[place - 1].span
        return Edit(after.end, after.end, f"{_gap(text, after.start)}{moved}")
    if machine.transitions:
        first = machine.transitions[0].span
        return Edit(first.start, first.start, f"{moved}{_gap(text, first.start)}")
    last = machine.states[-1].span
    return Edit(last.end, last.end, f"{_gap(text, last.start)}{moved}")


def _gap(text: str, start: int) -> str:
    """Return what separates a form from its sibling: a new line where the sibling begins its own."""
    found = _NEW_LINE.search(text[:start])
    return found[0] if found else " "


_NEW_LINE = re.compile(r"(?:\r\n|\r|\n)[ \t]*\Z")

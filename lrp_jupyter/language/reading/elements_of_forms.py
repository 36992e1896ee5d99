"""Conversion of a form that matches the grammar to the element of a program that it describes."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Any, NamedTuple

from lrp_jupyter.language.program import (
    Block,
    Event,
    Machine,
    Name,
    Program,
    Span,
    Spawn,
    State,
    Transition,
    Variable,
)
from lrp_jupyter.language.reading.forms import Shape
from lrp_jupyter.language.triggers import FORMS, Delay


class Actions(NamedTuple):
    """The items of an action form; a state concatenates forms with the same keyword."""

    items: tuple[Block | Spawn, ...]


Node = Variable | Machine | Event | Spawn | State | Transition | Actions
Part = Node | Block | Name | int | None
"""The value of one token of a form; None for signs and for wrong tokens."""

_TRANSITIONS = frozenset(f"{keyword.upper()}_FORM" for keyword in FORMS)


def node(keyword: str, types: Sequence[str], parts: Sequence[Any], shape: Shape | None, span: Span) -> Node:
    """Return the element that a form describes, by the types and values of its tokens, the keyword first."""
    if shape is not None:
        trigger, hold, source, sources, destination, name, effect = shape
        return Transition(
            FORMS[keyword].make(*[parts[index] for index in trigger]),
            tuple([parts[index] for index in sources]),
            source in ("every", "but"),
            parts[destination],
            None if name is None else parts[name],
            FORMS[keyword].outward,
            None if hold is None else Delay(parts[hold]),
            () if effect is None or parts[effect] is None else parts[effect].items,
            span,
        )
    if keyword == "var":
        return Variable(parts[1], parts[3], span)
    if keyword == "event":
        return Event(parts[1], parts[2], span)
    if keyword == "spawn":
        return Spawn(parts[1], parts[2], tuple(parts[3:]), span)
    if keyword == "state":
        return _state(types, parts, span)
    if keyword == "machine":
        return _machine(types, parts, span)
    return Actions(tuple(parts[1:]))


def _state(types: Sequence[str], parts: Sequence[Any], span: Span) -> State:
    actions: dict[str, Any] = {"ONENTRY_FORM": (), "RUNNING_FORM": (), "ONEXIT_FORM": ()}
    machines = []
    for kind, part in zip(types, parts, strict=True):
        if kind == "MACHINE_FORM":
            machines.append(part)
        elif kind in actions and part is not None:
            actions[kind] += part.items
    onentry, running, onexit = actions.values()
    return State(parts[1], onentry, running, onexit, tuple(machines), span)


def _machine(types: Sequence[str], parts: Sequence[Any], span: Span) -> Machine:
    found = _sorted(types, parts)
    transitions = tuple([part for kind, part in zip(types, parts, strict=True) if kind in _TRANSITIONS])
    variables, events, states = (tuple(found[kind]) for kind in ("VAR_FORM", "EVENT_FORM", "STATE_FORM"))
    return Machine(parts[1], variables, events, states, transitions, span)


def program(types: Sequence[str], parts: Sequence[Any], text: str, filename: str) -> Program:
    """Return the program made of the top-level forms."""
    found = _sorted(types, parts)
    kinds = ("VAR_FORM", "EVENT_FORM", "MACHINE_FORM", "SPAWN_FORM")
    variables, events, machines, spawns = (tuple(found[kind]) for kind in kinds)
    onpause, onresume, onend = (
        tuple(block for part in found[kind] if part is not None for block in part.items)
        for kind in ("ONPAUSE_FORM", "ONRESUME_FORM", "ONEND_FORM")
    )
    return Program(variables, events, machines, spawns, onpause, onresume, onend, text, filename)


def _sorted(types: Sequence[str], parts: Sequence[Any]) -> dict[str, list[Any]]:
    found: dict[str, list[Any]] = defaultdict(list)
    for kind, part in zip(types, parts, strict=True):
        found[kind].append(part)
    return found

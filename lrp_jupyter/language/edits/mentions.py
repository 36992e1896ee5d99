"""Every place of a program that names an element defined elsewhere, with the scope that defines it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from lrp_jupyter.language.blocks.block import block_names
from lrp_jupyter.language.program import Name, Span
from lrp_jupyter.language.resolution import Arrow, PlacedBlock, Resolution, Scope, Spawning
from lrp_jupyter.language.triggers import InState


class Named(NamedTuple):
    """A name at one place, with the kind of what it names and the scope that defines that; None if none does.

    A place that can mean several elements is named once for each.
    `inside`: whether it is looked up in that scope only, not in those around the place.
    `imported`: the module's whole name where it is bound by ``import``, else empty.
    """

    kind: str
    name: str
    span: Span
    scope: Scope | None
    inside: bool = False
    imported: str = ""


def named(names: Resolution) -> Iterator[Named]:
    """Yield every place of a program that names something."""
    for spawning in names.spawns:
        yield from named_by_spawn(spawning)
    for arrows in names.arrows.values():
        for arrow in arrows:
            yield from named_by_trigger(arrow)
            yield from named_states(arrow)
    for codes in names.blocks.values():
        for code in codes:
            yield from named_in_block(code)


def named_by_spawn(spawning: Spawning) -> Iterator[Named]:
    """Yield the machine, its start state and the variables that a spawn names."""
    noun, machine = spawning.noun, spawning.machine
    yield _named("machine", noun.machine, machine)
    yield _named("state", noun.state, machine, True)
    for setting in noun.settings:
        yield _named("variable", setting.name, machine, True)


def named_by_trigger(arrow: Arrow) -> Iterator[Named]:
    """Yield what a transition waits for by name: an event, the state of a machine, variables of delays."""
    trigger, hold = arrow.noun.trigger, arrow.noun.hold
    if isinstance(trigger, InState):
        for machine in dict.fromkeys(arrow.watched.values()) or (None,):
            yield _named("machine", trigger.machine, machine)
            yield _named("state", trigger.state, machine, True)
    elif trigger.reference is not None:
        yield _named(*trigger.reference, arrow.owner)
    if hold is not None and hold.reference is not None:
        _, name = hold.reference
        yield _named("variable", name, arrow.scope.owner("variable", name))


def named_states(arrow: Arrow) -> Iterator[Named]:
    """Yield the sources and the destination of a transition."""
    for source in arrow.noun.sources:
        yield _named("state", source, arrow.scope)
    for home in arrow.homes or (None,):
        yield _named("state", arrow.noun.destination, home)


def named_in_block(code: PlacedBlock) -> Iterator[Named]:
    """Yield what the names of a block can mean: variables, events, machines, and what is in these."""
    for name, span, imported, is_computed, member in block_names(code.block):
        machines = code.machines(name) if is_computed else ()
        event = code.event(name) if is_computed else None
        if machines and (member or event is None):
            yield from (Named("machine", name, span, machine) for machine in machines)
        elif event is not None:
            yield Named("event", name, span, event)
        else:
            yield Named("variable", name, span, code.visible.get(name), False, imported)
        if member is not None and member.name != "state":
            yield from _each("variable", member.name, member.span, machines)
        elif member is not None:
            for text, place in member.strings:
                yield from _each("state", text, place, machines)


def _each(kind: str, name: str, span: Span, machines: tuple[Scope, ...]) -> Iterator[Named]:
    return (Named(kind, name, span, machine, True) for machine in machines or (None,))


def _named(kind: str, name: Name, scope: Scope | None, inside: bool = False) -> Named:
    return Named(kind, str(name), name.span, scope, inside)

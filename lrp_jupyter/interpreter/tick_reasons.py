"""Why a transition fired in a tick, or did not: exactly one reason holds for each transition and tick.

It follows from the states that were active when the tick began and from the firings and faults in it, which
are in the journal, so it costs a running program nothing. Paper: §5.1 (the order of a tick).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from lrp_jupyter.interpreter.facts import Entered, Fact, Faulted, Fired
from lrp_jupyter.interpreter.history import PastMachine, PastState
from lrp_jupyter.language.program import Element, Path
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.triggers import Delay

ReasonCode = Literal[
    "fired",
    "source-inactive",
    "machine-not-running",
    "just-entered",
    "earlier-fired",
    "outer-fired",
    "exit-took-parent",
    "condition-false",
    "not-boolean",
    "raised",
    "no-data",
    "delay-not-over",
    "unknown-event",
    "unknown-destination",
    "paused",
    "not-in-program",
]

_OF_FAULTS: Mapping[str, ReasonCode] = {
    "no data yet": "no-data",
    "not boolean": "not-boolean",
    "unknown event": "unknown-event",
    "unknown machine": "unknown-event",
    "unknown state": "unknown-destination",
}


@dataclass(frozen=True, slots=True)
class Cause:
    """Why a transition fired in a tick, or did not, in terms of the tick.

    `fact`: the firing of it, or of the one that prevented it; or the fault; or the entry of its source in
        this tick.
    """

    code: ReasonCode
    machine: PastMachine | None = None  # its own when the tick began, if it was running
    fact: Fired | Entered | Faulted | None = None


def cause_in(
    state: PastState,
    facts: Sequence[Fact],
    element: Element,
    instance: Path | None = None,
    *,
    holds: bool = False,
) -> Cause:
    """Return why a transition, by path of definition, fired in a tick that began in `state`, or did not.

    `instance`: its machine, by path as spawned, if that may have run several times.
    `holds`: whether its trigger was true at the end of the tick, but has to hold for longer.
    """
    names = resolve(state.program)
    arrow = names.arrow(element)
    if arrow is None:
        return Cause("not-in-program")
    noun, arrows = arrow.noun, [each.element for each in names.arrows[arrow.scope]]
    order, home = list(state.walk()), element.path[:-1]
    machine = state.machine(home, instance)
    if machine is None or not noun.leaves(machine.state[-1]):
        for fact in facts:
            if (
                isinstance(fact, (Fired, Entered))
                and fact.state[:-1] == home
                and instance in (None, fact.path[:-1])
                and noun.leaves(fact.state[-1])
            ):
                return Cause("just-entered", machine, fact)
        return Cause("machine-not-running" if machine is None else "source-inactive", machine)
    before = [each.path for each in order[: order.index(machine)]]
    for fired in facts:
        if not isinstance(fired, Fired):
            continue
        if fired.machine == machine.path:
            if fired.transition == element:
                return Cause("fired", machine, fired)
            if arrows.index(fired.transition) < arrows.index(element):
                return Cause("earlier-fired", machine, fired)
        elif fired.machine in before and _is_inside(machine.path, fired.path[:-1]):
            outer = _is_inside(machine.path, fired.machine)
            return Cause("outer-fired" if outer else "exit-took-parent", machine, fired)
    for fault in facts:
        if isinstance(fault, Faulted) and (fault.transition, fault.machine) == (element, machine.path):
            is_of_trigger = fault.kind == "unknown state" and fault.ordinal == 0
            code = "unknown-event" if is_of_trigger else _OF_FAULTS.get(fault.kind, "raised")
            return Cause(code, machine, fault)
    waits = holds or isinstance(noun.trigger, Delay)
    return Cause("delay-not-over" if waits else "condition-false", machine)


def _is_inside(path: Path, outer: Path) -> bool:
    """Return whether the path of a machine as spawned is `outer` or lies inside it."""
    return path[: len(outer)] == outer

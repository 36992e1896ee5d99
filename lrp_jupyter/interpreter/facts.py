"""Facts: what happened in a run, as small values that the journal keeps among its undo records.

Their cost per tick is negligible: a transition's fact is made when it fires for the first time, and the
journal logs a reference to it with every firing. All other facts are rare.
"""

from __future__ import annotations

from typing import NamedTuple

from lrp_jupyter.interpreter.journal import weightless
from lrp_jupyter.language.program import Element, Path


@weightless
class Fired(NamedTuple):
    """A transition fired, and its destination was entered.

    `label`: how the transition is displayed.
    `machine`: its machine, as spawned.
    `source`: the name of the state that was left.
    `state`: the state that was entered, by path of definition.
    `path`: the same state, as spawned; in the outer machine if the transition is an ``exit``.
    """

    transition: Element
    label: str
    machine: Path
    source: str
    state: Path
    path: Path

    @property
    def destination(self) -> str:
        """The name of the state that was entered."""
        return self.state[-1]


@weightless
class Enabled(NamedTuple):
    """A transition was enabled in the tick in which its source was entered, which therefore did not act.

    `label`: how the transition is displayed.
    `machine`: its machine, as spawned.
    `state`: its source state, by path of definition.
    """

    transition: Element
    label: str
    machine: Path
    state: Path


@weightless
class Spawned(NamedTuple):
    """A machine was spawned.

    `machine`: its path as spawned.
    `by`: the state whose ``onentry`` spawned it, as spawned; empty for a top-level spawn.
    `defined`: the machine, by path of definition.
    """

    machine: Path
    by: Path
    defined: Path


@weightless
class Entered(NamedTuple):
    """A state was entered without a transition: it was spawned or forced."""

    state: Path
    path: Path


@weightless
class Discarded(NamedTuple):
    """A nested machine, as spawned and by path of definition, ended: the state around it was left."""

    machine: Path
    defined: Path


@weightless
class Faulted(NamedTuple):
    """A block raised, or something else was at fault.

    `ordinal`: index of the block within the element.
    `kind`: one of the kinds of issues.
    `machine`: the machine of the tested transition, if any, as spawned.
    `transition`: the tested transition.
    """

    element: Element
    ordinal: int
    kind: str
    message: str
    machine: Path = ()
    transition: Element | None = None


@weightless
class Commanded(NamedTuple):
    """A command was applied between two ticks; the facts of its effects precede it.

    `kind`: ``patched``, ``renamed``, ``restarted``, ``forced``, ``assigned``, ``paused`` or ``resumed``.
    `text`: the reason of a restart, ``transition``, ``teleport`` or ``fire``, the variable that was assigned,
        …
    `state`: the state that was forced, by path of definition.
    """

    kind: str
    text: str = ""
    state: Path = ()


Fact = Fired | Enabled | Spawned | Entered | Discarded | Faulted | Commanded

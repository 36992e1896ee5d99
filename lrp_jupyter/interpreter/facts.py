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
    """A transition fired, and its destination was entered."""

    transition: Element
    label: str  # how it is displayed
    machine: Path  # its own, as spawned
    source: str  # name of the state that was left
    state: Path  # that was entered, by path of definition
    path: Path  # of the same state, as spawned; in the outer machine if the transition is an `exit`

    @property
    def destination(self) -> str:
        """The name of the state that was entered."""
        return self.state[-1]


@weightless
class Enabled(NamedTuple):
    """A transition was enabled in the tick in which its source was entered, which therefore did not act."""

    transition: Element
    label: str  # how it is displayed
    machine: Path  # its own, as spawned
    state: Path  # its source, by path of definition


@weightless
class Spawned(NamedTuple):
    """A machine was spawned."""

    machine: Path  # as spawned
    by: Path  # the state whose `onentry` spawned it, as spawned; empty for a top-level spawn
    defined: Path  # the machine, by path of definition


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
    """A block raised, or something else was at fault."""

    element: Element
    ordinal: int  # of the block within the element
    kind: str  # of the issue
    message: str
    machine: Path = ()  # of the tested transition, if any, as spawned
    transition: Element | None = None  # the tested one


@weightless
class Commanded(NamedTuple):
    """A command was applied between two ticks; the facts of its effects precede it."""

    kind: str  # patched, renamed, restarted, forced, assigned, paused, resumed or ended
    text: str = ""  # the reason of a restart, how a state was forced, the variable that was assigned, …
    state: Path = ()  # that was forced, by path of definition


Fact = Fired | Enabled | Spawned | Entered | Discarded | Faulted | Commanded

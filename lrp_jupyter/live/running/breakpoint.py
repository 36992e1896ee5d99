"""A breakpoint as a value: what pauses the program, and how often it happened."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from lrp_jupyter.language.program import Element, Path, path_text
from lrp_jupyter.language.successors import Successors

BreakpointKind = Literal["entered", "left", "fired", "event", "condition"]
_WORDS = {  # when it pauses, and why it has paused
    "entered": ("{} is entered", "{} was entered"),
    "left": ("{} is left", "{} was left"),
    "fired": ("{} fires", "{} fired"),
    "event": ("the event {} occurs", "The event {} occurred"),
    "condition": ("{} becomes True", "{} became True"),
}


@dataclass(frozen=True, slots=True)
class Breakpoint:
    """A condition for a pause.

    `number`: the first is 1.
    `kind`: ``entered``, ``left``, ``fired``, ``event`` or ``condition``.
    `element`: the state, transition or event; None for a condition.
    `expression`: the condition.
    `machine`: the machine in whose scope the condition is evaluated, by path of definition; empty for the top
        level.
    `inside`: the states around the instance of its machine, by path of definition; None if any instance is
        meant.
    `enabled`: whether it pauses; hits are counted in either case.
    `after`: the first hit at which it pauses.
    `once`: whether it is switched off after pausing once.
    `dormant`: whether its element, or the machine of its condition, is missing from the running program.
    `problem`: a sentence about why its condition could not be evaluated the last time; may be empty.
    """

    number: int
    kind: BreakpointKind
    element: Element | None = None
    expression: str = ""
    machine: Path = ()
    inside: tuple[Path, ...] | None = None
    enabled: bool = True
    hits: int = 0
    after: int = 1
    once: bool = False
    dormant: bool = False
    problem: str = ""

    @property
    def hangs_on(self) -> Element:
        """The element that it follows: its element, or the machine of its condition (or the top level)."""
        return self.element if self.element is not None else Element("machine", self.machine)

    def moved(self, successors: Successors) -> Breakpoint:
        """Return a copy that follows its element, and the states around it, over an edit."""
        element = successors.of(self.hangs_on) or self.hangs_on
        inside = self.inside and successors.around(self.inside)
        if self.element is None:
            return replace(self, machine=element.path, inside=inside)
        return replace(self, element=element, inside=inside)

    @property
    def instance(self) -> Path:
        """The instance that is meant, by its path as spawned; empty for any."""
        if self.inside is None:
            return ()
        machine = self.machine if self.element is None else self.element.path[:-1]
        return (*(part for state in self.inside for part in state[-2:]), machine[-1])

    @property
    def name(self) -> str:
        """The name of its element, or its condition; in one instance of several, the path as spawned."""
        if self.element is None:
            return self.expression
        return path_text((*self.instance, self.element.shown[-1]))

    @property
    def what(self) -> str:
        """What has happened when it is hit: ``"`looking` was entered"``."""
        return _WORDS[self.kind][1].format(self._quoted)

    @property
    def _quoted(self) -> str:
        where = f" in `{path_text(self.instance)}`" if self.element is None and self.instance else ""
        return f"`{self.name}`{where}"

    def __str__(self) -> str:
        state = "" if self.enabled else ", switched off"
        state += ", dormant" if self.dormant else ""
        hits = f"{self.hits} hits" if self.hits != 1 else "1 hit"
        problem = f". {self.problem}" if self.problem else ""
        return (
            f"{self.number}: pause when {_WORDS[self.kind][0].format(self._quoted)}; {hits}{state}{problem}"
        )

"""What a transition waits for: an event, a condition, a delay, or nothing.

Each kind of trigger is a small frozen class that says how the language writes it, how a picture shows it,
which names it refers to and which blocks it holds. How it is tested is the interpreter's matter. That a
transition leads outward (``exit``) has nothing to do with its trigger.

Paper: §3.1 (events, epsilon transitions, timeouts).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, NamedTuple

from lrp_jupyter.language.source import Block, Name

__all__ = [
    "FORMS",
    "Condition",
    "Delay",
    "Epsilon",
    "Occurrence",
    "Purpose",
    "TransitionKind",
    "Trigger",
    "TriggerForm",
]

TransitionKind = Literal["on", "ontime", "eps", "exit"]
Purpose = Literal["action", "initialiser", "condition", "delay"]
"""What the value of a block is for; that of an action has no use."""


@dataclass(frozen=True, slots=True)
class Trigger:
    """The common part of all triggers; nothing is made of this class itself."""

    keyword: ClassVar[TransitionKind]
    """Of the form that a transition with this trigger has, unless it leads outward."""
    style: ClassVar[str]
    """Which kind of arrow a picture draws."""
    can_exit: ClassVar[bool] = False
    """Whether an ``exit`` can wait for it."""

    @property
    def text(self) -> str:
        """The trigger as the language writes it."""
        raise NotImplementedError

    @property
    def arrow(self) -> str:
        """The trigger as the arrow in a picture shows it."""
        return self.text

    @property
    def reference(self) -> tuple[Literal["event", "variable"], Name] | None:
        """What it refers to by name."""
        return None

    @property
    def block(self) -> tuple[Purpose, Block] | None:
        """The block in it, and what its value is for."""
        return None

    @property
    def due(self) -> int | None:
        """After how many milliseconds it is enabled in any case; None if that depends on the run."""
        return None


@dataclass(frozen=True, slots=True)
class Occurrence(Trigger):
    """``(on NAME …)``: an event, by name."""

    event: Name
    keyword: ClassVar[TransitionKind] = "on"
    style: ClassVar[str] = "on"
    can_exit: ClassVar[bool] = True

    @property
    def text(self) -> str:
        """The event's name."""
        return str(self.event)

    @property
    def reference(self) -> tuple[Literal["event", "variable"], Name]:
        """The event."""
        return "event", self.event


@dataclass(frozen=True, slots=True)
class Condition(Trigger):
    """``(on [condition] …)``: an inline event."""

    condition: Block
    keyword: ClassVar[TransitionKind] = "on"
    style: ClassVar[str] = "on"
    can_exit: ClassVar[bool] = True

    @property
    def text(self) -> str:
        """The block."""
        return f"[{self.condition.text}]"

    @property
    def arrow(self) -> str:
        """The block, without the space around its code."""
        return f"[{self.condition.text.strip()}]"

    @property
    def block(self) -> tuple[Purpose, Block]:
        """The condition."""
        return "condition", self.condition


@dataclass(frozen=True, slots=True)
class Delay(Trigger):
    """``(ontime DELAY …)``: milliseconds, a variable that holds them, or a block that computes them."""

    amount: int | Name | Block
    keyword: ClassVar[TransitionKind] = "ontime"
    style: ClassVar[str] = "ontime"

    @property
    def text(self) -> str:
        """The delay as it is written."""
        return f"[{self.amount.text}]" if isinstance(self.amount, Block) else str(self.amount)

    @property
    def arrow(self) -> str:
        """The delay, with its unit where it is known."""
        return f"{self.amount} ms" if isinstance(self.amount, int) else f"after {self.text}"

    @property
    def reference(self) -> tuple[Literal["event", "variable"], Name] | None:
        """The variable, if it names one."""
        return ("variable", self.amount) if isinstance(self.amount, Name) else None

    @property
    def block(self) -> tuple[Purpose, Block] | None:
        """The block, if it has one."""
        return ("delay", self.amount) if isinstance(self.amount, Block) else None

    @property
    def due(self) -> int | None:
        """The delay, if it is a number."""
        return max(0, self.amount) if isinstance(self.amount, int) else None


@dataclass(frozen=True, slots=True)
class Epsilon(Trigger):
    """``(eps …)``: enabled at once."""

    keyword: ClassVar[TransitionKind] = "eps"
    style: ClassVar[str] = "eps"

    @property
    def text(self) -> str:
        """Nothing is written."""
        return ""

    @property
    def arrow(self) -> str:
        """The Greek letter."""
        return "ε"

    @property
    def due(self) -> int:
        """At once."""
        return 0


class TriggerForm(NamedTuple):
    """How the form with one keyword is written.

    Parameters
    ----------
    usage : str
        An example of it.
    make : callable
        Returns the trigger, given the name, block or number behind the keyword, or None.
    name : str
        What a name in the place of the trigger is; empty where there is no trigger.
    block : str
        What a block in that place must hold.
    outward : bool
        It leads out of its machine.
    """

    usage: str
    make: Callable[[Any], Trigger]
    name: str = ""
    block: str = ""
    outward: bool = False


def _event(part: Name | Block) -> Trigger:
    return Condition(part) if isinstance(part, Block) else Occurrence(part)


FORMS: dict[str, TriggerForm] = {
    "on": TriggerForm("(on event source -> destination)", _event, "an event's name", "the condition"),
    "ontime": TriggerForm(
        "(ontime milliseconds source -> destination)", Delay, "a variable's name", "the delay in milliseconds"
    ),
    "eps": TriggerForm("(eps source -> destination)", lambda _: Epsilon()),
    "exit": TriggerForm(
        "(exit event source -> destination)", _event, "an event's name", "the condition", outward=True
    ),
}
"""The forms of transitions by keyword; ``grammar.lark`` says which tokens they hold."""

"""The triggers of transitions: an event, a condition, a delay, or nothing; `exit` is independent of them.

Paper: §3.1 (events, epsilon transitions, timeouts).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal, NamedTuple, cast

from lrp_jupyter.language.source import Block, Name

TransitionKind = Literal["on", "ontime", "eps", "exit"]
Reference = tuple[Literal["event", "variable", "machine"], Name]
"""The kind and the name of an element that a trigger refers to."""
Purpose = Literal["action", "initialiser", "condition", "delay"]
"""The use of a block's value; that of an action is not used."""


@dataclass(frozen=True, slots=True)
class Trigger:
    """Abstract base class of the triggers."""

    keyword: ClassVar[TransitionKind]
    """Keyword of a transition with this trigger, unless it leads outward."""
    can_exit: ClassVar[bool] = False
    """Whether an ``exit`` can have this trigger."""

    @property
    def text(self) -> str:
        """The trigger's source text."""
        raise NotImplementedError

    @property
    def arrow(self) -> str:
        """The trigger's text at the arrow in a picture."""
        return self.text

    @property
    def reference(self) -> Reference | None:
        """What it refers to by name, or None."""
        return None

    @property
    def block(self) -> tuple[Purpose, Block] | None:
        """Its block and what the value is used for, or None."""
        return None

    @property
    def due(self) -> int | None:
        """Milliseconds after which it is certainly enabled; None if that depends on the run."""
        return None


@dataclass(frozen=True, slots=True)
class Occurrence(Trigger):
    """``(on NAME …)``: an event, by name."""

    event: Name
    keyword: ClassVar[TransitionKind] = "on"
    can_exit: ClassVar[bool] = True

    @property
    def text(self) -> str:
        """The event's name."""
        return str(self.event)

    @property
    def reference(self) -> Reference:
        """The event."""
        return "event", self.event


@dataclass(frozen=True, slots=True)
class Condition(Trigger):
    """``(on [condition] …)``: an inline event."""

    condition: Block
    keyword: ClassVar[TransitionKind] = "on"
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
class InState(Trigger):
    """``(on MACHINE.STATE …)``: the machine that the source state spawned is in that state."""

    machine: Name
    state: Name
    keyword: ClassVar[TransitionKind] = "on"
    can_exit: ClassVar[bool] = True

    @property
    def text(self) -> str:
        """The names of the machine and of its state."""
        return f"{self.machine}.{self.state}"

    @property
    def reference(self) -> Reference:
        """The machine."""
        return "machine", self.machine


@dataclass(frozen=True, slots=True)
class Delay(Trigger):
    """``(ontime DELAY …)``: milliseconds, a variable that holds them, or a block that computes them."""

    amount: int | Name | Block
    keyword: ClassVar[TransitionKind] = "ontime"

    @property
    def text(self) -> str:
        """The delay as it is written."""
        return f"[{self.amount.text}]" if isinstance(self.amount, Block) else str(self.amount)

    @property
    def arrow(self) -> str:
        """The delay, with its unit where it is known."""
        return f"{self.amount} ms" if isinstance(self.amount, int) else f"after {self.text}"

    @property
    def duration(self) -> str:
        """How long it is, with its unit where it is known: whole seconds in seconds."""
        if not isinstance(self.amount, int):
            return self.text
        return f"{self.amount} ms" if self.amount % 1000 else f"{self.amount // 1000} s"

    @property
    def reference(self) -> Reference | None:
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

    @property
    def text(self) -> str:
        """The empty text."""
        return ""

    @property
    def arrow(self) -> str:
        """The Greek letter epsilon."""
        return "ε"

    @property
    def due(self) -> int:
        """Zero: it is enabled at once."""
        return 0


class TriggerForm(NamedTuple):
    """The syntax of the form with one keyword.

    `usage`: an example of it.
    `make`: returns the trigger for the names, block or number after the keyword.
    `name`: what a name as trigger refers to; empty where there is no trigger.
    `block`: what a block as trigger must contain.
    `outward`: whether it leads out of its machine.
    """

    usage: str
    make: Callable[..., Trigger]
    name: str = ""
    block: str = ""
    outward: bool = False


def _event(part: Name | Block, state: Name | None = None) -> Trigger:
    if state is not None:
        return InState(cast(Name, part), state)
    return Condition(part) if isinstance(part, Block) else Occurrence(part)


FORMS: dict[str, TriggerForm] = {
    "on": TriggerForm("(on event source -> destination)", _event, "an event's name", "the condition"),
    "ontime": TriggerForm(
        "(ontime milliseconds source -> destination)", Delay, "a variable's name", "the delay in milliseconds"
    ),
    "eps": TriggerForm("(eps source -> destination)", Epsilon),
    "exit": TriggerForm(
        "(exit event source -> destination)", _event, "an event's name", "the condition", outward=True
    ),
}
"""The forms of transitions by keyword; ``grammar.lark`` defines their tokens."""

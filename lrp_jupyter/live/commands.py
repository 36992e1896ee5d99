"""The commands of a session: frozen values, each of which can be applied to a loop.

They come from any thread, are queued in the loop's inbox, and are applied by one thread between two
ticks. Nothing else crosses from the views to the interpreter.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.patching import Patch
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, Program
from lrp_jupyter.language.unmeant import Unmeant
from lrp_jupyter.live.breakpoint import Breakpoint
from lrp_jupyter.live.breakpoints import Breakpoints
from lrp_jupyter.live.inbox import Command
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.record import Record

_ARGUMENTS = (LRPError, ValueError, TypeError)


@dataclass(frozen=True, slots=True)
class ReplaceProgram(Command):
    """Continue with another program. Of several queued in a row the newest wins. Paper: §6.1."""

    recorded: ClassVar[bool] = True
    interrupts: ClassVar[bool] = True
    newest_wins: ClassVar[bool] = True
    program: Program
    unmeant: Unmeant | None = None

    def apply(self, loop: Loop) -> Patch:
        """See :class:`Command`."""
        return loop.interpreter.patch(self.program, loop.timing.now, self.unmeant)

    def kept(self, record: Record) -> tuple[Command, int]:
        """See :class:`Command`: the text, a thousandth of the objects of its program."""
        if not self.program.text:
            return self, 0
        instead = "" if self.unmeant is None else self.unmeant.instead.text
        kept = RepeatEdit(
            self.program.text, self.program.filename, instead, self.unmeant and _light(self.unmeant)
        )
        return kept, len(self.program.text) + len(instead)


@dataclass(frozen=True, slots=True)
class RepeatEdit(Command):
    """Continue with another text, as an edit did before."""

    recorded: ClassVar[bool] = True
    text: str
    filename: str
    instead: str = ""
    unmeant: Unmeant | None = None

    def apply(self, loop: Loop) -> Patch:
        """See :class:`Command`."""
        unmeant = self.unmeant and replace(self.unmeant, instead=parse(self.instead, self.filename))
        return loop.interpreter.patch(parse(self.text, self.filename), loop.timing.now, unmeant)

    def kept(self, record: Record) -> tuple[Command, int]:
        """See :class:`Command`."""
        return self, len(self.text) + len(self.instead)


def _light(unmeant: Unmeant) -> Unmeant:
    """Return it without the program that runs instead."""
    return replace(unmeant, instead=Program())


@dataclass(frozen=True, slots=True)
class Force(Command):
    """Force a state, by transition or by teleport. Paper: §6.4."""

    recorded: ClassVar[bool] = True
    interrupts: ClassVar[bool] = True
    path: Path
    teleport: bool = False

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.force(self.path, "teleport" if self.teleport else "transition")


@dataclass(frozen=True, slots=True)
class Fire(Command):
    """Go where a transition leads that leaves an active state. Paper: §6.4."""

    recorded: ClassVar[bool] = True
    interrupts: ClassVar[bool] = True
    misuse: ClassVar[tuple[type[BaseException], ...]] = _ARGUMENTS
    path: Path

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.interpreter.fire(self.path, loop.timing.now)


@dataclass(frozen=True, slots=True)
class SetVariable(Command):
    """Evaluate an expression in a variable's scope and assign the value."""

    recorded: ClassVar[bool] = True
    misuse: ClassVar[tuple[type[BaseException], ...]] = (BaseException,)  # it runs code of the caller
    path: Path
    expression: str

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        variable = loop.interpreter.variables.path(self.path)
        loop.interpreter.set_variable(variable, self.expression, loop.timing.now)


@dataclass(frozen=True, slots=True, eq=False)
class Assign(Command):
    """Assign a value to a variable."""

    recorded: ClassVar[bool] = True
    path: Path
    value: object

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        variable, value = loop.interpreter.variables.path(self.path), loop.record.restored(self.value)
        loop.interpreter.assign(variable, value, loop.timing.now)

    def kept(self, record: Record) -> tuple[Command, int]:
        """See :class:`Command`: with a copy of a value that can be changed in place."""
        return Assign(self.path, record.kept(self.value)), 0


@dataclass(frozen=True, slots=True)
class Rename(Command):
    """Rename an element with all its references, without a restart; the result is the new text."""

    recorded: ClassVar[bool] = True
    interrupts: ClassVar[bool] = True
    misuse: ClassVar[tuple[type[BaseException], ...]] = _ARGUMENTS
    kind: str
    path: Path
    new_name: str

    def apply(self, loop: Loop) -> str:
        """See :class:`Command`."""
        return loop.interpreter.rename(self.kind, self.path, self.new_name, loop.timing.now)


@dataclass(frozen=True, slots=True)
class Rewind(Command):
    """Step back by this number of ticks."""

    recorded: ClassVar[bool] = True
    undoes: ClassVar[bool] = True
    interrupts: ClassVar[bool] = True
    misuse: ClassVar[tuple[type[BaseException], ...]] = _ARGUMENTS
    ticks: int

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.rewind(self.ticks)


@dataclass(frozen=True, slots=True)
class Reset(Command):
    """Restart the program at the next tick."""

    recorded: ClassVar[bool] = True
    interrupts: ClassVar[bool] = True

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.interpreter.reset(loop.timing.now)


@dataclass(frozen=True, slots=True)
class Renew(Command):
    """Make a broken session whole, with a new run of a program that is not started yet."""

    recorded: ClassVar[bool] = True
    mends: ClassVar[bool] = True
    program: Program

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.renew(self.program)


@dataclass(frozen=True, slots=True)
class Pause(Command):
    """Pause, for a reason (a sentence, or empty). Paper: §6.3."""

    interrupts: ClassVar[bool] = True
    urgent: ClassVar[bool] = True
    reason: str = ""

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.pause(self.reason)


@dataclass(frozen=True, slots=True)
class Resume(Command):
    """Start, or continue after a pause. Paper: §6.3."""

    moves: ClassVar[bool] = True

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.resume()


@dataclass(frozen=True, slots=True)
class Step(Command):
    """Run one tick, and one period of time. Paper: §6.3."""

    interrupts: ClassVar[bool] = True
    moves: ClassVar[bool] = True

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.step()


@dataclass(frozen=True, slots=True)
class SetRate(Command):
    """Change the ticks per second; 0 is as fast as possible. Paper: §5.1."""

    recorded: ClassVar[bool] = True
    misuse: ClassVar[tuple[type[BaseException], ...]] = _ARGUMENTS
    rate: float

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.set_rate(self.rate)


@dataclass(frozen=True, slots=True)
class EndAt(Command):
    """Have a run that a clock paces rest at a time, in seconds of the run; one that has passed is now."""

    time: float

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.timing.end = self.time


@dataclass(frozen=True, slots=True)
class SetSpeed(Command):
    """Change the seconds of the session per wall second."""

    misuse: ClassVar[tuple[type[BaseException], ...]] = _ARGUMENTS
    speed: float

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        loop.timing.set_speed(self.speed)


@dataclass(frozen=True, slots=True)
class SetPolicy(Command):
    """Change ``on_active_edit`` or ``on_issue``."""

    recorded: ClassVar[bool] = True
    misuse: ClassVar[tuple[type[BaseException], ...]] = _ARGUMENTS
    name: Literal["on_active_edit", "on_issue"]
    value: str

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        setattr(loop.interpreter, self.name, self.value)


@dataclass(frozen=True, slots=True)
class AddBreakpoint(Command):
    """Add a breakpoint; the result is the breakpoint with its number."""

    misuse: ClassVar[tuple[type[BaseException], ...]] = _ARGUMENTS
    breakpoint: Breakpoint

    def apply(self, loop: Loop) -> Breakpoint:
        """See :class:`Command`."""
        if loop.breakpoints is None:
            loop.breakpoints = Breakpoints(loop.interpreter)
        return loop.breakpoints.add(self.breakpoint)


@dataclass(frozen=True, slots=True)
class ChangeBreakpoint(Command):
    """Switch a breakpoint on or off, or set the hit from which on it pauses; None changes nothing."""

    misuse: ClassVar[tuple[type[BaseException], ...]] = _ARGUMENTS
    number: int
    enabled: bool | None = None
    after: int | None = None

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        (loop.breakpoints or Breakpoints(loop.interpreter)).change(self.number, self.enabled, self.after)


@dataclass(frozen=True, slots=True)
class RemoveBreakpoint(Command):
    """Remove a breakpoint."""

    misuse: ClassVar[tuple[type[BaseException], ...]] = _ARGUMENTS
    number: int

    def apply(self, loop: Loop) -> None:
        """See :class:`Command`."""
        (loop.breakpoints or Breakpoints(loop.interpreter)).remove(self.number)


@dataclass(frozen=True, slots=True, eq=False)
class Call(Command):
    """Call a function between two ticks; used to drag, draw on and reset the world."""

    misuse: ClassVar[tuple[type[BaseException], ...]] = (BaseException,)  # it runs code of the caller
    function: Callable[[], Any]

    def apply(self, loop: Loop) -> Any:
        """See :class:`Command`."""
        return self.function()

"""The commands of a session: frozen values, each of which can be applied to a loop.

They come from any thread, are queued in the loop's inbox, and are applied by one thread between two
ticks. Nothing else crosses from the views to the interpreter.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

from lrp_jupyter.bridges.guarding.safety import OF_COMMANDS
from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.patching import Patch
from lrp_jupyter.language.half_typed import Unmeant
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, Program
from lrp_jupyter.live.running.breakpoint import Breakpoint
from lrp_jupyter.live.running.breakpoints import Breakpoints
from lrp_jupyter.live.running.inbox import Command
from lrp_jupyter.live.running.inputs import EndProgram as EndProgram
from lrp_jupyter.live.running.inputs import Pause as Pause
from lrp_jupyter.live.running.inputs import Resume as Resume
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.running.record import Record

_ARGUMENTS = (LRPError, ValueError, TypeError)
_ANYTHING = (BaseException,)  # the caller's code runs


@dataclass(frozen=True, slots=True)
class ReplaceProgram(Command, recorded=True, interrupts=True, newest_wins=True):
    """Continue with another program. Of several queued in a row the newest wins. Paper: §6.1.

    `is_text`: whether only texts are kept, to be parsed again: a thousandth of the objects.
    """

    program: Program
    unmeant: Unmeant | None = None
    is_text: bool = False

    def apply(self, loop: Loop) -> Patch:
        program, unmeant = self.program, self.unmeant
        if self.is_text:
            program = parse(program.text, program.filename)
            unmeant = unmeant and replace(unmeant, instead=parse(unmeant.instead.text, program.filename))
        return loop.interpreter.patch(program, loop.timing.now, unmeant)

    def kept(self, record: Record) -> tuple[Command, int]:
        program, unmeant = self.program, self.unmeant
        if not program.text:
            return self, 0
        light = unmeant and replace(unmeant, instead=_text_of(unmeant.instead))
        letters = len(program.text) + len(unmeant.instead.text if unmeant else "")
        return ReplaceProgram(_text_of(program), light, is_text=True), letters


def _text_of(program: Program) -> Program:
    return Program(text=program.text, filename=program.filename)


@dataclass(frozen=True, slots=True)
class Force(Command, recorded=True, interrupts=True):
    """Force a state, by transition or by teleport. Paper: §6.4."""

    path: Path
    teleport: bool = False

    def apply(self, loop: Loop) -> None:
        loop.force(self.path, self.teleport)


@dataclass(frozen=True, slots=True)
class Fire(Command, recorded=True, interrupts=True, misuse=_ARGUMENTS):
    """Follow a transition from an active state. Paper: §6.4."""

    path: Path

    def apply(self, loop: Loop) -> None:
        loop.interpreter.fire(self.path, loop.timing.now)


@dataclass(frozen=True, slots=True)
class SetVariable(Command, recorded=True, misuse=_ANYTHING):
    """Evaluate an expression in a variable's scope and assign the value."""

    path: Path
    expression: str

    def apply(self, loop: Loop) -> None:
        variable = loop.interpreter.variables.path(self.path)
        loop.interpreter.set_variable(variable, self.expression, loop.timing.now)


@dataclass(frozen=True, slots=True, eq=False)
class Assign(Command, recorded=True):
    """Assign a value to a variable."""

    path: Path
    value: object

    def apply(self, loop: Loop) -> None:
        variable, value = loop.interpreter.variables.path(self.path), loop.record.restored(self.value)
        loop.interpreter.assign(variable, value, loop.timing.now)

    def kept(self, record: Record) -> tuple[Command, int]:
        return Assign(self.path, record.kept(self.value)), 0


@dataclass(frozen=True, slots=True)
class Rename(Command, recorded=True, interrupts=True, misuse=_ARGUMENTS):
    """Rename an element with all its references, without a restart; the result is the new text."""

    kind: str
    path: Path
    name: str

    def apply(self, loop: Loop) -> str:
        return loop.interpreter.rename(self.kind, self.path, self.name, loop.timing.now)


@dataclass(frozen=True, slots=True)
class Rewind(Command, recorded=True, undoes=True, interrupts=True, misuse=_ARGUMENTS):
    """Step back by this number of ticks."""

    ticks: int

    def apply(self, loop: Loop) -> None:
        loop.rewind(self.ticks)


@dataclass(frozen=True, slots=True)
class Reset(Command, recorded=True, interrupts=True):
    """End the run, and restart the program at the next tick."""

    def apply(self, loop: Loop) -> None:
        loop.reset()


@dataclass(frozen=True, slots=True)
class Renew(Command, recorded=True, mends=True):
    """Repair a broken session by a new run of a program, not started yet."""

    program: Program

    def apply(self, loop: Loop) -> None:
        loop.renew(self.program)


@dataclass(frozen=True, slots=True)
class Step(Command, interrupts=True, moves=True):
    """Run one tick, and one period of time. Paper: §6.3."""

    def apply(self, loop: Loop) -> None:
        loop.step()


@dataclass(frozen=True, slots=True)
class SetRate(Command, recorded=True, misuse=_ARGUMENTS):
    """Change the ticks per second; 0 is as fast as possible. Paper: §5.1."""

    rate: float

    def apply(self, loop: Loop) -> None:
        loop.set_rate(self.rate)


@dataclass(frozen=True, slots=True)
class EndAt(Command):
    """Set the time, in seconds, at which a run paced by a clock comes to rest; a past time means now."""

    time: float

    def apply(self, loop: Loop) -> None:
        loop.timing.end = self.time


@dataclass(frozen=True, slots=True)
class SetSpeed(Command, misuse=_ARGUMENTS):
    """Change the seconds of the session per wall second."""

    speed: float

    def apply(self, loop: Loop) -> None:
        loop.timing.set_speed(self.speed)


@dataclass(frozen=True, slots=True)
class SetPolicy(Command, recorded=True, misuse=_ARGUMENTS):
    """Change ``on_active_edit`` or ``on_issue``."""

    name: Literal["on_active_edit", "on_issue"]
    value: str

    def apply(self, loop: Loop) -> None:
        setattr(loop.interpreter, self.name, self.value)


@dataclass(frozen=True, slots=True)
class ClearIssues(Command, recorded=True):
    """Clear the issues so far, and the notices about commands of the program."""

    def apply(self, loop: Loop) -> None:
        loop.interpreter.issues.clear()
        loop.bridge.safety.forget_notices(*OF_COMMANDS)


@dataclass(frozen=True, slots=True)
class AddBreakpoint(Command, misuse=_ARGUMENTS):
    """Add a breakpoint; the result is the breakpoint with its number."""

    breakpoint: Breakpoint

    def apply(self, loop: Loop) -> Breakpoint:
        if loop.breakpoints is None:
            loop.breakpoints = Breakpoints(loop.interpreter)
        return loop.breakpoints.add(self.breakpoint)


@dataclass(frozen=True, slots=True)
class ChangeBreakpoint(Command, misuse=_ARGUMENTS):
    """Switch a breakpoint on or off, or set the first hit at which it pauses; None changes nothing."""

    number: int
    enabled: bool | None = None
    after: int | None = None

    def apply(self, loop: Loop) -> None:
        (loop.breakpoints or Breakpoints(loop.interpreter)).change(self.number, self.enabled, self.after)


@dataclass(frozen=True, slots=True)
class RemoveBreakpoint(Command, misuse=_ARGUMENTS):
    """Remove a breakpoint."""

    number: int

    def apply(self, loop: Loop) -> None:
        (loop.breakpoints or Breakpoints(loop.interpreter)).remove(self.number)


@dataclass(frozen=True, slots=True, eq=False)
class Call(Command, misuse=_ANYTHING):
    """Call a function between two ticks; used to drag, draw on and reset the world."""

    function: Callable[[], Any]

    def apply(self, loop: Loop) -> Any:
        return self.function()

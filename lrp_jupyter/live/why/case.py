"""A transition in a tick: the subject of a question, with the recorded data about it."""

from __future__ import annotations

from dataclasses import dataclass

from lrp_jupyter.interpreter.history import PastMachine, PastState
from lrp_jupyter.interpreter.tick_reasons import Cause
from lrp_jupyter.language.program import Block, Element, Path, Program, Transition
from lrp_jupyter.language.resolution import Scope, resolve
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.wording import time_text


@dataclass(frozen=True, slots=True)
class Case:
    """A transition, by path of definition, in a tick; its line is 0 if it has none."""

    run: RecordedRun
    element: Element
    label: str
    line: int
    tick: int
    cause: Cause
    since: float | None = None
    """When its trigger began to hold, in seconds; None if it does not, or need not for some time."""

    @property
    def time(self) -> float:
        """The time of the tick, in seconds."""
        return self.run.time(self.tick)

    @property
    def state(self) -> PastState:
        """The state of the run when the tick began."""
        return self.run.state(self.tick)

    @property
    def did_not_fire(self) -> str:
        """The beginning of a sentence that says so."""
        return f"{self._named} did not fire at {time_text(self.time)}"

    @property
    def did_fire(self) -> str:
        """The beginning of a sentence that says so."""
        return f"{self._named} fired at {time_text(self.time)}"

    @property
    def _named(self) -> str:
        machine = self.cause.machine
        instance = machine.path if machine is not None else self.run.instance and self.run.instance[0]
        place = f" (line {self.line})" if self.line else ""
        return f"`{self.label}`{self.run.where(instance or (), self.tick)}{place}"

    @property
    def program(self) -> Program:
        """The program that ran."""
        return self.state.program

    @property
    def noun(self) -> Transition:
        """The transition in that program."""
        arrow = resolve(self.program).arrow(self.element)
        assert arrow is not None
        return arrow.noun

    @property
    def tested(self) -> tuple[Block, Scope] | None:
        """The block that it tests, and the scope of the block; or None."""
        arrow = resolve(self.program).arrow(self.element)
        return arrow.tested if arrow is not None else None

    @property
    def machine(self) -> PastMachine:
        """Its machine, which was running."""
        assert self.cause.machine is not None
        return self.cause.machine

    @property
    def elapsed(self) -> float:
        """The milliseconds for which the active state of its machine had been active, or its trigger held."""
        return (self.time - (self.machine.entered if self.since is None else self.since)) * 1000

    @property
    def home(self) -> PastMachine | None:
        """The machine in whose scope its test is evaluated; None for the top level."""
        return None if self.tested is None else self.around(self.tested[1].path)

    def around(self, defined: Path) -> PastMachine | None:
        """Return its own machine, or one around that, by path of definition; None if it is neither."""
        ways = [self.machine.path[:end] for end in range(1, len(self.machine.path) + 1, 2)]
        machines = (each for each in self.state.walk() if each.path in ways)
        return next((each for each in machines if each.state[:-1] == defined), None)

"""A recorded run: its facts in order, and the time and the program of every tick."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from lrp_jupyter.interpreter.history import Dated, PastState
from lrp_jupyter.language.blocks.expressions import Evaluation
from lrp_jupyter.language.lookup import where
from lrp_jupyter.language.program import Element, Path, Program
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.running.notebook_names import ChangeNames
from lrp_jupyter.live.why.earlier_names import Names

Again = Callable[[int, Element, Path], Evaluation | Exception | None]
"""Runs a tick again in a fork and returns how a transition was tested there; None if that is impossible.

The path is that of its machine, as spawned.
"""


class RecordedRun:
    """Reads the recorded data of a run, for one question. Used on the thread that ticks, between two ticks.

    The *when* of an event is the number of its tick; between two ticks, the number of the first one plus a
    half.
    """

    def __init__(self, loop: Loop, again: Again) -> None:
        self.loop = loop
        self.again = again
        self.history = loop.interpreter.history
        self.changes = [
            (entry.tick, entry.what) for entry in loop.record.inputs if isinstance(entry.what, ChangeNames)
        ]
        """The changes of names of the namespace, each with the tick after which it came."""
        self._states: dict[int, PastState] = {}
        self.instance: tuple[Path, float] | None = None
        """The machine that is meant, by path as spawned, and when it has that; None if there is only one."""

    def tick(self, at: int | None) -> int:
        """Return the tick of a question, for None the last; raise ValueError if it is not remembered."""
        ticks = self.history.ticks
        tick = ticks.stop - 1 if at is None else at
        if tick not in ticks:
            raise ValueError(self.history.refusal(tick))
        return tick

    def time(self, when: float) -> float:
        """Return the time of a tick; for an event between two ticks, the time of the first."""
        return self.history.time(int(when)) if int(when) in self.history.ticks else 0.0

    def entered(self, state: Path, when: float) -> float:
        """Return the time at which a state, as spawned, was entered, if it is still active at the next tick.

        For any other state, return the time of the tick before.
        """
        if int(when) == when:
            return self.time(when)
        following = int(when + 0.5)
        if following not in self.history.ticks:
            now = self.loop.interpreter.entered(state)
            return self.time(when) if now is None else now
        machines = self.state(following).walk()
        return next((each.entered for each in machines if each.full_path == state), self.time(when))

    def state(self, tick: int) -> PastState:
        """Return the state of the run when a tick began; it is read from the journal once."""
        if tick not in self._states:
            self._states[tick] = self.history.state(tick, before=True)
        return self._states[tick]

    def program(self, tick: int) -> Program:
        """Return the program that ran in a tick; the current one for a future tick."""
        if tick in self.history.ticks:
            return self.state(tick).program
        return self.loop.interpreter.program

    def where(self, machine: Path, when: float) -> str:
        """Say in which instance something happened, if its machine could have several then."""
        return where(self.program(int(when + 0.5)), machine)

    def names(self, tick: float) -> Names:
        """Return the names that elements had in a tick."""
        return Names(self.loop.interpreter.moves, tick)

    def means(self, machine: Path, when: float) -> bool:
        """Return whether the machine that is meant had a path as spawned."""
        return self.instance is None or self.is_same(*self.instance, machine, when)

    def is_same(self, machine: Path, at: float, other: Path, when: float) -> bool:
        """Return whether a machine, by paths as spawned, had one of them at one moment and one at another."""
        if not self.loop.interpreter.moves:
            return machine == other
        return self._way(machine, at, at) == self._way(other, when, at)

    def _way(self, machine: Path, when: float, at: float) -> tuple[Path, ...]:
        """Return the states around a machine, and itself, by their paths of definition at a moment."""
        program, names = resolve(self.program(int(when + 0.5))), self.names(at)
        around = [names.of("state", state, when) for state in program.around(machine)]
        return (*around, names.of("machine", program.defined(machine), when))

    def backward(self, tick: int, *, before: bool = False) -> Iterator[Dated]:
        """Return what happened up to the end of a tick, the last fact first.

        Facts since the last tick belong to it. With `before`, return only facts from before the tick began.
        """
        after = 0.5 if tick == self.history.ticks.stop - 1 else 0
        return reversed(self.history.told(last=tick - 0.5 if before else tick + after))

"""The log of a run: checkpoints, and after each of them the inputs with their steps.

A checkpoint and the inputs after it reproduce the run up to any later moment. The log is bounded, by its
owner (:meth:`InputLog.begin`) or by itself: the oldest checkpoints are dropped, with their inputs.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field
from random import Random
from typing import Any, NamedTuple

from lrp_jupyter.sim.floor import Mark
from lrp_jupyter.sim.sim_robot import Memory, Motion
from lrp_jupyter.sim.world import World
from lrp_jupyter.sim.world_inputs import Input

CHECKPOINT_INPUTS = 20_000
MOST_CHECKPOINTS = 10_000
MOST_INPUTS = 500_000


class WorldMoment(NamedTuple):
    """A moment of a run: a step, and the number of inputs applied before it."""

    step: int
    inputs: int


@dataclass(slots=True)
class Checkpoint:
    """The full state of a run at one moment, and the inputs since then."""

    moment: WorldMoment
    world: World
    base: int  # step of the start or last reset
    robots: list[tuple[Motion, Memory]]
    solids: list[Motion]
    random: tuple[Any, ...]
    marks: list[Mark]
    mark_count: int
    between_inputs: bool  # made by an input: earlier inputs of its step come before it
    inputs: list[tuple[int, Input]] = field(default_factory=list)

    def is_after(self, step: int, inputs: int | None) -> bool:
        """Return whether it is later than a step (and a number of inputs; None: all of that step)."""
        if inputs is None:
            return self.moment.step > step or (self.moment.step == step and self.between_inputs)
        return self.moment.step > step or self.moment.inputs > inputs


class InputLog:
    """The checkpoints of a run in their order, each with the inputs up to the next."""

    def __init__(self) -> None:
        self._checkpoints: list[Checkpoint] = []

    @property
    def earliest(self) -> int:
        """The first step that can be reproduced."""
        return self._checkpoints[0].moment.step

    @property
    def last(self) -> Checkpoint:
        """The last checkpoint."""
        return self._checkpoints[-1]

    @property
    def wants_checkpoint(self) -> bool:
        """Whether a replay from the last checkpoint would have to apply many inputs."""
        return len(self._checkpoints[-1].inputs) >= CHECKPOINT_INPUTS

    def add(self, checkpoint: Checkpoint) -> None:
        """Add a checkpoint; drop the oldest ones beyond the limits of checkpoints and inputs."""
        self._checkpoints.append(checkpoint)
        kept = sum(len(old.inputs) for old in self._checkpoints)
        while len(self._checkpoints) > 1 and (
            len(self._checkpoints) > MOST_CHECKPOINTS or kept > MOST_INPUTS
        ):
            kept -= len(self._checkpoints.pop(0).inputs)

    def begin(self, step: int, inputs: int) -> None:
        """Drop what no moment from this one on needs."""
        while len(self._checkpoints) > 1 and not self._checkpoints[1].is_after(step, inputs):
            del self._checkpoints[0]

    def record(self, step: int, what: Input) -> None:
        """Record an input applied at a step."""
        self._checkpoints[-1].inputs.append((step, what))

    def find(self, step: int, inputs: int | None) -> tuple[Checkpoint, list[tuple[int, Input]]]:
        """Return what reproduces a moment: the last checkpoint before it, and the inputs between the two.

        `inputs`: number of inputs applied before it; None: those before this step.
        Raises ValueError: it is too long ago.
        """
        last = next((each for each in reversed(self._checkpoints) if not each.is_after(step, inputs)), None)
        if last is None:
            raise ValueError(f"Step {step} is too long ago: the log begins in step {self.earliest}.")
        if inputs is None:
            return last, [(at, what) for at, what in last.inputs if at < step]
        noted = last.inputs[: max(0, inputs - last.moment.inputs)]
        return last, [(at, what) for at, what in noted if at <= step]

    def between(self, first: WorldMoment, last: WorldMoment) -> list[tuple[int, Input]]:
        """Return the inputs after a moment, up to another one, with their steps."""
        return [
            each
            for checkpoint in self._checkpoints
            for number, each in enumerate(checkpoint.inputs, start=checkpoint.moment.inputs)
            if first.inputs <= number < last.inputs
        ]

    def cut(self, step: int, inputs: int | None) -> tuple[Checkpoint, list[tuple[int, Input]]]:
        """Drop everything after a moment; return the same as :meth:`find`, to be recorded again."""
        last, between = self.find(step, inputs)
        while self._checkpoints[-1] is not last:
            self._checkpoints.pop()
        last.inputs = []
        return last, between


def packed(random: Random) -> tuple[Any, ...]:
    """Return the state of a generator, packed to a tenth of its size."""
    version, numbers, spare = random.getstate()
    return version, array("L", numbers).tobytes(), spare


def unpack(random: Random, state: tuple[Any, ...]) -> None:
    """Restore a packed state of a generator."""
    version, numbers_of, spare = state
    numbers = array("L")
    numbers.frombytes(numbers_of)
    random.setstate((version, tuple(numbers), spare))

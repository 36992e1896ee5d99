"""What is recorded of a run: checkpoints, and after each of them the inputs with their steps.

From a checkpoint and the inputs that followed it the run can be made again up to any later moment.
The recording is bounded: the oldest checkpoints are forgotten, with their inputs.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field
from random import Random
from typing import Any, NamedTuple

from lrp_jupyter.sim.floor import Mark
from lrp_jupyter.sim.inputs import Input
from lrp_jupyter.sim.robot import Memory, Motion

__all__ = ["Checkpoint", "InputLog", "WorldMoment", "packed", "unpack"]

CHECKPOINT_INPUTS = 20_000
MOST_CHECKPOINTS = 1_000
MOST_INPUTS = 250_000


class WorldMoment(NamedTuple):
    """A point of a run: a step, and the number of inputs that had acted."""

    step: int
    inputs: int


@dataclass(slots=True)
class Checkpoint:
    """Everything that changes in a run, at one moment of it, and the inputs since then."""

    moment: WorldMoment
    base: int  # step of the start or last reset
    robots: list[tuple[Motion, Memory]]
    solids: list[Motion]
    random: tuple[Any, ...]
    marks: list[Mark]
    mark_count: int
    between_inputs: bool  # made by an input, so that earlier inputs of its step belong before it
    inputs: list[tuple[int, Input]] = field(default_factory=list)

    def is_after(self, step: int, inputs: int | None) -> bool:
        """Whether it comes later than a step (and a number of inputs; none: before all of that step)."""
        if inputs is None:
            return self.moment.step > step or (self.moment.step == step and self.between_inputs)
        return self.moment.step > step or self.moment.inputs > inputs


class InputLog:
    """The checkpoints of a run in their order, each with the inputs up to the next."""

    def __init__(self) -> None:
        self._checkpoints: list[Checkpoint] = []

    @property
    def earliest(self) -> int:
        """The first step that can be made again."""
        return self._checkpoints[0].moment.step

    @property
    def wants_checkpoint(self) -> bool:
        """Whether many inputs acted since the last checkpoint: all would have to act again."""
        return len(self._checkpoints[-1].inputs) >= CHECKPOINT_INPUTS

    def add(self, checkpoint: Checkpoint) -> None:
        """Add a checkpoint; forget the oldest where there are too many of them, or of their inputs."""
        self._checkpoints.append(checkpoint)
        kept = sum(len(old.inputs) for old in self._checkpoints)
        while len(self._checkpoints) > 1 and (
            len(self._checkpoints) > MOST_CHECKPOINTS or kept > MOST_INPUTS
        ):
            kept -= len(self._checkpoints.pop(0).inputs)

    def note(self, step: int, what: Input) -> None:
        """Note that an input acts at a step."""
        self._checkpoints[-1].inputs.append((step, what))

    def cut(self, step: int, inputs: int | None) -> tuple[Checkpoint, list[tuple[int, Input]]]:
        """Forget what came after a point of the run; give what it is made again from.

        Parameters
        ----------
        step : int
        inputs : int or None
            How many inputs had acted; None: those before this step.

        Returns
        -------
        Checkpoint
            The last one before the point.
        list of (int, Input)
            What acted between the two, to be noted again.
        """
        while len(self._checkpoints) > 1 and self._checkpoints[-1].is_after(step, inputs):
            self._checkpoints.pop()
        checkpoint = self._checkpoints[-1]
        noted, checkpoint.inputs = checkpoint.inputs, []
        if inputs is None:
            return checkpoint, [(at, what) for at, what in noted if at < step]
        noted = noted[: max(0, inputs - checkpoint.moment.inputs)]
        return checkpoint, [(at, what) for at, what in noted if at <= step]


def packed(random: Random) -> tuple[Any, ...]:
    """Return the state of a generator, a tenth of its size."""
    version, numbers, spare = random.getstate()
    return version, array("L", numbers).tobytes(), spare


def unpack(random: Random, state: tuple[Any, ...]) -> None:
    """Bring a generator into a state that was packed."""
    version, numbers_of, spare = state
    numbers = array("L")
    numbers.frombytes(numbers_of)
    random.setstate((version, tuple(numbers), spare))

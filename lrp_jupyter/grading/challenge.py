"""What a challenge is: a task for a robot, its worlds, and how a program for it is judged."""

from __future__ import annotations

import os
import textwrap
from collections.abc import Callable, Iterable, Sequence
from contextvars import ContextVar
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from lrp_jupyter.arguments import check_number, check_type
from lrp_jupyter.errors import LRPError, ended, sentence_of
from lrp_jupyter.grading.criteria import Criterion
from lrp_jupyter.grading.run_record import RunRecord, at_start
from lrp_jupyter.grading.variation import Variation, varied
from lrp_jupyter.sim.world import World, WorldError
from lrp_jupyter.sim.worlds import load as load_world

Hint = Callable[[RunRecord], str | Iterable[str] | None]
"""A function that inspects a failed run and returns a hint if it finds its mistake, or several, else None."""

folder: ContextVar[Path] = ContextVar("folder", default=Path())
"""The folder from which the files of worlds are loaded."""

_STARTER = """\
(machine mine
  (state waiting)
)

(spawn mine waiting)
"""


@dataclass(frozen=True)
class Challenge:
    """A task to be programmed, with its worlds and criteria.

    Two rules hold in every challenge and are no criteria of it: the program runs without issues, and the
    robot is not carried. A run that breaks one earns no points.

    Parameters
    ----------
    name : str
    task : str
        What the robot has to do, in a sentence or two: what the criteria ask for, and nothing else. The time
        limit is added wherever the task is shown.
    worlds : str, path, World, or several of them
        Names of bundled worlds, files ending in ``.json`` as the lab saves them, or worlds. The program
        has to pass in every one.
    criteria : Criterion, or several
        In the order in which they can be met: partial credit is given up to the first one that is not.
    seconds : float
        Time in which the criteria have to be met, in that of the run. A run ends earlier when every criterion
        is met, or one is broken.
    hints : sequence of Hint
        For typical mistakes, the most specific first.
    rate : float
        Ticks per second.
    noise : dict or None
        Imperfections of the robot: ``{"motor": 0.1, "light": 10}``.
    seeds : int or sequence of int
        Number of runs in each world, each with other noise; or their seeds.
    points : float
        For a program that passes.
    starter : str
        The program to begin with, which does not pass; by default one whose robot stands still. Points count
        above what it earns.
    needed : float
        Share of the runs that a program has to pass, 0 to 1.
    vary : Variation, or several
        What is elsewhere, or looks different, in each run.
    hold : float
        Seconds for which the criteria have to stay met if any is about the end of the run, which then goes on
        for so long: what holds for a moment is not yet an end.
    series : str
        The series of challenges that it belongs to, under which lists show it.
    live : float
        If it is not 0, the task is to edit a running program: a run begins with `starter`, and after so many
        seconds the program that is graded takes its place.
    hidden : str, path, World, or several of them
        Worlds as in `worlds`, in which only ``lrp grade`` runs a program. Their files need not be where the
        students work.
    exam : bool
        The lab gives no hints, and shows a code of the text that students write down.

    Raises
    ------
    LRPError
        A world cannot be read, or a value makes no sense.
    """

    name: str
    task: str
    worlds: tuple[str | World, ...]
    criteria: tuple[Criterion, ...]
    seconds: float = 60
    hints: tuple[Hint, ...] = ()
    rate: float = 10
    noise: dict[str, float] | None = None
    seeds: int | Sequence[int] = 1
    points: float = 10
    starter: str = ""
    needed: float = 1.0
    live: float = 0.0
    vary: Variation | tuple[Variation, ...] = ()
    hold: float = 4.0
    hidden: tuple[str | Path | World, ...] = ()
    exam: bool = False
    series: str = ""

    def __post_init__(self) -> None:
        """Check the values, and read the files of worlds.

        Raises LRPError: a world cannot be read, or a value makes no sense.
        """
        check_type("name", self.name, str, "a text")
        check_number("seconds", self.seconds, "a number of seconds", above=0)
        check_number("needed", self.needed, "a share from 0 to 1", above=0)
        worlds = tuple(map(_world, _several(self.worlds, (str, os.PathLike, World))))
        criteria = _several(self.criteria, Criterion)
        for what, found in (("world", worlds), ("criterion", criteria)):
            if not found:
                raise LRPError(f"The challenge `{self.name}` has no {what}. Give it at least one.")
        for each in criteria:
            check_type("criteria", each, Criterion, "made by functions such as `visits`")
        values = {
            "vary": _several(self.vary, Variation),
            "hold": self.hold if any(each.when == "at the end" for each in criteria) else 0.0,
            "worlds": worlds,
            "criteria": criteria,
            "hints": tuple(self.hints),
            "hidden": tuple(map(_located, _several(self.hidden, (str, os.PathLike, World)))),
            "seeds": self.seeds if isinstance(self.seeds, int) else tuple(self.seeds),
            "starter": self.starter or _STARTER,
        }
        for field, value in values.items():
            object.__setattr__(self, field, value)

    @property
    def assignment(self) -> str:
        """The task as it is shown: what the robot has to do, and in how long."""
        return f"{self.task} Time limit: {_time(self.seconds)}.".lstrip()

    @property
    def beginning(self) -> str:
        """The text to begin with: the assignment and the challenge's name in comments, then the starter."""
        lines = textwrap.wrap(self.assignment, 100, initial_indent="; ", subsequent_indent="; ")
        return "\n".join([*lines, f"; challenge: {self.name}", "", self.starter])

    @property
    def begins_with(self) -> str:
        """What points count above, in words."""
        given = "the program that the challenge begins with"
        return "a robot that stands still" if self.starter == _STARTER else given

    @property
    def runs(self) -> tuple[tuple[World, int], ...]:
        """The world of each run, in which things are where its seed puts them, and the seed."""
        seeds = range(self.seeds) if isinstance(self.seeds, int) else self.seeds
        worlds = map(load_world, self.worlds)
        return tuple(
            (varied(world, _several(self.vary, Variation), seed), seed) for world in worlds for seed in seeds
        )

    @property
    def count(self) -> int:
        """How many runs there are in each world."""
        return self.seeds if isinstance(self.seeds, int) else len(self.seeds)

    def first_seeds(self, count: int) -> tuple[int, ...]:
        """Return so many of the seeds, and further ones if there are fewer."""
        own = tuple(range(self.seeds)) if isinstance(self.seeds, int) else tuple(self.seeds)
        return (*own, *range(max(own) + 1, max(own) + 1 + count))[:count]

    def whole(self) -> Challenge:
        """Return the challenge as a teacher marks it: the hidden worlds are among the others, with hints.

        Raises
        ------
        LRPError
            A hidden world cannot be read.
        """
        try:
            hidden = tuple(map(_world, self.hidden))
        except LRPError as error:
            raise LRPError(
                f"A hidden world of `{self.name}` is missing. {ended(str(error))} Grade on the computer"
                " that has it beside the file of the challenge."
            ) from error
        return replace(self, worlds=(*self.worlds, *hidden), hidden=(), exam=False)

    def check(self) -> None:
        """Ask every criterion about a run that has just begun, in every world.

        Raises
        ------
        LRPError
            A criterion names a zone or a solid that a world does not have, or it fails otherwise; or all are
            met before anything happens, where the run would end.
        """
        for world in dict.fromkeys(world for world, _ in self.runs):
            start, is_missing = at_start(world), False
            for criterion in self.criteria:
                try:
                    share, reason = criterion.judge(start)
                    is_missing |= float(share) < 1
                    str(reason)
                except Exception as error:
                    raise LRPError(
                        f"The challenge `{self.name}` cannot be judged by `{criterion.sentence}`: "
                        f"{sentence_of(error)}"
                    ) from error
            if not is_missing:
                raise LRPError(
                    f"The criteria of the challenge `{self.name}` are all met before the robot moves, so"
                    " every program would pass at once. Add `lasts(30)`, or something that has to be reached."
                )

    def __str__(self) -> str:
        return f"{self.name}: {self.assignment}"


def _time(seconds: float) -> str:
    """Say how long something takes: in minutes if they are whole ones."""
    count, unit = (seconds / 60, "minute") if seconds % 60 == 0 else (seconds, "second")
    return f"{count:g} {unit}{'' if count == 1 else 's'}"


def _several(values: Any, kind: type | tuple[type, ...]) -> tuple[Any, ...]:
    """Return some values, or one, as a tuple."""
    return (values,) if isinstance(values, kind) else tuple(values)


def _located(world: Any) -> str | Path | World:
    """Return a world that is a file as its path, any other as it is."""
    if isinstance(world, World) or (isinstance(world, str) and not world.endswith(".json")):
        return world
    path: Path = folder.get() / world
    return path


def _world(world: Any) -> str | World:
    """Return a world that is a file as a world, any other as it is."""
    path = _located(world)
    if isinstance(path, World):
        return path
    try:
        if isinstance(path, str):
            load_world(path)
            return path
        loaded = load_world(path)
    except WorldError as error:
        raise LRPError(str(error)) from error
    return loaded if loaded.name else replace(loaded, name=path.stem)

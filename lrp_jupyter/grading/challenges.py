"""Challenges: tasks for a robot, and how a program for them is graded.

The bundled challenges are defined here, from easy to hard, each with hints for its typical mistakes; a
teacher adds more with :func:`register`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from lrp_jupyter.errors import LRPError, did_you_mean
from lrp_jupyter.grading.criteria import (
    EDITED,
    Criterion,
    drives,
    edited,
    ends_in,
    ends_still,
    never_restarts,
    no_faults,
    on_line,
    pushes,
    sees_line,
    stays_in,
    touches,
    touches_nothing,
    turns,
    visits,
)
from lrp_jupyter.grading.record import RunRecord
from lrp_jupyter.sim.world import (
    ArcStroke,
    BoxSolid,
    BoxZone,
    CircleZone,
    FloorSpec,
    PathStroke,
    RobotSpec,
    World,
)

__all__ = ["BUNDLED", "Challenge", "Hint", "challenge", "challenges", "register"]

Hint = Callable[[RunRecord], str | None]
"""A function that inspects a failed run and returns a hint if it finds its mistake, else None."""


@dataclass(frozen=True)
class Challenge:
    """A task to be programmed, with its worlds and criteria.

    Parameters
    ----------
    name : str
    task : str
        What the robot has to do, in a sentence or two.
    worlds : tuple of str or World
        The program has to pass in every one.
    criteria : tuple of Criterion
        In the order in which they can be met: partial credit is given up to the first one that is not.
    seconds : float
        Longest duration of a run, in its own time. It ends earlier when every criterion is met, or one is
        broken.
    hints : tuple of Hint
        For typical mistakes, the most specific first.
    rate : float
        Ticks per second.
    noise : dict or None
        Imperfections of the robot: ``{"motor": 0.1, "light": 10}``.
    seeds : int
        Number of runs in each world, each with other noise.
    points : float
        For a program that passes.
    starter : str
        The text to begin with; by default a program whose robot stands still.
    """

    name: str
    task: str
    worlds: tuple[str | World, ...]
    criteria: tuple[Criterion, ...]
    seconds: float = 60
    hints: tuple[Hint, ...] = ()
    rate: float = 10
    noise: dict[str, float] | None = None
    seeds: int = 1
    points: float = 10
    starter: str = ""

    @property
    def beginning(self) -> str:
        """The text to begin with."""
        return self.starter or _BEGINNING.format(task=self.task)

    @property
    def is_about_edits(self) -> bool:
        """Whether a program has to be edited while it runs."""
        return any(criterion.sentence == EDITED for criterion in self.criteria)

    @property
    def runs(self) -> tuple[tuple[str | World, int], ...]:
        """The world and the seed of each run."""
        return tuple((world, seed) for world in self.worlds for seed in range(self.seeds))

    def __str__(self) -> str:
        return f"{self.name}: {self.task}"


_BEGINNING = """\
; {task}
(machine solution
  (state start)
)
(spawn solution start)
"""

_challenges: dict[str, Challenge] = {}


def register(new: Challenge) -> Challenge:
    """Register a challenge under its name, replacing one of the same name."""
    _challenges[new.name] = new
    return new


def challenges() -> tuple[Challenge, ...]:
    """Return the challenges, from easy to hard."""
    return tuple(_challenges.values())


def challenge(name: str) -> Challenge:
    """Return the challenge of a name, in any case, with spaces, hyphens or underscores.

    Raises
    ------
    LRPError
        There is no challenge of that name; the message suggests the closest one.
    """
    known = {each.name: each for each in challenges()}
    wanted = name.replace("-", " ").replace("_", " ").casefold().strip()
    if wanted in known:
        return known[wanted]
    hint = did_you_mean(wanted, known)
    raise LRPError(f"There is no challenge `{name}`.{hint} Choose one of: {', '.join(known)}.")


_QUARTER = math.pi / 2


def _line_across() -> World:
    """Return a world with a line across the robot's path."""
    return World(
        name="line across",
        size=(3, 2),
        floor=FloorSpec(strokes=(PathStroke(((2, 0.4), (2, 1.6))),)),
        robots=(RobotSpec((0.5, 1, 0)),),
        zones={"at the line": BoxZone((1.95, 1, 0.2, 1.2)), "beyond": BoxZone((2.5, 1, 0.8, 2))},
    )


def _square() -> World:
    """Return a world with zones at the corners of a square to the left of the robot."""
    corners = {
        "home": (1.0, 0.6),
        "first corner": (1.6, 0.6),
        "second corner": (1.6, 1.2),
        "third corner": (1.0, 1.2),
    }
    zones = {name: CircleZone((x, y, 0.22)) for name, (x, y) in corners.items()}
    return World(name="square", size=(2.6, 1.8), robots=(RobotSpec((1.0, 0.6, 0)),), zones=zones)


def _wall_ahead() -> World:
    """Return a world with a wall ahead of the robot."""
    wall = BoxSolid((2.2, 1, 0.08, 1.2), name="wall")
    return World(name="wall ahead", size=(3, 2), solids=(wall,), robots=(RobotSpec((0.5, 1, 0)),))


def _oval(radius: float) -> World:
    """Return a world with an oval line whose half circles have a radius, in metres."""
    left, right, middle = radius + 0.4, radius + 1.4, radius + 0.4
    strokes = (
        PathStroke(((left, middle - radius), (right, middle - radius))),
        ArcStroke((right, middle, radius, -_QUARTER, _QUARTER)),
        PathStroke(((right, middle + radius), (left, middle + radius))),
        ArcStroke((left, middle, radius, _QUARTER, 3 * _QUARTER)),
    )
    return World(
        name=f"oval of radius {radius:g} m",
        size=(right + radius + 0.4, 2 * middle),
        floor=FloorSpec(strokes=strokes),
        robots=(RobotSpec((left + 0.3, middle - radius, 0)),),
        zones={
            "right": CircleZone((right + radius, middle, 0.25)),
            "left": CircleZone((left - radius, middle, 0.25)),
            "start": CircleZone((left + 0.3, middle - radius, 0.25)),
        },
    )


def _block() -> World:
    """Return a world with a block, and the robot beside it with a distance sensor to its left."""
    around = {"south": (1.5, 0.45), "east": (2.55, 1), "north": (1.5, 1.55), "west": (0.45, 1)}
    return World(
        name="block",
        size=(3, 2),
        solids=(BoxSolid((1.5, 1, 1.2, 0.4), name="wall"),),
        robots=(RobotSpec((1.0, 0.5, 0), distance=((0.0, 2.0), (_QUARTER, 2.0))),),
        zones={name: CircleZone((x, y, 0.4)) for name, (x, y) in around.items()},
    )


def _drove_over(run: RunRecord) -> str | None:
    seen = next((sample for sample in run.samples if sees_line(sample)), None)
    if seen is None or next(run.inside("beyond"), None) is None:
        return None
    return (
        f"The robot crossed the line after {seen.time:.1f} s and drove on. Add"
        " `(on online driving -> stopped)`, with `(event online [robot.light.data < 128])` and a state"
        " `stopped` that does nothing."
    )


def _never_turned(run: RunRecord) -> str | None:
    if sum(run.turned) > 20:
        return None
    return "The robot only drove straight on. `robot.move(angular=1)` for pi / 2 s is a quarter turn."


def _never_saw_the_line(run: RunRecord) -> str | None:
    if any(map(sees_line, run.samples)):
        return None
    return "The light sensor never saw the line. White reads 255, black reads 0; the line is below 128."


def _lost_the_line(run: RunRecord) -> str | None:
    last = max((sample.time for sample in run.samples if sees_line(sample)), default=None)
    if last is None or run.seconds - last < 5:
        return None
    return (
        f"The robot lost the line after {last:.1f} s and did not find it again."
        " Look to the left, then to the right, and each time a bit further."
    )


def _ended_at_the_first_bump(run: RunRecord) -> str | None:
    walls = [name for name in ("far wall", "near wall") if next(run.touches(name), None)]
    if walls != ["far wall"] or run.seconds - run.still_since < 2:
        return None
    return (
        "The robot ended at the far wall. While the bumper is still pressed, a flag that is cleared in"
        " `bumpback` ends the program one tick later; clear it on entering the turn."
    )


def _did_not_turn_back(run: RunRecord) -> str | None:
    touched = sum("far wall" in sample.touched for sample in run.samples)
    if touched < 30:
        return None
    return "The robot keeps pushing against the far wall. Drive back for a second, then turn by pi."


def _kept_pushing(run: RunRecord) -> str | None:
    if sum("wall" in sample.touched for sample in run.samples) < 50:
        return None
    return (
        "The robot keeps pushing. At the event `[robot.bumper.data == 1]`, enter a state that does nothing."
    )


def _crossed_the_border(run: RunRecord) -> str | None:
    if next((sample for sample in run.samples if sees_line(sample)), None) is None:
        return None
    return "The robot turned on the border, which carries it across. Drive back first, then turn."


def _too_close(run: RunRecord) -> str | None:
    found = next((sample for sample in run.samples if "wall" in sample.touched), None)
    if found is None:
        return None
    return "The robot came too close to the wall. Steer away when it is nearer than the distance to keep."


def _restarted(run: RunRecord) -> str | None:
    if not run.restarts:
        return None
    return (
        f"The program restarted: {run.restart_reason} Change a state only while it is not active; changes of"
        " variables, events and transitions never restart the program."
    )


_AROUND = visits("right", "left", "start")
_THERE_AND_BACK = (touches("far wall", "near wall"), ends_still(2), no_faults())
_BACK_HINTS: tuple[Hint, ...] = (_ended_at_the_first_bump, _did_not_turn_back, _lost_the_line)

BUNDLED = tuple(
    register(each)
    for each in (
        Challenge(
            "first move",
            "Drive: at least 30 cm in five seconds, anywhere.",
            ("empty",),
            (drives(0.3), no_faults()),
            5,
        ),
        Challenge(
            "stop at the line",
            "Drive straight on and stop at the black line.",
            (_line_across(),),
            (ends_in("at the line"), ends_still(2), no_faults()),
            20,
            (_drove_over, _never_saw_the_line),
        ),
        Challenge(
            "square",
            "Drive a square with sides of 60 cm, to the left, and stop where it began.",
            (_square(),),
            (
                visits("first corner", "second corner", "third corner", "home"),
                ends_in("home"),
                turns(250),
                no_faults(),
            ),
            40,
            (_never_turned,),
        ),
        Challenge(
            "bump and stay",
            "Drive until something is in the way, then stand still.",
            (_wall_ahead(),),
            (touches("wall"), ends_still(3), no_faults()),
            25,
            (_kept_pushing,),
        ),
        Challenge(
            "follow the line",
            "Follow the closed line once around, however narrow its curves are.",
            tuple(_oval(radius) for radius in (0.35, 0.5, 0.8)),
            (_AROUND, on_line(0.35), no_faults()),
            150,
            (_never_saw_the_line, _lost_the_line),
            noise={"motor": 0.02, "light": 5},
        ),
        Challenge(
            "find the line",
            "The line is somewhere ahead, a bit to the side: find it, and stop on it.",
            (_line_across(),),
            (on_line(0.02), ends_in("at the line"), no_faults()),
            40,
            (_drove_over, _never_saw_the_line),
            noise={"motor": 0.05},
        ),
        Challenge(
            "there and back",
            "Follow the line until you bump into the far wall, come back, and end at the near wall.",
            ("line",),
            _THERE_AND_BACK,
            300,
            _BACK_HINTS,
            noise={"motor": 0.02, "light": 5},
        ),
        Challenge(
            "debug the printed listing",
            "The program printed in the paper does not come back. Find out why, while it runs.",
            ("line",),
            _THERE_AND_BACK,
            300,
            _BACK_HINTS,
        ),
        Challenge(
            "edge guard",
            "Drive about for a minute and never leave the field with the black border.",
            ("arena",),
            (stays_in("inside"), drives(2), no_faults()),
            60,
            (_crossed_the_border,),
            noise={"motor": 0.02},
        ),
        Challenge(
            "wall follower",
            "Go once around the block on your left, without touching it.",
            (_block(),),
            (visits("east", "north", "west", "south"), touches_nothing(), no_faults()),
            120,
            (_too_close,),
        ),
        Challenge(
            "push the box",
            "Push the box in front of you into the goal.",
            ("boxes",),
            (pushes("box", "goal"), no_faults()),
            60,
        ),
        Challenge(
            "maze",
            "Find the way to the goal, in the corner across.",
            ("maze",),
            (visits("goal"), no_faults()),
            600,
        ),
        Challenge(
            "edit it live",
            "Change the running program, at least once: it drives on and never restarts.",
            ("oval",),
            (drives(0.5), edited(), never_restarts(), no_faults()),
            30,
            (_restarted,),
        ),
    )
)

"""Challenges about pushing things."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import pushes
from lrp_jupyter.grading.record import RunRecord
from lrp_jupyter.sim.world import BoxSolid, CircleZone, FloorSpec, PathStroke, RobotSpec, World

_START = 0.5  # m
_LINE = 0.12  # m before the middle of the goal: what the light sensor is behind the middle of a pushed box


def _box_after(metres: float, goal: float) -> World:
    """Return a world with a box ahead of the robot, so far away, and behind it a goal that a line marks."""
    line = goal - _LINE
    return World(
        name=f"goal at {goal:g} m",
        size=(3.4, 2),
        floor=FloorSpec(strokes=(PathStroke(((line, 0.6), (line, 1.4))),)),
        solids=(BoxSolid((_START + 0.08 + metres + 0.1, 1, 0.2, 0.2), push=0.3, name="box"),),
        robots=(RobotSpec((_START, 1, 0)),),
        zones={"goal": CircleZone((goal, 1, 0.25))},
    )


def _never_touched_it(run: RunRecord) -> str | None:
    if next(run.touches("box"), None) is not None:
        return None
    return f"The robot never touched the box; it drove {run.driven:.2f} m. The box is straight ahead."


def _place(run: RunRecord) -> tuple[float, float, float]:
    """Return where the box is, and how far before the goal (negative: in it, or behind it), in metres."""
    x, y, _ = run.samples[-1].solids[0]
    goal = run.world.zones["goal"]
    assert isinstance(goal, CircleZone)
    middle, _, radius = goal.circle
    return x, y, middle - radius - x


def _pushed_too_far(run: RunRecord) -> str | None:
    x, y, way = _place(run)
    if way > 0 or run.world.zones["goal"].contains(x, 1) or abs(y - 1) > 0.25:
        return None
    return (
        f"The box was pushed through the goal, to x = {x:.2f} m. Stop at the black line:"
        " `[robot.light.data < 128]`."
    )


def _pushed_too_little(run: RunRecord) -> str | None:
    x, y, way = _place(run)
    if next(run.touches("box"), None) is None or way <= 0 or abs(y - 1) > 0.25:
        return None
    if run.still_since > run.seconds - 1:
        return (
            f"When the time was over, the robot still pushed, and the box was at x = {x:.2f} m. Drive faster."
        )
    return (
        f"The robot stopped after {run.still_since:.1f} s, and the box is at x = {x:.2f} m, {way:.2f} m"
        " before the goal, which is elsewhere in each world: only the black line says when the box is in it."
    )


def _lost_it(run: RunRecord) -> str | None:
    last: float | None = None
    last = run.fold(lambda so_far, now, _: now.time if "box" in now.touched else so_far, last, "at the box")
    if last is None or last > run.seconds - 2 or run.still_since < last + 1:
        return None
    x, y, _ = _place(run)
    return (
        f"The robot lost the box after {last:.1f} s and drove on; the box is at x = {x:.2f} m, y = {y:.2f} m."
        " Drive straight on while you push, and slowly."
    )


PUSH_THE_BOX = Challenge(
    "push the box",
    "Push the box in front of you into the goal, and leave it there for two seconds. When the robot is on the"
    " black line, the box is in the goal.",
    (_box_after(0.3, 1.8), _box_after(0.6, 2.4), _box_after(0.9, 2.1)),
    (pushes("box", "goal", 2),),
    40,
    (_never_touched_it, _lost_it, _pushed_too_far, _pushed_too_little),
    noise={"motor": 0.02},
    starter=starter("push the box"),
)

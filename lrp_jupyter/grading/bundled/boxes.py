"""Challenges about pushing things."""

from __future__ import annotations

from collections.abc import Iterator

from lrp_jupyter.grading.bundled.common_hints import drove_over_the_line, stopped_too_early
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import pushes, stops_once
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves, shades
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


def _hints(run: RunRecord) -> Iterator[str]:
    yield from stopped_too_early(run, "when the box is in the goal")
    if "robot.light" in run.programs[-1].text:
        yield from drove_over_the_line(run)
    x, y, _ = run.samples[-1].solids[0]
    goal = run.world.zones["goal"]
    assert isinstance(goal, CircleZone)
    middle, _, radius = goal.circle
    way = middle - radius - x  # m before the goal; negative: in it, or behind it
    at_box = run.last(lambda sample: "box" in sample.touched)
    if at_box is None:
        yield f"The robot never touched the box; it drove {run.driven:.2f} m. The box is straight ahead."
    elif at_box.time <= run.seconds - 2 and run.still_since >= at_box.time + 1:
        yield (
            f"The robot lost the box after {at_box.time:.1f} s and drove on; the box is at x = {x:.2f} m, y ="
            f" {y:.2f} m. Drive straight on and slowly while you push."
        )
    if abs(y - 1) > 0.25:
        return
    if way <= 0 and not goal.contains(x, 1):
        yield (
            f"The box was pushed through the goal, to x = {x:.2f} m. Stop at the black line:"
            " `[robot.light.data < 128]`."
        )
    if way > 0 and at_box and run.stood < 1:
        yield (
            f"When the time was up, the robot was still pushing, and the box was at x = {x:.2f} m. Drive"
            " faster."
        )
    elif way > 0 and at_box:
        yield (
            f"The robot stopped after {run.still_since:.1f} s, and the box is at x = {x:.2f} m, {way:.2f} m"
            " short of the goal, which is in a different place in each world: only the black line says when"
            " the box is in it."
        )


PUSH_THE_BOX = Challenge(
    "push the box",
    "Push the box in front of you into the goal, and leave it there for two seconds. When the robot is on the"
    " black line, the box is in the goal.",
    (_box_after(0.3, 1.8), _box_after(0.6, 2.4), _box_after(0.9, 2.45)),
    (pushes("box", "goal", 2), stops_once()),
    90,
    (_hints,),
    noise={"motor": 0.02},
    seeds=2,
    vary=(moves("box", x=0.1, y=0.01), moves("goal", "floor", x=0.45), shades(30)),
    starter=starter("push the box"),
)

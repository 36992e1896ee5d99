"""Challenges about a line on the floor."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lrp_jupyter.grading.bundled.common_hints import (
    drove_over_the_line,
    ignores,
    lost_the_line,
    never_saw_the_line,
    stopped_too_early,
)
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import (
    ends_in,
    ends_near_line,
    ends_still,
    finds_line,
    near_line,
    sees_line,
    stops_once,
    visits,
)
from lrp_jupyter.grading.criteria.order import longest
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves, shades
from lrp_jupyter.sim.floor import distance_to
from lrp_jupyter.sim.world import (
    ArcStroke,
    BoxZone,
    CircleZone,
    FloorSpec,
    PathStroke,
    Point,
    RobotSpec,
    World,
)

_QUARTER = math.pi / 2


def _line_after(metres: float) -> World:
    """Return a world with a line across the robot's way, so far from its light sensor."""
    line = 0.5 + RobotSpec((0, 0, 0)).light[0][0] + metres
    return World(
        name=f"line after {metres:g} m",
        size=(3, 2),
        floor=FloorSpec(strokes=(PathStroke(((line, 0.4), (line, 1.6))),)),
        robots=(RobotSpec((0.5, 1, 0)),),
        zones={"at the line": BoxZone((line, 1, 0.25, 1.2))},
    )


def _thin_and_wide(name: str, thin: tuple[float, ...], wide: float) -> World:
    """Return a world with lines across the robot's way, of which only one is wide; x in metres."""
    strokes = tuple(_across(x, PathStroke(()).width) for x in thin)
    sensor = RobotSpec((0, 0, 0)).light[0][0]
    return World(
        name=name,
        size=(3.6, 2),
        floor=FloorSpec(strokes=(*strokes, _across(wide, _WIDE))),
        robots=(RobotSpec((0.4, 1, 0)),),
        zones={"wide line": BoxZone((wide - sensor, 1, _WIDE + 0.06, 1))},
    )


def _across(x: float, width: float) -> PathStroke:
    return PathStroke(((x, 0.6), (x, 1.4)), width)


def _line_beside(name: str, *ends: Point) -> World:
    """Return a world with a line that is not ahead of the robot."""
    return World(
        name=f"line {name}",
        size=(2.4, 2),
        floor=FloorSpec(strokes=(PathStroke(ends),)),
        robots=(RobotSpec((0.9, 1, 0)),),
    )


def _oval(radius: float) -> World:
    """Return a world with an oval line whose half circles have a radius, in metres."""
    left, right, middle = radius + 0.4, radius + 1.0, radius + 0.4
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
        robots=(RobotSpec((left + 0.2, middle - radius, 0)),),
        zones={
            "right": CircleZone((right + radius, middle, 0.2)),
            "left": CircleZone((left - radius, middle, 0.2)),
            "start": CircleZone((left + 0.2, middle - radius, 0.2)),
        },
    )


def _drove_over(run: RunRecord) -> Iterator[str]:
    seen = run.first(sees_line)
    if seen and distance_to(run.world.floor, *run.samples[-1][1:3]) >= 0.15:
        yield (
            f"The robot crossed the line after {seen.time:.1f} s and drove on. Let a transition with the"
            " condition `[robot.light.data < 128]` lead to a state that does nothing."
        )


def _did_anything(run: RunRecord) -> bool:
    return any(any(each.command) or each.active != run.samples[0].active for each in run.samples)


def _stopped_before(run: RunRecord) -> Iterator[str]:
    if run.first(sees_line) or run.stood < 2 or not _did_anything(run):
        return
    if run.still_since < 0.5:
        yield "The robot stopped at once. The line is black, and there the light sensor reads less than 128."
    else:
        yield (
            f"The robot stopped after {run.still_since:.1f} s, when its light sensor had not seen the line"
            " yet. How far away the line is differs from world to world: let the sensor decide, not the time."
        )


def _did_not_stop(run: RunRecord) -> Iterator[str]:
    yield from stopped_too_early(run, "when its light sensor sees the line")
    yield from _drove_over(run)
    yield from _stopped_before(run)
    yield from drove_over_the_line(run)
    yield from never_saw_the_line(run)


def _stopped_at_another(run: RunRecord) -> Iterator[str]:
    wide, last = run.world.zones["wide line"], run.samples[-1]
    yield from stopped_too_early(run, "on the wide line")
    black = run.last(lambda sample: sees_line(sample) and sample.time <= run.still_since + 1e-6)
    if run.stood < 2:
        seconds = longest(run, lambda now, before: sees_line(now) and sees_line(before), "sees black")
        if seconds:
            yield (
                f"The robot drove over the wide line. Its light sensor saw black for {seconds:.1f} s there:"
                " the condition must not have to hold longer than that."
            )
    elif black and not wide.contains(last.x, last.y):
        if run.still_since - black.time < 0.3:
            yield (
                f"The robot stopped after {run.still_since:.1f} s, on a thin line. Its light sensor sees a"
                " thin line for a moment, and the wide one for longer. With `for 500`, a transition fires"
                " when its condition has held for half a second."
            )
        else:
            yield (
                f"The robot stopped after {run.still_since:.1f} s, where there is no line. Each world has"
                " different lines, in different places: let the light sensor decide."
            )
    yield from _stopped_before(run)
    yield from never_saw_the_line(run)


def _did_not_find_it(run: RunRecord) -> Iterator[str]:
    yield from stopped_too_early(run, "when its light sensor sees the line")
    yield from _drove_over(run)
    turned, seen = run.turned.total, run.first(sees_line)
    if not seen and turned <= 60 and run.driven > 0.1:
        yield (
            f"The robot drove {run.driven:.2f} m and turned only {turned:.0f}°, and the line is not ahead of"
            " it. Drive in a curve that gets wider and wider, or turn and drive on when the bumper meets the"
            " edge."
        )
    if not seen and turned >= 540:
        yield (
            f"The robot turned {turned:.0f}° and came to the same places again and again. Let the curve get"
            " wider: make `angular` smaller in `running`, a little each time."
        )
    yield from _stopped_before(run)
    yield from never_saw_the_line(run)


def _did_not_follow(run: RunRecord) -> Iterator[str]:
    yield from ignores(
        run, "light", "How tight the curves are differs from world to world: let the sensor steer."
    )
    last = run.last(sees_line)
    if last and _NEAR.missing(run):
        yield (
            f"The light sensor last saw the line after {last.time:.1f} s, and after {run.seconds:.1f} s the"
            " robot was too far from it. When it sees white, let the robot stop, look to the left, then to"
            " the right, and each time a bit further."
        )
    yield from lost_the_line(run)
    yield from never_saw_the_line(run)


_NEAR = near_line(0.12)
_WIDE = 0.2  # m

STOP_AT_THE_LINE = Challenge(
    "stop at the line",
    "Drive straight on and stop at the black line, however far away it is.",
    tuple(map(_line_after, (0.5, 0.9, 1.5))),
    (finds_line(), ends_in("at the line"), ends_still(2), stops_once()),
    60,
    (_did_not_stop,),
    noise={"motor": 0.02},
    seeds=8,  # so many that a line is missed at every speed at which one can be
    vary=(moves("floor", "at the line", x=0.08), moves("robot", y=0.1, degrees=5), shades(30)),
    starter=starter("stop at the line"),
)

STOP_AT_THE_WIDE_LINE = Challenge(
    "stop at the wide line",
    "Drive over the thin lines, and stop on the wide one.",
    (  # the first two lines are equally far apart, so that they do not tell where the wide one is
        _thin_and_wide("three thin lines", (0.8, 1.1, 1.4), 2.0),
        _thin_and_wide("five thin lines", (0.7, 1.0, 1.07, 1.5, 1.9), 2.6),
        _thin_and_wide("a thin line before and after", (0.9, 2.0), 1.2),
    ),
    (visits("wide line"), ends_in("wide line"), ends_still(2), stops_once()),
    90,
    (_stopped_at_another,),
    noise={"motor": 0.02},
    seeds=2,
    vary=(moves("floor", "wide line", x=0.08), moves("robot", y=0.1, degrees=5), shades(30)),
    starter=starter("stop at the wide line"),
)

FIND_THE_LINE = Challenge(
    "find the line",
    "There is a line somewhere around the robot, but never ahead of it: find it, and stop on it.",
    (
        _line_beside("to the left", (0.3, 1.45), (2.1, 1.45)),
        _line_beside("to the right", (0.3, 0.6), (2.1, 0.6)),
        _line_beside("behind", (0.4, 0.3), (0.4, 1.7)),
    ),
    (finds_line(), ends_near_line(0.12), ends_still(2), stops_once()),
    120,
    (_did_not_find_it,),
    noise={"motor": 0.02},
    seeds=2,
    vary=(moves("floor", x=0.05, y=0.05), moves("robot", x=0.05, y=0.05, degrees=8), shades(30)),
    starter=starter("find the line"),
)

FOLLOW_THE_LINE = Challenge(
    "follow the line",
    "Follow the closed line once around, never further than 12 cm from it, however tight its curves are.",
    tuple(map(_oval, (0.3, 0.45, 0.7))),
    (visits("right", "left", "start"), _NEAR),
    150,
    (_did_not_follow,),
    noise={"motor": 0.02, "light": 5},
    vary=(moves("robot", x=0.1, y=0.01, degrees=5), shades(30)),
    starter=starter("follow the line"),
)

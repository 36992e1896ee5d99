"""Challenges about bumping into walls."""

from __future__ import annotations

from collections.abc import Iterator

from lrp_jupyter.grading.bundled.common_hints import kept_pushing, never_touched
from lrp_jupyter.grading.bundled.rooms import ROOMS
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import (
    backs_off,
    backs_off_at_bumps,
    bumps,
    bumps_in,
    ends_still,
    keeps_driving,
    lit_while,
    never_pushes,
    stops_at,
    touches,
    turns,
    turns_at_bumps,
)
from lrp_jupyter.grading.criteria.contact import longest_push
from lrp_jupyter.grading.criteria.motion import backed
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import BoxSolid, RobotSpec, World


def _wall_ahead(metres: float) -> World:
    """Return a world with a wall ahead of the robot."""
    wall = BoxSolid((0.58 + metres + 0.04, 1, 0.08, 1.2), name="wall")
    return World(
        name=f"wall after {metres:g} m", size=(3, 2), solids=(wall,), robots=(RobotSpec((0.5, 1, 0)),)
    )


def _drives_backward(sample: Sample) -> bool:
    return sample.command[0] < 0


def _did_not_stay(run: RunRecord) -> Iterator[str]:
    if run.first(_drives_backward):
        yield "The robot drove backward. It has to stay at the wall: enter a state that does nothing."
    touched = run.touch("wall")
    if touched and run.still_since - touched.time >= 1:
        yield (
            f"The robot reached the wall after {touched.time:.1f} s and kept pushing. At the event"
            " `[robot.bumper.data == 1]`, enter a state that does nothing."
        )
    yield from never_touched(run)


def _did_not_turn(run: RunRecord) -> Iterator[str]:
    yield from kept_pushing(run)
    times = run.fold(backed, 0)
    if run.touch() and not times:
        yield (
            "The robot bumped but never drove backward. `robot.move(linear=-0.2)` for a second makes room to"
            " turn."
        )
    if times == 1 and run.stood >= 3:
        yield (
            f"The robot backed off once, stopped after {run.still_since:.1f} s and stayed there. A transition"
            " has to lead back to the state that drives, such as `(ontime 1500 turning -> driving)`."
        )
    walls = {wall for sample in run.samples for wall in sample.touched}
    if len(walls) == 2 and times >= 3:
        yield (
            f"The robot only goes back and forth between the {' and the '.join(sorted(walls))}."
            " Turn by a different angle: half a turn leads back to where it came from."
        )
    yield from never_touched(run)


def _backed_off_without_a_bump(run: RunRecord) -> Iterator[str]:
    reason = _ANSWERS.missing(run)
    if reason and reason.endswith("had not bumped"):
        yield (
            f"The robot drives backward without a bump: {reason}. Let the event `[robot.bumper.data == 1]`"
            " lead to the state that backs off, and nothing else."
        )


def _drove_on_without_a_turn(run: RunRecord) -> Iterator[str]:
    reason = _TURNS.missing(run)
    if reason:
        yield (
            f"The robot does not turn before it drives on: {reason}. Between the state that backs off and the"
            " one that drives, there has to be one that turns: `robot.move(angular=1)`."
        )


def _lit_wrongly(run: RunRecord) -> Iterator[str]:
    lit, backs = run.first(lambda sample: sample.lamp), run.first(_drives_backward)
    if lit is None:
        if backs:
            yield "The lamp was never lit. `robot.lamp(True)` in the `onentry` of a state lights it."
    elif not all(sample.lamp for sample in run.samples if sample.time >= lit.time):
        return
    elif backs and not _drives_backward(run.samples[-1]):
        yield (
            f"The lamp was switched on after {lit.time:.1f} s and stayed on. The `onexit` of the same state"
            " can switch it off: `robot.lamp(False)`."
        )
    else:
        yield (
            "The lamp was lit before the robot drove backward. Light it in the `onentry` of the state that"
            " backs off."
        )


def _stayed_in_a_state(run: RunRecord) -> Iterator[str]:
    push = longest_push(run)
    if push.seconds > 1:
        later = run.first(lambda sample: sample.time > push.since + 0.5 and sample.active)
        state = later.active[0][-1] if later else ""
        yield (
            f"The robot pushed against the {push.solid} in `{state}`: no transition leads out of it when"
            " the robot bumps. `*` as the source of a transition stands for every state."
        )
    missing = next((state for state in _WANDERING if run.entered(state) is None), None)
    if missing:
        yield (
            f"`{missing}` was never active. Keep the states of the program, and add transitions that lead out"
            " of them."
        )
    yield from kept_pushing(run)
    yield from never_touched(run)


_ANYWHERE = moves("robot", x=0.2, y=0.2, degrees=180)
_ANSWERS = backs_off_at_bumps(1)
_TURNS = turns_at_bumps(20)

BUMP_AND_STAY = Challenge(
    "bump and stay",
    "Drive until the robot bumps into the wall. Stop there within a second, and stay.",
    tuple(map(_wall_ahead, (0.5, 0.9, 1.4))),
    (touches("wall"), keeps_driving(1, until="wall"), stops_at("wall", 1), ends_still(2)),
    60,
    (_did_not_stay,),
    noise={"motor": 0.02},
    seeds=3,
    vary=(moves("robot", x=0.1, y=0.2, degrees=8),),
    starter=starter("bump and stay"),
)

BUMP_AND_TURN = Challenge(
    "bump and turn",
    "Drive about in the room: at each bump back off, turn, and drive on. Bump into three different walls, and"
    " never push against one for longer than a second.",
    ROOMS,
    (_ANSWERS, _TURNS, backs_off(2), bumps(3, walls=3), never_pushes(1)),
    120,
    (_backed_off_without_a_bump, _drove_on_without_a_turn, _did_not_turn),
    noise={"motor": 0.02},
    seeds=3,
    vary=(_ANYWHERE,),
    starter=starter("bump and turn"),
)

LAMP = Challenge(
    "lamp",
    "The robot bumps, backs off and turns. Its lamp has to be lit while it drives backward, and only then."
    " Let it back off three times.",
    ROOMS,
    (lit_while("drives backward", _drives_backward), _ANSWERS, backs_off(3), turns(90)),
    120,
    (_backed_off_without_a_bump, _lit_wrongly),
    noise={"motor": 0.02},
    seeds=3,
    vary=(_ANYWHERE,),
    starter=starter("lamp"),
)

_WANDERING = ("straight", "left", "right")

BUMP_OUT = Challenge(
    "bump out of everything",
    "The robot wanders about in three states. Whichever of `straight`, `left` and `right` is active at a"
    " bump, let the robot back off and wander on: it never pushes for longer than a second.",
    ROOMS,
    (bumps_in(*_WANDERING), _ANSWERS, backs_off(5), never_pushes(1)),
    480,
    (_backed_off_without_a_bump, _stayed_in_a_state),
    noise={"motor": 0.02},
    seeds=3,
    vary=(_ANYWHERE,),
    starter=starter("bump out of everything"),
)

"""Challenges about bumping into walls."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.hints import kept_pushing, longest_push, never_touched
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import (
    backs_off,
    bumps,
    bumps_in,
    ends_still,
    lit_while,
    never_pushes,
    stops_at,
    touches,
)
from lrp_jupyter.grading.record import RunRecord, Sample
from lrp_jupyter.sim.world import BoxSolid, Pose, RobotSpec, World


def _wall_ahead(metres: float) -> World:
    """Return a world with a wall ahead of the robot."""
    wall = BoxSolid((0.58 + metres + 0.04, 1, 0.08, 1.2), name="wall")
    return World(
        name=f"wall after {metres:g} m", size=(3, 2), solids=(wall,), robots=(RobotSpec((0.5, 1, 0)),)
    )


def _room(name: str, width: float, height: float, pose: Pose) -> World:
    """Return a room between four walls that have names."""
    thick = 0.06
    walls = {
        "west wall": (thick / 2, height / 2, thick, height),
        "east wall": (width - thick / 2, height / 2, thick, height),
        "south wall": (width / 2, thick / 2, width, thick),
        "north wall": (width / 2, height - thick / 2, width, thick),
    }
    solids = tuple(BoxSolid(box, name=wall) for wall, box in walls.items())
    return World(name=name, size=(width, height), solids=solids, robots=(RobotSpec(pose),))


_ROOMS = (
    _room("room", 1.8, 1.4, (0.6, 0.7, 0)),
    _room("wide room", 2.4, 1.4, (1.2, 0.6, 0.5)),
    _room("narrow room", 1.2, 1.6, (0.5, 0.8, 2)),
)


def _drives_backward(sample: Sample) -> bool:
    return sample.command[0] < 0


def _went_on_pushing(run: RunRecord) -> str | None:
    touched = next(run.touches("wall"), None)
    if touched is None or run.still_since - touched.time < 1:
        return None
    return (
        f"The robot met the wall after {touched.time:.1f} s and kept pushing. At the event"
        " `[robot.bumper.data == 1]`, enter a state that does nothing."
    )


def _left_the_wall(run: RunRecord) -> str | None:
    if run.first(_drives_backward, "drives backward") is None:
        return None
    return "The robot drove backward. It has to stay at the wall: enter a state that does nothing."


def _to_and_fro(run: RunRecord) -> str | None:
    walls = {wall for sample in run.samples for wall in sample.touched}
    if len(walls) != 2 or run.fold(_backs, 0) < 3:
        return None
    return (
        f"The robot only goes to and fro between the {' and the '.join(sorted(walls))}."
        " Turn by another angle: half a turn leads back to where it came from."
    )


def _backs(count: int, now: Sample, before: Sample) -> int:
    return count + (_drives_backward(now) and not _drives_backward(before))


def _did_not_back_off(run: RunRecord) -> str | None:
    if not run.first(lambda sample: sample.touched, "touches anything") or run.fold(_backs, 0):
        return None
    return (
        "The robot bumped and never drove backward. `robot.move(linear=-0.2)` for a second makes room to"
        " turn."
    )


def _backed_off_once(run: RunRecord) -> str | None:
    if run.fold(_backs, 0) != 1 or run.still_since > run.seconds - 3:
        return None
    return (
        f"The robot backed off once and stands still since {run.still_since:.1f} s. A transition has to lead"
        " back to the state that drives, such as `(ontime 1500 turning -> driving)`."
    )


def _never_lit(run: RunRecord) -> str | None:
    if run.first(lambda sample: sample.lamp, "lit") or run.first(_drives_backward, "drives backward") is None:
        return None
    return "The lamp was never lit. `robot.lamp(True)` in the `onentry` of a state lights it."


def _never_dark_again(run: RunRecord) -> str | None:
    lit = run.first(lambda sample: sample.lamp, "lit")
    if lit is None or not all(sample.lamp for sample in run.samples if sample.time >= lit.time):
        return None
    if not _drives_backward(run.samples[-1]) and run.first(_drives_backward, "drives backward") is not None:
        return (
            f"The lamp was switched on after {lit.time:.1f} s and stayed on. The `onexit` of the same state"
            " can switch it off: `robot.lamp(False)`."
        )
    return (
        "The lamp was lit before the robot drove backward. Light it in the `onentry` of the state that backs"
        " off."
    )


def _pushed_in_a_state(run: RunRecord) -> str | None:
    longest, since, wall, _ = run.fold(longest_push, (0.0, 0.0, "", 0.0))
    if longest <= 1:
        return None
    state = next(
        (path[-1] for sample in run.samples if sample.time > since + 0.5 for path in sample.active), ""
    )
    return (
        f"The robot pushed against the {wall} in `{state}`: no transition leads out of it at a bump. `*` as"
        " the source of a transition stands for every state."
    )


def _lost_a_state(run: RunRecord) -> str | None:
    missing = [state for state in _WANDERING if run.entered(state) is None]
    if not missing:
        return None
    return f"`{missing[0]}` was never active. Keep the states of the program, and add what leads out of them."


BUMP_AND_STAY = Challenge(
    "bump and stay",
    "Drive until the robot bumps into the wall. Stop there within a second, and stay.",
    tuple(map(_wall_ahead, (0.5, 0.9, 1.4))),
    (touches("wall"), stops_at("wall", 1), ends_still(2)),
    20,
    (_left_the_wall, _went_on_pushing, never_touched),
    noise={"motor": 0.02},
    starter=starter("bump and stay"),
)

BUMP_AND_TURN = Challenge(
    "bump and turn",
    "Drive about in the room: at each bump back off, turn, and drive on. Bump into three different walls, and"
    " never push against one for longer than a second.",
    _ROOMS,
    (backs_off(2), bumps(3, walls=3), never_pushes(1)),
    60,
    (kept_pushing, _did_not_back_off, _backed_off_once, _to_and_fro, never_touched),
    noise={"motor": 0.02},
    starter=starter("bump and turn"),
)

LAMP = Challenge(
    "lamp",
    "The robot bumps, backs off and turns. Light its lamp while it drives backward, and only then; let it do"
    " so three times.",
    _ROOMS,
    (lit_while("drives backward", _drives_backward), backs_off(3)),
    40,
    (_never_lit, _never_dark_again),
    noise={"motor": 0.02},
    starter=starter("lamp"),
)

_WANDERING = ("straight", "left", "right")

BUMP_OUT = Challenge(
    "bump out of everything",
    "The robot wanders about in three states. Whichever of `straight`, `left` and `right` is active at a"
    " bump, let the robot back off and wander on: it never pushes for longer than a second.",
    _ROOMS,
    (bumps_in(*_WANDERING), backs_off(5), never_pushes(1)),
    240,
    (_pushed_in_a_state, _lost_a_state, kept_pushing, never_touched),
    noise={"motor": 0.02},
    starter=starter("bump out of everything"),
)

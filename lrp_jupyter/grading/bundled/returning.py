"""The scenario of the paper: along the line to the far wall, and back to the near one."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.hints import ignores, longest_push, lost_the_line, never_saw_the_line
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge, Hint
from lrp_jupyter.grading.criteria import ends_still, touches, within
from lrp_jupyter.grading.record import RunRecord, Sample
from lrp_jupyter.programs import load

_FOLLOWER = load("follower").split("\n\n", 1)[1].replace(")))\n\n(spawn", "))\n)\n\n(spawn")
_NOISE = {"motor": 0.02, "light": 5.0}
_LAP = 35.0  # s


def _walls(run: RunRecord) -> list[str]:
    """Return which walls were touched, each once."""
    return list(dict.fromkeys(wall for sample in run.samples for wall in sorted(sample.touched)))


def _ended_at_the_first_bump(run: RunRecord) -> str | None:
    touched = next(run.touches("far wall"), None)
    if touched is None or _walls(run) != ["far wall"]:
        return None
    if run.seconds - run.still_since < 2 or run.still_since - touched.time > 2:
        return None
    return (
        "The robot ended at the far wall. While the bumper is still pressed, a flag that is changed in"
        " `bumpback` ends the program one tick later; change it on entering the turn."
    )


def _kept_pushing(run: RunRecord) -> str | None:
    longest, since, wall, _ = run.fold(longest_push, (0.0, 0.0, "", 0.0))
    way_out = {
        "far wall": "A bump has to lead out of it: drive back for a second, then turn by pi.",
        "near wall": "A second bump has to end it: enter a state that stops the robot.",
    }.get(wall)
    if longest <= 3 or way_out is None:
        return None
    states = next(sample for sample in run.samples if sample.time > since).active
    where = f" in `{states[0][-1]}`" if states else ""
    return f"The robot keeps pushing against the {wall}{where}, from {since:.1f} s on. {way_out}"


def _came_to_the_same_wall(run: RunRecord) -> str | None:
    if _walls(run) != ["far wall"]:
        return None
    times = run.fold(_bumps, (0, -9.0))[0]
    if times < 2:
        return None
    return (
        f"The robot bumped into the far wall {times} times: after the bump it does not turn far enough. Half"
        " a turn takes pi seconds at 1 rad/s."
    )


def _bumps(so_far: tuple[int, float], now: Sample, _: Sample) -> tuple[int, float]:
    count, last = so_far
    if "far wall" not in now.touched:
        return so_far
    return count + (now.time - last > 2), now.time


def _went_on(run: RunRecord) -> str | None:
    share, reason = _TOUCHES.judge(run)
    if share < 1 or run.still_since < run.seconds - 2:
        return None
    return (
        f"The robot came back to the near wall ({reason}) and went on. The second bump has to lead to a state"
        " that stops it: is the flag for that ever set?"
    )


def _ran_out_of_time(run: RunRecord) -> str | None:
    if run.still_since < run.seconds - 2 or _TOUCHES.judge(run)[0] >= 1:
        return None
    touched = next(run.touches("far wall"), None)
    done = "it had not touched the far wall"
    if touched is not None:
        done = f"it had touched the far wall after {touched.time:.1f} s"
    return (
        f"After {run.seconds:.0f} s the robot was still on its way between the walls; {done}. Where does it"
        " lose time: driving, searching, or turning?"
    )


_HINTS: tuple[Hint, ...] = (
    ignores("light", "The line is not straight: let the sensor steer."),
    _ended_at_the_first_bump,
    _kept_pushing,
    _came_to_the_same_wall,
    never_saw_the_line,
    _went_on,
    lost_the_line,
    _ran_out_of_time,
)
_TOUCHES = touches("far wall", "near wall")
_THERE_AND_BACK = (_TOUCHES, ends_still(2))

THERE_AND_BACK = Challenge(
    "there and back",
    "Follow the line until you bump into the far wall, come back, and end at the near wall: in two minutes.",
    ("line",),
    _THERE_AND_BACK,
    120,
    _HINTS,
    noise=_NOISE,
    seeds=3,
    starter=starter("there and back"),
)

DEBUG_THE_LISTING = Challenge(
    "debug the printed listing",
    "This program is meant to follow the line to the far wall, to come back, and to end at the near wall. It"
    " was printed in a paper, and it does not. Find its mistakes, one after the other; it may take five"
    " minutes.",
    ("line",),
    _THERE_AND_BACK,
    300,
    _HINTS,
    noise=_NOISE,
    seeds=3,
    starter=starter("debug the printed listing"),
)

LAP = Challenge(
    "lap",
    f"There and back again, in a hurry: touch the far wall and then the near wall within {_LAP:g} s.",
    ("line",),
    (within(_LAP, _TOUCHES),),
    _LAP,
    _HINTS,
    noise=_NOISE,
    seeds=3,
    starter=_FOLLOWER,
)

ROBUST_FOLLOWER = Challenge(
    "robust follower",
    "There and back, with bad motors and a bad light sensor: in 90 % of 50 runs, the robot has to touch the"
    " far wall and then the near wall within a minute and a half.",
    ("line",),
    (_TOUCHES,),
    90,
    _HINTS,
    noise={"motor": 0.35, "light": 50.0},
    seeds=tuple(range(1000, 1050)),
    starter=starter("robust follower"),
    needed=0.9,
)

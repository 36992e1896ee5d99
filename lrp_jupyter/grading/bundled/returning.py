"""The scenario of the paper: along the line to the far wall, and back to the near one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from lrp_jupyter.grading.bundled.common_hints import ignores, lost_the_line, never_saw_the_line
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import ends_still, touches, within
from lrp_jupyter.grading.criteria.contact import longest_push
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.programs import load
from lrp_jupyter.sim.mirror import mirrored
from lrp_jupyter.sim.world import BoxSolid
from lrp_jupyter.sim.worlds import load as load_world

_LINE = load_world("line")
_AROUND = replace(  # a block on the way that is straight on, up to the edge of the world
    _LINE,
    name="line around a block",
    solids=(*_LINE.solids, BoxSolid((_LINE.size[0] / 2, 0.3, 0.14, 0.6), name="block")),
)
_LINES = (_AROUND, mirrored(_AROUND, "mirrored line", y=True))
_ELSEWHERE = moves("robot", x=0.05, y=0.01, degrees=12)
_FOLLOWER = load("follower").split("\n\n", 1)[1].replace(")))\n\n(spawn", "))\n)\n\n(spawn")
_NOISE = {"motor": 0.02, "light": 5.0}
_LAP = 32.0  # s


_WAYS_OUT = {
    "far wall": "A bump has to lead out of it: drive back for a second, then turn by pi.",
    "near wall": "A second bump has to end it: enter a state that stops the robot.",
}


def _hints(run: RunRecord) -> Iterator[str]:
    yield from ignores(run, "light", "The line is not straight: let the sensor steer.")
    touched, push = run.touch("far wall"), longest_push(run)
    is_one_wall = {wall for sample in run.samples for wall in sample.touched} == {"far wall"}
    if touched and is_one_wall and run.stood >= 2 and run.still_since - touched.time <= 2:
        yield (
            "The robot ended at the far wall. While the bumper is still pressed, a flag that is changed in"
            " `bumpback` ends the program one tick later; change it when the turn is entered."
        )
    if push.seconds > 3 and push.solid in _WAYS_OUT:
        states = next(sample for sample in run.samples if sample.time > push.since).active
        where = f" in `{states[0][-1]}`" if states else ""
        yield (
            f"The robot keeps pushing against the {push.solid}{where}, from {push.since:.1f} s on."
            f" {_WAYS_OUT[push.solid]}"
        )
    bumps = [sample.time for sample in run.touches("far wall")]
    times = sum(time - last > 2 for last, time in pairwise([-9.0, *bumps]))
    if is_one_wall and times > 1:
        yield (
            f"The robot bumped into the far wall {times} times: after the bump it does not turn far enough."
            " Half a turn takes pi seconds at 1 rad/s."
        )
    yield from never_saw_the_line(run)
    share, reason = _TOUCHES.judge(run)
    if share >= 1 and run.stood <= 2:
        yield (
            f"The robot came back to the near wall ({reason}) and went on. The second bump has to lead to a"
            " state that stops it: is the flag for that ever set?"
        )
    yield from lost_the_line(run)
    if share < 1 and run.stood <= 2:
        done = f"touched the far wall after {touched.time:.1f} s" if touched else "not touched the far wall"
        yield (
            f"After {run.seconds:.0f} s the robot was still on its way between the walls; it had {done}."
            " Where does it lose time: driving, searching, or turning?"
        )


_TOUCHES = touches("far wall", "near wall")
_THERE_AND_BACK = (_TOUCHES, ends_still(2))

THERE_AND_BACK = Challenge(
    "there and back",
    "Follow the line until you bump into the far wall, come back, and end at the near wall.",
    _LINES,
    _THERE_AND_BACK,
    180,
    (_hints,),
    noise=_NOISE,
    seeds=3,
    vary=_ELSEWHERE,
    starter=starter("there and back"),
)

DEBUG_THE_LISTING = Challenge(
    "debug the printed listing",
    "This program is meant to follow the line to the far wall, to come back, and to end at the near wall. It"
    " was printed in a paper, and it does not. Find its mistakes, one by one.",
    _LINES,
    _THERE_AND_BACK,
    300,
    (_hints,),
    noise=_NOISE,
    seeds=3,
    vary=_ELSEWHERE,
    starter=starter("debug the printed listing"),
)

LAP = Challenge(
    "lap",
    "There and back again, in a hurry: touch the far wall and then the near wall.",
    _LINES,
    (within(_LAP, _TOUCHES),),
    _LAP,
    (_hints,),
    noise=_NOISE,
    seeds=3,
    vary=_ELSEWHERE,
    starter=_FOLLOWER,
)

ROBUST_FOLLOWER = Challenge(
    "robust follower",
    "There and back, with bad motors and a bad light sensor: in 90% of 50 runs, the robot has to touch the"
    " far wall and then the near wall.",
    _LINES,
    (_TOUCHES,),
    120,
    (_hints,),
    noise={"motor": 0.2, "light": 70.0},
    seeds=tuple(range(1000, 1025)),
    vary=_ELSEWHERE,
    starter=starter("robust follower"),
    needed=0.9,
)

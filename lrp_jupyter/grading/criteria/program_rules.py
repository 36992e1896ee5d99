"""Criteria about the program itself: its states, its edits, its faults."""

from __future__ import annotations

from functools import partial

from lrp_jupyter.grading.criteria.criterion import Criterion, Found
from lrp_jupyter.grading.criteria.order import in_order, reason_of
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.language.checks.uses import uses_of
from lrp_jupyter.language.program import Path
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.running.frame import is_active

_SPAN = 2.0  # s, over which a speed is measured

_Recent = tuple[tuple[float, float, int], ...]  # time, way, and version of the program


def enters(*states: str) -> Criterion:
    """Require that states of the program, given by name or path, are entered, in this order."""

    def judge(run: RunRecord) -> Found:
        names = [f"`{state}`" for state in states]
        done = in_order(run, [partial(_is_in, state) for state in states], ("enters", states))
        if len(states) == 1:
            return Found(bool(done), f"entered after {done[0]:.1f} s" if done else "never entered")
        return Found(len(done) / len(states), reason_of(done, names, "came to"))

    some = "the states" if len(states) > 1 else "the state"
    sentence = f"enters {some} " + ", then ".join(f"`{state}`" for state in states)
    return Criterion(sentence, judge, "once", needs_motion=False)


def _is_in(state: str, now: Sample) -> bool:
    return is_active(state, now.active)


def reused(machine: str, states: int = 2) -> Criterion:
    """Require that a machine runs in so many states, and that the program has only one of that name."""

    def judge(run: RunRecord) -> Found:
        def step(so_far: frozenset[Path], now: Sample, _: Sample) -> frozenset[Path]:
            new = {
                path[:index]
                for path in now.active
                for index in range(2, len(path), 2)
                if path[index] == machine and path[:index] not in so_far
            }
            return so_far | new if new else so_far

        nothing: frozenset[Path] = frozenset()
        users = sorted(path[-1] for path in run.fold(step, nothing, ("states that run", machine)))
        programs = run.programs[-1:]
        written = sum(path[-1] == machine for program in programs for path, _ in program.walk())
        if programs and written != 1:
            many = f"{written} machines" if written else "no machine"
            return Found(0, f"there {'are' if written else 'is'} {many} `{machine}`")
        where = " and in ".join(f"`{state}`" for state in users)
        only = " only" if len(users) < states else ""
        return Found(
            len(users) / states, f"`{machine}` ran in {where}{only}" if users else f"`{machine}` never ran"
        )

    several = {2: "two"}.get(states, states)
    sentence = f"runs `{machine}`, which is written once, in {several} states"
    return Criterion(sentence, judge, "once", needs_motion=False)


def without(*members: str) -> Criterion:
    """Require that the program does not use these members of the robot, such as ``"drive_by"``."""

    def judge(run: RunRecord) -> Found:
        used = {
            use.names[0]
            for program in run.programs
            for placed in resolve(program).all_blocks
            for use in uses_of("robot", placed.block.text)
            if use.names
        }
        found = [f"`robot.{name}`" for name in members if name in used]
        return Found(not found, f"it uses {' and '.join(found)}" if found else "it uses none of them")

    listed = ", ".join(f"`{name}`" for name in members)
    return Criterion(f"does without {listed}", judge, "always", needs_motion=False)


def edited(times: int = 1) -> Criterion:
    """Require that the program is edited while it runs: this often, and so that it becomes another one."""

    def judge(run: RunRecord) -> Found:
        edits = max(0, len(run.programs) - 1)
        return Found(edits / times, {0: "no edit", 1: "1 edit"}.get(edits, f"{edits} edits"))

    return Criterion("is edited while it runs", judge, "once", needs_motion=False)


def slows_to(share: float, slack: float = 0.1) -> Criterion:
    """Require that the robot drives on, after an edit, at this share of the speed that it had before.

    Parameters
    ----------
    share : float
        0.5 is half the speed.
    slack : float
        How far off the share may be, as a fraction of the speed before.
    """

    def judge(run: RunRecord) -> Found:
        def step(so_far: tuple[float, _Recent], now: Sample, before: Sample) -> tuple[float, _Recent]:
            """Keep the speed before the first edit, and time, way and version of the last two seconds."""
            first, recent = so_far
            way = (recent[-1][1] if recent else 0.0) + now.distance(before)
            recent = (*recent, (now.time, way, now.version))
            recent = tuple(each for each in recent if each[0] >= now.time - _SPAN - 1e-6)
            return (_speed(recent) if not now.version else first), recent

        nothing: tuple[float, _Recent] = (0.0, ())
        first, recent = run.fold(step, nothing, "speeds")
        now, half = _speed(recent), len(recent) // 2
        if not recent or not recent[0][2]:
            return Found(0, f"it drives at {now:.2f} m/s")
        parts = [_speed(each) / first if first else 0.0 for each in (recent[:half], recent[half:])]
        met = all(abs(part - share) <= slack for part in parts) and recent[0][2] == recent[-1][2]
        return Found(met, f"it drove at {first:.2f} m/s, and then at {now:.2f} m/s")

    named = {0.5: "half the speed", 2: "twice the speed"}.get(share, f"{share:.0%} of the speed")
    return Criterion(f"drives on at {named}", judge, "once")


def _speed(recent: _Recent) -> float:
    """Return a speed, in m/s, from times and ways."""
    if len(recent) < 2:
        return 0.0
    (first_time, first_way, _), (time, way, _) = recent[0], recent[-1]
    return (way - first_way) / (time - first_time)


def drives_on(metres: float) -> Criterion:
    """Require that the robot drives at least this far after the first edit."""

    def judge(run: RunRecord) -> Found:
        def step(so_far: float, now: Sample, before: Sample) -> float:
            return so_far + now.distance(before) if before.version else so_far

        way = run.fold(step, 0.0, "drives after the edit")
        return Found(way / metres, f"it drove {way * 100:.0f} cm after the edit")

    return Criterion(f"drives on for {metres * 100:g} cm after the edit", judge, "once")


def never_restarts() -> Criterion:
    """Require that no edit restarts the program."""

    def judge(run: RunRecord) -> Found:
        return Found(not run.restarts, run.restart_reason if run.restarts else "no restart")

    return Criterion("never restarts", judge, "always", needs_motion=False)


def no_faults() -> Criterion:
    """Require that the program runs without issues; holds in every challenge.

    An error that the checks find is an issue to come, also in a state that the run does not enter.
    """

    def judge(run: RunRecord) -> Found:
        errors = (finding for finding in run.findings if finding.severity == "error")
        fault = run.issues[0] if run.issues else next(errors, None)
        return Found(not fault, f"line {fault.line}: {fault.message}" if fault else "no issue")

    return Criterion("runs without issues", judge, needs_motion=False)

"""Criteria about the program itself: its states, its edits, its faults."""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from typing import NamedTuple

from lrp_jupyter.grading.criteria.criterion import Criterion, Found
from lrp_jupyter.grading.criteria.order import in_order, reason_of
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.language.checks.uses import uses_of
from lrp_jupyter.language.program import Path
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.running.frame import is_active

_SPAN = 2.0  # s, over which a speed is measured

_LATE = 0.25  # s, by which the same phase may last longer or shorter
_OTHER_SPEED, _OTHER_TURN = 0.01, 0.05  # m/s and rad/s, by which commands differ

_Recent = tuple[tuple[float, float, int], ...]  # time, way, and version of the program


class _Phase(NamedTuple):
    """A time in which the command was the same."""

    command: tuple[float, float]
    seconds: float


class _Driving(NamedTuple):
    """The phases before the first edit, the sample at which the present one began, and what is different."""

    known: tuple[_Phase, ...] = ()
    first: Sample | None = None
    found: str = ""


def enters(*states: str) -> Criterion:
    """Require that states of the program, given by name or path, are entered, in this order."""

    def judge(run: RunRecord) -> Found:
        names = [f"`{state}`" for state in states]
        done = in_order(run, [partial(_is_in, state) for state in states], ("enters", states))
        if len(states) == 1:
            return Found(bool(done), f"entered after {done[0]:.1f} s" if done else "never entered")
        return Found(len(done) / len(states), reason_of(done, names, "entered"))

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


def moves_only_in(machine: str) -> Criterion:
    """Require that no other machine moves the robot, by whatever name it reaches it."""

    def judge(run: RunRecord) -> Found:
        other = run.fold(_first_mover, None, ("other movers than", machine))
        return Found(other is None, f"`{other}` moved it" if other else "no other machine moved it")

    def _first_mover(found: str | None, now: Sample, _: Sample) -> str | None:
        return found or next((path[-1] for path in sorted(now.movers) if path and machine not in path), None)

    return Criterion(f"is moved by `{machine}` only", judge, needs_motion=False)


def without(*members: str) -> Criterion:
    """Require that the program does not use these tasks of the robot, such as ``"drive_by"``.

    It neither names one in its text nor has the robot drive for one, by whatever name it reaches it.
    """

    def judge(run: RunRecord) -> Found:
        used = {
            use.names[0]
            for program in run.programs
            for placed in resolve(program).all_blocks
            for use in uses_of("robot", placed.block.text)
            if use.names
        }
        driven_for = run.fold(_tasks, nothing, "tasks")
        found = [f"`robot.{name}`" for name in members if name in used | driven_for]
        return Found(not found, f"it uses {' and '.join(found)}" if found else "it uses none of them")

    nothing: frozenset[str] = frozenset()
    listed = ", ".join(f"`{name}`" for name in members)
    return Criterion(f"does without {listed}", judge, "always", needs_motion=False)


def _tasks(so_far: frozenset[str], now: Sample, _: Sample) -> frozenset[str]:
    return so_far if now.task in so_far else so_far | {now.task}


def edited(times: int = 1) -> Criterion:
    """Require that the program is edited while it runs: this often, and so that it becomes another one."""

    def judge(run: RunRecord) -> Found:
        edits = max(0, len(run.programs) - 1)
        return Found(edits / times, {0: "no edit", 1: "1 edit"}.get(edits, f"{edits} edits"))

    return Criterion("is edited while it runs", judge, "once", needs_motion=False)


def slows_to(share: float, slack: float = 0.03) -> Criterion:
    """Require that the robot drives on steadily, after an edit, at this share of the speed before it.

    Parameters
    ----------
    share : float
        0.5 is half the speed.
    slack : float
        How far off the mean of two seconds may be, as a fraction of the speed before; one tick may be off by
        three times as much.
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
        now = _speed(recent)
        if not recent or not recent[0][2]:
            return Found(0, f"it drives at {now:.2f} m/s")
        parts = [_speed(pair) for pair in pairwise(recent)]
        met = (
            recent[0][2] == recent[-1][2]
            and abs(now - share * first) <= slack * first
            and all(abs(part - share * first) <= 3 * slack * first for part in parts)
        )
        return Found(met, f"it drove at {first:.2f} m/s, and then at {now:.2f} m/s")

    named = {0.5: "half the speed", 2: "twice the speed"}.get(share, f"{share:.0%} of the speed")
    return Criterion(f"drives on at {named}", judge)


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


def drives_differently() -> Criterion:
    """Require that the robot gets other commands after the first edit, or the same ones for other times."""

    def judge(run: RunRecord) -> Found:
        found = run.fold(_compare, _Driving(), "drives differently").found
        edited = bool(run.samples and run.samples[-1].version)
        return Found(bool(found), found or ("it drives as before the edit" if edited else "no edit"))

    return Criterion("drives differently after the edit", judge, "once")


def _compare(so_far: _Driving, now: Sample, before: Sample) -> _Driving:
    """Compare the phases of driving, in each of which the command is the same, with those before the edit."""
    known, first, found = so_far
    if found:
        return so_far
    if first is None or not _is_alike(now.command, before.command):
        if first is not None:
            length = now.time - first.time
            usual = _usual(known, before.command)
            if not before.version:
                known += (_Phase(before.command, length),)
            elif usual and length < min(usual) - _LATE:
                found = _driven(before.command, length)
        first = now
    if now.version and not found:
        length = now.time - first.time
        usual = _usual(known, now.command)
        if (not usual and first.version) or (usual and length > max(usual) + _LATE):
            found = _driven(now.command, length)
    return _Driving(known, first, found)


def _usual(known: tuple[_Phase, ...], command: tuple[float, float]) -> list[float]:
    return [phase.seconds for phase in known if _is_alike(phase.command, command)]


def _driven(command: tuple[float, float], seconds: float) -> str:
    return f"it drove at {command[0]:.2f} m/s and {command[1]:.2f} rad/s, for {seconds:.1f} s"


def _is_alike(one: tuple[float, float], other: tuple[float, float]) -> bool:
    return abs(one[0] - other[0]) < _OTHER_SPEED and abs(one[1] - other[1]) < _OTHER_TURN


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

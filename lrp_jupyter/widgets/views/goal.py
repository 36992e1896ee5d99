"""The challenge of an open program: criteria of the present run, checks, hints.

The criteria are judged live, on the thread of the loop. A check makes all runs of the challenge in
separate processes meanwhile: the lab stays responsive, and the robot drives on.
"""

from __future__ import annotations

import asyncio
import math
import random
import threading
import traceback
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import Finding, LRPError, sentence_of
from lrp_jupyter.grading.attempt import Attempt, Job, attempt
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.grade import Grade, above_starter, jobs_of, starter_jobs
from lrp_jupyter.grading.handing_in import code_of
from lrp_jupyter.grading.referee import Referee
from lrp_jupyter.grading.workers import Halt, HowRun, run_jobs
from lrp_jupyter.graph.state_graph import DefinedPaths
from lrp_jupyter.language.program import Program, path_text
from lrp_jupyter.live.session import Session
from lrp_jupyter.live.stored.run_files import possible_name
from lrp_jupyter.runs.expectation import ExpectedPart
from lrp_jupyter.sim.world import ArcStroke, BoxSolid, BoxZone, CircleStroke, PathStroke, Solid, World, Zone
from lrp_jupyter.sim.worlds import load
from lrp_jupyter.widgets.views.shown_moment import Looking
from lrp_jupyter.widgets.views.shown_runs import ShownRuns
from lrp_jupyter.widgets.wire.protocol import (
    AttemptView,
    CheckView,
    CriterionView,
    GoalView,
    Hints,
    OutlineView,
)

_HOW = HowRun(limit=30)
_STORING = 0.5  # s in which a browser stores the text, before a check that may not return


@dataclass
class _Check:
    """A check: its runs, and the results of those that have ended."""

    text: str
    jobs: Sequence[Job]
    grade: Grade  # for the runs made so far
    made: dict[int, Attempt] = field(default_factory=dict)
    views: dict[str, AttemptView] = field(default_factory=dict)
    busy: bool = True
    error: str = ""
    halted: Halt = field(default_factory=Halt)


class Goal:
    """The challenge of one open program."""

    def __init__(self, task: Challenge, hints: Hints = "sentences") -> None:
        self.task, self.hints = task, hints
        self._worlds = [load(world) for world in task.worlds]
        self._outlines = [_outline(world) for world in self._worlds]
        self._world = 0
        self._referee: Referee | None = None
        self._is_over = False
        self._check: _Check | None = None
        self._hinted = 0
        self._begun = 0
        self._checked: Program | None = None
        self._findings: tuple[Finding, ...] = ()  # about it
        self._trail: list[tuple[float, float, float, str]] = []
        self.stored: Callable[[], Awaitable[object]] = partial(asyncio.sleep, _STORING)
        """Waits until the text is stored, where a check may not return."""
        self._wake: Callable[[], None] = lambda: None
        self._end: Callable[[], None] = lambda: None

    @property
    def offers_changes(self) -> bool:
        """Whether changes that make a program pass are offered."""
        return self.hints == "changes" and not self.task.exam

    # -- the present run: on the loop's thread --------------------------------------------------------

    def attach(self, session: Session, wake: Callable[[], None]) -> None:
        """Start judging the runs of a session; `wake` is called when there is something to show."""
        self._end()
        self._referee, self._is_over, self._wake = None, False, wake
        self._end = session.on_tick(lambda: self._see(session))

    def close(self) -> None:
        """End the current check, and stop judging runs."""
        self._end()
        if self._check is not None:
            self._check.halted.set()

    def _see(self, session: Session) -> None:
        bridge, referee = session.bridge, self._referee
        if not isinstance(bridge, SimBridge):
            return
        if referee is None or referee.run.world is not bridge.world:
            self._referee = referee = Referee(self.task, bridge.world)
            self._is_over = False
        samples = referee.run.samples
        now = bridge.simulation.time_since_start
        if samples and now <= samples[-1].time:
            referee.go_back(now)
            self._is_over = False
        # a run that began before it was watched cannot be judged
        if not self._is_over and (samples or now < 1):
            self._is_over = referee.see(bridge, session.interpreter, self._findings)

    # -- what is shown: on the publisher's thread -----------------------------------------------------

    def criteria(self) -> list[CriterionView]:
        """Return the results of the criteria for the present run."""
        referee = self._referee
        if referee is None:
            return [{"sentence": each.sentence, "state": "open", "reason": ""} for each in self.task.criteria]
        return [
            {"sentence": each.sentence, "state": each.state, "reason": each.reason}
            for each in referee.verdicts(self._is_over)
        ]

    def view(self, session: Session, text: str) -> GoalView:
        """Return everything else."""
        if session.program is not self._checked:  # here, so that it costs the robot nothing
            self._checked, self._findings = session.program, session.check(session.program)
        hints = self._hints
        return {
            "name": self.task.name,
            "task": self.task.assignment,
            "points": self.task.points,
            "seconds": self.task.seconds,
            "over": self._is_over,
            "world": self._world,
            "worlds": self._outlines,
            "note": self._warning(session),
            "hints": list(hints[: self._hinted]),
            "more_hints": max(0, len(hints) - self._hinted),
            "code": code_of(text) if self.task.exam else "",
            "hidden": len(self.task.hidden),
            "check": self._check_view(text),
            "begun": self._begun,
            "trail": self._trail,
            "keeps": not self.task.live,
        }

    def _warning(self, session: Session) -> str:
        bridge = session.bridge
        if not isinstance(bridge, SimBridge):
            return f"This challenge is for the simulated robot. Choose `sim` instead of `{bridge.name}`."
        if bridge.is_edited or bridge.world.name not in {world.name for world in self._worlds}:
            return "This is not the world of the challenge. Start over brings it back."
        return ""

    @property
    def _hints(self) -> tuple[str, ...]:
        check = self._check
        return () if check is None or check.busy else check.grade.hints

    def _check_view(self, text: str) -> CheckView | None:
        check = self._check
        if check is None:
            return None
        is_whole = len(check.made) == len(check.jobs) and not check.busy
        return {
            "busy": check.busy,
            "stale": check.text != text,
            "done": len(check.made),
            "total": len(check.jobs),
            "passed": check.grade.passed and is_whole,
            "points": check.grade.points if is_whole else 0.0,
            "error": check.error,
        }

    def attempts(self) -> dict[str, AttemptView]:
        """Return the runs of the last check."""
        return {} if self._check is None else self._check.views.copy()

    # -- what a person does ------------------------------------------------------------------------------

    def check(self, session: Session, text: str) -> None:
        """Start running the text in every world of the challenge, with every seed; ends an earlier check."""
        if self._check is not None:
            self._check.halted.set()
        _, jobs = jobs_of(text, self.task, how=_HOW._replace(namespace=session.namespace))
        check = _Check(text, jobs, Grade.of(self.task, {}, jobs))
        self._check, self._hinted = check, 0
        if session.driver == "asyncio":
            self._task = asyncio.get_running_loop().create_task(self._run_here(check))
        else:
            threading.Thread(target=self._run, args=(check,), name="lrp check", daemon=True).start()
        self._wake()

    def _run(self, check: _Check) -> None:
        with _ending(check, self._wake):
            for index, made in run_jobs(check.jobs, _HOW, halt=check.halted):
                made.check()
                self._note(check, index, made)
            begun = run_jobs(self._starter_jobs(check), _HOW, halt=check.halted)
            self._settle(check, [made for _, made in begun])

    async def _run_here(self, check: _Check) -> None:
        """Make the runs one by one, letting the program run in between."""
        with _ending(check, self._wake):
            await self.stored()
            for index, job in enumerate(check.jobs):
                await asyncio.sleep(0.05)
                if check.halted.done():
                    return
                self._note(check, index, attempt(job))
            begun = []
            for job in self._starter_jobs(check):
                await asyncio.sleep(0.05)
                begun.append(attempt(job))
            self._settle(check, begun)

    def _note(self, check: _Check, index: int, made: Attempt) -> None:
        check.made[index] = made
        check.grade = Grade.of(self.task, check.made, check.jobs)
        world = self._world_of(index)
        check.views[str(index)] = _attempt_view(made, world, self._worlds[world].size[1])
        self._wake()

    def _starter_jobs(self, check: _Check) -> list[Job]:
        how = _HOW._replace(namespace=dict(check.jobs[0].namespace))
        return starter_jobs(check.grade, self.task, how)

    def _settle(self, check: _Check, begun: Sequence[Attempt]) -> None:
        if not check.halted.done():
            check.grade = above_starter(check.grade, self.task, begun)

    def _world_of(self, index: int) -> int:
        """Return the place of the world of a run among those of the challenge."""
        return index // self.task.count

    def hint(self) -> None:
        """Show one more of the hints that the last check gives."""
        hints = self._hints
        if not hints:
            raise LRPError("Press Check first: a hint is about what went wrong there.")
        if self._hinted >= len(hints):
            raise LRPError("There are no more hints.")
        self._hinted += 1
        self._wake()

    def start_over(self, session: Session, world: int | None = None) -> None:
        """Put the robot back to the start of a world of the challenge, and start the program again."""
        bridge = _simulated(session)
        self._world = self._world if world is None else min(world, len(self._worlds) - 1)
        wanted = self._worlds[self._world]
        session.pause()  # or a tick in the new world would come before the restart, which would count
        session.call(lambda: bridge.load_world(wanted, 0))
        session.reset()
        self._begin([])
        session.start()

    def _begin(self, trail: list[tuple[float, float, float, str]]) -> None:
        self._trail = trail
        self._begun += 1
        self._wake()

    def show(self, session: Session, looking: Looking, index: int) -> None:
        """Repeat a run of the check in the lab, and look at the moment when it failed."""
        _, decided = self._repeat(session, index)
        if decided is not None:
            looking.look(session, decided)

    def keep(self, session: Session, runs: ShownRuns, index: int) -> None:
        """Repeat a run of the check in the lab, and keep it: it has to meet the challenge."""
        job, _ = self._repeat(session, index)
        name = possible_name(f"{job.world.name}, seed {job.seed}")
        runs.keep(session, name, str(ExpectedPart("meets", self.task.name)))

    def _repeat(self, session: Session, index: int) -> tuple[Job, float | None]:
        """Repeat a run in the lab, in virtual time; return also when it failed, in seconds of the session."""
        bridge, check = _simulated(session), self._check
        made = None if check is None else check.made.get(index)
        if check is None or made is None:
            raise LRPError("This run is no longer known. Check again.")
        if check.text != session.text:
            raise LRPError("The program has changed since this check. Check again first.")
        job = check.jobs[index]
        session.pause()
        self._world = self._world_of(index)
        random.seed(job.seed)
        session.call(lambda: bridge.load_world(job.world, job.seed))
        session.reset()
        begin = session.frame.time
        session.step()  # at once: the world would go on until the next tick is due
        for number, (text, seconds) in enumerate(zip(job.texts, job.durations, strict=True)):
            if number or text != session.text:
                session.edit(text)
            if self._is_over and number:
                break
            rest = begin + made.seconds + 1 / self.task.rate - session.frame.time
            is_last = number == len(job.texts) - 1
            session.run(max(0.0, rest if is_last else min(seconds, rest)), limit=_HOW.limit / 6)
        self._begin(self._driven(session, begin))
        failure = made.failure
        decided = None if failure is None else failure.decided
        return job, None if decided is None else begin + decided

    def _driven(self, session: Session, begin: float) -> list[tuple[float, float, float, str]]:
        """Return the path driven in the present run, with times of the session."""
        samples = [] if self._referee is None else list(self._referee.run.samples)
        paths = DefinedPaths(session.program)
        return [
            (
                round(begin + each.time, 2),
                round(each.x, 3),
                round(each.y, 3),
                path_text(paths.member(each.active[0])) if each.active else "",
            )
            for each in samples
        ]


def _simulated(session: Session) -> SimBridge:
    if not isinstance(session.bridge, SimBridge):
        raise LRPError(f"The program drives `{session.bridge.name}`, not the simulated robot.")
    return session.bridge


@contextmanager
def _ending(check: _Check, wake: Callable[[], None]) -> Iterator[None]:
    """Note that a check has ended, and why; its errors are shown, not raised."""
    try:
        yield
    except LRPError as error:
        check.error = sentence_of(error)
    except Exception:
        check.error = traceback.format_exc()
    finally:
        check.busy = False
        wake()


# -- from values to plain data ---------------------------------------------------------------------------


def _attempt_view(made: Attempt, world: int, height: float) -> AttemptView:
    failure = made.failure
    points = made.path[:: max(1, len(made.path) // 60)]
    return {
        "world": world,
        "seed": made.seed,
        "passed": made.passed,
        "failed": "" if failure is None else failure.sentence,
        "reason": "" if failure is None else failure.reason,
        "share": round(made.share, 3),
        "shows": not made.ended,
        "path": "M" + " ".join(f"{x:.2f},{height - y:.2f}" for x, y in points) if points else "",
    }


def _outline(world: World) -> OutlineView:
    width, height = world.size
    line = []
    for stroke in world.floor.strokes:
        match stroke:
            case PathStroke(path=path):
                line.append("M" + " ".join(f"{x:.2f},{height - y:.2f}" for x, y in path))
            case ArcStroke(arc=(x, y, radius, first, last)):
                ends = [(x + radius * math.cos(a), height - y - radius * math.sin(a)) for a in (first, last)]
                far, left = int(abs(last - first) > math.pi), int(last < first)
                (x1, y1), (x2, y2) = ends
                line.append(f"M{x1:.2f},{y1:.2f} A{radius:g},{radius:g} 0 {far} {left} {x2:.2f},{y2:.2f}")
            case CircleStroke(circle=(x, y, radius)):
                line.append(_ring(x, height - y, radius))
    return {
        "name": world.name,
        "width": width,
        "height": height,
        "solids": " ".join(_shape(solid, solid.angle, height) for solid in world.solids),
        "line": " ".join(line),
        "zones": " ".join(_shape(zone, 0, height) for zone in world.zones.values()),
    }


def _shape(each: Solid | Zone, angle: float, height: float) -> str:
    if isinstance(each, BoxSolid | BoxZone):
        return _rectangle(*each.box, angle, height)
    x, y, radius = each.circle
    return _ring(x, height - y, radius)


def _ring(x: float, y: float, radius: float) -> str:
    arc = f"a{radius:g},{radius:g} 0 1 0"
    return f"M{x - radius:.2f},{y:.2f} {arc} {2 * radius:g},0 {arc} {-2 * radius:g},0Z"


def _rectangle(x: float, y: float, width: float, length: float, angle: float, height: float) -> str:
    cos, sin = math.cos(angle), math.sin(angle)
    corners = [(-width, -length), (width, -length), (width, length), (-width, length)]
    points = [(x + (a * cos - b * sin) / 2, y + (a * sin + b * cos) / 2) for a, b in corners]
    return "M" + " ".join(f"{px:.2f},{height - py:.2f}" for px, py in points) + "Z"

"""One run of a program for a challenge: what is to be run, and what came of it."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, ClassVar, Literal, NamedTuple, get_args

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import LRPError, LRPSyntaxError, SessionTimeoutError
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria.criterion import State, Verdict
from lrp_jupyter.grading.hints import hints_of
from lrp_jupyter.grading.referee import Referee
from lrp_jupyter.grading.run_clock import with_run_clock
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.untrusted import number_in, one_of, share_in, text_in
from lrp_jupyter.language.parser import parse
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.world import World

Ended = Literal["", "text", "time", "memory", "crash", "fault"]


@dataclass(frozen=True)
class Job:
    """One run that is to be made.

    `texts`: applied one after the other to the running program: the second one after `live` seconds, if the
        challenge says so, the others at equal intervals.
    `world`: one of the challenge's, with everything where the seed puts it.
    `seed`: of the robot's noise, and of Python's random numbers.
    `limit`: wall seconds that it may take.
    `namespace`: names that blocks can read.
    """

    texts: tuple[str, ...]
    task: Challenge
    world: World
    seed: int
    limit: float
    namespace: Mapping[str, Any] = field(default_factory=dict)
    recording: ClassVar[str] = ""

    @property
    def durations(self) -> tuple[float, ...]:
        """How long each of the texts runs, in seconds of the run."""
        first, others = self.task.live, len(self.texts) - 1
        if first and others:
            return (first, *[(self.task.seconds - first) / others] * others)
        return (self.task.seconds / len(self.texts),) * len(self.texts)

    @property
    def key(self) -> object:
        """What identifies the program: the same texts for another challenge are another one."""
        return self.texts, self.task.name

    def done(self) -> dict[str, Any]:
        """Make the run, and return the plain data of its attempt."""
        return self.outcome().to_dict()

    def outcome(self, watch: Watch | None = None) -> Attempt:
        """Make the run; see :func:`attempt`."""
        return attempt(self, watch)

    def made(self, data: Any) -> Attempt:
        """Return the attempt that plain data describes. Raises ValueError: it describes none at this job."""
        return Attempt.from_dict(data).of(self)

    def failed(self, ended: Ended, sentence: str, reason: str) -> Attempt:
        """Return an attempt of which nothing is known but why it ended."""
        return failed(ended, sentence, reason).of(self)

    @property
    def world_name(self) -> str:
        """The name of the world."""
        return self.world.name or "world"


class Attempt(NamedTuple):
    """One run that was made.

    `seconds`: its length, in its own time.
    `hints`: for the mistakes that were found, the most important first.
    `share`: of the points, 0 to 1.
    `ended`: why there was no complete run: the text is not a valid program, it took too long to compute, it
        needed too much memory, its process ended, or what runs and judges the program failed.
    `path`: where the robot was, in metres.
    """

    world: str
    seed: int
    seconds: float
    verdicts: tuple[Verdict, ...]
    hints: tuple[str, ...] = ()
    share: float = 0.0
    ended: Ended = ""
    path: tuple[tuple[float, float], ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every criterion is met."""
        return not self.ended and all(verdict.passed for verdict in self.verdicts)

    @property
    def hint(self) -> str:
        """The first hint; empty if there is none."""
        return self.hints[0] if self.hints else ""

    @property
    def failure(self) -> Verdict | None:
        """The criterion that was broken, else the first one that was not met; None if it passed."""
        missing = [verdict for verdict in self.verdicts if not verdict.passed]
        broken = (verdict for verdict in missing if verdict.decided is not None)
        return next(broken, missing[0] if missing else None)

    @property
    def reason(self) -> str:
        """What was broken or not met, and why; empty if it passed."""
        return f"{self.failure.sentence}: {self.failure.reason}" if self.failure else ""

    def check(self) -> None:
        """Raise an LRPError if what runs and judges the program failed."""
        if self.ended == "fault":
            raise LRPError(self.verdicts[0].reason)

    def to_dict(self) -> dict[str, Any]:
        """Return plain data, as :meth:`from_dict` reads it."""
        return {**self._asdict(), "verdicts": [verdict._asdict() for verdict in self.verdicts]}

    @classmethod
    def from_dict(cls, data: Any) -> Attempt:
        """Return the attempt that plain data describes.

        Raises ValueError: it describes none.
        """
        try:
            return cls(
                world=text_in(data["world"]),
                seed=number_in(data["seed"], int),
                seconds=number_in(data["seconds"]),
                verdicts=tuple(map(_verdict, data["verdicts"])),
                hints=tuple(map(text_in, data["hints"])),
                share=share_in(data["share"]),
                ended=one_of(data["ended"], get_args(Ended)),
                path=tuple((number_in(x), number_in(y)) for x, y in data["path"]),
            )
        except (TypeError, LookupError) as error:
            raise ValueError("This is no attempt.") from error

    def of(self, job: Job) -> Attempt:
        """Return this attempt as that of a job.

        Raises ValueError: it is not judged by the criteria of the challenge.
        """
        expected = [text_in(each.sentence) for each in job.task.criteria]
        judged = [verdict.sentence for verdict in self.verdicts]
        if not self.ended and judged[: len(expected)] != expected:
            raise ValueError("This is an attempt at another challenge.")
        return self._replace(world=job.world_name, seed=job.seed)


def _verdict(data: Any) -> Verdict:
    return Verdict(
        text_in(data["sentence"]),
        one_of(data["passed"], (True, False)),
        text_in(data["reason"]),
        share_in(data["share"]),
        one_of(data["state"], get_args(State)),
        None if data["decided"] is None else number_in(data["decided"]),
    )


def failed(ended: Ended, sentence: str, reason: str, hint: str = "") -> Attempt:
    """Return an attempt at any job, of which nothing is known but why it ended."""
    verdict = Verdict(sentence, False, reason, state="failed")
    return Attempt("", 0, 0.0, (verdict,), (hint,) if hint else (), ended=ended)


Watch = Callable[[Session], object]
"""Called after each tick of a run, on the thread that ticks."""


def attempt(job: Job, watch: Watch | None = None) -> Attempt:
    """Run a program in virtual time, and judge it.

    Raises LRPError: the interpreter itself failed.
    """
    before = random.getstate()
    random.seed(job.seed)
    try:
        referee = _run(job, watch)
    except SessionTimeoutError as error:
        return failed("time", f"is computed within {job.limit:g} s", str(error)).of(job)
    except LRPSyntaxError as error:
        hint = "Correct the text first; the editor marks the error."
        return failed("text", "is a valid program", str(error.findings[0]), hint).of(job)
    except MemoryError:
        return failed("memory", "needs little memory", "It needed more memory than it may use.").of(job)
    finally:
        random.setstate(before)
    run, verdicts = referee.run, referee.verdicts(True)
    hints: Sequence[str] = ()
    if not all(verdict.passed for verdict in verdicts):
        hints = tuple(dict.fromkeys(hints_of(job.task, run)))
    return Attempt(
        job.world_name, job.seed, run.seconds, verdicts, tuple(hints), referee.share, path=_path(run)
    )


def _run(job: Job, watch: Watch | None) -> Referee:
    """Run the program.

    Raises SessionTimeoutError: it took longer than the limit.
    """
    end = perf_counter() + job.limit
    task = job.task
    bridge = SimBridge(job.world, job.seed, task.noise)
    referee = Referee(task, bridge.world)
    programs = [parse(text, "<lrp grade>") for text in job.texts]
    namespace = with_run_clock(job.namespace, lambda: bridge.simulation.time_since_start)
    with Session(
        programs[0],
        bridge,
        rate=task.rate,
        namespace=namespace,
        name="grade",
        journal=None if watch else 0,
    ) as session:
        findings = session.check(programs[0])

        def over() -> bool:
            if watch:
                watch(session)
            return referee.see(bridge, session.interpreter, findings) or perf_counter() > end

        for number, (program, seconds) in enumerate(zip(programs, job.durations, strict=True)):
            if number:
                findings = session.edit(program.text)
            decided = session.run(
                seconds + (1 + task.hold if number == len(programs) - 1 else 0),
                after_tick=over,
                limit=job.limit / 6,
            )
            if perf_counter() > end:
                raise SessionTimeoutError(
                    f"The run took longer than {job.limit:g} s of computing and was ended after "
                    f"{referee.run.seconds:.1f} s of its own time. Let the blocks compute less."
                )
            if decided:
                break
        if session.fault:
            raise LRPError(f"The interpreter itself failed, not the program:\n{session.fault}")
    return referee


def _path(run: RunRecord) -> tuple[tuple[float, float], ...]:
    """Return at most 200 points of the robot's path, the last one included."""
    samples = run.samples
    every = max(1, len(samples) // 200)
    return tuple((round(each.x, 3), round(each.y, 3)) for each in (*samples[:-1:every], *samples[-1:]))

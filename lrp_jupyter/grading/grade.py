"""Grade a program: run it headless, in virtual time, and apply the criteria.

``grade(program, "there and back", seeds=10)`` takes a second or two and returns, for every seed
and every criterion, whether it passed and why, and a hint where a typical mistake was made.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, NamedTuple

from lrp_jupyter.arguments import check_number, check_type
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import LRPError, LRPSyntaxError, SessionTimeoutError
from lrp_jupyter.grading.challenges import Challenge, Hint, challenge
from lrp_jupyter.grading.criteria import Criterion, Verdict, no_faults
from lrp_jupyter.grading.record import RunRecord
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Program
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.world import World

__all__ = ["Attempt", "Grade", "grade"]


class Attempt(NamedTuple):
    """One run: world, seed, the verdicts of the criteria, and a hint (empty when there is none).

    `exceeded` is whether it was ended because it took too long to compute.
    """

    world: str
    seed: int
    seconds: float
    verdicts: tuple[Verdict, ...]
    hint: str = ""
    exceeded: bool = False

    @property
    def passed(self) -> bool:
        """Whether every criterion is met."""
        return all(verdict.passed for verdict in self.verdicts)


@dataclass(frozen=True)
class Grade:
    """The result of :func:`grade`; true if everything passed. ``print(grade)`` explains it.

    Parameters
    ----------
    challenge : str
    attempts : tuple of Attempt
    """

    challenge: str
    attempts: tuple[Attempt, ...] = field(default=(), repr=False)

    @property
    def passed(self) -> bool:
        """Whether every run met every criterion."""
        return bool(self.attempts) and all(attempt.passed for attempt in self.attempts)

    @property
    def hint(self) -> str:
        """The first hint; empty when there is none."""
        return next((attempt.hint for attempt in self.attempts if attempt.hint), "")

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        good = sum(attempt.passed for attempt in self.attempts)
        word = "passed" if self.passed else "not yet"
        return f"<Grade {self.challenge}: {word}, {good} of {len(self.attempts)} runs>"

    def __str__(self) -> str:
        lines = [f"{self.challenge}: {'passed' if self.passed else 'not yet'}"]
        shown = next((attempt for attempt in self.attempts if not attempt.passed), None)
        if len(self.attempts) > 1:
            lines += list(self._summary())
        if shown is None and self.attempts:
            shown = self.attempts[0]
        if shown is not None:
            lines += [f"  {verdict}" for verdict in shown.verdicts]
        if self.hint:
            lines.append(f"Hint: {self.hint}")
        return "\n".join(lines)

    def _summary(self) -> Iterator[str]:
        worlds = dict.fromkeys(attempt.world for attempt in self.attempts)
        for world in worlds:
            runs = [attempt for attempt in self.attempts if attempt.world == world]
            failed = [str(attempt.seed) for attempt in runs if not attempt.passed]
            text = f"all {len(runs)} runs" if not failed else f"failed with seed {', '.join(failed)}"
            yield f"  in `{world}`: {text}"


def grade(
    program: str | Program | Sequence[str | Program] | Session,
    what: str | Challenge | World,
    seeds: int | Iterable[int] = 1,
    *,
    criteria: Sequence[Criterion] = (),
    seconds: float = 60,
    namespace: dict[str, Any] | None = None,
    limit: float = 60,
) -> Grade:
    """Run a program headless, in virtual time, and return how it did.

    Parameters
    ----------
    program : str, Program, Session, or several texts
        Several are applied one after the other to the running program, at equal intervals.
    what : str, Challenge or World
        A challenge or its name; a world is graded by `criteria`, for `seconds`.
    seeds : int or iterable of int
        Number of runs in each world, or their seeds.
    namespace : dict, optional
        Names available to the blocks.
    limit : float
        Wall seconds of computing that one run may take, and one block at most a sixth of it; a run that
        takes longer does not pass and is the last one.

    Returns
    -------
    Grade
        A text that is not a valid program does not pass; the reason is its first error.

    Raises
    ------
    LRPError
        The challenge does not exist, or the interpreter itself failed.
    """
    check_type("what", what, (str, Challenge, World), "the name of a challenge, a Challenge or a World")
    check_number("limit", limit, "a number of seconds", above=0)
    check_number("seconds", seconds, "a number of seconds", above=0)
    if not isinstance(seeds, Iterable):
        check_type("seeds", seeds, int, "a number of runs, or the seeds themselves")
        check_number("seeds", seeds, "a number of runs", least=1)
    if isinstance(what, str):
        task = challenge(what)
    elif isinstance(what, Challenge):
        task = what
    else:
        task = Challenge(what.name or "your world", "", (what,), (*criteria, no_faults()), seconds)
    texts = [_text(each) for each in (program if isinstance(program, (list, tuple)) else [program])]
    numbers = range(seeds) if isinstance(seeds, int) else seeds
    runs = [(world, seed) for world in task.worlds for seed in numbers]
    attempts = []
    for world, seed in runs:
        attempts.append(_attempt(texts, task, world, seed, namespace, limit))
        if attempts[-1].exceeded:  # the others would take as long
            break
    return Grade(task.name, tuple(attempts))


def _text(program: Any) -> str:
    if isinstance(program, str):
        return program
    text = getattr(program, "text", None)  # a program, a session, a lab
    if not isinstance(text, str):
        raise TypeError(f"A program must be a text, a Program or a Session, not {type(program).__name__}.")
    return text


def _attempt(
    texts: list[str],
    task: Challenge,
    world: str | World,
    seed: int,
    namespace: dict[str, Any] | None,
    limit: float,
) -> Attempt:
    name = world if isinstance(world, str) else world.name or "world"
    try:
        record = _record(texts, task, world, seed, namespace, limit)
    except SessionTimeoutError as error:
        reason = Verdict(f"is computed within {limit:g} s", False, str(error))
        return Attempt(name, seed, 0.0, (reason,), exceeded=True)
    except LRPSyntaxError as error:
        reason = Verdict("is a valid program", False, str(error.findings[0]))
        return Attempt(name, seed, 0.0, (reason,), "Correct the text first; the editor marks the error.")
    verdicts = tuple(criterion(record) for criterion in task.criteria)
    hint = ""
    if not all(verdict.passed for verdict in verdicts):
        hint = next((text for find in (*_FIRST, *task.hints, _watchdog) if (text := find(record))), "")
    return Attempt(name, seed, record.seconds, verdicts, hint)


def _record(
    texts: list[str],
    task: Challenge,
    world: str | World,
    seed: int,
    namespace: dict[str, Any] | None,
    limit: float,
) -> RunRecord:
    """Run the program.

    Raises
    ------
    SessionTimeoutError
        It took longer than the limit.
    """
    end = perf_counter() + limit
    bridge = SimBridge(world, seed, task.noise)
    record = RunRecord(bridge.world)
    programs = [parse(text, "<lrp grade>") for text in texts]
    with Session(
        programs[0], bridge, rate=task.rate, namespace=namespace, name="grade", journal=0
    ) as session:
        session.observe(record.events.append)

        def over() -> bool:
            record.sample(bridge, session.interpreter)
            return perf_counter() > end or (task.until is not None and task.until(record))

        for number, program in enumerate(programs):
            if number:
                session.edit(program.text)
            session.run(task.seconds / len(programs), after_tick=over, limit=limit / 6)
            if perf_counter() > end:
                raise SessionTimeoutError(
                    f"The run took longer than {limit:g} s of computing and was ended after "
                    f"{record.seconds:.1f} s of its own time. Let the blocks compute less."
                )
        if session.fault:
            raise LRPError(f"The interpreter itself failed, not the program:\n{session.fault}")
        record.issues = tuple(issue for issue in session.issues if not issue.resolved)
        record.notices = bridge.safety.notices
        record.commands = bridge.safety.command_count
    return record


def _nothing_active(run: RunRecord) -> str | None:
    if run.count("entered"):
        return None
    return "Nothing was active. Write `(spawn machine state)` outside all machines to start one."


def _has_issues(run: RunRecord) -> str | None:
    return f"Line {run.issues[0].line}: {run.issues[0].message}" if run.issues else None


def _no_command(run: RunRecord) -> str | None:
    if run.commands:
        return None
    return "The robot never received a command. Put `robot.move(linear=0.2)` into the `running` of a state."


def _watchdog(run: RunRecord) -> str | None:
    return next((notice.text for notice in run.notices if notice.kind == "command watchdog"), None)


_FIRST: tuple[Hint, ...] = (_nothing_active, _has_issues, _no_command)

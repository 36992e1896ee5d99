"""A kept run that is run again with a program, in a worker or here."""

from __future__ import annotations

import ast
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import chain
from typing import Any, ClassVar

from lrp_jupyter.errors import LRPError, LRPSyntaxError
from lrp_jupyter.files import shown
from lrp_jupyter.grading.attempt import Ended
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.interpreter.journal import TICKS
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, Program
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.past.fork import private_namespace
from lrp_jupyter.live.past.replay import Entry, play, without_edits
from lrp_jupyter.live.recording import Recording, RunStart, random_of, recording_of
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.inputs import Input
from lrp_jupyter.live.session import Session
from lrp_jupyter.runs.expectation import Expectation
from lrp_jupyter.runs.outcome import RunOutcome
from lrp_jupyter.runs.renamed import path_now, renamed
from lrp_jupyter.runs.verdicts import RunWatch, judged


@dataclass(frozen=True)
class Rerun:
    """A kept run that is to be run again, in a worker or here.

    `texts`: the program, as one text.
    `recording`: the file.
    `tasks`: the challenges whose criteria are expected to be met, as they are named there.
    `limit`: seconds of computing.
    `trusted`: whether expressions that someone else may have recorded are evaluated.
    `namespace`: names that blocks can read.
    """

    texts: tuple[str, ...]
    recording: str
    expected: Expectation = Expectation()  # noqa: RUF009  (an immutable value)
    tasks: Mapping[str, Challenge] = field(default_factory=dict)
    limit: float = 10.0
    trusted: bool = False
    namespace: Mapping[str, Any] = field(default_factory=dict)
    filename: ClassVar[str] = "<lrp run>"

    @property
    def key(self) -> object:
        """What identifies the program."""
        return self.texts

    def made(self, data: Any) -> RunOutcome:
        """Return the outcome that plain data describes. Raises ValueError: it describes none."""
        return RunOutcome.from_dict(data)

    def failed(self, ended: Ended, sentence: str, reason: str) -> RunOutcome:
        """Return the outcome of a run that did not come to its end."""
        return RunOutcome(problem=reason, ended=ended)

    def done(self) -> dict[str, Any]:
        """Run it again, and return the outcome as plain data."""
        return self.outcome()._asdict()

    def outcome(self, also: Callable[[Session], object] | None = None) -> RunOutcome:
        """Run it again, and call `also` after every tick, with the session that remembers it.

        Raises LRPError: the interpreter itself failed.
        """
        try:
            return self._outcome(recording_of(self.recording), parse(self.texts[0], self.filename), also)
        except LRPSyntaxError as error:
            return RunOutcome(problem=f"The program cannot be run: {error.findings[0]}")
        except MemoryError:
            return RunOutcome(problem="It needed more memory than it may use.")
        except LRPError as error:
            return RunOutcome(problem=str(error))

    @property
    def _seconds(self) -> float:
        """How long the run has to be at least, so that everything that is expected can be met; in seconds."""
        limits = [part.time or 0.0 for part in self.expected.parts if part.kind == "reaches"]
        return max(limits + [task.seconds + 1 + task.hold for task in self.tasks.values()], default=0.0)

    def _outcome(
        self, recording: Recording, program: Program, also: Callable[[Session], object] | None
    ) -> RunOutcome:
        if not self.trusted:
            check_own(recording)
        with session_for(recording, program, self.namespace, remembers=also is not None) as session:
            watch = RunWatch(session, self.expected, self.tasks)

            def after_tick() -> None:
                if also is not None:
                    also(session)
                watch.tick()

            drive_again(session, recording, self.limit, after_tick)
            watch.repeated = len(watch.happenings)
            if recording.start.world is not None:  # a simulated robot can drive on
                more = self._seconds - session.frame.time
                session.run(max(0.0, more), limit=self.limit, after_tick=after_tick)
            return judged(recording, session, watch, self.expected)


def session_for(
    recording: Recording, program: Program, namespace: Mapping[str, Any], remembers: bool = False
) -> Session:
    """Return a session of a program as the recorded one was when it began."""
    start = recording.start
    session = Session(
        start.program(program),
        start.make_bridge(),
        VirtualClock(),
        start.rate,
        namespace=private_namespace({**namespace, **start.namespace()}, random_of(start.random).getstate()),
        on_active_edit=start.on_active_edit,  # type: ignore[arg-type]
        on_issue=start.on_issue,  # type: ignore[arg-type]
        name="run",
        journal=max(recording.reach, TICKS) if recording.reach or remembers else 0,
        start=_start_in(program, start),
    )
    session._loop.is_copy = True
    session.open()
    return session


def _start_in(program: Program, start: RunStart) -> Path | None:
    """Return the machine or state that was started alone, under its present name; None if none was."""
    return path_now(as_path(start.start), renamed(parse(start.text), program)) if start.start else None


def drive_again(
    session: Session,
    recording: Recording,
    limit: float,
    after_tick: Callable[[], object] = lambda: None,
) -> float:
    """Repeat a recorded run in a session from now on, but for edits; return when it began, in seconds.

    Raises SessionTimeoutError: a block does not return.
    Raises LRPError: the interpreter itself failed.
    """
    loop = session._loop
    ticks, begin = loop.interpreter.tick, loop.timing.now
    script: deque[Entry] = deque(
        each._replace(tick=each.tick + ticks, time=round(each.time + begin, 9))
        for each in without_edits(recording.entries)
    )
    with session.driving(limit):
        play(loop, script, float("inf"), lambda: after_tick() or session._driver.has_exceeded)
        loop.timing.clock.rebase(loop.timing.now)
        loop.publish()
    if session.fault:
        raise LRPError(f"The interpreter itself failed, not the program:\n{session.fault}")
    return begin


def check_own(recording: Recording) -> None:
    """Raise LRPError if a run of it evaluates an expression that someone else may have recorded."""
    if not recording.is_own and (code := _code_in(recording)):
        raise LRPError(
            f"It contains `{shown(code)}`, an expression that you have not recorded here. Read it, then "
            "run it once with `lrp replay FILE --trust`."
        )


def _code_in(recording: Recording) -> str:
    """Return an expression that a replay evaluates, and that is more than a value; empty if there is none."""
    set_by_hand = (
        entry.what.expression
        for entry in recording.entries
        if isinstance(entry, Input) and isinstance(entry.what, do.SetVariable)
    )
    for expression in chain(recording.start.initials.values(), set_by_hand):
        try:
            ast.literal_eval(expression)
        except (ValueError, SyntaxError, MemoryError, RecursionError):
            return expression
    return ""

"""A kept run, run again with a program: what was recorded beside what happens now, and the verdict on it."""

from __future__ import annotations

import ast
import json
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Any, ClassVar, NamedTuple, get_args

from lrp_jupyter.bridges.recorded import RecordedBridge
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import LRPError, LRPSyntaxError, SessionTimeoutError
from lrp_jupyter.grading.attempt import Ended
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.referee import Referee
from lrp_jupyter.grading.untrusted import number_in, one_of, text_in
from lrp_jupyter.interpreter.journal import TICKS
from lrp_jupyter.interpreter.trace_events import TraceEvent
from lrp_jupyter.language.diff import diff
from lrp_jupyter.language.lookup import means
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, Program, path_text
from lrp_jupyter.language.successors import Successors
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.coverage import coverage_of
from lrp_jupyter.live.past.fork import private_namespace
from lrp_jupyter.live.past.replay import Entry, play, without_edits
from lrp_jupyter.live.past.timeline import Happening
from lrp_jupyter.live.past.what_if import Divergence, first_event
from lrp_jupyter.live.recording import Line, Recording, random_of, recording_of
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.frame import missing_state
from lrp_jupyter.live.running.inputs import Input
from lrp_jupyter.live.session import Session
from lrp_jupyter.live.stored.json_values import plain, unplain
from lrp_jupyter.live.why.wording import call_text
from lrp_jupyter.runs.expectation import Expectation, ExpectedPart

OPEN_LOOP = (
    "A real robot was recorded: from the first difference on, its readings are those of the recorded drive, "
    "not what the robot would have read with this program."
)


class PartVerdict(NamedTuple):
    """The verdict on one part of an expectation.

    `part`: as a person writes it.
    `reason`: a sentence.
    `time`: when it was decided, in seconds of the run; None if only the end decided.
    """

    part: str
    passed: bool
    reason: str
    time: float | None = None


class StateEntered(NamedTuple):
    """A state that was entered, or None for the end of its machine: when (s), and in which machine.

    `lane`: the path of the machine, as spawned.
    """

    time: float
    lane: str
    state: str | None


class RunOutcome(NamedTuple):
    """What came of a run that was run again.

    `found`: the verdict on each part of what is expected.
    `difference`, `differs`: the first difference of its states from the recording, in words; and its tick.
    `time`, `lane`: when that is, in seconds, and in which machine.
    `open_loop`: the seconds from which recorded readings do not answer any more to what is commanded.
    `seconds`: how long the run is.
    `recorded`, `now`: the states that were entered.
    `coverage`: what of the program was reached, as plain data.
    `issues`: how many issues the program has at the end.
    `problem`: why there is no verdict; empty if there is.
    """

    found: tuple[PartVerdict, ...] = ()
    difference: str = ""
    differs: int | None = None
    time: float = 0.0
    lane: str = ""
    open_loop: float | None = None
    seconds: float = 0.0
    recorded: tuple[StateEntered, ...] = ()
    now: tuple[StateEntered, ...] = ()
    coverage: Mapping[str, Any] = {"states": {}, "transitions": {}, "conditions": {}}
    issues: int = 0
    problem: str = ""

    ended: Ended = ""

    @property
    def passed(self) -> bool:
        """Whether everything that is expected holds."""
        return not self.problem and all(each.passed for each in self.found)

    @property
    def reason(self) -> str:
        """Why it did not pass; empty if it did."""
        return self.problem or next((each.reason for each in self.found if not each.passed), "")

    @classmethod
    def from_dict(cls, data: Any) -> RunOutcome:
        """Return the outcome that plain data describes. Raises ValueError: it describes none."""
        try:
            return cls(
                tuple(
                    PartVerdict(text_in(part), one_of(passed, (True, False)), text_in(reason), _maybe(time))
                    for part, passed, reason, time in data["found"]
                ),
                text_in(data["difference"]),
                None if data["differs"] is None else number_in(data["differs"], int),
                number_in(data["time"]),
                text_in(data["lane"]),
                _maybe(data["open_loop"]),
                number_in(data["seconds"]),
                tuple(map(_entered_in, data["recorded"])),
                tuple(map(_entered_in, data["now"])),
                {
                    "states": _counts(data["coverage"]["states"]),
                    "transitions": _counts(data["coverage"]["transitions"]),
                    "conditions": {
                        text_in(path): (bool(held), bool(failed))
                        for path, (held, failed) in data["coverage"]["conditions"].items()
                    },
                },
                number_in(data["issues"], int),
                text_in(data["problem"]),
                one_of(data["ended"], get_args(Ended)),
            )
        except (TypeError, LookupError, AttributeError) as error:
            raise ValueError("This is no outcome of a run.") from error


def _maybe(time: Any) -> float | None:
    return None if time is None else number_in(time)


def _entered_in(data: Any) -> StateEntered:
    time, lane, state = data
    return StateEntered(number_in(time), text_in(lane), None if state is None else text_in(state))


def _counts(data: Any) -> dict[str, int]:
    return {text_in(path): number_in(times, int) for path, times in data.items()}


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

    def outcome(self) -> RunOutcome:
        """Run it again. Raises LRPError: the interpreter itself failed."""
        try:
            return self._outcome(recording_of(self.recording), parse(self.texts[0], self.filename))
        except SessionTimeoutError as error:
            return RunOutcome(problem=f"It was ended after {self.limit:g} s of computing. {error}")
        except LRPSyntaxError as error:
            return RunOutcome(problem=f"The program cannot be run: {error.findings[0]}")
        except MemoryError:
            return RunOutcome(problem="It needed more memory than it may use.")
        except LRPError as error:
            return RunOutcome(problem=str(error))

    def _outcome(self, recording: Recording, program: Program) -> RunOutcome:
        if not (self.trusted or recording.is_own) and (code := _code_in(recording)):
            raise LRPError(
                f"It contains `{code}`, an expression that you have not recorded here. Read it, then run it "
                "once with `lrp replay FILE --trust`."
            )
        with session_for(recording, program, self.namespace) as session:
            watch = _Watch(session, self.tasks)
            drive_again(session, recording, self.limit, watch.tick)
            return _judged(recording, session, watch, self.expected)


def session_for(recording: Recording, program: Program, namespace: Mapping[str, Any]) -> Session:
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
        journal=max(recording.reach, TICKS) if recording.reach else 0,
    )
    session._loop.is_copy = True
    session.open()
    return session


def drive_again(
    session: Session,
    recording: Recording,
    limit: float,
    after_tick: Callable[[], object] | None = None,
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
        play(loop, script, float("inf"), after_tick)
        loop.timing.clock.rebase(loop.timing.now)
        loop.publish()
    if session.fault:
        raise LRPError(f"The interpreter itself failed, not the program:\n{session.fault}")
    return begin


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


class _Watch:
    """What is noted of a run: states and commands, what the robot touches, the challenges' criteria."""

    def __init__(self, session: Session, tasks: Mapping[str, Challenge]) -> None:
        self.happenings: list[Happening] = []
        self.commands: list[Happening] = []
        self.touches: list[tuple[float, str]] = []
        self._session = session
        self._touched: frozenset[str] = frozenset()
        session.observe(self._see)
        bridge = session.bridge
        self._is_open_loop = isinstance(bridge, RecordedBridge)
        simulated = bridge if isinstance(bridge, SimBridge) else None
        self.referees = {name: Referee(task, simulated.world) for name, task in tasks.items() if simulated}
        self._findings = session.check(session.program) if self.referees else ()

    def _see(self, event: TraceEvent) -> None:
        time = round(event.now, 9)
        if event.kind == "entered":
            self.happenings.append(Happening(event.tick, time, "entered", event.path[:-1], event.path))
        elif event.kind == "discarded":
            self.happenings.append(Happening(event.tick, time, "ended", event.path))
        elif event.kind == "commanded" and self._is_open_loop:
            data: Any = event.data
            call = _call(data.name, plain(data.arguments))
            self.commands.append(Happening(event.tick, time, "command", by=(data.name,), call=call))

    def tick(self) -> bool:
        session = self._session
        bridge = session.bridge
        if isinstance(bridge, SimBridge):
            touched = bridge.touched
            for solid in touched - self._touched:
                self.touches.append((session._loop.timing.now, solid))
            self._touched = touched
            for referee in self.referees.values():
                referee.see(bridge, session.interpreter, self._findings)
        return False


def _call(name: str, arguments: Any) -> str:
    """Return a call as it is written in a program, from its arguments in their JSON form."""
    return call_text(name, unplain(json.loads(json.dumps(arguments))))


def _recorded(lines: Sequence[Line], successors: Successors, kind: str) -> Iterator[Happening]:
    """Yield the states, or the commands, of a recording, under their names in the present program."""
    for line in lines:
        event, tick, time = line.get("event"), line["tick"], line["time"]
        if kind == "command" and event == "commanded":
            name = line["command"]
            yield Happening(tick, time, "command", by=(name,), call=_call(name, line["arguments"]))
        elif kind == "state" and event == "entered":
            path = _renamed(tuple(line["state"].split("/")), successors)
            yield Happening(tick, time, "entered", path[:-1], path)
        elif kind == "state" and event == "discarded":
            yield Happening(tick, time, "ended", _renamed(tuple(line["machine"].split("/")), successors))


def _renamed(path: Path, successors: Successors) -> Path:
    """Return the present path of a state or machine; one that is gone keeps its own."""
    kind = "machine" if len(path) % 2 else "state"
    return successors.path(kind, path) or path


def _judged(recording: Recording, session: Session, watch: _Watch, expected: Expectation) -> RunOutcome:
    successors = diff(recording.start.program(recording.start.text), session.program).successors
    recorded = [*_recorded(recording.followed, successors, "state")]
    differs = first_event(recorded, watch.happenings)
    is_open_loop = isinstance(session.bridge, RecordedBridge)
    other: Divergence | None = None
    if is_open_loop:
        other = first_event(_recorded(recording.followed, successors, "command"), watch.commands)
    departs = [each.time for each in (differs, other) if each is not None]
    return RunOutcome(
        found=tuple(_found(part, session, watch, differs) for part in expected.parts),
        difference="" if differs is None else differs.text,
        differs=None if differs is None else differs.tick,
        time=0.0 if differs is None else differs.time,
        lane="" if differs is None else path_text(differs.lane),
        open_loop=min(departs) if is_open_loop and departs else None,
        seconds=session._loop.timing.now,
        recorded=tuple(map(_entered, recorded)),
        now=tuple(map(_entered, watch.happenings)),
        coverage=coverage_of(session.interpreter).to_dict(),
        issues=sum(not issue.resolved for issue in session.interpreter.issues),
    )


def _entered(each: Happening) -> StateEntered:
    return StateEntered(each.time, path_text(each.lane), each.state[-1] if each.state else None)


def _found(part: ExpectedPart, session: Session, watch: _Watch, differs: Divergence | None) -> PartVerdict:
    """Return the verdict on a part of an expectation."""
    match part.kind:
        case "as recorded":
            if differs is None or (part.time is not None and differs.time > part.time):
                return PartVerdict(str(part), True, "The same states are entered at the same times.")
            return PartVerdict(
                str(part), False, f"differs at {differs.time:.1f} s: {differs.text}", differs.time
            )
        case "touches":
            return _touching(part, session, watch)
        case "meets":
            return _meeting(part, watch)
    return _entering(part, session, watch)


def _entering(part: ExpectedPart, session: Session, watch: _Watch) -> PartVerdict:
    program = session.program
    if (missing := missing_state(part.name, program)) is not None:
        return PartVerdict(str(part), False, str(missing))
    states = (each for each in watch.happenings if each.kind == "entered")
    first = next((each.time for each in states if means(program, part.name, each.state)), None)
    state = f"`{part.name}`"
    if part.kind == "never":
        return PartVerdict(
            str(part),
            first is None,
            f"{state} is never entered." if first is None else f"{state} is entered at {first:.1f} s.",
            first,
        )
    if first is None:
        return PartVerdict(str(part), False, f"{state} is not entered in {session._loop.timing.now:.1f} s.")
    is_late = part.time is not None and first > part.time
    return PartVerdict(str(part), not is_late, f"{state} is entered at {first:.1f} s.", first)


def _touching(part: ExpectedPart, session: Session, watch: _Watch) -> PartVerdict:
    if not isinstance(session.bridge, SimBridge):
        return PartVerdict(str(part), False, "What the robot touched is known only of a simulated robot.")
    wanted = [(time, solid) for time, solid in watch.touches if part.name in ("", solid)]
    if not wanted:
        return PartVerdict(
            str(part), True, "The robot touches nothing." if not part.name else "It is not touched."
        )
    time, solid = wanted[0]
    what = "the edge of the world" if solid == "edge" else f"`{solid}`"
    return PartVerdict(str(part), False, f"The robot touches {what} at {time:.1f} s.", time)


def _meeting(part: ExpectedPart, watch: _Watch) -> PartVerdict:
    referee = watch.referees.get(part.name)
    if referee is None:
        return PartVerdict(str(part), False, "The criteria of a challenge are about a simulated robot.")
    missing = [verdict for verdict in referee.verdicts(True) if not verdict.passed]
    if not missing:
        return PartVerdict(str(part), True, "All criteria are met.")
    broken = next((verdict for verdict in missing if verdict.decided is not None), missing[0])
    return PartVerdict(str(part), False, f"{broken.sentence}: {broken.reason}", broken.decided)

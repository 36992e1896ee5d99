"""Judge a run that is run again, beside what was recorded, by what is expected of it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from lrp_jupyter.bridges.recorded import RecordedBridge
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.referee import Referee
from lrp_jupyter.interpreter.trace_events import TraceEvent
from lrp_jupyter.language.lookup import means
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import path_text
from lrp_jupyter.live.coverage import coverage_of
from lrp_jupyter.live.past.timeline import Happening
from lrp_jupyter.live.past.what_if import Divergence, first_event
from lrp_jupyter.live.recording import Line, Recording
from lrp_jupyter.live.running.frame import missing_state
from lrp_jupyter.live.session import Session
from lrp_jupyter.live.stored.json_values import plain, unplain
from lrp_jupyter.live.why.wording import call_text
from lrp_jupyter.runs.expectation import Expectation, ExpectedPart
from lrp_jupyter.runs.outcome import PartVerdict, RunOutcome, StateEntered
from lrp_jupyter.runs.renamed import Names, path_now, renamed


class RunWatch:
    """What is noted of a run: states and commands, and what else is asked for.

    That is what the robot touches, and the criteria of challenges.
    """

    def __init__(self, session: Session, expected: Expectation, tasks: Mapping[str, Challenge]) -> None:
        self.happenings: list[Happening] = []
        self.repeated: int | None = None  # how many of them there were when the recording was at its end
        self.commands: list[Happening] = []
        self.touches: list[tuple[float, str]] = []
        self._session = session
        self._touched: frozenset[str] = frozenset()
        self._decided: set[str] = set()  # the challenges that have been met, or no longer can be
        session.observe(self._see)
        bridge = session.bridge
        self.is_open_loop = isinstance(bridge, RecordedBridge)
        self._simulated = simulated = bridge if isinstance(bridge, SimBridge) else None
        self._feels = any(part.kind == "touches" for part in expected.parts)
        self.referees = {name: Referee(task, simulated.world) for name, task in tasks.items() if simulated}
        self._findings = session.check(session.program) if self.referees else ()

    def _see(self, event: TraceEvent) -> None:
        time = round(event.now, 9)
        if event.kind == "entered":
            self.happenings.append(Happening(event.tick, time, "entered", event.path[:-1], event.path))
        elif event.kind == "discarded":
            self.happenings.append(Happening(event.tick, time, "ended", event.path))
        elif event.kind == "commanded" and self.is_open_loop:
            data: Any = event.data
            call = _call(data.name, plain(data.arguments))
            self.commands.append(Happening(event.tick, time, "command", by=(data.name,), call=call))

    def tick(self) -> None:
        """Note what a tick has brought."""
        session, world = self._session, self._simulated
        if world is None:
            return
        if self._feels:
            new = sorted(world.touched - self._touched)
            self.touches += ((session._loop.timing.now, solid) for solid in new)
            self._touched = world.touched
        for name, referee in self.referees.items():
            if name not in self._decided and referee.see(world, session.interpreter, self._findings):
                self._decided.add(name)


def _call(name: str, arguments: Any) -> str:
    """Return a call as it is written in a program, from its arguments in their JSON form."""
    return call_text(name, unplain(json.loads(json.dumps(arguments))))


def _recorded(lines: Sequence[Line], names: Names, kind: str) -> Iterator[Happening]:
    """Yield the states, or the commands, of a recording, under their names in the present program."""
    for line in lines:
        event, tick, time = line.get("event"), line["tick"], line["time"]
        if kind == "command" and event == "commanded":
            name = line["command"]
            yield Happening(tick, time, "command", by=(name,), call=_call(name, line["arguments"]))
        elif kind == "state" and event == "entered":
            path = path_now(tuple(line["state"].split("/")), names)
            yield Happening(tick, time, "entered", path[:-1], path)
        elif kind == "state" and event == "discarded":
            yield Happening(tick, time, "ended", path_now(tuple(line["machine"].split("/")), names))


def judged(recording: Recording, session: Session, watch: RunWatch, expected: Expectation) -> RunOutcome:
    """Return what came of a run, and the verdict on each part of what is expected."""
    names = renamed(parse(recording.start.text), session.program)
    recorded = [*_recorded(recording.followed, names, "state")]
    differs = first_event(recorded, watch.happenings[: watch.repeated])
    other: Divergence | None = None
    if watch.is_open_loop:
        other = first_event(_recorded(recording.followed, names, "command"), watch.commands)
    departs = [each.time for each in (differs, other) if each is not None]
    return RunOutcome(
        found=tuple(_found(part, session, watch, differs) for part in expected.parts),
        difference="" if differs is None else differs.text,
        time=0.0 if differs is None else differs.time,
        lane="" if differs is None else path_text(differs.lane),
        open_loop=min(departs) if watch.is_open_loop and departs else None,
        seconds=session._loop.timing.now,
        recorded=tuple(map(_entered, recorded)),
        now=tuple(map(_entered, watch.happenings)),
        coverage=coverage_of(session.interpreter).to_dict(),
        issues=sum(not issue.resolved for issue in session.interpreter.issues),
    )


def _entered(each: Happening) -> StateEntered:
    return StateEntered(each.time, path_text(each.lane), each.state[-1] if each.state else None)


def _found(part: ExpectedPart, session: Session, watch: RunWatch, differs: Divergence | None) -> PartVerdict:
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


def _entering(part: ExpectedPart, session: Session, watch: RunWatch) -> PartVerdict:
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


def _touching(part: ExpectedPart, session: Session, watch: RunWatch) -> PartVerdict:
    if not isinstance(session.bridge, SimBridge):
        return PartVerdict(str(part), False, "What a robot touches is only known in the simulator.")
    wanted = [(time, solid) for time, solid in watch.touches if part.name in ("", solid)]
    if not wanted:
        nothing = f"The robot does not touch `{part.name}`." if part.name else "The robot touches nothing."
        return PartVerdict(str(part), True, nothing)
    time, solid = wanted[0]
    what = "the edge of the world" if solid == "edge" else f"`{solid}`"
    return PartVerdict(str(part), False, f"The robot touches {what} at {time:.1f} s.", time)


def _meeting(part: ExpectedPart, watch: RunWatch) -> PartVerdict:
    referee = watch.referees.get(part.name)
    if referee is None:
        return PartVerdict(
            str(part), False, "The criteria of a challenge can only be checked with a simulated robot."
        )
    missing = [verdict for verdict in referee.verdicts(True) if not verdict.passed]
    if not missing:
        return PartVerdict(str(part), True, "All criteria are met.")
    broken = next((verdict for verdict in missing if verdict.decided is not None), missing[0])
    return PartVerdict(str(part), False, f"{broken.sentence}: {broken.reason}", broken.decided)

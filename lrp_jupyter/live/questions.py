"""What a session can be asked: what was, why, how it would go on, and what if something were otherwise.

Nothing changes in the session. Its record answers between two ticks; *what if* runs forks, which are sessions
themselves.
"""

from __future__ import annotations

import math
import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path as FilePath
from types import NoneType
from typing import Any, TypeVar

from lrp_jupyter.arguments import check_callable, check_number, check_type
from lrp_jupyter.bridges.recorded import RecordedBridge
from lrp_jupyter.errors import BridgeError, FileError, SessionTimeoutError, sentence_of
from lrp_jupyter.language.blocks.expressions import Evaluation
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element, Path, Program, path_text
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.past.fork import (
    ForkStart,
    check_repeated,
    fork_start,
    private_namespace,
    run_start,
    started_again,
)
from lrp_jupyter.live.past.past_frames import animation_of, frame_at, tick_of
from lrp_jupyter.live.past.plots import Plot, plotting_named
from lrp_jupyter.live.past.replay import Entry, Ticked, WentBackError, repeat, tested_again, without_edits
from lrp_jupyter.live.past.timeline import Timeline, TimelineCursor, timeline_of
from lrp_jupyter.live.past.trials import Trial, Trials
from lrp_jupyter.live.past.what_if import Course, Observation, WhatIf, divergence
from lrp_jupyter.live.reason import Reason
from lrp_jupyter.live.recorder import Recorder, start_of
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.runner import Runner, Until
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.frame import Frame
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.stored.run_files import new_file, runs_folder
from lrp_jupyter.live.why.answers import Question, element_reason
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.logs import open_log

REPEATING = 2.0
"""Wall seconds that a block may take in a fork that others wait for."""

Moment = int | float | None
"""A tick; a time in seconds, as a float: then the last tick that was not after it; None: now."""
Asked = TypeVar("Asked", bound=Runner)


def at(session: Runner, tick: int | float) -> Frame:
    """Return the frame of an earlier moment."""
    _check_moment("tick", tick)
    return session._value(
        "at", lambda loop: frame_at(loop, tick_of(loop, tick) if isinstance(tick, float) else tick)
    )


def animation(session: Runner, begin: Moment, end: Moment) -> str:
    """Return how the simulated world moved between two moments, as an animated SVG."""
    for name, at in (("begin", begin), ("end", end)):
        if at is not None:
            _check_moment(name, at)
    draw = session._value(
        "animation", lambda loop: animation_of(loop, _tick_of(loop, begin), _tick_of(loop, end))
    )
    if draw is None:
        raise BridgeError(f"`{session.bridge.name}` has no simulated world that could be drawn.")
    return draw()


def timeline(session: Runner, since: TimelineCursor | None, plots: Mapping[str, int] | None) -> Timeline:
    """Return what happened, in order, since an earlier answer."""
    check_type("since", since, (TimelineCursor, NoneType), "the `cursor` of a timeline")
    check_type("plots", plots, (Mapping, NoneType), "a mapping of names to ticks")
    return session._value("timeline", lambda loop: timeline_of(loop, since, plots))()


def plots(session: Runner, names: Iterable[str], event: str | Path | None, seconds: float) -> list[Plot]:
    """Return the recorded samples of variables and readings."""
    wanted = _listed("names", names, '["robot.light.data"]')
    check_number("seconds", seconds, "a number of seconds", above=0)
    for name in wanted:
        check_type("names", name, str, "a list of texts")
    return session._value("plots", lambda loop: plotting_named(loop, wanted, event, seconds))()


def answer(session: Runner, question: Question, name: str | Path, at: Moment) -> Reason:
    """Return why an element of the program, or the robot, did or did not do something."""
    if at is not None:
        _check_moment("at", at)

    def answer(loop: Loop) -> Reason:
        run = RecordedRun(loop, partial(test_again, session))
        return element_reason(run, question, name, _tick_of(loop, at))

    return session._value(question, answer)


def test_again(session: Runner, tick: int, element: Element, machine: Path) -> Evaluation | Exception | None:
    """Run a tick again in a fork, and return what the test of a transition of a machine was there."""
    try:
        start = fork_start(session._loop, tick - 1)
        if isinstance(start.bridge, RecordedBridge):
            return None
        with _forked(session, start) as copy, copy.driving(REPEATING):
            return tested_again(copy._loop, copy._script, element, machine)
    except (ValueError, BridgeError, SessionTimeoutError):
        return None


def fork(session: Asked, at: Moment, program: str | Program | None, inputs: bool) -> Asked:
    """Return an independent copy of a session, now or after an earlier tick."""
    other = _parsed(session, program)
    return _going_on(session, _start_of(session, at), other, inputs)


def keep(session: Asked, name: str, folder: str | os.PathLike[str] | None) -> FilePath:
    """Write a recording of the present run, made by repeating it."""
    check_type("name", name, str, "a name")
    session._driver.refuse_inside("keep")
    start = session._value("keep", run_start)
    path = new_file(runs_folder(session.name) if folder is None else folder, name or "run")
    recorders: list[Recorder] = []

    def record(copy: Runner) -> None:
        copy.interpreter.report_duplicates()
        began = replace(start_of(copy._loop), bridge=session.bridge.name)
        recorders.append(Recorder(copy._loop, stream.write, began))

    try:
        with open_log(path) as stream, _forked(session, start, record) as copy:
            _repeat(copy, start.later)  # what was done after the last tick
            recorders[0].end()
        _check_readable(path)
    except BaseException as error:
        path.unlink(missing_ok=True)
        if not isinstance(error, WentBackError):
            raise
        raise ValueError(
            f"This run cannot be kept: you went back in it, and {error.left} was no longer as it had been "
            "then. Begin a new run."
        ) from None
    return path


def _check_readable(path: FilePath) -> None:
    """Raise ValueError if a recording cannot be read: better now than when it is needed."""
    try:
        read_recording(path)
    except FileError:
        raise ValueError(
            "This run cannot be kept: something was done in it that cannot be written to a file, such as "
            "assigning an object. Begin a new run."
        ) from None


def _parsed(session: Runner, program: str | Program | None) -> Program | None:
    check_type("program", program, (str, Program, NoneType), "a text or a Program")
    return parse(program, session.program.filename) if isinstance(program, str) else program


def _start_of(session: Runner, at: Moment) -> ForkStart:
    if at is not None:
        _check_moment("at", at)
    return session._value("fork", lambda loop: fork_start(loop, _tick_of(loop, at)))


def _starts(session: Runner, at: Moment, count: int) -> Iterator[ForkStart]:
    """Yield the starts of some forks, all from the same moment though the session goes on between them."""
    start = _start_of(session, at)
    try:
        for number in range(count):
            yield started_again(start) if number < count - 1 else start
    finally:
        start.bridge.close()


def _going_on(session: Asked, start: ForkStart, program: Program | None, inputs: bool) -> Asked:
    """Return a fork that goes on from its start, with another program if there is one."""
    copy = _forked(session, start)
    with copy._closed_on_error(), copy._driver.exclusive("fork"):
        if program is not None:
            copy._loop.apply(do.ReplaceProgram(program))
            copy._text = program.text
            copy._script = deque(without_edits(copy._script))
        if not inputs:
            copy._script.clear()
        if not copy._script:
            copy._loop.rest()
        copy._loop.publish()
    return copy


def what_if(session: Runner, at: Moment, program: str | Program | None, seconds: float) -> WhatIf:
    """Return how another program would go on from a moment, beside how it went."""
    if program is None and at is not None:
        program = session.program
    others = [] if program is None else [program]
    return _compared(session, "what_if", at, [None, *others], seconds)[-1]


def try_programs(
    session: Runner, programs: Iterable[str | Program], seconds: float, at: Moment
) -> list[WhatIf]:
    """Return how each of some programs would go on from a moment, beside how the first would."""
    return _compared(session, "try_programs", at, _listed("programs", programs, "[text, other]"), seconds)


def _compared(
    session: Runner, what: str, at: Moment, programs: list[str | Program | None], seconds: float
) -> list[WhatIf]:
    """Run each program on from one moment in a fork, None as it went; compare each course with the first."""
    check_number("seconds", seconds, "a number of seconds", above=0)
    if math.isinf(seconds):
        raise ValueError("All runs last so many `seconds`. Pass a number that is not infinite.")
    session._driver.refuse_inside(what)
    parsed, found = [_parsed(session, program) for program in programs], list[WhatIf]()
    for program, start in zip(parsed, _starts(session, at, len(parsed)), strict=True):
        with _going_on(session, start, program, True) as copy:
            tick, begin = copy.frame.tick, copy.frame.time
            changed, end, open_loop = _observed(copy, seconds)
        recorded = found[0].recorded if found else changed
        differs = divergence(recorded, changed)
        found.append(WhatIf(tick, begin, end, recorded, changed, differs, open_loop))
    return found


def _observed(copy: Runner, seconds: float) -> tuple[Course, float, bool]:
    """Run a fork, and return its course, its end in seconds, and whether readings were fed."""
    observation = Observation(copy._loop)
    copy.run(seconds, limit=REPEATING, after_tick=observation.watch)
    open_loop = isinstance(copy.bridge, RecordedBridge)
    return observation.course(), copy._loop.timing.now, open_loop


def try_values(
    session: Asked,
    variable: str | Path,
    values: Iterable[object],
    seconds: float,
    until: Until | None,
    outcome: Callable[[Asked], object] | None,
    at: Moment,
) -> Trials:
    """Run on from one moment with different values of a variable, each in a fork."""
    check_number("seconds", seconds, "a number of seconds", least=0)
    if math.isinf(seconds) and until is None:
        raise ValueError("A run without `until` never ends. Pass `until`, or other `seconds`.")
    if outcome is not None:
        check_callable("outcome", outcome)
    session._driver.refuse_inside("try_values")
    wanted, trials = _listed("values", values, "[0.2, 0.3]"), []
    for value, start in zip(wanted, _starts(session, at, len(wanted)), strict=True):
        with _going_on(session, start, None, False) as copy:
            copy.variables[variable] = value
            trials.append(_tried(copy, value, seconds, until, outcome))
    awaited = "" if until is None else "the condition" if callable(until) else path_text(as_path(until))
    return Trials(path_text(as_path(variable)), tuple(trials), awaited)


def _tried(
    copy: Asked,
    value: object,
    seconds: float,
    until: Until | None,
    outcome: Callable[[Asked], object] | None,
) -> Trial:
    begin, way = copy.frame.time, []
    ends = None if until is None else copy._watch(until)

    def after_tick() -> bool:
        if (world := copy.bridge.simulated) is not None:
            way.append(world.pose[:2])
        return ends is not None and ends()

    reached = copy.run(seconds, after_tick=after_tick)
    frame = copy.frame
    return Trial(
        value,
        round(frame.time - begin, 9),
        round(frame.time - begin, 9) if reached and until is not None else None,
        None if outcome is None else outcome(copy),
        frame.active,
        sum(not issue.resolved for issue in frame.issues),
        tuple(way),
    )


def _forked(session: Asked, start: ForkStart, begun: Callable[[Asked], object] = lambda copy: None) -> Asked:
    """Return a copy of a session, at the moment for which it was prepared.

    `begun`: called with the copy before it repeats anything.
    """
    checkpoint = start.checkpoint
    copy = type(session)(
        checkpoint.snapshot.program,
        start.bridge,
        VirtualClock(),
        namespace=private_namespace(start.namespace, checkpoint.random),
        name=f"{session.name} fork",
        journal=session._journal,
    )
    with copy._closed_on_error():
        copy._loop.begin(checkpoint)
        begun(copy)
        if start.entries:
            _repeat(copy, start.entries)
        if start.recorded is not None:
            check_repeated(start.recorded, copy.interpreter)
    copy._text = copy.interpreter.program.text
    copy._script.extend(start.later)
    return copy


def _repeat(copy: Runner, entries: Iterable[Entry]) -> None:
    """Raise SessionTimeoutError if a block did not return, ValueError if an input cannot be applied again."""
    queued, what = copy._loop.inbox.queued, ""
    try:
        with copy.driving(REPEATING):
            for entry in entries:
                noun = "Tick" if isinstance(entry, Ticked) else "What was done after tick"
                what = f"{noun} {entry.tick}"
                repeat(copy._loop, entry)
                if queued:  # the limit is exceeded
                    break
    except SessionTimeoutError:
        raise SessionTimeoutError(f"{what} cannot be repeated: a block did not return.") from None
    except WentBackError:
        raise
    except Exception as error:
        raise ValueError(f"{what} cannot be repeated: {sentence_of(error)}") from error


def _listed(name: str, values: Iterable[Any], example: str) -> list[Any]:
    """Return the values of an argument that is a list, for which a text is taken by mistake."""
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        kind = type(values).__name__
        raise TypeError(f"`{name}` must be a list, such as `{example}`, not {kind}.")
    return list(values)


def _check_moment(name: str, at: object) -> None:
    check_type(name, at, (int, float), "the number of a tick, or a time in seconds")
    if isinstance(at, float):
        check_number(name, at, "a time in seconds", least=0)


def _tick_of(loop: Loop, at: Moment) -> int | None:
    """Return the tick that is meant by its number, or by a time in seconds; None for now."""
    return tick_of(loop, at) if isinstance(at, float) else at

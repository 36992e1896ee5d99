"""Frames of the past: what a session was at an earlier tick, without running anything again."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType

from lrp_jupyter.interpreter.by_path import ByPath
from lrp_jupyter.interpreter.facts import Entered, Faulted, Fired
from lrp_jupyter.interpreter.history import History
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.interpreter.rendering import of_type, render
from lrp_jupyter.interpreter.tree import Count
from lrp_jupyter.language.program import Element, Path
from lrp_jupyter.live.running.frame import Frame
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.running.values import numbers_of
from lrp_jupyter.live.why.earlier_names import Names


def frame_at(loop: Loop, tick: int) -> Frame:
    """Return the frame of a tick; raise ValueError if it is not remembered."""
    interpreter, bridge = loop.interpreter, loop.bridge
    history = interpreter.history
    least = interpreter.tick - min(len(loop.record.moments), len(history.ticks)) + 1
    if not least <= tick <= interpreter.tick:
        raise ValueError(history.refusal(tick, least))
    state = history.state(tick)
    variables = state.variables
    texts = {path: render(value, of_type) for path, value in variables.items()}  # others may have changed
    time, moment, sensed, _ = loop.record.moment(tick)
    visits, firings = _counts_at(interpreter, tick)
    after = loop.record.moment(tick + 1).world if tick < interpreter.tick else bridge.moment()
    return replace(
        loop.make_frame(),
        status="paused",
        reason=f"Looking at {time:.1f} s, {loop.timing.now - time:.1f} s ago.",
        tick=tick,
        time=time,
        active=state.active,
        values=ByPath(variables, state.program),
        variables=ByPath(texts, state.program),
        numbers=ByPath(numbers_of(variables.items()), state.program),
        outdated={},
        visits=MappingProxyType({path: times for path, (times, _) in visits.items()}),
        visited_at=MappingProxyType({path: last for path, (_, last) in visits.items()}),
        fired=MappingProxyType({path: times for path, (times, _) in firings.items()}),
        fired_at=MappingProxyType({path: last for path, (_, last) in firings.items()}),
        events=MappingProxyType({}),
        countdowns=MappingProxyType(state.countdowns),
        issues=tuple(_issues_at(history, tick, interpreter.issues)),
        program=state.program,
        readings=loop.record.readings_of(sensed),
        robot=None if (world := bridge.simulated) is None else world.picture_after(moment, after),
        hung=None,
    )


def animation_of(loop: Loop, begin: int | None, end: int | None) -> Callable[[], str] | None:
    """Return a function that draws the remembered run, or some ticks of it; None for a robot without a world.

    Raises ValueError: a tick is not remembered, or the end is before the beginning.
    Raises BridgeError: another world was loaded in between, or the world cannot be reproduced that far back.
    """
    last, count = loop.interpreter.tick, len(loop.record.moments)
    first = last - count + 1
    for tick in (begin, end):
        if tick is not None and not first <= tick <= last:
            raise ValueError(loop.interpreter.history.refusal(tick, first))
    if begin is not None and end is not None and end < begin:
        raise ValueError(f"The end, tick {end}, is before the beginning, tick {begin}.")
    moments = [each.world for each in loop.record.moments]
    moments.append(loop.bridge.moment())
    final = moments[-1 if end is None else end - first + 1]
    starts = moments if begin is None else [moments[begin - first]]
    return None if (world := loop.bridge.simulated) is None else world.animation(starts, final)


def tick_of(loop: Loop, time: float) -> int:
    """Return the last tick that was not after a time of the run; raise ValueError if it is not recorded."""
    if not time >= 0:
        raise ValueError(f"A time is a number of seconds of the run, 0 or more, not {time:g}.")
    if time > loop.timing.now + 1e-9:
        raise ValueError(f"{time:g} s is later than the run, which is at {loop.timing.now:g} s.")
    moments = loop.record.moments
    count = bisect_right(range(len(moments)), time + 1e-9, key=lambda index: moments[index].time)
    tick = loop.interpreter.tick - len(moments) + count
    history = loop.interpreter.history
    first = history.ticks.start
    if tick < first and 1 < first <= loop.interpreter.tick:
        raise ValueError(f"{time:g} s is not remembered. Ask about {history.time(first):g} s or later.")
    return max(tick, first)


def _counts_at(
    interpreter: Interpreter, tick: int
) -> tuple[dict[Path, tuple[int, int]], dict[Path, tuple[int, int]]]:
    """Return how often states were entered and transitions fired up to a tick, and in which tick last."""
    history, names = interpreter.history, Names(interpreter.moves, tick)
    ticks: dict[str, dict[Path, list[float]]] = {"state": {}, "transition": {}}
    for when, fact in history.told():
        if isinstance(fact, (Fired, Entered)):
            ticks["state"].setdefault(names.of("state", fact.state, when), []).append(when)
        if isinstance(fact, Fired):
            path = names.of("transition", fact.transition.path, when)
            ticks["transition"].setdefault(path, []).append(when)

    def until(kind: str, present: Mapping[Path, Count]) -> dict[Path, tuple[int, int]]:
        now = {names.of(kind, path, math.inf): count for path, count in present.items()}
        counts = {}
        for path in now.keys() | ticks[kind].keys():
            known = ticks[kind].get(path, [])
            here = bisect_right(known, tick)
            times = now[path].times - (len(known) - here) if path in now else here
            if times > 0:
                counts[path] = times, int(known[here - 1]) if here else min(now[path].tick, tick)
        return counts

    return until("state", interpreter.visits), until("transition", interpreter.firings)


def _issues_at(history: History, tick: int, issues: Iterable[Issue]) -> Iterable[Issue]:
    """Yield the issues that had occurred by a tick, in their recorded condition at that tick."""
    ticks: dict[tuple[Element, str], list[float]] = {}
    for when, fact in history.told():
        if isinstance(fact, Faulted):
            ticks.setdefault((fact.element, fact.kind), []).append(when)
    for issue in issues:
        if issue.first_tick > tick:
            continue
        known = ticks.get((issue.element, issue.kind), [])
        here = bisect_right(known, tick)
        if here == len(known):
            yield issue
        else:
            last = int(known[here - 1]) if here else issue.first_tick
            yield replace(
                issue, last_tick=last, count=max(1, issue.count - len(known) + here), resolved=False
            )

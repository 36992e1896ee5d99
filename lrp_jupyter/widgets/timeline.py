"""The messages of the timeline: what happened, look at an earlier moment, run on from there, what if."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Annotated

from lrp_jupyter.language.program import path_text
from lrp_jupyter.live.plots import Plot
from lrp_jupyter.live.timeline import Happening, TimelineCursor
from lrp_jupyter.live.what_if import Course
from lrp_jupyter.widgets.codec import Between
from lrp_jupyter.widgets.commands import INTERRUPTING, Applied
from lrp_jupyter.widgets.messages import OpenProgram, act, question
from lrp_jupyter.widgets.places import id_of
from lrp_jupyter.widgets.protocol import CourseView, HappeningView, PlotView, TimelineView, WhatIfView


@question("timeline")
def timeline(opened: OpenProgram, epoch: int, tick: int, plots: dict[str, int] | None = None) -> TimelineView:
    """Ask what happened since a tick that the page knows, in the run of this `epoch`, 0 for none.

    `plots` are the names to plot, such as ``robot.light.data`` or ``follower/lightlim``, each with the tick
    up to which the page has its samples.
    """
    since = TimelineCursor(epoch - 1, tick) if epoch else None
    told = opened.session.timeline(since, plots)
    return {
        "epoch": told.epoch + 1,
        "first": told.first,
        "last": told.last,
        "begin": told.begin,
        "end": told.end,
        "kept": told.kept,
        "happenings": _happening_views(told.happenings),
        "plots": [_plot_view(plot) for plot in told.plots],
        "names": list(told.names),
    }


@act(is_noted=False)
def look(opened: OpenProgram, tick: int | None = None, time: float | None = None) -> Applied:
    """Show an earlier moment, by its tick or its time in seconds; without both, show the present again."""
    session, looking = opened.session, opened.looking
    at: int | float | None = tick
    if tick is not None:
        session.looked("playhead", f"tick {tick}")
    elif time is not None:
        at = float(time)  # a page writes whole numbers without a point
        session.looked("playhead", f"{time:g} s")
    else:
        session.looked("playhead", "now")

    def show() -> None:
        if at is None:
            resumed = looking.back(session)
            if resumed is not None:
                resumed.result()
        else:
            looking.look(session, at)

    return opened.work(show)


@act(INTERRUPTING)
def run_from(opened: OpenProgram) -> Applied:
    """Go back to the moment looked at, and run on from there; with the edited program, if it was edited."""
    return opened.work(partial(opened.looking.run_on, opened.session))


@question("what_if", 30.0)  # a long run is repeated up to that moment, and the page asks once
def what_if(opened: OpenProgram, seconds: Annotated[float, Between(0.1, 600)]) -> WhatIfView:
    """Ask how the present program goes on from the moment looked at, or from now, for some seconds."""
    session = opened.session
    answer = session.what_if(opened.looking.tick(session), seconds=seconds)
    difference, touch = answer.divergence, answer.changed.touch
    return {
        "tick": answer.tick,
        "begin": answer.begin,
        "end": answer.end,
        "recorded": _course_view(answer.recorded),
        "changed": _course_view(answer.changed),
        "divergence": None
        if difference is None
        else {"tick": difference.tick, "time": difference.time, "text": difference.text},
        "collision": "" if touch is None else str(touch),
        "collision_at": None if touch is None else touch.time,
        "open_loop": answer.open_loop,
    }


def _happening_views(happenings: Iterable[Happening]) -> list[HappeningView]:
    return [
        {
            "tick": each.tick,
            "time": round(each.time, 3),
            "kind": each.kind,
            "lane": path_text(each.lane),
            "state": path_text(each.state),
            "by": id_of("transition", each.by) if each.by and each.kind == "entered" else path_text(each.by),
            "text": each.text,
        }
        for each in happenings
    ]


def _course_view(course: Course) -> CourseView:
    return {
        "happenings": _happening_views(course.happenings),
        "way": _rounded(course.way),
        "others": [_rounded(way) for way in course.others.values()],
        "solids": _rounded((index, *pose) for index, pose in course.solids),
    }


def _rounded(rows: Iterable[Iterable[float]]) -> list[list[float]]:
    return [[round(number, 4) for number in row] for row in rows]


def _plot_view(plot: Plot) -> PlotView:
    return {
        "name": plot.name,
        "kind": plot.kind,
        "times": [round(time, 3) for time in plot.times],
        "values": list(plot.values),
        "thresholds": [{"text": each.text, "values": list(each.values)} for each in plot.thresholds],
    }

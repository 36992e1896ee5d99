"""What a view may see of a session, and what of that changed since it looked last.

A *look* is a mapping with the fields of a `Frame` message, each in full. A view gets the difference of
the look it was sent last and the present one, so it may miss any number of looks between the two.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from lrp_jupyter.graph.paths import Paths
from lrp_jupyter.interpreter.frame import Frame
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.program import Path, Program, path_text
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.paths import id_of
from lrp_jupyter.widgets.protocol import RestartView
from lrp_jupyter.widgets.telling import bridge_view, issue_view, member_values, panel_view, value_view

__all__ = ["PRINTED", "Look", "Sight", "changes", "is_urgent"]

Look = Mapping[str, Any]

PRINTED = 500
"""Lines of output that a view is told at most."""

_MERGED = ("entered", "fired", "variables", "events", "members", "layouts")
_CALM = {"tick", "time", "rate", "speed", "members", "variables", "printed"}


class Sight:
    """Makes looks of one session. Used by one thread."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._program: Program | None = None
        self._paths = Paths(Program())
        self._frame: Frame | None = None
        self._of_frame: dict[str, Any] = {}
        self._entered: dict[str, tuple[int, int]] = {}  # counts, and the tick in which they were noticed
        self._restarts = 0
        self._restart: RestartView = {"count": 0, "tick": 0, "reason": ""}
        self._issues: dict[tuple[int, str, object, int], int] = {}
        self._told: dict[int, tuple[Issue, int, dict[str, Any]]] = {}

    def look(self, revision: int, **more: Any) -> dict[str, Any]:
        """Look at the session as it is now; `revision` is that of the text that runs."""
        session = self._session
        frame = session.frame
        if frame.program is not self._program:
            self._program, self._paths = frame.program, Paths(frame.program)
            self._frame = None
        if frame is not self._frame or self._of_frame["revision"] != revision:
            self._frame, self._of_frame = frame, self._look_at(frame, revision)
        return {
            **self._of_frame,
            "printed": session.output.count,
            "members": member_values(session.bridge),
            "hung": frame.hung and asdict(frame.hung),
            "bridge": bridge_view(session.bridge),
            "panel": panel_view(session.bridge),
            **more,
        }

    def _look_at(self, frame: Frame, revision: int) -> dict[str, Any]:
        paths = self._paths
        if frame.restarts != self._restarts:
            if frame.restart_reason != "reset":  # that was a person's wish, and is no news
                count = self._restart["count"] + frame.restarts - self._restarts
                self._restart = {"count": count, "tick": frame.tick, "reason": frame.restart_reason}
            self._restarts = frame.restarts
        return {
            "status": frame.status,
            "reason": frame.reason,
            "tick": frame.tick,
            "time": round(frame.time, 3),
            "rate": {"wanted": frame.rate, "achieved": round(frame.achieved_rate, 1)},
            "speed": {
                "wanted": frame.speed if math.isfinite(frame.speed) else 0,
                "achieved": round(frame.achieved_speed, 2),
            },
            "revision": revision,
            "active": [path_text(path) for path in frame.active],
            "lit": paths.lit(frame.active),
            "entered": self._counts_of_entries(frame),
            "fired": self._counts_of_firings(frame),
            "variables": {
                path_text(paths.member(path)): value_view(text, frame.numbers.get(path))
                for path, text in frame.variables.items()
            },
            "events": {path_text(path): value for path, value in frame.events.items()},
            "issues": self._list_issues(frame, revision),
            "restart": self._restart,
        }

    def _counts_of_entries(self, frame: Frame) -> dict[str, Any]:
        counts: dict[str, int] = {}
        for path, count in frame.visits.items():
            name = path_text(self._paths.member(path))
            counts[name] = counts.get(name, 0) + count
        for name, count in counts.items():
            if self._entered.get(name, (0, 0))[0] != count:
                self._entered[name] = count, frame.tick
        return {name: {"count": count, "tick": self._entered[name][1]} for name, count in counts.items()}

    def _counts_of_firings(self, frame: Frame) -> dict[str, Any]:
        fired: dict[str, dict[str, int]] = {}
        for path, count in frame.fired.items():
            name = id_of("transition", self._where(path))
            known = fired.setdefault(name, {"count": 0, "tick": 0})
            known["count"] += count
            known["tick"] = max(known["tick"], frame.fired_at.get(path, 0))
        return fired

    def _where(self, spawned: Path) -> Path:
        return (*self._paths.machine(spawned[:-1]), spawned[-1])

    def _list_issues(self, frame: Frame, revision: int) -> dict[int, Any]:
        listed = {}
        for index, issue in enumerate(frame.issues):
            key = index, issue.kind, issue.element, issue.first_tick
            number = self._issues.setdefault(key, len(self._issues) + 1)
            known = self._told.get(number)
            if known is None or known[:2] != (issue, revision):
                view = dict(issue_view(number, issue, frame.program.text, revision))
                known = self._told[number] = issue, revision, view
            listed[number] = known[2]
        return listed


def changes(before: Look, now: Look, lines: Any = None) -> dict[str, Any]:
    """Give the fields of a `Frame` message that leads from one look to the next.

    Parameters
    ----------
    before, now : mapping
        `before` is empty for a view that has seen nothing.
    lines : callable, optional
        Gives the lines printed after the first so many, and the number of the first that is kept.
    """
    told: dict[str, Any] = {}
    for field, value in now.items():
        old = before.get(field)
        if field in before and old == value:
            continue
        if field in _MERGED:
            old = old or {}
            merged = {name: new for name, new in value.items() if name not in old or old[name] != new}
            merged.update({name: None for name in old if name not in value} if field == "variables" else {})
            if merged:
                told[field] = merged
        elif field == "issues":
            old = old or {}
            told["issues"] = [issue for number, issue in value.items() if old.get(number) != issue]
            gone = [number for number in old if number not in value]
            if gone:
                told["gone"] = gone
        elif field == "printed":
            if lines is not None and value > (old or 0):
                told["printed"] = lines(old or 0)
        else:
            told[field] = value
    return told


def is_urgent(told: Look) -> bool:
    """Whether a person should see these changes at once: not those that come with every tick."""
    return not told.keys() <= _CALM

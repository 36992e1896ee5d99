"""The view state of a session: everything that a view may show of it, and the difference of two of them.

A view gets the difference of the view state it was sent last and the present one, so it may miss any number
of states between the two.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import is_dataclass
from typing import Any, get_args

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.guarding.safety import OF_COMMANDS, Notice
from lrp_jupyter.bridges.members import Member
from lrp_jupyter.bridges.tasks import TaskState
from lrp_jupyter.codes import FINDINGS
from lrp_jupyter.errors import NoDataYet, StaleData
from lrp_jupyter.graph.layout import fit_tags
from lrp_jupyter.graph.state_graph import DefinedPaths
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.interpreter.rendering import render
from lrp_jupyter.interpreter.variables import Outdated
from lrp_jupyter.language.lookup import line_of_element
from lrp_jupyter.language.program import Finding, Program, path_text
from lrp_jupyter.language.successors import Successors
from lrp_jupyter.live.predicted import finding_of
from lrp_jupyter.live.running.breakpoint import Breakpoint
from lrp_jupyter.live.running.frame import Frame, Hit
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.text.finding_views import finding_id
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.views.goal import Goal
from lrp_jupyter.widgets.views.instances import Instances
from lrp_jupyter.widgets.views.layouts import Layouts
from lrp_jupyter.widgets.views.shown_moment import MomentShown
from lrp_jupyter.widgets.views.shown_runs import ShownRuns
from lrp_jupyter.widgets.views.shown_search import ShownSearch
from lrp_jupyter.widgets.wire.packing import as_fields
from lrp_jupyter.widgets.wire.page_places import id_of, offset_of, range_of
from lrp_jupyter.widgets.wire.protocol import (
    BreakpointView,
    BridgeView,
    ElementKind,
    HitView,
    IssueView,
    MachineItem,
    MemberView,
    MovedElement,
    OutdatedView,
    ProgramView,
    RestartView,
    TextRange,
    ViewState,
)

PRINTED = 500
"""Lines of output that a view is sent at most."""
RESTARTS = 20
"""The last restarts, which a view lists."""
_TIME = {"tick", "time", "rate", "achieved_rate", "speed", "achieved_speed"}
_CALM = _TIME | {"countdowns", "members", "variables", "printed", "hands", "criteria"}
_DEEPEST = 2  # levels of fields of a reading that are listed


class ViewStates:
    """Creates the view states of one session. Used by one thread at a time."""

    def __init__(
        self,
        session: Session,
        saver: Saver,
        layouts: Layouts,
        runs: ShownRuns,
        search: ShownSearch,
        goal: Goal | None = None,
    ) -> None:
        self._goal = goal
        self._runs = runs
        self._search = search
        self._session = session
        self._texts = saver.texts
        self._saver = saver
        self._layouts = layouts
        self._program = Program()
        self._paths, self._instances = DefinedPaths(self._program), Instances(self._program)
        self._shown = Frame()
        self._program_view = program_view(self._shown.program)
        self._moved: dict[str, list[MovedElement]] = {}
        self._restarted = 0
        self._restarts: dict[str, RestartView] = {}
        self._numbers: dict[tuple[object, ...], int] = {}  # of issues, from 1
        self._checked: tuple[str, tuple[Finding, ...]] = "", ()  # the running text, and what was found in it
        self._issue_views: dict[int, tuple[object, IssueView]] = {}
        self._made_of: tuple[object, object] = None, None
        self._breakpoint_views: dict[str, BreakpointView] = {}
        self._printed: tuple[int, dict[str, str]] = 0, {}

    def current(self, what: MomentShown, waits: bool = False) -> ViewState:
        """Return what a view may show of a moment: the program is the newest one that is laid out."""
        session, texts, conditions = self._session, self._texts, self._texts.conditions
        shown, layouts = self._layouts.current
        frame, looking = what
        now = session.frame
        if frame.program is not self._program:
            self._program = frame.program
            self._paths, self._instances = DefinedPaths(frame.program), Instances(frame.program)
        if shown is not self._shown:
            view = program_view(shown.program)
            self._shown = shown
            self._moved = {str(revision): _moved_elements(each) for revision, each in shown.moved}
            if view != self._program_view:  # white space makes another program, and the same view
                self._program_view = view
        members = list(listed_members(session.bridge))
        return {
            "status": frame.status,
            "reason": frame.reason,
            "tick": frame.tick,
            "time": round(frame.time, 3),
            "rate": frame.rate,
            "achieved_rate": round(frame.achieved_rate, 1),
            "speed": frame.speed if math.isfinite(frame.speed) else 0,
            "achieved_speed": round(frame.achieved_speed, 2),
            "revision": texts.running_revision,
            "program": self._program_view,
            "layouts": dict(layouts),
            "moved": self._moved,
            "active": [path_text(path) for path in frame.active],
            "lit": self._paths.active_states(frame.active),
            "users": fit_tags(self._paths.users(frame.active), layouts.values()),
            "entered": {
                path_text(path): (count, frame.visited_at[path]) for path, count in frame.visits.items()
            },
            "fired": {
                id_of("transition", path): (count, frame.fired_at[path])
                for path, count in frame.fired.items()
            },
            "instances": self._instances.of(frame.active),
            "variables": {
                path_text(path): (text, _finite(frame.numbers.get(path)))
                for path, text in frame.variables.items()
            },
            "outdated": {path_text(path): _outdated_view(each) for path, each in frame.outdated.items()},
            "countdowns": {
                id_of("transition", path): (round(each.since, 3), each.delay)
                for path, each in frame.countdowns.items()
            },
            "events": {path_text(path): value for path, value in frame.events.items() if value is not None},
            "members": _member_values(members, frame.readings if looking else None),
            "issues": self._issues(frame),
            "printed": self._lines(),
            "restarts": self._last_restarts(frame),
            "hung": frame.hung,
            "breakpoints": self._breakpoints(now.breakpoints, now.program),
            "paused_by": _hit_view(now.paused_by),
            "bridge": _bridge_view(session.bridge, members),
            "panel": session.bridge.panel(),
            "settings": {
                "edits": conditions.edits,
                "graph": conditions.graph,
                "quiet": conditions.quiet,
                "lock": conditions.lock,
                "log": session.log,
                "on_active_edit": "keep" if session.on_active_edit == "keep" else "restart",
                "pause_on_issue": session.on_issue == "pause",
            },
            "conflict": texts.conflict,
            "cell": texts.in_cell,
            "looking": looking,
            "unkept": self._saver.problem,
            "late": _late(session) if waits else "",
            "hands": texts.hands(),
            "goal": None if self._goal is None else self._goal.view(session, texts.text),
            "criteria": [] if self._goal is None else self._goal.criteria(),
            "attempts": {} if self._goal is None else self._goal.attempts(),
            "runs": self._runs.view(session, "" if self._goal is None else self._goal.task.name),
            "kept_runs": self._runs.kept(),
            "search": self._search.view(session, texts.text, self._goal),
        }

    def _last_restarts(self, frame: Frame) -> dict[str, RestartView]:
        more, self._restarted = frame.restarts - self._restarted, frame.restarts
        if more > 0 and frame.restart_reason != "reset":  # the user requested that one
            number = int(next(reversed(self._restarts), "0")) + more
            last: RestartView = {"tick": frame.tick, "reason": frame.restart_reason}
            self._restarts = dict([*self._restarts.items(), (str(number), last)][-RESTARTS:])
        return self._restarts

    def _issues(self, frame: Frame) -> dict[str, IssueView]:
        texts = self._texts
        text = frame.program.text
        if texts.text == text or self._checked[0] != text:
            self._checked = text, texts.judgement.findings if texts.text == text else ()
        findings = self._checked[1]
        views = {}
        key: tuple[object, ...]
        for index, issue in enumerate(frame.issues):
            key = index, issue.kind, issue.element, issue.first_tick
            number = self._numbers.setdefault(key, len(self._numbers) + 1)
            made_of = issue, text, findings
            known, view = self._issue_views.get(number, (None, None))
            if view is None or known != made_of:
                view = _issue_view(number, issue, text, findings)
                self._issue_views[number] = made_of, view
            views[str(number)] = view
        for notice in self._session.bridge.safety.notices:
            if notice.kind in OF_COMMANDS and notice.first.tick <= frame.tick:
                key = notice.kind, notice.about, notice.first
                number = self._numbers.setdefault(key, len(self._numbers) + 1)
                views[str(number)] = _notice_view(number, notice, frame)
        return views

    def _breakpoints(self, known: tuple[Breakpoint, ...], program: Program) -> dict[str, BreakpointView]:
        if (known, program.text) != self._made_of:
            self._made_of = known, program.text
            self._breakpoint_views = {str(each.number): _breakpoint_view(each, program) for each in known}
        return self._breakpoint_views

    def _lines(self) -> dict[str, str]:
        count, _ = self._printed
        if self._session.output.count != count:
            total, lines = self._session.output.since(0)
            lines = lines[-PRINTED:]
            first = total - len(lines)
            self._printed = total, {str(first + index): line for index, line in enumerate(lines)}
        return self._printed[1]


def difference(before: Mapping[str, Any], now: ViewState) -> dict[str, Any]:
    """Return the fields of a `FrameMessage` that lead from one view state, or an empty one, to the next.

    Of an object only the entries that changed, None for one that is gone; anything else in full.
    """
    changes: dict[str, Any] = {}
    for field, value in now.items():
        old = before.get(field)
        if field in before and old == value:
            continue
        if is_dataclass(old) and is_dataclass(value):
            old, value = as_fields(old), as_fields(value)
        if isinstance(old, dict) and isinstance(value, dict):
            gone = dict.fromkeys(old.keys() - value.keys())
            value = {name: new for name, new in value.items() if name not in old or old[name] != new} | gone
        changes[field] = value
    return changes


def last_fired(state: ViewState) -> list[str]:
    """Return the transitions that fired last: one of each machine."""
    last: dict[str, tuple[int, str]] = {}
    for name, (_, tick) in state["fired"].items():
        machine = name.partition(":")[0]
        last[machine] = max(last.get(machine, (0, "")), (tick, name))
    return [name for _, name in last.values()]


def is_urgent(changes: Mapping[str, Any]) -> bool:
    """Return whether the user should see these changes at once, unlike those that come with every tick."""
    return not changes.keys() <= _CALM


def is_time(changes: Mapping[str, Any]) -> bool:
    """Return whether nothing has changed but the time, if that."""
    return changes.keys() <= _TIME


# -- from the package's values to plain data ---------------------------------------------------------


def _late(session: Session) -> str:
    """Return what it means that messages of a page wait for a cell that runs."""
    waits = "While a cell runs, Pause and Stop wait for its end: nothing in a page reaches a busy kernel here"
    if not session.bridge.hardware:
        return f"{waits}. {_SUBSHELLS}"
    watched = "" if session.dead_man is None else _WATCHED.format(session.dead_man)
    return f"{waits}, and the robot goes on.{watched} Have another way to stop it at hand. {_SUBSHELLS}"


_WATCHED = " After {:g} s in which no page reaches it, the robot stops and the program pauses."
_SUBSHELLS = (
    'In JupyterLab, the setting "Kernel Comms over subshells" changes that, with ipykernel 7 or newer.'
)


def _hit_view(hit: object) -> HitView | None:
    return {"number": hit.number, "text": str(hit), "hits": hit.count} if isinstance(hit, Hit) else None


def _breakpoint_view(each: Breakpoint, program: Program) -> BreakpointView:
    element = each.element
    return {
        "kind": each.kind,
        "path": id_of(element.kind, element.path) if element is not None else "",
        "name": each.name,
        "expression": each.expression,
        "machine": path_text(each.machine),
        "instance": path_text(each.instance),
        "enabled": each.enabled,
        "hits": each.hits,
        "after": each.after,
        "dormant": each.dormant,
        "problem": each.problem,
        "line": 0 if element is None else line_of_element(program, element),
    }


def program_view(program: Program) -> ProgramView:
    """Return a program without its blocks."""
    machines: dict[str, MachineItem] = {}
    for path, machine in program.walk():
        text = path_text(path)
        if text in machines:
            continue
        states = {path_text((*path, state.name)): state for state in reversed(machine.states)}
        machines[text] = {
            "path": text,
            "parent": path_text(path[:-1]) if len(path) > 1 else None,
            "states": [
                {"path": name, "machines": [f"{name}/{inner.name}" for inner in state.machines]}
                for name, state in reversed(states.items())
            ],
            "transitions": [
                {
                    "id": f"{text}:{id_}",
                    "kind": transition.kind,
                    "trigger": transition.trigger_text,
                    "source": transition.source_text,
                    "destination": str(transition.destination),
                }
                for id_, transition in zip(machine.ids, machine.transitions, strict=True)
            ],
            "variables": _names(f"{text}/", machine.variables),
            "events": _names(f"{text}/", machine.events),
        }
    return {
        "variables": _names("", program.variables),
        "events": _names("", program.events),
        "machines": list(machines.values()),
        "main": program.main,
    }


def _moved_elements(successors: Successors) -> list[MovedElement]:
    """Return the elements that a page may have remembered by another path."""
    return [
        {"kind": kind, "old": id_of(kind, old.path), "new": id_of(kind, new.path)}
        for kind in get_args(ElementKind)
        for old, new in successors.moved.items()
        if old.kind == kind and old != new
    ]


def _names(prefix: str, nouns: tuple[Any, ...]) -> list[str]:
    return list(dict.fromkeys(f"{prefix}{noun.name}" for noun in nouns))


def _issue_view(number: int, issue: Issue, text: str, findings: Iterable[Finding]) -> IssueView:
    place = _word_at(text, issue.line, issue.column)
    same = None if issue.resolved else finding_of(issue, findings)
    return {
        "id": number,
        "code": issue.code,
        "severity": FINDINGS[issue.code].severity,
        "kind": issue.kind,
        "element": str(issue.element),
        "message": issue.message,
        "range": place,
        "finding": "" if same is None else finding_id(same),
        "traceback": issue.traceback,
        "first_tick": issue.first_tick,
        "last_tick": issue.last_tick,
        "count": issue.count,
        "resolved": issue.resolved,
        "instances": [path_text(path) for path in issue.instances],
    }


_OVER = 1.0  # s after which something that has not happened again is over


def _notice_view(number: int, notice: Notice, frame: Frame) -> IssueView:
    """Return a notice of the robot's safety as an issue, in the line of the command that it is about."""
    block, line, text = notice.first.block, notice.first.line, frame.program.text
    lines = text.splitlines()
    method = notice.about.partition(" ")[0].rpartition(".")[2]
    column = lines[line - 1].find(method) + 1 if 0 < line <= len(lines) else 0
    return {
        "id": number,
        "code": "",
        "severity": "warning",
        "kind": notice.kind,
        "element": block,
        "message": notice.text,
        "range": _word_at(text, line, max(1, column)) if line else None,
        "finding": "",
        "traceback": "",
        "first_tick": notice.first.tick,
        "last_tick": notice.last.tick,
        "count": notice.count,
        "resolved": frame.time - notice.now > _OVER,
        "instances": [],
    }


_WORD = re.compile(r"\w+|\([^()\[\]\n]*\)?|[^\s\w]")


def _word_at(text: str, line: int, column: int) -> TextRange:
    """Return the range of the word, or of the short form, that begins at a place."""
    start = offset_of(text, line, column)
    word = _WORD.match(text, start)
    return range_of(text, start, word.end() if word else start)


def _finite(number: float | None) -> float | None:
    """Return a number if JSON can represent it."""
    return number if number is not None and math.isfinite(number) else None


def _outdated_view(outdated: Outdated) -> OutdatedView:
    computed = f"Computed from `{outdated.source[-1]}` at {outdated.computed:.1f} s."
    return {"computed": computed, "initial": outdated.initial}


def _bridge_view(bridge: Bridge, members: Iterable[Member]) -> BridgeView:
    status = bridge.status
    return {
        "name": bridge.name,
        "status": status.state.value,
        "sentence": status.sentence,
        "hardware": bridge.hardware,
        "armed": bridge.safety.armed,
        "failsafe": bridge.failsafe,
        "members": [member_view(member) for member in members],
    }


def _member_values(members: Iterable[Member], past: Mapping[str, object] | None) -> dict[str, str]:
    """Return the last readings of the robot and the states of its tasks, or those of the past, as text."""

    def text(member: Member) -> str:
        if past is not None and member.name in past:
            return _short(past[member.name])
        if member.kind == "task" and past is not None:
            return ""  # it was not asked for then
        return member.absence or _short(member.value)

    shown = [each for each in members if each.kind == "task" or (each.kind == "variable" and not each.fields)]
    return {member.name: text(member) for member in shown}


def listed_members(bridge: Bridge) -> Iterator[Member]:
    """Yield the members of `robot`, and the fields of its readings."""

    def inside(member: Member, depth: int) -> Iterator[Member]:
        yield member
        # the arguments of a command cannot be read
        for field in member.fields if depth and member.kind == "variable" else ():
            yield from inside(field, depth - 1)

    for member in bridge.members():
        yield from inside(member, _DEEPEST)


def member_view(member: Member) -> MemberView:
    """Return what views know of a member of `robot`, besides its value."""
    return {
        "name": member.name,
        "kind": member.kind,
        "type": member.type,
        "unit": member.unit,
        "doc": member.doc,
        "insert": f"robot.{member.name}{member.signature}",
    }


def _short(value: object) -> str:
    if isinstance(value, NoDataYet):
        return "stale" if isinstance(value, StaleData) else "waiting"
    return str(value) if isinstance(value, TaskState) else render(value)

"""What the package knows, told in the nouns of messages: programs, findings, issues, bridges, values."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any, cast

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.members import Member
from lrp_jupyter.interpreter.frame import render
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.diff import diff
from lrp_jupyter.language.program import Finding, Program, path_text
from lrp_jupyter.widgets.protocol import (
    BridgeView,
    Difference,
    FindingView,
    IssueView,
    MachineItem,
    MemberView,
    PanelView,
    ProgramView,
    Range,
    Severity,
    ValueView,
    offset_of,
    range_of,
)

__all__ = [
    "bridge_view",
    "difference_view",
    "finding_view",
    "issue_view",
    "member_values",
    "panel_view",
    "program_view",
    "value_view",
]

_DEEPEST = 2  # levels of fields of a reading that are listed
_MILD: Mapping[str, Severity] = {"no data yet": "hint", "defined twice": "warning"}


def program_view(program: Program) -> ProgramView:
    """Tell a program without its blocks."""
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
                    "id": f"{text}:{label}",
                    "kind": transition.kind,
                    "trigger": transition.trigger_text,
                    "source": transition.source_text,
                    "destination": str(transition.destination),
                }
                for label, transition in zip(machine.labels, machine.transitions, strict=True)
            ],
            "variables": _names(f"{text}/", machine.variables),
            "events": _names(f"{text}/", machine.events),
        }
    return {
        "variables": _names("", program.variables),
        "events": _names("", program.events),
        "machines": list(machines.values()),
    }


def _names(prefix: str, nouns: tuple[Any, ...]) -> list[str]:
    return list(dict.fromkeys(f"{prefix}{noun.name}" for noun in nouns))


def finding_view(finding: Finding, text: str) -> FindingView:
    """Tell a finding of the checks about a text."""
    fix = finding.fix
    return {
        "code": finding.code,
        "severity": finding.severity,
        "message": finding.message,
        "range": {
            "line": finding.line,
            "column": finding.column,
            "end_line": finding.end_line,
            "end_column": finding.end_column,
        },
        "fix": None
        if fix is None
        else {
            "title": fix.title,
            "edits": [{"range": range_of(text, e.start, e.end), "text": e.text} for e in fix.edits],
        },
    }


def issue_view(number: int, issue: Issue, text: str, revision: int) -> IssueView:
    """Tell a fault of the run; `text` is the one that runs."""
    return {
        "id": number,
        "code": issue.code,
        "severity": _MILD.get(issue.kind, "error"),
        "kind": issue.kind,
        "element": str(issue.element),
        "message": issue.message,
        "revision": revision,
        "range": _word_at(text, issue.line, issue.column),
        "traceback": issue.traceback,
        "first_tick": issue.first_tick,
        "last_tick": issue.last_tick,
        "count": issue.count,
        "resolved": issue.resolved,
    }


_WORD = re.compile(r"\w+|\([^()\[\]\n]*\)?|[^\s\w]")


def _word_at(text: str, line: int, column: int) -> Range:
    """Give the range of the word, or of the short form, that begins at a place."""
    start = offset_of(text, line, column)
    word = _WORD.match(text, start)
    return range_of(text, start, word.end() if word else start)


def difference_view(old: Program, new: Program) -> Difference:
    """Tell what an edit would change."""
    changes = diff(old, new)
    return {
        "added": [str(element) for element in changes.added],
        "removed": [str(element) for element in changes.removed],
        "changed": [str(element) for element in changes.changed],
        "moved": [str(element) for element in changes.moved],
    }


def value_view(text: str, number: float | None) -> ValueView:
    """Tell a value, as a number too where JSON has it."""
    return {"text": text, "number": number if number is not None and math.isfinite(number) else None}


def bridge_view(bridge: Bridge) -> BridgeView:
    """Tell how a bridge stands to its robot, and what `robot` offers."""
    status = bridge.status
    return {
        "name": bridge.name,
        "status": status.state.value,
        "sentence": status.sentence,
        "hardware": bridge.hardware,
        "armed": bridge.safety.armed,
        "members": [_member_view(member) for member in _members(bridge)],
    }


def member_values(bridge: Bridge) -> dict[str, str]:
    """Give the last reading of every variable of the robot, as text."""
    return {
        member.name: "waiting" if member.value is None else _short(member.value)
        for member in _members(bridge)
        if member.kind == "variable" and not member.fields
    }


def _members(bridge: Bridge) -> Iterator[Member]:
    def inside(member: Member, depth: int) -> Iterator[Member]:
        yield member
        # what a command takes is nothing to read
        for field in member.fields if depth and member.kind == "variable" else ():
            yield from inside(field, depth - 1)

    for member in bridge.members():
        yield from inside(member, _DEEPEST)


def _member_view(member: Member) -> MemberView:
    return {
        "name": member.name,
        "kind": member.kind,
        "type": member.type,
        "unit": member.unit,
        "doc": member.doc,
        "insert": f"robot.{member.name}{member.signature}",
    }


def _short(value: object) -> str:
    return format(value, ".4g") if isinstance(value, float) else render(value)


def panel_view(bridge: Bridge) -> PanelView | None:
    """Give the bridge's panel as it is now."""
    panel = bridge.panel()
    return None if panel is None else cast(PanelView, panel.as_dict())

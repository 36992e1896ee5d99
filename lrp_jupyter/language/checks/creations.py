"""What is missing, created: edits offered beside a finding, because only the user knows what is meant.

A new form goes after the last one of its kind, and is indented like the forms around it.
"""

from __future__ import annotations

from lrp_jupyter.errors import MOST_FINDINGS, Fix
from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.program import Machine, State

__all__ = ["new_delay", "new_event", "new_machine", "new_spawn", "new_state", "new_variable"]


def new_state(report: Reporter, machine: Machine | None, name: str) -> Fix | None:
    """Return the fix that creates a state in a machine."""
    return _created(report, machine, f"(state {name})", f"state `{name}`")


def new_event(report: Reporter, machine: Machine | None, name: str) -> Fix | None:
    """Return the fix that creates an event in a machine, with a condition to be replaced."""
    return _created(report, machine, f"(event {name} [False])", f"event `{name}`")


def new_variable(report: Reporter, name: str) -> Fix | None:
    """Return the fix that creates a variable at the top level, with a value to be replaced."""
    return _created(report, None, f"(var {name} := [0])", f"variable `{name}`")


def new_delay(report: Reporter, name: str) -> Fix | None:
    """Return the fix that creates a variable at the top level that holds a second."""
    return _created(report, None, f"(var {name} := [1000])", f"variable `{name}`")


def new_machine(report: Reporter, state: State | None, name: str, start: str) -> Fix | None:
    """Return the fix that creates a machine with its start state, in a state or at the top level."""
    return _created(report, state, f"(machine {name} (state {start}))", f"machine `{name}`")


def new_spawn(report: Reporter, state: State | None, machine: str, start: str) -> Fix | None:
    """Return the fix that spawns a machine, when a state is entered or at the top level."""
    if not _has_room(report):
        return None
    sheet, form = report.sheet, f"(spawn {machine} {start})"
    edit = sheet.spawned_by(sheet.at(state.span.start), form) if state else sheet.added(sheet.root, form)
    return Fix(f"Add `{form}`", (edit,))


def _created(report: Reporter, around: Machine | State | None, form: str, what: str) -> Fix | None:
    if not _has_room(report):
        return None
    sheet = report.sheet
    edit = sheet.added(sheet.at(around.span.start) if around else sheet.root, form)
    return Fix(f"Create the {what}", (edit,))


def _has_room(report: Reporter) -> bool:
    """Return whether there is a text to edit, and this finding can still be listed."""
    return bool(report.program.text) and len(report.findings) < MOST_FINDINGS

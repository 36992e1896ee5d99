"""Edits that create what is missing: offered beside a finding, because only the user knows what is meant."""

from __future__ import annotations

from collections.abc import Callable
from keyword import iskeyword

from lrp_jupyter.errors import MOST_FINDINGS, Edit, Fix
from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.edits.form_places import Sheet, WrittenForm
from lrp_jupyter.language.program import Machine, State


def new_state(report: Reporter, machine: Machine | None, name: str) -> Fix | None:
    """Return the fix that creates a state in a machine."""
    return _created(report, machine, f"(state {name})", f"state `{name}`")


def new_event(report: Reporter, machine: Machine | None, name: str) -> Fix | None:
    """Return the fix that creates an event in a machine, with a condition to be replaced."""
    return _created(report, machine, f"(event {name} [False])", f"event `{name}`")


def new_variable(report: Reporter, name: str, value: int = 0, around: Machine | None = None) -> Fix | None:
    """Return the fix that creates a variable in a machine or at the top level, with a value to replace."""
    if iskeyword(name):
        return None
    return _created(report, around, f"(var {name} := [{value}])", f"variable `{name}`")


def new_machine(report: Reporter, state: State | None, name: str, start: str) -> Fix | None:
    """Return the fix that creates a machine with its start state, in a state or at the top level."""
    return _created(report, state, f"(machine {name} (state {start}))", f"machine `{name}`")


def new_spawn(report: Reporter, state: State | None, machine: str, start: str) -> Fix | None:
    """Return the fix that spawns a machine, when a state is entered or at the top level."""
    form = f"(spawn {machine} {start})"
    add = Sheet.added if state is None else Sheet.spawned_by
    return _fix(report, f"Add `{form}`", state, form, add)


def _created(report: Reporter, around: Machine | State | None, form: str, what: str) -> Fix | None:
    return _fix(report, f"Create the {what}", around, form, Sheet.added)


def _fix(
    report: Reporter,
    title: str,
    around: Machine | State | None,
    form: str,
    add: Callable[[Sheet, WrittenForm, str], Edit],
) -> Fix | None:
    """Return the fix that adds a form, if there is a text and this finding can still be listed."""
    if not report.program.text or len(report.findings) >= MOST_FINDINGS:
        return None
    try:
        sheet = report.sheet
        parent = sheet.root if around is None else sheet.at(around.span.start)
        if around is not None and parent.end != around.span.end:
            raise LookupError
        return Fix(title, (add(sheet, parent, form),))
    except LookupError:  # the program was put together from elements of other texts
        return None

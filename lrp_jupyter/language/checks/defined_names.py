"""2xx: names that are defined twice or hide others, and programs that spawn nothing."""

from __future__ import annotations

import builtins

from lrp_jupyter.language.checks.creations import new_spawn
from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.program import Edit, Fix, Machine, Name, Span, Transition, Variable, path_text
from lrp_jupyter.language.python.scanner import LINE_END
from lrp_jupyter.language.reading.forms import article
from lrp_jupyter.language.resolution import Resolution, Scope

BUILTINS = frozenset(dir(builtins))
_PROVIDED = {"robot": "the robot", "print": "the `print` that writes into the lab's output"}


def check_names(report: Reporter, names: Resolution) -> None:
    """Report what is wrong with the definitions of a program."""
    for element, scope, first, again in names.repeats:
        place = f" of `{path_text(scope.path)}`" if scope.path else ""
        fix = Fix("Remove it", (Edit(*again.span, ""),)) if again == first else None
        report.add(
            "LRP201",
            again.name.span,
            f"`{again.name}` is already {article(element.kind)} {element.kind}{place}, in line "
            f"{report.line(first.name.span)}, and only the first definition counts. "
            "Rename or remove this one.",
            fix,
        )
    for scope in names.scopes:
        for variable in scope.variables.values():
            _hiding(report, scope, variable)
        _colliding(report, scope)
    if not report.program.spawns and names.top.machines:
        _no_spawn(report)


def _hiding(report: Reporter, scope: Scope, variable: Variable) -> None:
    name = variable.name
    outer = scope.outer.visible.get(name) if scope.outer else None
    if outer and name not in _PROVIDED:
        line = report.line(outer.variables[name].name.span)
        message = f"The variable `{name}` hides the `{name}` in line {line}. Give one of them another name."
        report.add("LRP202", name.span, message)
    elif name in BUILTINS or name in _PROVIDED:
        what = _PROVIDED.get(name, f"Python's own `{name}`")
        message = f"The variable `{name}` hides {what} from all blocks here. Give it another name."
        report.add("LRP203" if name in _PROVIDED else "LRP204", name.span, message)


def _colliding(report: Reporter, scope: Scope) -> None:
    """Report transitions that edits can distinguish only by their order. Paper: §6.1, footnote 5."""
    seen: dict[object, Transition] = {}
    for transition in scope.transitions:
        first = seen.setdefault(transition.identity, transition)
        if first is not transition and first.trigger != transition.trigger:
            remedy = "another name" if transition.name else "a name"
            report.add(
                "LRP205",
                transition.span,
                f"Only the condition distinguishes this transition from the one in line "
                f"{report.line(first.span)}, so an edit may confuse the two. Give it {remedy}.",
            )


def _no_spawn(report: Reporter) -> None:
    """Report, at the first line, that nothing is spawned; where the start is certain, with a fix."""
    program = report.program
    machine: Machine = program.machines[0]
    begun = starts(machine)
    start = begun[0] if begun else machine.states[0].name if machine.states else Name("state")
    text = f"(spawn {machine.name} {start})"
    certain = len(program.machines) == len(begun) == 1
    fix = new_spawn(report, None, machine.name, start)
    report.add(
        "LRP206",
        Span(0, len(LINE_END.split(program.text, maxsplit=1)[0])),
        f"Nothing is spawned, so nothing runs. End the program with `{text}`.",
        fix if certain else None,
        creates=None if certain else fix,
    )


def starts(machine: Machine) -> list[Name]:
    """Return the states from which every state of a machine can be reached."""
    names = [state.name for state in machine.states]
    following = {
        str(name): {str(each.destination) for each in machine.transitions if each.leaves(name)} & set(names)
        for name in names[:_FEW]
    }

    def reached(name: str) -> int:
        found, waiting = {name}, [name]
        while waiting:
            new = following.get(waiting.pop(), set()) - found
            found |= new
            waiting += new
        return len(found)

    return [name for name in names[:_FEW] if reached(str(name)) == len(names)]


_FEW = 50  # states: of more, the first is suggested

"""Other initial values: ``--set search=0.5`` lets a variable begin with something else.

The program runs as if its text said so; the text itself, and every place in it, stays as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import NamedTuple

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.language.program import Block, Machine, Path, Program, State, Variable, path_text

__all__ = ["Assignment", "with_initials"]


class Assignment(NamedTuple):
    """A variable's path (or its name alone, where there is only one) and a Python expression."""

    variable: Path
    expression: str


def with_initials(program: Program, assignments: Sequence[Assignment]) -> Program:
    """Return the program with other initialisers.

    Raises
    ------
    UnknownElementError
        There is no such variable, or there are several of that name.
    """
    for variable, expression in assignments:
        path = _full_path(program, variable)

        def changed(old: Variable, text: str = expression) -> Variable:
            block = Block(text, old.initial.span, old.initial.line, old.initial.column, old.initial.prefix)
            return replace(old, initial=block)

        if len(path) == 1:
            program = replace(program, variables=_changed(program.variables, path[0], changed))
        else:
            program = replace(program, machines=_inside(program.machines, path, changed))
    return program


def _full_path(program: Program, wanted: Path) -> Path:
    known = list(_variables(program))
    if wanted in known:
        return wanted
    found = [path for path in known if path[-1:] == wanted]
    if len(found) == 1:
        return found[0]
    texts = [path_text(path) for path in (found or known)]
    name = path_text(wanted)
    if found:
        raise UnknownElementError(f"--set {name}: which one? There are {', '.join(texts)}.")
    close = get_close_matches(name, [*texts, *(path[-1] for path in known)], n=1)
    hint = f"did you mean `{close[0]}`?" if close else f"it has {', '.join(texts) or 'none'}."
    raise UnknownElementError(f"--set {name}: the program has no such variable; {hint}")


def _variables(program: Program) -> Iterator[Path]:
    yield from ((str(variable.name),) for variable in program.variables)
    for path, machine in program.walk():
        yield from ((*path, str(variable.name)) for variable in machine.variables)


Change = Callable[[Variable], Variable]


def _changed(variables: tuple[Variable, ...], name: str, change: Change) -> tuple[Variable, ...]:
    return tuple(change(each) if each.name == name else each for each in variables)


def _inside(machines: tuple[Machine, ...], path: Path, change: Change) -> tuple[Machine, ...]:
    name, *rest = path
    return tuple(_in_machine(each, tuple(rest), change) if each.name == name else each for each in machines)


def _in_machine(machine: Machine, path: Path, change: Change) -> Machine:
    if len(path) == 1:
        return replace(machine, variables=_changed(machine.variables, path[0], change))

    def in_state(state: State) -> State:
        if state.name != path[0]:
            return state
        return replace(state, machines=_inside(state.machines, path[1:], change))

    return replace(machine, states=tuple(map(in_state, machine.states)))

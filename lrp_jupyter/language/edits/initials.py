"""Other initial values of a program's variables, replaced in the text."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.lookup import as_defined, definition_of, find
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element, Path, Program, Variable
from lrp_jupyter.language.resolution import resolve


def with_initial(text: str, variable: str | Path, expression: str) -> str:
    """Return a text with another initialiser of a variable; raise LRPSyntaxError or UnknownElementError.

    It is the one in the ``spawn`` if the path is that of its machine, or if there is no other use of it.
    """
    program = parse(text)
    element = find(program, "variable", variable)
    found = _setting(program, element, as_path(variable)) or definition_of(program, element)
    assert isinstance(found, Variable)
    start, end = found.initial.span
    return f"{text[:start]}[{expression}]{text[end:]}"


def with_initialiser(program: Program, variable: str, expression: str) -> Program:
    """Return a program with another initialiser of a variable; its text stays.

    Raises UnknownElementError: there is no such variable, or there are several.
    """
    found = definition_of(program, find(program, "variable", variable))
    assert isinstance(found, Variable)
    new = replace(found, initial=replace(found.initial, text=expression))
    replaced: Program = _replaced(program, found, new)
    return replaced


def _replaced(part: Any, old: Variable, new: Variable) -> Any:
    """Return a program, or a part of it, with one variable replaced."""
    if part is old:
        return new
    names = [name for name in ("variables", "machines", "states") if hasattr(part, name)]
    changed = {name: tuple(_replaced(each, old, new) for each in getattr(part, name)) for name in names}
    return replace(part, **changed) if changed else part


def _setting(program: Program, element: Element, spawned: Path) -> Variable | None:
    """Return what initialises a variable in a spawn, by its path as spawned."""
    *where, name = element.path
    uses = [each for each in resolve(program).spawns if each.machine and each.machine.path == tuple(where)]
    spawner = as_defined(program, "state", spawned[:-2])
    chosen = [each for each in uses if each.spawner == spawner] if len(spawned) > 1 else []
    chosen = chosen or (uses if len(uses) == 1 else [])
    return next((each for use in chosen for each in use.noun.settings if each.name == name), None)

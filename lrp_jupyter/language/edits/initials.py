"""Other initial values of a program's variables, replaced in the text."""

from __future__ import annotations

from lrp_jupyter.language.lookup import definition_of, find
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, Variable


def with_initial(text: str, variable: str | Path, expression: str) -> str:
    """Return a text with the initialiser of a variable replaced by an expression.

    Raises LRPSyntaxError: the text is not a valid program.
    Raises UnknownElementError: there is no such variable, or several have that name.
    """
    program = parse(text)
    found = definition_of(program, find(program, "variable", variable))
    assert isinstance(found, Variable)
    start, end = found.initial.span
    return f"{text[:start]}[{expression}]{text[end:]}"

"""Other initial values of a program's variables, replaced in the text."""

from __future__ import annotations

from lrp_jupyter.language.lookup import definition_of, find
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, Variable


def with_initial(text: str, variable: str | Path, expression: str) -> str:
    """Return a text with another initialiser of a variable; raise LRPSyntaxError or UnknownElementError."""
    program = parse(text)
    found = definition_of(program, find(program, "variable", variable))
    assert isinstance(found, Variable)
    start, end = found.initial.span
    return f"{text[:start]}[{expression}]{text[end:]}"

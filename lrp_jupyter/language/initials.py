"""Other initial values of a program's variables: found by name or path, and replaced in the text."""

from __future__ import annotations

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Machine, Path, Program, Variable, path_text


def find_variable(program: Program, wanted: Path) -> tuple[Path, Variable]:
    """Return the variable of a path, or of a name that only one variable has, and its path.

    Raises UnknownElementError: there is none, or several have that name.
    """
    known = _variables(program)
    if wanted in known:
        return wanted, known[wanted]
    found = [path for path in known if path[-1:] == wanted]
    if len(found) == 1:
        return found[0], known[found[0]]
    texts = [path_text(path) for path in (found or known)]
    lines = (program.place(known[path].span.start)[0] for path in (found or known))
    listed = ", ".join(f"`{text}` (line {line})" for text, line in zip(texts, lines, strict=True))
    if found:
        raise UnknownElementError(f"Several variables have this name. Use one of {listed}.", texts)
    if not known:
        raise UnknownElementError("The program has no variables.")
    names = [*texts, *(path[-1] for path in known)]
    raise UnknownElementError.missing(
        "The program has no such variable.", path_text(wanted), names, f"It has {listed}."
    )


def with_initial(text: str, variable: Path, expression: str) -> str:
    """Return a text with the initialiser of a variable replaced by an expression.

    Raises LRPSyntaxError: the text is not a valid program.
    Raises UnknownElementError: there is no such variable, or several have that name.
    """
    _, found = find_variable(parse(text), variable)
    start, end = found.initial.span
    return f"{text[:start]}[{expression}]{text[end:]}"


def _variables(program: Program) -> dict[Path, Variable]:
    """Return the variables by their paths; where two have the same path, the first one counts."""
    scopes: list[tuple[Path, Program | Machine]] = [((), program), *program.walk()]
    known: dict[Path, Variable] = {}
    for path, scope in scopes:
        for each in scope.variables:
            known.setdefault((*path, str(each.name)), each)
    return known

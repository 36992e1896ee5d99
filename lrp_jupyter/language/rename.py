"""Renaming: a definition and everything that refers to it change together, and not a character else.

Paper: §9, "refactorings that allow renaming … allowing some interpreter restarts to be avoided".
"""

from __future__ import annotations

from collections import Counter
from keyword import iskeyword
from typing import NamedTuple

from lrp_jupyter.errors import LRPSyntaxError, UnknownElementError
from lrp_jupyter.language.names import normal
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Element, Path, Program, Span
from lrp_jupyter.language.symbols import Symbol, Use, symbols

__all__ = ["References", "references", "rename"]

_KINDS = ("state", "machine", "event", "variable", "transition")


class References(NamedTuple):
    """An element of the program, where it is defined, and every other place where it is meant."""

    element: Element
    definition: Span
    references: tuple[Span, ...]


def references(program: Program, offset: int) -> References | None:
    """Find what the name at an offset of the program's text means.

    Returns
    -------
    References or None
        None if no name stands there, or one that means no part of the program.
    """
    for symbol in symbols(program)[0]:
        for start, end in (symbol.definition, *symbol.references):
            if start <= offset <= end:
                return References(symbol.element, symbol.definition, tuple(sorted(set(symbol.references))))
    return None


def rename(program: Program, kind: str, path: Path, new_name: str) -> str:
    """Return the program's text with one element renamed, everything else kept to the letter.

    Parameters
    ----------
    program : Program
    kind : {"state", "machine", "event", "variable", "transition"}
    path : tuple of str
    new_name : str

    Raises
    ------
    UnknownElementError
        There is no such element.
    ValueError
        The name is illegal or taken, or something would mean something else than before.
    """
    if not program.text:
        program = parse(to_source(program), program.filename)
    element = Element(kind, tuple(path))
    found, uses = symbols(program)
    symbol = next((symbol for symbol in found if symbol.element == element), None)
    if symbol is None:
        raise _unknown(program, element)
    _check_name(kind, new_name)
    name = normal(new_name)
    if name == normal(program.text[slice(*symbol.definition)]):
        return program.text
    text = _changed(program.text, symbol, uses, name)
    try:
        _check_meaning(program, found, uses, text, symbol, name)
    except LRPSyntaxError as error:
        raise ValueError(f"`{name}` does not fit everywhere: {error.findings[0].message}") from None
    return text


def _unknown(program: Program, element: Element) -> Exception:
    if element.kind not in _KINDS:
        return UnknownElementError(f"A {element.kind} has no name of its own; rename {', '.join(_KINDS)}.")
    machine = dict(program.walk()).get(element.path[:-1])
    if element.kind == "transition" and machine and element.path[-1] in machine.labels:
        return ValueError(f"{element} has no name of its own; write one behind its destination.")
    return UnknownElementError(f"There is no {element}.")


def _check_name(kind: str, name: str) -> None:
    if not name.isidentifier():
        raise ValueError(f"`{name}` is no name; use letters, digits and `_`.")
    if kind == "variable" and (iskeyword(normal(name)) or name == "__debug__"):
        raise ValueError(f"`{name}` is a word of Python; give the variable another name.")


def _changed(text: str, symbol: Symbol, uses: list[Use], name: str) -> str:
    edits = {symbol.definition: name, **dict.fromkeys(symbol.references, name)}
    for use in uses:
        if use.symbol is symbol and use.imported:
            if "." in use.imported:
                raise ValueError(f"`import {use.imported}` assigns `{use.name}`; give that an `as` first.")
            edits[use.span] = f"{use.imported} as {name}"
    for (start, end), new in sorted(edits.items(), reverse=True):
        text = text[:start] + new + text[end:]
    return text


def _check_meaning(
    program: Program, found: list[Symbol], uses: list[Use], text: str, symbol: Symbol, name: str
) -> None:
    """Refuse a text in which any name means something else than before."""
    counts = Counter(use.span for use in uses if use.symbol)
    if any(counts[span] > 1 for span in symbol.references):
        raise ValueError(f"{symbol.element} is not the only one that its `exit` can lead to; rename by hand.")
    if any(other.element == (symbol.element.kind, (*symbol.element.path[:-1], name)) for other in found):
        raise ValueError(f"`{name}` is taken: there is another {symbol.element.kind} of this name.")
    new_found, new_uses = symbols(parse(text, program.filename))
    if len(new_found) != len(found):
        raise ValueError(f"{symbol.element} is defined twice; remove the second definition first.")
    before, after = _meanings(found, uses), _meanings(new_found, new_uses)
    for use, old, new in zip(uses, before, after, strict=False):
        if old != new:
            line, _ = program.place(use.span.start)
            raise ValueError(f"`{name}` is taken: it means something else in line {line}.")
    if len(before) != len(after):
        raise ValueError(f"`{name}` is taken: an inner function uses it for something else.")


def _meanings(found: list[Symbol], uses: list[Use]) -> list[int | None]:
    order = {symbol: index for index, symbol in enumerate(found)}
    return [None if use.symbol is None else order[use.symbol] for use in uses]

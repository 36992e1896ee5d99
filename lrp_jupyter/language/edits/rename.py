"""Rename and go to definition: finds all positions of a text that name the same element.

Paper: §3.1 (scope), §9 ("refactorings that allow renaming … allowing some interpreter restarts to be
avoided").
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from keyword import iskeyword
from typing import NamedTuple

from lrp_jupyter.errors import Edit, LRPSyntaxError, UnknownElementError, edited
from lrp_jupyter.language.blocks.names_in_blocks import normal
from lrp_jupyter.language.edits.mentions import named
from lrp_jupyter.language.lookup import find
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Element, Name, Path, Program, Span
from lrp_jupyter.language.resolution import Resolution, resolve

_KINDS = ("state", "machine", "event", "variable", "transition")


class Mention(NamedTuple):
    """One position of the text where a name refers to something; `symbol`: None unless that is an element.

    `imported`: the module's name where the name is bound by ``import``, else empty.
    """

    name: str
    span: Span
    symbol: Symbol | None
    imported: str = ""


@dataclass(eq=False)
class Symbol:
    """A named element: where it is defined, and where it is referred to."""

    element: Element
    definition: Span
    references: list[Span] = field(default_factory=list)


def symbols(program: Program) -> tuple[list[Symbol], list[Mention]]:
    """Return the definitions that count and every reference, resolved or not, in the order of the text."""
    names = resolve(program)
    found = {element: Symbol(element, name.span) for element, name in _definitions(names)}
    mentions = []
    for kind, name, span, scope, _, imported in named(names):
        symbol = None if scope is None else found.get(Element(kind, scope.path_of(kind, name)))
        if symbol is not None:
            symbol.references.append(span)
        mentions.append(Mention(name, span, symbol, imported))
    mentions.sort(key=lambda mention: mention.span)
    return sorted(found.values(), key=lambda symbol: symbol.definition), mentions


def _definitions(names: Resolution) -> Iterator[tuple[Element, Name]]:
    for scope in names.scopes:
        for kind, nouns in (("variable", scope.variables), ("event", scope.events), ("state", scope.states)):
            for noun in nouns.values():
                yield Element(kind, (*scope.path, str(noun.name))), noun.name
        if scope.name is not None:
            yield Element("machine", scope.path), scope.name
        for arrow in names.arrows[scope]:
            if arrow.noun.name is not None:
                yield arrow.element, arrow.noun.name


def references(program: Program, offset: int) -> Symbol | None:
    """Return the element that the name at an offset of the program's text refers to, if any."""
    for symbol in symbols(program)[0]:
        for start, end in (symbol.definition, *symbol.references):
            if start <= offset <= end:
                return replace(symbol, references=sorted(set(symbol.references)))
    return None


def rename(program: Program, kind: str, path: str | Path, new_name: str) -> str:
    """Return the program's text with one element renamed, everything else unchanged.

    Raises UnknownElementError: the element does not exist.
    Raises ValueError: the name is not valid or is taken, or the rename would change the meaning of another
        name.
    """
    if not program.text:
        program = parse(to_source(program), program.filename)
    return edited(program.text, rename_edits(program, kind, path, new_name))


def rename_edits(program: Program, kind: str, path: str | Path, new_name: str) -> list[Edit]:
    """Return the edits of a rename of a program that has a text. Raise as :func:`rename` does."""
    if kind not in _KINDS:
        raise UnknownElementError(f"A {kind} has no name of its own. Only these have: {', '.join(_KINDS)}.")
    element = find(program, kind, path)
    found, uses = symbols(program)
    symbol = next((symbol for symbol in found if symbol.element == element), None)
    if symbol is None:
        raise ValueError(f"{element} has no name of its own. Write one after its destination.")
    check_name(kind, new_name)
    name = normal(new_name)
    if name == normal(program.text[slice(*symbol.definition)]):
        return []
    edits = _changes(symbol, uses, name)
    text = edited(program.text, edits)
    try:
        _check_meaning(program, found, uses, text, symbol, name)
    except LRPSyntaxError as error:
        raise ValueError(f"`{name}` is not valid everywhere: {error.findings[0].message}") from None
    return edits


def check_name(kind: str, name: str) -> None:
    """Raise ValueError unless an element of this kind can have the name."""
    if not name.isidentifier():
        raise ValueError(f"`{name}` is not a valid name. Use letters, digits and `_`.")
    if kind == "variable" and (iskeyword(normal(name)) or name == "__debug__"):
        raise ValueError(f"`{name}` is a keyword of Python. Give the variable another name.")


def _changes(symbol: Symbol, uses: list[Mention], name: str) -> list[Edit]:
    names = {symbol.definition: name, **dict.fromkeys(symbol.references, name)}
    for use in uses:
        if use.symbol is symbol and use.imported:
            if "." in use.imported:
                raise ValueError(f"`import {use.imported}` assigns `{use.name}`. Add an `as` first.")
            names[use.span] = f"{use.imported} as {name}"
    return [Edit(*span, new) for span, new in names.items()]


def _check_meaning(
    program: Program, found: list[Symbol], uses: list[Mention], text: str, symbol: Symbol, name: str
) -> None:
    """Raise if any name has another meaning in the new text than before."""
    counts = Counter(use.span for use in uses if use.symbol)
    shared = next((span for span in symbol.references if counts[span] > 1), None)
    if shared is not None:
        line, _ = program.place(shared.start)
        problem = f"{symbol.element} is not the only one that line {line} can mean"
        raise ValueError(f"{problem}. Rename it by hand.")
    if symbol.element.kind == "transition" and _shared(found, symbol, program):
        raise ValueError(f"{symbol.element} is not the only one of this name. Rename it by hand.")
    if any(other.element == (symbol.element.kind, (*symbol.element.path[:-1], name)) for other in found):
        raise ValueError(f"`{name}` is taken by another {symbol.element.kind}. Choose another name.")
    new_found, new_uses = symbols(parse(text, program.filename))
    if len(new_found) != len(found):
        raise ValueError(f"{symbol.element} is defined twice. Remove the second definition first.")
    before, after = _meanings(found, uses), _meanings(new_found, new_uses)
    for use, old, new in zip(uses, before, after, strict=False):
        if old != new:
            line, _ = program.place(use.span.start)
            raise ValueError(f"`{name}` already means something else in line {line}. Choose another name.")
    if len(before) != len(after):
        raise ValueError(f"`{name}` already means something else in an inner function. Choose another name.")


def _shared(found: list[Symbol], symbol: Symbol, program: Program) -> bool:
    """Return whether another transition of the machine has the same name: a rename could not be undone."""
    names = [
        program.text[slice(*other.definition)]
        for other in found
        if other.element.kind == "transition" and other.element.path[:-1] == symbol.element.path[:-1]
    ]
    return names.count(program.text[slice(*symbol.definition)]) > 1


def _meanings(found: list[Symbol], uses: list[Mention]) -> list[int | None]:
    order = {symbol: index for index, symbol in enumerate(found)}
    return [None if use.symbol is None else order[use.symbol] for use in uses]

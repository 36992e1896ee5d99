"""The outline of a text: its elements, what can be folded, and what is selected step by step."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from lsprotocol import types as lsp

from lrp_jupyter.editors.program_text import ProgramText
from lrp_jupyter.language.edits.form_places import WrittenForm
from lrp_jupyter.language.program import Event, Machine, Program, Span, State, Variable

_COMMENTS = re.compile(r"(?:^[ \t]*[;#][^\r\n]*(?:\r\n|\r|\n|\Z)){2,}", re.MULTILINE)
_WORD = re.compile(r"[\w\u0080-\uffff]+")


def outline(text: ProgramText) -> list[lsp.DocumentSymbol]:
    """Return the elements of a text, with those in them."""
    return [*_inside(text, text.sketched)]


def _inside(text: ProgramText, owner: Program | Machine) -> Iterator[lsp.DocumentSymbol]:
    kinds = lsp.SymbolKind
    found = [
        *(_symbol(text, each, kinds.Variable, "variable") for each in owner.variables),
        *(_symbol(text, each, kinds.Event, "event") for each in owner.events),
    ]
    if isinstance(owner, Program):
        found += [_machine(text, each) for each in owner.machines]
    else:
        for state in owner.states:
            inner = [_machine(text, each) for each in state.machines]
            found.append(_symbol(text, state, kinds.EnumMember, "state", inner))
        for label, each in zip(owner.labels, owner.transitions, strict=True):
            name = each.name or each.destination
            found.append(_made(text, label, kinds.Operator, each.kind, each.span, name.span, []))
    return iter(sorted(found, key=lambda each: (each.range.start.line, each.range.start.character)))


def _machine(text: ProgramText, machine: Machine) -> lsp.DocumentSymbol:
    return _symbol(text, machine, lsp.SymbolKind.Class, "machine", _inside(text, machine))


def _symbol(
    text: ProgramText,
    noun: Variable | Event | State | Machine,
    kind: lsp.SymbolKind,
    detail: str,
    inside: Iterable[lsp.DocumentSymbol] = (),
) -> lsp.DocumentSymbol:
    return _made(text, str(noun.name), kind, detail, noun.span, noun.name.span, inside)


def _made(
    text: ProgramText,
    name: str,
    kind: lsp.SymbolKind,
    detail: str,
    whole: Span,
    word: Span,
    inside: Iterable[lsp.DocumentSymbol],
) -> lsp.DocumentSymbol:
    span = text.at.range
    return lsp.DocumentSymbol(name, kind, span(*whole), span(*word), detail, children=[*inside])


def folds(text: ProgramText) -> Iterator[lsp.FoldingRange]:
    """Yield what takes several lines: forms, blocks, and comments."""
    for start, end in _spans(text.root):
        first, last = text.at.position(start).line, text.at.position(end).line
        if first < last:
            yield lsp.FoldingRange(first, last)
    for found in _COMMENTS.finditer(text.text):
        first, last = text.at.position(found.start()).line, text.at.position(found.end() - 1).line
        yield lsp.FoldingRange(first, last, kind=lsp.FoldingRangeKind.Comment)


def _spans(form: WrittenForm) -> Iterator[tuple[int, int]]:
    for item in form.items:
        if isinstance(item, WrittenForm):
            yield item.start, item.end
            yield from _spans(item)
        elif item[0] == "BLOCK":
            yield item[1], item[2]


def selection(text: ProgramText, offset: int) -> lsp.SelectionRange:
    """Return what is around an offset, step by step: the word, the block, each form, the text."""
    spans = [(0, len(text.text))]
    around = text.root.around(offset)
    spans += [(form.start, form.end) for form in around[1:]]
    spans += [
        item[1:] for item in around[-1].items if isinstance(item, tuple) and item[1] <= offset <= item[2]
    ]
    line = text.at.offset(lsp.Position(text.at.position(offset).line, 0))
    spans += [each.span() for each in _WORD.finditer(text.text, line, offset + 100) if _touches(each, offset)]
    found: lsp.SelectionRange | None = None
    for start, end in dict.fromkeys(spans):
        found = lsp.SelectionRange(text.at.range(start, end), found)
    assert found is not None
    return found


def _touches(found: re.Match[str], offset: int) -> bool:
    return found.start() <= offset <= found.end()

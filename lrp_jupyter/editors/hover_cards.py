"""What an editor shows about a word: what it means, and the explanation of what is found there."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterator

from lrp_jupyter.codes import FINDINGS
from lrp_jupyter.editors.program_text import ProgramText
from lrp_jupyter.editors.python_options import doc_of, signature_of
from lrp_jupyter.editors.semantic_colours import words
from lrp_jupyter.editors.word_context import context_at
from lrp_jupyter.errors import LRPError
from lrp_jupyter.language.blocks.builtin_names import TIME_TEXTS, builtin
from lrp_jupyter.language.edits.rename import Symbol
from lrp_jupyter.language.form_texts import form_texts
from lrp_jupyter.language.lookup import definition_of
from lrp_jupyter.language.program import Machine, path_text

_LEFT = re.compile(r"[\w.\u0080-\uffff]*\Z")
_BESIDE = re.compile(r"[ \t]*[;#][;# ]*([^\r\n]+)")
_RIGHT = re.compile(r"[\w\u0080-\uffff]*")


def card(text: ProgramText, offset: int) -> tuple[str, tuple[int, int]] | None:
    """Return Markdown about an offset, and the range of the text that it is about."""
    found, span = _about(text, offset)
    told = [*found, *_explanations(text, offset)]
    return ("\n\n---\n\n".join(told), span) if told else None


def _about(text: ProgramText, offset: int) -> tuple[list[str], tuple[int, int]]:
    symbol = text.symbol(offset)
    if symbol is not None:
        return [_named(text, symbol)], text.span(symbol, offset)
    keyword_span = _keyword_at(text, offset)
    if keyword_span is not None:
        form = form_texts()[text.text[slice(*keyword_span)]]
        return [_code(form.usage) + form.doc], keyword_span
    begun = _LEFT.search(text.text, max(0, offset - 200), offset)[0]  # type: ignore[index]
    chain = begun + _RIGHT.match(text.text, offset)[0]  # type: ignore[index]
    start = offset - len(begun)
    span = (start, start + len(chain))
    is_python = chain and context_at(text.text, text.root, text.names, offset).wanted == "python"
    return [*_python(text, chain)] if is_python and not _is_quoted(text, offset) else [], span


def _is_quoted(text: ProgramText, offset: int) -> bool:
    """Return whether an offset is in a comment, or in a string that may not contain Python."""
    found = (word for word in words(text) if word.start <= offset < word.end)
    return any(each.kind in ("comment", "string") and text.text[each.start - 1] not in "fF" for each in found)


def _keyword_at(text: ProgramText, offset: int) -> tuple[int, int] | None:
    """Return where a keyword is that an offset touches."""
    spans = ((start, end) for kind, start, end in text.parts if kind in ("KEYWORD", "FOR"))
    return next((span for span in spans if span[0] <= offset <= span[1]), None)


def _named(text: ProgramText, symbol: Symbol) -> str:
    """Return what an element is, as it is written, with the comments above and beside it."""
    kind, path = symbol.element.kind, symbol.element.path
    noun = definition_of(text.sketched, symbol.element)
    where = f" of `{path_text(path[:-1])}`" if len(path) > 1 else ""
    lines = [f"**{kind}** `{text.text[slice(*symbol.definition)]}`{where}"]
    if isinstance(noun, Machine):
        states = ", ".join(f"`{each.name}`" for each in noun.states)
        lines.append(f"States: {states}." if states else "It has no states.")
    elif noun is not None:
        lines.append(_code(_first_lines(text.text[slice(*noun.span)])))
    lines += _comments(text.text, symbol.definition.start, noun.span.end if noun else symbol.definition.end)
    return "\n\n".join(lines)


def _comments(text: str, start: int, end: int) -> Iterator[str]:
    """Yield the comment lines directly above what is defined, and the comment beside its end."""
    above = text[:start].splitlines()[:-1]
    found: list[str] = []
    while above and above[-1].lstrip()[:1] in (";", "#"):
        found.insert(0, above.pop().lstrip().lstrip(";# "))
    beside = _BESIDE.match(text, end)
    if beside:
        found.append(beside[1])
    if found:
        yield " ".join(found)


def _python(text: ProgramText, chain: str) -> Iterator[str]:
    bridge = text.robot.read(text.text).bridge
    first, _, path = chain.partition(".")
    if first == "robot" and bridge is not None:
        try:
            member = bridge.describe(path)
        except LRPError:
            return
        kind = " ".join(filter(None, (member.type, member.unit and f"in {member.unit}")))
        inside = ", ".join(f"`{each.name.removeprefix(f'{path}.')}`" for each in member.fields)
        title = f"{chain}{member.signature}" + (f": {kind}" if kind else "")
        yield "\n\n".join(filter(None, (_code(title, "python") + member.doc, inside and f"With {inside}.")))
    elif chain in TIME_TEXTS:
        yield _code(f"{chain}: float", "python") + TIME_TEXTS[chain]
    elif not path and not keyword.iskeyword(chain):
        try:
            value = builtin(chain)
        except AttributeError:
            return
        yield _code(chain + (signature_of(value) if callable(value) else ""), "python") + doc_of(value)


def _explanations(text: ProgramText, offset: int) -> Iterator[str]:
    """Yield the explanation of each code that is found at an offset."""
    codes = {}
    for finding in text.findings:
        start, end = text.at.span(text.at.range_of_finding(finding))
        if start <= offset <= end:
            codes[finding.code] = FINDINGS[finding.code]
    for code, found in codes.items():
        yield f"**{code}: {found.title}**\n\n{found.explanation}\n\n{found.remedy}"


def _first_lines(written: str) -> str:
    """Return the first lines of a form."""
    lines = written.splitlines()
    return "\n".join(lines if len(lines) <= 6 else [*lines[:5], "…"])


def _code(text: str, language: str = "lrp") -> str:
    return f"```{language}\n{text}\n```\n"

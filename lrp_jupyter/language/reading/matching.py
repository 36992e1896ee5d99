"""Matching of the brackets of forms, with findings for those that do not match."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.program import line_starts
from lrp_jupyter.language.reading.missing_brackets import Bracket, BracketRepair, repair
from lrp_jupyter.language.reading.tokens import KEYWORDS, LEGAL, Token, keyword_of, tokenize
from lrp_jupyter.language.source import Diagnosis

DEEPEST = 100
"""Maximum depth of nested forms."""

_BRACKETS = frozenset({"OPEN", "CLOSE"})
_LEGAL = {keyword: LEGAL.get(keyword, frozenset()) for keyword in KEYWORDS} | LEGAL


class Matching(NamedTuple):
    """How to interpret the brackets of forms; each is identified by the index of its token.

    `extra`: closing brackets to ignore.
    `lost`: keywords to parse as if a ``(`` preceded them.
    `closing`: number of ``)`` to insert before a token.
    `too_deep`: whether forms are nested too deeply to parse the text.
    """

    findings: list[Diagnosis]
    extra: frozenset[int] = frozenset()
    lost: frozenset[int] = frozenset()
    closing: dict[int, int] = {}  # noqa: RUF012  (never changed)
    too_deep: bool = False


def match(text: str, starts: list[int], tokens: Sequence[Token]) -> Matching:
    """Match the brackets of a text whose lines begin at `starts`, with as few changes as possible."""
    around = ["program"]
    sound = True
    for token in [token for token in tokens if token[0] in _BRACKETS]:
        if token[0] == "OPEN":
            keyword = keyword_of(text, token)
            if len(around) > DEEPEST:
                message = f"Forms are nested too deeply here. Nest at most {DEEPEST}."
                return Matching([Diagnosis(token[1], token[2], "LRP111", message)], too_deep=True)
            if keyword not in _LEGAL.get(around[-1], KEYWORDS) and keyword in KEYWORDS:
                sound = False
            around.append(keyword)
        elif len(around) > 1:
            around.pop()
        else:
            sound = False
    return Matching([]) if sound and len(around) == 1 else _repaired(text, starts, tokens)


def matched(text: str) -> list[Token]:
    """Return the tokens of a text with brackets that match: without extra ones, and with those that lack.

    A form that is not closed ends before the next token. None of a text whose forms are nested too deeply.
    """
    tokens = tokenize(text)
    _, extra, lost, closing, too_deep = match(text, line_starts(text), tokens)
    found: list[Token] = []
    for index, token in enumerate([] if too_deep else [*tokens, ("END", len(text), len(text))]):
        _, start, end = token
        found += [("CLOSE", start, start)] * closing.get(index, 0)
        if index not in extra:
            found.append(("OPEN", start, end) if index in lost else token)
    return found[:-1]


def _repaired(text: str, starts: list[int], tokens: Sequence[Token]) -> Matching:
    indices = []
    sequence = []
    for index, (kind, start, end) in enumerate(tokens):
        if kind not in ("OPEN", "CLOSE", "NAME"):
            continue
        line = bisect_right(starts, start) - 1
        before = text[starts[line] : start]
        column = -1 if before.strip() else len(before)
        if kind == "NAME" and (column < 0 or text[start:end] not in KEYWORDS):
            continue
        keyword = "" if kind == "CLOSE" else keyword_of(text, tokens[index])
        if kind == "OPEN" and keyword not in KEYWORDS:
            keyword = "?"
        indices.append(index)
        followed = index + 1 < len(tokens) and tokens[index + 1][0] not in _BRACKETS
        indent = len(before) - len(before.lstrip())
        sequence.append(Bracket(keyword, column, indent, kind == "NAME", followed))
    found = repair(sequence)
    findings: list[Diagnosis] = []
    indices.append(len(tokens))
    moved = _moved(found)
    for position, (opened, gap) in moved.items():
        _, start, end = tokens[indices[position]]
        last_end = tokens[indices[gap] - 1][2]
        keyword = sequence[opened].keyword.strip("?")
        early = "too early" if position < gap else "too late"
        line = bisect_right(starts, last_end)
        message = f"This `)` closes `({keyword}` {early}. Put it at the end of line {line}."
        edits = Edit(start, end, ""), Edit(last_end, last_end, ")")
        findings.append(Diagnosis(start, end, "LRP102", message, edits))
    for position in found.extra:
        if position in moved:
            continue
        _, start, end = tokens[indices[position]]
        message = "This `)` is one too many. Remove it."
        findings.append(Diagnosis(start, end, "LRP102", message, (Edit(start, end, ""),)))
    for position in found.lost:
        _, start, end = tokens[indices[position]]
        message = f"A `(` is missing before `{text[start:end]}`. Insert it."
        findings.append(Diagnosis(start, end, "LRP101", message, (Edit(start, start, "("),)))
    closing: dict[int, int] = {}
    for position, before_position in found.unclosed:
        index = indices[before_position]
        closing[index] = closing.get(index, 0) + 1
        last, _, last_end = tokens[index - 1]
        if last == "UNCLOSED" or (position, before_position) in moved.values():
            continue  # this `)` is missing together with the block's `]`, or is elsewhere
        _, start, end = tokens[indices[position]]
        keyword = sequence[position].keyword.strip("?")
        what = f"`({keyword}`" if keyword else "`(`"
        line = bisect_right(starts, last_end)
        message = f"This {what} is not closed. Put its `)` at the end of line {line}."
        findings.append(Diagnosis(start, end, "LRP101", message, (Edit(last_end, last_end, ")"),)))
    extra, lost = (frozenset(indices[position] for position in part) for part in found[:2])
    return Matching(findings, extra, lost, closing)


def _moved(found: BracketRepair) -> dict[int, tuple[int, int]]:
    """Return the closing brackets that belong elsewhere: what each closes, and before which bracket."""
    moved: dict[int, tuple[int, int]] = {}
    if len(found.extra) != len(found.unclosed) or found.lost:
        return moved
    unclosed = sorted(found.unclosed, key=lambda each: each[1])
    for (opened, gap), extra in zip(unclosed, found.extra, strict=True):
        if opened < extra:
            moved[extra] = opened, gap
    return moved

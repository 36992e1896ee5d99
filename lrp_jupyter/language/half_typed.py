"""The word at the cursor: the part of a text that is still being typed.

A half-typed name is seldom what the program should be: `loo` on the way to `lookleft`, `0.` on the way to
`0.25`. With a cursor (or several, where two editors show it), a text is therefore two programs: the text
itself, and the text *without the change at the cursor*, in which only that change is as it was in the running
program. The second one runs instead of the first while

- a number is being typed,
- the word at the cursor brings an error into the text,
- the same word is being typed at several cursors, and would restart the program, or
- the cursor is inside an active state, and what changed there brings an error into the text.

A text that is not a program is not judged while it is being typed: what is wrong changes with every letter.
Views keep what they showed until the word is finished or left, or the text is a program.

A new transition is different: it runs although the state that it leads to is not there yet, so that it is
drawn at once; only its faults are not reported. Nor are those of a condition that is being typed, which on
its way to a comparison is seldom True or False. Which words are still being typed is the editor's decision,
by its timers: everything here is a function of its arguments. But who types slowly has the cursor in a word
that is taken for finished: while it is an error, its finding is shown, and its faults are not reported.

Deviation: §6.1 applies every text that is a program at once. Without a cursor that is what happens.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import Any, NamedTuple

from lrp_jupyter.language.edits.text_difference import text_difference
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Element, Finding, Program, Span, State
from lrp_jupyter.language.resolution import resolve

Check = Callable[[Program], tuple[Finding, ...]]

_WORD = re.compile(r"[0-9][\w.]*|\w+")
_ARROWS = frozenset({"LRP301", "LRP302", "LRP303", "LRP309", "LRP310"})
"""The errors about the names in a transition."""


class Cursor(NamedTuple):
    """Where the cursor of an editor is, in characters; `meant`: the word that it touches is finished."""

    offset: int
    meant: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Unmeant:
    """The unfinished part of a program.

    `instead`: the program without it.
    `reason`: why it waits: ``waits:`` and a sentence, without a full stop; empty if only for what it would
        disturb.
    `always`: whether `instead` always runs; otherwise only where the program would change the actions of an
        active state, remove it, or restart.
    `element`: the element that contains it; its faults are not reported while the program runs, or `always`.
    """

    instead: Program
    reason: str = ""
    always: bool = False
    element: Element | None = None


class Judgement(NamedTuple):
    """What a text means while the cursor is in it.

    `findings`: those to show, without those about what is unfinished; `hides`: whether there are such.
    """

    program: Program | None
    findings: tuple[Finding, ...]
    unmeant: Unmeant | None = None
    hides: bool = False

    @property
    def half_typed(self) -> bool:
        """Whether the text will mean something else once the word at the cursor is finished or left."""
        return self.hides or self.unmeant is not None


def judge(
    text: str,
    program: Program | None,
    findings: tuple[Finding, ...],
    cursors: Iterable[Cursor],
    running: Program,
    check: Check,
) -> Judgement:
    """Return what a text means while cursors are in it: what is half typed at any of them waits."""
    left, waiting, hides = findings, [], False
    every_cursor = sorted(cursors)
    several = sum(not cursor.meant for cursor in every_cursor) > 1
    for cursor in every_cursor:
        there, span = _judge_at(text, program, findings, cursor, running, check, several)
        hides |= there.hides
        left = tuple(each for each in left if each in there.findings)
        if there.unmeant is not None:
            waiting.append((there.unmeant, span))
    unmeant = waiting[0][0] if waiting else None
    if program is not None and len(waiting) > 1:
        every = [each for each, _ in waiting]
        unmeant = Unmeant(
            without_change(program, running, *[span for _, span in waiting]),
            next((each.reason for each in every if each.reason), ""),
            any(each.always for each in every),
            next((each.element for each in every if each.element), None),
        )
    return Judgement(program, left, unmeant, hides)


def _judge_at(
    text: str,
    program: Program | None,
    findings: tuple[Finding, ...],
    cursor: Cursor,
    running: Program,
    check: Check,
    several: bool,
) -> tuple[Judgement, Span]:
    """Return what a text means while a cursor is in it, and the range of what is unfinished."""
    if program is None:
        return Judgement(None, findings if cursor.meant else (), hides=not cursor.meant), Span(0, 0)
    word = _word_at(text, cursor.offset)
    if word is not None and not cursor.meant:
        left, unmeant = _without_word(program, word, findings, running, check, several)
        if unmeant is not None:
            return Judgement(program, left, unmeant, len(left) < len(findings)), word
    element = None
    if word is not None and cursor.meant:
        wrong = [each for each in findings if each.severity == "error"]
        element = _element_at(program, word) if len(_away_from(text, word, wrong)) < len(wrong) else None
    state = _state_at(program, cursor.offset)
    if state is not None and _has_errors(findings):
        instead = without_change(program, running, state.span)
        errors = _new_errors(findings, instead, check)
        if errors:
            reason = waits_for(errors[0].message)
            return Judgement(program, findings, Unmeant(instead, reason, element=element)), state.span
    if word is not None and element is not None:
        instead = without_change(program, running, word)
        return Judgement(program, findings, Unmeant(instead, element=element)), word
    here = Span(cursor.offset, cursor.offset)
    tested = None if cursor.meant else _tested_at(program, here)
    if tested is not None:
        instead = without_change(program, running, here)
        return Judgement(program, findings, Unmeant(instead, element=tested)), here
    return Judgement(program, findings), Span(0, 0)


def _without_word(
    program: Program,
    word: Span,
    findings: tuple[Finding, ...],
    running: Program,
    check: Check,
    several: bool,
) -> tuple[tuple[Finding, ...], Unmeant | None]:
    """Return the findings that are not about a word that is being typed, and what waits because of it."""
    text = program.text
    left = _away_from(text, word, findings)
    is_number = text[word.start].isdecimal()
    if not is_number and not several and len(left) == len(findings) and not _has_errors(findings):
        return findings, None
    instead, tested = without_change(program, running, word), _tested_at(program, word)
    if is_number:
        if instead == program:  # in a comment, or as it was
            return left, None
        reason = f"waits: `{text[slice(*word)]}` is being typed"
        return left, Unmeant(instead, reason, True, tested)
    element = _element_at(program, word)
    errors = _new_errors(findings, instead, check)
    if errors and element is not None and _is_wrong(instead, element, check):
        errors = []
    if errors and not _begins_arrow(program, instead, errors):
        known = {(each.code, each.message) for each in check(instead)}
        about = [each for each in errors if each not in left] or errors
        left = tuple(each for each in left if (each.code, each.message) in known)
        return left, Unmeant(instead, waits_for(about[0].message), True, tested)
    if len(left) == len(findings) and (not several or instead == program):
        return findings, None
    return left, Unmeant(instead, element=element)


def _is_wrong(program: Program, element: Element, check: Check) -> bool:
    """Return whether an element has an error: then it makes no difference what becomes of it."""
    spans = [span for each, span in _places(program) if each == element]
    errors = [each for each in check(program) if each.severity == "error"] if spans else []
    return any(len(_away_from(program.text, span, errors)) < len(errors) for span in spans)


def _new_errors(findings: tuple[Finding, ...], instead: Program, check: Check) -> list[Finding]:
    """Return the errors that a program has in addition to those of another one."""
    errors = [each for each in findings if each.severity == "error"]
    if not errors:
        return []
    known = Counter((each.code, each.message) for each in check(instead) if each.severity == "error")
    new = [each for each in errors if not _counted(known, (each.code, each.message))]
    left = Counter(code for code, _ in known.elements())
    return [each for each in new if not _counted(left, each.code)]


def _has_errors(findings: tuple[Finding, ...]) -> bool:
    return any(each.severity == "error" for each in findings)


def _counted(counts: Counter[Any], key: object) -> bool:
    counts[key] -= 1
    return counts[key] >= 0


def _begins_arrow(program: Program, instead: Program, errors: list[Finding]) -> bool:
    """Return whether the errors are about the names of a transition that is new."""
    before, now = (sum(len(machine.transitions) for _, machine in each.walk()) for each in (instead, program))
    return now > before and all(each.code in _ARROWS for each in errors)


def waits_for(problem: str) -> str:
    """Return a reason to wait: the first sentence about a problem."""
    problem = problem.partition(". ")[0].rstrip(".")
    return f"waits: {problem[0].lower()}{problem[1:]}"


def without_change(program: Program, before: Program, *spans: Span) -> Program:
    """Return a program without its changes in some ranges; the earlier one if the result is not a program."""
    parts, at, place = [], 0, 0
    for length, new in text_difference(before.text, program.text):
        then = before.text[place : place + length]
        now = then if new is None else new
        is_there = any(at <= span.end and span.start <= at + len(now) for span in spans)
        parts.append(then if is_there else now)
        at += len(now)
        place += length
    text = "".join(parts)
    if text == before.text:
        return before
    if text == program.text:
        return program
    found, _ = scan(text, program.filename)
    return before if found is None else found


def _word_at(text: str, offset: int) -> Span | None:
    """Return the range of the name or number that a cursor touches."""
    start = max(text.rfind("\n", 0, offset), text.rfind("\r", 0, offset)) + 1
    for match in _WORD.finditer(text, start):
        if match.start() > offset:
            break
        if match.end() >= offset:
            return Span(*match.span())
    return None


def _away_from(text: str, span: Span, findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Return the findings that do not touch a range of the text."""
    place = Program(text=text).place
    begin, end = place(span.start), place(span.end)
    return tuple(
        each
        for each in findings
        if (each.line, each.column) > end or (each.end_line, each.end_column) < begin
    )


def _state_at(program: Program, offset: int) -> State | None:
    """Return the innermost state that a cursor is in."""
    around = [
        state
        for _, machine in program.walk()
        for state in machine.states
        if state.span.start < offset < state.span.end
    ]
    return around[-1] if around else None


def _tested_at(program: Program, span: Span) -> Element | None:
    """Return the element whose condition or delay contains a range of the text."""
    for each in resolve(program).all_blocks:
        start, end = each.block.span
        if start < span.start and span.end < end and each.purpose in ("condition", "delay"):
            return each.element
    return None


def _element_at(program: Program, span: Span) -> Element | None:
    """Return the element to which a fault in a range of the text is attributed."""
    around = (
        element for element, (start, end) in _places(program) if start <= span.start and span.end <= end
    )
    return next(around, None)


def _places(program: Program) -> Iterator[tuple[Element, Span]]:
    """Yield the elements to which faults are attributed, with their ranges; blocks come first."""
    names = resolve(program)
    return chain(
        ((each.element, each.block.span) for placed in names.blocks.values() for each in placed),
        ((each.element, each.noun.span) for arrows in names.arrows.values() for each in arrows),
        ((each.element, each.noun.span) for each in names.spawns),
    )

"""Slips in the Python of a block: what is wrong, and the change after which Python accepts it.

Python names the place where it gave up and often nothing else. So this package tries what people usually
mean: each rule proposes changes at a place that looks like its kind of slip (a sign of another language, a
missing bracket, a misspelt keyword), and the first change after which Python accepts the block is reported as
the mistake, with the change as its fix. One slip is one fault, whatever follows from it. Where nothing helps,
the error of Python is reported in other words.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from itertools import chain

from lrp_jupyter.errors import Edit, edited
from lrp_jupyter.language.blocks.slips.block_words import conditions, forms, keywords, negated
from lrp_jupyter.language.blocks.slips.brackets import braces, brackets, calls_in_brackets
from lrp_jupyter.language.blocks.slips.code import Guess, Guesses, WrongBlock
from lrp_jupyter.language.blocks.slips.indentation import indentation
from lrp_jupyter.language.blocks.slips.literals import numbers, strings
from lrp_jupyter.language.blocks.slips.signs import characters, comments, conditionals, signs
from lrp_jupyter.language.blocks.slips.statements import colons, equals, gaps, strays, unfinished
from lrp_jupyter.language.blocks.slips.wordings import in_words
from lrp_jupyter.language.program import line_starts
from lrp_jupyter.language.python.block_suite import parse_block
from lrp_jupyter.language.source import Diagnosis

__all__ = ["brief", "explain", "fault_of"]

LONGEST = 6_000
"""Characters of a block in which remedies are searched for."""
_ATTEMPTS = 250_000
"""Characters parsed at most in search of the remedies of one block."""
_MOST = 8
"""Slips reported at most in one block."""


def explain(text: str, line: int = 1, column: int = 0, is_condition: bool = False) -> tuple[Diagnosis, ...]:
    """Return the errors of a block that is not valid Python, in the order in which Python meets them.

    `line`, `column`: where the text begins in the program: its line, from 1, and its column, from 0.
    """
    if len(text) > LONGEST:
        return brief(text, line)
    faults: list[Diagnosis] = []
    origins = list(range(len(text) + 1))  # of each character of the present text, its offset in the block's
    left = _ATTEMPTS
    while len(faults) < _MOST:
        error = _error(text)
        if error is None:
            break
        place = _offset(text, error.lineno, error.offset)
        best = guess = None  # the latter: Python would accept it, but something else may be meant
        if "too " in error.msg:  # deeply nested: nothing is misspelt
            left = 0
        code = WrongBlock(text, place, error.msg, column, is_condition)
        for candidate in chain.from_iterable(rule(code) for rule in _RULES):
            left -= len(text)
            if left < 0:
                break
            follower = _error(edited(text, candidate.edits))
            if follower is None and (candidate.is_certain or candidate.is_form):
                best = candidate
                break
            if follower is None:
                guess = guess or candidate
            elif best is None and _is_progress(text, candidate, place, follower):
                best = candidate
        best = best or guess
        if best is None:
            fault = _known_pattern(code) or fault_of(error, text, line)
            faults.append(fault._replace(start=origins[fault.start], end=origins[fault.end]))
            break
        edits = [Edit(origins[start], origins[end], new) for start, end, new in best.edits if best.is_certain]
        start, end = origins[best.start], origins[best.end]
        faults.append(Diagnosis(start, end, best.code, best.message, tuple(edits)))
        for start, end, new in sorted(best.edits, reverse=True):
            origins[start:end] = [origins[start]] * len(new)
        text = edited(text, best.edits)
        column = 0 if column and origins[0] else column
    return tuple(faults)


def brief(text: str, line: int = 1) -> tuple[Diagnosis, ...]:
    """Return the first error of a block in words, without a search for its remedy."""
    error = _error(text)
    return () if error is None else (fault_of(error, text, line),)


def fault_of(error: SyntaxError, text: str, line: int = 1) -> Diagnosis:
    """Return an error of Python in other words; the text begins in the given line of the program."""
    start = _offset(text, error.lineno, error.offset)
    end = max(_offset(text, error.end_lineno, error.end_offset), min(start + 1, len(text)))
    match = _WORD.match(text, start)
    code = "LRP514" if error.msg.startswith("unterminated") else "LRP501"
    return Diagnosis(start, end, code, in_words(error.msg, match[0] if match else "", line))


_WORD = re.compile(r"\w{1,40}|[^\s\w`]")


@lru_cache(maxsize=512)
def _error(text: str) -> SyntaxError | None:
    try:
        parse_block(text)
    except SyntaxError as error:
        return error.with_traceback(None)
    return None


def _offset(text: str, line: int | None, column: int | None) -> int:
    starts = line_starts(text)
    return min(starts[min(line or 1, len(starts)) - 1] + (column or 1) - 1, len(text))


def _is_progress(text: str, candidate: Guess, place: int, follower: SyntaxError) -> bool:
    """Return whether Python now gives up in a later line, so that this was one slip of several."""
    later = _offset(edited(text, candidate.edits), follower.lineno, follower.offset)
    first = min(edit.start for edit in candidate.edits)
    grown = sum(len(new) - (end - start) for start, end, new in candidate.edits)
    if later - max(grown, 0) <= place:
        return False
    return candidate.code in _CERTAIN or "\n" in text[max(place, first) : later - grown]


_CERTAIN = frozenset({"LRP510", "LRP511"})
"""What is wrong wherever it stands, even if more is wrong in its line."""


def _known_pattern(code: WrongBlock) -> Diagnosis | None:
    """Return what is wrong with a line that no single change can mend, if it looks like something known."""
    start = code.starts[code.at]
    end = code.starts[code.at + 1] if code.at + 1 < len(code.starts) else len(code.text)
    for pattern, code_of, message in _PATTERNS:
        if match := pattern.search(code.text, start, end):
            return Diagnosis(match.start(), match.end(), code_of, message)
    return None


_RANGE = "Python counts with `range`. Write `for i in range(3):`."
_PATTERNS = [
    (re.compile(pattern), number, message)
    for pattern, number, message in (
        (r"\bfor\s*\(", "LRP510", _RANGE),
        (r"\bfor\s+\w+\s*=", "LRP510", _RANGE),
        (r"\d\s*\.\.+\s*\d", "LRP510", _RANGE),
        (r"\b(?:repeat|loop)\b", "LRP511", _RANGE),
        (r"\bis\s+(?:less|greater|equal|bigger|smaller|not equal)\b|\bequals?\b", "LRP511",
         "Python compares with signs. Write `<`, `>` or `==`."),
        (r"\b(?:and|or)\s*[<>=!]", "LRP517",
         "`and` and `or` join whole comparisons. Write the name again before the sign."),
        (r"\)\s*\{|\belse\s*\{|\}\s*else\b", "LRP510",
         "Python has no braces around statements. Write `:`, and the rest in new lines, further right."),
    )
]  # fmt: skip


_RULES: tuple[Callable[[WrongBlock], Guesses], ...] = (
    conditions,
    forms,
    signs,
    characters,
    strings,
    numbers,
    calls_in_brackets,
    braces,
    brackets,
    keywords,
    negated,
    colons,
    equals,
    comments,
    conditionals,
    unfinished,
    gaps,
    indentation,
    strays,
)

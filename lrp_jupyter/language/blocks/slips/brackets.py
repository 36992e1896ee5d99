"""Brackets that are missing, superfluous or of the wrong kind."""

from __future__ import annotations

from keyword import iskeyword

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.slips.code import (
    BARE,
    CLOSING,
    OPENING,
    Guess,
    Guesses,
    PythonToken,
    WrongBlock,
    change,
    is_value_end,
)


def brackets(code: WrongBlock) -> Guesses:
    """Brackets that are missing or superfluous."""
    opened: list[int] = []
    unmatched: list[int] = []
    pairs: list[tuple[int, int]] = []
    for index, token in enumerate(code.tokens):
        if token.kind != "sign":
            continue
        if token.text in OPENING:
            opened.append(index)
        elif token.text in CLOSING:
            if opened and code.tokens[opened[-1]].text == CLOSING[token.text]:
                pairs.append((opened.pop(), index))
            else:
                unmatched.append(index)
    for index in unmatched:
        yield from _unmatched(code, index, opened)
    for index in reversed(opened):
        yield from _unclosed(code, index)


def _unmatched(code: WrongBlock, index: int, opened: list[int]) -> Guesses:
    token = code.tokens[index]
    around = next((each for each in reversed(opened) if each < index), None)
    if around is not None:
        meant = OPENING[code.tokens[around].text]
        message = f"`{token.text}` does not close `{code.tokens[around].text}`. Write `{meant}`."
        yield from _unclosed(code, around, index)
        yield change(token, meant, "LRP513", message)
    opening = CLOSING[token.text]
    for gap in range(index - 2, -1, -1):
        left, right = code.get(gap), code.get(gap + 1)
        if left.line != token.line or left.text in (";", ":"):
            break
        if left.kind == "name" and (code.is_gap(gap) or right.kind in ("string", "number")):
            message = f"A `(` is missing after `{left.text}`. Insert it."
            yield Guess("LRP513", message, left.start, right.end, (Edit(left.end, right.start, opening),))
    before = code.get(index - 1)
    if before.kind == "name" and code.get(index - 2).text == "." and not iskeyword(before.text):
        message = f"A `{opening}` is missing after `{before.text}`. Insert it."
        yield Guess("LRP513", message, before.start, token.end, (Edit(token.start, token.start, opening),))
    message = f"Unmatched `{token.text}`: no `{opening}` is open here. Remove it."
    yield change(token, "", "LRP513", message)


_MEASURES = frozenset({"abs", "len", "min", "max", "round", "int", "float", "sum", "sqrt", "hypot"})
_COMPARISONS = frozenset({"<", ">", "<=", ">=", "==", "!=", "and", "or", "if", "else"})


def _unclosed(code: WrongBlock, index: int, stop: int | None = None) -> Guesses:
    """Close a bracket: in its line, then at the ends of later lines."""
    token = code.tokens[index]
    closing = OPENING[token.text]
    inside = [each for each in range(index, len(code.tokens)) if code.tokens[each].line == token.line]
    ends = [inside[-1]]
    is_call = code.get(index - 1).text in _MEASURES
    depth = 0
    for each in inside[1:]:
        text = code.tokens[each].text
        depth += (text in OPENING) - (text in CLOSING)
        if is_call and not depth and text in _COMPARISONS:
            ends.insert(0, each - 1)
            break
    if stop is not None:
        ends = [stop - 1]
    else:
        if code.tokens[ends[-1]].text in (":", ";", ","):
            ends.insert(-1, ends[-1] - 1)
            while code.tokens[ends[-2]].text in (":", ";", ","):
                ends[-2] -= 1
        for each in inside[1:-1]:
            if code.tokens[each].text in (":", ";") and code.tokens[each - 1].text not in (":", ";"):
                ends.insert(0 if code.tokens[each].text == ":" else len(ends), each - 1)
        ends += reversed(inside[:-1])
        later = [line[-1] for line in code.lines() if code.tokens[line[0]].line > token.line]
        ends += later[:6]
    for each in dict.fromkeys(ends):
        end = code.tokens[each].end
        if each == index and token.text != "(":
            continue
        shown = code.piece(code.tokens[max(each - 2, index)].start if each > index else token.start, end)
        message = f"This `{token.text}` is not closed. Write `{closing}` after `{shown}`."
        yield Guess("LRP513", message, token.start, token.end, (Edit(end, end, closing),))


def calls_in_brackets(code: WrongBlock) -> Guesses:
    """Change the brackets of a call into parentheses."""
    for index in code.near():
        token, before = code.tokens[index], code.get(index - 1)
        if token.text in ("[", "{") and before.kind == "name" and before.end == token.start:
            last = code.partner(index)
            if any(each.text == "=" for each in code.tokens[index:last]):
                message = f"A call has parentheses. Write `(` instead of `{token.text}`."
                end = code.tokens[last]
                edits = (Edit(token.start, token.end, "("), Edit(end.start, end.end, ")"))
                yield Guess("LRP513", message, token.start, token.end, edits)


def braces(code: WrongBlock) -> Guesses:
    """Braces around statements."""
    edits: list[Edit] = []
    first: PythonToken | None = None
    depth = 0
    for index, token in enumerate(code.tokens):
        before, after = code.get(index - 1), code.get(index + 1)
        if token.text == "{" and (before.text in (")", *BARE) or is_value_end(before)):
            depth += 1
            first = first or token
            edits.append(Edit(before.end, token.end, ":"))
        elif token.text == "}" and depth:
            depth -= 1
            start, end = token.start, token.end
            if code.begins(index) or code.ends(index + 1) or code.begins(index - 1):
                if after.line == token.line:
                    end = after.start
                elif before.line == token.line:
                    start = before.end
            edits.append(Edit(start, end, ""))
    if first is not None:
        message = "Python has no braces around statements. Write `:` instead of `{`, and remove the `}`."
        yield Guess("LRP510", message, first.start, first.end, tuple(edits))

"""Statements whose parts do not fit together: colons, commas, `=`, calls without parentheses."""

from __future__ import annotations

from keyword import iskeyword

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.slips.code import (
    BARE,
    HEADERS,
    OPENING,
    SIMPLE,
    Guess,
    Guesses,
    PythonToken,
    WrongBlock,
    change,
    is_value_end,
)


def colons(code: WrongBlock) -> Guesses:
    """Headers without their colon, and colons that do not belong."""
    for line in code.lines():
        head, last = code.tokens[line[0]], code.tokens[line[-1]]
        if not code.is_near(head) or head.kind != "name":
            continue
        if head.text not in HEADERS:
            if last.text == ":":
                message = "Only a header such as `if …:` ends with `:`. Remove it."
                yield change(last, "", "LRP512", message)
            continue
        message = f"This `{head.text}` needs a `:`. Write it after `{{}}`."
        if head.text == "def" and last.kind == "name" and len(line) == 2:
            edits = (Edit(last.end, last.end, "():"),)
            yield Guess("LRP512", f"This `def` needs `():`. Write it after `{last.text}`.", *head[2:4], edits)
        if head.text == "def" and len(line) > 2 and code.get(line[2]).text == ":":
            name = code.get(line[1])
            message = f"A function needs parentheses. Write `{name.text}()`."
            yield Guess("LRP513", message, name.start, name.end, (Edit(name.end, name.end, "()"),))
        ends = [line[0]] if head.text in BARE else []
        for index in line[1:-1]:
            after = code.tokens[index + 1]
            is_start = after.kind == "name" and (after.text in SIMPLE or not iskeyword(after.text))
            if is_value_end(code.tokens[index]) and is_start:
                ends.append(index)
        if last.text in (";", ",", ".", "=", "->", "=>", "{"):
            yield change(last, ":", "LRP512", f"`{last.text}` does not end a header. Write `:`.")
        ends.insert(0 if head.text not in BARE else 1, line[-1])
        colons = [index for index in line if code.tokens[index].text == ":" and not code.tokens[index].depth]
        for index in dict.fromkeys(ends):
            if colons and index < colons[-1]:
                continue
            end = code.tokens[index].end
            shown = code.piece(head.start, end)
            yield Guess("LRP512", message.format(shown), head.start, end, (Edit(end, end, ":"),))
        for index in line[1:]:
            token = code.tokens[index]
            if token.text in (";", ",") and not (token.depth or colons):
                yield change(token, ":", "LRP512", f"`{token.text}` does not end a header. Write `:`.")


def equals(code: WrongBlock) -> Guesses:
    """Compare instead of assigning, and give an argument its value with `=`."""
    signs = [token for token in code.tokens if token.text == "=" and not token.depth]
    if code.is_condition and len(signs) > 1:
        edits = tuple(Edit(token.start, token.end, "==") for token in signs)
        yield Guess("LRP516", "`=` assigns. Write `==` to compare.", signs[0].start, signs[0].end, edits)
    for index in code.near():
        token = code.tokens[index]
        if token.text == "," and not token.depth and code.get(index + 2).text == "=":
            message = f"A comma does not separate statements. Write `;` before `{code.get(index + 1).text}`."
            yield change(token, ";", "LRP516", message)
        elif token.text == ";" and code.around(index) == "(":
            yield change(token, ",", "LRP516", "Arguments are separated by commas. Write `,`.")
    for index in code.near():
        token = code.tokens[index]
        if token.text == "=":
            if code.around(index) == "{":
                yield change(token, ":", "LRP516", "In `{ }`, a value comes after `:`. Write `:`.")
            before = [each.text for each in code.tokens[:index] if each.line == token.line]
            compares = not {"if", "elif", "while", "assert", "return", "not"}.isdisjoint(before)
            if compares or code.is_condition:
                yield change(token, "==", "LRP516", "`=` assigns. Write `==` to compare.")
            elif "==" in code.problem or "assign" in code.problem:
                message = "Only a name can be assigned. Write one before the `=`, or `==` to compare."
                yield change(token, "==", "LRP516", message)._replace(is_certain=False)
        elif token.text == ":" and code.around(index) == "(" and code.get(index - 1).kind == "name":
            name = code.tokens[index - 1].text
            message = f"An argument has its value after `=`. Write `{name}=`."
            after = code.get(index + 1)
            yield Guess("LRP516", message, token.start, token.end, (Edit(token.start, after.start, "="),))


def unfinished(code: WrongBlock) -> Guesses:
    """Operators with nothing after them."""
    for index in code.near():
        token = code.tokens[index]
        is_last = code.ends(index + 1) or code.get(index + 1).text in _CLOSERS
        if is_last and token.text in _OPERATORS:
            message = f"Something is missing after `{token.text}`. Complete it, or remove the `{token.text}`."
            edit = Edit(code.get(index - 1).end if index else token.start, token.end, "")
            yield Guess("LRP501", message, token.start, token.end, (edit,), False)


_CLOSERS = frozenset({")", "]", "}", ":", ","})
_OPERATORS = frozenset({
    "+", "-", "*", "/", "%", "**", "//", "<", ">", "<=", ">=", "==", "!=", "=", "+=", "-=", "*=", "/=",
    "and", "or", "not", "in", "is", ",", ".", "&", "|",
})  # fmt: skip


def gaps(code: WrongBlock) -> Guesses:
    """Two values without a sign between them: calls without parentheses, missing commas and points."""
    for index in code.near():
        if not code.is_gap(index):
            continue
        left, right = code.tokens[index], code.tokens[index + 1]
        between = Edit(left.end, right.start, "")
        if right.depth:
            message = f"A comma is missing between `{_short(left)}` and `{_short(right)}`. Insert it."
            yield Guess("LRP517", message, left.start, right.end, (Edit(left.end, left.end, ","),))
        calls = list(_calls(code, index))
        is_argument = code.get(index + 2).text == "="
        is_named = is_argument and code.get(index - 1).text == "."
        is_member = left.kind == right.kind == "name" and _root(code, index) == "robot"
        if left.text != "robot" and (right.kind != "name" or is_named):
            yield from calls
        if is_member:
            message = f"A `.` is missing between `{left.text}` and `{right.text}`. Write it without spaces."
            yield Guess("LRP517", message, left.start, right.end, (between._replace(text="."),))
        if is_named or not is_argument:
            yield from calls
        before = [each.text for each in code.tokens[:index] if each.line == left.line]
        if right.kind == "name" and (left.text == ")" or "=" in before):
            is_whole = not code.ends(index + 2) or iskeyword(right.text)
            message = f"Two statements are in one line. Write `;` before `{_short(right)}`, or a new line."
            yield Guess("LRP517", message, left.start, right.end, (Edit(left.end, left.end, ";"),), is_whole)
    for index in code.near():
        if code.is_gap(index):
            left, right = code.tokens[index], code.tokens[index + 1]
            if left.kind == "name" and right.kind == "name" and not iskeyword(right.text):
                glued = f"{left.text}_{right.text}"
                pair = f"`{left.text}` and `{right.text}`"
                message = f"A name cannot contain spaces. Write `{glued}`, or a sign between {pair}."
                edit = Edit(left.start, right.end, glued)
                yield Guess("LRP517", message, left.start, right.end, (edit,), False)


def _calls(code: WrongBlock, index: int) -> Guesses:
    """Yield the call of what ends at a token, with the rest of the statement as its arguments."""
    left, right = code.tokens[index], code.tokens[index + 1]
    start = index
    while code.get(start - 1).text == "." and code.get(start - 2).kind == "name":
        start -= 2
    stop = code.statement_end(index)
    if not code.begins(start):
        if left.text not in _FUNCTIONS:
            return
        stop = next((each for each in range(index, stop) if code.tokens[each].text in _AFTER), stop)
    if left.kind == "name":
        end = code.tokens[stop - 1].end
        call = code.piece(code.tokens[start].start, left.end) + "(" + code.piece(right.start, end) + ")"
        edits = (Edit(left.end, right.start, "("), Edit(end, end, ")"))
        is_plain = right.kind == "name" or code.is_condition
        is_certain = left.text in _FUNCTIONS or start < index or not is_plain
        message = f"A call needs parentheses. Write `{call}`."
        yield Guess("LRP517", message, left.start, end, edits, is_certain)


_FUNCTIONS = frozenset(
    {"print", "range", "abs", "len", "min", "max", "round", "int", "float", "str", "bool", "sum"}
)
_AFTER = frozenset({":", ";", "and", "or", "if", "else", "<", ">", "<=", ">=", "==", "!="})


def _short(token: PythonToken) -> str:
    return " ".join(token.text.replace("`", "'").split())[:20]


def _root(code: WrongBlock, index: int) -> str:
    while code.get(index - 1).text == ".":
        index -= 2
    return code.get(index).text


def strays(code: WrongBlock) -> Guesses:
    """Signs and words that should not be there."""
    for index in code.near():
        token = code.tokens[index]
        before = code.get(index - 1)
        if token.kind == "name" and token.text == before.text:
            message = f"`{token.text}` is written twice. Remove one."
            yield Guess("LRP501", message, token.start, token.end, (Edit(before.end, token.end, ""),))
        elif token.kind == "sign" and token.text == before.text and token.text not in OPENING:
            yield change(token, "", "LRP501", f"`{token.text}` is written twice. Remove one.")
    for index in code.near():
        token = code.tokens[index]
        if token.kind == "sign" and token.text in (".", ",", ":", ";", "\\"):
            yield change(token, "", "LRP501", f"There is one `{token.text}` too many. Remove it.")

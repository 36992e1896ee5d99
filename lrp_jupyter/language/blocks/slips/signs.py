"""Signs and characters of other languages, and those that only look right."""

# ruff: noqa: RUF001  (signs that look like others are what this is about)

from __future__ import annotations

import unicodedata
from itertools import pairwise

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.slips.code import OPENING, Guess, Guesses, PythonToken, WrongBlock, change


def signs(code: WrongBlock) -> Guesses:
    """Signs of other languages; all of one kind are one slip."""
    found: dict[str, list[int]] = {}
    for index, token in enumerate(code.tokens):
        if token.kind == "sign" and token.text in _MEANT:
            found.setdefault(token.text, []).append(index)
    for sign, indices in found.items():
        for meant in _MEANT[sign]:
            edits = []
            for index in indices:
                token = code.tokens[index]
                if meant == "." and index:
                    edits.append(Edit(code.tokens[index - 1].end, token.end, meant))
                else:
                    edits.append(_written(code.text, token, meant))
            first = code.tokens[indices[0]]
            message = f"Python has no `{sign}`. Write `{meant.strip()}`."
            yield Guess("LRP510", message, first.start, first.end, tuple(edits))
    yield from _negations(code)
    yield from _increments(code)
    yield from _assignments(code)
    for index, (first, second) in enumerate(pairwise(code.tokens)):
        is_pair = first.kind == "sign" and first.text in "=!<>+-*/" and second.text == "="
        if is_pair and first.end < second.start:
            sign = "=" if first.text == "=" and _is_assigned(code, index) else f"{first.text}="
            message = f"`{code.text[first.start : second.end]}` is two signs. Write `{sign}`."
            yield Guess("LRP510", message, first.start, second.end, (Edit(first.start, second.end, sign),))


_MEANT: dict[str, tuple[str, ...]] = {
    "&&": ("and",),
    "||": ("or",),
    "===": ("==",),
    "!==": ("!=",),
    "=>": (">=", ":"),
    "=<": ("<=",),
    "<>": ("!=",),
    "=:": ("=",),
    "::": (".", ":"),
    "->": (".", "="),
}


def _negations(code: WrongBlock) -> Guesses:
    signs = [index for index, token in enumerate(code.tokens) if token.text in ("!", "=!")]
    if not signs:
        return
    first = code.tokens[signs[0]]
    for index in signs:
        token, after = code.tokens[index], code.get(index + 1)
        if token.text == "=!" and (after.kind in ("number", "string") or not code.begins(index - 1)):
            yield change(token, "!=", "LRP510", "Python has no `=!`. Write `!=`.")
    for wrapped in (False, True):
        edits = []
        for index in signs:
            token = code.tokens[index]
            word = "= not" if token.text == "=!" else "(not" if wrapped else "not"
            edits.append(_worded(code.text, token, word))
            if edits[-1].text.startswith(" (") or code.get(index - 1).text in OPENING:
                edits[-1] = edits[-1]._replace(text=edits[-1].text.lstrip())
            if code.get(index + 1).start > token.end:
                edits[-1] = edits[-1]._replace(text=edits[-1].text.rstrip())
            if wrapped and token.text == "!":
                end = code.tokens[code.chain_end(index + 1) - 1].end
                edits.append(Edit(end, end, ")"))
        message = f"Python has no `{first.text}`. Write `not`."
        yield Guess("LRP510", message, first.start, first.end, tuple(edits))
    for index in signs:
        token = code.tokens[index]
        yield change(token, "!=", "LRP510", f"Python has no `{token.text}`. Write `!=`.")


def _increments(code: WrongBlock) -> Guesses:
    for index, token in enumerate(code.tokens):
        if token.text not in ("++", "--"):
            continue
        added = f" {token.text[0]}= 1"
        message = f"Python has no `{token.text}`. Write `{added.strip()}`."
        if code.ends(index + 1):
            edit = Edit(code.get(index - 1).end if index else token.start, token.end, added)
            yield Guess("LRP510", message, token.start, token.end, (edit,))
        elif code.begins(index):
            end = code.tokens[code.chain_end(index + 1) - 1].end
            edits = (Edit(token.start, code.tokens[index + 1].start, ""), Edit(end, end, added))
            yield Guess("LRP510", message, token.start, token.end, edits)


def _assignments(code: WrongBlock) -> Guesses:
    signs = [index for index, token in enumerate(code.tokens) if token.text == ":="]
    plain = [index for index in signs if _is_assigned(code, index)]
    message = "`:=` belongs outside of blocks. In Python, `=` assigns: write `=`."
    if plain and not code.is_condition:
        first = code.tokens[plain[0]]
        edits = tuple(Edit(code.tokens[index].start, code.tokens[index].end, "=") for index in plain)
        yield Guess("LRP510", message, first.start, first.end, edits)
    for index in signs:
        if code.is_condition:
            yield change(code.tokens[index], "==", "LRP516", "`:=` assigns. Write `==` to compare.")
        yield change(code.tokens[index], "=", "LRP510", message)
        yield change(code.tokens[index], "==", "LRP516", "`:=` assigns. Write `==` to compare.")


def _is_assigned(code: WrongBlock, index: int) -> bool:
    """Return whether a sign follows what begins a statement, so that it probably assigns."""
    starts = range(max(index - 9, 0), index)
    follows = any(code.begins(start) and code.chain_end(start) == index for start in starts)
    return follows and not code.is_condition


def characters(code: WrongBlock) -> Guesses:
    """Characters that Python does not know: typographic quotes, mathematical signs, invisible ones."""
    strange = [token for token in code.tokens if token.kind == "other"]
    for chosen in ([token for token in strange if _ascii(token.text) in ("'", '"')], strange):
        known = [token for token in chosen if _ascii(token.text) is not None]
        if known:
            edits = [_written(code.text, token, _ascii(token.text) or "") for token in known]
            first, meant = known[0], _ascii(known[0].text) or ""
            remedy = f"Write `{meant}`" if meant.strip() else "Write a space" if meant else "Remove it"
            shown = f"`{first.text}`" if first.text.isprintable() else "this invisible character"
            message = f"Python does not know {shown}. {remedy}."
            yield Guess("LRP510", message, first.start, first.end, tuple(edits))
    for token in strange[:3]:
        shown = f"`{token.text}`" if token.text.isprintable() else "this invisible character"
        message = f"Python does not know {shown}. Remove it."
        yield change(token, "", "LRP510", message)


_SIGNS = {
    **dict.fromkeys("“”„‟«»″", '"'),
    **dict.fromkeys("‘’‚‛´′`", "'"),
    **dict.fromkeys("−–—‐‑", "-"),
    **dict.fromkeys("×·⋅∙", "*"),
    **dict.fromkeys("\u200b\u200c\u200d\u2060\ufeff\u00ad\u200e\u200f", ""),
    "≤": "<=", "⩽": "<=", "≥": ">=", "⩾": ">=", "≠": "!=", "≡": "==", "÷": "/", "∕": "/",
    "²": "**2", "³": "**3",
    "∧": "and", "∨": "or", "¬": "not", "←": "=", "≔": "=", "…": "...", "→": ".",
}  # fmt: skip


def _written(text: str, token: PythonToken, meant: str) -> Edit:
    return _worded(text, token, meant) if meant.isalpha() else Edit(token.start, token.end, meant)


def _worded(text: str, token: PythonToken, word: str) -> Edit:
    """Return the edit that writes a word instead of a sign, with blanks around it."""
    start, end = token.start, token.end
    before = "" if text[start - 1 : start].isspace() or start == 0 else " "
    return Edit(start, end, f"{before}{word}" + ("" if text[end : end + 1].isspace() else " "))


def _ascii(character: str) -> str | None:
    meant = _SIGNS.get(character)
    if meant is None:
        plain = unicodedata.normalize("NFKC", character)
        meant = plain if plain.isascii() and plain != character and plain.isprintable() else None
    return meant


def comments(code: WrongBlock) -> Guesses:
    """Comments as the text outside of blocks, or another language, writes them."""
    # the last sign of a line first, because what is before it may be code: `x = 1; y = 2 ; go on`
    for index in sorted(code.near(), key=lambda each: (code.tokens[each].line != code.at, -each)):
        token, after = code.tokens[index], code.get(index + 1)
        if token.text in (";", "//", "--") and after.line == token.line and after.text not in (";", "}"):
            message = f"In a block, `{token.text}` does not begin a comment. Write `#`."
            yield change(token, "#", "LRP510", message)
        elif token.text == "/" and after.text.startswith("*") and after.start == token.end:
            end = code.text.find("*/", after.end)
            edits = [Edit(token.start, after.end, "#")]
            if end >= 0:
                edits.append(Edit(end, end + 2, ""))
            yield Guess("LRP510", "Python has no `/*`. Write `#`.", token.start, after.end, tuple(edits))


def conditionals(code: WrongBlock) -> Guesses:
    """Conditional expressions of other languages: ``test ? one : other``."""
    for index in code.near():
        token = code.tokens[index]
        if token.text != "?":
            continue
        whole = range(index, code.statement_end(index))
        colon = next((each for each in whole if code.get(each).text == ":"), None)
        start = index
        while not code.begins(start) and code.get(start - 1).text not in ("=", "return", "(", ",", "[", "+="):
            start -= 1
        if colon is None or start == index or colon == index + 1:
            continue
        end = code.statement_end(colon)
        while end > colon + 1 and code.get(end - 1).text in (")", "]") and code.around(end - 1) == "":
            end -= 1
        if end == colon + 1:
            continue
        first, middle, last = (
            code.text[code.tokens[one].start : code.tokens[other - 1].end]
            for one, other in ((start, index), (index + 1, colon), (colon + 1, end))
        )
        meant = f"{middle} if {first} else {last}"
        edit = Edit(code.tokens[start].start, code.tokens[end - 1].end, meant)
        shown = " ".join(meant.replace("`", "'").split())
        yield Guess("LRP510", f"Python has no `?`. Write `{shown}`.", token.start, token.end, (edit,))

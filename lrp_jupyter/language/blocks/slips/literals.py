"""Numbers and strings that are written in ways that Python does not accept."""

from __future__ import annotations

import re

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.slips.code import Guess, Guesses, WrongBlock, change
from lrp_jupyter.language.spellings import UNITS


def numbers(code: WrongBlock) -> Guesses:
    """Numbers with a decimal comma, leading zeros or a unit."""
    for index in code.near():
        token = code.tokens[index]
        if token.kind != "number":
            continue
        comma, after = code.get(index + 1), code.get(index + 2)
        if comma.text == "," and after.kind == "number" and token.end == comma.start == after.start - 1:
            edit = Edit(comma.start, comma.end, ".")
            message = f"A decimal number has a point. Write `{token.text}.{after.text}`."
            yield Guess("LRP510", message, token.start, after.end, (edit,))
        if re.fullmatch(r"0+[1-9]\d*", token.text):
            plain = token.text.lstrip("0")
            meant = f"0.{plain}" if token.text[1] != "0" else plain
            message = f"A number does not begin with 0. Write `{meant}`"
            yield change(
                token, meant, "LRP501", f"{message}, or `{plain}`." if meant != plain else f"{message}."
            )
        unit = code.get(index + 1)
        if (
            unit.text == "%"
            and unit.start == token.end
            and code.get(index + 2).kind not in ("number", "name")
        ):
            share = f"{float(token.text) / 100:g}"
            message = f"Python has no percentages. Write `{share}`."
            yield Guess("LRP510", message, token.start, unit.end, (Edit(token.start, unit.end, share),))
        if code.is_gap(index) and unit.text in _UNITS and code.get(index + 2).text not in ("=", "(", "."):
            message = f"Python knows no units. Write the number alone: `{token.text}`."
            yield Guess("LRP510", message, token.start, unit.end, (Edit(token.end, unit.end, ""),))
        if match := _WITH_UNIT.fullmatch(token.text):
            message = f"Python knows no units. Write the number alone: `{match[1]}`."
            yield change(token, match[1], "LRP510", message)
        elif match := re.fullmatch(r"(\d+)([A-Za-z_]\w*)", token.text):
            meant = f"{match[1]} * {match[2]}"
            message = f"`{token.text}` is neither a number nor a name. Write `{meant}` to multiply."
            yield change(token, meant, "LRP501", message)


_UNITS = {*filter(None, UNITS), "m", "cm", "mm", "rad", "deg", "degrees", "hz", "Hz", "px"}
_WITH_UNIT = re.compile(rf"(\d+(?:\.\d*)?)({'|'.join(_UNITS)})")
_ITEMS = frozenset("()[]{},")
"""Signs that are rather between strings than in one."""


def strings(code: WrongBlock) -> Guesses:
    """Strings with their own quote inside; for one that is missing, see `mistakes.unclosed`."""
    for index, token in enumerate(code.tokens):
        after = code.get(index + 1)
        if token.kind == "string" and after.kind == "name" and after.start == token.end:
            last = next((each for each in code.tokens[index:] if each.kind == "open"), None)
            quote = token.text[0]
            other = '"' if quote == "'" else "'"
            if last and last.line == token.line and last.text[0] == quote != other:
                whole, end = code.text[token.start + 1 : last.start], last.start + 1
                if other not in whole:
                    message = f"The `{quote}` inside ends this string. Write it with `{other}` around it."
                    pair = (Edit(token.start, token.start + 1, other), Edit(last.start, end, other))
                    yield Guess("LRP514", message, token.start, end, pair, _ITEMS.isdisjoint(whole))

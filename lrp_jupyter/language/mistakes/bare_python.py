"""Python in brackets of another kind, in quotation marks, or without brackets."""

from __future__ import annotations

import re
from itertools import pairwise
from keyword import iskeyword

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.mistakes.form_order import source_length
from lrp_jupyter.language.mistakes.text_draft import (
    Correction,
    Corrections,
    DraftForm,
    Piece,
    TextDraft,
    is_python,
)
from lrp_jupyter.language.python.scanner import brackets, line_end
from lrp_jupyter.language.reading.tokens import ACTIONS, FORM_LINE
from lrp_jupyter.language.spellings import AMOUNT
from lrp_jupyter.language.triggers import FORMS

_WORDS = re.compile(r"[^\W\d]\w*(?:\s+[^\W\d]\w*)*")
_HYPHENS = re.compile(r"\w+(?:-\w+)+")
_TESTED = frozenset({"event", "on", "exit"})
_DOES = re.compile(r"[=<>(\[]")


def _place(form: DraftForm, at: int) -> int | None:
    """Return the index of the part that should be a block, if one is."""
    kinds, keyword = form.kinds, form.keyword
    if keyword in ACTIONS:
        first = at
    elif keyword in ("var", "event"):
        first = 2 if kinds[1:2] in (("ASSIGN",), ("SIGN",)) else 1
    else:
        first = 0 if keyword in ("on", "exit", "ontime") else len(kinds)
    if first >= len(kinds) or kinds[first] in ("BLOCK", "INVALID", "UNCLOSED"):
        return None
    item = form.items[first]
    return None if isinstance(item, DraftForm) and item.kinds[:1] == ("ASSIGN",) else first  # `(x := [1])`


def quoted(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Python in quotation marks."""
    first = _place(form, at)
    if first is None or form.keyword == "var" or form.items[first].kind != "QUOTED":
        return
    item = form.items[first]
    start, end = item.start, item.end
    inside = draft.text[start + 1 : end - 1]
    if is_python(inside) and _DOES.search(inside):
        message = "Python is written in square brackets, not in quotation marks. Write `[…]` here."
        edits = Edit(start, start + 1, "["), Edit(end - 1, end, "]")
        yield _block(form, first, first + 1, "LRP115", message, (start, end), edits)


def bracketed(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Python in round brackets or braces."""
    first = _place(form, at)
    if first is None or not (form.items[first].kind == "LBRACE" or isinstance(form.items[first], DraftForm)):
        return
    text, start = draft.text, form.items[first].start
    close = _end_of_python(text, start + 1)
    which = f"{text[start]} {text[close]}"
    if close < 0 or which not in ("( )", "{ }", "( ]"):
        return
    inside = text[start + 1 : close]
    names = _WORDS.fullmatch(inside.strip())
    is_source = names and form.keyword in FORMS and not iskeyword(names[0])
    is_value = form.keyword == "var" and set(inside) & set(":,")
    if which == "{ }" and (is_source or is_value):
        return
    last = _index(form, close + 1)
    if which == "( ]" and draft.missing > 0 and is_python(inside):
        message = "This block begins with `(` and ends with `]`. Write `[`."
        edit = Edit(start, start + 1, "[")
        yield _block(form, first, None, "LRP115", message, (start, start + 1), (edit,))
    elif which != "( ]" and (last in (None, len(form.items)) or form.keyword not in ("var", "event")):
        if not is_python(inside):
            return
        message = f"Python is written in square brackets, not in `{which}`. Write `[…]` here."
        edits = Edit(start, start + 1, "["), Edit(close, close + 1, "]")
        yield _block(form, first, last, "LRP115", message, (start, close + 1), edits)


def bare(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Python without brackets: up to the source of a transition, the next action, or the end of the form."""
    first = _place(form, at)
    kinds, keyword, text = form.kinds, form.keyword, draft.text
    if first is None or kinds[first] in ("STAR", "LBRACE", "QUOTED", "UNOPENED"):
        return
    if keyword == "event" and kinds[first : first + 2] in (("NAME", "BLOCK"), ("NAME", "INVALID")):
        return
    if keyword == "var" and first == 1 and kinds[1] == "NAME":
        return  # `(var x is 5)` and `(var max speed := [1])`
    start = form.items[first].start
    if first and kinds[first - 1] == "NAME" and form.items[first - 1].end == start:
        return  # `(event is-near […])`
    ends: list[int] = []
    if keyword in FORMS:
        for stop in range(len(kinds) - 1, first + 1, -1):
            length = source_length(kinds[stop:])
            if length and kinds[stop + length : stop + length + 1] == ("ARROW",):
                ends.append(form.items[stop - 1].end)
    else:
        end = _end_of_python(text, start)
        if keyword in ACTIONS:
            for before, item in pairwise(form.items[first:]):
                spaced = item.start < end and text[item.start - 1].isspace()
                if spaced and item.kind in ("BLOCK", "SPAWN_FORM"):
                    ends.append(before.end)
        ends.append(end)
    for end in ends:
        python = text[start:end].rstrip() if end > 0 else ""
        if not is_python(python) or (keyword in FORMS and _is_no_condition(draft, python)):
            continue
        if text[end] == "]":
            message = "A `[` is missing here, before the Python that ends with `]`. Insert it."
            place = start, line_end(text, start)
            yield _block(form, first, None, "LRP103", message, place, (Edit(start, start, "["),))
        elif text[end] != "}":
            end = start + len(python)
            message = "Python is written in square brackets. Write `[…]` around this."
            edits = Edit(start, start, "["), Edit(end, end, "]")
            block = _block(form, first, _index(form, end), "LRP115", message, (start, end), edits)
            yield block._replace(is_certain=keyword not in _TESTED or draft.makes_sense(python))


def _is_no_condition(draft: TextDraft, python: str) -> bool:
    """Return whether Python in the place of a condition is a name with hyphens, a delay, or several parts."""
    if _HYPHENS.fullmatch(python) and python.replace("-", "_") in draft.events | draft.hyphened:
        return True
    return bool(AMOUNT.fullmatch(python) or set(python) & set(",\n\r"))


def _end_of_python(text: str, start: int) -> int:
    """Return the offset of the bracket that closes what is around Python from an offset on; or -1."""
    form = FORM_LINE.search(text, start)
    opened = 0
    for offset, char in brackets(text, start, form.start() if form else None):
        if char in "([{":
            opened += 1
        elif char in ")]}":
            if not opened:
                return offset
            opened -= 1
        elif char == '"':
            return -1
    return -1


def _index(form: DraftForm, end: int) -> int | None:
    """Return the index after the parts up to an offset; None if they are others than they seem to be."""
    index = next((index for index, item in enumerate(form.items) if item.end > end), len(form.items))
    return None if end >= form.end or (form.items[index:] and form.items[index].start < end) else index


def _block(
    form: DraftForm,
    first: int,
    stop: int | None,
    code: str,
    message: str,
    place: tuple[int, int],
    edits: tuple[Edit, ...],
) -> Correction:
    """Return the guess that some parts are a block; without an end, what follows is to be read again."""
    if stop is None:
        return Correction(code, message, *place, edits, form.items, hides=True)
    block = Piece("BLOCK", form.items[first].start, form.items[stop - 1].end)
    return Correction(code, message, *place, edits, [*form.items[:first], block, *form.items[stop:]])

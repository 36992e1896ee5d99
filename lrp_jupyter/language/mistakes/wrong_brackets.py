"""Brackets of the wrong kind around names and forms, and those that are missing or doubled."""

from __future__ import annotations

import re

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.mistakes.text_draft import (
    Correction,
    Corrections,
    DraftForm,
    Piece,
    TextDraft,
    is_complete,
    is_python,
)
from lrp_jupyter.language.python.scanner import line_end
from lrp_jupyter.language.reading.forms import USAGE
from lrp_jupyter.language.reading.tokens import LEGAL, NAMED
from lrp_jupyter.language.triggers import FORMS

_AFTER_NAME = (("ASSIGN",), ("BLOCK",), ("INVALID",))
_FIRST_WORD = re.compile(r"\s*([^\W\d]\w*)")
_CONTAINERS = frozenset({"machine", "state"})
_BLOCKS = frozenset({"BLOCK", "INVALID"})


def form_ends_square(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Forms that end with `]`."""
    bracket = form.items[at]
    if draft.word(bracket) == "]" and draft.missing > 0 and is_complete(form.keyword, form.kinds[:at]):
        start, end = bracket.start, bracket.end
        message = "This form ends with `)`, not with `]`. Write `)`."
        yield Correction("LRP104", message, start, end, (Edit(start, end, ")"),), form.items, hides=True)


def ends_swapped(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Blocks that end with `)]` in the place of `])`."""
    block = form.items[at]
    shorter = draft.word(block)[1:-1].rstrip()
    if draft.missing > 0 and shorter[-1:] == ")" and is_python(shorter[:-1]):
        start, end = block.start + len(shorter), block.end
        message = "The block ends before the form: `]` comes before `)`. Swap them."
        yield Correction("LRP103", message, start, end, (Edit(start, end, "])"),), form.items, hides=True)


def block_ends_round(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Blocks that end with `)`."""
    end = form.items[at].end
    if draft.missing < 0 and draft.text[end : end + 1] == ")" and is_python(draft.word(form.items[at])[1:]):
        message = "A block ends with `]`, not with `)`. Write `]`."
        yield Correction("LRP103", message, end, end + 1, (Edit(end, end + 1, "]"),), form.items, hides=True)


def lost(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Forms without their `(`."""
    start, end, word = form.items[at].start, form.items[at].end, draft.word(form.items[at])
    rest = [*form.kinds[at + 1 :], "CLOSE"]
    begins = word in LEGAL.get(form.keyword, ()) and (at or form.keyword not in _CONTAINERS)
    if begins and draft.missing < 0 and is_complete(word, rest[: rest.index("CLOSE")]):
        message = f"A `(` is missing before `{word}`. Insert it."
        yield Correction("LRP101", message, start, end, (Edit(start, start, "("),), form.items, hides=True)


def bare_form(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Forms without brackets that end with their line, or with the form around them."""
    items, start, word = form.items, form.items[at].start, draft.word(form.items[at])
    if draft.missing or word not in LEGAL.get(form.keyword, ()) or (form.keyword in _CONTAINERS and not at):
        return
    stop, last = line_end(draft.text, start), at
    while last + 1 < len(items) and isinstance(items[last + 1], Piece) and items[last + 1].start < stop:
        last += 1
    if last > at and is_complete(word, form.kinds[at + 1 : last + 1]):
        end = items[last].end
        message = f"This form has no brackets. Write `{USAGE[word]}`."
        edits = Edit(start, start, "("), Edit(end, end, ")")
        whole = Piece(f"{word.upper()}_FORM", start, end)
        yield Correction("LRP101", message, start, end, edits, form.replaced(at, last, whole))


def doubled(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Round brackets around those of a form."""
    inner = form.items[at]
    if not isinstance(inner, DraftForm) or inner.keyword or not inner.items:
        return
    if not isinstance(inner.items[0], DraftForm):
        return
    start, edit = inner.start, Edit(inner.start, inner.start + 1, "")
    if draft.missing > 0:
        message = "This `(` is one too many. Remove it."
        yield Correction("LRP102", message, start, start + 1, (edit,), form.items, hides=True)
    else:
        message = "These brackets are doubled. Remove one pair."
        edits = edit, Edit(inner.end - 1, inner.end, "")
        yield Correction("LRP102", message, start, start + 1, edits, form.replaced(at, at, *inner.items))


def names(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Names and delays in brackets; several sources belong in braces."""
    keyword, kinds, item, last = form.keyword, form.kinds, form.items[at], at
    if item.kind == "LBRACE" and "RBRACE" in kinds[at:]:
        last = kinds.index("RBRACE", at)
    start, end = item.start, form.items[last].end
    inside = draft.text[start + 1 : end - 1].split()
    is_delay = keyword == "ontime" and not at and inside[:1] != [] and inside[0].isdecimal()
    if not inside or not (is_delay or all(map(str.isidentifier, inside))):
        return
    if keyword in FORMS and len(inside) > 1 and draft.states.issuperset(inside) and last == at:
        names = f"{{{' '.join(inside)}}}"
        message = f"Several sources are written in braces. Write `{names}`."
        parts = [Piece(kind, start, end) for kind in ("LBRACE", "NAME", "RBRACE")]
        items = form.replaced(at, last, *parts)
        yield Correction("LRP110", message, start, end, (Edit(start, end, names),), items)
    if len(inside) > (2 if keyword == "spawn" and not at else 1):
        return
    if keyword in NAMED and (at or inside[0] in LEGAL.get(keyword, ())):
        return
    if keyword in ("var", "event") and item.kind in _BLOCKS and kinds[1:2] not in _AFTER_NAME:
        return
    is_call = at == 1 and form.items[0].end == start
    if keyword in ("on", "exit") and (is_call if at else inside[0] not in draft.events):
        return
    plain = " ".join(inside)
    before = "" if draft.text[start - 1 : start].isspace() else " "
    what = "Delays are written without brackets" if is_delay else "Names are written without brackets here"
    parts = [Piece("INTEGER" if is_delay else "NAME", start, end)] * len(inside)
    message, edit = f"{what}. Write `{plain}`.", Edit(start, end, before + plain)
    is_state = item.kind == "FORM" and keyword in FORMS and plain in draft.states
    items = form.replaced(at, last, *parts)
    yield Correction("LRP110", message, start, end, (edit,), items, alone=is_state)


def square_form(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Forms in square brackets."""
    if keyword := is_form(draft.word(form.items[at])[1:-1], form.keyword):
        yield _in_round_ones(form, at, at, keyword)


def braced_form(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Forms in braces."""
    keyword = draft.word(form.items[at + 1]) if form.kinds[at + 1 : at + 2] == ("NAME",) else ""
    depth = 0
    for last in range(at, len(form.items)):
        depth += (form.kinds[last] == "LBRACE") - (form.kinds[last] == "RBRACE")
        if not depth and keyword in LEGAL.get(form.keyword, ()):
            yield _in_round_ones(form, at, last, keyword)
            break


def _in_round_ones(form: DraftForm, at: int, last: int, keyword: str) -> Correction:
    start, end = form.items[at].start, form.items[last].end
    message = f"A form is written in round brackets. Write `({keyword} …)`."
    edits = Edit(start, start + 1, "("), Edit(end - 1, end, ")")
    whole = Piece(f"{keyword.upper()}_FORM", start, end)
    return Correction("LRP104", message, start, end, edits, form.replaced(at, last, whole))


def is_form(inside: str, around: str) -> str:
    """Return the keyword of a form that is written in the brackets of a block, or an empty text."""
    found = _FIRST_WORD.match(inside)
    keyword = found[1] if found else ""
    return keyword if keyword in LEGAL.get(around, ()) and not is_python(inside) else ""

"""Which keyword is meant by a word after `(`, or by a form that has none."""

from __future__ import annotations

from collections.abc import Sequence

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.mistakes.text_draft import (
    Correction,
    Corrections,
    DraftForm,
    Item,
    TextDraft,
    as_if,
    is_complete,
)
from lrp_jupyter.language.reading.forms import USAGE
from lrp_jupyter.language.reading.tokens import KEYWORDS, LEGAL
from lrp_jupyter.language.spellings import FOLLOWERS, OTHERS, closest
from lrp_jupyter.language.triggers import FORMS


def two_words(draft: TextDraft, form: DraftForm) -> Corrections:
    """Keywords in two words, as in ``(on entry […])``."""
    items = form.items
    if form.keyword.lower() not in ("on", "state") or not items:
        return
    joined = draft.word(items[0]) in ("-", ".")
    second, after = (*items[joined:], *[None] * 2)[:2]
    if second is None or second.kind != "NAME" or draft.word(second) in draft.events:
        return
    word, kind = draft.word(second).lower(), after.kind if after else ""
    if form.keyword == "state":
        meant = "machine" if word == "machine" and kind == "NAME" else ""
    else:
        meant = next((meant for meant, words in FOLLOWERS.items() if word in words), "")
        timed = kind in ("INTEGER", "AMOUNT") or (joined and kind == "NAME")
        acts = kind in ("BLOCK", "INVALID", "UNCLOSED") or isinstance(after, DraftForm)
        meant = meant if (timed if meant == "ontime" else acts) else ""
    if meant:
        yield _guess(draft, form, meant, second.end, items[joined + 1 :])


def misspelt(draft: TextDraft, form: DraftForm) -> Corrections:
    """Keywords that are misspelt, of other languages, or missing."""
    word = form.keyword
    if word in KEYWORDS:
        return
    meant, is_certain = _meant(form) if word else ("", True)
    if meant:
        yield _guess(draft, form, meant, form.head, form.items, is_certain)
    elif inferred := _inferred(form):
        start = form.start
        message = f"The keyword is missing after this `(`. Write `{USAGE[inferred]}`."
        edit = Edit(start + 1, start + 1, f"{inferred} ")
        name = form.name()
        yield Correction("LRP106", message, start, start + 1, (edit,), [*name, *form.items], keyword=inferred)


def _guess(
    draft: TextDraft, form: DraftForm, meant: str, end: int, items: Sequence[Item], is_certain: bool = True
) -> Correction:
    start = form.head - len(form.keyword)
    word = draft.text[start:end]
    message = f"`{word}` is not a keyword. Did you mean `{meant}`?"
    if word.lower() == meant:
        message = f"Keywords are written in lowercase. Write `{meant}`."
    begins = any(keyword.startswith(word) for keyword in KEYWORDS)
    edit = Edit(start, end, meant)
    return Correction("LRP106", message, start, end, (edit,), items, is_certain, False, begins, meant)


def _meant(form: DraftForm) -> tuple[str, bool]:
    """Return the keyword that a word probably stands for, and whether that is certain."""
    plain = form.keyword.lower().replace("_", "")
    if plain in KEYWORDS:
        return plain, True
    legal = sorted(LEGAL.get(form.around, KEYWORDS))
    meant = [keyword for keyword in OTHERS.get(plain, ()) if keyword in legal]
    if meant and meant[0] in FORMS:
        meant = [_kind_of_transition(form.items, meant[0])]
    close = closest(plain, legal, 0.6) or closest(plain, KEYWORDS, 0.8)
    kinds = as_if(form.items)
    if close in ("on", "eps") and kinds[:1] == ("INTEGER",):
        close = "ontime"
    inferred = _inferred(form)
    for keyword in (*meant[:1], close):
        if keyword and (not inferred or is_complete(keyword, kinds)):
            return keyword, True
    return ("" if inferred else next(iter(OTHERS.get(plain, ())), "")), False


def _kind_of_transition(items: Sequence[Item], meant: str) -> str:
    """Return which kind of transition has these parts."""
    kinds = as_if(items)
    if kinds[:1] == ("INTEGER",):
        return "ontime"
    return "eps" if kinds[:1] == ("LBRACE",) or kinds[1:2] == ("ARROW",) else meant


def _inferred(form: DraftForm) -> str:
    """Return the only keyword with which a form without one would be right; else an empty text."""
    kinds = as_if([*form.name(), *form.items])
    if len(kinds) < (1 if form.around == "machine" else 2):
        return ""
    found = [keyword for keyword in sorted(LEGAL.get(form.around, ())) if is_complete(keyword, kinds)]
    if "machine" in found and "STATE_FORM" not in kinds:
        found.remove("machine")
    if "on" in found and kinds[0] != "INTEGER":
        return "on"
    return found[0] if len(found) == 1 else ""

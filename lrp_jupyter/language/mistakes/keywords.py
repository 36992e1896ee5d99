"""Which keyword is meant by a word after `(`, or by a form that has none."""

from __future__ import annotations

from collections.abc import Sequence

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.mistakes.text_draft import (
    Correction,
    Corrections,
    DraftForm,
    Item,
    Piece,
    TextDraft,
    as_if,
    is_complete,
)
from lrp_jupyter.language.reading.forms import USAGE
from lrp_jupyter.language.reading.tokens import KEYWORDS, LEGAL
from lrp_jupyter.language.spellings import FOLLOWERS, LAST, OTHERS, REMARKS, closest
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
        found = [meant for meant, words in FOLLOWERS.items() if word in words]
        meant = next((meant for meant in found if meant in LEGAL.get(form.around, ())), next(iter(found), ""))
        number = as_if(after.items) if isinstance(after, DraftForm) else (kind,)  # `after(2000)`
        timed = number in (("INTEGER",), ("AMOUNT",)) or (joined and kind == "NAME")
        acts = kind in ("BLOCK", "INVALID", "UNCLOSED") or isinstance(after, DraftForm)
        meant = meant if (timed if meant == "ontime" else acts) else ""
    if meant:
        yield _guess(draft, form, meant, second.end, items[joined + 1 :])


def misspelt(draft: TextDraft, form: DraftForm) -> Corrections:
    """Keywords that are misspelt, of other languages, or missing."""
    word = form.keyword
    if word in KEYWORDS:
        acts = "ARROW" not in form.kinds and set(form.kinds) - {"NAME"}
        if word == "exit" and form.around == "state" and acts:
            yield _guess(draft, form, "onexit", *_labelled(draft, form))
        return
    meant, is_certain = _meant(form) if word else ("", True)
    remark = REMARKS.get(_plain(word), "")
    if _plain(word) in LAST and _is_followed(draft, form):
        is_certain = False
    if meant:
        yield _guess(draft, form, meant, *_labelled(draft, form), is_certain)
    elif (inferred := _inferred(form)) and _is_named(draft, form, inferred):
        start, name = form.start, form.name()
        message = f"The keyword is missing after this `(`. Write `{USAGE[inferred]}`."
        edit = Edit(start + 1, start + 1, f"{inferred} ")
        yield Correction("LRP106", message, start, start + 1, (edit,), [*name, *form.items], keyword=inferred)
    elif remark:
        place = form.first, form.head
        message = f"`{word}` is not a keyword. {remark}"
        yield Correction("LRP106", message, *place, (), form.items, False, keyword=word)


def effect_first(draft: TextDraft, form: DraftForm) -> Corrections:
    """Transitions with the word for what they do in front: ``(effect e a -> b [x = 1])``."""
    if form.keyword != "effect" or form.around != "machine" or "ARROW" not in form.kinds:
        return
    blocks = len(form.items)
    while form.kinds[blocks - 1] == "BLOCK":
        blocks -= 1
    head, acts = form.items[:blocks], form.items[blocks:]
    end = Piece("EFFECT_FORM", acts[0].start, acts[-1].end) if acts else None
    items = [*head, *([end] if end else [])]
    meant = next((each for each in FORMS if is_complete(each, as_if(items))), "")
    if not meant:
        return
    edits = [Edit(form.first, form.head, meant)]
    written = f"({meant} {draft.text[head[0].start : head[-1].end]})"
    if end is not None:
        edits += [Edit(end.start, end.start, "(effect "), Edit(end.end, end.end, ")")]
        written = f"{written[:-1]} (effect {draft.text[end.start : end.end]}))"
    names = {draft.word(item) for item in head if item.kind == "NAME"}
    is_certain = names <= draft.states | draft.events
    message = f"An `effect` is the end of a transition. Write `{written}`."
    yield Correction("LRP108", message, form.first, form.head, tuple(edits), items, is_certain, keyword=meant)


def _is_named(draft: TextDraft, form: DraftForm, keyword: str) -> bool:
    """Return whether what is in the place of a keyword can be the first part of a form."""
    word = form.keyword
    if keyword == "on":
        return not word or word in draft.events
    is_name = _plain(word) not in REMARKS or word in draft.names
    return is_name or any(isinstance(item, DraftForm) for item in form.items)


def _is_followed(draft: TextDraft, form: DraftForm) -> bool:
    """Return whether a later transition leaves the state that this one leaves."""
    sources = _sources(draft, form)
    others = [item for item in form.row if isinstance(item, DraftForm) and item.start > form.start]
    return any(sources & _sources(draft, other) for other in others if other.keyword in FORMS)


def _sources(draft: TextDraft, form: DraftForm) -> set[str]:
    before = form.items[: form.kinds.index("ARROW")] if "ARROW" in form.kinds else []
    names = {draft.word(item) for item in before}
    return draft.states if "*" in names else names & draft.states


def _plain(word: str) -> str:
    return word.lower().replace("_", "")


def _labelled(draft: TextDraft, form: DraftForm) -> tuple[int, Sequence[Item]]:
    """Return the end of a keyword and what follows it, without the `/` of ``entry / x = 1``."""
    first = form.items[0] if form.items else None
    if first is not None and draft.word(first) in ("/", ":"):
        return first.end, form.items[1:]
    return form.head, form.items


def _guess(
    draft: TextDraft, form: DraftForm, meant: str, end: int, items: Sequence[Item], is_certain: bool = True
) -> Correction:
    start = form.first
    word = draft.text[start:end]
    is_same = word.lower() == meant
    problem, remark = f"`{word}` is not a keyword.", REMARKS.get(_plain(word), "")
    message = f"{problem} {remark if f'`{meant}`' in remark else f'Did you mean `{meant}`?'}"
    if is_same:
        message = f"Keywords are written in lowercase. Write `{meant}`."
    elif form.keyword == "exit":
        message = "`exit` is a transition. What a state does when it is left is its `onexit`. Write `onexit`."
    begins = any(keyword.startswith(word) for keyword in KEYWORDS)
    edit = Edit(start, end, meant if end == form.head or draft.spaced(end) else f"{meant} ")
    return Correction(
        "LRP106",
        message,
        start,
        end,
        (edit,),
        items,
        is_certain,
        is_prefix=begins,
        keyword=meant,
        alone=is_same,
        doubt=f"{problem} {remark}" if remark else "",
    )


def _meant(form: DraftForm) -> tuple[str, bool]:
    """Return the keyword that a word probably stands for, and whether that is certain."""
    plain = _plain(form.keyword)
    if plain in KEYWORDS:
        return plain, True
    legal = sorted(LEGAL.get(form.around, () if form.around in KEYWORDS else KEYWORDS))
    meant = [keyword for keyword in OTHERS.get(plain, ()) if keyword in legal]
    if meant and meant[0] in FORMS:
        meant = [_kind_of_transition(form.items, meant[0])]
    close = closest(plain, legal, 0.6) or closest(plain, KEYWORDS, 0.8)
    if plain in REMARKS or (plain in OTHERS and not meant):
        close = ""
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
    if meant == "eps" and is_complete("on", kinds):
        return "on"
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

"""Parts of a form that are in the wrong order or missing, and signs that are wrong."""

from __future__ import annotations

import re
from collections.abc import Sequence

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.mistakes.text_draft import (
    SIGNS,
    Correction,
    Corrections,
    DraftForm,
    Item,
    Piece,
    TextDraft,
    as_if,
    is_complete,
)
from lrp_jupyter.language.python.scanner import line_end
from lrp_jupyter.language.reading.forms import USAGE, article
from lrp_jupyter.language.reading.tokens import LEGAL
from lrp_jupyter.language.spellings import ARROW_WORDS, ASSIGN_WORDS
from lrp_jupyter.language.triggers import FORMS

_ACTION = re.compile(r"\brobot\.(?!stop\b|pen\b|lamp\b)\w+(?:\s*\(|\s+as\b)|[+\-*/]=")
"""What is probably meant to be repeated: a robot that gets no command for a while stops."""


def wrong_arrow(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Signs and words in the place of the arrow of a transition."""
    items, kinds = form.items, form.kinds
    if "ARROW" in kinds:
        return
    for index, item in reversed([*enumerate(items)]):  # a sign before it is one of a condition
        word, start, end = draft.word(item), item.start, item.end
        is_exception = item.kind == "MINUS" and kinds[index - 1 :: 2][:2] == ("STAR", "LBRACE")
        is_sign = item.kind in SIGNS and not is_exception
        is_between = item.kind == "NAME" and 0 < index < len(items) - 1
        is_word = is_between and word.lower() in ARROW_WORDS and word not in draft.states
        if not (is_sign or is_word):
            continue
        message = f"The arrow to the destination is `->`, not `{word}`. Write `->`."
        tight = draft.text[start - 1 : start] + draft.text[end : end + 1]
        edit = Edit(start, end, "->" if is_sign or tight.isspace() else " -> ")
        parts = form.replaced(index, index, Piece("ARROW", start, end))
        yield Correction("LRP104", message, start, end, (edit,), parts, "<" not in word, alone=is_sign)


def no_arrow(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Transitions without their arrow."""
    items, kinds = form.items, form.kinds
    first = int(form.keyword != "eps")
    index = first + source_length(kinds[first:])
    names = kinds[index:]
    if index > first and names in (("NAME",), ("NAME", "NAME")[: 1 + first]):
        before, start, end = items[index - 1].end, items[index].start, items[index].end
        message = "The arrow `->` is missing before the destination. Insert it."
        parts = [*items[:index], Piece("ARROW", before, before), *items[index:]]
        sources = {draft.word(item) for item in items[first:index] if item.kind == "NAME"}
        is_certain = draft.states >= sources
        yield Correction("LRP108", message, start, end, (Edit(before, before, " ->"),), parts, is_certain)


def no_assignment(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Variables without `:=`."""
    if form.kinds in (("NAME", "BLOCK"), ("NAME", "INVALID")):
        name, block = form.items
        message = f"`:=` is missing between the name and its value. Write `{USAGE[form.keyword]}`."
        edit = Edit(name.end, name.end, " :=" if draft.text[name.end].isspace() else " := ")
        parts = [name, Piece("ASSIGN", name.end, name.end), block]
        yield Correction("LRP108", message, block.start, block.end, (edit,), parts)


def wrong_sign(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Signs and words in the place of `:=`, and signs in forms that have none."""
    if len(form.items) != 3:
        return
    name, sign, last = form.items
    word, start, end = draft.word(sign), sign.start, sign.end
    if form.keyword == "var" and (sign.kind in SIGNS or word in ASSIGN_WORDS):
        message = f"A variable gets its value with `:=`, not with `{word}`. Write `:=`."
        parts = [name, Piece("ASSIGN", start, end), last]
        yield Correction("LRP104", message, start, end, (Edit(start, end, ":="),), parts)
    elif form.keyword != "var" and sign.kind in SIGNS:
        message = f"There is no `{word}` in `{form.keyword}`. Write `{USAGE[form.keyword]}`."
        yield Correction("LRP104", message, start, end, (Edit(start, end, " "),), [name, last])


def sources(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Several sources without braces, or with one of them."""
    first = int(form.keyword != "eps")
    kinds = form.kinds
    if "ARROW" not in kinds[first:]:
        return
    arrow = kinds.index("ARROW", first)
    items = form.items[first:arrow]
    inside = [item for item in items if item.kind == "NAME"]
    braces = {"LBRACE", "RBRACE"} & set(kinds[first:arrow])
    starred = kinds[first : first + 2] == ("STAR", "MINUS")
    alone = not braces and len(inside) < 2 and not starred
    if len(braces) == 2 or alone or not inside or not draft.states.issuperset(map(draft.word, inside)):
        return
    start, end = inside[0].start, inside[-1].end
    edits = [] if "LBRACE" in braces else [Edit(start, start, "{")]
    edits += [] if "RBRACE" in braces else [Edit(end, end, "}")]
    message = f"Several sources are written in braces. Write `{{{' '.join(map(draft.word, inside))}}}`."
    group = [Piece("LBRACE", start, start), *inside, Piece("RBRACE", end, end)]
    parts = [*form.items[:first], *items[: 2 * starred], *group, *form.items[arrow:]]
    yield Correction("LRP108", message, start, end, tuple(edits), parts)


def trigger_last(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Events and delays at the end of a transition."""
    items, kinds = form.items, form.kinds
    arrow = source_length(kinds)
    if not arrow or kinds[arrow:-1] != ("ARROW", "NAME"):
        return
    first, destination, trigger = items[0], items[arrow + 1], items[-1]
    word = draft.word(trigger)
    known = draft.defined["var" if form.keyword == "ontime" else "event"]
    if (trigger.kind != "NAME" and word != ",") or (word in known and word not in draft.states):
        what = "The delay" if form.keyword == "ontime" else "The event"
        message = f"{what} comes before the states. Write `{USAGE[form.keyword]}`."
        edits = Edit(first.start, first.start, f"{word} "), Edit(destination.end, trigger.end, "")
        yield Correction("LRP108", message, trigger.start, trigger.end, edits, [trigger, *items[:-1]])


def other_keyword(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Transitions with the parts of another kind."""
    kinds, start = form.kinds, form.first
    if form.keyword == "on" and kinds[:1] == ("INTEGER",):
        meant, reason = "ontime", "A delay belongs in `ontime`"
    elif form.keyword == "eps" and kinds[1:3] in (("NAME", "ARROW"), ("STAR", "ARROW")):
        meant = "ontime" if kinds[0] == "INTEGER" else "on"
        reason = "An `eps` has neither an event nor a delay"
    else:
        return
    if draft.text[start : form.head] == form.keyword:  # else it is misspelt, which is reported already
        edit = Edit(start, form.head, meant)
        message = f"{reason}. Write `{meant}`."
        yield Correction("LRP108", message, start, form.head, (edit,), form.items, keyword=meant)


def several_variables(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Several variables in one `var`."""
    rest = form.items[3:]
    comma = rest[:1] if rest and draft.word(rest[0]) == "," else []
    if form.kinds[:3] == ("NAME", "ASSIGN", "BLOCK") and is_complete("var", as_if(rest[len(comma) :])):
        name = rest[len(comma)]
        message = f"Each variable has a `var` of its own. Write `(var {draft.word(name)} := [value])`."
        edit = Edit(form.items[2].end, name.start, ") (var ")
        yield Correction("LRP108", message, name.start, rest[-1].end, (edit,), form.items[:3])


def name_last(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Blocks before their name."""
    items, kinds = form.items, form.kinds
    if kinds in (("BLOCK", "NAME"), ("BLOCK", "ASSIGN", "NAME")):
        block, name = items[0], items[-1]
        message = f"The name comes before the block. Write `{USAGE[form.keyword]}`."
        edits = Edit(block.start, block.end, draft.word(name)), Edit(name.start, name.end, draft.word(block))
        yield Correction("LRP108", message, block.start, block.end, edits, [name, *items[1:-1], block])


def several_words(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Names of several words."""
    kinds = form.kinds
    count = next((index for index, kind in enumerate(kinds) if kind != "NAME"), len(kinds))
    name = "_".join(map(draft.word, form.items[:count]))
    if count > 1 and name in draft.known():
        start, end = form.items[0].start, form.items[count - 1].end
        parts = [Piece("NAME", start, end), *form.items[count:]]
        message = f"A name is one word. Write `{name}`."
        yield Correction("LRP110", message, start, end, (Edit(start, end, name),), parts)


def phrases(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Names of states and machines that are two words, where they are defined and where they are used."""
    for words, elsewhere in draft.phrases.items():
        items = list(form.items)
        found: list[list[Item]] = []
        for first in reversed(range(len(items) - len(words) + 1)):
            piece = items[first : first + len(words)]
            if tuple(map(draft.word, piece)) == words and {item.kind for item in piece} == {"NAME"}:
                found.insert(0, piece)
                items[first : first + len(words)] = [Piece("NAME", piece[0].start, piece[-1].end)]
        if found:
            name = "_".join(words)
            here = [Edit(piece[0].start, piece[-1].end, name) for piece in found]
            edits = dict.fromkeys([*here, *(elsewhere if form.keyword in ("state", "machine") else ())])
            message = f"A name is one word. Write `{name}`."
            yield Correction("LRP110", message, here[0].start, here[0].end, tuple(edits), items)


def action(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Actions straight in a state."""
    start, end = form.items[at].start, form.items[at].end
    repeats = _ACTION.search(draft.text, start, end) and "RUNNING_FORM" not in form.kinds
    keyword, other = ("running", "onentry") if repeats else ("onentry", "running")
    message = f"An action needs a form that says when it runs. Write `({keyword} […])` or `({other} […])`."
    edits = Edit(start, start, f"({keyword} "), Edit(end, end, ")")
    parts = form.replaced(at, at, Piece(f"{keyword.upper()}_FORM", start, end))
    yield Correction("LRP117", message, start, end, edits, parts)


def effects(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Effects that do not come last, and several of them."""
    items, kinds, text = form.items, form.kinds, draft.text
    rest = [item for item in items if item.kind != "EFFECT_FORM"]
    found = [index for index, kind in enumerate(kinds) if kind == "EFFECT_FORM"]
    if not found or not is_complete(form.keyword, as_if(rest)):
        return
    first, last = items[found[0]], items[found[-1]]
    if len(found) == 1:
        before = items[found[0] - 1].end if found[0] else form.head
        usage = f"{USAGE[form.keyword][:-1]} {USAGE['effect']})"
        message = f"The effect comes last. Write `{usage}`."
        edits = Edit(before, first.end, ""), Edit(rest[-1].end, rest[-1].end, f" {draft.word(first)}")
        is_certain = not text[before : first.start].strip()
        yield Correction("LRP108", message, first.start, first.end, edits, [*rest, first], is_certain)
    elif kinds[found[0] :] == ("EFFECT_FORM", "EFFECT_FORM") and isinstance(last, DraftForm):
        message = (
            "A transition has one effect, with a block for each action. Write `(effect [action] [action])`."
        )
        is_certain = not text[first.end : last.start].strip()
        edit = Edit(first.end - 1, last.head, "")
        whole = Piece("EFFECT_FORM", first.start, last.end)
        yield Correction("LRP108", message, last.start, last.end, (edit,), [*rest, whole], is_certain)


def behind(draft: TextDraft, form: DraftForm) -> Corrections:
    """Forms behind the one in which they belong: a `var` of a `spawn`, the effect of a transition."""
    legal = LEGAL.get(form.keyword, frozenset())
    is_known = form.around and legal and not draft.missing
    for index, owner in enumerate(form.items if is_known else []):
        if not isinstance(owner, DraftForm) or owner.keyword not in _LAST_INSIDE:
            continue
        inner: list[DraftForm] = []
        for item in form.items[index + 1 :]:
            if not isinstance(item, DraftForm) or item.keyword in legal:
                break
            inner += [item] if is_complete(item.keyword, as_if(item.items)) else []
        kinds = (*as_if(owner.items), *[item.kind for item in inner])
        if not inner or not is_complete(owner.keyword, kinds) or not _is_next(draft, form, owner, inner[0]):
            continue
        word, start, end = inner[0].keyword, inner[0].head, inner[-1].end
        where = f"{article(form.keyword)} `{form.keyword}`"
        message = f"`{word}` is not allowed in {where}. Put it in the `{owner.keyword}` before it."
        edits = Edit(owner.end - 1, owner.end, ""), Edit(end, end, ")")
        parts = form.replaced(index, index + len(inner), Piece(owner.kind, owner.start, end))
        names = [draft.word(item.items[0]) for item in inner if item.keyword == "var"]
        machine = draft.word(owner.items[0])
        is_certain = draft.members.get(machine, set()).issuperset(names)
        yield Correction("LRP107", message, start - len(word), start, edits, parts, is_certain, alone=True)
        break


def _is_next(draft: TextDraft, form: DraftForm, owner: DraftForm, inner: DraftForm) -> bool:
    """Return whether a form certainly belongs to the one before it, and not to another one."""
    owners = [item for item in form.items if isinstance(item, DraftForm)]
    owners = [item for item in owners if item is owner or _may_have(draft, item, inner)]
    between = draft.text[owner.end : inner.start]
    if between.strip():
        return False
    if len(owners) == 1:
        return True
    if "\n" in between or "\r" in between:
        return _column(draft, owner) < _column(draft, inner)
    line = line_end(draft.text, inner.end)
    return not any(inner.end < item.start < line for item in owners)


def _may_have(draft: TextDraft, owner: DraftForm, inner: DraftForm) -> bool:
    if owner.keyword == "spawn" and owner.items and inner.keyword == "var":
        return draft.word(inner.items[0]) in draft.members.get(draft.word(owner.items[0]), ())
    return inner.keyword in LEGAL.get(owner.keyword, ())


def _column(draft: TextDraft, form: DraftForm) -> int:
    before = draft.text[: form.start]
    return form.start - max(before.rfind("\n"), before.rfind("\r"))


_LAST_INSIDE = frozenset({"spawn", *FORMS})
"""The forms that contain others, and those after everything else."""


def source_length(kinds: Sequence[str]) -> int:
    """Return the number of parts in the source at the beginning of some; 0 if there is none."""
    if kinds[:1] == ("NAME",):
        return 1
    if kinds[:1] == ("STAR",) and kinds[1:2] != ("MINUS",):
        return 1
    if "RBRACE" in kinds and kinds[0] in ("LBRACE", "STAR"):
        return list(kinds).index("RBRACE") + 1
    return 0

"""Conditions on the state of a machine, and how long a condition must hold, in other notations."""

from __future__ import annotations

import re

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.mistakes.foreign_words import milliseconds
from lrp_jupyter.language.mistakes.form_order import source_length
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
from lrp_jupyter.language.reading.forms import short
from lrp_jupyter.language.reading.tokens import HELD
from lrp_jupyter.language.spellings import HOLDING, UNITS

_ASKED = re.compile(
    r"""[({"']?\s*(?:(?P<path>\w+(?:[./:]+\w+)*?)[./:]+)?(?P<machine>\w+)"""
    r"""(?:\s*(?:[./:,]+|->?|==?)\s*|\s+(?:is\s+|in\s+)?)["']?(?P<state>\w+)["']?(?:\(\))?\s*[)}"']?"""
)
_COMMENT = re.compile(r"[;#]")


def machine_states(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """States of machines: ``move/reached``, ``move reached``, ``(move.reached)``, ``a.move.reached``."""
    items, kinds = form.items, as_if(form.items)
    for stop in range(1, len(items)):
        length = source_length(kinds[stop:])
        if not length or not is_complete("on", ("NAME", *kinds[stop:])):
            continue
        start, end = items[0].start, items[stop - 1].end
        found = _ASKED.fullmatch(draft.text, start, end)
        if not found or found["machine"] not in draft.defined["machine"] - draft.events:
            continue
        if found["state"] not in draft.members.get(found["machine"], set()) & draft.states:
            continue
        path = re.split(r"[./:]+", found["path"]) if found["path"] else []
        if not draft.states | draft.defined["machine"] >= set(path):
            continue
        written = f"{found['machine']}.{found['state']}"
        meant = form.keyword if form.keyword in HELD else "on"
        message = f"The state of a machine is written `machine.state`. Write `{written}`."
        edits = [Edit(start, end, written)]
        if meant != form.keyword:
            message = f"`{form.keyword}` has no condition. Write `{meant} {written}`."
            edits.append(Edit(form.first, form.head, meant))
        sources = set(map(draft.word, items[stop : stop + length]))
        is_certain = not path or path[-1] in sources
        trigger = [Piece(kind, start, end) for kind in ("NAME", "DOT", "NAME")]
        parts = [*trigger, *items[stop:]]
        yield Correction("LRP108", message, start, end, tuple(edits), parts, is_certain, keyword=meant)


def half_named_states(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """States of machines without the name of the state or of the machine: ``move.``, ``.reached``."""
    items, words = form.items, [draft.word(item) for item in form.items[:3]]
    if len(words) < 3 or not isinstance(items[0], Piece):
        return
    start, end = items[0].start, items[1].end
    if words[0] == ".":
        machines = [name for name, inside in draft.members.items() if name and words[1] in inside]
        if len(machines) == 1 and words[1] in draft.states:
            written = f"{machines[0]}.{words[1]}"
            message = f"The name of the machine is missing. Write `{written}`."
            trigger = [Piece(kind, start, end) for kind in ("NAME", "DOT", "NAME")]
            edits = (Edit(start, end, written),)
            yield Correction("LRP108", message, start, end, edits, [*trigger, *items[2:]])
    elif form.kinds[:4] == ("NAME", "DOT", "NAME", "ARROW") and words[2] in draft.states:
        message = f"The name of a state is missing after `{words[0]}.`. Write `(on machine.state a -> b)`."
        parts = [*items[:2], Piece("NAME", end, end), *items[2:]]
        edits = (Edit(end, end, f"{words[2]} "),)
        yield Correction("LRP108", message, start, end, edits, parts, False)


def holds(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """How long a condition must hold: with another word, without one, or elsewhere."""
    items = form.items
    for first, item in enumerate(items):
        word = item.keyword if isinstance(item, DraftForm) else draft.word(item)
        is_word = word.lower() in HOLDING
        if not is_word and item.kind not in ("INTEGER", "AMOUNT"):
            continue
        inside = item.items if isinstance(item, DraftForm) else items[first + is_word :]
        delay, count = _delay(draft, inside)
        if not delay:
            continue
        stop = first + 1 if isinstance(item, DraftForm) else first + is_word + count
        before = first - (first > 0 and draft.word(items[first - 1]) == ",")
        others = [*items[:before], *items[stop:]]
        length = _trigger(draft, others)
        is_right = item.kind == "FOR" and before == length and isinstance(inside[0], Piece)
        if is_right or (not is_word and first != length):
            continue
        if is_word and not first and is_complete("ontime", ("INTEGER", *as_if(others))):
            yield _timed(form, delay, stop)
        meant = form.keyword if form.keyword in HELD else "on"
        trigger, start, end = others[:length], items[before].start, items[stop - 1].end
        if length == 3:
            trigger[1] = Piece("DOT", trigger[1].start, trigger[1].end)
        held = Piece("FOR", start, end), Piece("INTEGER", start, end)
        parts = [*trigger, *held, *others[length:]]
        if not length or not is_complete(meant, as_if(parts)):
            continue
        text = draft.text[trigger[0].start : trigger[-1].end]
        written = f"{short(text)} for {delay}"
        message = f"How long a condition must hold is written with `for`. Write `{written}`."
        if meant != form.keyword:
            message = f"`{form.keyword}` has no condition. Write `{meant} {written}`."
        elif not is_word:
            message = f"`for` is missing before the delay. Write `{written}`."
        elif before != length:
            message = f"`for` and its delay come after the condition. Write `{written}`."
        if before == length:
            edits = [Edit(start, end, f"{'' if draft.text[start - 1].isspace() else ' '}for {delay}")]
        else:
            gone = (start, items[stop].start) if not before else (items[before - 1].end, end)
            edits = [Edit(*gone, ""), Edit(trigger[-1].end, trigger[-1].end, f" for {delay}")]
        is_certain = not any(_COMMENT.search(draft.text, *edit[:2]) for edit in edits if not edit.text)
        is_certain &= length > 1 or trigger[0].kind == "BLOCK" or draft.word(trigger[0]) in draft.events
        if meant != form.keyword:
            edits.append(Edit(form.first, form.head, meant))
            start, end = items[0].start, max(end, trigger[-1].end)
        yield Correction("LRP108", message, start, end, tuple(edits), parts, is_certain, keyword=meant)


def _timed(form: DraftForm, delay: str, stop: int) -> Correction:
    """Return that a delay without a condition is an `ontime`."""
    message = f"A delay without a condition is an `ontime`. Write `ontime {delay}`."
    end = form.items[stop - 1].end
    parts = [Piece("INTEGER", form.items[0].start, end), *form.items[stop:]]
    edit = Edit(form.first, end, f"ontime {delay}")
    return Correction("LRP108", message, form.items[0].start, end, (edit,), parts, keyword="ontime")


def no_delay(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Conditions with `for` but no delay."""
    items, kinds = form.items, form.kinds
    if "FOR" not in kinds:
        return
    after = kinds.index("FOR") + 1
    length = source_length(kinds[after:])
    names = {draft.word(item) for item in items[after : after + length] if item.kind == "NAME"}
    if length and kinds[after + length : after + length + 1] == ("ARROW",) and draft.states >= names:
        _, start, end = items[after - 1]  # type: ignore[misc]
        message = "The delay is missing after `for`. Write the milliseconds there, as in `for 500`."
        parts = [*items[:after], Piece("INTEGER", end, end), *items[after:]]
        yield Correction("LRP108", message, start, end, (Edit(end, end, " 500"),), parts, False)


def _delay(draft: TextDraft, items: list[Item]) -> tuple[str, int]:
    """Return the delay with which some parts begin, and of how many it consists; empty if with none."""
    if not items:
        return "", 0
    item, word = items[0], draft.word(items[0])
    if isinstance(item, DraftForm):
        return (_delay(draft, item.items)[0], 1) if not item.keyword and len(item.items) == 1 else ("", 0)
    if item.kind in ("INTEGER", "AMOUNT"):
        unit = draft.word(items[1]) if len(items) > 1 and items[1].kind == "NAME" else ""
        count = 1 + (unit.lower() in UNITS and unit != "" and unit not in draft.states)
        return milliseconds(word + unit * (count > 1)), count
    is_variable = item.kind == "NAME" and word in draft.defined["var"] - draft.states
    return (word, 1) if item.kind == "BLOCK" or is_variable else ("", 0)


def _trigger(draft: TextDraft, items: list[Item]) -> int:
    """Return of how many of the first parts a condition consists; 0 if there is none."""
    if len(items) > 2 and draft.word(items[1]) == ".":
        return 3 * (items[0].kind == items[2].kind == "NAME")
    return int(bool(items) and items[0].kind in ("NAME", "BLOCK"))

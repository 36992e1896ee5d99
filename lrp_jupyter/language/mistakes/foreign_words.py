"""Names, delays and comments as other languages write them, and characters that are not part of this one."""

from __future__ import annotations

import re
from keyword import iskeyword

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.mistakes.text_draft import Correction, Corrections, DraftForm, Piece, TextDraft
from lrp_jupyter.language.python.scanner import LINE_END, line_end
from lrp_jupyter.language.reading.forms import USAGE, short
from lrp_jupyter.language.reading.tokens import NAMED
from lrp_jupyter.language.spellings import AMOUNT, MODULES, UNITS
from lrp_jupyter.language.triggers import FORMS

_TOUCHING = frozenset("!?.$%&@|'\"`^~+/\\")
_FIRST = re.compile(r"[^\W\d]\w*")
_WORDS = frozenset({"NAME", "WORD", "INTEGER", "AMOUNT"})


def comments(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Comments of other languages."""
    start, end = form.items[at].start, form.items[at].end
    word = draft.text[start:end]
    sign = word[:2]
    edits = [Edit(start, start + 2, ";")]
    if sign == "/*":
        if word.endswith("*/") and len(word) > 3:
            after = draft.text[end : line_end(draft.text, end)]
            edits.append(Edit(end - 2, end, "" if not after.strip() else "\n"))
            word = word[:-2]
        edits += [Edit(start + line.end(), start + line.end(), "; ") for line in LINE_END.finditer(word)]
    message = f"Comments begin with `;`, not with `{sign}`. Write `;`."
    yield Correction("LRP114", message, start, end, tuple(edits), form.replaced(at, at))


def import_forms(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Forms that import or export."""
    start, end = form.items[at].start, form.items[at].end
    word = next(iter(_FIRST.findall(draft.text, start, end)), "")
    if word in MODULES:
        what = "everything is visible already" if word == "export" else "copy what you need into this text"
        message = f"LRP has no modules: a program is one text. Remove this `{word}`; {what}."
        yield Correction("LRP113", message, start, end, (Edit(start, end, ""),), form.replaced(at, at))


def import_lines(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Lines that import, as in Python; they may be needed in a block, so there is no fix."""
    start = form.items[at].start
    if draft.word(form.items[at]) in MODULES:
        end = line_end(draft.text, start)
        message = "LRP has no modules, and Python's are imported inside a block. Move this into a block."
        items = [each for each in form.items if not start <= each.start < end]
        yield Correction("LRP113", message, start, end, (Edit(start, end, ""),), items, is_certain=False)


def delays(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Delays with a unit or a point, or in quotation marks."""
    at = form.kinds.index("FOR") + 1 if "FOR" in form.kinds else 0
    if len(form.items) <= at or (form.keyword != "ontime" and not at):
        return
    item, *rest = form.items[at:]
    word, end = draft.word(item), item.end
    comma, decimals = (*rest, item, item)[:2]
    if (
        draft.text[end : decimals.start] == ","
        and comma.kind == "STRAY"
        and decimals.kind in ("INTEGER", "AMOUNT")
    ):
        word, end, rest = f"{word}.{draft.word(decimals)}", decimals.end, rest[2:]
    amount = AMOUNT.fullmatch(word)
    if item.kind == "QUOTED" and word[1:-1].strip().isdecimal():
        meant = word[1:-1].strip()
        message = f"Delays are written without quotation marks. Write `{meant}`."
    elif item.kind not in ("INTEGER", "AMOUNT") or not amount:
        return
    else:
        if rest and rest[0].kind == "NAME" and not amount[2] and draft.word(rest[0]) not in draft.states:
            unit = draft.word(rest[0])
            if unit.lower() in UNITS:
                end, amount, rest = rest[0].end, AMOUNT.fullmatch(word + unit), rest[1:]
        meant = milliseconds(amount[0]) if amount else ""
        if not meant or (item.kind == "INTEGER" and end == item.end):
            return
        message = f"`{draft.text[item.start : end]}` is not a whole number of milliseconds. Write `{meant}`."
    items = [*form.items[:at], Piece("INTEGER", item.start, end), *rest]
    yield Correction("LRP108", message, item.start, end, (Edit(item.start, end, meant),), items)


def milliseconds(word: str) -> str:
    """Return a delay, which may have a unit or a point, in milliseconds; empty if it is none."""
    amount = AMOUNT.fullmatch(word)
    if not amount or amount[2].lower() not in UNITS:
        return ""
    number = float(amount[1].replace("_", ""))
    factor = UNITS[amount[2].lower()] or (1000 if number % 1 or (number < 20 and "." in word) else 1)
    return str(round(number * factor)) if number * factor < 1e15 else ""


def names(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Names with signs, with a digit first, or in quotation marks: ``have-rest``, ``2fast``, ``"a"``."""
    items, first, last = form.items, at, at
    if items[at].kind != "QUOTED":
        while _joins(draft, form, first) and _joins(draft, form, first - 1, begins=True):
            first -= 1
        if items[first].kind not in _WORDS:
            return
        while _joins(draft, form, last + 1):
            last += 1
        if items[last].kind == "MINUS":
            last -= 1
    start, end, kind = items[first].start, items[last].end, items[first].kind
    written = draft.text[start:end]
    word = written[1:-1].strip() if kind == "QUOTED" else written
    name = _valid(draft, word)
    if not name or (word.isdecimal() and form.keyword not in ("state", "machine")) or name == written:
        return
    parts = [Piece("NAME", start, end)]
    defines = form.keyword in NAMED and not first
    is_known = defines or name in draft.names or written in draft.definitions
    halves = re.split(r"\W+", word)
    machines = draft.defined["machine"]
    is_pair = len(halves) == 2 and halves[0] in machines and halves[1] in draft.states
    if form.keyword == "spawn" and is_pair:
        name = " ".join(halves)
        parts *= 2
        is_known = True
        message = f"The machine and its state are two words. Write `{name}`."
    elif not is_known and form.keyword in FORMS and _is_path(draft, halves):
        remark = _path(draft, form, first, halves)
        if not remark:
            return
        message = f"`{written}` is a path. {remark}"
    elif kind == "QUOTED":
        message = f"Names are written without quotation marks. Write `{name}`."
    elif word[0].isdigit():
        message = f"A name begins with a letter or `_`. Write `{name}`."
    else:
        message = f"A name has letters, digits and `_`. Write `{name}`."
    edit = Edit(start, end, name)
    yield Correction("LRP110", message, start, end, (edit,), form.replaced(first, last, *parts), is_known)


def _is_path(draft: TextDraft, names: list[str]) -> bool:
    return len(names) > 1 and names[0] in draft.states | draft.defined["machine"]


def _path(draft: TextDraft, form: DraftForm, at: int, names: list[str]) -> str:
    """Return what to do instead of naming a state inside another; empty where no state is named."""
    if "ARROW" not in form.kinds[at:]:
        outer = f"`{names[0]}`" if names[0] in draft.states else f"the state that spawns `{names[0]}`"
        return (
            "A transition leads to a state of its own machine. "
            f"Write {outer}, and name the state inside in its `spawn`."
        )
    if at or form.keyword == "eps":
        what = "A transition leaves a state of its own machine"
        return f"{what}. To leave `{names[0]}` from a state inside, write an `exit` there."
    return ""


def _joins(draft: TextDraft, form: DraftForm, index: int, begins: bool = False) -> bool:
    """Return whether a part is one word with the part before it, or begins one."""
    if not (0 if begins else 1) <= index < len(form.items):
        return False
    item, kinds = form.items[index], form.kinds
    if not begins and item.start != form.items[index - 1].end:
        return False
    word = draft.word(item)
    if item.kind == "MINUS":
        return form.keyword not in FORMS or "ARROW" in kinds or "SIGN" in kinds
    if item.kind == "SIGN":
        return word in ("~", "::") or (word == ":" and form.keyword not in ("var", "event") and index == 1)
    return item.kind in _WORDS or (item.kind in ("STRAY", "DOT") and word in _TOUCHING)


def _valid(draft: TextDraft, word: str) -> str:
    """Return the valid name that is most like a word; empty if there is none."""
    name = re.sub(r"\W+", "_", word).strip("_") if not word.isidentifier() else word
    if name[:1].isdigit():
        digits = re.match(r"\d+", name)[0]  # type: ignore[index]
        rest = name[len(digits) :].strip("_")
        name = rest if rest in draft.names else f"{rest}{digits}" if rest else ""
    return name if name.isidentifier() and not iskeyword(name) else ""


def commas(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Commas between the parts of a form."""
    found = [item for item in form.items if item.kind == "STRAY" and draft.word(item) == ","]
    if found:
        edits = [Edit(item.start, item.end, "" if draft.spaced(item.end) else " ") for item in found]
        message = f"Parts are separated by spaces, not by commas. Remove the comma{'s' * (len(found) > 1)}."
        items = [item for item in form.items if item not in found]
        start, end = found[0].start, found[0].end
        yield Correction("LRP104", message, start, end, tuple(edits), items, alone=True)


def strays(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Characters that mean nothing, one error for those in a row."""
    items, last = form.items, at
    while last + 1 < len(items) and items[last + 1].kind == "STRAY" and draft.word(items[last + 1]) != "]":
        last += 1
    start, end = items[at].start, items[last].end
    word = short(draft.text[start : min(end, start + 40)])
    message = f"`{word}` is not part of the language. Remove it."
    doubt = message.replace("Remove it", f"Write `{USAGE[form.keyword]}`") if form.keyword in USAGE else ""
    if word == "]":
        message = "Unmatched `]`: there is no open block here. Remove it."
        doubt = ""
    edit, parts = Edit(start, end, ""), form.replaced(at, last)
    sides = *items[max(at - 1, 0) : at], *items[last + 1 : last + 2]
    if [(side.kind, side.end == start or side.start == end) for side in sides] == [("NAME", True)] * 2:
        if "".join(map(draft.word, sides)) in draft.names:
            parts = form.replaced(at - 1, last + 1, Piece("NAME", sides[0].start, sides[1].end))
        else:
            edit = edit._replace(text=" ")  # else the two would become one name
    yield Correction("LRP104", message, start, end, (edit,), parts, doubt=doubt)

"""The variables that a `spawn` sets, as other languages pass arguments: ``turn=-1``, ``(turn := [-1])``."""

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
    expression,
)
from lrp_jupyter.language.reading.forms import USAGE
from lrp_jupyter.language.spellings import OTHERS

_USAGE = f"{USAGE['spawn'][:-1]} {USAGE['var']})"
_ASSIGNED = re.compile(r"\s*(\w+)\s*:?=\s*(.+?)\s*", re.DOTALL)
_COMMENT = re.compile(r"[;#]")
_WORDS = frozenset(
    {"var", "vars", "with", "where", "using", *(word for word in OTHERS if "var" in OTHERS[word])}
)
_Settings = list[tuple[str, str]]
"""Names of variables, and the Python of their values."""


def settings(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Values of the variables of a machine, in other notations."""
    if at < 2 or form.kinds[:2] != ("NAME", "NAME"):
        return
    stop = next((index for index in range(at, len(form.items)) if form.kinds[index] == "VAR_FORM"), None)
    items = form.items[at:stop]
    found = _read(draft, items)
    if not items or not found:
        return
    written = " ".join([f"(var {name} := [{python}])" for name, python in found])
    start, end = items[0].start, items[-1].end
    message = f"A `spawn` sets variables of its machine with `var`. Write `{written}`."
    parts = form.replaced(at, at + len(items) - 1, Piece("VAR_FORM", start, end))
    machine = draft.word(form.items[0])
    is_certain = draft.members.get(machine, set()).issuperset([name for name, _ in found])
    is_certain &= not _COMMENT.search(draft.text, start, end)
    tight = "" if draft.text[start - 1].isspace() else " "
    edits = (Edit(start, end, tight + written),)
    yield Correction("LRP108", message, start, end, edits, parts, is_certain)


def settings_first(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Values of variables before the names of the machine and its state."""
    names = [item for item in form.items if item.kind == "NAME"]
    values = [item for item in form.items if item.kind != "NAME"]
    found = _read(draft, [item for item in values if item.kind != "VAR_FORM"])
    if len(names) != 2 or form.kinds[:2] == ("NAME", "NAME"):
        return
    written = [draft.word(item) for item in (*names, *values) if item.kind in ("NAME", "VAR_FORM")]
    written += [f"(var {name} := [{python}])" for name, python in found]
    if len(written) == len(form.items):
        start, end = form.items[0].start, form.items[-1].end
        message = f"The variables come after the names of the machine and its state. Write `{_USAGE}`."
        items = [*names, *[Piece("VAR_FORM", item.start, item.end) for item in values]]
        is_certain = not _COMMENT.search(draft.text, start, end)
        edits = (Edit(start, end, " ".join(written)),)
        first = values[0]
        yield Correction("LRP108", message, first.start, first.end, edits, items, is_certain)


def after_state(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Anything else after the names of the machine and its state."""
    if at >= 2 and form.kinds[:2] == ("NAME", "NAME") and at < len(form.items):
        stop = next((index for index in range(at, len(form.items)) if form.kinds[index] == "VAR_FORM"), None)
        items = form.items[at:stop] or form.items[at:]
        start, end = items[0].start, items[-1].end
        message = f"Only variables of the machine can follow its start state. Write `{_USAGE}`."
        parts = form.replaced(at, at + len(items) - 1)
        yield Correction("LRP108", message, start, end, (Edit(start, end, ""),), parts, False)


def _read(draft: TextDraft, items: Sequence[Item]) -> _Settings:
    """Return the settings that some parts are; none if one of them is something else."""
    found: _Settings = []
    index = 0
    while index < len(items):
        item, word = items[index], draft.word(items[index])
        index += 1
        is_head = item.kind == "NAME" and word.lower() in _WORDS and not _is_sign(draft, items, index)
        if is_head or word == "," or (_is_sign(draft, items, index - 1) and items[index:]):
            continue
        if isinstance(item, DraftForm):
            inner = _read(draft, [*item.name(), *item.items])
        elif item.kind in ("BLOCK", "INVALID"):
            assigned = _ASSIGNED.fullmatch(word[1:-1])
            inner = [(assigned[1], assigned[2])] if assigned and expression(assigned[2]) else []
        elif item.kind == "NAME":
            index += _is_sign(draft, items, index)
            stop = _end(draft, items, index)
            python = draft.text[items[index].start : items[stop - 1].end] if index < stop else ""
            python = python[1:-1].strip() if python[:1] == "[" and stop == index + 1 else python
            inner = [(word, python)] if expression(python) else []
            index = stop
        else:
            inner = []
        if not inner:
            return []
        found += inner
    return found


def _is_sign(draft: TextDraft, items: Sequence[Item], index: int) -> bool:
    return items[index : index + 1] != [] and items[index].kind in SIGNS - {"MINUS", "ARROW"}


def _end(draft: TextDraft, items: Sequence[Item], index: int) -> int:
    """Return the index after a value that begins at an index: before a comma or the next name with a sign."""
    if index < len(items) and items[index].kind in ("BLOCK", "INVALID"):
        return index + 1
    for stop in range(index + 1, len(items)):
        is_next = items[stop].kind == "NAME" and _is_sign(draft, items, stop + 1)
        if draft.word(items[stop]) == "," or is_next or _is_sign(draft, items, stop):
            return stop
    return len(items)

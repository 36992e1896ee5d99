"""Transitions as other notations write them: an event with a guard, several events, and effects.

UML writes ``event [guard] / effect``; SCXML, XState and others give a transition its guard and its actions.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.mistakes.form_order import source_length
from lrp_jupyter.language.mistakes.text_draft import (
    SIGNS,
    Correction,
    Corrections,
    DraftForm,
    Item,
    Piece,
    TextDraft,
    expression,
    is_python,
)
from lrp_jupyter.language.python.scanner import line_end
from lrp_jupyter.language.reading.forms import USAGE
from lrp_jupyter.language.reading.tokens import ACTIONS
from lrp_jupyter.language.spellings import ASKING, EFFECT_WORDS, GUARD_WORDS, JOINING, OTHERS, UNITS

_ASSIGNS = re.compile(r"\w+ *=[^=]*")
_COMMENT, _LINE_END = re.compile(r"[;#]"), re.compile(r"[\r\n]")
_TRIED = 10  # places where Python may end
_LOOSE = ast.IfExp | ast.Lambda | ast.NamedExpr
"""Expressions that need parentheses beside `and` and `or`."""


class _Part(NamedTuple):
    """Something before the source or after the destination.

    `kind`: ``condition``, ``effect``, or ``either`` if it may be one or the other.
    `joined`: the words between it and the part before.
    `is_event`: whether it is an event, the state of a machine, or a delay.
    `is_foreign`: whether it is written in another notation.
    """

    python: str
    kind: str = "condition"
    joined: str = ""
    is_event: bool = False
    is_foreign: bool = False


def guards_and_effects(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Several conditions, and what a transition does, wherever other notations put them."""
    items, text, keyword = form.items, draft.text, form.keyword
    arrow = form.kinds.index("ARROW") if "ARROW" in form.kinds else 0
    starts = [start for start in range(arrow) if source_length(form.kinds[start:]) == arrow - start]
    rest = arrow + 2
    if not starts or form.kinds[arrow + 1 : rest] != ("NAME",) or text[form.end - 1] != ")":
        return
    source = starts[-1] - 2 * (form.kinds[max(0, starts[-1] - 2) : starts[-1]] == ("STAR", "MINUS"))
    is_named = form.kinds[rest : rest + 1] == ("NAME",) and draft.word(items[rest]).lower() not in _WORDS
    rest += is_named and form.kinds[rest + 1 : rest + 2] != ("SIGN",)  # not the `x` of `x = 1`
    is_tight = rest < len(items) and items[rest - 1].end == items[rest].start
    if is_tight and form.kinds[rest] not in _BRACKETS and draft.word(items[rest]) not in (",", ":"):
        return  # `a -> have-rest`
    stop = len(items)
    stop -= form.kinds[-1] == "EFFECT_FORM"
    before = _before(draft, form, items[:source])
    after = _parts(draft, items[rest:stop])
    if before is None or after is None or not (after or _is_several(before)):
        return
    parts = [*before, *after]
    effects = [part.python for part in parts if part.kind == "effect"]
    doubtful = next((part for part in parts if part.kind == "either"), None)
    conditions = [part for part in parts if part.kind == "condition"]
    if (not conditions and keyword != "eps") or (effects and stop < len(items)):
        return
    made, is_certain = _joined(conditions)
    written = f"(effect {' '.join(f'[{each}]' for each in effects)})"
    changes = conditions != before[: len(conditions)] or _is_several(conditions)
    meant = "on" if changes and keyword != "exit" else keyword
    remarks = []
    if doubtful:
        is_certain, both = False, _joined([*conditions, doubtful])[0]
        if expression(doubtful.python) is None:
            both = both.replace("=", "==")
        what = "A transition has one condition, before its source, and its effect at the end"
        remarks.append(f"{what}. Write `[{both}]`, or `(effect [{doubtful.python}])`.")
    elif meant != keyword:
        remarks.append(f"`{keyword}` has no condition. Write `on [{made}]`.")
    elif changes and not is_certain:
        remarks.append(f"A transition has one condition. Join these with `and` or `or`, as in `[{made}]`.")
    elif changes:
        what = "The condition comes before the source"
        if len(conditions) > 1:
            what = "A transition has one condition, before its source"
        elif before:
            what = "A condition is Python in square brackets"
        remarks.append(f"{what}. Write `[{made}]`.")
    if effects:
        remarks.append(f"What a transition does is its effect, at its end. Write `{written}`.")
    edits = []
    end = items[source - 1].end if source else form.head
    if changes and meant == keyword and source:
        edits.append(Edit(items[0].start, end, f"[{made}]"))
    elif changes:
        edits.append(Edit(form.first, end, f"{meant} [{made}]"))
    elif len(before) > 1:
        edits.append(Edit(items[0].end, end, ""))
    if after or effects:
        edits.append(Edit(items[rest - 1].end, items[stop - 1].end, f" {written}" if effects else ""))
    is_certain &= not any(_COMMENT.search(text, *edit[:2]) for edit in edits)
    is_certain &= not any(_LINE_END.search(part.python) for part in parts)
    is_certain &= not changes or draft.makes_sense(made)
    start = items[0 if _is_several(before) else rest].start
    trigger = [Piece("BLOCK", form.head, form.head)] if changes else items[: min(source, 1)]
    left = [*trigger, *items[source:rest], *items[stop:]]
    place = start, items[stop - 1].end if after else end
    yield Correction("LRP108", " ".join(remarks), *place, tuple(edits), left, is_certain, keyword=meant)


def loose_effects(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Effects of transitions that have no arrow: ``exit done / robot.stop()``."""
    items = form.items
    first = next((index for index, item in enumerate(items) if draft.word(item) == "/"), 0)
    parts = _parts(draft, items[first:]) if first and "ARROW" not in form.kinds else None
    if not parts or form.around != "machine" or any(part.kind != "effect" for part in parts):
        return
    written = f"{USAGE[form.keyword][:-1]} (effect {' '.join(f'[{part.python}]' for part in parts)}))"
    message = f"A transition leads from a source to a destination. Write `{written}`."
    trigger = {"eps": [], "ontime": ["INTEGER"]}.get(form.keyword, ["NAME"])
    start, end = items[0].start, items[-1].end
    left = [Piece(kind, start, end) for kind in (*trigger, "NAME", "ARROW", "NAME", "EFFECT_FORM")]
    yield Correction("LRP108", message, start, end, (Edit(form.start, form.end, ""),), left, False)


def asked_states(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Questions for the active state of another machine: ``in(held)``, ``done(arm)``."""
    if len(form.items) < 2 or not isinstance(form.items[0], Piece):
        return
    first, second = form.items[:2]
    word = draft.word(first)
    if word in ASKING and word not in draft.values and first.end == second.start:
        stop = 2
        while stop < len(form.items) and form.items[stop - 1].end == form.items[stop].start:
            stop += 1
        message = (
            "A condition on another machine names it and its state. "
            'Write `(on machine.state a -> b)`, or `machine.state == "state"` in a block.'
        )
        items = form.replaced(0, stop - 1, Piece("BLOCK", first.start, form.items[stop - 1].end))
        yield Correction("LRP108", message, first.start, form.items[stop - 1].end, (), items, False)


def delays(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Delays beside an event or behind the destination."""
    word = draft.word(form.items[at - 1]).lower() if at and form.kinds[at - 1] != "FOR" else ""
    if word in ("after", "for", "within", "timeout", "delay"):
        last = at + (
            form.kinds[at + 1 : at + 2] == ("NAME",) and draft.word(form.items[at + 1]).lower() in UNITS
        )
        place = form.items[at - 1].start, form.items[last].end
        message = (
            "A transition with a delay is an `ontime`. To wait for a condition as well, "
            "write `(on condition for milliseconds a -> b)`, or test `elapsed`."
        )
        yield Correction("LRP108", message, *place, (), form.replaced(at - 1, last), False)


def arrows(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Transitions as PlantUML and Mermaid draw them: ``a --> b : event [guard] / effect``."""
    items, kinds = form.items, form.kinds
    if len(items) < at + 3 or kinds[at + 2] != "NAME" or kinds[at + 1] not in SIGNS:
        return
    source, arrow, destination = items[at : at + 3]
    stop = _line(draft, form, at + 3)
    ends = draft.word(source), draft.word(destination)
    is_line = not re.split(r"[\r\n]", draft.text[: source.start])[-1].strip()
    if not is_line or not draft.states.issuperset(ends) or ">" not in draft.word(arrow):
        return
    is_labelled = kinds[at + 3 : at + 4] == ("SIGN",)
    parts = _parts(draft, items[at + 3 + is_labelled : stop])
    conditions = [part for part in parts or () if part.kind == "condition"]
    made, is_certain = _joined(conditions)
    head = f"on [{made}]" if conditions else "eps"
    if len(conditions) == 1 and conditions[0].python in draft.events:
        head = f"on {made}"
    effects = [f"[{part.python}]" for part in parts or () if part.kind == "effect"]
    tail = f" (effect {' '.join(effects)})" if effects else ""
    whole = f"({head} {ends[0]} -> {ends[1]}{tail})"
    is_certain &= parts is not None and len(conditions) + len(effects) == len(parts)
    is_certain &= not conditions or draft.makes_sense(made)
    shown = whole if is_certain else "(on condition source -> destination)"
    start, end = source.start, items[stop - 1].end
    edits = (Edit(start, end, whole),)
    form_of = Piece(f"{head[:3].strip().upper()}_FORM", start, end)
    message = f"A transition is a form. Write `{shown}`."
    yield Correction("LRP108", message, start, end, edits, form.replaced(at, stop - 1, form_of), is_certain)


def labels(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Actions of a state as UML writes them: ``entry / x = 1``."""
    items = form.items
    word = draft.word(items[at]).lower()
    found = [each for each in (word, *OTHERS.get(word, ())) if each in ACTIONS]
    meant = "onexit" if word == "exit" else next(iter(found), "")
    if not meant or at + 2 >= len(items) or draft.word(items[at + 1]) not in ("/", ":"):
        return
    stop = _line(draft, form, at + 2)
    start, first, end = items[at].start, items[at + 2].start, items[stop - 1].end
    python = draft.text[first:end]
    python = python[1:-1] if items[at + 2].kind == "BLOCK" and stop == at + 3 else python
    if is_python(python):
        whole = f"({meant} [{python}])"
        edit = Edit(start, end, whole)
        message = f"What a state does stands in a form. Write `{whole}`."
        items = form.replaced(at, stop - 1, Piece(f"{meant.upper()}_FORM", start, end))
        yield Correction("LRP108", message, start, end, (edit,), items)


def _line(draft: TextDraft, form: DraftForm, at: int) -> int:
    """Return the index after the parts of a line, or of what comes before a form there."""
    end = line_end(draft.text, form.items[at - 1].start)
    while at < len(form.items) and form.items[at].end <= end and not form.kinds[at].endswith("_FORM"):
        at += 1
    return at


_BRACKETS = frozenset({"BLOCK", "FORM", "LBRACE"})
_WORDS = {*EFFECT_WORDS, *JOINING}


def _is_several(parts: Sequence[_Part]) -> bool:
    return len(parts) > 1 or any(part.is_foreign or "not" in part.joined for part in parts)


def _before(draft: TextDraft, form: DraftForm, items: Sequence[Item]) -> list[_Part] | None:
    """Return the parts before the source; for a delay, the condition that it is."""
    if form.keyword != "ontime" and [item.kind for item in items[:1]] != ["INTEGER"]:
        found = _parts(draft, items)
        return found and [part._replace(kind="either") if _may_compare(part) else part for part in found]
    others = _parts(draft, items[1:])
    if not items or others is None or items[0].kind not in ("INTEGER", "NAME", "BLOCK"):
        return None
    word = draft.word(items[0])
    seconds = f"{int(word) / 1000:g}" if word.isdecimal() else f"{word} / 1000"
    if items[0].kind == "BLOCK":
        seconds = f"({word[1:-1].strip()}) / 1000"
    if expression(seconds) is None and any(part.kind != "effect" for part in others):
        return None
    return [_Part(f"elapsed >= {seconds}", is_event=True), *others]


def _may_compare(part: _Part) -> bool:
    """Return whether an assignment in the place of a condition may be a comparison with `=`."""
    return part.kind == "effect" and not part.is_foreign and bool(_ASSIGNS.fullmatch(part.python))


def _parts(draft: TextDraft, items: Sequence[Item]) -> list[_Part] | None:
    """Return the conditions and effects that are written one after the other; None if some are others."""
    found: list[_Part] = []
    words = [draft.word(item) for item in items]
    joined, acts, index = "", False, 0
    while index < len(items):
        item, word = items[index], words[index].lower()
        stop = index + 1
        parts: list[_Part] = []
        if words[index] in draft.defined["machine"] and words[stop : stop + 1] == ["."]:
            stop += 2
            asked = [f'{words[index]}.state == "{state}"' for state in words[stop - 1 : stop]]
            parts = [_Part(python, is_event=True) for python in asked]
        elif words[index] in draft.events or (item.kind == "NAME" and joined.endswith("not")):
            parts = [_Part(words[index], is_event=True)]
        elif word in JOINING:
            joined, index = f"{joined} {JOINING[word]}", stop
            continue
        elif word in EFFECT_WORDS:
            acts, index = True, stop
            continue
        elif isinstance(item, DraftForm) or item.kind == "BLOCK":
            parts = _bracketed(draft, item, acts)
        else:
            ends = [each for each in range(stop, len(items)) if words[each].lower() in _WORDS]
            for stop in (len(items), *reversed(ends[-_TRIED:])):
                python = draft.text[item.start : items[stop - 1].end]
                python = python[1:-1].strip() if python[0] + python[-1] == "{}" else python
                parts = [] if python.isidentifier() else _part(python, acts)
                parts = [part._replace(is_foreign=acts or stop < len(items)) for part in parts]
                if parts:
                    break
        if not parts:
            return None
        found += [parts[0]._replace(joined=joined), *parts[1:]]
        joined, acts, index = "", False, stop
    return None if joined or acts else found


def _bracketed(draft: TextDraft, item: Item, acts: bool) -> list[_Part]:
    """Return what is in the brackets of a part, which may begin with a word that says what it is."""
    inside = draft.word(item)[1:-1].strip()
    if inside in draft.events:
        return [_Part(inside, is_event=True)]
    word, inner = "", None
    if isinstance(item, DraftForm):
        word, is_event = item.keyword.lower(), item.keyword in draft.events
        inner = _parts(draft, [*item.name(), *item.items] if is_event else item.items) if word else None
        if is_event and inner:
            return [_Part(_joined(inner)[0], is_foreign=True)]
    if word in ("and", "or", "not") and inner:
        return [_Part(_joined([part._replace(joined=word) for part in inner])[0], is_foreign=True)]
    if word in EFFECT_WORDS and inner:
        return [part._replace(kind="effect", is_foreign=True) for part in inner]
    if word in GUARD_WORDS and inner:
        return [part._replace(kind="condition", is_foreign=True) for part in inner if part.kind != "effect"]
    if item.kind == "BLOCK" and not acts and isinstance(expression(inside), ast.Constant):
        return [_Part(inside)]
    return [] if inside.isidentifier() and inside not in draft.defined["var"] else _part(inside, acts)


def _part(python: str, acts: bool) -> list[_Part]:
    """Return what Python is in a transition; an empty list if it is none."""
    python = python.strip()
    value = expression(python)
    if not is_python(python) or isinstance(value, ast.Constant):
        return []
    kind = "effect" if value is None else "either" if isinstance(value, ast.Call) else "condition"
    if acts and kind == "condition":
        return []  # `a -> b/c`
    return [_Part(python, "effect" if acts else kind, is_foreign=acts)]


def _joined(parts: Sequence[_Part]) -> tuple[str, bool]:
    """Return the condition that several are together, and whether that is certain."""
    whole, is_certain = "", True
    for index, part in enumerate(parts):
        words = part.joined.split()
        sign = "or" if "or" in words else "and"
        python = part.python
        if "not" in words:
            python = f"not {_enclosed(python, ast.BoolOp)}"
            python = (
                part.python.replace(" == ", " != ") if " == " in part.python and part.is_event else python
            )
        elif sign == "and" and len(parts) > 1:
            python = _enclosed(python, ast.Or)
        if index:
            is_plain = parts[index - 1].is_event != part.is_event
            is_certain &= "," not in words and (is_plain or "and" in words or "or" in words)
            whole = f"{_enclosed(whole, ast.Or) if sign == 'and' else whole} {sign} {python}"
        else:
            whole = python
    return whole, is_certain


def _enclosed(python: str, loose: type[ast.AST]) -> str:
    """Return an expression, in parentheses if they are needed beside another one."""
    value = expression(python)
    operator = value.op if isinstance(value, ast.BoolOp) else None
    return f"({python})" if isinstance(value, _LOOSE | loose) or isinstance(operator, loose) else python

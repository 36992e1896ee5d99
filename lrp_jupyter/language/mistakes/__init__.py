"""Mistakes in a text that is not a program: each is one error and, where that is certain, has a fix.

The text is read as nested forms. Where the parts of a form are not those of its keyword, the rules propose
what may be meant at the first part that does not fit: another sign, a bracket, a word in another order. The
first guess after which the form is right, or right up to a later part, is the mistake; with its edits, the
form is tried again. So one mistake is one error, and what would follow from it is not reported. A guess is
certain only if its form is right in the end, and if it makes no name of something that does not exist. The
text with its corrections is parsed, which finds what is left, and what the corrections have uncovered.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.mistakes import bare_python as python
from lrp_jupyter.language.mistakes import condition_forms as conditions
from lrp_jupyter.language.mistakes import foreign_words as words
from lrp_jupyter.language.mistakes import form_order as order
from lrp_jupyter.language.mistakes import keywords, notations, settings, unclosed, wrong_brackets
from lrp_jupyter.language.mistakes.text_draft import (
    Correction,
    Corrections,
    DraftForm,
    Item,
    Piece,
    TextDraft,
    first_wrong,
    given_up,
)
from lrp_jupyter.language.reading.tokens import ACTIONS
from lrp_jupyter.language.source import Diagnosis
from lrp_jupyter.language.triggers import FORMS


class Rule(NamedTuple):
    """A kind of mistake.

    `propose`: yields what may be wrong with a form whose part at an index does not fit, the likeliest first.
    `parts`: the types of such parts for which it is tried; all if there are none.
    `forms`: the keywords of such forms; all if there are none.
    `is_later`: whether it is tried for later parts, too, where no rule explains the first that does not fit.
    """

    propose: Callable[[TextDraft, DraftForm, int], Corrections]
    parts: frozenset[str]
    forms: frozenset[str]
    is_later: bool


def _rule(
    propose: Callable[[TextDraft, DraftForm, int], Corrections],
    parts: str = "",
    forms: str = "",
    is_later: bool = False,
) -> Rule:
    return Rule(propose, frozenset(parts.split()), frozenset(forms.split()), is_later)


CONTAINERS = frozenset({"program", "machine", "state"})
_TRANSITIONS = " ".join(FORMS)
_NAMING = f"var event machine state spawn {_TRANSITIONS}"
_PYTHON = f"var event on exit ontime {' '.join(ACTIONS)}"

RULES = (
    _rule(words.comments, "COMMENT"),
    _rule(wrong_brackets.form_ends_square, "STRAY"),
    _rule(wrong_brackets.ends_swapped, "INVALID"),
    _rule(wrong_brackets.block_ends_round, "UNCLOSED"),
    _rule(unclosed.quotes, "UNCLOSED INVALID"),
    _rule(unclosed.hidden, "UNCLOSED"),
    _rule(unclosed.doubled, "UNCLOSED"),
    _rule(unclosed.ends, "UNCLOSED"),
    _rule(wrong_brackets.lost, "NAME"),
    _rule(wrong_brackets.bare_form, "NAME"),
    _rule(order.phrases, "", f"state machine spawn {_TRANSITIONS}"),
    _rule(order.effects, "", _TRANSITIONS),
    _rule(conditions.machine_states, "", _TRANSITIONS),
    _rule(conditions.half_named_states, "", "on exit"),
    _rule(conditions.holds, "", _TRANSITIONS),
    _rule(conditions.no_delay, "", "on exit"),
    _rule(notations.guards_and_effects, "", _TRANSITIONS),
    _rule(notations.loose_effects, "", _TRANSITIONS),
    _rule(notations.asked_states, "", "on exit"),
    _rule(notations.delays, "INTEGER AMOUNT", "on exit eps"),
    _rule(notations.arrows, "NAME", "machine"),
    _rule(notations.labels, "NAME", "state"),
    _rule(settings.settings, "", "spawn"),
    _rule(settings.settings_first, "", "spawn"),
    _rule(words.import_lines, "NAME", "program"),
    _rule(words.import_forms, "FORM", "program"),
    _rule(wrong_brackets.doubled, "FORM"),
    _rule(wrong_brackets.names, "FORM BLOCK INVALID LBRACE", _NAMING, is_later=True),
    _rule(wrong_brackets.square_form, "BLOCK INVALID"),
    _rule(wrong_brackets.braced_form, "LBRACE"),
    _rule(python.quoted, "", _PYTHON),
    _rule(python.bracketed, "", _PYTHON),
    _rule(python.bare, "", _PYTHON),
    _rule(words.delays, "", "ontime on exit"),
    _rule(words.names, "NAME WORD INTEGER AMOUNT MINUS SIGN STRAY QUOTED"),
    _rule(order.wrong_arrow, "", _TRANSITIONS),
    _rule(order.no_arrow, "", _TRANSITIONS),
    _rule(order.wrong_sign, "", "var event spawn"),
    _rule(order.no_assignment, "BLOCK INVALID", "var"),
    _rule(order.sources, "", "on ontime eps"),
    _rule(order.trigger_last, "", "on ontime exit"),
    _rule(order.other_keyword, "", "on eps"),
    _rule(order.name_last, "", "var event"),
    _rule(order.several_variables, "", "var"),
    _rule(order.several_words, "NAME", "var event state machine"),
    _rule(order.action, "BLOCK", "state"),
    _rule(words.commas, "STRAY", is_later=True),
    _rule(words.strays, "STRAY"),
    _rule(settings.after_state, "", "spawn"),
)
"""The cheapest first. Each can be left out: then its mistakes are reported by what the parser expects."""

_KEYWORD_RULES = (keywords.two_words, keywords.misspelt, keywords.effect_first)
_MOST = 100
"""Parts of a form that are looked at."""


class Corrected(NamedTuple):
    """A corrected text, the errors of the original, and what moves other errors to their places there."""

    text: str
    found: list[Diagnosis]
    moved: Callable[[Diagnosis], Diagnosis]


def correct(text: str) -> Corrected | None:
    """Correct what is clear in a text that is not a program; return None if nothing is."""
    draft = TextDraft(text)
    guesses: list[Correction] = []
    _mend(draft, draft.read(), guesses)
    limit = min((guess.start for guess in guesses if guess.hides), default=len(text))
    guesses = [guess for guess in guesses if guess.start <= limit]
    if not guesses:
        return None
    corrected, origin = _applied(text, [edit for guess in guesses for edit in guess.edits])
    return Corrected(corrected, _errors(text, guesses), lambda diagnosis: _moved(diagnosis, origin))


def _mend(draft: TextDraft, form: DraftForm, guesses: list[Correction]) -> None:
    """Correct a form, then those in it."""
    ignored: set[Item] = set()
    found: list[Correction] = []
    wrong: list[int] = []  # the offsets of what is still wrong in the end
    for rule in _KEYWORD_RULES if form.around else ():
        for guess in rule(draft, form):
            found.append(guess)
            form.keyword, form.items = guess.keyword, list(guess.items)
    while belonging := next(order.behind(draft, form), None):
        found.append(belonging)
        form.items = list(belonging.items)
    for _ in range(_MOST):
        at = first_wrong(form.keyword, form.items, ignored)
        if at is None:
            break
        accepted = _first_accepted(draft, form, at, ignored)
        if accepted is None and form.keyword in FORMS:
            accepted = _first_alone(draft, form, at)
        if accepted:
            blocks = [item for item in accepted.items if item.kind == "BLOCK"]
            found = [guess for guess in found if not any(_is_in(guess, block) for block in blocks)]
            found.append(accepted)
            form.items = list(accepted.items)
            form.keyword = accepted.keyword or form.keyword
            if accepted.hides:
                break
        elif at < len(form.items) and (instead := given_up(form.items[at])):
            form.items[at] = instead
        elif at == len(form.items) or form.keyword in FORMS:
            wrong.append(form.part(form.items, at)[1])
            break
        else:
            ignored.add(form.items[at])
            wrong += [form.items[at].start] if isinstance(form.items[at], Piece) else []
    guesses += _doubted(form, found, wrong)
    for item in form.items:
        if isinstance(item, DraftForm):
            item.around, item.row = form.keyword, form.items
            _mend(draft, item, guesses)


def _is_in(guess: Correction, block: Item) -> bool:
    """Return whether something was mistaken for a part of a form that is now known to be Python."""
    return block.start <= guess.start and guess.end <= block.end


def _doubted(form: DraftForm, found: list[Correction], wrong: list[int]) -> list[Correction]:
    """Return guesses, without certainty where something stays wrong: then something else may be meant.

    In a form that contains others, that holds for what no other form separates from it.
    """
    forms = [item.start for item in form.items if isinstance(item, DraftForm)]
    separate = forms if form.keyword in CONTAINERS else []
    rooms = {bisect_right(separate, offset) for offset in wrong}
    guesses = []
    for guess in found:
        is_doubtful = bisect_right(separate, guess.start) in rooms and not (guess.alone or guess.hides)
        if guess.code == "LRP106" and (is_doubtful or not guess.is_certain):
            # of an unknown form, nothing else is known
            return [guess._replace(edits=(), message=guess.doubt or guess.message)]
        if is_doubtful:
            guess = guess._replace(is_certain=False, message=guess.doubt or guess.message)
        guesses.append(guess)
    return guesses


def _first_accepted(draft: TextDraft, form: DraftForm, at: int, ignored: set[Item]) -> Correction | None:
    """Return the first guess after which a form is right, or right up to a later part."""
    _, place = form.part(form.items, at)
    for guess in _proposed(draft, form, at):
        later = first_wrong(guess.keyword or form.keyword, guess.items, ignored)
        if guess.hides or guess.alone or later is None or form.part(guess.items, later)[1] > place:
            return guess
    return None


def _first_alone(draft: TextDraft, form: DraftForm, at: int) -> Correction | None:
    """Return the first guess about a later part that is wrong whatever is wrong before it."""
    for later in range(at + 1, min(len(form.items), _MOST)):
        for guess in _proposed(draft, form, later, are_later=True):
            if guess.alone:
                return guess
    return None


def _proposed(draft: TextDraft, form: DraftForm, at: int, are_later: bool = False) -> Corrections:
    kind, _ = form.part(form.items, at)
    for rule in RULES:
        is_for_it = kind in (rule.parts or (kind,)) and form.keyword in (rule.forms or (form.keyword,))
        if is_for_it and (rule.is_later or not are_later):
            yield from rule.propose(draft, form, at)


def _errors(text: str, guesses: list[Correction]) -> list[Diagnosis]:
    """Return the errors; a name that is wrong in several places is one."""
    found: dict[object, Diagnosis] = {}
    for guess in sorted(guesses, key=lambda guess: guess.start):
        edits = guess.edits if guess.is_certain else ()
        key = text[guess.start : guess.end] if guess.code == "LRP110" else guess[:3]
        if key in found:
            found[key] = found[key]._replace(edits=tuple(dict.fromkeys(found[key].edits + edits)))
        else:
            found[key] = Diagnosis(guess.start, guess.end, guess.code, guess.message, edits, guess.is_prefix)
    return list(found.values())


def _moved(diagnosis: Diagnosis, origin: Callable[..., int]) -> Diagnosis:
    """Return an error of a corrected text at its place in the original; no fix may touch a correction."""
    edits = tuple([Edit(origin(start), origin(end), new) for start, end, new in diagnosis.edits])
    if [end - start for start, end, _ in edits] != [end - start for start, end, _ in diagnosis.edits]:
        edits = ()
    start, end = origin(diagnosis.start), origin(diagnosis.end, is_end=diagnosis.start < diagnosis.end)
    return diagnosis._replace(start=start, end=max(start, end), edits=edits)


def _applied(text: str, edits: list[Edit]) -> tuple[str, Callable[..., int]]:
    """Apply edits that do not overlap; return the text, and the map of its offsets back.

    Where text was removed at an offset, the end of a range is before that, and any other offset after it.
    """
    pieces = []
    olds, news = [0], [0]
    position = length = 0
    for start, end, new in sorted(edits):
        if start < position:
            continue
        pieces += [text[position:start], new]
        length += start - position + len(new)
        position = end
        news += [length - len(new), length]
        olds += [start, end]
    pieces.append(text[position:])

    def back(offset: int, is_end: bool = False) -> int:
        at = (bisect_left if is_end else bisect_right)(news, offset) - 1
        if at % 2:  # in the new text of an edit
            return min(olds[at] + offset - news[at], olds[at + 1])
        return olds[at] + offset - news[at]

    return "".join(pieces), back

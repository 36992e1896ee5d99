"""What may be named at a place of a text that is being written; as `context.ts` of the lab's page.

`examples_of_completion.json` of the tests is what both are tested with.
"""

from __future__ import annotations

import re
from typing import Literal, NamedTuple

from lrp_jupyter.language.blocks.names_in_blocks import normal
from lrp_jupyter.language.edits.form_places import WrittenForm
from lrp_jupyter.language.reading.tokens import HELD
from lrp_jupyter.language.resolution import Resolution, Scope
from lrp_jupyter.language.triggers import FORMS

Wanted = Literal[
    "keyword", "event", "delay", "held", "state", "machine", "setting", "effect", "python", "nothing"
]
"""The kinds of names; `held` is a state, or the `for` before it."""

BEGUN = re.compile(r"[\w\u0080-\uffff]*\Z")
_COMMENT = re.compile(r"[;#][^\r\n]*\Z")
_GROUP = re.compile(r"LBRACE[^}]*?(?:(RBRACE)|\Z)")
_IN_STATE = re.compile(r"NAME DOT( NAME)?")


class WordContext(NamedTuple):
    """What may be named at a place.

    `begin`: where the word begins that is being written.
    `form`: the innermost form around it.
    `scope`: the innermost machine around it, or the top level.
    `state`: the state of that machine around it, or empty.
    `machine`: whose states or variables can be named.
    """

    wanted: Wanted
    begin: int
    form: WrittenForm
    scope: Scope
    state: str
    machine: Scope | None


def context_at(text: str, root: WrittenForm, names: Resolution, offset: int) -> WordContext:
    """Return what may be named at an offset of a text with these forms and names."""
    begin = offset - len(BEGUN.search(text, max(0, offset - 100), offset)[0])  # type: ignore[index]
    bracket = len(text[:begin].rstrip()) - 1
    around = root.around(offset)
    is_keyword = bracket >= 0 and text[bracket] == "(" and any(form.start == bracket for form in around[1:])
    if is_keyword:
        around = [form for form in around if form.start < bracket or form is root]
    scope, state = _scope(text, around, names)
    form = around[-1]
    context = WordContext("nothing", begin, form, scope, state, scope)
    if is_keyword:
        return context._replace(wanted="keyword")
    tokens = _tokens(form)
    if any(_is_in_block(*token, offset) for token in tokens):
        return context._replace(wanted="python")
    ends = [item.end if isinstance(item, WrittenForm) else item[2] for item in form.items]
    before = max((end for end in ends if end <= offset), default=form.start)
    if _COMMENT.search(text, before, offset):
        return context
    if form.keyword in FORMS:
        return _in_transition(text, context)
    words = [text[start:end] for _, start, end in tokens if end < begin]
    outer = around[-2] if len(around) > 1 else root
    if form.keyword == "spawn":
        if not words:
            return context._replace(wanted="machine")
        spawned = scope.machine(state, normal(words[0]))
        return context._replace(wanted="state", machine=spawned) if len(words) == 1 else context
    if form.keyword == "var" and outer.keyword == "spawn" and not words:
        first = next((text[start:end] for kind, start, end in _tokens(outer) if kind == "NAME"), "")
        return context._replace(wanted="setting", machine=scope.machine(state, normal(first)))
    return context


def _tokens(form: WrittenForm) -> list[tuple[str, int, int]]:
    return [item for item in form.items if not isinstance(item, WrittenForm)]


def _is_in_block(kind: str, start: int, end: int, offset: int) -> bool:
    if kind == "UNCLOSED":
        return start < offset <= end
    return kind in ("BLOCK", "UNOPENED") and start < offset < end


def _scope(text: str, around: list[WrittenForm], names: Resolution) -> tuple[Scope, str]:
    """Return the machine that forms are in, and its state."""
    path: list[str] = []
    for form in around:
        if form.keyword in ("machine", "state") and form.name is not None:
            path.append(normal(text[slice(*form.name)]))
    state = path.pop() if len(path) % 2 == 0 and path else ""
    found = names.by_path.get(tuple(path))
    return (names.top, "") if found is None else (found, state)


def _in_transition(text: str, context: WordContext) -> WordContext:
    form, begin, scope = context.form, context.begin, context.scope
    before = [
        token for token in _tokens(form) if token[2] < begin or (token[0] == "DOT" and token[2] <= begin)
    ]
    kinds = " ".join(kind for kind, _, _ in before)
    if "ARROW" in kinds:
        if not kinds.endswith("ARROW"):
            return context._replace(wanted="effect")
        return context._replace(wanted="state", machine=scope.outer if form.keyword == "exit" else scope)
    if kinds.endswith("DOT"):
        first = normal(text[slice(*before[0][1:])])
        machine = next(iter(scope.machines_called(first)), None)
        return context._replace(wanted="state", machine=machine)
    words = _GROUP.sub(lambda found: found[1] or "", _IN_STATE.sub("NAME", kinds)).split()
    is_held = form.keyword in HELD
    if is_held and len(words) == 1:
        return context._replace(wanted="held")
    if is_held and len(words) == 2 and words[1] == "FOR":
        return context._replace(wanted="delay")
    if form.keyword == "eps" or words:
        return context._replace(wanted="state")
    return context._replace(wanted="delay" if form.keyword == "ontime" else "event")

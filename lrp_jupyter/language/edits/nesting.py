"""Nesting: a state moves into another one, or out of the one around it, as edits of the text.

The state's transitions to itself go with it. An arrow cannot lead into a nested machine, so one that led to
the state leads to the state around it; one that leaves the state for the outer machine is an ``exit``. What
the language cannot express (an ``exit`` after a delay) is refused, and so is a move that would
change the meaning of a name in the state.

Paper: §3.1 (nested machines), §9.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from itertools import chain

from lrp_jupyter.errors import Edit, edited
from lrp_jupyter.language.edits.drawing import DrawnProgram, WrittenTransition, numbered
from lrp_jupyter.language.edits.form_places import WrittenForm
from lrp_jupyter.language.edits.mentions import (
    Named,
    named_by_spawn,
    named_by_trigger,
    named_in_block,
)
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, State, path_text
from lrp_jupyter.language.reading.forms import article
from lrp_jupyter.language.resolution import Arrow, Scope


class _Move:
    """One move of a state from a machine to another."""

    def __init__(self, drawing: DrawnProgram, scope: Scope, state: State) -> None:
        self.drawing, self.scope, self.state = drawing, scope, state
        self.name = str(state.name)
        self.path = (*scope.path, self.name)
        self.edits: list[Edit] = []
        self.gone: list[WrittenForm] = []  # removed, in addition to what moves
        self.along: list[tuple[WrittenForm, str, str]] = []  # transitions that move: keyword, destination

    def bring(self, arrow: Arrow, keyword: str = "", destination: str = "") -> None:
        """Move a transition with the state, with another keyword or destination."""
        self.along.append((self.drawing.written(arrow).form, keyword, destination))

    def rewrite(self, arrow: Arrow, keyword: str = "", destination: str = "") -> None:
        """Change a transition without moving it."""
        written = self.drawing.written(arrow)
        self.edits += _changes(self.drawing, written.form, keyword, destination)

    def refuse(self, arrow: Arrow, reason: str) -> None:
        """Raise, because this transition prevents the move."""
        remedy = f"Delete it or connect it to another state first, then move `{self.name}`."
        raise ValueError(f"`{arrow.label}` {reason}. {remedy}")

    def arrows(self) -> Iterator[tuple[Arrow, bool]]:
        """Yield the transitions that name the state, and whether as source; those to itself move along."""
        for arrow in chain.from_iterable(self.drawing.names.arrows.values()):
            noun = arrow.noun
            is_source = arrow.scope is self.scope and self.name in noun.sources
            if is_source and (noun.wildcard or set(noun.sources) != {self.name}):
                self.refuse(arrow, "names it together with other states")
            is_destination = noun.destination == self.name and self.scope in arrow.homes
            if is_source and is_destination and not noun.outward:
                self.bring(arrow)
            elif is_source or is_destination:
                yield arrow, is_source
            elif noun.outward and _is_in(arrow.scope.path, self.path) and self.scope in arrow.homes:
                self.refuse(arrow, f"leads from inside `{self.name}` to a state beside it")

    def finish(self, parent: WrittenForm, new_machine: str = "") -> list[Edit]:
        """Return all edits; the state and its transitions are written into a machine, or into a new one."""
        sheet = self.drawing.sheet
        parts = [(sheet.at(self.state.span.start), "", ""), *self.along]
        if new_machine:
            gap = sheet.place(parent, "machine")[1]
            inner = gap if gap == " " else f"{gap}  "
            texts = (inner + self._text(*part, inner) for part in parts)
            self.edits.append(sheet.added(parent, f"(machine {new_machine}{''.join(texts)})"))
        else:
            for part in parts:
                gap = sheet.place(parent, part[0].keyword)[1]
                self.edits.append(sheet.added(parent, self._text(*part, gap)))
        gone = [*self.gone, *(form for form, _, _ in parts)]
        return self.drawing.edits([*self.edits, *sheet.removed(gone)])

    def _text(self, form: WrittenForm, keyword: str, destination: str, gap: str) -> str:
        """Return the text of a form, indented for its new place unless that changes its meaning."""
        sheet, text = self.drawing.sheet, self.drawing.sheet.text[form.start : form.end]
        if gap != " ":
            shifted = sheet.shifted(form, gap.removeprefix(sheet.line_end))
            if parse(_in_machine(shifted)) == parse(_in_machine(text)):
                text = shifted
        if form.keyword == "state":
            return text
        copy = DrawnProgram(_in_machine(text))
        edits = _changes(copy, copy.sheet.root.forms[0].forms[0], keyword, destination)
        return edited(copy.sheet.text, edits)[len(_BEFORE) : -len(_AFTER)]


_BEFORE, _AFTER = "(machine m ", "\n)"


def _in_machine(text: str) -> str:
    return _BEFORE + text + _AFTER


def _changes(drawing: DrawnProgram, form: WrittenForm, keyword: str, destination: str) -> list[Edit]:
    """Return the edits that give a transition another keyword or destination; an empty one stays."""
    edits = []
    if keyword:
        edits.append(Edit(form.head - len(form.keyword), form.head, keyword))
    if destination:
        edits.append(Edit(*WrittenTransition(drawing.sheet, form).destination, destination))
    return edits


def nest(text: str, path: Path, into: str) -> list[Edit]:
    """Return the edits that move a state into another one: into its first machine, or into a new one.

    Raises ValueError: the language cannot express what its transitions would have to do, or a name would mean
        something else.
    """
    drawing = DrawnProgram(text)
    scope, state = drawing.state(path)
    target = drawing.state((*path[:-1], into))[1]
    if target is state:
        raise ValueError(f"`{into}` cannot be inside itself.")
    inner = scope.machines.get(into, {}).get(str(target.machines[0].name)) if target.machines else None
    move = _Move(drawing, scope, state)
    name = move.name
    _refuse_watched(move)
    if inner:
        if name in inner.states:
            raise ValueError(f"`{name}` is taken in `{inner.path[-1]}`. Rename one of them first.")
        _refuse_captured(move, inner)
    for arrow, is_source in move.arrows():
        noun = arrow.noun
        if is_source:
            if noun.kind != "on":
                move.refuse(arrow, "would have to be an `exit`, which needs a condition")
            move.bring(arrow, keyword="exit")
        elif arrow.scope is inner:
            move.rewrite(arrow, keyword="on")
        elif into in noun.sources or (arrow.scope is not scope and arrow.scope.state == into):
            move.refuse(arrow, f"would lead from `{into}` into itself")
        else:
            move.rewrite(arrow, destination=into)
    move.edits += [Edit(*spawn.span(2), into) for spawn in drawing.spawns(scope, name)]
    if inner:
        if not inner.states and not drawing.spawns(inner):
            move.edits.append(drawing.spawn(inner, name))
        return move.finish(drawing.form_of(inner))
    taken = {scope.path[-1] for scope in drawing.names.scopes if scope.path}
    machine = next(free for free in numbered(f"in_{into}") if free not in taken)
    move.edits.append(drawing.spawn_by(target, f"(spawn {machine} {name})"))
    return move.finish(drawing.sheet.at(target.span.start), machine)


def unnest(text: str, path: Path) -> list[Edit]:
    """Return the edits that move a state out of the state around it; a machine that becomes empty is removed.

    Raises ValueError: it is not inside another state, the language cannot express what its transitions would
        have to do, or a name would mean something else.
    """
    drawing = DrawnProgram(text)
    scope, state = drawing.state(path)
    outer, around = scope.outer, scope.state
    if outer is None or outer.noun is None:
        raise ValueError(f"`{path[-1]}` is not inside another state.")
    move = _Move(drawing, scope, state)
    name = move.name
    if name in outer.states:
        raise ValueError(f"`{name}` is taken in `{outer.path[-1]}`. Rename one of them first.")
    _refuse_watched(move)
    _refuse_lost(move, outer)
    for arrow, is_source in move.arrows():
        noun = arrow.noun
        if is_source:
            if noun.outward and set(arrow.homes) != {outer}:
                move.refuse(arrow, "leads somewhere else")
            move.bring(arrow, *(("on", "") if noun.outward else ("", around)))
        elif arrow.scope is not scope or noun.kind != "on" or noun.wildcard or len(noun.sources) != 1:
            move.refuse(arrow, "would have to be an `exit`, which needs one source and a condition")
        else:
            move.rewrite(arrow, keyword="exit")
    spawns = drawing.spawns(scope, name)
    other = next((each for each in scope.states if each != name), None)
    if other is not None:
        move.edits += [Edit(*spawn.span(2), other) for spawn in spawns]
        return move.finish(drawing.form_of(outer))
    has_others = scope.variables or scope.events or len(scope.transitions) > len(move.along)
    move.gone = spawns if has_others else [*spawns, drawing.form_of(scope)]
    return move.finish(drawing.form_of(outer))


def _names(move: _Move) -> Iterator[Named]:
    """Yield what a state and its transitions refer to, looked up in the scopes around it."""
    return (each for each in _all_names(move) if not each.inside)


def _all_names(move: _Move) -> Iterator[Named]:
    names = move.drawing.names
    for element, codes in names.blocks.items():
        if _is_in(element.path, move.path) or _is_own(move, element.path):
            for code in codes:
                yield from named_in_block(code)
    for arrow in chain.from_iterable(names.arrows.values()):
        is_inside = _is_in(arrow.element.path, move.path) or _is_own(move, arrow.element.path)
        if is_inside:
            yield from named_by_trigger(arrow)
    for spawning in names.spawns:
        if _is_in(spawning.spawner, move.path):
            yield from named_by_spawn(spawning)


def _is_in(path: Path, around: Path) -> bool:
    return path[: len(around)] == around


def _is_own(move: _Move, path: Path) -> bool:
    """Return whether a path is that of a transition which leaves the state."""
    arrows = move.drawing.names.arrows[move.scope]
    return any(arrow.element.path == path and move.name in arrow.noun.sources for arrow in arrows)


def _refuse_watched(move: _Move) -> None:
    """Raise if something asks whether the machine is in the state, which will not be in it any more."""
    drawing = move.drawing
    arrows = chain.from_iterable(drawing.names.arrows.values())
    for each in chain(
        chain.from_iterable(map(named_by_trigger, arrows)),
        chain.from_iterable(map(named_in_block, drawing.names.all_blocks)),
    ):
        if (each.kind, each.name, each.scope) == ("state", move.name, move.scope):
            line, _ = drawing.program.place(each.span.start)
            problem = f"Line {line} asks whether `{move.scope.path[-1]}` is in `{move.name}`"
            raise ValueError(f"{problem}. Change that first, then move `{move.name}`.")


def _refuse_captured(move: _Move, inner: Scope) -> None:
    """Raise if a name used in the state would refer to something else in the machine that it moves into."""
    beside = inner.outer.machines[inner.state] if inner.outer else {}
    own: dict[str, Collection[str]] = {"variable": inner.variables, "event": inner.events, "machine": beside}
    for kind, name, _, owner, *_ in _names(move):
        if name in own[kind] and not (owner and _is_in(owner.path, move.path)):
            problem = f"`{name}` would mean another {kind} in `{path_text(inner.path)}`"
            raise ValueError(f"{problem}. Rename one of them first.")


def _refuse_lost(move: _Move, outer: Scope) -> None:
    """Raise if a name used in the state refers to something that is not defined outside."""
    around = (*outer.path, move.scope.state)
    for kind, name, _, owner, *_ in _names(move):
        if owner and _is_in(owner.path, around) and not _is_in(owner.path, move.path):
            problem = f"`{move.name}` uses `{name}`, {article(kind)} {kind} inside `{move.scope.state}`"
            raise ValueError(f"{problem}. Move that out first.")

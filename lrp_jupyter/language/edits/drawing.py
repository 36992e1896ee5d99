"""Drawing: changes made in a state graph, as edits of the program's text.

Every function returns the edits for one change (a new state, a retargeted transition, …) and leaves all
other text alone, as in `form_places`. A change that would not result in a valid program is refused with a
message. A new form goes after the last one of its kind: a new transition has the lowest priority.

Paper: §9 (editing the state graph itself).
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import chain
from typing import Literal, NamedTuple

from lrp_jupyter.errors import Edit, LRPSyntaxError, UnknownElementError, edited
from lrp_jupyter.language.blocks.names_in_blocks import normal
from lrp_jupyter.language.edits.form_places import Sheet, WrittenForm
from lrp_jupyter.language.edits.rename import check_name
from lrp_jupyter.language.lookup import find
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, Program, State, path_text
from lrp_jupyter.language.python.scanner import block_end
from lrp_jupyter.language.reading.forms import Shape, shape_of
from lrp_jupyter.language.reading.tokens import HELD, LEGAL, tokenize
from lrp_jupyter.language.resolution import Arrow, Resolution, Scope, resolve
from lrp_jupyter.language.triggers import FORMS

FIRST_MACHINE = "main"
"""The name of the machine that is made for the first state of an empty program."""

_AMOUNT = re.compile(r"(\d+(?:\.\d+)?)\s*(ms|s)")
_HELD = re.compile(r"(.*\S)\s+for\s+(\S.*)", re.DOTALL)
_KEYWORD = re.compile(rf"({'|'.join(FORMS)})(?:\s+(?=\S)|(?=\[))")


class DrawnProgram:
    """A program as nested forms and resolved names; LRPSyntaxError if its text is not valid."""

    def __init__(self, text: str) -> None:
        self.program: Program = parse(text)
        self.names: Resolution = resolve(self.program)
        self.sheet = Sheet(text)

    def machine(self, path: Path) -> Scope:
        """Return the machine at a path."""
        return self.names.by_path[find(self.program, "machine", path).path]

    def state(self, path: Path) -> tuple[Scope, State]:
        """Return the state at a path, and its machine."""
        *where, name = find(self.program, "state", path).path
        scope = self.names.by_path[tuple(where)]
        return scope, scope.states[name]

    def arrow(self, path: Path) -> Arrow:
        """Return the transition at a path."""
        arrow = self.names.arrow(find(self.program, "transition", path))
        assert arrow is not None
        return arrow

    def form_of(self, scope: Scope) -> WrittenForm:
        """Return the form of a machine, or the top level."""
        return self.sheet.root if scope.noun is None else self.sheet.at(scope.noun.span.start)

    def written(self, arrow: Arrow) -> WrittenTransition:
        """Return a transition as it is written."""
        return WrittenTransition(self.sheet, self.sheet.at(arrow.noun.span.start))

    def spawns(self, scope: Scope, state: str = "") -> list[WrittenForm]:
        """Return the spawns that start a machine, in a state or in any."""
        spawns = [each.noun for each in self.names.spawns if each.machine is scope]
        return [self.sheet.at(spawn.span.start) for spawn in spawns if state in ("", spawn.state)]

    def spawn(self, scope: Scope, state: str) -> Edit:
        """Return the edit that spawns a machine which nothing spawns yet."""
        form = f"(spawn {scope.path[-1]} {state})"
        if scope.outer is None or scope.outer.noun is None:
            return self.sheet.added(self.sheet.root, form)
        return self.spawn_by(scope.outer.states[scope.state], form)

    def spawn_by(self, state: State, form: str) -> Edit:
        """Return the edit that adds a spawn to what a state does on entry."""
        return self.sheet.spawned_by(self.sheet.at(state.span.start), form)

    def edits(self, edits: Iterable[Edit]) -> list[Edit]:
        """Return edits in order, insertions at one place joined; raise ValueError if no program results."""
        joined: list[Edit] = []
        for edit in sorted(edits, key=lambda edit: edit[:2]):
            if joined and edit.start == edit.end == joined[-1].start == joined[-1].end:
                joined[-1] = edit._replace(text=joined[-1].text + edit.text)
            else:
                joined.append(edit)
        try:
            parse(edited(self.sheet.text, joined))
        except LRPSyntaxError as error:
            raise ValueError(error.findings[0].message) from None
        return joined


class WrittenTransition(NamedTuple):
    """A transition as it is written, with the places of its parts."""

    sheet: Sheet
    form: WrittenForm

    @property
    def shape(self) -> Shape:
        """The roles of its parts."""
        found = shape_of(self.form.types)
        assert isinstance(found, Shape)
        return found

    @property
    def destination(self) -> tuple[int, int]:
        """The range of its destination."""
        return self.form.span(self.shape.destination)

    @property
    def source(self) -> tuple[int, int]:
        """The range of its whole source, as written."""
        return self.form.span(self.shape.first_of_source)[0], self.form.span(self.shape.destination - 2)[1]

    def sources(self, name: str) -> list[int]:
        """Return the indices of its parts that name a state as a source, or as an exception from `*`."""
        spans = {index: self.form.span(index) for index in self.shape.sources}
        return [index for index, span in spans.items() if self.sheet.name(span) == name]

    def without(self, name: str) -> list[Edit]:
        """Return the edits that remove a state from several sources or exceptions."""
        gone, all_ = self.sources(name), self.shape.sources
        if len(gone) == len(all_):  # `*-{a}` becomes `*`
            return [Edit(self.form.span(all_[0] - 2)[0], self.form.span(all_[-1] + 1)[1], "")]
        edits = []
        for index in gone:
            start, end = self.form.span(index)
            if index != all_[0]:
                before = self.form.span(index - 1)[1]
                blank = not self.sheet.text[before:start].strip(" \t")
                edits.append(Edit(before if blank else start, end, ""))
            else:
                after = self.form.span(index + 1)[0]
                blank = index + 1 not in gone and not self.sheet.text[end:after].strip(" \t")
                edits.append(Edit(start, after if blank else end, ""))
        return edits


# -- new elements ----------------------------------------------------------------------------------------


def new_state(text: str, machine: Path, name: str) -> list[Edit]:
    """Return the edits for a new state; the first one of a machine is its start.

    `machine`: empty to make a machine as well, which is the one that is spawned already, if there is none.
    Raises ValueError: the name cannot be used.
    """
    drawing = DrawnProgram(text)
    name = _new_name(name)
    if not machine:
        one, taken = drawing.sheet.line_end, drawing.names.top.machines.get("", {})
        spawned = [str(spawn.machine) for spawn in drawing.program.spawns]
        wanted = chain(spawned, numbered(FIRST_MACHINE))
        first = next(free for free in wanted if free not in taken)
        form = f"(machine {first}{one}  (state {name}))"
        if first in spawned:
            there = [spawn for spawn in drawing.program.spawns if spawn.machine == first]
            starts = _started([drawing.sheet.at(spawn.span.start) for spawn in there], name)
            return drawing.edits([drawing.sheet.added(drawing.sheet.root, form), *starts])
        spawn = f"(spawn {first} {name})"
        if drawing.program.spawns:
            return drawing.edits([drawing.sheet.added(drawing.sheet.root, each) for each in (form, spawn)])
        return drawing.edits([drawing.sheet.added(drawing.sheet.root, form, spawn)])
    scope = drawing.machine(machine)
    return drawing.edits(_state(drawing, scope, name))


def numbered(name: str) -> Iterable[str]:
    """Return a name, followed by the same name with a number appended, starting with 2."""
    return chain((name,), (f"{name}{number}" for number in range(2, 10_000)))


def _new_name(name: str) -> str:
    check_name("state", name)
    return normal(name)


def _state(drawing: DrawnProgram, scope: Scope, name: str) -> list[Edit]:
    if name in scope.states:
        raise ValueError(f"`{name}` is taken by another state. Choose another name.")
    edits = [drawing.sheet.added(drawing.form_of(scope), f"(state {name})")]
    if not scope.states:
        edits += _started(drawing.spawns(scope), name) or [drawing.spawn(scope, name)]
    return edits


def _started(spawns: list[WrittenForm], state: str) -> list[Edit]:
    """Return the edits with which spawns start their machine in a state."""
    return [Edit(*spawn.span(2), state) for spawn in spawns]


def new_transition(text: str, machine: Path, source: str, destination: str, trigger: str) -> list[Edit]:
    """Return the edits for a new transition.

    `source`: a state of the machine, or ``*``.
    `destination`: a state of the machine; created if it does not exist.
    `trigger`: an event, a block or the state of a machine (``move.reached``), which may have to hold for some
        time (``near for 2 s``), a delay (``300``, ``2 s``, a variable), or nothing for ``eps``; anything else
        becomes a condition. A keyword before it takes precedence: ``ontime [pause]``.
    Raises ValueError: it would not be a valid program.
    """
    drawing = DrawnProgram(text)
    scope = drawing.machine(machine) if source == "*" else drawing.state((*machine, source))[0]
    destination = _new_name(destination)
    edits = [] if destination in scope.states else _state(drawing, scope, destination)
    keyword, condition = _trigger(scope, trigger.strip())
    form = " ".join(filter(None, (keyword, *condition, source, "->", destination)))
    form = _only_form(f"({form})", "machine")
    edits.append(drawing.sheet.added(drawing.form_of(scope), form))
    return drawing.edits(edits)


def _trigger(scope: Scope, trigger: str) -> tuple[str, tuple[str, ...]]:
    """Return the keyword and the text of what was written as a trigger, and of its ``for``, if any."""
    if trigger in ("", "eps", "ε"):
        return "eps", ()
    if found := _KEYWORD.match(trigger):
        return found[1], (_milliseconds(trigger[found.end() :]),)
    if _milliseconds(trigger).isdecimal():
        return "ontime", (_milliseconds(trigger),)
    if trigger.isidentifier():
        name = normal(trigger)
        if scope.owner("event", name) is not None:
            return "on", (trigger,)
        if name not in ("True", "False"):
            return ("on" if scope.owner("variable", name) is None else "ontime"), (trigger,)
    if _is_block(trigger):
        return "on", (trigger,)
    if (found := _HELD.fullmatch(trigger)) and (delay := _delay(found[2])):
        keyword, condition = _trigger(scope, found[1])
        if keyword in HELD:
            return keyword, (*condition, "for", delay)
    machine, _, state = map(normal, trigger.partition("."))
    if any(state in each.states for each in scope.machines_called(machine)):
        return "on", (trigger,)
    return "on", (f"[{trigger}]",)


def _is_block(text: str) -> bool:
    return text[:1] == "[" and block_end(text, 0) == len(text) - 1


def _are_blocks(text: str) -> bool:
    while text[:1] == "[" and (end := block_end(text, 0)) >= 0:
        text = text[end + 1 :].lstrip()
        if not text:
            return True
    return False


def _delay(text: str) -> str:
    """Return a delay as the language writes it; empty if the text is none."""
    delay = _milliseconds(text.strip())
    return delay if delay.isdecimal() or delay.isidentifier() or _is_block(delay) else ""


def _milliseconds(text: str) -> str:
    """Return a time with its unit (``2 s``) in milliseconds; any other text unchanged."""
    found = _AMOUNT.fullmatch(text)
    return str(round(float(found[1]) * (1000 if found[2] == "s" else 1))) if found else text


def new_form(text: str, path: Path, form: str) -> list[Edit]:
    """Return the edits that add a form to a state, to a machine, or to the program.

    `form`: ``event late [time > 3]``, with or without its brackets.
    Raises ValueError: it is not exactly one form, or is not allowed there.
    """
    drawing = DrawnProgram(text)
    keyword = find(drawing.program, ("machine", "state"), path).kind if path else "program"
    if keyword == "state":
        parent = drawing.sheet.at(drawing.state(path)[1].span.start)
    else:
        parent = drawing.form_of(drawing.machine(path) if path else drawing.names.top)
    return drawing.edits([drawing.sheet.added(parent, _only_form(form, keyword))])


def _only_form(text: str, keyword: str) -> str:
    """Return a form with its brackets if it is exactly one, legal in a form with this keyword."""
    text = text.strip()
    form = text if text.startswith("(") else f"({text})"
    tokens = tokenize(form)
    kinds = [kind for kind, _, _ in tokens]
    if form[tokens[-1][2] :].strip():
        raise ValueError(f"`{text}` ends with a comment. Remove the comment.")
    if kinds.count("OPEN") > kinds.count("CLOSE"):
        raise ValueError(f"`{text}` is not closed. Put a `)` at its end.")
    before = {"state": "(machine m (state s ", "machine": "(machine m ", "program": ""}[keyword]
    whole = f"{before}{form}\n{')' * before.count('(')}"
    try:
        parse(whole)
    except LRPSyntaxError as error:
        raise ValueError(error.findings[0].message) from None
    found = Sheet(whole).at(len(before))
    if found.end != len(before) + len(form) or found.keyword not in LEGAL[keyword]:
        raise ValueError(f"`{text}` is more than one form. Write one at a time.")
    return form


# -- removed elements ------------------------------------------------------------------------------------


def delete_transition(text: str, path: Path) -> list[Edit]:
    """Return the edits that delete a transition."""
    drawing = DrawnProgram(text)
    return drawing.edits(drawing.sheet.removed([drawing.written(drawing.arrow(path)).form]))


def delete_state(text: str, path: Path) -> list[Edit]:
    """Return the edits that delete a state, with its transitions.

    A transition with other sources, or with other exceptions from ``*``, loses only this one. A machine
    that starts in the state starts in the first remaining one; if there is none, its spawn is removed.
    Raises ValueError: there are two states of this name.
    """
    drawing = DrawnProgram(text)
    scope, state = drawing.state(path)
    name = str(state.name)
    if scope.noun and [str(each.name) for each in scope.noun.states].count(name) > 1:
        raise ValueError(f"`{name}` is defined twice. Remove the second definition first.")
    gone, edits = [drawing.sheet.at(state.span.start)], []
    for arrow in chain.from_iterable(drawing.names.arrows.values()):
        noun, here = arrow.noun, arrow.scope is scope
        if noun.destination == name and set(arrow.homes) == {scope}:
            gone.append(drawing.written(arrow).form)
        elif here and name in noun.sources:
            if noun.wildcard or set(noun.sources) != {name}:
                edits += drawing.written(arrow).without(name)
            else:
                gone.append(drawing.written(arrow).form)
    other = next((each for each in scope.states if each != name), None)
    for spawn in drawing.spawns(scope, name):
        if other is None:
            gone.append(spawn)
        elif not state.span.start < spawn.start < state.span.end:
            edits.append(Edit(*spawn.span(2), other))
    return drawing.edits([*edits, *drawing.sheet.removed(gone)])


def delete_machine(text: str, path: Path) -> list[Edit]:
    """Return the edits that delete a machine, with its spawns."""
    drawing = DrawnProgram(text)
    scope = drawing.machine(path)
    return drawing.edits(drawing.sheet.removed([drawing.form_of(scope), *drawing.spawns(scope)]))


# -- changed transitions ---------------------------------------------------------------------------------


def change_transition(text: str, path: Path, form: str) -> list[Edit]:
    """Return the edits that rewrite a transition, or raise ValueError; the new text may lack the brackets."""
    drawing = DrawnProgram(text)
    old = drawing.written(drawing.arrow(path)).form
    new = _only_form(form, "machine")
    if Sheet(new).root.forms[0].keyword not in FORMS:
        raise ValueError(f"`{form.strip()}` is not a transition. Begin with {', '.join(FORMS)}.")
    return drawing.edits([Edit(old.start, old.end, new)])


def set_trigger(text: str, path: Path, trigger: str) -> list[Edit]:
    """Return the edits that change when a transition fires; `trigger` is written as for a new one.

    Raises ValueError: it would not be a valid program.
    """
    drawing = DrawnProgram(text)
    arrow = drawing.arrow(path)
    written = drawing.written(arrow)
    keyword, condition = _trigger(arrow.scope, trigger.strip())
    if arrow.noun.outward and keyword == "on":
        keyword = arrow.noun.kind
    head, start = written.form.head, written.source[0]
    new = " ".join((keyword, *condition))
    return drawing.edits([Edit(head - len(arrow.noun.kind), start, f"{new} ")])


def set_hold(text: str, path: Path, delay: str) -> list[Edit]:
    """Return the edits that change for how long the trigger of a transition has to hold; empty: at once.

    `delay`: as in the text, or with a unit (``2 s``).
    Raises ValueError: it is not a delay, or the transition waits for a time already.
    """
    drawing = DrawnProgram(text)
    arrow = drawing.arrow(path)
    if arrow.noun.kind not in HELD:
        raise ValueError(f"`{arrow.label}` waits for no condition that could hold for some time.")
    written = drawing.written(arrow)
    hold, last = written.shape.hold, written.shape.trigger[-1]
    new = _delay(delay)
    if delay.strip() and not new:
        raise ValueError(f"`{delay.strip()}` is not a time. Write milliseconds, `2 s`, or a variable.")
    if hold is None:
        end = written.form.span(last)[1]
        return drawing.edits([Edit(end, end, f" for {new}")] if new else [])
    if new:
        return drawing.edits([Edit(*written.form.span(hold), new)])
    return drawing.edits([Edit(written.form.span(last)[1], written.form.span(hold)[1], "")])


def set_effect(text: str, path: Path, code: str) -> list[Edit]:
    """Return the edits that change what a transition does when it fires; empty: nothing.

    `code`: Python, with or without its square brackets, or several blocks.
    Raises ValueError: it is not valid.
    """
    drawing = DrawnProgram(text)
    written = drawing.written(drawing.arrow(path))
    code = code.strip()
    form = f"(effect {code if _are_blocks(code) else f'[{code}]'})"
    if written.shape.effect is None:
        end = written.form.span(len(written.form.items))[1]
        return drawing.edits([Edit(end, end, f" {form}")] if code else [])
    old = written.form.items[written.shape.effect - 1]
    assert isinstance(old, WrittenForm)
    return drawing.edits([Edit(old.start, old.end, form)] if code else drawing.sheet.removed([old]))


def set_setting(text: str, path: Path, machine: str, name: str, value: str) -> list[Edit]:
    """Return the edits that change with which value a state spawns a machine; empty: with the machine's own.

    `path`: the state; empty for the top level. `machine`, `name`: its machine, and the variable of that.
    Raises ValueError: the state does not spawn the machine, or no valid program would result.
    """
    drawing = DrawnProgram(text)
    spawner = find(drawing.program, "state", path).path if path else ()
    spawns = (each.noun for each in drawing.names.spawns if each.spawner == spawner)
    spawn = next((each for each in spawns if each.machine == machine), None)
    if spawn is None:
        raise ValueError(f"`{path[-1] if path else 'The program'}` spawns no machine `{machine}`.")
    written = drawing.sheet.at(spawn.span.start)
    value = value.strip()
    form = f"(var {name} := {value if _is_block(value) else f'[{value}]'})"
    old = next((each for each in spawn.settings if each.name == name), None)
    if old is None:
        end = written.span(len(written.items))[1]
        return drawing.edits([Edit(end, end, f" {form}")] if value else [])
    setting = drawing.sheet.at(old.span.start)
    return drawing.edits(
        [Edit(setting.start, setting.end, form)] if value else drawing.sheet.removed([setting])
    )


def retarget(
    text: str, path: Path, end: Literal["source", "destination"], name: str, old: str = ""
) -> list[Edit]:
    """Return the edits that connect one end of a transition to another state.

    `name`: the other state; as a source also ``*``. `old`: the source to replace, if there are several.
    Raises UnknownElementError: there is no such state.
    """
    drawing = DrawnProgram(text)
    arrow = drawing.arrow(path)
    written = drawing.written(arrow)
    homes = [arrow.scope] if end == "source" else list(arrow.homes)
    every = end == "source" and name == "*"
    if not every and not any(name in home.states for home in homes):
        where = path_text((homes[0] if homes else arrow.scope).path)
        known = [state for home in homes for state in home.states]
        raise UnknownElementError.missing(f"There is no state `{name}` in `{where}`.", name, known)
    if end == "destination":
        return drawing.edits([Edit(*written.destination, name)])
    if every or arrow.noun.wildcard or len(arrow.noun.sources) == 1:
        return drawing.edits([Edit(*written.source, name)])
    if not written.sources(old):
        message = f"`{old}` is not one of the sources of `{path[-1]}`."
        raise UnknownElementError.missing(message, old, arrow.noun.sources)
    if name == old:
        return []
    if name in arrow.noun.sources:
        return drawing.edits(written.without(old))
    return drawing.edits([Edit(*written.form.span(index), name) for index in written.sources(old)])


def reverse(text: str, path: Path) -> list[Edit]:
    """Return the edits that exchange the two states of a transition; raise ValueError if it has others."""
    drawing = DrawnProgram(text)
    arrow = drawing.arrow(path)
    noun, written = arrow.noun, drawing.written(arrow)
    if noun.outward or noun.wildcard or len(noun.sources) != 1:
        reason = "Only a transition between two states of one machine can."
        raise ValueError(f"`{arrow.label}` cannot be reversed. {reason}")
    source, destination = str(noun.sources[0]), str(noun.destination)
    return drawing.edits([Edit(*written.source, destination), Edit(*written.destination, source)])


def start_in(text: str, path: Path) -> list[Edit]:
    """Return the edits that start a machine in a state; it is spawned if nothing spawns it."""
    drawing = DrawnProgram(text)
    scope, state = drawing.state(path)
    name, spawns = str(state.name), drawing.spawns(scope)
    return drawing.edits(_started(spawns, name) or [drawing.spawn(scope, name)])

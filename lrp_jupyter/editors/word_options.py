"""Completion of the language and of Python in its blocks; as `complete.ts` of the lab's page."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.editors.program_text import ProgramText
from lrp_jupyter.editors.python_options import (
    PythonOption,
    arguments_of,
    fields_of,
    members_beginning,
    names_beginning,
    option_of,
)
from lrp_jupyter.editors.word_context import WordContext, context_at
from lrp_jupyter.errors import LRPError
from lrp_jupyter.language.blocks.builtin_names import builtin
from lrp_jupyter.language.form_texts import form_texts
from lrp_jupyter.language.reading.tokens import KEYWORDS, LEGAL
from lrp_jupyter.language.resolution import Scope

_NEAR = 1000  # characters in which a message gets its name
_CHAIN = re.compile(r"[\w.\u0080-\uffff]*\Z")
_COMPARED = re.compile(
    r"([\w\u0080-\uffff]+)\.state\s*(?:[!=]=|(?:not\s+)?in\s*[([{][^)\]}]*)\s*[\"']([\w\u0080-\uffff]*)\Z"
)
"""In a string that is compared with the state of a machine."""
_TAKING = re.compile(r"\brobot\.([\w.]+)\((?:[^()]*,)?\s*\Z")
"""In the brackets of a command, where an argument begins."""
_FIELD = re.compile(r"#\{(.*?)\}")


class WordOption(NamedTuple):
    """One completion.

    `kind`: as in `PythonOption`, or ``state``, ``event`` or ``machine``.
    `snippet`: what is written instead of the label, with fields; empty for the label.
    """

    label: str
    kind: str
    detail: str = ""
    info: str = ""
    snippet: str = ""


class WordOptions(NamedTuple):
    """The completions of the word that begins at an offset."""

    begin: int
    options: tuple[WordOption, ...]


def complete(text: ProgramText, offset: int) -> WordOptions:
    """Return what can be written at an offset."""
    place = context_at(text.text, text.root, text.names, offset)
    if place.wanted == "python":
        return _python(text, offset, place.scope)
    return WordOptions(place.begin, tuple(_of_program(text, offset, place)))


def _of_program(text: ProgramText, offset: int, place: WordContext) -> Iterator[WordOption]:
    match place.wanted:
        case "keyword":
            yield from _keywords(text, offset, place)
        case "event":
            yield from _events(place.scope)
            dot = "" if text.text[offset : offset + 1] == "." else "."
            yield from _machines(place.scope, dot)
        case "delay":
            yield from _variables(place.scope)
        case "held":
            yield from _states(place.machine)
            yield _keyword("for")
        case "state":
            yield from _states(place.machine)
        case "machine":
            yield from (WordOption(name, "machine") for name in sorted(place.scope.spawnable(place.state)))
        case "setting":
            is_whole = re.match(r"[\w\u0080-\uffff]*\s*:=", text.text[offset : offset + _NEAR])
            for option in _own_variables(place.machine):
                yield option if is_whole else option._replace(snippet=f"{option.label} := [$0]")
        case "effect":
            effect = _keyword("effect")
            yield effect._replace(label="(effect […])", snippet=f"({effect.snippet})")


def _keywords(text: ProgramText, offset: int, place: WordContext) -> Iterator[WordOption]:
    """Return the keywords that may stand in a form, with its closing bracket if that is not there yet."""
    known = form_texts()
    around = place.form.keyword
    legal = LEGAL.get(around, ()) if around in KEYWORDS or around == "program" else known
    begun = text.root.around(offset)[-1]
    ending = "" if begun.is_closed or begun is text.root else ")"
    for keyword in known:
        if keyword in legal and keyword != "for":
            option = _keyword(keyword)
            yield option._replace(snippet=option.snippet + ending)


def _keyword(keyword: str) -> WordOption:
    form = form_texts()[keyword]
    fields = iter(range(1, 9))
    template = form.template.replace("\t", "  ")
    snippet = _FIELD.sub(lambda f: f"${{{next(fields)}:{f[1]}}}" if f[1] else "$0", template)
    return WordOption(keyword, "keyword", form.detail, f"`{form.usage}`\n\n{form.doc}", snippet)


def _events(scope: Scope) -> Iterator[WordOption]:
    for name, owner in scope.visible_events.items():
        yield WordOption(name, "event", _short(f"[{owner.events[name].condition.text}]"))


def _machines(scope: Scope, dot: str) -> Iterator[WordOption]:
    """Yield the machines whose state can be asked for, with the dot that this takes."""
    names = sorted(scope.callable_names())
    return (WordOption(name, "machine", "machine", snippet=name + dot) for name in names)


def _states(machine: Scope | None) -> Iterator[WordOption]:
    return (WordOption(name, "state", "state") for name in (machine.states if machine else ()))


def _variables(scope: Scope) -> Iterator[WordOption]:
    for name, owner in scope.visible.items():
        yield WordOption(name, "variable", _short(f"[{owner.variables[name].initial.text}]"))


def _own_variables(machine: Scope | None) -> Iterator[WordOption]:
    for name, variable in (machine.variables if machine else {}).items():
        yield WordOption(name, "variable", _short(f"[{variable.initial.text}]"))


def _short(text: str) -> str:
    words = " ".join(text.split())
    return words if len(words) <= 40 else f"{words[:39]}…"


# -- Python ----------------------------------------------------------------------------------------------


def _python(text: ProgramText, offset: int, scope: Scope) -> WordOptions:
    before = text.text[max(0, offset - _NEAR) : offset]
    compared = _COMPARED.search(before)
    if compared:
        machine, begun = compared.groups()
        return WordOptions(offset - len(begun), tuple(_states(machine_in(scope, machine))))
    prefix = _CHAIN.search(before)[0]  # type: ignore[index]
    if prefix[:1].isdigit():
        return WordOptions(offset, ())
    begun = prefix.rpartition(".")[2]
    begin = offset - len(begun)
    bridge = text.robot.read(text.text).bridge
    own: list[WordOption] = []
    command = filled_by(prefix, before[: len(before) - len(begun)], text.text[offset : offset + _NEAR])
    if command is not None:
        more = _robot_members(bridge, command)
    elif "." in prefix:
        chain = prefix.rpartition(".")[0]
        own = _results(scope, chain)
        more = (
            [] if own else _robot_members(bridge, prefix) if prefix.startswith("robot.") else _of_value(chain)
        )
    else:
        hidden = scope.visible
        own = [*_variables(scope), WordOption("robot", "variable", "the robot")]
        own += [each for each in (*_events(scope), *_machines(scope, ".")) if each.label not in hidden]
        taking = _TAKING.search(before[: len(before) - len(begun)])
        more = arguments_of(bridge, f"robot.{taking[1]}") if taking and bridge is not None else []
        more = [*more, *names_beginning(begun, {})]
    known = {each.label for each in own}
    others = (WordOption(**each) for each in more if each["label"] not in known)
    return WordOptions(begin, (*own, *others))


def _results(scope: Scope, name: str) -> list[WordOption]:
    """Return what follows the dot of a machine: its state and its variables."""
    machine = machine_in(scope, name)
    if machine is None:
        return []
    variables = [each for each in _own_variables(machine) if each.label != "state"]
    return [WordOption("state", "property", "the active state"), *variables]


def machine_in(scope: Scope, name: str) -> Scope | None:
    """Return the machine that a name in a block means; a variable hides it."""
    return None if name in scope.visible else next(iter(scope.machines_called(name)), None)


def _robot_members(bridge: Bridge | None, prefix: str) -> list[PythonOption]:
    """Return the members of the robot, or of a part of it, at the last dot of a text."""
    if bridge is None:
        return []
    chain = prefix.rpartition(".")[0]
    if chain != "robot":
        return fields_of(bridge, chain) or []
    return [option_of(bridge.describe(name)) for name in dir(bridge.robot)]


def _of_value(chain: str) -> list[PythonOption]:
    """Return what is in a value that only Python or the language defines."""
    first, *rest = chain.split(".")
    try:
        value = builtin(first)
        for name in rest:
            value = getattr(value, name)
    except (AttributeError, LRPError):
        return []
    return members_beginning(value, "")


def filled_by(prefix: str, before: str, after: str) -> str | None:
    """Return what ``msg.linear.`` means where `msg` is the message that a command fills.

    It is filled by a lambda, in a ``with``, or by a ``def`` that is handed to the command further down.
    """
    name, *rest = prefix.split(".")
    if not (name and rest) or name == "robot":
        return None
    filler = _last(rf"\bdef\s+(\w+)\(\s*{name}\b", before)
    command = filler and _last(rf"robot\.([\w.]+)\(\s*{filler}\b", after)
    command = command or _last(rf"robot\.([\w.]+)(?:\(\s*lambda\s+|\s+as\s+){name}\s*:", before)
    return f"robot.{command}().{'.'.join(rest)}" if command else None


def _last(pattern: str, text: str) -> str | None:
    found = re.findall(pattern, text)
    return found[-1] if found else None

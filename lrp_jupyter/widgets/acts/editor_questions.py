"""The questions of an editor: completion, hover, references, format, versions, files.

They are answered on the worker's thread. Live values are read between two ticks, on the interpreter's
thread, which passes on only texts of limited length.
"""

from __future__ import annotations

import inspect
import keyword
from collections.abc import Iterable, Mapping
from typing import Any

from lrp_jupyter import codes
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.member_tree import RobotMethod
from lrp_jupyter.bridges.members import Member, MemberError
from lrp_jupyter.bridges.robot import Robot
from lrp_jupyter.editors.python_options import (
    arguments_of,
    doc_of,
    fields_of,
    members_beginning,
    names_beginning,
    signature_of,
)
from lrp_jupyter.errors import LRPError, LRPSyntaxError, UnknownElementError
from lrp_jupyter.interpreter.rendering import render
from lrp_jupyter.language.blocks.builtin_names import TIME_TEXTS, builtin
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.edits.format import formatting
from lrp_jupyter.language.edits.rename import references as find_references
from lrp_jupyter.language.lookup import as_defined, called
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Path, Program, path_text
from lrp_jupyter.language.resolution import Scope, resolve
from lrp_jupyter.live.running.frame import Frame
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.acts.messages import OpenProgram, question
from lrp_jupyter.widgets.views.program_picture import still
from lrp_jupyter.widgets.wire.page_places import edits_view, id_of, offset_of, path_of, range_of
from lrp_jupyter.widgets.wire.protocol import (
    ElementKind,
    ExplanationView,
    HoverView,
    Option,
    ReferencesView,
    TextEdit,
    VersionView,
    WhyLine,
    WhyView,
)


class _NothingError(Exception):
    """A name has no meaning here."""


@question("svg")
def picture(opened: OpenProgram) -> str:
    """Return a picture of the program, to be stored with its text."""
    return still(opened.session, opened.view_state())


@question("options")
def complete(opened: OpenProgram, prefix: str, scope: str) -> list[Option]:
    """Complete a Python expression (``robot.li``) in the scope of a machine path ("" for the top level).

    The path of an instance, as spawned, means its variables.

    ``robot.move().`` asks for the fields of the message that a command sends, ``robot.move(`` for its
    arguments. The page itself completes keywords and the program's names.
    """
    session = opened.session
    robot = session.bridge
    command, bracket, argument = prefix.partition("(")
    if bracket and not argument.startswith(")"):
        return [each for each in arguments_of(robot, command) if each["label"].startswith(argument)]
    before, dot, begun = prefix.rpartition(".")
    if not dot:
        return [*names_beginning(begun, session.namespace)]
    fields = fields_of(robot, before)
    if fields is not None:
        return [each for each in fields if each["label"].startswith(begun)]
    try:
        return session.call(lambda: members_beginning(_value_of(session, before, scope), begun))
    except _NothingError:
        return []


@question("hover")
def hover(opened: OpenProgram, chain: str, scope: str) -> HoverView | None:
    """Describe a dotted name (``robot.light.data``) in a scope, with its present value."""
    if keyword.iskeyword(chain):
        return None
    session = opened.session
    frame = opened.looking.shown(session).frame
    path = _variable_in_scope(frame.program, chain, scope)
    if path is not None:
        return _variable_card(frame, chain, path)
    computed = _computed_card(session, chain, scope)
    if computed is not None:
        return computed

    def card() -> HoverView:
        if chain.startswith("robot."):
            return _member_card(chain, session.bridge.describe(chain.removeprefix("robot.")))
        return _card(chain, _value_of(session, chain, scope))

    try:
        return session.call(card)
    except (_NothingError, MemberError):
        return None


@question("references")
def references(opened: OpenProgram, line: int, column: int) -> ReferencesView | None:
    """Find the element named at a place of the last text sent."""
    text = opened.texts.text
    program, _ = scan(text)
    if program is None:
        raise LRPError(
            "The text is not a valid program at the moment, so references cannot be found. Correct it first."
        )
    found = find_references(program, offset_of(text, line, column))
    if found is None:
        return None
    definition = range_of(text, *found.definition)
    others = [range_of(text, *span) for span in found.references if span != found.definition]
    kind: Any = found.element.kind
    return {
        "kind": kind,
        "path": id_of(kind, found.element.path),
        "name": text[slice(*found.definition)],
        "definition": definition,
        "references": [definition, *others],
    }


@question("edits")
def format_(opened: OpenProgram, text: str) -> list[TextEdit]:
    """Lay out a program's text; only white space changes."""
    try:
        edits = formatting(text)
    except LRPSyntaxError:
        raise LRPError("The text has errors, so it cannot be formatted. Correct them first.") from None
    return edits_view(text, edits)


@question("why")
def why(opened: OpenProgram, kind: ElementKind, path: str) -> WhyView:
    """Ask why a transition did not fire, why a state is active, or why the robot does what it does.

    `kind` is ``transition``, ``state`` or ``robot``, whose `path` is the name of a command, or empty for the
    command that moves it. The question is about the moment that the views show.
    """
    session = opened.session
    at = opened.looking.tick(session)
    try:
        if kind == "transition":
            reason = session.why_not(path_of(kind, path), at)
        elif kind == "state":
            reason = session.why(path_of(kind, path), at)
        else:
            reason = session.why(f"robot.{path or _moving(session.bridge)}", at)
    except ValueError as error:
        raise LRPError(str(error)) from None
    program = session.at(reason.tick).program if reason.code != "not-in-program" else session.program
    lines: list[WhyLine] = []
    sources = program.text.splitlines()
    for line in reason.facts["lines"]:
        if line <= len(sources):
            lines.append({"line": line, "text": sources[line - 1].strip()})
    return {
        "code": reason.code,
        "name": _name_of(kind, path, program),
        "tick": reason.tick,
        "time": reason.time,
        "sentence": str(reason),
        "lines": lines,
        "present": program.text == session.program.text,
    }


@question("explanation")
def explain(opened: OpenProgram, code: str) -> ExplanationView:
    """Explain a code, such as ``LRP301``."""
    found, *_ = codes.explain(code)
    return {
        "code": found.code,
        "title": found.title,
        "explanation": found.explanation,
        "example": found.example,
        "script": found.script,
        "remedy": found.remedy,
        "repaired": found.repaired,
        "address": found.address,
    }


@question("versions")
def versions(opened: OpenProgram) -> list[VersionView]:
    """List the earlier texts, the newest first."""
    return [
        {"key": version.key, "when": version.when, "text": version.text} for version in opened.texts.versions
    ]


@question("exists", only_looks=False)
def save(opened: OpenProgram, name: str, replace: bool) -> bool:
    """Write the text to a file; return whether another file is there, and nothing was written."""
    if not name.strip():
        raise LRPError("Enter a name for the file.")
    return not opened.saver.save_as(name.strip(), replace)


# -- Python names ----------------------------------------------------------------------------------------


def _member_card(title: str, member: Member) -> HoverView:
    names = (field.name.removeprefix(f"{member.name}.") for field in member.fields)
    inside = ", ".join(names)
    shown = {"method": "", "task": inside, "part": inside, "variable": member.absence or render(member.value)}
    return _hover_view(title + member.signature, member.type, shown[member.kind], member.doc)


def _card(title: str, value: object) -> HoverView:
    kind = type(value).__name__
    if isinstance(value, Robot):
        return _hover_view(title, "", ", ".join(dir(value)))
    if callable(value):
        return _hover_view(title + signature_of(value), kind, "", doc_of(value))
    return _hover_view(title, kind, render(value), doc_of(value) if inspect.ismodule(value) else "")


def _hover_view(title: str, kind: str, value: str, doc: str = "") -> HoverView:
    return {"title": title, "type": kind, "value": value, "doc": doc}


def _variable_card(frame: Frame, title: str, path: Path) -> HoverView | None:
    """Return the card of a variable: its value, or its values in the instances of its machine."""
    found = _instances(frame.program, path, frame.variables)
    if not found:
        return None
    return _hover_view(title, type(frame.values[found[0]]).__name__, _text_of(found, frame.variables))


def _text_of(paths: list[Path], texts: Mapping[Path, str]) -> str:
    """Return the value of a variable or an event; if it has several, with the instance of each."""
    if len(paths) == 1:
        return texts[paths[0]]
    return "\n".join(f"{path_text(each[:-1])}: {texts[each]}" for each in paths)


def _instances(program: Program, path: Path, values: Iterable[Path]) -> list[Path]:
    """Return the paths as spawned that a variable or an event has; such a path means only itself."""
    known = [*values]
    return [path] if path in known else [each for each in known if as_defined(program, "event", each) == path]


def _computed_card(session: Session, chain: str, scope: str) -> HoverView | None:
    """Return the card of what a name means besides variables: an event, a machine, a time; else None."""
    first, dot, rest = chain.partition(".")
    here = _scope(session.program, scope)
    if first in session.namespace or first in here.visible:
        return None
    owner = here.owner("event", first)
    if owner is not None and not dot:
        path = (*_place_of(session.program, owner, scope), first)
        values = {each: str(value) for each, value in session.frame.events.items() if value is not None}
        doc = "An event: in a block, whether its condition is true at this moment."
        return _hover_view(first, "event", _text_of(_instances(session.program, path, values), values), doc)
    machines = _machines(session, first, scope)
    if machines:
        return _machine_card(session, chain, rest, machines)
    if first in TIME_TEXTS and not dot:
        return _hover_view(first, "float", _time_now(session, first, here), TIME_TEXTS[first])
    return None


def _machine_card(session: Session, title: str, member: str, machines: tuple[Scope, ...]) -> HoverView | None:
    """Return the card of a machine, its `state` or one of its variables."""
    if member and member != "state":
        paths = ((*machine.path, member) for machine in machines if member in machine.variables)
        return next(filter(None, (_variable_card(session.frame, title, path) for path in paths)), None)
    states = [place for machine in machines for place in _active_states(session, machine)]
    if member:
        doc = "The name of the active state of the machine; `None` while it does not run."
        return _hover_view(title, "str", ", ".join(repr(each[-1]) for each in states) or "None", doc)
    names = dict.fromkeys(f"`{title}.{name}`" for machine in machines for name in machine.variables)
    variables = f" Its variables: {', '.join(names)}." if names else ""
    doc = f"A machine: `{title}.state` is its active state.{variables}"
    return _hover_view(title, "machine", ", ".join(each[-1] for each in states) or "not running", doc)


def _active_states(session: Session, machine: Scope) -> list[Path]:
    """Return the active states of a machine, by their paths as spawned: one for each instance."""
    frame = session.frame
    names = resolve(frame.program)
    paths = (path[:end] for path in frame.active for end in range(2, len(path) + 1, 2))
    return [path for path in dict.fromkeys(paths) if names.defined(path[:-1]) == machine.path]


def _time_now(session: Session, name: str, machine: Scope) -> str:
    """Return the seconds since the active state of a machine was entered."""
    states = _active_states(session, machine) if name == "elapsed" else []
    if not states:
        return ""
    interpreter = session.interpreter
    entered, now = session.call(lambda: (interpreter.entered(states[0]), interpreter.now))
    return "" if entered is None else f"{now - entered:.1f} in `{states[0][-1]}`"


def _value_of(session: Session, chain: str, scope: str) -> object:
    """Return the value of a dotted name in the scope of a machine; between two ticks."""
    first, *rest = chain.split(".")
    result = _result(session, first, rest[0], scope) if rest else None
    if result is not None:
        rest = rest[1:]
        value = _variable(session, result)
    else:
        value = _root(session, first, scope)
    for name in rest:
        try:
            value = getattr(value, name)
        except Exception:
            raise _NothingError from None
    return value


def _root(session: Session, name: str, scope: str) -> object:
    path = _variable_in_scope(session.program, name, scope)
    if path is not None:
        return _variable(session, path)
    if name == "robot":
        return session.bridge.robot
    if name in session.namespace:
        return session.namespace[name]
    try:
        return builtin(name)
    except AttributeError:
        raise _NothingError from None


def _result(session: Session, machine: str, name: str, scope: str) -> Path | None:
    """Return the path of a variable that a block names as that of another machine."""
    found = _machines(session, machine, scope)
    return next(((*each.path, name) for each in found if name in each.variables), None)


def _variable(session: Session, path: Path) -> object:
    """Return the value of a variable by its path of definition, in the first instance of its machine."""
    try:
        found = _instances(session.frame.program, path, session.frame.variables)
        return session.interpreter.variables[next(iter(found), path)]
    except UnknownElementError:
        raise _NothingError from None


def _machines(session: Session, name: str, scope: str) -> tuple[Scope, ...]:
    """Return the machines that a name in a block can mean."""
    here = _scope(session.program, scope)
    return () if name in session.namespace or name in here.visible else here.machines_called(name)


def _scope(program: Program, path: str) -> Scope:
    """Return the machine with a path, as spawned or of definition; the top level if there is none."""
    names = resolve(program)
    return names.by_path.get(names.defined(as_path(path)) if path else (), names.top)


def _variable_in_scope(program: Program, name: str, scope: str) -> Path | None:
    """Return the path of a variable that is visible in a machine: as spawned, if the machine's path is."""
    owner = _scope(program, scope).visible.get(name)
    if owner is None:
        return None
    return (*_place_of(program, owner, scope), name)


def _place_of(program: Program, owner: Scope, scope: str) -> Path:
    """Return the path of a machine around a scope: as spawned, if that of the scope is."""
    names, here = resolve(program), as_path(scope) if scope else ()
    around = (here[:end] for end in range(len(here), 0, -2))
    return next((each for each in around if names.defined(each) == owner.path), owner.path)


# -- why -------------------------------------------------------------------------------------------------


def _name_of(kind: ElementKind, path: str, program: Program) -> str:
    """Return the name of an element; of a transition without one, its label."""
    if kind == "robot":
        return path
    wanted = path_of(kind, path)
    found = called(program, kind, wanted)
    return found[0].shown[-1] if found else wanted[-1]


def _moving(bridge: Bridge) -> str:
    """Return the name of the command that moves a robot."""
    methods = [
        node.path for node in bridge.nodes.members() if isinstance(node, RobotMethod) and node.velocity
    ]
    if not methods:
        raise LRPError(f"`{bridge.name}` has no command that moves it.")
    return "move" if "move" in methods else methods[0]

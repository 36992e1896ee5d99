"""Inspection of elements of the program and of values, step by step. Paper: §6.5."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from inspect import getattr_static
from itertools import islice

from lrp_jupyter.bridges.members import Member
from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.graph.state_graph import find_machine
from lrp_jupyter.interpreter.by_path import ByPath
from lrp_jupyter.interpreter.rendering import render
from lrp_jupyter.interpreter.variables import VariableMapping
from lrp_jupyter.language.lookup import as_defined, definition_of, find
from lrp_jupyter.language.program import (
    Element,
    Event,
    Machine,
    Path,
    Program,
    Span,
    Spawn,
    State,
    Transition,
    path_text,
)
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.acts.messages import OpenProgram, question
from lrp_jupyter.widgets.wire.page_places import id_of, path_of
from lrp_jupyter.widgets.wire.protocol import CountAndTick, ElementKind, Facet, InspectView, ViewState

_MOST = 100  # facets of one object
_PLAIN = (bool, int, float, complex, str, bytes, type(None))


@question("inspect")
def inspect(opened: OpenProgram, kind: ElementKind, path: str, into: list[str]) -> InspectView:
    """Inspect an element, or a part of its value (`into`: steps of earlier facets)."""
    session, where = opened.session, path_of(kind, path)
    program = session.program
    if kind == "robot":
        return _robot(session)
    if kind == "variable":
        past = None if opened.looking.tick(session) is None else opened.looking.shown(session).frame
        if past is not None:
            return session.call(lambda: _variable(past.values, past.program, where, into))
        return session.call(lambda: _variable(session.interpreter.variables, program, where, into))
    element = find(program, kind, where)
    noun = definition_of(program, element)
    if isinstance(noun, Machine):
        facets = [_facet("states", ", ".join(str(state.name) for state in noun.states))]
        facets += [_facet(str(t.kind), f"{t.source_text} -> {t.destination}") for t in noun.transitions]
        return _view(f"machine {noun.name}", program, noun.span, facets)
    if isinstance(noun, Transition):
        return _transition(opened.view_state(), program, element.path, noun)
    if isinstance(noun, State):
        return _state(opened.view_state(), program, element.path, noun, path_text(where))
    assert isinstance(noun, Event)
    return _view(f"event {noun.name}", program, noun.span, [])


def _state(now: ViewState, program: Program, path: Path, state: State, asked: str) -> InspectView:
    machine = find_machine(program, path[:-1])
    name = path_text(path)
    visits = now["entered"].get(name, (0, 0))
    if any(each["path"] == asked.rpartition("/")[0] for each in now["instances"]):
        active = any(f"{each}/".startswith(f"{asked}/") for each in now["active"])
    else:
        active = name in now["lit"]
    facets = [_facet("active", "yes" if active else "no"), _facet("entered", _times(visits))]
    for part in ("onentry", "running", "onexit"):
        facets += [_facet(part, _action(action)) for action in getattr(state, part)]
    facets += [_facet("machine", str(inner.name)) for inner in state.machines]
    facets += [
        _facet(label, f"{transition.trigger_text} -> {transition.destination}")
        for label, transition in zip(machine.labels, machine.transitions, strict=True)
        if transition.leaves(str(state.name))
    ]
    return _view(f"state {state.name}", program, state.span, facets)


def _action(action: object) -> str:
    if isinstance(action, Spawn):
        return f"(spawn {action.machine} {action.state})"
    return f"[{getattr(action, 'text', '')}]"


def _transition(now: ViewState, program: Program, path: Path, transition: Transition) -> InspectView:
    fired = now["fired"].get(id_of("transition", path), (0, 0))
    facets = [
        _facet("kind", transition.kind),
        _facet("when", transition.trigger_text),
        _facet("from", transition.source_text),
        _facet("to", str(transition.destination)),
        _facet("fired", _times(fired)),
    ]
    return _view(f"transition {transition.label}", program, transition.span, facets)


def _times(seen: CountAndTick) -> str:
    count, tick = seen
    if not count:
        return "never"
    return f"{count} {'time' if count == 1 else 'times'}, last in tick {tick}"


def _shown(member: Member) -> str:
    """Return the value of a reading, or the status of a task that was asked for."""
    if member.kind == "task":
        return str(member.value)
    return "" if member.kind == "method" else render(member.value)


def _robot(session: Session) -> InspectView:
    bridge = session.bridge
    facets = [
        _facet(
            f"robot.{member.name}{member.signature}",
            member.absence or _shown(member),
            member.unit or member.type,
        )
        for member in bridge.members()
    ]
    facets += [_facet(notice.kind, notice.text) for notice in bridge.safety.notices[-5:]]
    status = bridge.status
    return {
        "title": "robot",
        "type": f"bridge {bridge.name}, {status.state.value}",
        "text": status.sentence,
        "source": "",
        "facets": facets[:_MOST],
        "more": max(0, len(facets) - _MOST),
    }


# -- values ----------------------------------------------------------------------------------------------


def _variable(
    variables: ByPath[object] | VariableMapping, program: Program, path: Path, into: Sequence[str]
) -> InspectView:
    path = variables.path(path)
    value = variables[path]
    title = path[-1]
    for step in into:
        for known, _, inner in _inside(value):
            if known == step:
                value = inner
                title += step
                break
        else:
            raise UnknownElementError(f"`{title}` has no `{step}` any more.")
    every = list(islice(_inside(value), _MOST + 1))
    facets: list[Facet] = [
        {
            "step": step,
            "label": label,
            "type": type(inner).__name__,
            "text": render(inner),
            "deep": not isinstance(inner, _PLAIN),
        }
        for step, label, inner in every[:_MOST]
    ]
    length = len(value) if isinstance(value, (Mapping, Sequence, Set)) else len(every)
    variable = definition_of(program, Element("variable", as_defined(program, "variable", path)))
    return {
        "title": title,
        "type": type(value).__name__,
        "text": render(value),
        "source": program.text[slice(*variable.span)] if variable is not None and not into else "",
        "facets": facets,
        "more": max(0, length - len(facets)) if facets else 0,
    }


def _inside(value: object) -> Iterator[tuple[str, str, object]]:
    """Yield the parts of a value: the step to the part, its label, the part itself."""
    if isinstance(value, _PLAIN):
        return
    if isinstance(value, Mapping):
        yield from (
            (f"[{render(key)}]", render(key), inner) for key, inner in list(value.items())[: _MOST + 1]
        )
    elif isinstance(value, (list, tuple)):
        yield from ((f"[{index}]", str(index), inner) for index, inner in enumerate(value[: _MOST + 1]))
    elif isinstance(value, Set):
        yield from ((f"{{{index}}}", "", inner) for index, inner in enumerate(list(value)[: _MOST + 1]))
    for name in [*getattr(value, "__slots__", ()), *getattr(value, "__dict__", ())]:
        if isinstance(name, str) and not name.startswith("__"):
            try:
                held = getattr_static(value, name)
                yield f".{name}", name, getattr(value, name) if not isinstance(held, property) else held
            except AttributeError:  # a slot that is empty
                continue


def _facet(label: str, text: str, kind: str = "") -> Facet:
    return {"step": "", "label": label, "type": kind, "text": text, "deep": False}


def _view(title: str, program: Program, span: Span, facets: list[Facet]) -> InspectView:
    return {
        "title": title,
        "type": "",
        "text": "",
        "source": program.text[slice(*span)],
        "facets": facets[:_MOST],
        "more": max(0, len(facets) - _MOST),
    }

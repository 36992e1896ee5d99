"""Debug a fault after it has happened, with any Python debugger. Paper: §6.2.

A debugger inspects the frames of a traceback, but the frame of a block has only the variables that the block
mentions. Every frame is therefore replaced by a stand-in at the same line of the same file, whose local names
are those of the frame followed by everything in scope. It is an ordinary frame, of code executed with a
mapping as its namespace, so any debugger can inspect it.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping, MutableMapping
from types import TracebackType
from typing import Any, NamedTuple

from lrp_jupyter.interpreter.cells import Slot, content
from lrp_jupyter.interpreter.computed import ComputedName
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.interpreter.trace_events import UNSET
from lrp_jupyter.language.blocks.computed_names import name_of_cell
from lrp_jupyter.language.program import Path, Program, path_text

Assign = Callable[[str, Slot, object], object]


class Raised(NamedTuple):
    """The data kept of the last occurrence of an issue."""

    error: BaseException  # the exception, or the fault that the interpreter found
    visible: Mapping[str, Slot]  # the variables in scope, with `robot` and `print`
    state: Path  # of which a block or a transition failed, as spawned; empty outside machines


class FrameNames(MutableMapping[str, object]):
    """The names visible in a frame: its own, then the current variables, `robot`, and `state`.

    `own`: the local names of the frame that are not variables of the program. Events, machines and times
        among them are computed where they are looked up.
    `hidden`: names with another meaning in this frame.
    `assign`: assigns a value to a variable.
    """

    def __init__(
        self, own: dict[str, object], raised: Raised, hidden: Container[str], assign: Assign
    ) -> None:
        self.variables = {
            name: slot
            for name, slot in raised.visible.items()
            if not (name in own or name in hidden or name == "print")  # a debugger prints to its own output
        }
        self._own = own
        if "state" not in (own | self.variables):
            self._own = own | {"state": path_text(raised.state)}
        self._assign = assign

    def __getitem__(self, name: str) -> object:
        if name not in self.variables:
            value = self._own[name]
            return value() if isinstance(value, ComputedName) else value
        value = content(self.variables[name].cell)
        if value is UNSET:
            raise KeyError(name)
        return value

    def __setitem__(self, name: str, value: object) -> None:
        if name in self.variables:
            self._assign(name, self.variables[name], value)
        else:
            self._own[name] = value

    def __delitem__(self, name: str) -> None:
        del self._own[name]

    def __iter__(self) -> Iterator[str]:
        yield from self._own
        yield from (name for name, slot in self.variables.items() if content(slot.cell) is not UNSET)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __repr__(self) -> str:
        return repr(dict(self))


class _Place(NamedTuple):
    function: str
    filename: str
    line: int
    names: dict[str, Any]
    own: dict[str, object]


def scoped_traceback(
    program: Program, issue: Issue, raised: Raised, namespace: dict[str, Any], assign: Assign
) -> TracebackType | None:
    """Return the traceback of an issue, starting at its block, with everything in scope in each frame."""
    places = _places(program, issue, raised) or [
        _Place(str(issue.element), program.filename, issue.line, namespace, {})
    ]
    following = None
    for place in reversed(places):
        hidden = {"state"} & place.names.keys() if place.filename == program.filename else place.names
        scope = FrameNames(place.own, raised, hidden, assign)
        following = _stand_in(place, scope, following)
    return following


def _places(program: Program, issue: Issue, raised: Raised) -> list[_Place]:
    """Return the frames of a traceback, starting at the block; none if no block was running."""
    places: list[_Place] = []
    trace = raised.error.__traceback__
    while trace is not None:
        code, own = trace.tb_frame.f_code, trace.tb_frame.f_locals
        if places or code.co_filename == program.filename:
            if code.co_filename == program.filename:  # its variables are those of the program
                shared = {*code.co_freevars} & raised.visible.keys()
                own = {name_of_cell(name) or name: own[name] for name in own if name not in shared}
            line, names = trace.tb_lineno, trace.tb_frame.f_globals
            places.append(_Place(code.co_name, code.co_filename, line, names, dict(own)))
        trace = trace.tb_next
    lines = [place.line for place in places if place.filename == program.filename]
    moved = issue.line - lines[-1] if lines else 0  # lines, by edits since then
    return [
        place._replace(line=place.line + moved) if place.filename == program.filename else place
        for place in places
    ]


def _stand_in(place: _Place, scope: FrameNames, following: TracebackType | None) -> TracebackType | None:
    """Return an entry of a traceback whose frame is at a place and has a scope."""
    code = compile("\n" * (place.line - 1) + "1 / 0", place.filename, "exec")
    try:
        exec(code.replace(co_name=place.function), place.names, scope)
    except ZeroDivisionError as error:
        trace = error.__traceback__ and error.__traceback__.tb_next
        assert trace is not None
        trace.tb_next = following
        return trace
    return None

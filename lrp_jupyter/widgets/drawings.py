"""The layouts of a program's machines, kept stable from edit to edit for one session."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from threading import RLock
from time import monotonic
from typing import Any

from lrp_jupyter.graph.layout import layout
from lrp_jupyter.graph.shapes import Layout
from lrp_jupyter.graph.state_graph import events_in_scope, outer_states, start_states
from lrp_jupyter.language.program import Machine, Path, Program, path_text

__all__ = ["Drawings"]


class Drawings:
    """Lays out the machines of the running program; only what looks different is laid out anew.

    May be used from any thread. A layout once made is never changed, so views compare them by identity.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._lock = RLock()
        self._program = Program()
        self._layouts: dict[str, Layout] = {}
        self._looks: dict[str, Hashable] = {}
        self._gone: dict[str, Layout] = {}  # of machines that are not in the text at the moment

    @property
    def layouts(self) -> Mapping[str, Layout]:
        """The layouts by machine path."""
        return self._layouts

    def update(self, program: Program, renamed: tuple[Path, str] | None = None) -> dict[str, Layout]:
        """Follow the program; give the layouts that changed.

        Parameters
        ----------
        program : Program
        renamed : (path, str), optional
            A state or machine that was renamed, and its new name: what is drawn keeps its place.
        """
        with self._lock:
            if program is self._program:
                return {}
            before = {**self._gone, **self._layouts}
            looks, layouts = {}, {}
            starts = start_states(program)
            for path, machine in program.walk():
                name = path_text(path)
                if name in layouts:
                    continue
                look = looks[name] = _look(program, path, machine, starts.get(path, ()))
                old_name, states = _before(path, renamed)
                if look == self._looks.get(name) and name in self._layouts:
                    layouts[name] = self._layouts[name]
                else:
                    layouts[name] = self._draw(program, path, machine, before.get(old_name), renamed=states)
            changed = {name: new for name, new in layouts.items() if new is not self._layouts.get(name)}
            self._gone = {name: old for name, old in before.items() if name not in layouts}
            self._program, self._layouts, self._looks = program, layouts, looks
            return changed

    def pin(self, machine: str, state: str, x: float, y: float) -> None:
        """Put a node where a person dragged it; it stays there."""
        self._again(machine, moved={state: (x, y)})

    def arrange(self, machine: str) -> None:
        """Lay out a machine as if for the first time."""
        self._again(machine, anew=True)

    def _again(self, name: str, anew: bool = False, **options: Any) -> None:
        with self._lock:
            path = tuple(name.split("/"))
            machine = next((machine for where, machine in self._program.walk() if where == path), None)
            if machine is None:
                return
            previous = None if anew else self._layouts[name]
            new = self._draw(self._program, path, machine, previous, **options)
            self._layouts = {**self._layouts, name: new}

    def _draw(
        self, program: Program, path: Path, machine: Machine, previous: Layout | None, **options: Any
    ) -> Layout:
        return layout(machine, previous, program=program, path=path, now=self._clock(), **options)


def _before(path: Path, renamed: tuple[Path, str] | None) -> tuple[str, dict[str, str]]:
    """Tell what a machine was called before a rename, and which of its states were."""
    if renamed is None:
        return path_text(path), {}
    old, new = renamed
    if path == old[:-1]:  # a state of this machine
        return path_text(path), {old[-1]: new}
    if path[: len(old)] == (*old[:-1], new):  # the machine itself, or what is inside
        return path_text((*old, *path[len(old) :])), {}
    return path_text(path), {}


def _look(program: Program, path: Path, machine: Machine, starts: tuple[str, ...]) -> Hashable:
    """Everything that a layout depends on, without the blocks of states."""
    names = events_in_scope(program, path)
    return (
        tuple(
            (str(state.name), tuple(str(inner.name) for inner in state.machines)) for state in machine.states
        ),
        tuple(
            (
                transition.kind,
                transition.trigger_text,
                transition.source_text,
                str(transition.destination),
                label,
            )
            for label, transition in zip(machine.labels, machine.transitions, strict=True)
        ),
        starts,
        frozenset(t.trigger_text for t in machine.transitions if t.trigger_text in names),
        outer_states(program, path) if any(t.kind == "exit" for t in machine.transitions) else frozenset(),
    )

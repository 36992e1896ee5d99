"""The layouts of a program's machines, kept stable from edit to edit for one session."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from contextlib import contextmanager
from threading import Lock
from time import monotonic
from typing import Any

from lrp_jupyter.graph.layout import layout
from lrp_jupyter.graph.shapes import Layout
from lrp_jupyter.graph.state_graph import events_in_scope, outer_states, start_states
from lrp_jupyter.language.program import Machine, Path, Program, path_text

__all__ = ["Layouts"]


class Layouts:
    """Lays out the machines of the running program; only what looks different is laid out again.

    Only :meth:`update` computes, and may take long: call it with no lock held that others wait for. The
    other methods return at once, from any thread. A layout once made is never changed, so views compare
    them by identity.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self.current: tuple[Program, Mapping[str, Layout]] = Program(), {}
        """The program laid out last, and its layouts by machine path; replaced as a whole."""
        self._clock = clock
        self._computing = Lock()
        self._lock = Lock()  # of what is to be computed next
        self._arranged: set[str] = set()
        self._pinned: dict[str, dict[str, tuple[float, float]]] = {}
        self._renamed: tuple[Path, str] | None = None
        self._appearances: dict[str, Hashable] = {}
        self._gone: dict[str, Layout] = {}  # of machines that are not in the text at the moment

    def pin(self, machine: str, state: str, x: float, y: float) -> None:
        """Put a node where a person dragged it, with the next update; it stays there."""
        with self._lock:
            self._pinned.setdefault(machine, {})[state] = x, y

    def arrange(self, machine: str) -> None:
        """Lay out a machine as if for the first time, with the next update."""
        with self._lock:
            self._arranged.add(machine)
            self._pinned.pop(machine, None)

    @contextmanager
    def renaming(self, kind: str, path: Path, name: str) -> Iterator[None]:
        """Keep the place of a state or machine that is renamed while this is open."""
        with self._lock:
            self._renamed = (path, name) if kind in ("state", "machine") else None
        try:
            yield
        except BaseException:
            with self._lock:
                self._renamed = None
            raise

    def update(self, program: Program) -> None:
        """Compute the layouts of a program, and what was pinned or arranged since the last update."""
        with self._computing:
            before, _ = self.current
            with self._lock:
                arranged, self._arranged = self._arranged, set()
                pinned, self._pinned = self._pinned, {}
                renamed = None
                if program is not before:
                    renamed, self._renamed = self._renamed, None
            if program is not before:
                self._follow(program, renamed)
            for name in arranged:
                self._again(name, fresh=True)
            for name, places in pinned.items():
                self._again(name, moved=places)

    def _follow(self, program: Program, renamed: tuple[Path, str] | None) -> None:
        _, last = self.current
        before = {**self._gone, **last}
        appearances, layouts = {}, {}
        starts = start_states(program)
        for path, machine in program.walk():
            name = path_text(path)
            if name in layouts:
                continue
            appearance = appearances[name] = _appearance(program, path, machine, starts.get(path, ()))
            old_name, states = _before(path, renamed)
            if appearance == self._appearances.get(name) and name in last:
                layouts[name] = last[name]
            else:
                layouts[name] = self._lay_out(program, path, machine, before.get(old_name), renamed=states)
        self._gone = {name: old for name, old in before.items() if name not in layouts}
        self._appearances = appearances
        self.current = program, layouts

    def _again(self, name: str, fresh: bool = False, **options: Any) -> None:
        program, layouts = self.current
        path = tuple(name.split("/"))
        machine = next((machine for where, machine in program.walk() if where == path), None)
        if machine is not None:
            new = self._lay_out(program, path, machine, None if fresh else layouts[name], **options)
            self.current = program, {**layouts, name: new}

    def _lay_out(
        self, program: Program, path: Path, machine: Machine, previous: Layout | None, **options: Any
    ) -> Layout:
        return layout(machine, previous, program=program, path=path, now=self._clock(), **options)


def _before(path: Path, renamed: tuple[Path, str] | None) -> tuple[str, dict[str, str]]:
    """Return what a machine was called before a rename, and the new names of its states by the old ones."""
    if renamed is None:
        return path_text(path), {}
    old, new = renamed
    if path == old[:-1]:  # a state of this machine
        return path_text(path), {old[-1]: new}
    if path[: len(old)] == (*old[:-1], new):  # the machine itself, or what is inside
        return path_text((*old, *path[len(old) :])), {}
    return path_text(path), {}


def _appearance(program: Program, path: Path, machine: Machine, starts: tuple[str, ...]) -> Hashable:
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
                id_,
            )
            for id_, transition in zip(machine.ids, machine.transitions, strict=True)
        ),
        starts,
        frozenset(t.trigger_text for t in machine.transitions if t.trigger_text in names),
        outer_states(program, path) if any(t.outward for t in machine.transitions) else frozenset(),
    )

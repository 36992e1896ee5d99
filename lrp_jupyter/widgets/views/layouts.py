"""The layouts of a program's machines, kept stable from edit to edit for one session."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from threading import Lock
from time import monotonic

from lrp_jupyter.graph.geometry import Size
from lrp_jupyter.graph.layout import layout
from lrp_jupyter.graph.layout_parts import Layout
from lrp_jupyter.graph.spawned import landings, spawned_machines
from lrp_jupyter.graph.state_graph import events_in_scope, outer_states, start_states
from lrp_jupyter.language.program import Machine, Path, Program, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.successors import Successors
from lrp_jupyter.live.running.frame import Frame


class Layouts:
    """Lays out the machines of the running program again only if they would be drawn differently.

    Only :meth:`update` computes, and may take long: call it without holding a lock that others wait for. The
    other methods return at once, from any thread. A layout is never changed after its creation, so views
    compare them by identity.
    """

    def __init__(self) -> None:
        self.current: tuple[Frame, Mapping[str, Layout]] = Frame(), {}
        """The first frame of the program laid out last, and the layouts by machine path; one value."""
        self._computing = Lock()
        self._lock = Lock()  # of the input of the next computation
        self._arranged: set[str] = set()
        self._panel: Size | None = None
        self._wanted = False  # whether nested machines are to be drawn inside their states
        self._nested = False  # whether they are
        self._otherwise: dict[str, Layout] = {}  # of machines around others, as drawn the other way
        self._pinned: dict[str, dict[str, tuple[float, float]]] = {}
        self._appearances: dict[str, tuple[Hashable, Hashable]] = {}
        self._gone: dict[str, Layout] = {}  # of machines that are not in the text at the moment

    def pin(self, machine: str, state: str, x: float, y: float) -> None:
        """Pin a node to the place where it was dragged, with the next update."""
        with self._lock:
            self._pinned.setdefault(machine, {})[state] = x, y

    def arrange(self, machine: str) -> None:
        """Lay out a machine as if for the first time, with the next update."""
        with self._lock:
            self._arranged.add(machine)
            self._pinned.pop(machine, None)

    def fit(self, panel: Size) -> None:
        """Choose new places for a panel of this size, in px; for the first one lay out all machines again."""
        with self._lock:
            if self._panel is None:
                self._arranged.update(self.current[1].keys() - self._pinned.keys())
            self._panel = panel

    def nest(self, on: bool) -> None:
        """Draw nested machines inside their states or not, with the next update."""
        with self._lock:
            self._wanted = on

    def update(self, frame: Frame) -> None:
        """Compute the layouts of a frame's program, and those pinned or arranged since the last update."""
        with self._computing:
            with self._lock:
                arranged, self._arranged = self._arranged, set()
                pinned, self._pinned = self._pinned, {}
                panel, nested = self._panel, self._wanted
            shown, last = self.current
            same_program = frame.program is shown.program
            if same_program:
                if not (arranged or pinned or nested != self._nested):
                    return
                frame = shown
            program, previous = frame.program, {**self._gone, **last}
            otherwise = self._otherwise
            for revision, successors in frame.moved:
                if revision > shown.revision:
                    previous |= _carried(previous, successors)
                    otherwise |= _carried(otherwise, successors)
            if nested != self._nested:  # states of another size have their own places
                self._nested = nested
                self._otherwise = {name: old for name, old in previous.items() if _has_nested(old)}
                previous = {name: old for name, old in previous.items() if not _has_nested(old)} | otherwise
                last = {name: old for name, old in last.items() if not _has_nested(old)}
            machines: dict[Path, Machine] = {}
            for path, machine in program.walk():
                machines.setdefault(path, machine)
            appearances: dict[str, tuple[Hashable, Hashable]] = {}
            layouts: dict[str, Layout] = {}
            starts = start_states(program)
            for path, machine in reversed(machines.items()):  # inner ones first: others are drawn around them
                name = path_text(path)
                known = self._appearances.get(name, (None, None))
                inside = {inner: done for inner, done in layouts.items() if nested and _is_in(inner, name)}
                appearance = (
                    known[0] if same_program else _appearance(program, path, machine, starts.get(path, ())),
                    tuple((inner, *done["view"]) for inner, done in inside.items()),
                )
                appearances[name] = appearance
                looks_alike = name in last and appearance == known
                if looks_alike and name not in arranged and name not in pinned:
                    layouts[name] = last[name]
                else:
                    layouts[name] = layout(
                        machine,
                        None if name in arranged else previous.get(name),
                        program=program,
                        path=path,
                        moved=pinned.get(name),
                        now=monotonic(),
                        panel=panel,
                        inside=inside,
                    )
            self._gone = {name: old for name, old in previous.items() if name not in layouts}
            self._appearances = appearances
            self.current = frame, dict(reversed(layouts.items()))


def _is_in(inner: str, outer: str) -> bool:
    """Return whether a state of the machine `outer` contains the machine `inner` directly."""
    return inner.startswith(f"{outer}/") and inner.count("/") == outer.count("/") + 2


def _has_nested(drawing: Layout) -> bool:
    return any(shape["machines"] for shape in drawing["states"])


def _carried(layouts: Mapping[str, Layout], successors: Successors) -> dict[str, Layout]:
    """Return layouts by the paths that their machines have now, with the names that their states have now."""
    carried = {}
    for name, known in layouts.items():
        path = tuple(name.split("/"))
        machine = successors.path("machine", path) or path
        states = known["places"]
        names = {state: (successors.path("state", (*path, state)) or (state,))[-1] for state in states}
        # a renamed state takes precedence over the place kept for a removed state with its new name
        in_order = sorted(names.items(), key=lambda pair: pair[0] != pair[1])
        places = {now: states[before] for before, now in in_order}
        carried[path_text(machine)] = Layout(**{**known, "places": places})
    return carried


def _appearance(program: Program, path: Path, machine: Machine, starts: tuple[str, ...]) -> Hashable:
    """Return everything that a layout depends on, without the blocks of states."""
    names = events_in_scope(program, path)
    resolution = resolve(program)
    return (
        tuple(
            (str(state.name), tuple(str(inner.name) for inner in state.machines)) for state in machine.states
        ),
        tuple(
            (
                transition.kind,
                transition.trigger_text,
                transition.arrow_text,
                transition.effect,
                transition.source_text,
                str(transition.destination),
                id_,
            )
            for id_, transition in zip(machine.ids, machine.transitions, strict=True)
        ),
        starts,
        frozenset(t.trigger_text for t in machine.transitions if t.trigger_text in names),
        outer_states(program, path) if any(t.outward for t in machine.transitions) else frozenset(),
        tuple((each.state, each.machine.path, each.settings) for each in spawned_machines(resolution, path)),
        tuple(
            (each.state, each.arrow.element, each.arrow.noun.trigger_text, each.text, each.broken)
            for each in landings(resolution, path)
        ),
    )

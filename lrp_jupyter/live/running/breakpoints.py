"""Breakpoints: pause when a state is entered or left, a transition fires, or a condition becomes True.

A breakpoint belongs to the identity of an element, so it survives edits and renames; while its element is
missing it is dormant. The tick in which it is hit is completed, then the program pauses. Without breakpoints
there is no overhead.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from lrp_jupyter.errors import sentence_of
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.trace_events import TraceEvent
from lrp_jupyter.interpreter.variables import BlockTest, check_expression
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.lookup import find, places_called, where
from lrp_jupyter.language.program import Block, Path, Program, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.running.breakpoint import Breakpoint, BreakpointKind
from lrp_jupyter.live.running.frame import Hit

_KEYWORDS = {"state": "entered", "transition": "fires", "event": "event"}
"""The argument of `Session.pause_when` that takes an element, by its kind."""


Around = tuple[Path, ...]
"""The states around an instance of a machine, by path of definition."""


def noun_of(kind: BreakpointKind) -> str:
    """Return the kind of element that a kind of breakpoint has; empty for a condition."""
    return {"fired": "transition", "event": "event", "condition": ""}.get(kind, "state")


def breakpoint_of(
    program: Program,
    kind: BreakpointKind,
    wanted: str | Path,
    machine: str | Path = (),
    *,
    instance: str | Path = (),
    after: int = 1,
    once: bool = False,
) -> Breakpoint:
    """Return a new breakpoint without a number, for the wanted element or condition.

    `instance`: the instance of its machine, by path as spawned; without it the one named, or any.

    Raises UnknownElementError: there is no such element, or there are several.
    Raises SyntaxError: the condition is not an expression.
    """
    inside: tuple[Path, ...] | None
    if kind != "condition":
        noun, text = noun_of(kind), path_text(as_path(wanted))
        remedies = {each: f'Pass `{keyword}="{text}"`.' for each, keyword in _KEYWORDS.items()}
        element = find(program, noun, wanted, remedies)
        if instance:
            inside = resolve(program).around(as_path(instance))
        else:
            inside = _inside(program, as_path(wanted)[:-1], element.path[:-1])
        return Breakpoint(0, kind, element, inside=inside, after=after, once=once)
    home = find(program, "machine", machine).path if machine else ()
    inside = _inside(program, as_path(machine), home) if machine else None
    return Breakpoint(0, kind, None, check_expression(str(wanted)), home, inside, after=after, once=once)


def _inside(program: Program, wanted: Path, machine: Path) -> tuple[Path, ...] | None:
    """Return the states around the instance of a machine that is wanted by its path as spawned, if any."""
    names = resolve(program)
    found = places_called(program, machine, wanted) if wanted not in ((), machine) else []
    return names.around(found[0]) if len(found) == 1 and len(names.places(machine)) > 1 else None


class Breakpoints:
    """The breakpoints of a session. Used on the thread that ticks."""

    def __init__(self, interpreter: Interpreter) -> None:
        self._interpreter = interpreter
        self._all: dict[int, Breakpoint] = {}
        self._last = 0
        self._seen: list[TraceEvent] = []
        self._held: dict[int, frozenset[Around]] = {}  # by number of a condition: where it held last
        self._conditions: dict[int, BlockTest | None] = {}  # of this revision
        self._revision = interpreter.revision
        self._end: Callable[[], None] | None = None

    @property
    def all(self) -> tuple[Breakpoint, ...]:
        """All breakpoints, by number."""
        self._carry()
        return tuple(self._all.values())

    def add(self, new: Breakpoint) -> Breakpoint:
        """Add a breakpoint; return it with its number."""
        self._last += 1
        new = replace(new, number=self._last)
        self._carry()
        self._all[new.number] = new
        self._held[new.number] = frozenset()
        if new.kind in ("event", "condition"):
            holds, problem = self._holds(new)
            self._held[new.number] = frozenset(holds)
            if self._interpreter.tick:  # before the first tick there are no variables
                self._all[new.number] = new = replace(new, problem=problem)
        if self._end is None:
            self._end = self._interpreter.observe(self._seen.append)
        return new

    def change(self, number: int, enabled: bool | None = None, after: int | None = None) -> None:
        """Switch a breakpoint on or off, or set the first hit at which it pauses."""
        known = self._known(number)
        self._all[number] = replace(
            known,
            enabled=known.enabled if enabled is None else enabled,
            after=known.after if after is None else after,
        )

    def remove(self, number: int) -> None:
        """Remove a breakpoint."""
        self._known(number)
        del self._all[number]
        self._conditions.pop(number, None)
        if not self._all and self._end is not None:
            self._end()
            self._end = None
            self._seen.clear()

    def _known(self, number: int) -> Breakpoint:
        if number not in self._all:
            numbers = ", ".join(map(str, self._all)) or "none"
            raise ValueError(f"There is no breakpoint {number}. There are: {numbers}.")
        return self._all[number]

    def check(self) -> Hit | None:
        """Count the hits since the last call; return the first one that pauses.

        During a tick it is called while the readings of the tick are valid: conditions see the same values as
        the program.
        """
        if not self._all:
            return None
        self._carry()
        events, self._seen[:] = [*self._seen], []
        first: Hit | None = None
        for number, each in list(self._all.items()):
            times, where = self._times(each, events)
            if not times:
                continue
            each = replace(self._all[number], hits=each.hits + times)
            pauses = each.enabled and each.hits >= each.after
            if pauses and first is None:
                first = Hit(number, f"{each.what}{where}", each.hits, self._interpreter.tick)
            self._all[number] = replace(each, enabled=not (pauses and each.once) and each.enabled)
        return first

    def _times(self, each: Breakpoint, events: list[TraceEvent]) -> tuple[int, str]:
        """Return how often a breakpoint was hit, and in which instance first, where that is not clear."""
        if each.kind in ("event", "condition"):
            held = self._held[each.number]
            holds, problem = self._holds(each)
            self._held[each.number] = frozenset(holds)
            if problem != each.problem:
                self._all[each.number] = replace(self._all[each.number], problem=problem)
            hit = [path for around, path in holds.items() if around not in held]
        else:
            wanted = each.element.path if each.element is not None else ()
            names = resolve(self._interpreter.program)
            paths = [event.path for event in events if event.kind == each.kind]
            hit = [path[:-1] for path in paths if (*names.defined(path[:-1]), path[-1]) == wanted]
            hit = [path for path in hit if each.inside in (None, names.around(path))]
        if not hit or each.inside is not None:
            return len(hit), ""
        return len(hit), where(self._interpreter.program, hit[0])

    def _holds(self, each: Breakpoint) -> tuple[dict[Around, Path], str]:
        """Return the instances in which a condition holds, and why it could not be evaluated, if so."""
        if each.number not in self._conditions:
            self._conditions[each.number] = self._condition(each)
        condition = self._conditions[each.number]
        results = {} if condition is None else self._interpreter.test(condition)
        around = resolve(self._interpreter.program).around
        errors = [sentence_of(each) for each in results.values() if isinstance(each, BaseException)]
        return {around(path): path for path, value in results.items() if value is True}, "".join(errors[:1])

    def _condition(self, each: Breakpoint) -> BlockTest | None:
        """Return the condition of a breakpoint; None if its event is missing."""
        if each.element is None:
            return BlockTest(Block(each.expression), each.hangs_on, each.inside)
        machine, name = each.element.path[:-1], each.element.path[-1]
        scope = resolve(self._interpreter.program).by_path.get(machine)
        event = scope.events.get(name) if scope is not None else None
        filename = self._interpreter.program.filename
        return None if event is None else BlockTest(event.condition, each.element, each.inside, filename)

    def _carry(self) -> None:
        """Follow the elements to their new names, and determine which of them exist."""
        interpreter = self._interpreter
        if interpreter.revision == self._revision:
            return
        for revision, successors in interpreter.moved:
            if revision > self._revision:
                for number, each in self._all.items():
                    self._all[number] = each.moved(successors)
                    held = self._held[number]
                    self._held[number] = frozenset(successors.around(each) for each in held)
        self._revision = interpreter.revision
        self._conditions.clear()
        existing = set(resolve(interpreter.program).elements())
        for number, each in self._all.items():
            missing = each.hangs_on.path != () and each.hangs_on not in existing
            self._all[number] = replace(each, dormant=missing)

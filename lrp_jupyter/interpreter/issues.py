"""Faults of a running program: values that are recorded, counted, resolved and reopened.

A fault never stops the loop; the element that caused it is ignored for that tick. Paper: §6.2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any, Literal, overload

from lrp_jupyter.language.program import Element, Path, Program, path_text
from lrp_jupyter.language.successors import Successors

IssueKind = Literal[
    "exception",
    "not boolean",
    "unknown event",
    "unknown state",
    "unknown machine",
    "unknown variable",
    "not a delay",
    "already running",
    "defined twice",
    "no data yet",
    "did not return",
]

ISSUE_CODES: dict[IssueKind, str] = {
    "exception": "LRP601",
    "not boolean": "LRP602",
    "unknown event": "LRP603",
    "unknown state": "LRP604",
    "unknown machine": "LRP605",
    "unknown variable": "LRP606",
    "not a delay": "LRP607",
    "already running": "LRP608",
    "defined twice": "LRP609",
    "no data yet": "LRP610",
    "did not return": "LRP611",
}


@dataclass(frozen=True, slots=True)
class Issue:
    """One fault of the program, however often it occurs.

    Parameters
    ----------
    kind : str
        One of :data:`ISSUE_CODES`.
    element : Element
        The element at fault.
    message : str
        A sentence; names in backticks.
    line, column : int
        Location in the text, from 1.
    traceback : str
        The Python traceback, starting at the block; empty if no exception was raised.
    first_tick, last_tick : int
    count : int
        How often it occurred.
    resolved : bool
        Its element is gone, was changed, or ran again without the fault.
    instances : tuple of paths
        The instances in which it occurred, by path as spawned, the last one last; empty for a machine that
        can run in one place only.
    """

    kind: IssueKind
    element: Element
    message: str
    line: int
    column: int
    traceback: str = ""
    first_tick: int = 0
    last_tick: int = 0
    count: int = 1
    resolved: bool = False
    instances: tuple[Path, ...] = ()

    @property
    def where(self) -> str:
        """The instances, as in ``in `m/left/follow` and `k/one/follow```; empty if there are none."""
        *most, last = [f"`{path_text(path)}`" for path in self.instances] or [""]
        return f"in {', '.join(most)} and {last}" if most else last and f"in {last}"

    @property
    def code(self) -> str:
        """The stable code, ``LRP6xx``."""
        return ISSUE_CODES[self.kind]

    def __str__(self) -> str:
        notes = ", ".join(filter(None, (self.where, f"{self.count} times" if self.count > 1 else "")))
        return f"{self.line}:{self.column}: {self.code} {self.message}{notes and f' ({notes})'}"


Key = tuple[Element, int, str]  # the element, the ordinal of the block within it, and the kind


class IssueLog(Sequence[Issue]):
    """The issues of one run, each once, in order of first occurrence."""

    def __init__(self) -> None:
        self._all: dict[Key, Issue] = {}
        self.open_blocks: dict[tuple[Element, int], set[object]] = {}
        """The open blocks, each with the instances in which it fails; none if they are unknown."""
        self._last: dict[Key, tuple[str, int]] = {}  # message and line of the last occurrence, in this text
        self._raised: dict[Key, Any] = {}

    @overload
    def __getitem__(self, index: int) -> Issue: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Issue, ...]: ...
    def __getitem__(self, index: int | slice) -> Issue | tuple[Issue, ...]:
        return tuple(self._all.values())[index]

    def __len__(self) -> int:
        return len(self._all)

    def __iter__(self) -> Iterator[Issue]:
        return iter(tuple(self._all.values()))

    def __repr__(self) -> str:
        return f"IssueLog({list(self)!r})"

    def report(
        self,
        key: Key,
        make: Callable[[], Issue],
        message: str,
        tick: int,
        line: int = 0,
        raised: object = None,
        instance: object = None,
        place: Path | None = None,
    ) -> Issue | None:
        """Count a fault of an instance; return the issue if it is new, reopened or new there, otherwise None.

        The issue describes the last occurrence: it is replaced if the message, the line or the text differs.
        `raised` is kept only for the last occurrence because it holds frames.

        `place`: the path of the instance, as spawned, if its machine can run in several places.
        """
        self._raised[key] = raised
        known, last = self._all.get(key), self._last.get(key)
        self._last[key] = message, line
        self.open_blocks.setdefault(key[:2], set()).add(instance)
        is_open = known is not None and not known.resolved
        places = known.instances if known is not None and is_open else ()
        is_known = is_open and (place is None or place in places)
        if place is not None and places[-1:] != (place,):
            places = (*[each for each in places if each != place], place)
        if known is not None and is_open and last == (message, line):
            self._all[key] = issue = replace(known, last_tick=tick, count=known.count + 1, instances=places)
            return None if is_known else issue
        issue = replace(make(), instances=places)
        if known is not None:
            issue = replace(issue, first_tick=known.first_tick, count=known.count + 1)
        self._all[key] = issue
        if is_known:
            return None
        return issue

    def is_open(self, block: tuple[Element, int], instance: object) -> bool:
        """Return whether a block has an open issue, and fails in this instance as far as is known."""
        instances = self.open_blocks.get(block)
        return instances is not None and (not instances or instance in instances)

    def recovered(self, block: tuple[Element, int], instance: object) -> bool:
        """Note that an instance has run a block without a fault; return whether it fails in no other."""
        instances = self.open_blocks.get(block, set())
        instances.discard(instance)
        return not instances

    def forget(self, instance: object) -> bool:
        """Forget where an instance fails, because it is gone; return whether it failed anywhere."""
        failing = [instances for instances in self.open_blocks.values() if instance in instances]
        for instances in failing:
            instances.discard(instance)
        return bool(failing)

    def forget_instances(self) -> None:
        """Forget in which instances blocks fail: any that runs without a fault resolves an issue."""
        self.open_blocks = {block: set() for block in self.open_blocks}

    def resolve(self, which: Callable[[Key, Issue], bool]) -> None:
        """Resolve the open issues for which `which` is true."""
        for key, issue in self._all.items():
            if not issue.resolved and which(key, issue):
                self._all[key] = replace(issue, resolved=True)
        self._keep_open()

    def _keep_open(self) -> None:
        open_blocks = {key[:2] for key, issue in self._all.items() if not issue.resolved}
        self.open_blocks = {block: self.open_blocks.get(block, set()) for block in open_blocks}

    def raised(self, issue: Issue) -> Any:
        """Return the data that was `raised` at the last occurrence of an issue, or None."""
        place = attrgetter("element", "kind", "line", "column")
        found = [self._raised[key] for key, known in self._all.items() if place(known) == place(issue)]
        return found[0] if found else None

    @property
    def newest(self) -> Issue | None:
        """The most recent issue; if several are in one tick, the last in the list."""
        return max(reversed(self), key=attrgetter("last_tick", "first_tick"), default=None)

    def move(
        self, shift: Callable[[Issue], tuple[int, int]], successors: Successors, before: Program
    ) -> None:
        """Update the location and element of every issue for a new text; those of removed elements stay.

        `before`: the program before the edit.
        """
        self._last.clear()
        moved: dict[Key, Issue] = {}
        raised, self._raised = self._raised, {}
        for (old, ordinal, kind), issue in self._all.items():
            line, column = shift(issue)
            element = successors.of(old) or old
            places = tuple([successors.instance(before, path) for path in issue.instances])
            if (line, column, places) != (issue.line, issue.column, issue.instances) or element is not old:
                issue = replace(issue, line=line, column=column, element=element, instances=places)
            known = moved.get((element, ordinal, kind))
            if known is None or known.resolved:  # its element may be gone, and the name reused
                moved[element, ordinal, kind] = issue
                self._raised[element, ordinal, kind] = raised[old, ordinal, kind]
        self._all = moved
        self.open_blocks = {
            (successors.of(old) or old, ordinal): at for (old, ordinal), at in self.open_blocks.items()
        }
        self._keep_open()

    def copy(self) -> IssueLog:
        """Return an independent copy; issues are frozen."""
        log = IssueLog()
        log._all, log._last = dict(self._all), dict(self._last)
        log.open_blocks = {block: set() for block in self.open_blocks}
        log._raised = dict.fromkeys(self._all)
        return log

    def clear(self) -> None:
        """Remove all issues; faults that persist are reported again."""
        self._all.clear()
        self._last.clear()
        self._raised.clear()
        self.open_blocks.clear()

"""Coverage: how much of a program runs have reached."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.program import Element, Path, Program, path_text
from lrp_jupyter.language.resolution import resolve

REACHED = ("states", "transitions", "held", "failed")
"""The kinds of what a run reaches, in plain data; the last two are outcomes of conditions."""
_LISTED = 8  # elements in a sentence


@dataclass(frozen=True, repr=False)
class Coverage:
    """How much of a program one or more runs have reached; ``print(coverage)`` says what they have not.

    Parameters
    ----------
    program : Program
    states : mapping of path to int
        How often each state was entered, by path of definition; for several runs, in how many of them.
    transitions : mapping of path to int
        How often each transition fired, in the same way.
    conditions : mapping of path to (bool, bool)
        Whether the condition of each transition was ever true when it was tested, and whether it was ever
        false; since it was last edited. Delays are not conditions.
    """

    program: Program
    states: Mapping[Path, int]
    transitions: Mapping[Path, int]
    conditions: Mapping[Path, tuple[bool, bool]]

    @property
    def unreached(self) -> tuple[Element, ...]:
        """The states that were never entered, then the transitions that never fired."""
        missing = [Element("state", path) for path, times in self.states.items() if not times]
        return (*missing, *(self._transition(path) for path, times in self.transitions.items() if not times))

    @property
    def undecided(self) -> tuple[Element, ...]:
        """The transitions whose conditions were tested, and had only one outcome."""
        return tuple(
            self._transition(path) for path, (held, failed) in self.conditions.items() if held != failed
        )

    def _transition(self, path: Path) -> Element:
        arrow = resolve(self.program).arrow(Element("transition", path))
        return arrow.element if arrow else Element("transition", path)

    def __str__(self) -> str:
        both = sum(held and failed for held, failed in self.conditions.values())
        groups = [("states", self.states), ("transitions", self.transitions)]
        counts = [f"{sum(map(bool, each.values()))} of {len(each)} {name}" for name, each in groups if each]
        if self.conditions:
            counts.append(f"both outcomes of {both} of {len(self.conditions)} conditions")
        lines = [f"Reached: {', '.join(counts) or 'nothing'}."]
        unreached, one_way = self.unreached, self.undecided
        named: list[tuple[str, list[Element]]] = [
            ("Never entered", [each for each in unreached if each.kind == "state"]),
            ("Never fired", [each for each in unreached if each.kind == "transition"]),
            ("Never true", [each for each in one_way if not self.conditions[each.path][0]]),
            ("Never false", [each for each in one_way if self.conditions[each.path][0]]),
        ]
        lines += [f"{words}: {_listed(elements)}." for words, elements in named if elements]
        return "\n".join(lines)

    __repr__ = __str__

    def to_dict(self) -> dict[str, list[str]]:
        """Return the paths of what was reached as plain data, as `coverage_from` reads it."""
        reached = {
            "states": [path for path, times in self.states.items() if times],
            "transitions": [path for path, times in self.transitions.items() if times],
            "held": [path for path, (held, _) in self.conditions.items() if held],
            "failed": [path for path, (_, failed) in self.conditions.items() if failed],
        }
        return {kind: [*map(path_text, paths)] for kind, paths in reached.items()}


def _listed(elements: list[Element]) -> str:
    names = [f"`{path_text(each.shown)}`" for each in elements[:_LISTED]]
    more = len(elements) - len(names)
    return ", ".join(names) + (f" and {more} more" if more else "")


def coverage_of(interpreter: Interpreter) -> Coverage:
    """Return what the present run has reached of the program that runs."""
    return _coverage(
        interpreter.program,
        {path: count.times for path, count in interpreter.visits.items()},
        {path: count.times for path, count in interpreter.firings.items()},
        interpreter.outcomes,
    )


def coverage_from(program: Program, runs: Sequence[Mapping[str, Iterable[str]]]) -> Coverage:
    """Return what runs of a program have reached together, from the plain data of each."""
    states, transitions, held, failed = (
        Counter(as_path(text) for run in runs for text in run[kind]) for kind in REACHED
    )
    conditions = {path: (path in held, path in failed) for path in held | failed}
    return _coverage(program, states, transitions, conditions)


def _coverage(
    program: Program,
    states: Mapping[Path, int],
    transitions: Mapping[Path, int],
    conditions: Mapping[Path, tuple[bool, bool]],
) -> Coverage:
    elements = [*resolve(program).elements()]
    arrows = [arrow for each in resolve(program).arrows.values() for arrow in each]
    return Coverage(
        program,
        {path: states.get(path, 0) for kind, path in elements if kind == "state"},
        {arrow.element.path: transitions.get(arrow.element.path, 0) for arrow in arrows},
        {
            arrow.element.path: conditions.get(arrow.element.path, (False, False))
            for arrow in arrows
            if arrow.noun.trigger.keyword == "on"
        },
    )

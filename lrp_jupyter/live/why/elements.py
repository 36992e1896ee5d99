"""Elements in the text of a program: the lines in which they begin, and the elements that lead to them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from lrp_jupyter.language.lookup import line_of_element
from lrp_jupyter.language.program import Block, Element, Path, Program, Spawn, State, Transition
from lrp_jupyter.language.resolution import Arrow, Spawning, resolve


def line_of(program: Program, part: Block | Spawn | State | Transition | None) -> int:
    """Return the line in which a part of a program begins, from 1; 0 for None."""
    return program.place(part.span.start)[0] if part is not None else 0


def line_of_state(program: Program, path: Path) -> int:
    """Return the line of a state by its path of definition; 0 if the program does not have it."""
    return line_of_element(program, Element("state", path))


def spawns_of(program: Program, machine: Path) -> list[Spawning]:
    """Return every spawn of a machine, by its path of definition."""
    spawns = resolve(program).spawns
    return [each for each in spawns if each.machine is not None and each.machine.path == machine]


def arrows_to(program: Program, state: Path) -> Iterator[Arrow]:
    """Yield the transitions that lead to a state, by path of definition, each ``exit`` included."""
    names = resolve(program)
    scope = names.by_path.get(state[:-1])
    for arrow in chain.from_iterable(names.arrows.values()):
        if arrow.noun.destination == state[-1] and scope in arrow.homes:
            yield arrow

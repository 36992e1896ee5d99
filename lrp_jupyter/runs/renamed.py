"""Which states and machines of a recorded program have other names in the present one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeVar

from lrp_jupyter.language.program import Machine, Path, Program, State

Names = Mapping[tuple[str, str], str]
"""By the machine (empty: of a machine itself) and the recorded name, the present one."""
_Part = TypeVar("_Part", Machine, State)


def renamed(old: Program, new: Program) -> Names:
    """Return the names that have changed: one that is gone, where as many are defined and another is new."""
    return {where: name for where, name in _machines(old.machines, new.machines) if where[1] != name}


def path_now(path: Path, names: Names) -> Path:
    """Return the present path, as spawned, of a recorded state or machine."""
    now = [names.get(("", name), name) for name in path]
    for place in range(1, len(path), 2):
        now[place] = names.get((path[place - 1], path[place]), path[place])
    return tuple(now)


def _machines(old: Sequence[Machine], new: Sequence[Machine]) -> Iterator[tuple[tuple[str, str], str]]:
    for machine, present in _pairs(old, new):
        yield ("", str(machine.name)), str(present.name)
        for state, now in _pairs(machine.states, present.states):
            yield (str(machine.name), str(state.name)), str(now.name)
            yield from _machines(state.machines, now.machines)


def _pairs(old: Sequence[_Part], new: Sequence[_Part]) -> Iterator[tuple[_Part, _Part]]:
    """Pair those of one name; of those that are left, if there are as many, those in the same place."""
    before, after = ({str(each.name): each for each in several} for several in (old, new))
    yield from ((part, after[name]) for name, part in before.items() if name in after)
    gone = [part for name, part in before.items() if name not in after]
    added = [part for name, part in after.items() if name not in before]
    if len(gone) == len(added) and len(old) == len(new):
        yield from zip(gone, added, strict=True)

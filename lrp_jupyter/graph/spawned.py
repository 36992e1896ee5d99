"""What the states of a machine spawn, and the transitions that land in it from there.

A state may spawn machines that are defined elsewhere than in it. An ``exit`` leaves the machine in which it
stands and enters a state of the one that has spawned it: there it is an arrow from the spawning state to its
destination, as UML draws a transition that leaves a composite state.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from lrp_jupyter.graph.labels import arrow_text, settings_text
from lrp_jupyter.graph.state_graph import why_dangling
from lrp_jupyter.language.program import Path, Spawn
from lrp_jupyter.language.resolution import Arrow, Resolution, Scope


class SpawnedMachine(NamedTuple):
    """A machine that a state spawns, and where it is defined."""

    state: str
    machine: Scope
    elsewhere: bool  # than in the state
    settings: str  # the values that it gives to variables: ``side 1, keep 0.25``

    @property
    def text(self) -> str:
        """The machine's name, and the settings."""
        return f"{self.machine.path[-1]} {self.settings}".rstrip()


class Landing(NamedTuple):
    """An ``exit`` of a machine, from a state that spawns the machine."""

    state: str
    arrow: Arrow
    inside: str  # the state that it leaves, as a part of its arrow's text
    broken: str | None  # why it can never fire from there

    @property
    def text(self) -> str:
        """The text of its arrow."""
        return f"{arrow_text(self.arrow.noun)} {self.inside}"


def spawned_machines(names: Resolution, path: Path) -> Iterator[SpawnedMachine]:
    """Yield the machines that the states of a machine spawn, each once for each state."""
    scope = names.by_path.get(path, names.top)
    for name, state in scope.states.items():
        seen: set[Path] = set()
        for item in state.onentry:
            if not isinstance(item, Spawn):
                continue
            machine = scope.machine(name, item.machine)
            if machine is not None and machine.path not in seen:
                seen.add(machine.path)
                yield SpawnedMachine(name, machine, machine.path[:-1] != (*path, name), settings_text(item))


def landings(names: Resolution, path: Path) -> Iterator[Landing]:
    """Yield the transitions that leave what the states of a machine spawn, and enter a state of it."""
    home = names.by_path.get(path, names.top)
    for each in spawned_machines(names, path):
        for arrow in names.arrows[each.machine]:
            noun = arrow.noun
            if noun.outward:
                broken = why_dangling(
                    noun,
                    source_exists=all(name in each.machine.states for name in noun.sources),
                    target_exists=noun.destination in home.states,
                    events=each.machine.visible_events,
                )
                yield Landing(each.state, arrow, f"(from {noun.source_text})", broken)

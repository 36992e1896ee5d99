"""The machines and states of a program as an indented text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from lrp_jupyter.graph.state_graph import distinct_states
from lrp_jupyter.language.program import Machine, Path, Program

__all__ = ["tree"]


def tree(subject: Program | Machine, active: Iterable[Sequence[str]] = ()) -> str:
    """Write the machines, their states and what is nested in them, one per line.

    Parameters
    ----------
    subject : Program or Machine
    active : iterable of path
        Paths of the innermost active states; they and what encloses them are marked ``●``.
    """
    machines = (subject,) if isinstance(subject, Machine) else subject.machines
    on = {tuple(path[:end]) for path in active for end in range(1, len(path) + 1)}
    lines = [line for machine in machines for line in _machine((), machine, "", "", on)]
    return "\n".join(lines) or "(no machine)"


def _machine(outer: Path, machine: Machine, first: str, rest: str, on: set[Path]) -> Iterator[str]:
    path = (*outer, str(machine.name))
    yield f"{first}machine {machine.name}" + (" ●" if path in on else "")
    states = list(distinct_states(machine).values())
    for state in states:
        last = state is states[-1]
        here = (*path, str(state.name))
        yield f"{rest}{'└─ ' if last else '├─ '}{state.name}" + (" ●" if here in on else "")
        deeper = rest + ("   " if last else "│  ")
        for inner in state.machines:
            end = inner is state.machines[-1]
            yield from _machine(
                here, inner, deeper + ("└─ " if end else "├─ "), deeper + ("   " if end else "│  "), on
            )

"""What an editor is told about a moment of a run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypedDict

from lrp_jupyter.language.lookup import as_defined
from lrp_jupyter.language.program import Path, Program, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.running.frame import Frame

Places = dict[str, str]
"""A text for each place where a machine runs: the path of the machine as it is spawned."""


class LiveNews(TypedDict):
    """What an editor is told, by paths of definition."""

    status: str
    states: dict[str, Places]
    variables: dict[str, Places]
    events: dict[str, Places]


def news_of(frame: Frame) -> LiveNews:
    """Return what is told about a moment of a run; of the events, those that are tested now."""
    program = frame.program
    states = [*dict.fromkeys(path[:end] for path in frame.active for end in range(2, len(path) + 1, 2))]
    tested = {*_tested(program, states)}
    events = {path: str(value) for path, value in frame.events.items() if value is not None}
    found = _table(program, "event", events.items())
    return {
        "status": frame.status,
        "states": _table(program, "state", ((path, "active") for path in states)),
        "variables": _table(program, "variable", frame.variables.items()),
        "events": {path: values for path, values in found.items() if path in tested},
    }


def _table(program: Program, kind: str, texts: Iterable[tuple[Path, str]]) -> dict[str, Places]:
    table: dict[str, Places] = {}
    for path, text in texts:
        defined = path_text(as_defined(program, kind, path))
        table.setdefault(defined, {})[path_text(path[:-1])] = text
    return table


def _tested(program: Program, states: Iterable[Path]) -> Iterator[str]:
    """Yield the events for which a transition out of an active state waits."""
    names = resolve(program)
    for path in states:
        scope = names.by_path.get(names.defined(path[:-1]))
        for arrow in names.arrows[scope] if scope is not None else ():
            reference = arrow.noun.trigger.reference
            if arrow.owner is not None and reference is not None and arrow.noun.leaves(path[-1]):
                yield path_text(arrow.owner.path_of(*reference))

"""What an editor is told about a moment of a run."""

from __future__ import annotations

from typing import TypedDict

from lrp_jupyter.language.lookup import as_defined
from lrp_jupyter.language.program import path_text
from lrp_jupyter.live.running.frame import Frame


class LiveNews(TypedDict):
    """What an editor is told, by paths of definition; a value for each place where a machine runs.

    Each place is the path of the machine as it is spawned.
    """

    status: str
    states: dict[str, list[str]]
    variables: dict[str, dict[str, str]]
    events: dict[str, dict[str, str]]


def news_of(frame: Frame) -> LiveNews:
    """Return what is told about a moment of a run."""
    program = frame.program
    states: dict[str, dict[str, None]] = {}
    for path in frame.active:
        for end in range(2, len(path) + 1, 2):
            defined = path_text(as_defined(program, "state", path[:end]))
            states.setdefault(defined, {})[path_text(path[: end - 1])] = None
    tables: tuple[dict[str, dict[str, str]], ...] = ({}, {})
    values = {path: str(value) for path, value in frame.events.items() if value is not None}
    for kind, table, found in zip(("variable", "event"), tables, (frame.variables, values), strict=True):
        for path, text in found.items():
            defined = path_text(as_defined(program, kind, path))
            table.setdefault(defined, {})[path_text(path[:-1])] = text
    variables, events = tables
    named = {path: [*places] for path, places in states.items()}
    return {"status": frame.status, "states": named, "variables": variables, "events": events}

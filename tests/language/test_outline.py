"""The elements of programs, for the page's own parser, too: `outlines.json` is what both are tested with.

``UPDATE=1`` writes it, with other programs.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, settings
from programs import programs

from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Program, path_text

FILE = Path(__file__).with_name("outlines.json")
LONGEST = 700


def elements(program: Program) -> Iterator[str]:
    """Yield each element as its kind, its path as the page writes it, and the label of a transition."""
    for kind, nouns in (("variable", program.variables), ("event", program.events)):
        yield from (f"{kind} {noun.name}" for noun in nouns)
    for path, machine in program.walk():
        where = path_text(path)
        yield f"machine {where}"
        parts = (("variable", machine.variables), ("event", machine.events), ("state", machine.states))
        for kind, nouns in parts:
            yield from (f"{kind} {where}/{noun.name}" for noun in nouns)
        for id_, label in zip(machine.ids, machine.labels, strict=True):
            yield f"transition {where}:{id_} {label}"


def outline(text: str) -> list[str]:
    return sorted(set(elements(parse(text))))


def update() -> None:
    found: dict[str, list[str]] = {}

    @settings(
        max_examples=400,
        derandomize=True,
        phases=[Phase.generate],
        suppress_health_check=[*HealthCheck],
        database=None,
    )
    @given(programs)
    def collect(program: Program) -> None:
        text = to_source(program)
        names = outline(text)
        if len(text) < LONGEST and any(name.startswith("transition") for name in names):
            found[text] = names

    collect()
    lines = [json.dumps({"text": text, "elements": names}) for text, names in found.items()]
    FILE.write_text("[\n" + ",\n".join(lines) + "\n]\n", "utf-8")


def test_the_recorded_elements_are_those_of_the_parser() -> None:
    if os.environ.get("UPDATE"):
        update()
    recorded = json.loads(FILE.read_text("utf-8"))
    assert len(recorded) > 20
    for each in recorded:
        assert outline(each["text"]) == each["elements"]

"""Programs whose spawns give values to variables."""

from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from lrp_jupyter.language.program import Block, Name, Program, Spawn, Variable


@dataclass(frozen=True)
class SpawnWithSettings(Spawn):
    settings: tuple[Variable, ...] = ()


def with_settings(program: Program, machine: str, **values: str) -> Program:
    """Return the program; those who spawn a machine give these values to its variables."""
    settings = tuple(Variable(Name(name), Block(value)) for name, value in values.items())

    def changed(item: Any) -> Any:
        if isinstance(item, Spawn) and item.machine == machine:
            return SpawnWithSettings(item.machine, item.state, item.span, settings)
        if isinstance(item, Block) or not is_dataclass(item):
            return tuple(map(changed, item)) if type(item) is tuple else item
        parts = {each.name: changed(getattr(item, each.name)) for each in fields(item) if each.init}
        return replace(item, **parts)

    return changed(program)

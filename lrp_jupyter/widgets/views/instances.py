"""The machines that run, as views list them: a machine that several states spawn may run once in each."""

from __future__ import annotations

from collections.abc import Iterable

from lrp_jupyter.language.program import Path, Program, Variable, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.widgets.wire.protocol import InstanceView


class Instances:
    """Describes the instances of the machines of one program."""

    def __init__(self, program: Program) -> None:
        self._names = resolve(program)
        self._known: dict[Path, InstanceView] = {}

    def of(self, active: Iterable[Path]) -> list[InstanceView]:
        """Return the machines that run, by their innermost active states, outer before inner."""
        running = (path[:end] for path in active for end in range(1, len(path), 2))
        return [self._view(path) for path in dict.fromkeys(running)]

    def _view(self, path: Path) -> InstanceView:
        found = self._known.get(path)
        if found is None:
            machine = self._names.defined(path)
            found = self._known[path] = {
                "path": path_text(path),
                "machine": path_text(machine),
                "settings": ", ".join(map(_setting, self._settings(path, machine))),
            }
        return found

    def _settings(self, path: Path, machine: Path) -> Iterable[Variable]:
        spawner = (*self._names.defined(path[:-2]), path[-2]) if len(path) > 2 else ()
        spawns = (each for each in self._names.spawns if each.machine and each.machine.path == machine)
        spawn = next((each for each in spawns if each.spawner == spawner), None)
        return () if spawn is None else spawn.settings.values()


def _setting(setting: Variable) -> str:
    """Return a setting in a line: ``keep 0.25``."""
    first, *more = setting.initial.text.strip().splitlines() or [""]
    sign = "\N{MINUS SIGN}" if first.startswith("-") else first[:1]
    return f"{setting.name} {sign}{first[1:].rstrip()}{' …' if more else ''}"

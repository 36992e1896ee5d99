"""Completion of values in a shell; `lrp --install-completion` installs it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from lrp_jupyter import programs
from lrp_jupyter.codes import CODES

if TYPE_CHECKING:
    from lrp_jupyter.language.program import Program


def bundled(incomplete: str) -> list[str]:
    """Complete the name of a bundled program."""
    return _beginning(incomplete, programs.names())


def sources(incomplete: str) -> list[str]:
    """Complete the name of a bundled program or a file of a program."""
    return [*bundled(incomplete), *_files(incomplete, ".lrp")]


def worlds(incomplete: str) -> list[str]:
    """Complete the name of a bundled world or a file of a world."""
    from lrp_jupyter.sim.worlds import BUNDLED

    return [*_beginning(incomplete, BUNDLED), *_files(incomplete, ".json")]


def bridges(incomplete: str) -> list[str]:
    """Complete the name of a bridge."""
    from lrp_jupyter.bridges.discovery import find_bridges

    return _beginning(incomplete, find_bridges())


def backends(incomplete: str) -> list[str]:
    """Complete the name of a way to a robot that is to be guarded."""
    from lrp_jupyter.cli.guard_command import BACKENDS

    return _beginning(incomplete, BACKENDS)


def noises(incomplete: str) -> list[str]:
    """Complete the name of an imperfection of the simulated robot, up to the ``=``."""
    from dataclasses import fields

    from lrp_jupyter.sim.world import Noise

    return _beginning(incomplete, [f"{field.name}=" for field in fields(Noise)])


def speeds(incomplete: str) -> list[str]:
    """Complete the speed that is a word."""
    return _beginning(incomplete, ["max"])


def challenges(incomplete: str) -> list[str]:
    """Complete the name of a challenge; that of one of a series when it has been begun."""
    from lrp_jupyter.grading.challenges import challenges as known

    return _beginning(incomplete, [each.name for each in known() if incomplete or not each.series])


def codes(incomplete: str) -> list[str]:
    """Complete a code of a finding, a reason, a notice or an exit."""
    return _beginning(incomplete, CODES)


def states(context: typer.Context, incomplete: str) -> list[str]:
    """Complete the name of a state of the program named before."""
    program = _program(context)
    return _beginning(
        incomplete, {str(state.name) for _, machine in program.walk() for state in machine.states}
    )


def transitions(context: typer.Context, incomplete: str) -> list[str]:
    """Complete the name of a transition of the program named before, up to the ``@``."""
    machines = [machine for _, machine in _program(context).walk()]
    return _beginning(incomplete, {f"{name}@" for machine in machines for name in machine.labels})


def machines(context: typer.Context, incomplete: str) -> list[str]:
    """Complete the path of a machine of the program named before."""
    return _beginning(incomplete, ["/".join(path) for path, _ in _program(context).walk()])


def variables(context: typer.Context, incomplete: str) -> list[str]:
    """Complete the name of a variable of the program named before, up to the ``=``."""
    program = _program(context)
    every = [*program.variables, *(each for _, machine in program.walk() for each in machine.variables)]
    return _beginning(incomplete, {f"{each.name}=" for each in every})


def _program(context: Any) -> Program:
    """Return the program of the argument FILE; an empty one if there is none."""
    from lrp_jupyter.cli.program_source import read_source
    from lrp_jupyter.errors import LRPError
    from lrp_jupyter.language.parser import scan
    from lrp_jupyter.language.program import Program

    name = context.params.get("file") or next(iter(context.args), None)
    try:
        program, _ = scan(read_source(name).text) if name and name != "-" else (None, ())
    except LRPError:
        program = None
    return program or Program()


def _beginning(incomplete: str, words: Iterable[str]) -> list[str]:
    return sorted(word for word in words if word.startswith(incomplete))


def _files(incomplete: str, suffix: str) -> list[str]:
    """Return the files of a suffix, and the folders, whose path begins so."""
    folder, slash, begun = incomplete.rpartition("/")
    try:
        found = sorted((Path(folder or slash or ".")).iterdir())
    except OSError:
        return []
    return [
        f"{folder}{slash}{path.name}{'/' if path.is_dir() else ''}"
        for path in found
        if path.name.startswith(begun) and (path.suffix == suffix or path.is_dir())
    ]

"""The transition or state that a question names."""

from __future__ import annotations

from collections.abc import Iterable

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.language.names import as_path
from lrp_jupyter.language.program import Element, Path, Program, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.unknown import unknown


def _transitions_in(program: Program) -> list[Element]:
    """Return all transitions of a program."""
    return [element for element in resolve(program).elements() if element.kind == "transition"]


def find_transition(wanted: str | Path, programs: Iterable[Program]) -> tuple[Element, Program] | None:
    """Return the transition of a name, label, id or path, and the first program that has it; or None.

    Raises UnknownElementError: there are several.
    """
    for program in programs:
        found = [each for each in _transitions_in(program) if _is_called(each, wanted)]
        if len(found) == 1:
            return found[0], program
        if found:
            paths = [path_text(each.path) for each in found]
            raise UnknownElementError.ambiguous("transitions", str(wanted), paths)
    return None


def the_transition(wanted: str | Path, program: Program) -> Element:
    """Return the transition of a name, label, id or path.

    Raises UnknownElementError: there is none, or there are several.
    """
    found = find_transition(wanted, [program])
    if found is None:
        raise unknown("transition", ["transition"], wanted, [program])
    return found[0]


def _is_called(transition: Element, wanted: str | Path) -> bool:
    """Return whether a transition has a name, label, id or path."""
    path, shown = transition.path, transition.shown
    texts = {path[-1], shown[-1], path_text(path), path_text(shown), f"{path_text(path[:-1])}:{path[-1]}"}
    return as_path(wanted) == path or (isinstance(wanted, str) and wanted in texts)


def _states_in(program: Program) -> list[Path]:
    """Return the paths of definition of all states of a program."""
    return list(
        dict.fromkeys(
            (*path, str(state.name)) for path, machine in program.walk() for state in machine.states
        )
    )


def find_state(wanted: str | Path, programs: Iterable[Program]) -> tuple[Path, Program] | None:
    """Return the path of definition of a state, and the first program that has it; None if there is none.

    A name or a path is wanted; also a path as spawned.

    Raises UnknownElementError: there are several.
    """
    path = as_path(wanted)
    for program in programs:
        known = _states_in(program)
        found = [each for each in known if each == path or each[-1:] == path]
        if len(path) > 1 and not found:
            defined = (*resolve(program).defined(path[:-1]), path[-1])
            found = [each for each in known if each == defined]
        if len(found) == 1:
            return found[0], program
        if found:
            raise UnknownElementError.ambiguous("states", path_text(path), map(path_text, found))
    return None

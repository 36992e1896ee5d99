"""Look-up of a program's elements by the names that people use: every command accepts the same spellings.

An element is called by its name; by its path, as a text or a tuple, as it is defined or as it is spawned; a
transition also by its label or its id, alone or in a path, and as pages write it: ``m:late``. A whole path of
definition means that element only; any other spelling means every element that has it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.program import Element, Path, Program, Transition, path_text
from lrp_jupyter.language.reading.forms import article
from lrp_jupyter.language.resolution import Definition, resolve

_KINDS = ("transition", "state", "event", "variable", "machine")
_MOST = 8  # names that are listed


def called(program: Program, kind: str, wanted: str | Path) -> list[Element]:
    """Return the elements of a kind that can be meant."""
    path = as_path(wanted)
    known = [each for each in resolve(program).elements() if each.kind == kind]
    texts = {path_text(path)}
    if is_spawned(program, path):
        texts.add(path_text(as_defined(program, kind, path)))
    if isinstance(wanted, str):
        texts.add(wanted)
    exact = [each for each in known if each.path == path]
    return exact or [each for each in known if not texts.isdisjoint(_spellings(each))]


def _spellings(element: Element) -> Iterator[str]:
    for path in (element.path, element.shown):
        yield path[-1]
        yield path_text(path)
    if element.kind == "transition":
        yield f"{path_text(element.path[:-1])}:{element.path[-1]}"


def is_spawned(program: Program, path: Path) -> bool:
    """Return whether each state on a path contains or spawns the machine after it."""
    names = resolve(program)
    for end in range(3, len(path) + 1, 2):
        spawner, machine = (*names.defined(path[: end - 2]), path[end - 2]), names.defined(path[:end])
        spawned = (each.machine for each in names.spawns if each.spawner == spawner)
        if machine[:-1] != spawner and not any(each and each.path == machine for each in spawned):
            return False
    return True


def as_defined(program: Program, kind: str, path: Path) -> Path:
    """Return the path of definition of an element whose path is as spawned; any other path unchanged."""
    end = len(path) if kind == "machine" else len(path) - 1
    is_machine = end % 2  # names of machines and states alternate
    return (*resolve(program).defined(path[:end]), *path[end:]) if is_machine else path


def places_called(program: Program, machine: Path, wanted: Path, running: Sequence[Path] = ()) -> list[Path]:
    """Return the places of a machine that can be meant, by paths as spawned; none if it runs nowhere.

    A path as spawned, or the end of one, means that place. The path of definition and a bare name mean the
    place that has the same path, else each instance that runs, or each that can.

    `wanted`: the path of the machine as it is written; empty if only an element in it is named.
    `running`: the instances that run.
    """
    names = resolve(program)
    possible = names.places(machine) if machine in names.by_path else ()
    if wanted not in ((), machine):
        every = [*dict.fromkeys([*running, *possible])]
        found = [wanted] if wanted in every else [place for place in every if place[-len(wanted) :] == wanted]
        if found:
            return [place for place in found if place in running] or found
    found = list(running or possible)
    return [machine] if machine in found else found


def where(program: Program, machine: Path) -> str:
    """Say in which instance something happened, by path as spawned: a space and ``in `m/left/follow```.

    Nothing is said if the machine can run in one place only.
    """
    names = resolve(program)
    return f" in `{path_text(machine)}`" if names.is_shared(names.defined(machine)) else ""


def means(program: Program, wanted: str | Path, state: Path) -> bool:
    """Return whether a state, by its path as defined or as spawned, can be meant."""
    path = as_path(wanted)
    if len(path) == 1:
        return state[-1:] == path
    if state[-1] != path[-1]:
        return False
    wanted = as_defined(program, "state", path) if is_spawned(program, path) else path
    return as_defined(program, "state", state) == wanted


def find(
    program: Program,
    kinds: str | Sequence[str],
    wanted: str | Path,
    remedies: Mapping[str, str] | None = None,
) -> Element:
    """Return the element that is meant, as :func:`find_first` of one program."""
    return find_first([program], kinds, wanted, remedies)[0]


def find_first(
    programs: Sequence[Program],
    kinds: str | Sequence[str],
    wanted: str | Path,
    remedies: Mapping[str, str] | None = None,
    others: Iterable[str] = (),
) -> tuple[Element, Program]:
    """Return the element that is meant, and the first program that has it.

    `kinds`: what it can be; an earlier kind is preferred. Messages also mention those that no program has,
        such as ``command``.
    `remedies`: for each other kind that the element may be of, a sentence that says what to do.
    `others`: the names of elements of those kinds.
    Raises UnknownElementError: there is none, or there are several.
    """
    kinds = (kinds,) if isinstance(kinds, str) else kinds
    for program in programs:
        for kind in kinds:
            found = called(program, kind, wanted)
            if len(found) == 1:
                return found[0], program
            if found:
                paths = [path_text(each.path) for each in found]
                raise UnknownElementError.ambiguous(f"{kind}s", path_text(as_path(wanted)), paths)
    raise missing(programs, kinds, wanted, remedies, others)


def missing(
    programs: Sequence[Program],
    kinds: Sequence[str],
    wanted: str | Path,
    remedies: Mapping[str, str] | None = None,
    others: Iterable[str] = (),
) -> UnknownElementError:
    """Return the error for an unknown element: it says what the name is instead, or which names exist."""
    text = path_text(as_path(wanted))
    noun = " or ".join(filter(None, (", ".join(kinds[:-1]), kinds[-1])))
    elements = [each for program in programs for each in resolve(program).elements()]
    known = [each.shown for kind in kinds for each in elements if each.kind == kind]
    names = list(dict.fromkeys([*(path[-1] for path in known), *others]))
    for kind in _KINDS:
        if any(called(program, kind, wanted) for program in programs):
            remedy = (remedies or {}).get(kind) or _listed(noun, names)
            problem = f"`{text}` is {article(kind)} {kind}, not {article(noun)} {noun}"
            return UnknownElementError(f"{problem}. {remedy}")
    spellings = [*names, *map(path_text, known)]
    return UnknownElementError.missing(f"There is no {noun} `{text}`.", text, spellings, _listed(noun, names))


def _listed(noun: str, names: list[str]) -> str:
    """Return a sentence that lists the existing names."""
    if not names:
        return f"The program has no {noun}."
    if len(names) == 1:
        return f"There is only `{names[0]}`."
    more = ", …" if len(names) > _MOST else ""
    return f"There are: {', '.join(f'`{name}`' for name in names[:_MOST])}{more}."


def definition_of(program: Program, element: Element) -> Definition | Transition | None:
    """Return what defines an element; None if the program does not have it."""
    names, kind, path = resolve(program), element.kind, element.path
    if kind == "transition":
        arrow = names.arrow(element)
        return None if arrow is None else arrow.noun
    scope = names.by_path.get(path if kind == "machine" else path[:-1])
    if scope is None or kind == "machine":
        return None if scope is None else scope.noun
    tables: dict[str, Mapping[str, Definition]] = {
        "state": scope.states,
        "event": scope.events,
        "variable": scope.variables,
    }
    return tables[kind].get(path[-1])


def line_of_element(program: Program, element: Element) -> int:
    """Return the line in which an element begins, from 1; 0 if the program does not have it."""
    found = definition_of(program, element)
    return 0 if found is None else program.place(found.span.start)[0]

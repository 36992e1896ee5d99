"""Variables by path: as a tuple or as text, or by a bare name if it is unambiguous."""

from __future__ import annotations

from collections.abc import Collection, ItemsView, Iterator, Mapping
from typing import Any, TypeVar

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.lookup import as_defined
from lrp_jupyter.language.program import Path, Program, path_text

V = TypeVar("V", covariant=True)


class ByPath(Mapping[Path, V]):
    """A frozen mapping with the paths of variables as keys.

    A key is a path, as a tuple (``("follower", "nobump")``) or as text (``"follower/nobump"``), or a bare
    name (``"nobump"``) if only one path ends with it. Iteration yields tuples.

    `items`: the values by path as spawned.
    `program`: the program of the variables; with it, a key may also be a path of definition.
    Raises UnknownElementError: a key names none of the paths, or several.
    """

    __slots__ = ("_items", "_program")

    def __init__(self, items: Mapping[Path, V] | None = None, program: Program | None = None) -> None:
        self._items: Mapping[Path, V] = {} if items is None else items
        self._program = program

    def __getitem__(self, key: Path | str) -> V:
        if isinstance(key, tuple) and key in self._items:
            return self._items[key]
        return self._items[self.path(key)]

    def path(self, key: Path | str) -> Path:
        """Return the path of a key."""
        return full_path(key, self._items, self._program)

    def __contains__(self, key: object) -> bool:
        return key in self._items or bool(
            isinstance(key, (str, tuple)) and _matching(as_path(key), self._items, self._program)
        )

    def get(self, key: Path | str, default: Any = None) -> Any:
        """Return the value of a key, or the default if there is none; an ambiguous name raises."""
        known = _matching(as_path(key), self._items, self._program)
        return self[key] if known else default

    def items(self) -> ItemsView[Path, V]:
        """Return all paths and their values."""
        return self._items.items()

    def __iter__(self) -> Iterator[Path]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def _ipython_key_completions_(self) -> list[str]:
        """Return the keys that completion in a notebook offers after ``[``."""
        return [path_text(path) for path in self._items]

    def __repr__(self) -> str:
        return repr({path_text(path): value for path, value in self._items.items()})


def full_path(wanted: Path | str, known: Collection[Path], program: Program | None = None) -> Path:
    """Return the path of a variable as spawned, for its path or its unambiguous name.

    Raises UnknownElementError: there is no such variable now, or several have that name.
    """
    path = as_path(wanted)
    found = _matching(path, known, program)
    if len(found) == 1:
        return found[0]
    if found:
        raise UnknownElementError.ambiguous("variables", path[0], map(path_text, found))
    names = dict.fromkeys(name for other in known for name in (path_text(other), other[-1]))
    raise UnknownElementError.missing(
        f"There is no variable `{path_text(path)}` now. Variables exist while their machine runs, global "
        "ones from the first tick after a start or restart.",
        path_text(path),
        names,
    )


def _matching(path: Path, known: Collection[Path], program: Program | None) -> list[Path]:
    if path in known:
        return [path]
    if len(path) == 1:
        return [other for other in known if other[-1:] == path]
    return [other for other in known if program and as_defined(program, "variable", other) == path]

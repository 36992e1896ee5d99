"""Deep copies of many values at once, so that objects shared among them stay shared.

Values are copied by pickling, which follows any Python object and, unlike `copy.deepcopy`, allows a function
to be copied with the variables of the program that it closes over: the copy of a function writes the copies
of its variables. Objects that are meaningful only as themselves are shared: modules, classes, code, functions
that close over nothing, and any object that cannot be copied, such as an open file.
"""

from __future__ import annotations

import copyreg
import io
import pickle
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, ModuleType
from typing import Any, NamedTuple

from lrp_jupyter.errors import name_of, sentence_of
from lrp_jupyter.interpreter.cells import content, put
from lrp_jupyter.interpreter.journal import weightless
from lrp_jupyter.interpreter.trace_events import UNSET

_SHARED = (ModuleType, type, CodeType, BuiltinFunctionType, type(UNSET))
_PLAIN = frozenset(
    {int, float, bool, str, bytes, bytearray, complex, type(None), list, tuple, dict, set, frozenset}
)


@weightless
class Packed(NamedTuple):
    """Values packed for copying."""

    data: bytes
    shared: tuple[object, ...]  # the objects that are not copied
    uncopied: tuple[str, ...]  # type names of shared objects that could not be copied


def pack(values: Sequence[object], cells: Mapping[int, int], known: Callable[[object], object]) -> Packed:
    """Pack values; they are read now, and can be unpacked any number of times.

    `values`: one that cannot be copied, for example because it is nested too deeply, is shared.
    `cells`: the numbers of the program's variables, by id of the cell.
    `known`: returns a token for an object that is specific to each copy, such as `robot`; None for any other.
    """
    refused: dict[int, object] = {}
    while True:
        try:
            return _Packer(cells, known, refused).pack(values)
        except Exception:
            failing = [each for each in values if not _is_packed(each, cells, known, refused)]
            more = {id(each): each for each in failing or values}
            if more.keys() <= refused.keys():
                raise
            refused |= more


def _is_packed(
    value: object, cells: Mapping[int, int], known: Callable[[object], object], refused: dict[int, object]
) -> bool:
    with suppress(Exception):
        return bool(_Packer(cells, known, refused).pack([value]))
    return False


def unpack(packed: Packed, cells: list[CellType], find: Callable[[object], object]) -> list[Any]:
    """Return new copies of packed values.

    `cells`: the variables by number.
    `find`: returns the object for a token that `known` returned.
    Raises ValueError: the code of a value, such as its `__setstate__`, fails.
    """
    try:
        return list(_Unpacker(packed, cells, find).load())
    except Exception as error:
        raise ValueError(f"The values of the program cannot be copied. {sentence_of(error)}") from error


class _Packer(pickle.Pickler):
    def __init__(
        self, cells: Mapping[int, int], known: Callable[[object], object], refused: Mapping[int, object]
    ) -> None:
        self._file = io.BytesIO()
        super().__init__(self._file, protocol=5)
        self._cells = cells
        self._known = known
        self._shared: dict[int, tuple[int, object]] = {}  # by id: number, object
        self._refused = dict(refused)
        self._reduced: dict[int, tuple[object, tuple[Any, ...]]] = {}  # by id: object, how to copy it
        self._globals: set[int] = set()

    def pack(self, values: Sequence[object]) -> Packed:
        self.dump(list(values))
        uncopied = dict.fromkeys(name_of(type(value)) for value in self._refused.values())
        shared = tuple(value for _, value in self._shared.values())
        return Packed(self._file.getvalue(), shared, tuple(uncopied))

    def persistent_id(self, value: object) -> object:
        kind = type(value)
        if id(value) in self._refused or id(value) in self._globals:
            return self._share(value)
        if kind in _PLAIN:
            return None
        if kind is CellType and id(value) in self._cells:
            return "cell", self._cells[id(value)]
        token = self._known(value)
        if token is not None:
            return "known", token
        if isinstance(value, _SHARED) or (kind is FunctionType and value.__closure__ is None):  # type: ignore[attr-defined]
            return self._share(value)
        if kind is not CellType and kind is not FunctionType and not self._reduce(value):
            self._refused[id(value)] = value
            return self._share(value)
        return None

    def _share(self, value: object) -> object:
        number, _ = self._shared.setdefault(id(value), (len(self._shared), value))
        return "shared", number

    def _reduce(self, value: object) -> bool:
        """Store how to copy an object; return whether it can be copied."""
        if id(value) in self._reduced:
            return True
        try:
            reduce = copyreg.dispatch_table.get(type(value))
            reduced: Any = value.__reduce_ex__(5) if reduce is None else reduce(value)
        except Exception:
            return False
        if not isinstance(reduced, tuple) or not 2 <= len(reduced) <= 6 or not callable(reduced[0]):
            return False  # it can be reduced only to its name, or not at all
        self._reduced[id(value)] = value, reduced
        return True

    def reducer_override(self, value: Any) -> Any:
        kind = type(value)
        if kind is CellType:  # the functions that close over it set its content
            return CellType, ()
        if kind is FunctionType:
            self._globals.add(id(value.__globals__))
            own = [(cell, content(cell)) for cell in value.__closure__ if id(cell) not in self._cells]
            made = value.__code__, value.__globals__, value.__name__, None, value.__closure__
            return FunctionType, made, (value.__defaults__, value.__kwdefaults__, own), None, None, _finish
        return self._reduced[id(value)][1] if id(value) in self._reduced else NotImplemented


def _finish(function: FunctionType, state: tuple[Any, Any, list[tuple[CellType, object]]]) -> None:
    """Complete a copied function, once it can refer to itself."""
    function.__defaults__, function.__kwdefaults__, own = state
    for cell, value in own:
        put(cell, value)


class _Unpacker(pickle.Unpickler):
    def __init__(self, packed: Packed, cells: list[CellType], find: Callable[[object], object]) -> None:
        super().__init__(io.BytesIO(packed.data))
        self._shared = packed.shared
        self._cells = cells
        self._find = find

    def persistent_load(self, token: Any) -> Any:
        kind, which = token
        if kind == "cell":
            return self._cells[which]
        return self._shared[which] if kind == "shared" else self._find(which)

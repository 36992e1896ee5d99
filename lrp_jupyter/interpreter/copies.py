"""Copies of values: deep, of many values at once, so that what they share stays shared.

Copied by pickling, which follows any object of Python and, unlike `copy.deepcopy`, lets a function be copied
with the variables of the program that it closes over: the copy of a function writes the copies of its
variables. What means something only where it is in the process is shared: modules, classes, code, functions
that close over nothing, and whatever refuses to be copied, such as an open file.
"""

from __future__ import annotations

import copyreg
import io
import pickle
from collections.abc import Callable, Mapping
from types import (
    BuiltinFunctionType,
    CellType,
    CodeType,
    FunctionType,
    ModuleType,
)
from typing import Any, NamedTuple

from lrp_jupyter.errors import name_of
from lrp_jupyter.interpreter.cells import content, put
from lrp_jupyter.interpreter.events import UNSET
from lrp_jupyter.interpreter.journal import weightless

__all__ = ["Packed", "pack", "unpack"]

_SHARED = (ModuleType, type, CodeType, BuiltinFunctionType, type(UNSET))
_PLAIN = frozenset({int, float, bool, str, bytes, complex, type(None), list, tuple, dict, set, frozenset})


@weightless
class Packed(NamedTuple):
    """A value packed for copying.

    Parameters
    ----------
    data : bytes
    shared : tuple
        The objects that are not copied.
    uncopied : tuple of str
        The names of the types of those among them that could not be copied.
    """

    data: bytes
    shared: tuple[object, ...]
    uncopied: tuple[str, ...]


def pack(value: object, cells: Mapping[int, int], known: Callable[[object], object]) -> Packed:
    """Pack a value; it is read now, and can be unpacked any number of times.

    Parameters
    ----------
    value : object
    cells : mapping of int to int
        The numbers of the program's variables, by id of the cell.
    known : callable
        Returns what stands for an object that every copy has for itself, such as `robot`; None for any other.
    """
    packer = _Packer(cells, known)
    return packer.pack(value)


def unpack(packed: Packed, cells: list[CellType], find: Callable[[object], object]) -> Any:
    """Return a new copy of what was packed.

    Parameters
    ----------
    packed : Packed
    cells : list of types.CellType
        The variables by number.
    find : callable
        Returns the object that stands here for what `known` returned.
    """
    return _Unpacker(packed, cells, find).load()


class _RefusalError(Exception):
    """An object cannot be copied."""

    def __init__(self, value: object) -> None:
        self.value = value
        super().__init__()


class _Packer(pickle.Pickler):
    def __init__(self, cells: Mapping[int, int], known: Callable[[object], object]) -> None:
        self._file = io.BytesIO()
        super().__init__(self._file, protocol=5)
        self._cells = cells
        self._known = known
        self._shared: dict[int, tuple[int, object]] = {}  # by id: number, object
        self._refused: dict[int, object] = {}
        self._globals: set[int] = set()

    def pack(self, value: object) -> Packed:
        while True:
            try:
                self.dump(value)
                break
            except _RefusalError as refusal:  # one object more is shared, and all begins again
                self._refused[id(refusal.value)] = refusal.value
                self._shared.clear()
                self._file.seek(0)
                self._file.truncate()
                self.clear_memo()
        uncopied = dict.fromkeys(name_of(type(value)) for value in self._refused.values())
        shared = tuple(value for _, value in self._shared.values())
        return Packed(self._file.getvalue(), shared, tuple(uncopied))

    def persistent_id(self, value: object) -> object:
        kind = type(value)
        if kind in _PLAIN and id(value) not in self._globals:
            return None
        if kind is CellType and id(value) in self._cells:
            return "cell", self._cells[id(value)]
        token = self._known(value)
        if token is not None:
            return "known", token
        if (
            isinstance(value, _SHARED)
            or (kind is FunctionType and value.__closure__ is None)  # type: ignore[attr-defined]
            or id(value) in self._refused
            or id(value) in self._globals
        ):
            number, _ = self._shared.setdefault(id(value), (len(self._shared), value))
            return "shared", number
        return None

    def reducer_override(self, value: Any) -> Any:
        kind = type(value)
        if kind is CellType:  # the functions that close over it set its content
            return CellType, ()
        if kind is FunctionType:
            self._globals.add(id(value.__globals__))
            own = [(cell, content(cell)) for cell in value.__closure__ if id(cell) not in self._cells]
            made = value.__code__, value.__globals__, value.__name__, None, value.__closure__
            return FunctionType, made, (value.__defaults__, value.__kwdefaults__, own), None, None, _finish
        if kind in copyreg.dispatch_table or kind in _PLAIN:
            return NotImplemented
        try:
            reduced = value.__reduce_ex__(5)
        except Exception:
            reduced = ""
        if isinstance(reduced, str):  # it cannot be reduced, or only to its name
            raise _RefusalError(value)
        return reduced


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

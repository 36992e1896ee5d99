"""Values as text, bounded in length and work.

Values of built-in types are written without calling foreign code, and only the items and characters that are
shown are read. Any other value has its own ``__repr__``, which may take any time and raise any exception; the
caller decides how to call it. Functions, classes and their objects are written without module, address and
the block that defines them: ``pid(e)``, ``class Pid``, ``Pid.out(e)``, ``<Pid object>``, ``Light.RED``.
"""

from __future__ import annotations

import array
import sys
from collections import Counter, OrderedDict, defaultdict, deque
from collections.abc import Callable, Iterable, Iterator
from enum import Enum, EnumType
from inspect import CO_VARARGS, CO_VARKEYWORDS
from itertools import islice
from types import CodeType, FunctionType, MethodType, NoneType
from typing import Any

from lrp_jupyter.errors import NotAValue, name_of

LONGEST = 400  # maximum number of characters of a rendered value
_DEEPEST, _ITEMS = 3, 12
_STRING, _NUMBER = 160, 60  # maximum characters of one text or object, and of one integer
_BITS = 4096  # of the largest integer whose digits are computed

Foreign = Callable[[object], str]


def render(value: object, foreign: Foreign = repr) -> str:
    """Return a value as text of bounded depth and length.

    Only a KeyboardInterrupt is raised; any other exception is named in the text.

    `foreign`: returns the text of a value, or a part of one, that has its own ``__repr__``.
    """
    writer = _Writer(foreign)
    try:
        writer.write(value, _DEEPEST)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        return f"<{name_of(type(value))}: no text, {name_of(type(error))}>"
    text = "".join(writer.parts)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 40]}…{text[-39:]}"  # its end tells how many


def of_type(value: object) -> str:
    """Return the name of a value's type, for a value whose own ``__repr__`` must not run."""
    return f"<{name_of(type(value))}>"


def short(value: object) -> str:
    """Return a value as a short text for a message; runs no foreign code."""

    def foreign(part: object) -> str:
        return f"a value of type `{name_of(type(part))}`" if part is value else of_type(part)

    text = render(value, foreign)
    return text if len(text) <= 60 else text[:57] + "…"


def is_scalar(value: object) -> bool:
    """Return whether a value is a number, a text or None, of exactly a built-in type."""
    kind = type(value)
    return kind is float or kind is int or kind is str or kind is bool or kind is NoneType


def scalar_of(value: object) -> object:
    """Return a numpy scalar as a value of a built-in type; any other value unchanged."""
    numpy = sys.modules.get("numpy")
    if numpy is None or not issubclass(type(value), numpy.generic):
        return value
    plain: object = numpy.generic.item(value)  # code of numpy, also for a subclass
    return plain if is_scalar(plain) else value


class _Writer:
    """Collects the parts of a text up to its maximum length."""

    def __init__(self, foreign: Foreign) -> None:
        self.parts: list[str] = []
        self._left = LONGEST
        self._foreign = foreign

    def put(self, text: str) -> None:
        self.parts.append(text)
        self._left -= len(text)

    def write(self, value: Any, depth: int) -> None:
        """Write a value, using the ``__repr__`` that its type has or inherits."""
        if self._left <= 0:
            return
        own = type.__getattribute__(type(value), "__repr__")
        for builtin, write in _WRITERS:
            if own is builtin:
                write(self, value, depth)
                return
        if issubclass(type(value), NotAValue):
            self.put(_cut(value._in_text(), _STRING))
            return
        try:
            text = _exactly(self._foreign(value)).replace(_IN_BLOCK, "")
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            text = f"<{name_of(type(value))}: no text, {name_of(type(error))}>"
        self.put(_cut(text, _STRING))

    def items(
        self,
        opening: str,
        items: Iterable[Any],
        count: int,
        closing: str,
        depth: int,
        write: Callable[[_Writer, Any, int], None] = write,
    ) -> None:
        """Write the first items, in brackets."""
        self.put(opening)
        if depth <= 0 and count:
            self.put("...")
        else:
            shown = 0
            for item in islice(items, _ITEMS):
                if self._left <= 0:
                    break
                self.put(", " if shown else "")
                write(self, item, depth - 1)
                shown += 1
            if count > shown:
                self.put(f", ... {count - shown} more")
        self.put(closing)

    def mapping(self, opening: str, mapping: dict[Any, Any], closing: str, depth: int) -> None:
        """Write the first items of a dict, in brackets."""
        self.items(opening, dict.items(mapping), dict.__len__(mapping), closing, depth, _Writer.pair)

    def pair(self, pair: tuple[Any, Any], depth: int) -> None:
        self.write(pair[0], depth)
        self.put(": ")
        self.write(pair[1], depth)


def _exactly(text: str) -> str:
    """Return a text as exactly a str, not a subclass."""
    return str.__getitem__(text, slice(None))


def _cut(text: str, most: int) -> str:
    """Return a text with its middle left out if it is too long."""
    if len(text) <= most:
        return text
    before = (most - 3) // 2
    return f"{text[:before]}...{text[before + 3 - most :]}"


def _ends(value: Any, read: Callable[[Any, slice], Any], length: int) -> Any:
    """Return the visible parts of a long text, joined."""
    if length <= 2 * _STRING:
        return value
    return read(value, slice(_STRING)) + read(value, slice(-_STRING, None))


def _str(writer: _Writer, value: str, depth: int) -> None:
    shown = str.__getitem__(_ends(value, str.__getitem__, str.__len__(value)), slice(None))
    writer.put(_cut(repr(shown), _STRING))


def _bytes(writer: _Writer, value: bytes, depth: int) -> None:
    writer.put(_cut(repr(bytes(_ends(value, bytes.__getitem__, bytes.__len__(value)))), _STRING))


def _bytearray(writer: _Writer, value: bytearray, depth: int) -> None:
    shown = bytes(_ends(value, bytearray.__getitem__, bytearray.__len__(value)))
    writer.put(_cut(f"bytearray({shown!r})", _STRING))


def _int(writer: _Writer, value: int, depth: int) -> None:
    bits = int.bit_length(value)
    writer.put(_cut(int.__repr__(value), _NUMBER) if bits <= _BITS else f"<integer of {bits} bits>")


def _list(writer: _Writer, value: list[Any], depth: int) -> None:
    writer.items("[", list.__iter__(value), list.__len__(value), "]", depth)


def _tuple(writer: _Writer, value: tuple[Any, ...], depth: int) -> None:
    count = tuple.__len__(value)
    writer.items("(", tuple.__iter__(value), count, ",)" if count == 1 else ")", depth)


def _set(writer: _Writer, value: set[Any], depth: int) -> None:
    if count := set.__len__(value):
        writer.items("{", _sorted(set.__iter__(value), count), count, "}", depth)
    else:
        writer.put("set()")


def _frozenset(writer: _Writer, value: frozenset[Any], depth: int) -> None:
    if count := frozenset.__len__(value):
        writer.items("frozenset({", _sorted(frozenset.__iter__(value), count), count, "})", depth)
    else:
        writer.put("frozenset()")


def _sorted(items: Iterator[Any], count: int) -> Iterable[Any]:
    """Return the items of a set, sorted if this is quick: Python's order may differ in every process."""
    if count > 200:
        return items
    every = list(items)
    kind = type(every[0])
    comparable = is_scalar(every[0]) and all(type(item) is kind for item in every)
    return sorted(every) if comparable else sorted(every, key=lambda item: render(item, of_type))


def _dict(writer: _Writer, value: dict[Any, Any], depth: int) -> None:
    writer.mapping("{", value, "}", depth)


def _named_dict(writer: _Writer, value: dict[Any, Any], depth: int) -> None:
    writer.mapping(f"{name_of(type(value))}({{", value, "})", depth)


def _deque(writer: _Writer, value: deque[Any], depth: int) -> None:
    writer.items("deque([", deque.__iter__(value), deque.__len__(value), "])", depth)


def _array(writer: _Writer, value: array.array[Any], depth: int) -> None:
    count = array.array.__len__(value)
    first = (array.array.__getitem__(value, index) for index in range(count))
    writer.items(f"array({value.typecode!r}, [", first, count, "])", depth)


def _function(writer: _Writer, value: FunctionType, depth: int) -> None:
    parameters = ", ".join(_parameters(value.__code__))
    name = _exactly(value.__name__)
    text = f"lambda {parameters}".rstrip() + ": …" if name == "<lambda>" else f"{name}({parameters})"
    writer.put(_cut(text, _STRING))


def _method(writer: _Writer, value: MethodType, depth: int) -> None:
    function, owner = value.__func__, value.__self__
    kind: Any = owner if issubclass(type(owner), type) else type(owner)
    if type(function) is FunctionType:
        text = f"{_exactly(function.__name__)}({', '.join(_parameters(function.__code__)[1:])})"
    else:
        text = f"{name_of(type(function))}(…)"
    writer.put(_cut(f"{name_of(kind)}.{text}", _STRING))


def _parameters(code: CodeType) -> list[str]:
    """Return the parameters of a function as they are written in its head, without default values."""
    rest = iter(code.co_varnames)
    parameters = [*islice(rest, code.co_argcount)]
    named = [*islice(rest, code.co_kwonlyargcount)]
    if code.co_flags & CO_VARARGS:
        parameters.append(f"*{next(rest)}")
    elif named:
        parameters.append("*")
    parameters += named
    if code.co_flags & CO_VARKEYWORDS:
        parameters.append(f"**{next(rest)}")
    return parameters


def _class(writer: _Writer, value: type, depth: int) -> None:
    writer.put(_cut(f"class {name_of(value)}", _STRING))


def _object(writer: _Writer, value: object, depth: int) -> None:
    writer.put(_cut(f"<{name_of(type(value))} object>", _STRING))


def _member(writer: _Writer, value: Enum, depth: int) -> None:
    writer.put(_cut(f"{name_of(type(value))}.{object.__getattribute__(value, '_name_')}", _STRING))


_IN_BLOCK = "block.<locals>."  # what Python puts before the name of a class that a block defines

_WRITERS: list[tuple[object, Callable[[_Writer, Any, int], None]]] = [
    (float.__repr__, lambda writer, value, depth: writer.put(float.__repr__(value))),
    (int.__repr__, _int),
    (str.__repr__, _str),
    (bool.__repr__, lambda writer, value, depth: writer.put(bool.__repr__(value))),
    (NoneType.__repr__, lambda writer, value, depth: writer.put("None")),
    (complex.__repr__, lambda writer, value, depth: writer.put(complex.__repr__(value))),
    (list.__repr__, _list),
    (tuple.__repr__, _tuple),
    (dict.__repr__, _dict),
    (set.__repr__, _set),
    (frozenset.__repr__, _frozenset),
    (bytes.__repr__, _bytes),
    (bytearray.__repr__, _bytearray),
    (deque.__repr__, _deque),
    (OrderedDict.__repr__, _named_dict),
    (defaultdict.__repr__, _named_dict),
    (Counter.__repr__, _named_dict),
    (array.array.__repr__, _array),
    (FunctionType.__repr__, _function),
    (MethodType.__repr__, _method),
    (type.__repr__, _class),
    (EnumType.__repr__, _class),
    (Enum.__repr__, _member),
    (object.__repr__, _object),
]
"""Writers by the ``__repr__`` that a type has or inherits; comparison by identity runs no foreign code."""

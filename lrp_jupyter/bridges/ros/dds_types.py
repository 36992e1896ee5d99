"""ROS 2's message types, without a ROS installation: as definitions, as IDL structs, and by their hash.

A type is taken from the user's folders, else from an installed ROS (``AMENT_PREFIX_PATH``), else from the
copy in rosbags of the distribution ``ROS_DISTRO`` (default: jazzy). In a folder, the type ``package/Type`` is
the file ``package/msg/Type.msg``.
"""

from __future__ import annotations

import os
import re
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import cyclonedds.idl.types as idl
from cyclonedds.idl import make_idl_struct
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
from rosbags.typesys.base import normalize_fieldname

from lrp_jupyter.bridges.ros.definitions import INTEGERS, Definition, FieldType, canonical, definitions_of
from lrp_jupyter.bridges.ros.link import RefusedError
from lrp_jupyter.errors import BridgeError, did_you_mean

_DISTRIBUTION = "jazzy"
_PADDING = "structure_needs_at_least_one_member"  # ROS 2 gives a message without fields this one
_HEADER = "std_msgs/Header"
_PRIMITIVES: Mapping[str, Any] = {
    **{name: getattr(idl, name) for name in ("byte", "float32", "float64")},
    **{name: getattr(idl, name) for name in INTEGERS if "int" in name},
    "bool": bool,
}
_idl_lock = threading.Lock()  # cyclonedds keeps the class that is being made in a global variable

Make = Callable[[Any], Any]


class MessageTypes:
    """The types of one connection; the user's own definitions are in `folders`.

    `now`: returns the time, in ns, for headers that have none.

    Owner: the thread of the link; `sample` may be called on any thread for a type whose struct was made.
    """

    def __init__(
        self, folders: Iterable[str | os.PathLike[str]] = (), now: Callable[[], int] = time.time_ns
    ) -> None:
        self.now = now
        self._store = get_typestore(_distribution())
        for type_, (constants, fields) in self._store.fielddefs.items():
            self._store.fielddefs[type_] = (constants, [(name, _without_char(kind)) for name, kind in fields])
        self._files = {**_installed(), **{name: path for folder in folders for name, path in _found(folder)}}
        self._structs: dict[str, Any] = {}
        self._makers: dict[str, Make] = {}

    def names(self) -> list[str]:
        """Return the names of all types, as ``package/Type``."""
        return [*self._files, *(canonical(name) for name in self._store.fielddefs if "/msg/" in name)]

    def define(self, type_: str) -> dict[str, Definition]:
        """Return the definitions of a type and of those in it; empty if the type is not known."""
        return definitions_of(type_, self._shapes) if self._load(type_) else {}

    def _shapes(self, type_: str) -> dict[str, FieldType]:
        return {name: _shape(kind) for name, kind in self._fields(type_) if name != _PADDING}

    def hash(self, type_: str) -> str:
        """Return the hash by which ROS 2 tells versions of a type apart: ``RIHS01_…``."""
        return str(self._store.hash_rihs01(_full(type_)))

    def struct(self, type_: str) -> Any:
        """Return the class of a type's messages, as cyclonedds sends them."""
        if not self._load(type_):
            raise RefusedError(f"There is no message type `{type_}`.{did_you_mean(type_, self.names())}")
        with _idl_lock:
            return self._struct(type_)

    def _struct(self, type_: str) -> Any:
        if type_ not in self._structs:
            package, name = type_.split("/")
            fields = {field: self._idl(kind) for field, kind in self._fields(type_)}
            self._structs[type_] = make_idl_struct(f"{name}_", f"{package}.msg.dds_.{name}_", fields)
            self._makers[type_] = self._maker(type_)
        return self._structs[type_]

    def sample(self, type_: str, values: Mapping[str, Any]) -> Any:
        """Return a message of values, with zeros for the others, and the time now in a header without one."""
        return self._makers[type_](values)

    # -- files ------------------------------------------------------------------------------------

    def _load(self, type_: str, needed_by: tuple[str, ...] = ()) -> bool:
        """Read the files of a type and of all that is in it; return whether there is such a type."""
        full, path = _full(type_), self._files.get(type_)
        if type_ in self._structs:
            return True
        if path is not None:
            self._store.fielddefs[full] = _read(path, full)
        elif full not in self._store.fielddefs:
            return False
        for name, base in ((name, _shape(kind).base) for name, kind in self._fields(type_)):
            if base in (*needed_by, type_):
                raise RefusedError(f"{_where(path, type_, name)}: A `{base}` cannot contain a `{base}`.")
            if "/" in base and not self._load(base, (*needed_by, type_)):
                hint = did_you_mean(base, self.names())
                raise RefusedError(
                    f"{_where(path, type_, name)}: There is no message type `{base}`.{hint}"
                    f" Name the folder with `{base.replace('/', '/msg/')}.msg`, too."
                )
        return True

    def _fields(self, type_: str) -> Iterator[tuple[str, Any]]:
        for name, kind in self._store.fielddefs[_full(type_)][1]:
            yield normalize_fieldname(name), kind

    # -- messages ---------------------------------------------------------------------------------

    def _idl(self, kind: Any) -> Any:
        """Return the annotation of a field."""
        node, inside = kind
        if node == Nodetype.NAME:
            return self._struct(canonical(inside))
        if node == Nodetype.ARRAY:
            return idl.array[self._idl(inside[0]), inside[1]]
        if node == Nodetype.SEQUENCE:
            one = self._idl(inside[0])
            return idl.sequence[one, inside[1]] if inside[1] else idl.sequence[one]
        name, bound = inside
        if name == "string":
            return idl.bounded_str[bound] if bound else str
        return _PRIMITIVES[name]

    def _maker(self, type_: str) -> Make:
        kind, makers, zeros = self._structs[type_], {}, {}
        for name, shape in ((name, _shape(kind)) for name, kind in self._fields(type_)):
            one: Make = self._makers[shape.base] if "/" in shape.base else _same
            makers[name] = one if shape.length < 0 else _many(one)
            zero: Any = {} if "/" in shape.base else "" if shape.base == "string" else 0
            zeros[name] = zero if shape.length < 0 else [zero] * shape.length

        def make(values: Mapping[str, Any]) -> Any:
            return kind(**{name: one(values.get(name, zeros[name])) for name, one in makers.items()})

        def make_header(values: Mapping[str, Any]) -> Any:
            header = make(values)
            if not (header.stamp.sec or header.stamp.nanosec):
                header.stamp.sec, header.stamp.nanosec = divmod(self.now(), 1_000_000_000)
            return header

        return make_header if type_ == _HEADER else make


def _same(value: Any) -> Any:
    return value


def _many(one: Make) -> Make:
    return list if one is _same else lambda values: [one(value) for value in values]


def _distribution() -> Stores:
    name = os.environ.get("ROS_DISTRO", "")
    known = {store.value.removeprefix("ros2_"): store for store in Stores if store.value.startswith("ros2_")}
    return known.get(name, known[_DISTRIBUTION])


def _full(type_: str) -> str:
    return type_.replace("/", "/msg/", 1)


def _without_char(kind: Any) -> Any:
    """Return a field's type with uint8 for char: in ROS 2 they are one type, and have one hash."""
    node, inside = kind
    if node == Nodetype.BASE:
        return (node, ("uint8", inside[1])) if inside[0] == "char" else kind
    return kind if node == Nodetype.NAME else (node, (_without_char(inside[0]), inside[1]))


def _shape(kind: Any) -> FieldType:
    node, inside = kind
    if node == Nodetype.NAME:
        return FieldType(canonical(inside))
    if node == Nodetype.BASE:
        return FieldType(inside[0])
    return FieldType(_shape(inside[0]).base, inside[1] if node == Nodetype.ARRAY else 0)


def _installed() -> dict[str, Path]:
    """Find the definitions of an installed ROS."""
    prefixes = map(Path, filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)))
    return {
        f"{path.parts[-3]}/{path.stem}": path
        for prefix in reversed(list(prefixes))  # the first one wins
        for path in sorted(prefix.glob("share/*/msg/*.msg"))
    }


def _found(folder: str | os.PathLike[str]) -> Iterator[tuple[str, Path]]:
    """Yield the definitions in a folder of the user's, which must have some."""
    place = Path(folder).expanduser()
    if not place.is_dir():
        raise BridgeError(f"`{folder}` is not a folder. Name the one with `package/msg/Type.msg`.")
    paths = [path for path in sorted(place.resolve().rglob("*.msg")) if path.parent.name == "msg"]
    if not paths:
        raise BridgeError(f"`{folder}` has no message types. They are files such as `package/msg/Type.msg`.")
    for path in paths:
        yield f"{path.parts[-3]}/{path.stem}", path


def _read(path: Path, full: str) -> Any:
    """Read a definition; a RefusedError names the line of a mistake."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise RefusedError(f"{path} cannot be read: {error}.") from error
    for count, line in enumerate(lines, 1):  # the grammar is one of lines: the first that does not fit
        try:
            get_types_from_msg(f"{line}\n", full)
        except TypesysError:
            raise RefusedError(
                f"{path}, line {count}: `{line.strip()}` is not a field."
                " Write its type and its name, such as `float64 speed`."
            ) from None
    constants, fields = get_types_from_msg("\n".join(lines) + "\n", full)[full]
    names = [name for name, _kind in fields]
    for name in names:
        if names.count(name) > 1:
            raise RefusedError(f"{_where(path, full, name)}: There are two fields `{name}`. Rename one.")
    return constants, [(name, _without_char(kind)) for name, kind in fields]


def _where(path: Path | None, type_: str, field: str) -> str:
    """Return the place of a field: its file and line, or its type."""
    if path is None:
        return f"`{type_}.{field}`"
    pattern = re.compile(rf"\s*\S+\s+{re.escape(field.removesuffix('_'))}_?(\s|#|$)")
    lines = path.read_text(encoding="utf-8").splitlines()
    return f"{path}, line {next((n for n, line in enumerate(lines, 1) if pattern.match(line)), 1)}"

"""Reading a world from JSON; every error names its place: ``solids[2].box: expected 4 numbers``."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from difflib import get_close_matches
from keyword import iskeyword
from pathlib import Path
from typing import Any, TypeVar

from lrp_jupyter.sim.world import (
    DIRECTIONS,
    VERSION,
    ArcStroke,
    BoxSolid,
    BoxZone,
    CircleStroke,
    CircleZone,
    DiscSolid,
    FloorSpec,
    Noise,
    PathStroke,
    Patrol,
    RobotSpec,
    Solid,
    Stroke,
    World,
    WorldError,
    Zone,
    middle_of,
)

T = TypeVar("T")
_FAR = 1000.0  # metres: larger worlds are surely a mistake of units
_SMALL = 1e-4
_LARGEST = 32_000_000  # bytes of a file


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return `` Did you mean `x`?``, with a space before it, for the closest known word, or nothing."""
    close = get_close_matches(word, list(known), n=1)
    return f" Did you mean `{close[0]}`?" if close else ""


def read_file(path: Path) -> World:
    """Read a world from a JSON file.

    Raises WorldError: the file cannot be read, is not JSON, or is not a world.
    """
    try:
        size = path.stat().st_size if path.is_file() or path.is_dir() or not path.exists() else math.inf
        if size > _LARGEST:
            raise OSError("It is too large, or a device or a pipe.")
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:  # a ValueError: no text, or there is a null character in its name
        reason = getattr(error, "strerror", None) or error
        raise WorldError(f"{path} cannot be read: {str(reason).rstrip('.')}.") from error
    return read_text(text, str(path))


def read_text(text: str, source: str) -> World:
    """Read a world from JSON text.

    `source`: where the text is from, for messages.
    Raises WorldError: it is not JSON, or not a world.
    """
    try:
        value = json.loads(text, parse_constant=_no_constant)
    except json.JSONDecodeError as error:
        raise WorldError(
            f"{source} is not valid JSON: line {error.lineno}, column {error.colno}: {error.msg}."
        ) from error
    except WorldError as error:
        raise WorldError(f"{source}: {error}") from None
    except RecursionError:
        raise WorldError(f"{source} is nested too deeply.") from None
    try:
        return read_world(value)
    except WorldError as error:
        raise WorldError(f"{source}: {error}") from None


def read_world(value: object) -> World:
    """Read a world from plain data.

    `value`: as :meth:`World.to_dict` writes it; only ``version``, ``size`` and ``robots`` must be there.
    Raises WorldError: the message begins with the place of the first mistake.
    """
    record = _record(value, "", ("version", *_keys(World)), ("version", "size", "robots"))
    if record["version"] != VERSION or isinstance(record["version"], bool):
        raise WorldError(f"`version`: Expected {VERSION}, not {_shown(record['version'])}.")
    width, height = _numbers(record["size"], "size", 2, low=0.1, high=_FAR)
    robots = _each(record["robots"], "robots", lambda item, place: _robot(item, place, (width, height)))
    if not robots:
        raise WorldError("`robots`: Expected at least one robot.")
    names: list[str] = []
    for index, name in enumerate(World((width, height), robots).robot_names):
        if name in names:
            raise WorldError(f"`robots[{index}].name`: There is another `{name}`. Choose another name.")
        names.append(name)
    solids = _each(record.get("solids", []), "solids", read_solid)
    for index, solid in enumerate(solids):
        for number, point in enumerate(solid.patrol.points(middle_of(solid))[1:] if solid.patrol else ()):
            _inside(point, f"solids[{index}].patrol.path[{number}]", (width, height))
    return World(
        size=(width, height),
        robots=robots,
        floor=_floor(record.get("floor", {}), "floor"),
        solids=solids,
        zones=_zones(record.get("zones", {}), "zones"),
        seed=_whole(record.get("seed", 0), "seed"),
        open=_truth(record.get("open", False), "open"),
        name=_text(record.get("name", ""), "name"),
    )


def _floor(value: object, place: str) -> FloorSpec:
    record = _record(value, place, _keys(FloorSpec))
    return FloorSpec(
        grey=_grey(record.get("grey", 255), f"{place}.grey"),
        strokes=_each(record.get("strokes", []), f"{place}.strokes", _stroke),
    )


def _stroke(value: object, place: str) -> Stroke:
    record = _record(value, place, _keys(PathStroke, ArcStroke, CircleStroke))
    shape = _one_of(record, place, ("path", "arc", "circle"))
    width = _number(record.get("width", 0.03), f"{place}.width", low=_SMALL, high=_FAR)
    grey = _grey(record.get("grey", 0), f"{place}.grey")
    place = f"{place}.{shape}"
    if shape == "path":
        path = _each(record[shape], place, _point)
        if not path:
            raise WorldError(f"`{place}`: Expected at least one point.")
        return PathStroke(path, width, grey)
    if shape == "arc":
        x, y, radius, first, last = _numbers(record[shape], place, 5)
        if abs(last - first) > 2 * math.pi + 1e-9:
            raise WorldError(f"`{place}`: The arc is longer than a full turn. Write angles in radians.")
        return ArcStroke((x, y, _positive(radius, f"{place}[2]"), first, last), width, grey)
    x, y, radius = _numbers(record[shape], place, 3)
    return CircleStroke((x, y, _positive(radius, f"{place}[2]")), width, grey)


def read_solid(value: object, place: str) -> Solid:
    """Read a solid from plain data; `place` names it in messages.

    Raises WorldError: it is not a solid.
    """
    record = _record(value, place, _keys(BoxSolid, DiscSolid))
    shape = _one_of(record, place, ("box", "circle"))
    angle = _number(record.get("angle", 0), f"{place}.angle", low=-_FAR, high=_FAR)
    push = record.get("push")
    push = None if push is None else _number(push, f"{place}.push", low=0.0, high=10.0)
    name = _text(record.get("name", ""), f"{place}.name")
    patrol = None if record.get("patrol") is None else _patrol(record["patrol"], f"{place}.patrol")
    if push is not None and patrol is not None:
        raise WorldError(f"`{place}`: It moves by itself and cannot be pushed. Remove `patrol` or `push`.")
    if shape == "box":
        return BoxSolid(_box(record[shape], f"{place}.{shape}"), angle, push, name, patrol)
    return DiscSolid(_disc(record[shape], f"{place}.{shape}"), angle, push, name, patrol)


def _patrol(value: object, place: str) -> Patrol:
    record = _record(value, place, _keys(Patrol), ("path",))
    path = _each(record["path"], f"{place}.path", _point)
    if not path:
        raise WorldError(
            f"`{place}.path`: Expected at least one point, in metres from where the solid starts."
        )
    for index, (before, point) in enumerate(zip(((0.0, 0.0), *path), path, strict=False)):
        if math.dist(before, point) < _SMALL:
            raise WorldError(f"`{place}.path[{index}]`: The solid is there already. Remove this point.")
    return Patrol(
        path=path,
        speed=_number(record.get("speed", 0.2), f"{place}.speed", low=0.001, high=10.0),
        closed=_truth(record.get("closed", False), f"{place}.closed"),
    )


def _zones(value: object, place: str) -> dict[str, Zone]:
    return {name: read_zone(item, f"{place}.{name}") for name, item in _record(value, place, None).items()}


def read_zone(value: object, place: str) -> Zone:
    """Read a zone from plain data; `place` names it in messages.

    Raises WorldError: it is not a zone.
    """
    record = _record(value, place, _keys(BoxZone, CircleZone))
    shape = _one_of(record, place, ("box", "circle"))
    if shape == "box":
        return BoxZone(_box(record[shape], f"{place}.{shape}"))
    return CircleZone(_disc(record[shape], f"{place}.{shape}"))


def _robot(value: object, place: str, size: tuple[float, float]) -> RobotSpec:
    record = _record(value, place, _keys(RobotSpec), ("pose",))
    standard = RobotSpec((0.0, 0.0, 0.0))
    x, y, heading = _numbers(record["pose"], f"{place}.pose", 3, low=-_FAR, high=_FAR)
    _inside((x, y), f"{place}.pose", size)
    rays = _each(record.get("distance", standard.distance), f"{place}.distance", _point)
    for index, (_, reach) in enumerate(rays):
        _positive(reach, f"{place}.distance[{index}][1]")
    forward, turning = _numbers(
        record.get("limits", standard.limits), f"{place}.limits", 2, low=_SMALL, high=100.0
    )
    left, right = _numbers(record.get("wheels", standard.wheels), f"{place}.wheels", 2, low=_SMALL, high=10.0)
    return RobotSpec(
        pose=(x, y, heading),
        radius=_number(record.get("radius", standard.radius), f"{place}.radius", low=0.01, high=10.0),
        light=_each(record.get("light", standard.light), f"{place}.light", _point),
        bumper=_truth(record.get("bumper", True), f"{place}.bumper"),
        distance=rays,
        limits=(forward, turning),
        noise=_noise(record.get("noise", {}), f"{place}.noise"),
        wheels=(left, right),
        name=_robot_name(record.get("name", ""), f"{place}.name"),
    )


def _robot_name(value: object, place: str) -> str:
    name = _text(value, place)
    if name and (not name.isidentifier() or iskeyword(name) or name.startswith("_")):
        raise WorldError(f"`{place}`: Expected a name such as `follower`, not {_shown(name)}.")
    if name in _MEMBERS:
        raise WorldError(f"`{place}`: A robot has a member `{name}` already. Choose another name.")
    return name


_MEMBERS = frozenset(
    {
        *("light", "bumper", "distance", "scan", "gyro", "odom", *DIRECTIONS),
        *("move", "stop", "pen", "lamp", "drive_by", "turn_by", "drive_to", "say"),
    }
)
"""Members of a robot, which another robot cannot be called by."""


def _noise(value: object, place: str) -> Noise:
    record = _record(value, place, _keys(Noise))
    return Noise(
        **{key: _number(item, f"{place}.{key}", low=0.0, high=255.0) for key, item in record.items()}
    )


def _box(value: object, place: str) -> tuple[float, float, float, float]:
    x, y, width, height = _numbers(value, place, 4)
    return x, y, _positive(width, f"{place}[2]"), _positive(height, f"{place}[3]")


def _disc(value: object, place: str) -> tuple[float, float, float]:
    x, y, radius = _numbers(value, place, 3)
    return x, y, _positive(radius, f"{place}[2]")


def _inside(point: tuple[float, float], place: str, size: tuple[float, float]) -> None:
    (x, y), (width, height) = point, size
    if not (0 <= x <= width and 0 <= y <= height):
        raise WorldError(
            f"`{place}`: The point ({x:g}, {y:g}) is outside the world of {width:g} x {height:g} m."
        )


def _point(value: object, place: str) -> tuple[float, float]:
    x, y = _numbers(value, place, 2)
    return x, y


def _keys(*kinds: type) -> tuple[str, ...]:
    """Return the names of the fields of some dataclasses, each once."""
    return tuple(dict.fromkeys(field.name for kind in kinds for field in fields(kind)))


def _record(
    value: object, place: str, known: tuple[str, ...] | None, needed: tuple[str, ...] = ()
) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise WorldError(f"`{place or 'world'}`: Expected an object, not {_shown(value)}.")
    prefix = f"{place}." if place else ""
    for key in value:
        if not isinstance(key, str):
            raise WorldError(f"`{place or 'world'}`: Keys must be strings, not {_shown(key)}.")
        if known is not None and key not in known:
            raise WorldError(f"`{prefix}{key}`: Unknown key.{did_you_mean(key, known)}")
    for key in needed:
        if key not in value:
            raise WorldError(f"`{place or 'world'}`: The key `{key}` is missing.")
    return value


def _one_of(record: Mapping[str, Any], place: str, shapes: tuple[str, ...]) -> str:
    present = [shape for shape in shapes if shape in record]
    if len(present) != 1:
        choice = " or ".join(f"`{shape}`" for shape in shapes)
        found = "none" if not present else " and ".join(f"`{shape}`" for shape in present)
        raise WorldError(f"`{place}`: Expected one of {choice}, not {found}.")
    return present[0]


def _each(value: object, place: str, read: Callable[[object, str], T]) -> tuple[T, ...]:
    if not isinstance(value, list | tuple):
        raise WorldError(f"`{place}`: Expected a list, not {_shown(value)}.")
    return tuple(read(item, f"{place}[{index}]") for index, item in enumerate(value))


def _numbers(
    value: object, place: str, count: int, low: float = -_FAR, high: float = _FAR
) -> tuple[float, ...]:
    if not isinstance(value, list | tuple):
        raise WorldError(f"`{place}`: Expected {count} numbers, not {_shown(value)}.")
    if len(value) != count:
        raise WorldError(f"`{place}`: Expected {count} numbers, not {len(value)}.")
    return tuple(_number(item, f"{place}[{index}]", low, high) for index, item in enumerate(value))


def _number(value: object, place: str, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise WorldError(f"`{place}`: Expected a number, not {_shown(value)}.")
    if not low <= value <= high:  # NaN is in no range
        raise WorldError(f"`{place}`: Expected a number from {low:g} to {high:g}, not {value!r}.")
    return value


def _positive(value: float, place: str) -> float:
    return _number(value, place, low=_SMALL, high=_FAR)


def _grey(value: object, place: str) -> float:
    return _number(value, place, low=0.0, high=255.0)


def _whole(value: object, place: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise WorldError(f"`{place}`: Expected a whole number, not {_shown(value)}.")
    return value


def _truth(value: object, place: str) -> bool:
    if not isinstance(value, bool):
        raise WorldError(f"`{place}`: Expected true or false, not {_shown(value)}.")
    return value


def _text(value: object, place: str) -> str:
    if not isinstance(value, str):
        raise WorldError(f"`{place}`: Expected a string, not {_shown(value)}.")
    return value


def _shown(value: object) -> str:
    """Return a short text for a value, with JSON's names of types."""
    words: dict[type, str] = {
        dict: "an object",
        list: "a list",
        tuple: "a list",
        type(None): "null",
        bool: str(value).lower(),
    }
    return words.get(type(value)) or (repr(value) if len(repr(value)) <= 40 else f"{repr(value)[:37]}...")


def _no_constant(name: str) -> float:
    raise WorldError(f"`{name}` is not a valid number here.")

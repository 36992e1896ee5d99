"""The simulated world as messages: its description, the poses, and the trails of pens.

Everything here is read from frozen values and from lists that only grow, so it may be read on any thread;
the physics stays with the interpreter's.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, cast

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.sim import SimBridge, SimPicture
from lrp_jupyter.sim.floor import Mark, Paint
from lrp_jupyter.sim.world import BoxSolid, Point, Pose, can_move, middle_of
from lrp_jupyter.widgets.wire.protocol import InkView, StrokeView, WorldView

_DISTANCE = 0.1  # s between two descriptions, at least


class WorldCursor:
    """Tracks what one view has been sent of the world, and what is new."""

    def __init__(self) -> None:
        self._scene: object = None
        self._described = float("-inf")
        self._picture: SimPicture | None = None
        self._marks = 0
        self._strokes = 0
        self._says: list[str] = []

    def describe(self, bridge: Bridge, picture: object, now: float) -> WorldView | None:
        """Return the whole world; its poses and ink are then sent from the beginning."""
        self._scene, self._described = _scene_of(bridge, picture), now
        self._marks = self._strokes = 0
        self._says = []
        self._picture = None
        return world_view(bridge, picture)

    def must_describe(self, bridge: Bridge, picture: object, now: float) -> bool:
        """Whether the world changed other than by movement and ink, and long enough after the last time."""
        return _scene_of(bridge, picture) != self._scene and now - self._described >= _DISTANCE

    def has_moved(self, picture: object) -> bool:
        """Return whether something moved or was drawn; time alone moves nothing."""
        if not isinstance(picture, SimPicture) or self._picture is None:
            return isinstance(picture, SimPicture)
        return replace(picture, time=self._picture.time) != self._picture

    def advance(self, bridge: Bridge, picture: object) -> tuple[dict[str, Any], list[bytes]]:
        """Return the movement for a frame: fields for ink and texts that are new, and the buffer of poses."""
        assert isinstance(bridge, SimBridge)
        assert isinstance(picture, SimPicture)
        self._picture = picture
        fields: dict[str, Any] = {}
        says = [robot.says for robot in picture.robots] if any(robot.says for robot in picture.robots) else []
        if says != self._says:
            fields["says"] = self._says = says
        if picture.marks == self._marks:
            return fields, [_poses(picture)]
        if picture.marks < self._marks:  # an earlier moment is looked at
            self._marks = self._strokes = 0
        strokes = _strokes_of(bridge.simulation.floor.marks[self._marks : picture.marks])
        ink: InkView = {"first": self._strokes, "strokes": strokes}
        self._marks, self._strokes = picture.marks, self._strokes + len(strokes)
        return {**fields, "ink": ink}, [_poses(picture)]


def _scene_of(bridge: Bridge, picture: object) -> object:
    """Return a value that changes when the world must be described again; None without a world."""
    if not isinstance(bridge, SimBridge):
        return None
    return id(bridge.simulation), getattr(picture, "revision", 0)


def world_view(bridge: Bridge, picture: object) -> WorldView | None:
    """Return a world with its solids where they are now; None for a bridge without a world."""
    if not isinstance(bridge, SimBridge):
        return None
    world = bridge.world
    places: tuple[Pose, ...] = ()
    patrols: tuple[tuple[Point, ...], ...] = ()
    if isinstance(picture, SimPicture):
        world, places, patrols = picture.world, picture.solids, picture.patrols
    view = world.to_dict()
    for robot, name in zip(view["robots"], world.robot_names, strict=True):
        robot["name"] = name
    for i, (solid, shown) in enumerate(zip(world.solids, view["solids"], strict=True)):
        start = middle_of(solid)
        x, y, shown["angle"] = places[i] if places else (*start, solid.angle)
        shown["box" if isinstance(solid, BoxSolid) else "circle"][:2] = x, y
        if solid.patrol is not None:
            shown["patrol"] = patrols[i] if patrols else solid.patrol.points(start)
    view |= {"edited": bridge.is_edited, "undo": bridge.can_undo, "redo": bridge.can_redo}
    return cast(WorldView, view)


def _poses(picture: SimPicture) -> bytes:
    """Return the poses of everything, as the buffer of a `FrameMessage`."""
    robots: list[Any] = []
    for robot, spec in zip(picture.robots, picture.world.robots, strict=False):
        lights: list[float] = [*robot.lights, *[math.nan] * len(spec.light)]
        distances = [*robot.distances, *[math.inf] * len(spec.distance)]
        robots.append(
            (
                *robot.pose,
                bool(robot.bumper),
                robot.pen,
                robot.lamp,
                robot.command[0],
                lights[: len(spec.light)],
                distances[: len(spec.distance)],
            )
        )
    pushed = [
        place for place, solid in zip(picture.solids, picture.world.solids, strict=False) if can_move(solid)
    ]
    return pack_poses(picture.time, robots, pushed)


def _strokes_of(marks: Sequence[Mark]) -> list[StrokeView]:
    """Join connected pieces of trails into strokes."""
    strokes: list[StrokeView] = []
    before: tuple[Paint, float, float] | None = None
    for _, paint, piece in marks:
        x, y, end_x, end_y = piece.ends()
        if before and before[0] is paint and math.isclose(before[1], x) and math.isclose(before[2], y):
            strokes[-1]["path"].append((end_x, end_y))
        else:
            stroke: StrokeView = {
                "path": [(x, y), (end_x, end_y)],
                "width": 2 * paint.half,
                "grey": round(paint.grey),
            }
            if paint.ink:
                stroke["ink"] = True
            strokes.append(stroke)
        before = paint, end_x, end_y
    return strokes


def pack_poses(
    time: float,
    robots: Iterable[tuple[float, float, float, bool, bool, bool, float, Sequence[float], Sequence[float]]],
    solids: Iterable[tuple[float, float, float]] = (),
) -> bytes:
    """Pack poses into the buffer of a `FrameMessage`.

    Little endian: the world's time as float64, then float32: for each robot x, y (m), theta (rad), flags,
    speed (m/s), its light values, its distances (m, inf for nothing); then for each solid that can move,
    pushed or by itself, in the order of the world, x, y, theta. The page knows their number from the world.
    """
    numbers: list[float] = []
    for x, y, theta, bumper, pen, lamp, speed, lights, distances in robots:
        numbers += [x, y, theta, float(bumper | pen << 1 | lamp << 2), speed, *lights, *distances]
    for solid in solids:
        numbers += solid
    return struct.pack(f"<d{len(numbers)}f", time, *numbers)

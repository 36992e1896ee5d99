"""Transforms between frames, as tf publishes them: a tree, and where a frame is in another one (REP 105).

Nothing is waited for or interpolated: of each transform, the newest counts.

Paper: §7.1 (what arrives on a topic is read from `robot`).
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from lrp_jupyter.bridges.member_tree import AgeLimit
from lrp_jupyter.bridges.ros.rhythm import Motion, Rhythm
from lrp_jupyter.errors import BridgeError, NoDataYet, StaleData, did_you_mean

TRANSFORMS = "tf2_msgs/TFMessage"
"""The type of the messages."""

TF_TOPICS = ("tf", "tf_static")
"""The topics that have it, below the namespace of a robot."""

_SMALL = 0.01  # by which the length of a quaternion may differ from 1
_LATELY = 1.0  # seconds for which what a program has asked for counts
_SHOWN = 20  # frames that a sentence lists
_RESTS = Motion()  # of a robot that never moves


class Translation(NamedTuple):
    """Metres along the axes."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


class Rotation(NamedTuple):
    """A quaternion of length 1."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 1.0

    def times(self, other: Rotation) -> Rotation:
        """Return the rotation by the other one, then by this one."""
        x, y, z, w = self
        a, b, c, d = other
        return Rotation(
            w * a + x * d + y * c - z * b,
            w * b - x * c + y * d + z * a,
            w * c + x * b - y * a + z * d,
            w * d - x * a - y * b - z * c,
        )

    def inverse(self) -> Rotation:
        """Return the rotation back."""
        return Rotation(-self.x, -self.y, -self.z, self.w)

    def turned(self, way: Translation) -> Translation:
        """Return a vector, turned."""
        return Translation(*self.times(Rotation(*way, 0.0)).times(self.inverse())[:3])

    @property
    def yaw(self) -> float:
        """The angle about the vertical axis, in radians."""
        x, y, z, w = self
        return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


class _Pose(NamedTuple):
    """Where a frame is in another one."""

    translation: Translation = Translation()
    rotation: Rotation = Rotation()

    def times(self, other: _Pose) -> _Pose:
        """Return where the other's frame is, if the other is where it is in this one's frame."""
        there = self.rotation.turned(other.translation)
        way = Translation(*(one + two for one, two in zip(self.translation, there, strict=True)))
        return _Pose(way, self.rotation.times(other.rotation))

    def inverse(self) -> _Pose:
        """Return where the other frame is in this one."""
        back = self.rotation.inverse()
        x, y, z = back.turned(self.translation)
        return _Pose(Translation(-x, -y, -z), back)


@dataclass(frozen=True, slots=True)
class Transform:
    """Where a frame is in another one.

    Attributes
    ----------
    x, y : float
        In metres.
    yaw : float
        The heading, in radians, to the left of the x axis.
    translation : Translation
        With `x`, `y`, `z`, as in ``geometry_msgs/Transform``.
    rotation : Rotation
        A quaternion, with `x`, `y`, `z`, `w`.
    age : float
        Seconds since the oldest of its parts arrived; 0 if it consists of static ones.
    """

    x: float
    y: float
    yaw: float
    translation: Translation
    rotation: Rotation
    age: float


class _Link(NamedTuple):
    """The newest transform of a frame: where it is in its parent, and when that arrived."""

    frame: str
    parent: str
    pose: _Pose
    at: float
    rhythm: Rhythm | None  # of one that moves; None: it is static


LimitOf = Callable[[Rhythm], AgeLimit]
"""Returns from which age on what comes in a rhythm is too old."""


class TransformTree:
    """The newest transform of every frame.

    Owner: any thread puts and reads; the interpreter's thread latches.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._links: Mapping[str, _Link] = {}  # by their frames; always replaced, never changed
        self._latched: Mapping[str, _Link] = {}
        self._asked: dict[str, float] = {}  # the frames on the ways that ticks have asked for, and when

    def put(self, message: Any, at: float, is_static: bool, motion: Motion = _RESTS) -> None:
        """Take the transforms of a message; ValueError: one of them is none, and the others are taken.

        `motion`: of the robot, with which transforms may cease.
        """
        wrong, found = "", dict[str, _Link]()
        with self._lock:
            for each in message.transforms:
                frame, parent = _frame(each.child_frame_id), _frame(each.header.frame_id)
                pose = _pose_of(each.transform)
                if pose is None or not frame or not parent or frame == parent:
                    wrong = f"that of `{frame}` in `{parent}` is not a transform"
                else:
                    before = self._links.get(frame)
                    rhythm = None if is_static else (before and before.rhythm) or Rhythm()
                    if rhythm is not None:
                        rhythm.note(at, has_reason=motion.excused(rhythm.last) > 0)
                    found[frame] = _Link(frame, parent, pose, at, rhythm)
            self._links = {**self._links, **found}
        if wrong:
            raise ValueError(wrong)

    def forget(self, is_static: bool) -> None:
        """Forget the static transforms, or all others."""
        with self._lock:
            self._links = {
                name: each for name, each in self._links.items() if (each.rhythm is None) != is_static
            }

    def interrupt(self) -> None:
        """Count the silence that begins as no pause of the transforms."""
        for each in self._links.values():
            if each.rhythm is not None:
                each.rhythm.interrupt()

    def latch(self) -> None:
        """Hold what there is for the tick that begins."""
        self._latched = self._links

    def oldest(self, now: float, limit_of: LimitOf) -> tuple[float, AgeLimit]:
        """Return the age, and its limit, of what was asked for lately and is too old, or nearest to that."""
        links = [self._links.get(frame) for frame, at in self._asked.items() if now - at < _LATELY]
        known = [(max(0.0, now - each.at), limit_of(each.rhythm)) for each in links if each and each.rhythm]

        def excess(one: tuple[float, AgeLimit]) -> tuple[float, float]:
            age, most = one[0], one[1].seconds
            return -math.inf if most is None else age - most, age

        return max(known, key=excess, default=(0.0, AgeLimit(None)))

    def lookup(
        self,
        target: str,
        source: str,
        now: float,
        in_tick: bool,
        limit_of: LimitOf = lambda _: AgeLimit(None),
    ) -> Transform:
        """Return where the source frame is in the target frame.

        `now`: in the time in which messages arrived.
        Raises NoDataYet: that is not known; StaleData: a part of it is too old.
        """
        links = self._latched if in_tick else self._links
        known = dict.fromkeys([*links, *(each.parent for each in links.values())])
        target, source = _frame(target), _frame(source)
        for frame in (target, source):
            if frame not in known:
                raise NoDataYet(_unknown(frame, known))
        up, down = _Way.to_the_root(links, source), _Way.to_the_root(links, target)
        if up.frames[-1] != down.frames[-1]:
            raise NoDataYet(
                f"No transform connects `{target}` and `{source}`: one between `{down.frames[-1]}` and"
                f" `{up.frames[-1]}` is missing, known are {_chain(up.frames)}; {_chain(down.frames)}."
            )
        while up.links and down.links and up.links[-1] is down.links[-1]:
            up, down = up.shorter(), down.shorter()
        way = down.pose().inverse().times(up.pose())
        moving = [each for each in (*up.links, *down.links) if each.rhythm is not None]
        if in_tick:
            self._asked |= {each.frame: now for each in moving}
        for link in moving:
            if late := _lateness(link, now, limit_of):
                raise StaleData(late)
        age = max((max(0.0, now - link.at) for link in moving), default=0.0)
        translation, rotation = way
        return Transform(translation.x, translation.y, rotation.yaw, translation, rotation, age)


class _Way(NamedTuple):
    """The way from a frame up to another one."""

    frames: tuple[str, ...]
    links: tuple[_Link, ...]

    @staticmethod
    def to_the_root(links: Mapping[str, _Link], frame: str) -> _Way:
        """Return the way to the last frame; BridgeError: it goes round."""
        frames, passed = [frame], []
        while (link := links.get(frames[-1])) is not None:
            frames.append(link.parent)
            passed.append(link)
            if link.parent in frames[:-1]:
                raise BridgeError(f"The transforms go round in a circle: {_chain(frames)}.")
        return _Way(tuple(frames), tuple(passed))

    def shorter(self) -> _Way:
        """Return the way without its last step."""
        return self._replace(frames=self.frames[:-1], links=self.links[:-1])

    def pose(self) -> _Pose:
        """Return where the first frame is in the last one."""
        found = _Pose()
        for link in self.links:
            found = link.pose.times(found)
        return found


def _lateness(link: _Link, now: float, limit_of: LimitOf) -> str:
    """Return that a transform is too old, in a sentence, or an empty text."""
    assert link.rhythm is not None
    age, (most, measured) = now - link.at, limit_of(link.rhythm)
    if most is None or age <= most:
        return ""
    return f"That of `{link.frame}` in `{link.parent}` is stale: it is {age:.1f} s old. {measured}".rstrip()


def _frame(name: str) -> str:
    """Return the name of a frame as tf2 has it: some nodes still write a slash before it."""
    return name.removeprefix("/")


def _pose_of(raw: Any) -> _Pose | None:
    """Return the pose in a message; None if it has no finite numbers, or its quaternion does not rotate."""
    way, turn = raw.translation, raw.rotation
    numbers = (way.x, way.y, way.z, turn.x, turn.y, turn.z, turn.w)
    length = math.hypot(*numbers[3:])
    if not (all(map(math.isfinite, numbers)) and abs(length - 1) < _SMALL):
        return None
    return _Pose(Translation(*numbers[:3]), Rotation(*(each / length for each in numbers[3:])))


def _unknown(frame: str, known: Mapping[str, None]) -> str:
    if not known:
        return "No transform has arrived yet."
    names = ", ".join(f"`{each}`" for each in sorted(known)[:_SHOWN])
    more = f" and {len(known) - _SHOWN} more" if len(known) > _SHOWN else ""
    return f"There is no frame `{frame}`; there are {names}{more}.{did_you_mean(frame, known)}"


def _chain(frames: tuple[str, ...] | list[str]) -> str:
    return " in ".join(f"`{each}`" for each in frames)

"""A run of a world as an animated SVG, which repeats by itself: text only, drawn like the still picture.

Everything that moves is sampled and kept as few key frames, between which a viewer interpolates (SMIL). At
every sampled time the picture is true within `WITHIN` metres and `TURNED` degrees.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import pairwise
from typing import Any

from lrp_jupyter.sim import svg_shapes as shapes
from lrp_jupyter.sim.floor import Mark
from lrp_jupyter.sim.sim_robot import SimRobot
from lrp_jupyter.sim.simulation import STEPS_PER_SECOND, Simulation
from lrp_jupyter.sim.svg import framed, in_metres, joined, scaled, speech_of, zone_name
from lrp_jupyter.sim.svg_shapes import num
from lrp_jupyter.sim.world import Point

EVERY = 5  # steps between two samples
WITHIN = 0.002  # m
TURNED = 1.0  # degrees
_FAR = 0.01  # m, of what distance sensors see
_SHADE = 12  # greys, of what light sensors see
_ROUNDED = 0.75  # of a tolerance, so that rounding the numbers does not exceed it
_HOLD = 1.0  # s: the last picture stands before the next round


def animated(run: Iterable[Simulation], width: int = 640) -> str:
    """Return the animated picture of a run.

    `run`: one simulation that goes through the run: :meth:`Simulation.repeated` with every `EVERY` steps.
    `width`: pixels; the height follows from the world.
    """
    film = _Film()
    for simulation in run:
        film.add(simulation)
    return film.svg(width)


@dataclass(slots=True)
class _Series:
    """What has changed with time: seconds, and numbers; two of one time are a jump."""

    times: list[float] = field(default_factory=list)
    values: list[tuple[float, ...]] = field(default_factory=list)

    def add(self, time: float, *value: float) -> None:
        self.times.append(time)
        self.values.append(value)

    def simplified(self, tolerance: float) -> _Series:
        """Return the key frames between which a straight line is never farther away than the tolerance."""
        kept = sorted(_keys(self.times, self.values, tolerance * _ROUNDED))
        return _Series([self.times[i] for i in kept], [self.values[i] for i in kept])


def _keys(times: Sequence[float], values: Sequence[tuple[float, ...]], tolerance: float) -> set[int]:
    jumps = [i for i in range(1, len(times)) if times[i] == times[i - 1]]
    kept = {0, len(times) - 1, *jumps, *(i - 1 for i in jumps)}
    ends = sorted(kept)
    open_ranges = list(pairwise(ends))
    while open_ranges:
        first, last = open_ranges.pop()
        if last - first < 2:
            continue
        begin, span = times[first], times[last] - times[first]
        start, way = values[first], [b - a for a, b in zip(values[first], values[last], strict=True)]
        worst, farthest = tolerance, 0
        for i in range(first + 1, last):
            share = (times[i] - begin) / span
            off = math.hypot(*(v - s - share * w for v, s, w in zip(values[i], start, way, strict=True)))
            if off > worst:
                worst, farthest = off, i
        if farthest:
            kept.add(farthest)
            open_ranges += [(first, farthest), (farthest, last)]
    return kept


@dataclass(slots=True)
class _Thing:
    """Something that is drawn, while it is there."""

    drawn: str
    place: _Series = field(default_factory=_Series)
    turn: _Series = field(default_factory=_Series)
    seen: list[tuple[float, bool]] = field(default_factory=list)


@dataclass(slots=True)
class _Senses:
    robot: SimRobot
    place: _Series = field(default_factory=_Series)
    turn: _Series = field(default_factory=_Series)
    pressed: _Series = field(default_factory=_Series)
    said: list[tuple[str, list[tuple[float, bool]]]] = field(
        default_factory=list
    )  # bubbles, and when they are
    lights: list[_Series] = field(init=False)
    ways: list[_Series] = field(init=False)
    _text: str = ""

    def __post_init__(self) -> None:
        self.lights = [_Series() for _ in self.robot.spec.light]
        self.ways = [_Series() for _ in self.robot.spec.distance]

    def add(self, time: float, last_step: int, simulation: Simulation) -> None:
        """Add what the robot senses and says now; the bumper is pressed if it was since the last step."""
        robot = self.robot
        x, y, angle = robot.pose
        self.place.add(time, x, y)
        self.turn.add(time, math.degrees(angle))
        self.pressed.add(time, int(robot.memory.pressed_at > last_step))
        for series, level in zip(self.lights, robot.readings.lights, strict=False):
            series.add(time, level)
        for series, way in zip(self.ways, robot.readings.distances, strict=False):
            series.add(time, way)
        if (text := simulation.said(robot.index)) != self._text:
            if self._text:
                self.said[-1][1].append((time, False))
            if text:
                self.said.append((speech_of(simulation, robot), [(time, True)]))
            self._text = text


class _Film:
    """Collects what a run looks like."""

    def __init__(self) -> None:
        self.things: dict[Hashable, _Thing] = {}
        self.robots: list[_Senses] = []
        self.floors: list[tuple[list[Mark], float, float]] = []  # marks, from when, until when
        self.begin = self.end = 0.0
        self.times: list[float] = []

    def add(self, simulation: Simulation) -> None:
        time = simulation.time
        if not self.times:
            self.begin = time
            self.robots = [_Senses(robot) for robot in simulation.robots]
        last_step = round(self.times[-1] * STEPS_PER_SECOND) if self.times else simulation.steps - 1
        self.end, self.simulation = time, simulation
        self.times.append(time)
        marks = simulation.floor.marks
        if not self.floors or self.floors[-1][0] is not marks:
            self.floors.append((marks, time, time))
        self.floors[-1] = (marks, self.floors[-1][1], time)
        world = simulation.world
        present: set[Hashable] = set()

        def there(key: Hashable, draw: Callable[..., str], *shape: Any) -> _Thing:
            while key in present:
                key = (key, "again")
            present.add(key)
            if key not in self.things:
                self.things[key] = _Thing(draw(*shape))
            thing = self.things[key]
            if not thing.seen or not thing.seen[-1][1]:
                thing.seen.append((time, True))
            return thing

        for stroke in world.floor.strokes:
            there(stroke, shapes.stroke, stroke)
        for name, zone in world.zones.items():
            there((name, zone), shapes.zone, zone)
        for each in simulation.solids:
            if each.patrol:
                there(each.patrol, shapes.patrol, each.patrol)
        for each in simulation.solids:
            thing = there(each.spec, shapes.solid, each.spec)
            x, y, angle = each.pose
            thing.place.add(time, x, y)
            thing.turn.add(time, math.degrees(angle))
        for key, thing in self.things.items():
            if key not in present and thing.seen[-1][1]:
                thing.seen.append((time, False))
        for senses in self.robots:
            senses.add(time, last_step, simulation)

    # -- drawing --------------------------------------------------------------------------------

    def svg(self, width: int) -> str:
        world = self.simulation.world
        tall, scale = scaled(world, width)
        solids = [thing for thing in self.things.values() if thing.place.times]
        below = [thing for thing in self.things.values() if not thing.place.times]
        inside = [
            *(self._while_there(thing) for thing in below),
            *self._ink(),
            *(track for senses in self.robots for track in self._track(senses)),
            *(self._moved(thing.place, thing.turn, self._while_there(thing)) for thing in solids),
            *(self._robot(senses) for senses in self.robots),
        ]
        over = [
            *(zone_name(name, zone, tall, scale) for name, zone in world.zones.items()),
            *(in_metres(self._speech(senses), tall, scale) for senses in self.robots if senses.said),
        ]
        title = f"{world.name or 'World'} · {self.begin:.1f} to {self.end:.1f} s"
        bar = self._animate("width", _Series([self.begin, self.end], [(0.0,), (width - 2.0,)]), num)
        caption = (
            f'<rect x="1" y="{num(tall)}" height="3" width="{width - 2}" fill="#1F78B4">{bar}</rect>'
            f'<text class="lrp-world-text" x="4" y="{num(tall + 19)}">{escape(title)}</text>'
        )
        sentence = (
            f"World {world.name or 'without a name'} from {self.begin:.1f} to {self.end:.1f} s, animated"
        )
        return framed(world, width, sentence, inside, over, caption)

    def _robot(self, senses: _Senses) -> str:
        robot = senses.robot
        spec = robot.spec
        rays = [self._ray(senses, index) for index in range(len(spec.distance))]
        above = []
        for index, place in enumerate(spec.light):
            levels = _steps(senses.lights[index], _SHADE)
            moving = self._animate("fill", levels, shapes.grey, True)
            above.append(shapes.light(place, levels.values[0][0] if levels.values else 255, moving))
        if spec.bumper:
            looks = (shapes.CALM, shapes.BUMP)
            moving = "".join(
                self._animate(
                    name, senses.pressed, lambda pressed, part=part: looks[round(pressed)][part], True
                )
                for part, name in enumerate(("stroke", "stroke-width"))
            )
            above.append(shapes.bumper(spec, bool(senses.pressed.values[0][0]), moving))
        drawn = shapes.robot(spec, robot.index, "".join(rays), "".join(above))
        names = self.simulation.world.robot_names
        label = shapes.name_of(names[robot.index], spec, robot.index) if len(names) > 1 else ""
        return self._moved(senses.place, senses.turn, drawn, label)

    def _speech(self, senses: _Senses) -> str:
        said = "".join(_group(self._visible(seen), speech) for speech, seen in senses.said)
        return self._placed(senses.place, said)

    def _ray(self, senses: _Senses, index: int) -> str:
        """Draw a ray, hidden while it hits nothing."""
        spec, ways = senses.robot.spec, senses.ways[index]
        seen = [(time, math.isfinite(way)) for time, (way,) in zip(ways.times, ways.values, strict=True)]
        if not any(is_seen for _, is_seen in seen):
            return ""
        bearing, reach = spec.distance[index]
        finite = _Series(ways.times, [(min(way, reach),) for (way,) in ways.values]).simplified(_FAR)

        def end(way: float) -> str:
            return num(spec.radius + way)

        line, dot = self._animate("x2", finite, end), self._animate("cx", finite, end)
        return shapes.ray(spec, bearing, finite.values[0][0], (self._visible(seen), line, dot))

    def _ink(self) -> Iterator[str]:
        """Draw the trails of pens as they came about."""
        for marks, begin, end in self.floors:
            seen = [(begin, True), (end, end == self.end)]
            for paint, points, steps in joined(marks):
                way = _Series([step / STEPS_PER_SECOND for step in steps], [*points])
                if (growing := self._growing(way.simplified(WITHIN))) is not None:
                    extra, points, moving = growing
                    drawn = shapes.ink(paint, points, extra, moving)
                    yield drawn if seen[1][1] else _group(self._visible(seen), drawn)

    def _track(self, senses: _Senses) -> Iterator[str]:
        """Draw the way of a robot as it came about, in the same key frames as the robot."""
        place, pieces = senses.place.simplified(WITHIN), [_Series()]
        for time, value in zip(place.times, place.values, strict=True):
            if pieces[-1].times and pieces[-1].times[-1] == time:  # a jump
                pieces.append(_Series())
            pieces[-1].add(time, *value)
        for piece in pieces:
            if (growing := self._growing(piece)) is not None:
                extra, points, moving = growing
                yield shapes.track(points, senses.robot.index, extra, moving)

    def _growing(self, way: _Series) -> tuple[str, list[Point], str] | None:
        """Return the dashes with which a line grows, its points, and how the dashes move; None for a dot."""
        points = [(round(x, 4), round(y, 4)) for x, y in way.values]
        lengths = [0.0]
        for one, other in pairwise(points):
            lengths.append(lengths[-1] + math.dist(one, other))
        total = lengths[-1]
        if total == 0:
            return None
        if way.times[-1] <= self.begin:
            return "", points, ""
        left = _Series(
            [max(self.begin, time) for time in way.times], [(total - length,) for length in lengths]
        )
        whole = num(total + 0.001)
        return f' stroke-dasharray="{whole} {whole}"', points, self._animate("stroke-dashoffset", left, num)

    def _moved(self, place: _Series, turn: _Series, drawn: str, upright: str = "") -> str:
        inner = self._transform("rotate", turn.simplified(TURNED), lambda angle: f"{angle:.1f}", drawn)
        return self._placed(place, inner + upright)

    def _placed(self, place: _Series, drawn: str) -> str:
        return self._transform("translate", place.simplified(WITHIN), lambda x, y: f"{x:.3f} {y:.3f}", drawn)

    def _transform(self, kind: str, series: _Series, write: Callable[..., str], drawn: str) -> str:
        moving = self._animate("transform", series, write, kind=kind)
        if moving:
            return _group(moving, drawn)
        value = write(*series.values[0])
        return drawn if value == "0.0" else f'<g transform="{kind}({value})">{drawn}</g>'

    def _while_there(self, thing: _Thing) -> str:
        return _group(self._visible(thing.seen), thing.drawn)

    def _visible(self, seen: Sequence[tuple[float, bool]]) -> str:
        """Return what hides a thing where it is not there; nothing if it is always there."""
        changes = _Series()
        if seen[0][0] > self.begin:
            changes.add(self.begin, 0)
        for time, is_seen in seen:
            if not changes.values or changes.values[-1] != (int(is_seen),):
                changes.add(time, int(is_seen))
        if changes.values == [(1,)]:
            return ""
        return self._animate("visibility", changes, lambda is_seen: "visible" if is_seen else "hidden", True)

    def _animate(
        self,
        attribute: str,
        series: _Series,
        write: Callable[..., str],
        is_discrete: bool = False,
        kind: str = "",
    ) -> str:
        """Return an element that moves an attribute; nothing if that has one value only."""
        total = self.end - self.begin + _HOLD
        texts = [write(*value) for value in series.values]
        if len({*texts}) < 2:
            return ""
        digits = 3 + max(0, math.ceil(math.log10(total)))  # to a millisecond
        times = [_share((time - self.begin) / total, digits) for time in series.times]
        if times[0] != "0":
            times, texts = ["0", *times], [texts[0], *texts]
        if is_discrete:
            kept = [i for i in range(len(texts)) if i == 0 or texts[i] != texts[i - 1]]
            times, texts = [times[i] for i in kept], [texts[i] for i in kept]
        else:
            times, texts = [*times, "1"], [*texts, texts[-1]]
        element, type_ = ("animateTransform", f' type="{kind}"') if kind else ("animate", "")
        mode = ' calcMode="discrete"' if is_discrete else ""
        return (
            f'<{element} attributeName="{attribute}"{type_}{mode} dur="{num(total)}s" '
            f'repeatCount="indefinite" keyTimes="{";".join(times)}" values="{";".join(texts)}"/>'
        )


def _steps(series: _Series, least: float) -> _Series:
    """Return the values that differ from the one before by as much as that."""
    kept = _Series()
    for time, value in zip(series.times, series.values, strict=True):
        if not kept.values or abs(value[0] - kept.values[-1][0]) >= least:
            kept.add(time, *value)
    return kept


def _group(moving: str, drawn: str) -> str:
    return f"<g>{moving}{drawn}</g>" if moving else drawn


def _share(share: float, digits: int) -> str:
    return f"{share:.{digits}f}".rstrip("0").rstrip(".").removeprefix("0") or "0"

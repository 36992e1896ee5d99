"""A picture of a world as SVG: self-contained, legible on light and dark pages."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape

from lrp_jupyter.sim.robot import BAR, BAR_HALF, WHEELBASE, SimRobot
from lrp_jupyter.sim.sensors import light_spots
from lrp_jupyter.sim.simulation import Simulation
from lrp_jupyter.sim.world import (
    ArcStroke,
    BoxSolid,
    BoxZone,
    CircleStroke,
    Point,
    Solid,
    Stroke,
    World,
    Zone,
)

__all__ = ["svg"]

_CAPTION = 26  # px
_SMALL = (
    'font-family="system-ui,sans-serif" font-size="10" stroke="#fff" stroke-width="3" stroke-opacity="0.8" '
    'paint-order="stroke"'
)
_WAYS = (("#E31A1C", "none"), ("#33A02C", "0.05 0.02"), ("#FF7F00", "0.02 0.02"), ("#6A3D9A", "0.08 0.02"))
_FIXED, _PUSHABLE, _MOVING = ("#646d77", "#4b525a"), ("#d9a566", "#8a5a1f"), ("#8fc7c3", "#2b7a75")
_STYLE = """
.lrp-world-text{font:12px system-ui,sans-serif;fill:#5f6770}
.lrp-world-edge{fill:none;stroke:#9aa1a9;stroke-width:1.5}
@media (prefers-color-scheme:dark){.lrp-world-text{fill:#ddd}}
"""


def svg(
    world: Simulation | World,
    width: int = 640,
    caption: bool = True,
    ways: Mapping[str, Sequence[Point]] | None = None,
) -> str:
    """Return a picture of a running world as it is now, or of a description at its start.

    Parameters
    ----------
    world : Simulation or World
    width : int
        Pixels; the height follows from the world.
    caption : bool
        Whether to write time and readings below.
    ways : mapping of str to sequence of (x, y)
        Ways of other runs, in metres, by the names that are written at their ends.
    """
    ways = {name: way for name, way in (ways or {}).items() if way}
    simulation = world if isinstance(world, Simulation) else Simulation(world)
    length, depth = simulation.world.size
    scale = (width - 2) / length
    tall = depth * scale + 2
    below = _CAPTION if caption else 0
    frame = f'x="1" y="1" width="{width - 2}" height="{_n(tall - 2)}" rx="4"'
    clip = f"lrp-world-clip-{width}-{round(tall)}"  # pictures of one page share their ids
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {_n(tall + below)}" width="{width}" '
        f'role="img" aria-label="{escape(_sentence(simulation), quote=True)}">',
        f"<style>{_STYLE}</style>",
        f'<clipPath id="{clip}"><rect {frame}/></clipPath>',
        f'<g clip-path="url(#{clip})">',
        f'<g transform="translate(1 {_n(tall - 1)}) scale({_n(scale)} {_n(-scale)})">',
        f'<rect width="{_n(length)}" height="{_n(depth)}" fill="{_grey(simulation.floor.grey)}"/>',
        *(_zone(zone) for zone in simulation.world.zones.values()),
        *(_stroke(stroke) for stroke in simulation.world.floor.strokes),
        *_marks(simulation),
        *_track(simulation),
        *(_way(name, way, number) for number, (name, way) in enumerate(ways.items())),
        *(_patrol(thing.patrol) for thing in simulation.solids if thing.patrol),
        *(_solid(thing.here()) for thing in simulation.solids),
        *(_robot(robot) for robot in simulation.robots),
        "</g>",
        *(_label(name, zone, tall, scale) for name, zone in simulation.world.zones.items()),
        *(_value(robot, tall, scale) for robot in simulation.robots),
        *(_way_name(name, way[-1], number, tall, scale) for number, (name, way) in enumerate(ways.items())),
        "</g>",
        f'<rect class="lrp-world-edge" {frame}/>',
        _ruler(width, tall, scale),
        _caption(simulation, tall) if caption else "",
        "</svg>",
    ]
    return "\n".join(part for part in parts if part)


def _sentence(simulation: Simulation) -> str:
    x, y, heading = simulation.robot.pose
    return (
        f"World {simulation.world.name or 'without a name'} at {simulation.time:.1f} s: robot at "
        f"{x:.2f}, {y:.2f} m, heading {math.degrees(heading) % 360:.0f}°; {_readings(simulation)}"
    )


def _readings(simulation: Simulation) -> str:
    readings = simulation.robot.readings
    words = [f"light {' '.join(map(str, readings.lights))}"] if readings.lights else []
    if simulation.robot.spec.bumper:
        words.append("bumper pressed" if readings.bumper else "bumper free")
    if readings.distances:
        ways = ("∞" if math.isinf(way) else f"{way:.2f}" for way in readings.distances)
        words.append(f"distance {' '.join(ways)} m")
    return " · ".join(words)


def _caption(simulation: Simulation, tall: float) -> str:
    time = f"{simulation.time:.1f} s"
    title = f"{simulation.world.name} · {time}" if simulation.world.name else time
    return (
        f'<text class="lrp-world-text" x="4" y="{_n(tall + 17)}">'
        f'<tspan font-weight="600">{escape(title)}</tspan>'
        f'<tspan dx="14">{escape(_readings(simulation))}</tspan></text>'
    )


def _ruler(width: int, tall: float, scale: float) -> str:
    right, base, long = width - 10, tall - 10, scale / 2
    middle = f'x="{_n(right - long / 2)}" y="{_n(base - 4)}" text-anchor="middle"'
    return (
        f'<path d="M{_n(right - long)} {_n(base - 4)}v4H{right}v-4" class="lrp-world-edge"/>'
        f'<text {middle} {_SMALL} fill="#777">0.5 m</text>'
    )


def _zone(zone: Zone) -> str:
    style = (
        'fill="#33A02C" fill-opacity="0.07" stroke="#33A02C" stroke-width="0.006" stroke-opacity="0.7" '
        'stroke-dasharray="0.03 0.02"'
    )
    if isinstance(zone, BoxZone):
        x, y, width, height = zone.box
        corner = f'x="{_n(x - width / 2)}" y="{_n(y - height / 2)}"'
        return f'<rect {corner} width="{_n(width)}" height="{_n(height)}" {style}/>'
    x, y, radius = zone.circle
    return f'<circle cx="{_n(x)}" cy="{_n(y)}" r="{_n(radius)}" {style}/>'


def _label(name: str, zone: Zone, tall: float, scale: float) -> str:
    x, y = zone.box[:2] if isinstance(zone, BoxZone) else zone.circle[:2]
    up = zone.box[3] / 2 if isinstance(zone, BoxZone) else zone.circle[2]
    return (
        f'<text x="{_n(1 + x * scale)}" y="{_n(tall - 1 - (y + up) * scale + 12)}" text-anchor="middle" '
        f'{_SMALL} fill="#257a20">{escape(name)}</text>'
    )


def _stroke(stroke: Stroke) -> str:
    style = (
        f'fill="none" stroke="{_grey(stroke.grey)}" stroke-width="{_n(stroke.width)}" '
        'stroke-linecap="round" stroke-linejoin="round"'
    )
    if isinstance(stroke, CircleStroke):
        x, y, radius = stroke.circle
        return f'<circle cx="{_n(x)}" cy="{_n(y)}" r="{_n(radius)}" {style}/>'
    if isinstance(stroke, ArcStroke):
        x, y, radius, first, last = stroke.arc
        turns = max(1, math.ceil(abs(last - first) / 3))  # an SVG arc is shorter than a full turn
        angles = [first + (last - first) * turn / turns for turn in range(turns + 1)]
        ends = [(x + radius * math.cos(angle), y + radius * math.sin(angle)) for angle in angles]
        sweep = int(last > first)
        arcs = "".join(f"A{_n(radius)} {_n(radius)} 0 0 {sweep} {_n(px)} {_n(py)}" for px, py in ends[1:])
        return f'<path d="M{_n(ends[0][0])} {_n(ends[0][1])}{arcs}" {style}/>'
    return f'<path d="{_path(stroke.path)}" {style}/>'


def _marks(simulation: Simulation) -> list[str]:
    """Draw trails and drawings, the pieces of each stroke joined."""
    strokes: list[str] = []
    path: list[Point] = []
    marks = simulation.floor.marks
    for index, (_, paint, piece) in enumerate(marks):
        x, y, end_x, end_y = piece.ends()
        path = path or [(x, y)]
        path.append((end_x, end_y))
        following = marks[index + 1] if index + 1 < len(marks) else None
        if following is None or following[1] is not paint or following[2].ends()[:2] != (end_x, end_y):
            blend = ' style="mix-blend-mode:darken"' if paint.ink else ""
            strokes.append(
                f'<path d="{_path(tuple(path))}" fill="none" stroke="{_grey(paint.grey)}" '
                f'stroke-width="{_n(2 * paint.half)}" stroke-linecap="round" stroke-linejoin="round"{blend}/>'
            )
            path = []
    return strokes


def _track(simulation: Simulation) -> list[str]:
    """Draw where the robots have been, at most some hundred points each."""
    tracks = []
    for robot in simulation.robots:
        points = [(x, y) for _, index, x, y in simulation.track if index == robot.index]
        if len(points) > 1:
            tracks.append(
                f'<path d="{_path(_thinned([*points, robot.pose[:2]]))}" fill="none" stroke="#1F78B4" '
                'stroke-width="0.008" stroke-opacity="0.55" stroke-linejoin="round"/>'
            )
    return tracks


def _way(name: str, way: Sequence[Point], number: int) -> str:
    """Draw the way of another run, with a dot at its end."""
    colour, dashes = _WAYS[number % len(_WAYS)]
    x, y = way[-1]
    return (
        f'<g><title>{escape(name)}</title><path d="{_path(_thinned(way))}" fill="none" stroke="{colour}" '
        f'stroke-width="0.012" stroke-dasharray="{dashes}" stroke-linejoin="round"/>'
        f'<circle cx="{_n(x)}" cy="{_n(y)}" r="0.025" fill="{colour}"/></g>'
    )


def _way_name(name: str, end: Point, number: int, tall: float, scale: float) -> str:
    x, y = 1 + end[0] * scale, tall - 1 - end[1] * scale
    colour = _WAYS[number % len(_WAYS)][0]
    place = f'x="{_n(x + 8)}" y="{_n(y + 18)}"'
    return f'<text {place} {_SMALL} font-weight="600" fill="{colour}">{escape(name)}</text>'


def _patrol(points: tuple[Point, ...]) -> str:
    return (
        f'<path d="{_path(points)}" fill="none" stroke="{_MOVING[1]}" stroke-width="0.006" '
        'stroke-dasharray="0.006 0.02" stroke-linecap="round" stroke-linejoin="round"/>'
    )


def _solid(solid: Solid) -> str:
    fill, edge = _MOVING if solid.patrol is not None else _FIXED if solid.push is None else _PUSHABLE
    style = f'fill="{fill}" stroke="{edge}" stroke-width="0.008"'
    turn = f" rotate({_n(math.degrees(solid.angle))})" if solid.angle else ""
    if not isinstance(solid, BoxSolid):
        x, y, radius = solid.circle
        return f'<circle cx="{_n(x)}" cy="{_n(y)}" r="{_n(radius - 0.004)}" {style}/>'
    x, y, width, height = solid.box
    inner, outer = max(width - 0.008, 0.004), max(height - 0.008, 0.004)
    return (
        f'<rect x="{_n(-inner / 2)}" y="{_n(-outer / 2)}" width="{_n(inner)}" height="{_n(outer)}" '
        f'transform="translate({_n(x)} {_n(y)}){turn}" {style}/>'
    )


def _robot(robot: SimRobot) -> str:
    x, y, heading = robot.pose
    radius, readings = robot.spec.radius, robot.readings
    rays, spots = [], []
    for (bearing, _), way in zip(robot.spec.distance, readings.distances, strict=False):
        if not math.isinf(way):
            cos, sin = math.cos(bearing), math.sin(bearing)
            near, far = radius, radius + way
            rays.append(
                f'<path d="M{_n(cos * near)} {_n(sin * near)}L{_n(cos * far)} {_n(sin * far)}" '
                'stroke="#E31A1C" stroke-width="0.006" stroke-dasharray="0.02 0.015" stroke-opacity="0.8"/>'
                f'<circle cx="{_n(cos * far)}" cy="{_n(sin * far)}" r="0.012" fill="#E31A1C"/>'
            )
    for index, (forward, left) in enumerate(robot.spec.light):
        seen = readings.lights[index] if index < len(readings.lights) else 255
        spots.append(
            f'<circle cx="{_n(forward)}" cy="{_n(left)}" r="0.014" fill="{_grey(seen)}" '
            'stroke="#FF7F00" stroke-width="0.006"/>'
        )
    wheel, half = radius * 0.55, radius * WHEELBASE / 2
    wheels = "".join(
        f'<rect x="{_n(-wheel / 2)}" y="{_n(side * half - radius * 0.11)}" width="{_n(wheel)}" '
        f'height="{_n(radius * 0.22)}" rx="{_n(radius * 0.08)}" fill="#2b3138"/>'
        for side in (-1, 1)
    )
    bar = ""
    if robot.spec.bumper:
        rim = radius + BAR + 0.004
        cos, sin = rim * math.cos(BAR_HALF), rim * math.sin(BAR_HALF)
        colour, thick = ("#E31A1C", 0.02) if readings.bumper else ("#2b3138", 0.011)
        bar = (
            f'<path d="M{_n(cos)} {_n(-sin)}A{_n(rim)} {_n(rim)} 0 0 1 {_n(cos)} {_n(sin)}" fill="none" '
            f'stroke="{colour}" stroke-width="{thick}" stroke-linecap="round"/>'
        )
    corners = ((0.45, 0.0), (-0.3, 0.38), (-0.12, 0.0), (-0.3, -0.38))
    arrow = _path(tuple((radius * ahead, radius * left) for ahead, left in corners)) + "Z"
    return (
        f'<g transform="translate({_n(x)} {_n(y)}) rotate({_n(math.degrees(heading) % 360)})">{"".join(rays)}'
        f'<circle r="{_n(radius - 0.003)}" fill="#A6CEE3" stroke="#1F78B4" stroke-width="0.006"/>{wheels}'
        f'<path d="{arrow}" fill="#1F78B4"/>{"".join(spots)}{bar}</g>'
    )


def _value(robot: SimRobot, tall: float, scale: float) -> str:
    """Write the light values beside their spots, upright."""
    texts = []
    for spot, seen in zip(light_spots(robot.pose, robot.spec.light), robot.readings.lights, strict=False):
        x, y = 1 + spot[0] * scale, tall - 1 - spot[1] * scale
        texts.append(
            f'<text x="{_n(x + 12)}" y="{_n(y - 14)}" {_SMALL} font-weight="600" fill="#b35900">{seen}</text>'
        )
    return "".join(texts)


def _thinned(points: Sequence[Point]) -> tuple[Point, ...]:
    """Return some hundred points of a way at most, its end among them."""
    return (*points[: -1 : max(1, len(points) // 400)], points[-1])


def _path(points: tuple[Point, ...]) -> str:
    path = "".join(f"{'L' if index else 'M'}{_n(x)} {_n(y)}" for index, (x, y) in enumerate(points))
    return path if len(points) > 1 else f"{path}h0"


def _grey(grey: float) -> str:
    return f"#{round(grey):02x}{round(grey):02x}{round(grey):02x}"


def _n(number: float) -> str:
    """Write a number, to a tenth of a millimetre."""
    return f"{number:.4f}".rstrip("0").rstrip(".")

"""A picture of a world as SVG: self-contained, legible on light and dark pages."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape

from lrp_jupyter.sim import svg_shapes as shapes
from lrp_jupyter.sim.floor import Mark, Paint
from lrp_jupyter.sim.sensors import light_spots
from lrp_jupyter.sim.sim_robot import SimRobot
from lrp_jupyter.sim.simulation import Simulation
from lrp_jupyter.sim.svg_shapes import num
from lrp_jupyter.sim.world import BoxZone, Point, Pose, World, Zone, middle_of

_CAPTION = 26  # px
_SMALL = (
    'font-family="system-ui,sans-serif" font-size="10" stroke="#fff" stroke-width="3" stroke-opacity="0.8" '
    'paint-order="stroke"'
)
_WAYS = (("#E31A1C", "none"), ("#33A02C", "0.05 0.02"), ("#FF7F00", "0.02 0.02"), ("#6A3D9A", "0.08 0.02"))
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
    tall, scale = scaled(simulation.world, width)
    inside = [
        *(shapes.zone(zone) for zone in simulation.world.zones.values()),
        *(shapes.stroke(stroke) for stroke in simulation.world.floor.strokes),
        *(shapes.ink(paint, points) for paint, points, _ in joined(simulation.floor.marks)),
        *_track(simulation),
        *(_way(name, way, number) for number, (name, way) in enumerate(ways.items())),
        *(shapes.patrol(thing.patrol) for thing in simulation.solids if thing.patrol),
        *(_placed(shapes.solid(thing.spec), thing.pose) for thing in simulation.solids),
        *(_placed(_robot(robot), robot.pose) for robot in simulation.robots),
        *_names(simulation),
    ]
    over = [
        *(zone_name(name, zone, tall, scale) for name, zone in simulation.world.zones.items()),
        *(_value(robot, tall, scale) for robot in simulation.robots),
        *(_way_name(name, way[-1], number, tall, scale) for number, (name, way) in enumerate(ways.items())),
        *(in_metres(drawn, tall, scale) for drawn in _speeches(simulation)),
    ]
    below = _caption(simulation, tall) if caption else ""
    return framed(simulation.world, width, _sentence(simulation), inside, over, below)


def scaled(world: World, width: int) -> tuple[float, float]:
    """Return the height of the picture of a world without its caption, and the pixels that make a metre."""
    length, depth = world.size
    scale = (width - 2) / length
    return depth * scale + 2, scale


def framed(
    world: World, width: int, sentence: str, inside: Iterable[str], over: Iterable[str], below: str
) -> str:
    """Return the picture of a world, `width` pixels wide, with a sentence that says what it shows.

    `inside` is on the floor, in metres with y up; `over` are texts above it, and `below` the caption, in px.
    """
    (length, depth), (tall, scale) = world.size, scaled(world, width)
    floor = f'<rect width="{num(length)}" height="{num(depth)}" fill="{shapes.grey(world.floor.grey)}"/>'
    frame = f'x="1" y="1" width="{width - 2}" height="{num(tall - 2)}" rx="4"'
    clip = f"lrp-world-clip-{width}-{round(tall)}"  # pictures of one page share their ids
    full = num(tall + (_CAPTION if below else 0))
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {full}" width="{width}" role="img" '
        f'aria-label="{escape(sentence, quote=True)}">',
        f"<style>{_STYLE}</style>",
        f'<clipPath id="{clip}"><rect {frame}/></clipPath>',
        f'<g clip-path="url(#{clip})">',
        in_metres("\n".join((floor, *inside)), tall, scale),
        *over,
        "</g>",
        f'<rect class="lrp-world-edge" {frame}/>',
        _ruler(width, tall, scale),
        below,
        "</svg>",
    ]
    return "\n".join(part for part in parts if part)


def in_metres(drawn: str, tall: float, scale: float) -> str:
    """Draw something in metres, with y up, into a picture of this height and scale."""
    return f'<g transform="translate(1 {num(tall - 1)}) scale({num(scale)} {num(-scale)})">\n{drawn}\n</g>'


def _sentence(simulation: Simulation) -> str:
    x, y, heading = simulation.robot.pose
    says = f" · says “{said}”" if (said := simulation.said()) else ""
    return (
        f"World {simulation.world.name or 'without a name'} at {simulation.time:.1f} s: robot at "
        f"{x:.2f}, {y:.2f} m, heading {math.degrees(heading) % 360:.0f}°; {_readings(simulation)}{says}"
    )


def _readings(simulation: Simulation) -> str:
    readings = simulation.robot.readings
    words = [f"light {' '.join(map(str, readings.lights))}"] if readings.lights else []
    if simulation.robot.spec.bumper:
        words.append("bumper pressed" if readings.bumper else "bumper free")
    if readings.distances:
        ways = ("∞" if math.isinf(way) else f"{way:.2f}" for way in readings.distances)
        words.append(f"distance {' '.join(ways)} m")
    if simulation.robot.memory.lamp:
        words.append("lamp lit")
    return " · ".join(words)


def _caption(simulation: Simulation, tall: float) -> str:
    time = f"{simulation.time:.1f} s"
    title = f"{simulation.world.name} · {time}" if simulation.world.name else time
    return (
        f'<text class="lrp-world-text" x="4" y="{num(tall + 17)}">'
        f'<tspan font-weight="600">{escape(title)}</tspan>'
        f'<tspan dx="14">{escape(_readings(simulation))}</tspan></text>'
    )


def _ruler(width: int, tall: float, scale: float) -> str:
    right, base, long = width - 10, tall - 10, scale / 2
    middle = f'x="{num(right - long / 2)}" y="{num(base - 4)}" text-anchor="middle"'
    return (
        f'<path d="M{num(right - long)} {num(base - 4)}v4H{right}v-4" class="lrp-world-edge"/>'
        f'<text {middle} {_SMALL} fill="#777">0.5 m</text>'
    )


def zone_name(name: str, zone: Zone, tall: float, scale: float) -> str:
    """Write the name of a zone into a picture of this height and scale."""
    x, y = middle_of(zone)
    top = y + (zone.box[3] / 2 if isinstance(zone, BoxZone) else zone.circle[2])
    return (
        f'<text x="{num(1 + x * scale)}" y="{num(tall - 1 - top * scale + 12)}" text-anchor="middle" '
        f'{_SMALL} fill="#257a20">{escape(name)}</text>'
    )


def joined(marks: Sequence[Mark]) -> list[tuple[Paint, list[Point], list[int]]]:
    """Join the pieces of trails: for each stroke its paint, its points, and the steps that drew them."""
    strokes: list[tuple[Paint, list[Point], list[int]]] = []
    for step, paint, piece in marks:
        x, y, end_x, end_y = piece.ends()
        if not strokes or strokes[-1][0] is not paint or strokes[-1][1][-1] != (x, y):
            strokes.append((paint, [(x, y)], [step]))
        strokes[-1][1].append((end_x, end_y))
        strokes[-1][2].append(step)
    return strokes


def _track(simulation: Simulation) -> list[str]:
    """Draw where the robots have been, at most some hundred points each."""
    tracks = []
    for robot in simulation.robots:
        points = [(x, y) for _, index, x, y in simulation.track if index == robot.index]
        if len(points) > 1:
            tracks.append(shapes.track(_thinned([*points, robot.pose[:2]]), robot.index))
    return tracks


def _way(name: str, way: Sequence[Point], number: int) -> str:
    """Draw the way of another run, with a dot at its end."""
    colour, dashes = _WAYS[number % len(_WAYS)]
    x, y = way[-1]
    return (
        f'<g><title>{escape(name)}</title><path d="{shapes.path(_thinned(way))}" fill="none" '
        f'stroke="{colour}" stroke-width="0.012" stroke-dasharray="{dashes}" stroke-linejoin="round"/>'
        f'<circle cx="{num(x)}" cy="{num(y)}" r="0.025" fill="{colour}"/></g>'
    )


def _way_name(name: str, end: Point, number: int, tall: float, scale: float) -> str:
    x, y = 1 + end[0] * scale, tall - 1 - end[1] * scale
    colour = _WAYS[number % len(_WAYS)][0]
    place = f'x="{num(x + 8)}" y="{num(y + 18)}"'
    return f'<text {place} {_SMALL} font-weight="600" fill="{colour}">{escape(name)}</text>'


def _placed(shape: str, pose: Pose) -> str:
    x, y, angle = pose
    turn = f" rotate({num(math.degrees(angle) % 360)})" if angle else ""
    return f'<g transform="translate({num(x)} {num(y)}){turn}">{shape}</g>'


def _names(simulation: Simulation) -> list[str]:
    """Write the names of the robots, if there are several."""
    names = simulation.world.robot_names if len(simulation.robots) > 1 else ()
    return [
        _placed(shapes.name_of(name, robot.spec, robot.index), (*robot.pose[:2], 0.0))
        for name, robot in zip(names, simulation.robots, strict=False)
    ]


def _speeches(simulation: Simulation) -> list[str]:
    """Write what the robots say."""
    said = ((robot, speech_of(simulation, robot)) for robot in simulation.robots)
    return [_placed(drawn, (*robot.pose[:2], 0.0)) for robot, drawn in said if drawn]


def speech_of(simulation: Simulation, robot: SimRobot) -> str:
    """Return what a robot says, drawn around the origin; nothing if it is silent."""
    text = simulation.said(robot.index)
    return shapes.speech(text, robot.spec, robot.index, robot.pose[:2], simulation.world.size) if text else ""


def _robot(robot: SimRobot) -> str:
    spec, readings = robot.spec, robot.readings
    ways = zip(spec.distance, readings.distances, strict=False)
    rays = [shapes.ray(spec, bearing, way) for (bearing, _), way in ways if not math.isinf(way)]
    seen = dict(enumerate(readings.lights))
    above = [shapes.light(place, seen.get(index, 255)) for index, place in enumerate(spec.light)]
    if robot.memory.lamp:
        above.append(shapes.lamp(spec))
    if spec.bumper:
        above.append(shapes.bumper(spec, bool(readings.bumper)))
    return shapes.robot(spec, robot.index, "".join(rays), "".join(above))


def _value(robot: SimRobot, tall: float, scale: float) -> str:
    """Write the light values beside their spots, upright."""
    texts = []
    for spot, seen in zip(light_spots(robot.pose, robot.spec.light), robot.readings.lights, strict=False):
        x, y = 1 + spot[0] * scale, tall - 1 - spot[1] * scale
        place = f'x="{num(x + 12)}" y="{num(y - 14)}"'
        texts.append(f'<text {place} {_SMALL} font-weight="600" fill="#b35900">{seen}</text>')
    return "".join(texts)


def _thinned(points: Sequence[Point]) -> tuple[Point, ...]:
    """Return some hundred points of a way at most, its end among them."""
    return (*points[: -1 : max(1, len(points) // 400)], points[-1])

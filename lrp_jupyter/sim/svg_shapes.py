"""The shapes of the things in a world as SVG, in metres with y up: of still pictures and of animated ones.

Shapes that can change take `moving`: SMIL elements inside of them that say how.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from textwrap import wrap

from lrp_jupyter.sim.floor import Paint
from lrp_jupyter.sim.sim_robot import BAR, BAR_HALF, WHEELBASE
from lrp_jupyter.sim.world import (
    ArcStroke,
    BoxSolid,
    BoxZone,
    CircleStroke,
    Point,
    RobotSpec,
    Solid,
    Stroke,
    Zone,
)

CALM, BUMP = ("#2b3138", "0.011"), ("#E31A1C", "0.02")
"""Colour and width of a bumper that is free, and of one that is pressed."""

_FIXED, _PUSHABLE, _MOVING = ("#646d77", "#4b525a"), ("#d9a566", "#8a5a1f"), ("#8fc7c3", "#2b7a75")
_LINE, _LINES = 24, 4  # characters of a line of what a robot says, and how many lines
_ROBOTS = (("#A6CEE3", "#1F78B4"), ("#FDBF6F", "#B35900"), ("#B2DF8A", "#257A20"), ("#CAB2D6", "#6A3D9A"))


def robot_colour(index: int) -> tuple[str, str]:
    """Return the colours of a robot's body, and of its edge and track."""
    return _ROBOTS[index % len(_ROBOTS)]


def zone(shape: Zone) -> str:
    """Draw a zone."""
    style = (
        'fill="#33A02C" fill-opacity="0.07" stroke="#33A02C" stroke-width="0.006" stroke-opacity="0.7" '
        'stroke-dasharray="0.03 0.02"'
    )
    if isinstance(shape, BoxZone):
        x, y, width, height = shape.box
        corner = f'x="{num(x - width / 2)}" y="{num(y - height / 2)}"'
        return f'<rect {corner} width="{num(width)}" height="{num(height)}" {style}/>'
    x, y, radius = shape.circle
    return f'<circle cx="{num(x)}" cy="{num(y)}" r="{num(radius)}" {style}/>'


def stroke(shape: Stroke) -> str:
    """Draw a stroke of the floor."""
    style = (
        f'fill="none" stroke="{grey(shape.grey)}" stroke-width="{num(shape.width)}" '
        'stroke-linecap="round" stroke-linejoin="round"'
    )
    if isinstance(shape, CircleStroke):
        x, y, radius = shape.circle
        return f'<circle cx="{num(x)}" cy="{num(y)}" r="{num(radius)}" {style}/>'
    if isinstance(shape, ArcStroke):
        x, y, radius, first, last = shape.arc
        turns = max(1, math.ceil(abs(last - first) / 3))  # an SVG arc is shorter than a full turn
        angles = [first + (last - first) * turn / turns for turn in range(turns + 1)]
        ends = [(x + radius * math.cos(angle), y + radius * math.sin(angle)) for angle in angles]
        sweep, size = int(last > first), num(radius)
        arcs = "".join(f"A{size} {size} 0 0 {sweep} {num(px)} {num(py)}" for px, py in ends[1:])
        return f'<path d="M{num(ends[0][0])} {num(ends[0][1])}{arcs}" {style}/>'
    return f'<path d="{path(shape.path)}" {style}/>'


def ink(paint: Paint, points: Sequence[Point], extra: str = "", moving: str = "") -> str:
    """Draw a connected part of what was drawn on the floor while the world ran."""
    blend = ' style="mix-blend-mode:darken"' if paint.ink else ""
    return _element(
        f'path d="{path(points)}" fill="none" stroke="{grey(paint.grey)}" '
        f'stroke-width="{num(2 * paint.half)}" stroke-linecap="round" stroke-linejoin="round"{blend}{extra}',
        moving,
    )


def track(points: Sequence[Point], index: int, extra: str = "", moving: str = "") -> str:
    """Draw where a robot has been."""
    return _element(
        f'path d="{path(points)}" fill="none" stroke="{robot_colour(index)[1]}" stroke-width="0.008" '
        f'stroke-opacity="0.55" stroke-linejoin="round"{extra}',
        moving,
    )


def patrol(points: Sequence[Point]) -> str:
    """Draw the path of a solid that moves by itself."""
    return (
        f'<path d="{path(points)}" fill="none" stroke="{_MOVING[1]}" stroke-width="0.006" '
        'stroke-dasharray="0.006 0.02" stroke-linecap="round" stroke-linejoin="round"/>'
    )


def solid(shape: Solid) -> str:
    """Draw a solid around the origin, before turning."""
    fill, edge = _MOVING if shape.patrol is not None else _FIXED if shape.push is None else _PUSHABLE
    style = f'fill="{fill}" stroke="{edge}" stroke-width="0.008"'
    if not isinstance(shape, BoxSolid):
        return f'<circle r="{num(shape.circle[2] - 0.004)}" {style}/>'
    _, _, width, height = shape.box
    inner, outer = max(width - 0.008, 0.004), max(height - 0.008, 0.004)
    corner = f'x="{num(-inner / 2)}" y="{num(-outer / 2)}"'
    return f'<rect {corner} width="{num(inner)}" height="{num(outer)}" {style}/>'


def robot(spec: RobotSpec, index: int, below: str = "", above: str = "") -> str:
    """Draw a robot at the origin that faces along x: its rays `below` its body, its sensors `above`."""
    radius, (fill, edge) = spec.radius, robot_colour(index)
    wheel, half = radius * 0.55, radius * WHEELBASE / 2
    wheels = "".join(
        f'<rect x="{num(-wheel / 2)}" y="{num(side * half - radius * 0.11)}" width="{num(wheel)}" '
        f'height="{num(radius * 0.22)}" rx="{num(radius * 0.08)}" fill="#2b3138"/>'
        for side in (-1, 1)
    )
    corners = ((0.45, 0.0), (-0.3, 0.38), (-0.12, 0.0), (-0.3, -0.38))
    arrow = path([(radius * ahead, radius * left) for ahead, left in corners]) + "Z"
    return (
        f'{below}<circle r="{num(radius - 0.003)}" fill="{fill}" stroke="{edge}" stroke-width="0.006"/>'
        f'{wheels}<path d="{arrow}" fill="{edge}"/>{above}'
    )


def name_of(text: str, spec: RobotSpec, index: int) -> str:
    """Write the name of a robot above it; upright, if it is drawn where the robot is and not turned."""
    size = max(0.07, spec.radius)
    return (
        f'<text transform="translate(0 {num(spec.radius + 0.04)}) scale({num(size / 10)} {num(-size / 10)})" '
        'text-anchor="middle" font-family="system-ui,sans-serif" font-size="10" font-weight="600" '
        f'stroke="#fff" stroke-width="3" stroke-opacity="0.8" paint-order="stroke" '
        f'fill="{robot_colour(index)[1]}">{escape(text)}</text>'
    )


def speech(text: str, robot: RobotSpec, index: int, place: Point, size: Point) -> str:
    """Write what a robot says beside it, where a world of this size has room; upright, as :func:`name_of`."""
    px, lines = max(0.07, robot.radius) / 10, wrap(text, _LINE, max_lines=_LINES, placeholder=" …")
    wide, tall = 6.2 * max(map(len, lines), default=0) + 10, 12 * len(lines) + 6
    (x, y), away = place, robot.radius / px + 8
    half = min(wide * px, size[0]) / 2
    shift = (min(size[0] - half, max(half, x)) - x) / px
    top, tip = (away, -6) if y > size[1] / 2 else (-away - tall, tall + 6)
    style = f'fill="#fff" stroke="{robot_colour(index)[1]}"'
    corner = f'x="{num(shift - wide / 2)}" y="{num(top)}"'
    edge = top if tip < 0 else top + tall
    texts = "".join(
        f'<text x="{num(shift)}" y="{num(top + 12 * number - 1)}">{escape(line)}</text>'
        for number, line in enumerate(lines, 1)
    )
    return (
        f'<g transform="scale({num(px)} {num(-px)})" text-anchor="middle" '
        f'font-family="system-ui,sans-serif" font-size="10" fill="#1f2328">'
        f'<rect {corner} width="{num(wide)}" height="{tall}" rx="5" {style}/>'
        f'<path d="M-4 {num(edge)}L0 {num(top + tip)}L4 {num(edge)}" {style}/>{texts}</g>'
    )


def ray(spec: RobotSpec, bearing: float, way: float, moving: tuple[str, str, str] = ("", "", "")) -> str:
    """Draw the ray of a distance sensor, which sees something so far away.

    `moving` is inside of the ray, of its line, and of the dot at its end.
    """
    near, far = num(spec.radius), num(spec.radius + way)
    turn = f' transform="rotate({num(math.degrees(bearing))})"' if bearing else ""
    line = (
        f'line x1="{near}" x2="{far}" stroke="#E31A1C" stroke-width="0.006" stroke-dasharray="0.02 0.015" '
        'stroke-opacity="0.8"'
    )
    dot = _element(f'circle cx="{far}" r="0.012" fill="#E31A1C"', moving[2])
    return f"<g{turn}>{moving[0]}{_element(line, moving[1])}{dot}</g>"


def light(place: Point, seen: float, moving: str = "") -> str:
    """Draw the spot of a light sensor, filled with what it sees."""
    return _element(
        f'circle cx="{num(place[0])}" cy="{num(place[1])}" r="0.014" fill="{grey(seen)}" '
        'stroke="#FF7F00" stroke-width="0.006"',
        moving,
    )


def bumper(spec: RobotSpec, is_pressed: bool, moving: str = "") -> str:
    """Draw a bumper bar."""
    rim = spec.radius + BAR + 0.004
    cos, sin = rim * math.cos(BAR_HALF), rim * math.sin(BAR_HALF)
    colour, thick = BUMP if is_pressed else CALM
    arc = f"M{num(cos)} {num(-sin)}A{num(rim)} {num(rim)} 0 0 1 {num(cos)} {num(sin)}"
    return _element(
        f'path d="{arc}" fill="none" stroke="{colour}" stroke-width="{thick}" stroke-linecap="round"', moving
    )


def lamp(spec: RobotSpec) -> str:
    """Draw a lamp that is lit."""
    return (
        f'<circle cx="{num(-0.5 * spec.radius)}" r="{num(0.26 * spec.radius)}" fill="#FFD84D" '
        'stroke="#8a5a1f" stroke-width="0.004"><title>the lamp is lit</title></circle>'
    )


def path(points: Sequence[Point]) -> str:
    """Return the data of a path; a single point is a dot."""
    lines = "".join(f"{'L' if index else 'M'}{num(x)} {num(y)}" for index, (x, y) in enumerate(points))
    return lines if len(points) > 1 else f"{lines}h0"


def grey(level: float) -> str:
    """Return the colour of a grey, 0 to 255."""
    return f"#{round(level):02x}{round(level):02x}{round(level):02x}"


def num(value: float) -> str:
    """Write a number, to a tenth of a millimetre."""
    return f"{value:.4f}".rstrip("0").rstrip(".")


def _element(start: str, inside: str) -> str:
    return f"<{start}>{inside}</{start.partition(' ')[0]}>" if inside else f"<{start}/>"

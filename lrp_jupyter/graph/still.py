"""Static pictures: one machine, or all machines of a program, as a self-contained SVG document.

:mod:`lrp_jupyter.graph.layout` computes the positions; this module only writes them as SVG, with
the same class names and ``data-lrp-…`` attributes as in the notebook's live graph.

Paper: §3.1, figure 2: blue events, green epsilons, orange timeouts, purple wildcards.
"""

from __future__ import annotations

import zlib
from collections.abc import Collection, Iterable, Mapping, Sequence
from html import escape
from typing import Literal

from lrp_jupyter.graph.exports import tree
from lrp_jupyter.graph.inside import NAME
from lrp_jupyter.graph.labels import LABEL_FONT, LABEL_LINE, STATE_FONT, text_width
from lrp_jupyter.graph.layout import HEIGHT, ICON, SETTINGS, fit_tags, layout
from lrp_jupyter.graph.layout_parts import Label, Layout, Port, SpawnedLine, StateShape, TransitionShape
from lrp_jupyter.graph.routes import number
from lrp_jupyter.graph.state_graph import DefinedPaths, find_machine
from lrp_jupyter.language.lookup import find
from lrp_jupyter.language.program import Machine, Path, Program, path_text

__all__ = ["draw", "mimebundle", "svg"]

Theme = Literal["auto", "light", "dark"]

_LIGHT = {
    "ink": "#1f2328",
    "faint": "#6b7280",
    "line": "#d4d8de",
    "paper": "#ffffff",
    "state": "#f6f7f9",
    "fired": "#ffe2a3",
}
_DARK = {
    "ink": "#e6e8eb",
    "faint": "#9aa3af",
    "line": "#3d444d",
    "paper": "#1b1e23",
    "state": "#272b32",
    "fired": "#6b531f",
}
_LIGHT |= {"on": "#1F78B4", "eps": "#33A02C", "ontime": "#FF7F00", "wildcard": "#6A3D9A"}
_DARK |= {"on": "#A6CEE3", "eps": "#B2DF8A", "ontime": "#FDBF6F", "wildcard": "#CAB2D6"}
_DASHES = {"eps": "1.5 4", "ontime": "7 4", "wildcard": "11 3 2 3", "exit": "15 4"}
_WORDS = {"on": "event", "eps": "epsilon", "ontime": "timeout", "wildcard": "any state", "exit": "exit"}
_FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue','DejaVu Sans',sans-serif"
SPACE = 12.0
WIDE = 900.0  # px: panels are placed side by side up to this width


def svg(
    subject: Program | Machine,
    active: Iterable[Sequence[str]] = (),
    fired: Iterable[str] | str | None = None,
    machine_path: str | Path | None = None,
    *,
    previous: Layout | None = None,
    theme: Theme = "auto",
    legend: bool = True,
    nested: bool = False,
) -> str:
    """Return a picture of a program or a machine.

    Parameters
    ----------
    subject : Program or Machine
    active : iterable of path
        Paths of the innermost active states, as in :attr:`Interpreter.active`; for a machine by
        itself, paths that begin with its name.
    fired : str or iterable of str, optional
        Ids of the transitions fired last (``follower:tlooking``).
    machine_path : str or path, optional
        The one machine of the program to draw; by default all of them, the outer ones first.
    previous : Layout, optional
        An earlier layout of the one machine, whose states keep their positions.
    theme : {"auto", "light", "dark"}
        ``auto`` follows the reader's preference.
    legend : bool
        Whether to explain the colours and dashes.
    nested : bool
        Whether nested machines of a program are drawn inside their states.

    Returns
    -------
    str
        A self-contained SVG document, with a title and a description for screen readers.

    Raises
    ------
    UnknownElementError
        There is no such machine, or there are several.
    """
    if isinstance(subject, Machine):
        drawings = [layout(subject, previous)]
    elif machine_path is not None:
        path = find(subject, "machine", machine_path).path
        drawings = [layout(find_machine(subject, path), previous, program=subject, path=path)]
    else:
        drawn: dict[str, Layout] = {}
        for path, machine in reversed(_machines(subject)):
            drawn[path_text(path)] = layout(
                machine, program=subject, path=path, inside=drawn if nested else None
            )
        drawings = list(drawn.values())[::-1]
    users: dict[str, str] = {}
    if isinstance(subject, Program):  # active paths are as spawned, drawn paths as defined
        paths, spawned = DefinedPaths(subject), tuple(map(tuple, active))
        users = fit_tags(paths.users(spawned), drawings)
        active = [path.split("/") for path in paths.active_states(spawned)]
    marks = {fired} if isinstance(fired, str) else set(fired or ())
    return draw(drawings, active, marks, users, theme=theme, legend=legend)


def _machines(program: Program) -> list[tuple[Path, Machine]]:
    found: dict[Path, Machine] = {}
    for path, machine in program.walk():
        found.setdefault(path, machine)
    return list(found.items())


def mimebundle(subject: Program | Machine) -> dict[str, str]:
    """Return a program or a machine for a notebook: its picture, and its tree as plain text."""
    return {"image/svg+xml": svg(subject), "text/plain": tree(subject)}


def draw(
    drawings: Sequence[Layout],
    active: Iterable[Sequence[str]] = (),
    fired: Iterable[str] = (),
    users: Mapping[str, str] | None = None,
    *,
    theme: Theme = "auto",
    legend: bool = True,
) -> str:
    """Return a picture of layouts, side by side and below each other; the same input gives the same text.

    `users`: in which states a machine runs that runs in several, by its active states.
    """
    paths = (path_text(tuple(path[:end])) for path in active for end in range(2, len(path) + 1, 2))
    on = {path: (users or {}).get(path, "") for path in paths}
    marks = set(fired)
    panels: list[str] = []
    width, bottom = 120.0, SPACE
    across, row = SPACE, SPACE  # where the next panel begins: beside the last one if it fits
    widest = max([WIDE, *(drawing["view"][2] for drawing in drawings)])
    by_path = {drawing["machine"]: drawing for drawing in drawings}
    nested = {inner["machine"] for one in drawings for shape in one["states"] for inner in shape["inside"]}
    for drawing in drawings:
        if drawing["machine"] in nested:
            continue
        left, top, panel_width, panel_height = drawing["view"]
        if across > SPACE and across + panel_width > widest + SPACE:
            across, row = SPACE, bottom
        shift = f"translate({number(across - left)} {number(row - top)})"
        panels.append(f'<g transform="{shift}">{_panel(drawing, on, marks, by_path)}</g>')
        across += panel_width + SPACE
        width = max(width, across)
        bottom = max(bottom, row + panel_height + SPACE)
    styles = {shape["style"] for drawing in drawings for shape in drawing["transitions"]}
    if legend and styles:
        key, key_width = _legend(styles, bottom)
        panels.append(key)
        width = max(width, key_width)
        bottom += 24.0
    if not drawings:
        panels.append(_text("lrp-faint", width / 2, bottom + 14.0, "no machine"))
        bottom += 34.0
    title = ", ".join(drawing["name"] for drawing in drawings) or "empty program"
    title = f"State machine {title}" if len(drawings) == 1 else f"State machines {title}"
    body = "".join(panels)
    mark = f"lrp-{zlib.crc32(repr((body, theme)).encode()):08x}"
    size = f'width="{number(width)}" height="{number(bottom)}" viewBox="0 0 {number(width)} {number(bottom)}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} class="lrp-still" data-lrp="graph" role="img"'
        f' aria-labelledby="{mark}-title {mark}-desc">'
        f'<title id="{mark}-title">{escape(title)}</title>'
        f'<desc id="{mark}-desc">{escape(" ".join(_description(one, on, marks) for one in drawings))}</desc>'
        f"<style>{_css(theme)}</style>"
        f'<rect class="lrp-paper" width="100%" height="100%" rx="6"/>{body}</svg>\n'
    )


def _panel(drawing: Layout, active: Mapping[str, str], fired: set[str], others: Mapping[str, Layout]) -> str:
    left, top, width, height = drawing["frame"]
    frame = f'<rect class="lrp-frame" {_rect(left, top, width, height)} rx="8"/>'
    outer = drawing["machine"].rpartition("/")[0]
    inside = f'<tspan class="lrp-within" dx="6">in {escape(outer)}</tspan>' if outer else ""
    name = (
        f'<text class="lrp-machine" x="{number(left + 12)}" y="{number(top + 19)}" text-anchor="start">'
        f"{escape(drawing['name'])}{inside}</text>"
    )
    if not drawing["states"]:
        name += _text("lrp-faint", left + width / 2, top + height / 2 + 12.0, "no states yet")
    arrows = "".join(_transition(shape, shape["id"] in fired) for shape in drawing["transitions"])
    ports = "".join(map(_port, drawing["ports"]))
    states = "".join(
        _state(shape, active.get(shape["id"]), _inside(shape, active, fired, others))
        for shape in drawing["states"]
    )
    # labels last, and their halos before all of them: no halo covers another label
    halos = "".join(
        _label("lrp-halo lrp-fired" if shape["id"] in fired else "lrp-halo", shape["label"])
        for shape in drawing["transitions"]
    )
    labels = "".join(
        _label("lrp-label lrp-off" if shape["broken"] else "lrp-label", shape["label"])
        for shape in drawing["transitions"]
    )
    return (
        f'<g data-lrp-machine="{escape(drawing["machine"])}">'
        f"{frame}{name}{arrows}{ports}{states}{halos}{labels}</g>"
    )


def _inside(
    shape: StateShape, active: Mapping[str, str], fired: set[str], others: Mapping[str, Layout]
) -> str:
    drawn = ""
    for inner in shape["inside"]:
        at = f"translate({number(shape['x'] + inner['x'])} {number(shape['y'] + inner['y'])})"
        drawn += f'<g transform="{at}">{_panel(others[inner["machine"]], active, fired, others)}</g>'
    return drawn


def _transition(shape: TransitionShape, fired: bool) -> str:
    classes = f"lrp-transition lrp-{shape['style']}" + (" lrp-broken" if shape["broken"] else "")
    glow = f'<path class="lrp-glow" d="{shape["d"]}"/>' if fired else ""
    head = f'<path class="lrp-head" d="{shape["head"]}"/>' if shape["head"] else ""
    mark = f'<path class="lrp-mark" d="{shape["mark"]}"/>' if shape["mark"] else ""
    shown = f"{shape['id'].partition(':')[0]}:{shape['name']}"
    mine = f'data-lrp-transition="{escape(shown)}"' + (' data-fired=""' if fired else "")
    return (
        f'<g class="{classes}" {mine}>'
        f"<title>{escape(shape['title'])}</title>{glow}"
        f'<path class="lrp-shaft" d="{shape["d"]}"/>{head}{mark}</g>'
    )


def _state(shape: StateShape, user: str | None, inside: str) -> str:
    """Draw a state; `user`: None if it is not active."""
    x, y, width, height = shape["x"], shape["y"], shape["width"], shape["height"]
    left, top = x - width / 2, y - height / 2
    radius = height / 2 if shape["kind"] == "any" else 9.0
    body = f'<rect class="lrp-box" {_rect(left, top, width, height)} rx="{number(radius)}"/>'
    if shape["nested"]:
        body += f'<rect class="lrp-inner" {_rect(left + 3.5, top + 3.5, width - 7, height - 7)} rx="6"/>'
        first = x - text_width(shape["nested"], LABEL_FONT) / 2 - 7.0
        line = top + HEIGHT
        body += f'<path class="lrp-icon" d="{_icon(first + 4.0, line)}"/>'
        body += _text("lrp-nested", first + ICON, line + 4.0, shape["nested"], "start")
    if inside:
        body += _text("lrp-name", x, top + NAME / 2 + STATE_FONT * 0.35, shape["label"]) + inside
    else:
        below = shape["nested"] or shape["spawns"]
        name = top + HEIGHT / 2 + (5.5 if below else STATE_FONT * 0.35)
        body += _text("lrp-name", x, name, shape["label"])
    body += "".join(_spawned(line, x, y) for line in shape["spawns"])
    if (start := shape["start"]) is not None:
        body += (
            f'<g class="lrp-start"><circle cx="{number(start["x"])}" cy="{number(start["y"])}"'
            f' r="{number(start["radius"])}"/><path class="lrp-start-shaft" d="{start["d"]}"/>'
            f'<path d="{start["head"]}"/></g>'
        )
    if user:
        body += _text("lrp-user", left + 10.0, top - 4.0, user, "start")
    mine = f'data-lrp-state="{escape(shape["id"])}"' + (' data-active=""' if user is not None else "")
    title = f"<title>{escape(shape['title'])}</title>"
    kind = f"lrp-{shape['kind']}" + (" lrp-open" if inside else "")
    return f'<g class="lrp-state {kind}" {mine}>{title}{body}</g>'


def _spawned(line: SpawnedLine, x: float, y: float) -> str:
    left, middle = x + line["x"], y + line["y"]
    settings = (
        f'<tspan dx="{number(SETTINGS)}">{escape(line["settings"])}</tspan>' if line["settings"] else ""
    )
    return (
        f'<g data-lrp-spawns="{escape(line["machine"])}"><title>{escape(line["title"])}</title>'
        f'<path class="lrp-icon" d="M{number(left)} {number(middle - 5)}h7v7h-7z'
        f'M{number(left + 3)} {number(middle - 2)}h7v7h-7z"/>'
        f'<text class="lrp-nested" x="{number(left + ICON)}" y="{number(middle + 4)}" text-anchor="start">'
        f"{escape(line['name'])}{settings}</text></g>"
    )


def _icon(x: float, y: float) -> str:
    """Return the path of the icon of a nested machine: two small states and an arrow, around a point."""
    return (
        f"M{number(x - 6)} {number(y - 4)}h5v4h-5zM{number(x + 1)} {number(y + 1)}h5v4h-5z"
        f"M{number(x - 3.5)} {number(y)}v3h4.5"
    )


def _port(port: Port) -> str:
    missing = " lrp-off" if port["missing"] else ""
    circle = f'<circle class="lrp-port" cx="{number(port["x"])}" cy="{number(port["y"])}" r="4.5"/>'
    return circle + _label(f"lrp-outside{missing}", port["label"])


def _rect(left: float, top: float, width: float, height: float) -> str:
    return f'x="{number(left)}" y="{number(top)}" width="{number(width)}" height="{number(height)}"'


def _text(kind: str, x: float, y: float, text: str, anchor: str = "middle") -> str:
    start = ' text-anchor="start"' if anchor == "start" else ""
    return f'<text class="{kind}" x="{number(x)}" y="{number(y)}"{start}>{escape(text)}</text>'


def _label(kind: str, label: Label) -> str:
    lines = label["text"].split("\n")
    x, first = label["x"], label["y"] + LABEL_FONT * 0.35 - LABEL_LINE * (len(lines) - 1) / 2
    if len(lines) == 1:
        return _text(kind, x, first, lines[0])
    spans = " ".join(
        f'<tspan x="{number(x)}" y="{number(first + LABEL_LINE * index)}">{escape(line)}</tspan>'
        for index, line in enumerate(lines)
    )
    return f'<text class="{kind}">{spans}</text>'


def _legend(styles: Collection[str], top: float) -> tuple[str, float]:
    """Return one line of samples, and its width."""
    x, y = SPACE + 2.0, top + 8.0
    parts = []
    for style, word in _WORDS.items():
        if style in styles:
            parts.append(
                f'<g class="lrp-transition lrp-{style}">'
                f'<path class="lrp-shaft" d="M{number(x)} {number(y)}h30"/></g>'
                + _text("lrp-key", x + 36.0, y + 4.0, word, "start")
            )
            x += 36.0 + text_width(word, LABEL_FONT) + 20.0
    return f'<g class="lrp-legend" aria-hidden="true">{"".join(parts)}</g>', x


def _description(drawing: Layout, active: Mapping[str, str], fired: set[str]) -> str:
    words = [f"{drawing['name']}:"]
    states = [shape for shape in drawing["states"] if shape["kind"] == "state"]
    words.append(f"{len(states)} state" + ("" if len(states) == 1 else "s") + ".")
    for shape in states:
        if shape["start"] is not None:
            words.append(f"It starts in {shape['name']}.")
        words += [f"{shape['name']} spawns {line['title']}." for line in shape["spawns"]]
        if shape["id"] in active:
            user = active[shape["id"]]
            words.append(f"{shape['name']} is active{f' in {user}' if user else ''}.")
    for arrow in drawing["transitions"]:
        source = "any state" if arrow["source"] == "*" else arrow["source"]
        where = "leaves to" if arrow["kind"] == "exit" and not arrow["lands"] else "to"
        text = "at once" if arrow["kind"] == "eps" else " ".join(arrow["label"]["text"].split())
        broken = f" It is broken: {arrow['broken']}" if arrow["broken"] else ""
        last = " It fired last." if arrow["id"] in fired else ""
        words.append(f"From {source} {where} {arrow['destination']}, {text}.{last}{broken}")
    return " ".join(words)


def _css(theme: Theme) -> str:
    fixed = (
        f".lrp-still text{{font-family:{_FONT};text-anchor:middle}}"
        f".lrp-name{{font-size:{STATE_FONT}px;font-weight:500}}"
        f".lrp-nested,.lrp-key{{font-size:{LABEL_FONT}px}}"
        f".lrp-label,.lrp-halo,.lrp-outside,.lrp-faint{{font-size:{LABEL_FONT}px}}"
        ".lrp-still text[text-anchor=start]{text-anchor:start}"
        f".lrp-user{{font-size:{LABEL_FONT}px;font-weight:600}}"
        f".lrp-machine{{font-size:{STATE_FONT}px;font-weight:600}}"
        f".lrp-within{{font-size:{LABEL_FONT}px;font-weight:400}}"
        ".lrp-halo{stroke-width:4;stroke-linejoin:round}"
        ".lrp-shaft{fill:none;stroke-width:1.8;stroke-linecap:butt}"
        ".lrp-glow{fill:none;stroke-width:11;stroke-linecap:round;opacity:.5}"
        "[data-fired] .lrp-shaft{stroke-width:4.5}[data-fired] .lrp-head{stroke-width:5}"
        ".lrp-halo.lrp-fired{stroke-width:9}"
        ".lrp-mark{fill:none;stroke-width:1.8}.lrp-box{stroke-width:1.4}"
        ".lrp-open[data-active]>.lrp-box{stroke-width:3.5}"
        ".lrp-inner,.lrp-frame,.lrp-icon{fill:none;stroke-width:1}"
        ".lrp-missing .lrp-box,.lrp-any .lrp-box{stroke-dasharray:4 3}"
        ".lrp-start-shaft{fill:none;stroke-width:1.6}.lrp-port{stroke-width:1.6}"
    )
    fixed += "".join(f".lrp-{kind} .lrp-shaft{{stroke-dasharray:{dash}}}" for kind, dash in _DASHES.items())
    if theme == "dark":
        return fixed + _colours(_DARK)
    light = _colours(_LIGHT)
    if theme == "light":
        return fixed + light
    return fixed + light + "@media (prefers-color-scheme:dark){" + _colours(_DARK) + "}"


def _colours(c: Mapping[str, str]) -> str:
    rules = [
        f".lrp-paper,.lrp-port{{fill:{c['paper']}}}",
        f".lrp-name,.lrp-machine,.lrp-label,.lrp-outside,.lrp-user{{fill:{c['ink']}}}",
        f".lrp-nested,.lrp-key,.lrp-faint,.lrp-off,.lrp-within,.lrp-missing .lrp-name{{fill:{c['faint']}}}",
        f".lrp-halo{{fill:{c['paper']};stroke:{c['paper']}}}",
        f".lrp-halo.lrp-fired{{stroke:{c['fired']}}}"
        f".lrp-frame{{stroke:{c['line']}}}.lrp-box{{fill:{c['state']};stroke:{c['ink']}}}",
        f".lrp-inner,.lrp-icon{{stroke:{c['faint']}}}",
        f".lrp-missing .lrp-box{{fill:{c['paper']};stroke:{c['faint']}}}",
        f".lrp-any .lrp-box{{fill:{c['paper']};stroke:{c['wildcard']}}}",
        f".lrp-start{{fill:{c['ink']}}}.lrp-start-shaft,.lrp-port{{stroke:{c['ink']}}}",
        f"[data-active]>.lrp-box{{fill:{c['ink']}}}",
        f"[data-active]>.lrp-name,[data-active]>.lrp-nested,[data-active]>g>.lrp-nested{{fill:{c['paper']}}}",
        f"[data-active]>.lrp-inner,[data-active]>.lrp-icon,[data-active]>g>.lrp-icon{{stroke:{c['paper']}}}",
        f".lrp-open>.lrp-box{{fill:{c['paper']}}}.lrp-open[data-active]>.lrp-name{{fill:{c['ink']}}}",
        f".lrp-open[data-active]>g>.lrp-nested{{fill:{c['faint']}}}",
        f".lrp-open[data-active]>g>.lrp-icon{{stroke:{c['faint']}}}",
    ]
    for kind in _WORDS:
        colour = c["on"] if kind == "exit" else c[kind]
        rules.append(
            f".lrp-{kind} .lrp-shaft,.lrp-{kind} .lrp-glow,.lrp-{kind} .lrp-mark{{stroke:{colour}}}"
            f".lrp-{kind} .lrp-head{{fill:{colour}}}.lrp-{kind}[data-fired] .lrp-head{{stroke:{colour}}}"
        )
    return "".join(rules)

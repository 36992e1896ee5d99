"""The layout of one machine as plain data, drawn by the notebook's live graph and by the static picture.

The layout holds all positions, sizes, paths of arrows and positions of labels. A view only draws it and
marks what is active, so the live graph and the static picture look the same.

The result is passed to the next call as `previous`, so that states keep their positions:

- a state keeps its exact position, whatever else is edited; only `moved` moves it;
- a new state is placed at the free position nearest to its neighbours;
- the missing end of a dangling transition already has the position of the state to come;
- the position of a removed state, and of one to come, stays reserved for half a minute (time is a
  parameter here);
- a state whose name is being typed keeps its position: the only one that differs, in the same order; so does
  the missing end of an arrow.

Paper: §3.1, figure 2 (kinds of transitions and the fictional state ``*``).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from textwrap import dedent

from lrp_jupyter.graph.arrangement import GAP_X
from lrp_jupyter.graph.geometry import CELL, Cells, Point, Rect, Size
from lrp_jupyter.graph.inside import Nested, beside_each_other
from lrp_jupyter.graph.labels import (
    LABEL_FONT,
    LABEL_LINE,
    STATE_FONT,
    WIDEST_LABEL,
    arrow_text,
    beside,
    place_labels,
    shorten,
    text_width,
)
from lrp_jupyter.graph.layout_parts import (
    Label,
    Layout,
    Port,
    SpawnedLine,
    Start,
    StateShape,
    TransitionShape,
)
from lrp_jupyter.graph.routes import (
    Pair,
    Route,
    arc,
    bends,
    chords,
    detour,
    loop,
    number,
    obstacles,
    straight,
)
from lrp_jupyter.graph.spawned import SpawnedMachine, landings, spawned_machines
from lrp_jupyter.graph.state_graph import (
    ANY,
    NO_EXIT,
    distinct_states,
    events_in_scope,
    outer_states,
    start_states,
    why_dangling,
)
from lrp_jupyter.graph.state_places import keep_positions
from lrp_jupyter.language.program import Machine, Path, Program, State, Transition, path_text
from lrp_jupyter.language.resolution import resolve

HEIGHT = 36.0
LINE = 16.0  # px: height of a line below the name
ICON = 16.0  # px: width of what is before the name of a machine
SETTINGS = 6.0  # px: between that name and the settings
WIDEST_NAME, WIDEST_LINE = 150.0, 210.0
PLAIN = 1_000  # arrows above which neither they nor their labels avoid anything: that would take many seconds
TAG = 120.0  # px: width of what names the states in which a machine runs, above each active state
TAG_INSET, TAG_ABOVE, TAG_GAP = 10.0, 9.0, 4.0  # px: from the left side, from the top, to what is beside it
BOLD = 1.08  # how much wider letters are
MARGIN = 18.0
TITLE = 18.0


def layout(
    machine: Machine,
    previous: Layout | None = None,
    *,
    program: Program | None = None,
    path: Path | None = None,
    moved: Mapping[str, Sequence[float]] | None = None,
    now: float = 0.0,
    panel: Size | None = None,
    inside: Mapping[str, Layout] | None = None,
) -> Layout:
    """Lay out one machine.

    `previous`: the last layout of the same machine: its states keep their places. Without it everything is
        arranged again, except for what is moved.
    `program`: the program that contains it; provides start states, events in scope and where an ``exit``
        leads.
    `path`: the machine's path, by default its name alone.
    `moved`: states moved by hand and where to, in px; they stay moved in later layouts. The place of one that
        is not in the machine is reserved for it.
    `now`: time in seconds, on any clock; for the places that are reserved.
    `panel`: width and height of the panel that shows it, in px: new places are chosen so that it fits.
    `inside`: layouts of nested machines by their paths, to be drawn inside their states.
    Plain dicts, lists, strings and numbers: ``json.dumps`` takes it as it is. The same arguments always give
        the same result.
    """
    where = path or (str(machine.name),)
    return _Drawing(machine, where, program, inside or {}).draw(previous, moved or {}, now, panel)


def fit_tags(users: Mapping[str, str], layouts: Iterable[Layout]) -> dict[str, str]:
    """Return the tags of active states no wider than there is room: in the frame, and beside other states."""
    tags = dict(users)
    for drawing in layouts if tags else ():  # this is done for every frame
        right = drawing["frame"][0] + drawing["frame"][2]
        boxes = {
            each["id"]: Rect(each["x"], each["y"], each["width"], each["height"])
            for each in drawing["states"]
        }
        for state in boxes.keys() & tags.keys():
            tag = _tag(boxes[state], right)
            left = tag.x - tag.width / 2
            beside = (box for box in boxes.values() if box.overlaps(tag, gap_y=TAG_ABOVE))  # with its own tag
            ends = (box.x - box.width / 2 for box in beside)
            end = min([right, *(each for each in ends if each > left)])
            tags[state] = shorten(tags[state], LABEL_FONT * BOLD, end - left - TAG_GAP)
    return tags


def _tag(box: Rect, right: float) -> Rect:
    """Return the line above a state, as far as `right`."""
    left = box.x - box.width / 2 + TAG_INSET
    return Rect((left + right) / 2, box.y - box.height / 2 - TAG_ABOVE, right - left, LABEL_FONT)


class _Edge:
    """An arrow; `inside`: of an ``exit`` that lands here, the state that it leaves, as text."""

    def __init__(
        self,
        path: Path,
        label: str,
        transition: Transition,
        source: str,
        broken: str | None,
        inside: str | None = None,
    ) -> None:
        self.id = f"{path_text(path[:-1])}:{path[-1]}"
        self.label = label
        self.transition = transition
        self.source = source
        self.target = str(transition.destination)
        self.broken = broken
        self.lands = inside is not None
        self.outward = transition.outward and not self.lands
        texts = [arrow_text(transition), *([inside] if inside else [])]
        lines = [shorten(text, LABEL_FONT, WIDEST_LABEL) for text in texts]
        self.text = "\n".join(lines)
        width = max(text_width(line, LABEL_FONT) for line in lines)
        self.size = (width + 4.0, LABEL_FONT + 4.0 + LABEL_LINE * (len(lines) - 1))
        title = _source_text(transition) + (f" of {path_text(path[:-1])}" if self.lands else "")
        self.title = f"{title}: {broken}" if broken else title
        if transition.effect:
            self.title += "\n/ " + " ".join(f"[{dedent(block.text).strip()}]" for block in transition.effect)
        kind, name = transition.trigger.reference or ("", "")
        self.watched = str(name) if kind == "machine" else ""


class _Drawing:
    """Builder of one layout: nodes first, then positions, arrows, labels."""

    def __init__(
        self, machine: Machine, path: Path, program: Program | None, inside: Mapping[str, Layout]
    ) -> None:
        self.machine = machine
        self.path = path
        self.states = distinct_states(machine)
        names = resolve(program) if program else None
        scope = names and names.by_path.get(path)
        self.is_shared = bool(names and scope and len(names.spawners.get(scope, ())) > 1)
        self.spawned: dict[str, list[SpawnedMachine]] = {name: [] for name in self.states}
        for each in spawned_machines(names, path) if names else ():
            self.spawned.setdefault(each.state, []).append(each)
        self.lines = {name: _lines(spawned) for name, spawned in self.spawned.items() if name in self.states}
        self.insides = {
            name: nested
            for name, state in self.states.items()
            if (
                nested := beside_each_other(
                    [inside[at] for at in self._nested_in(state) if at in inside],
                    LINE * len(self.lines[name]),
                )
            )
        }
        self.starts: Sequence[str] = start_states(program).get(path, ()) if program else ()
        events = events_in_scope(program, path) if program else None
        outer = outer_states(program, path) if program else None
        # their labels are the largest: they are placed first
        self.edges = [
            _Edge(
                each.arrow.element.path,
                each.arrow.label,
                each.arrow.noun,
                each.state,
                each.broken,
                each.inside,
            )
            for each in (landings(names, path) if names else ())
        ]
        self.edges += [
            _Edge((*path, id_), label, transition, source, self._broken(transition, source, events, outer))
            for id_, label, transition in zip(machine.ids, machine.labels, machine.transitions, strict=True)
            for source in ([ANY] if transition.wildcard else dict.fromkeys(map(str, transition.sources)))
        ]
        self.sizes = self._sizes()
        self.plain = len(self.edges) > PLAIN

    def _nested_in(self, state: State) -> Iterable[str]:
        return dict.fromkeys(
            path_text((*self.path, str(state.name), str(inner.name))) for inner in state.machines
        )

    def _broken(
        self, transition: Transition, source: str, events: frozenset[str] | None, outer: frozenset[str] | None
    ) -> str | None:
        inside = outer if transition.outward else self.states
        if transition.outward and outer is not None and not outer:
            return NO_EXIT
        return why_dangling(
            transition,
            source_exists=source == ANY or source in self.states,
            target_exists=inside is None or str(transition.destination) in inside,
            events=events,
        )

    def _sizes(self) -> dict[str, tuple[float, float]]:
        """Return the width and height of every node: ``*``, the states, then the missing ones."""
        sizes: dict[str, tuple[float, float]] = {}
        if any(edge.source == ANY for edge in self.edges):
            sizes[ANY] = (HEIGHT, HEIGHT)
        for name, state in self.states.items():
            sizes[name] = _state_size(
                name, self._nested_text(state), self.insides.get(name), self.lines[name]
            )
        for edge in self.edges:
            for name in (edge.source, edge.target)[: 1 if edge.outward else 2]:
                if name not in sizes:
                    sizes[name] = _state_size(name, "", None, ())
        return sizes

    def _nested_text(self, state: State | None) -> str:
        if state is None:
            return ""
        name = str(state.name)
        inside = {str(each.machine.name): each.text for each in self.spawned[name] if not each.elsewhere}
        words = [inside.get(inner.name, str(inner.name)) for inner in state.machines]
        return shorten(", ".join(words), LABEL_FONT, WIDEST_NAME)

    def draw(
        self, previous: Layout | None, moved: Mapping[str, Sequence[float]], now: float, panel: Size | None
    ) -> Layout:
        inner = [edge for edge in self.edges if not edge.outward]
        links = [(edge.source, edge.target) for edge in inner]
        insides = {name: nested.centre for name, nested in self.insides.items()}
        places = keep_positions(
            self._roomy(), list(self.states), links, self.starts, previous, moved, now, panel, insides
        )
        boxes = {name: Rect(places[name]["x"], places[name]["y"], *size) for name, size in self.sizes.items()}
        starts = {name: _start(boxes[name]) for name in self.starts if name in boxes}
        solid = [*boxes.values(), *(Rect(start["x"], start["y"], 18.0, 18.0) for start in starts.values())]
        outer = [edge for edge in self.edges if edge.outward]
        routes = self._routes(inner, boxes)
        labels = self._labels(routes, inner, solid)
        room = max((edge.size[0] + 28.0 for edge in outer), default=0.0)  # for the arrows to the ports
        frame = _around([*solid, *self._tags(boxes.values()), *labels], routes, room, self._title_width())
        ports, exits, exit_labels = self._exits(outer, boxes, frame, [*solid, *labels])
        arrows = zip([*routes, *exits], [*labels, *exit_labels], strict=True)
        drawn = dict(zip([*inner, *outer], arrows, strict=True))
        shown = [port["label"] for port in ports]
        port_boxes = [Rect(each["x"], each["y"], each["width"], each["height"]) for each in shown]
        left, top, width, height = frame
        around = Rect(left + width / 2, top + height / 2, width, height)
        view = _extent([around, *exit_labels, *port_boxes], [], 2.0)
        return Layout(
            machine=path_text(self.path),
            name=str(self.machine.name),
            view=view,
            frame=frame,
            states=[self._state_shape(name, boxes[name], starts.get(name)) for name in self.sizes],
            transitions=[self._transition_shape(edge, *drawn[edge]) for edge in self.edges],
            ports=ports,
            places=places,
        )

    def _tags(self, boxes: Iterable[Rect]) -> list[Rect]:
        """Return what tags take that name the states in which the machine runs, if it may run in several."""
        right = TAG_INSET + TAG - MARGIN
        return [_tag(box, box.x - box.width / 2 + right) for box in boxes] if self.is_shared else []

    def _roomy(self) -> dict[str, Size]:
        """Return the sizes with room for the large labels of arrows that land."""
        sizes: dict[str, Size] = dict(self.sizes)
        for edge in self.edges:
            if edge.lands:
                width, height = sizes[edge.target]
                sizes[edge.target] = max(width, edge.size[0] + GAP_X / 2), height
        return sizes

    def _title_width(self) -> float:
        outer = path_text(self.path[:-1])
        name = text_width(str(self.machine.name), STATE_FONT) * 1.1  # it is bold
        return name + (text_width(f" in {outer}", LABEL_FONT) + 8.0 if outer else 0.0)

    # -- arrows ------------------------------------------------------------------------------------

    def _routes(self, edges: Sequence[_Edge], boxes: Mapping[str, Rect]) -> list[Route]:
        between = Counter((edge.source, edge.target) for edge in edges)
        pairs = {
            (a, b): count + between[b, a]
            for (a, b), count in between.items()
            if a != b and ((b, a) not in between or a < b)
        }
        cells = obstacles(() if self.plain else boxes.values())
        lines = chords(boxes, cells, pairs)
        around: dict[Pair, float] = {}
        spread: dict[Pair, list[float]] = {}
        for (a, b), line in list(lines.items()):
            there, back = bends(between[a, b], between[b, a])
            across = detour(boxes[a], boxes[b], [*there, *(-bend for bend in back)], cells, line)
            around[a, b], around[b, a] = across, -across
            spread[a, b], spread[b, a] = there, back
            lines[b, a] = line[1], line[0]
        routes: list[Route] = []
        drawn: Counter[Pair] = Counter()
        for edge in edges:
            a, b = pair = edge.source, edge.target
            broken = edge.broken is not None
            if a == b:
                routes.append(loop(boxes[a], drawn[pair], between[pair], broken=broken))
            else:
                bend = spread[pair][drawn[pair]]
                routes.append(arc(boxes[a], boxes[b], bend, around[pair], chord=lines[pair], broken=broken))
            drawn[pair] += 1
        return routes

    def _exits(
        self, edges: Sequence[_Edge], boxes: Mapping[str, Rect], frame: Sequence[float], solid: Sequence[Rect]
    ) -> tuple[list[Port], list[Route], list[Rect]]:
        """Route each ``exit`` to a port on the frame, by the shortest free path."""
        if not edges:
            return [], [], []
        ports: list[Port] = []
        ways: list[Route] = []
        cells, near_ports = obstacles(() if self.plain else solid), Cells(CELL)
        for edge in edges:
            source = boxes[edge.source]
            x, y, side = _port(source, frame, cells, near_ports)
            near_ports.add(Rect(x, y, 120.0, 48.0))
            text = shorten(edge.target, LABEL_FONT, WIDEST_LABEL)
            width = text_width(text, LABEL_FONT) + 4.0
            label = Label(
                text=text,
                x=round(x + side[0] * (width / 2 + 9.0), 1),
                y=round(y + side[1] * 15.0, 1),
                width=round(width, 1),
                height=LABEL_FONT + 4.0,
            )
            missing = edge.broken is not None
            ports.append(Port(x=x, y=y, name=edge.target, label=label, missing=missing))
            ways.append(straight(source, (x, y), broken=missing))
        taken = [*solid, *(Rect(port["x"], port["y"], 14.0, 14.0) for port in ports)]
        return ports, ways, self._labels(ways, edges, taken)

    def _labels(self, routes: Sequence[Route], edges: Sequence[_Edge], solid: Sequence[Rect]) -> list[Rect]:
        sizes = [edge.size for edge in edges]
        return [*map(beside, routes, sizes)] if self.plain else place_labels(routes, sizes, solid)

    # -- shapes ------------------------------------------------------------------------------------

    def _state_shape(self, name: str, box: Rect, start: Start | None) -> StateShape:
        state = self.states.get(name)
        machines = [str(inner.name) for inner in state.machines] if state else []
        kind = "any" if name == ANY else "state" if state else "missing"
        title = {"any": "every state", "missing": f"{name}: There is no such state."}.get(kind, name)
        if machines:
            title += f", with {'machine' if len(machines) == 1 else 'machines'} " + ", ".join(machines)
        lines = self.lines.get(name, [])
        if lines:
            title += ", spawns " + ", ".join(line["title"] for line in lines)
        return StateShape(
            id=path_text((*self.path, name)),
            name=name,
            kind=kind,
            x=box.x,
            y=box.y,
            width=round(box.width, 1),
            height=round(box.height, 1),
            label=shorten(name, STATE_FONT, WIDEST_NAME),
            nested="" if name in self.insides else self._nested_text(state),
            machines=machines,
            inside=self.insides[name].placed(box) if name in self.insides else [],
            spawns=[SpawnedLine(**{**line, "y": round(box.height / 2 + line["y"], 1)}) for line in lines],
            title=title,
            start=start,
        )

    def _transition_shape(self, edge: _Edge, route: Route, box: Rect) -> TransitionShape:
        return TransitionShape(
            id=edge.id,
            name=edge.label,
            kind=edge.transition.kind,
            style=edge.transition.style,
            source=edge.source,
            destination=edge.target,
            d=route.d,
            head=route.head,
            mark=route.mark,
            label=Label(
                text=edge.text, x=box.x, y=box.y, width=round(box.width, 1), height=round(box.height, 1)
            ),
            title=edge.title,
            broken=edge.broken,
            lands=edge.lands,
            watched=edge.watched,
        )


def _lines(spawned: Iterable[SpawnedMachine]) -> list[SpawnedLine]:
    """Return the lines for machines that are defined elsewhere; `y` is from the bottom of the state."""
    shown = [each for each in spawned if each.elsewhere]
    lines = []
    for index, each in enumerate(shown):
        name = shorten(each.machine.path[-1], LABEL_FONT, WIDEST_NAME)
        width = ICON + text_width(name, LABEL_FONT)
        settings = shorten(each.settings, LABEL_FONT, max(WIDEST_LINE - width, WIDEST_LINE / 3))
        if settings:
            width += SETTINGS + text_width(settings, LABEL_FONT)
        lines.append(
            SpawnedLine(
                machine=path_text(each.machine.path),
                name=name,
                settings=settings,
                title=f"{each.machine.path[-1]} ({each.settings})"
                if each.settings
                else each.machine.path[-1],
                x=round(-width / 2, 1),
                y=LINE * (index - len(shown)),
                width=round(width, 1),
            )
        )
    return lines


def _state_size(
    name: str, nested: str, nested_in: Nested | None, lines: Sequence[SpawnedLine]
) -> tuple[float, float]:
    width = text_width(shorten(name, STATE_FONT, WIDEST_NAME), STATE_FONT) + 26.0
    width = max([width, *(line["width"] + 28.0 for line in lines)])
    if nested_in is not None:
        return round(max(width, nested_in.width), 1), round(nested_in.height, 1)
    if nested:
        width = max(width, text_width(nested, LABEL_FONT) + 44.0)
    return round(max(width, 64.0), 1), HEIGHT + LINE * (len(lines) + bool(nested))


def _source_text(transition: Transition) -> str:
    words: list[str] = [transition.kind]
    if transition.trigger.text:
        words.append(transition.trigger_text)
    words += [transition.source_text, "->", str(transition.destination)]
    if transition.name:
        words.append(str(transition.name))
    return "(" + shorten(" ".join(words), 1.0, 160.0) + ")"


def _start(box: Rect) -> Start:
    """Draw a dot outside the upper left corner, and an arrow from it into the state."""
    x, y = box.x - box.width / 2 - 17.0, box.y - box.height / 2 - 13.0
    tip = (x + 19.0, y + 14.5)
    return Start(
        x=round(x, 1),
        y=round(y, 1),
        radius=5.0,
        d=f"M{number(x)} {number(y)}L{number(tip[0] - 5)} {number(tip[1] - 3.8)}",
        head=f"M{number(tip[0])} {number(tip[1])}L{number(tip[0] - 7.6)} {number(tip[1] - 1.4)}"
        f" {number(tip[0] - 3.4)} {number(tip[1] - 6.9)}Z",
    )


def _extent(boxes: Iterable[Rect], points: Iterable[Point], margin: float) -> list[float]:
    xs, ys = [], []
    for box in boxes:
        xs += [box.x - box.width / 2, box.x + box.width / 2]
        ys += [box.y - box.height / 2, box.y + box.height / 2]
    for x, y in points:
        xs.append(x)
        ys.append(y)
    if not xs:
        xs, ys = [0.0, 160.0], [0.0, 40.0]
    left, top = round(min(xs) - margin, 1), round(min(ys) - margin, 1)
    return [left, top, round(max(xs) + margin - left, 1), round(max(ys) + margin - top, 1)]


def _around(boxes: Iterable[Rect], routes: Iterable[Route], right: float, title: float) -> list[float]:
    """Draw the frame around everything, with more room at the right and for the name on top."""
    left, top, width, height = _extent(boxes, (point for route in routes for point in route.points), MARGIN)
    return [left, round(top - TITLE, 1), round(max(width + right, title + 28.0), 1), round(height + TITLE, 1)]


def _port(
    source: Rect, frame: Sequence[float], cells: Cells, near_ports: Cells
) -> tuple[float, float, Point]:
    """Return the free point on the frame that a state reaches by the shortest free path."""
    left, top, width, height = frame
    best: tuple[float, float, float, Point] | None = None
    for step in (0.0, 34.0, -34.0, 68.0, -68.0, 110.0, -110.0):
        for x, y, side in (
            (left + width, source.y + step, (1.0, 0.0)),
            (left, source.y + step, (-1.0, 0.0)),
            (source.x + step, top + height, (0.0, 1.0)),
            (source.x + step, top, (0.0, -1.0)),
        ):
            inside = side[1] < 0 or (left <= x <= left + width and top + TITLE <= y <= top + height)
            x, y = round(x, 1), round(y, 1)
            cost = abs(x - source.x) + abs(y - source.y) + abs(step) + (0.0 if side[0] > 0 else 260.0)
            if best is not None and cost >= best[0]:
                continue
            passed = set(cells.along((source.x, source.y), (x, y))) - {source}
            cost += 200.0 * sum(box.crossed_by((source.x, source.y), (x, y), 4.0) for box in passed)
            cost += 1000.0 * sum(around.holds((x, y)) for around in near_ports.at((x, y)))
            cost += 0.0 if inside else 400.0
            if best is None or cost < best[0]:
                best = (cost, x, y, side)
    assert best is not None
    return best[1], best[2], best[3]

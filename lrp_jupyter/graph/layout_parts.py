"""The parts of a layout: plain dicts, serialized as JSON without conversion."""

from __future__ import annotations

from typing import NotRequired, TypedDict


class Position(TypedDict):
    """The centre of a node, in px; ``gone``: the time at which its state was removed, in seconds.

    ``inside`` is the centre of what is drawn inside, in the coordinates of that: it stays where it is while
    the state grows around it.
    """

    x: float
    y: float
    gone: NotRequired[float]
    inside: NotRequired[tuple[float, float]]


class Label(TypedDict):
    """A text of one or more lines and the box around it; `x`, `y` is its centre."""

    text: str
    x: float
    y: float
    width: float
    height: float


class Start(TypedDict):
    """The dot and the arrow that mark a start state."""

    x: float
    y: float
    radius: float
    d: str
    head: str


class Inside(TypedDict):
    """A nested machine that is drawn inside its state; `x`, `y` is its origin, from the state's centre."""

    machine: str
    x: float
    y: float


class SpawnedLine(TypedDict):
    """The line in a state's box for a machine that it spawns and that is defined elsewhere: at `machine`.

    `x`, `y`: the left end of the line and the middle of its height, from the centre of the state.
    """

    machine: str
    name: str
    settings: str  # the values that it gives to variables: `side 1, keep 0.25`
    title: str
    x: float
    y: float
    width: float


class StateShape(TypedDict):
    """One state; `x`, `y` is its centre, in px."""

    id: str  # its path as text
    name: str
    kind: str  # state, any (the `*`) or missing
    x: float
    y: float
    width: float
    height: float
    label: str
    nested: str  # the text below its name for the nested machines
    machines: list[str]  # the names of these
    inside: list[Inside]  # those that are drawn inside instead
    spawns: list[SpawnedLine]
    title: str
    start: Start | None


class TransitionShape(TypedDict):
    """One arrow. A transition with several sources has an arrow for each, with the same `id`.

    An ``exit`` has one more wherever it lands.
    `id` is the machine's path and the transition's id, which survives an edit of its condition or delay,
    unlike its label `name`.
    """

    id: str
    name: str
    kind: str
    style: str  # how it is drawn: as its kind, or as a wildcard
    source: str
    destination: str
    d: str  # SVG path data of the shaft, as of the head and of the cross (`mark`) on a broken arrow
    head: str
    mark: str
    label: Label
    title: str
    broken: str | None  # why it can never fire
    lands: bool  # an `exit` of a machine that the source spawns
    watched: str  # the machine whose state it waits for: its name; else empty


class Port(TypedDict):
    """The point where an ``exit`` leaves the frame; `label` names the state it leads to."""

    x: float
    y: float
    name: str
    label: Label
    missing: bool


class Layout(TypedDict):
    """The drawing of one machine. Boxes are ``[left, top, width, height]``, all numbers px."""

    machine: str
    name: str
    view: list[float]
    frame: list[float]
    states: list[StateShape]
    transitions: list[TransitionShape]
    ports: list[Port]
    places: dict[str, Position]

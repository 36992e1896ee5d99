"""What a layout is made of: plain dicts that become JSON as they are."""

from __future__ import annotations

from typing import NotRequired, TypedDict

__all__ = ["Label", "Layout", "Port", "Position", "Start", "StateShape", "TransitionShape"]


class Position(TypedDict):
    """The middle of a node, in px; ``gone``: since when its state is not in the program, in seconds."""

    x: float
    y: float
    gone: NotRequired[float]


class Label(TypedDict):
    """A text and the box around it; `x`, `y` is the middle."""

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


class StateShape(TypedDict):
    """One state; `x`, `y` is the middle, in px.

    `kind` is ``state``, ``any`` (the ``*``) or ``missing``. `id` is the path as text. `machines` are
    the names of the nested ones, `nested` the same as shown under the state's name.
    """

    id: str
    name: str
    kind: str
    x: float
    y: float
    width: float
    height: float
    label: str
    nested: str
    machines: list[str]
    title: str
    start: Start | None


class TransitionShape(TypedDict):
    """One arrow. A transition with several sources has several, with the same `id`.

    `id` is the machine's path and the transition's id, which survives an edit of its condition or delay;
    `name` is its label, which does not.

    `kind` is the kind of transition; `style` says how it is drawn: as its kind, or ``wildcard``.
    `d`, `head`, `mark` are SVG path data of shaft, head and of the cross of a broken one; `broken`
    says why it can never be taken.
    """

    id: str
    name: str
    kind: str
    style: str
    source: str
    destination: str
    d: str
    head: str
    mark: str
    label: Label
    title: str
    broken: str | None


class Port(TypedDict):
    """Where an ``exit`` leaves the frame; `label` is the state of the enclosing machine."""

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

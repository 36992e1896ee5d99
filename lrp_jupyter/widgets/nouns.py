"""What the messages between page and kernel speak of: plain data, explained one by one.

The same types stand in ``js/src/nouns.ts``; a test holds the two equal. `protocol` has the messages.
"""

from __future__ import annotations

from typing import Any, Literal, NotRequired, TypedDict

__all__ = [
    "BridgeView",
    "ChoicesView",
    "ConflictView",
    "Difference",
    "ElementKind",
    "FindingView",
    "FiredView",
    "Floor",
    "HungView",
    "InkView",
    "IssueView",
    "Layout",
    "MachineItem",
    "MemberView",
    "OnActiveEdit",
    "PanelButton",
    "PanelField",
    "PanelQuestion",
    "PanelTable",
    "PanelView",
    "Part",
    "Point",
    "Pose",
    "PrintedView",
    "ProgramView",
    "QuickFix",
    "Range",
    "RateView",
    "RestartView",
    "RobotShape",
    "SettingsView",
    "Severity",
    "Solid",
    "SpeedView",
    "StateItem",
    "Status",
    "Stroke",
    "TextEdit",
    "TransitionItem",
    "TransitionKind",
    "ValueView",
    "WorldView",
    "Zone",
]

Part = Literal["lab", "controls", "editor", "tree", "graph", "variables", "issues", "world"]
Status = Literal["ready", "running", "paused", "hung", "stopped", "broken", "closed"]
Severity = Literal["error", "warning", "hint"]
OnActiveEdit = Literal["restart", "keep"]
ElementKind = Literal["machine", "state", "transition", "event", "variable", "robot"]
TransitionKind = Literal["on", "ontime", "eps", "exit"]
Point = tuple[float, float]
Pose = tuple[float, float, float]
Layout = dict[str, Any]  # as `lrp_jupyter.graph.layout` makes it; the page draws it


class Range(TypedDict):
    """A range of the text: lines and columns from 1, columns in characters, end exclusive."""

    line: int
    column: int
    end_line: int
    end_column: int


class TextEdit(TypedDict):
    """Replace a range by a text."""

    range: Range
    text: str


class QuickFix(TypedDict):
    """A certain remedy; its edits are places of the text that was answered."""

    title: str
    edits: list[TextEdit]


class FindingView(TypedDict):
    """A static finding of `check`."""

    code: str
    severity: Severity
    message: str
    range: Range
    fix: QuickFix | None


class IssueView(TypedDict):
    """A run-time issue. `range` is a place of the text with number `revision`, None if it has none."""

    id: int
    code: str
    severity: Severity
    kind: str
    element: str
    message: str
    revision: int
    range: Range | None
    traceback: str
    first_tick: int
    last_tick: int
    count: int
    resolved: bool


class ValueView(TypedDict):
    """A value as `Frame.variables` renders it, and as a number if it is a finite one (sparkline)."""

    text: str
    number: float | None


class StateItem(TypedDict):
    """A state and the paths of the machines nested in it."""

    path: str
    machines: list[str]


class TransitionItem(TypedDict):
    """A transition; `source` and `trigger` as the language writes them."""

    id: str
    kind: TransitionKind
    trigger: str
    source: str
    destination: str


class MachineItem(TypedDict):
    """A machine; `parent` is the path of the state it is nested in. Variables and events are paths."""

    path: str
    parent: str | None
    states: list[StateItem]
    transitions: list[TransitionItem]
    variables: list[str]
    events: list[str]


class ProgramView(TypedDict):
    """The running program without its blocks, machines in the order of `Program.walk`."""

    variables: list[str]
    events: list[str]
    machines: list[MachineItem]


class Difference(TypedDict):
    """What a held text would change, each element in words (``str(element)``)."""

    added: list[str]
    removed: list[str]
    changed: list[str]
    moved: list[str]


class RateView(TypedDict):
    """Ticks per second; `wanted` 0 means free."""

    wanted: float
    achieved: float


class SpeedView(TypedDict):
    """Simulated over real time; `wanted` 0 means as fast as possible."""

    wanted: float
    achieved: float


class FiredView(TypedDict):
    """How often something happened since the session began, and the tick of the last time."""

    count: int
    tick: int


class RestartView(TypedDict):
    """Restarts by an edit since the session began, tick and reason of the last one."""

    count: int
    tick: int
    reason: str


class HungView(TypedDict):
    """A block that does not return: ``follower/moving.running`` and for how long."""

    where: str
    seconds: float


class PrintedView(TypedDict):
    """Lines printed by blocks; `first` is the number of the first of them since the session began."""

    first: int
    lines: list[str]


class MemberView(TypedDict):
    """A member of `robot`: ``light.data``; `insert` is the text that a click puts into the program."""

    name: str
    kind: str
    type: str
    unit: str
    doc: str
    insert: str


class BridgeView(TypedDict):
    """The bridge. `status` is one of the words of `Bridge.status`, `sentence` explains it."""

    name: str
    status: str
    sentence: str
    hardware: bool
    armed: bool
    members: list[MemberView]


class PanelField(TypedDict):
    """One field of a bridge's panel; kind ``value`` is shown only. To take a choice may `press` a button."""

    key: str
    label: str
    kind: Literal["text", "number", "choice", "switch", "value"]
    value: str
    choices: list[str]
    unit: str
    press: str


class PanelButton(TypedDict):
    """A button of a panel, or of each row of a table."""

    key: str
    label: str


class PanelTable(TypedDict):
    """A table of a panel; `keys` name the rows."""

    key: str
    title: str
    columns: list[str]
    keys: list[str]
    rows: list[list[str]]
    buttons: list[PanelButton]


class PanelQuestion(TypedDict):
    """Something that the bridge needs to know before it connects, an address for example."""

    key: str
    text: str
    default: str
    button: str


class PanelView(TypedDict):
    """A bridge's panel: plain data, drawn by the lab."""

    title: str
    fields: list[PanelField]
    tables: list[PanelTable]
    buttons: list[PanelButton]
    questions: list[PanelQuestion]


class Stroke(TypedDict):
    """A line on the floor, in metres; grey from 0 (black) to 255. `ink` (of a pen) only darkens."""

    path: NotRequired[list[Point]]
    circle: NotRequired[Pose]
    arc: NotRequired[list[float]]
    width: NotRequired[float]
    grey: NotRequired[float]
    ink: NotRequired[bool]


class Floor(TypedDict):
    """What the light sensor sees."""

    grey: NotRequired[float]
    strokes: NotRequired[list[Stroke]]


class Solid(TypedDict):
    """Something to bump into. `box`: centre and size; `angle` in rad; `push`: a number if pushable."""

    box: NotRequired[list[float]]
    circle: NotRequired[Pose]
    angle: NotRequired[float]
    name: NotRequired[str]
    push: NotRequired[float | None]


class RobotShape(TypedDict):
    """A robot: pose (x, y, theta), radius, places of light sensors, (angle, reach) of distance sensors."""

    pose: Pose
    radius: NotRequired[float]
    light: NotRequired[list[Point]]
    bumper: NotRequired[bool]
    distance: NotRequired[list[Point]]


class Zone(TypedDict):
    """A region that a challenge speaks of."""

    circle: NotRequired[Pose]
    box: NotRequired[list[float]]


class WorldView(TypedDict):
    """The world as `World.to_dict` writes it (what is usual left out); `world/complete.ts` fills it in."""

    version: int
    name: NotRequired[str]
    open: NotRequired[bool]
    size: Point
    seed: int
    floor: Floor
    solids: list[Solid]
    robots: list[RobotShape]
    zones: dict[str, Zone]


class InkView(TypedDict):
    """Pen trails: keep the first `first` strokes of the ink, then these."""

    first: int
    strokes: list[Stroke]


class SettingsView(TypedDict):
    """Switches of the session that all its views share. `hold`: texts wait for ``apply``."""

    hold: bool
    on_active_edit: OnActiveEdit
    pause_on_issue: bool


class ConflictView(TypedDict):
    """Cell and lab were both changed: the cell's text, and a sentence. Ended by ``take`` or ``keep``."""

    text: str
    sentence: str


class ChoicesView(TypedDict):
    """Names of the bridges, of the bundled worlds, of the bundled programs."""

    bridges: list[str]
    worlds: list[str]
    programs: list[str]

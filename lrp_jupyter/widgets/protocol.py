# ruff: noqa: F403, F405  (all the nouns, to be imported from here too)
"""The messages between a lab in a page and its session in the kernel.

The same types stand in ``js/src/protocol.ts``; a test holds the two equal. What they speak of is in
`nouns` (``js/src/nouns.ts``), and can be imported from here too. All are JSON objects sent as
custom messages of the widget, told apart by ``type``. Fields that may be missing are `NotRequired`.

**Views.** Every picture of a lab in a page gives itself a random name, the ``view`` of every message. A
comm's messages reach all views of its widget, so each looks for its own name and drops the rest. The
kernel keeps for each view what it has sent and how much credit is left, and forgets it at ``bye``.

**Flow.** A view says `Hello` and gets one `Snapshot` (and a `WorldMessage`, if it shows a world). From then
on it gets `Frame` messages, at most 30 a second, each holding what changed since the last one *sent to this
view*. Every one carries a number, which the page sends back as `Credit` for it and all before it; the
kernel sends only while fewer than three are on their way. The page pays for two at a time, because the
kernel reports itself busy and idle for each message that it gets, and the host draws that; a frame that
comes alone is paid for at once. While nothing changes, an empty frame once a second is the heartbeat.
Everything that must not be lost in a frame left out is cumulative: counts of entries, firings, issues,
restarts.

**Text.** A view sends the whole text with a number of its own, ``seq``; one is on its way at a time, the
newest wins. The kernel gives each text a revision and answers to *all* views of the session: with ``seq``
and without the text to the sender, with ``seq`` 0 and the text to the others. It never sends a view the
text which that view typed.

**Commands and requests** with an ``id`` other than 0 get exactly one `Reply`, as soon as the session has
taken or refused them; ``error`` is one sentence. A page that hears nothing for 300 ms says "kernel busy".

**Places** are lines and columns from 1, columns in characters, as the language counts them; the end is
behind the last character. Only the page converts them to UTF-16 (`range_of` and `offset_of` convert to and
from the character offsets of Python).

**Names.** ``path`` is an element's path in the text, ``follower/looking/lookalgo``; a transition's is
``follower:tlooking``: the machine's path, a colon, its name or ``condition:from->to`` (`Machine.labels`).
"""

from __future__ import annotations

from typing import Literal, NotRequired, TypedDict

from lrp_jupyter.widgets.encoding import offset_of as offset_of
from lrp_jupyter.widgets.encoding import pack_poses as pack_poses
from lrp_jupyter.widgets.encoding import range_of as range_of
from lrp_jupyter.widgets.nouns import *

# ------------------------------------------------------------------ page -> kernel


class Hello(TypedDict):
    """A view is there, shows this part, and wants a `Snapshot`. Sent again when it has lost the thread."""

    type: Literal["hello"]
    view: str
    part: Part


class Bye(TypedDict):
    """A view goes; best effort, so a view without credit for long counts as gone too."""

    type: Literal["bye"]
    view: str


class Text(TypedDict):
    """The whole text of the editor. `base` is the last revision that the view knew."""

    type: Literal["text"]
    view: str
    seq: int
    base: int
    text: str


class Credit(TypedDict):
    """The frame with this number arrived, and with it all before it."""

    type: Literal["credit"]
    view: str
    frame: int


class Complete(TypedDict):
    """Complete a Python expression (``robot.li``) in the scope of a machine path ("" for the top level).

    The page itself completes keywords and the program's names. Answered by `options`.
    """

    type: Literal["complete"]
    view: str
    id: int
    prefix: str
    scope: str


class Hover(TypedDict):
    """What is this dotted name (``robot.light.data``) in that scope? Answered by `hover`."""

    type: Literal["hover"]
    view: str
    id: int
    chain: str
    scope: str


class References(TypedDict):
    """Whose name stands at this place of the last text sent? Answered by `references`."""

    type: Literal["references"]
    view: str
    id: int
    line: int
    column: int


class Inspect(TypedDict):
    """Look into an element, or (`into`: steps of earlier facets) into its value. Answered by `inspect`."""

    type: Literal["inspect"]
    view: str
    id: int
    kind: ElementKind
    path: str
    into: list[str]


Request = Complete | Hover | References | Inspect

Act = Literal[
    "run",
    "pause",
    "step",
    "step_back",
    "reset",
    "stop",
    "rate",
    "speed",
    "hold",
    "apply",
    "revert",
    "transition",
    "teleport",
    "fire",
    "set_variable",
    "rename",
    "drag_robot",
    "drag_solid",
    "drop",
    "stroke",
    "erase",
    "reset_pose",
    "reset_world",
    "world",
    "clear_issues",
    "pause_on_issue",
    "on_active_edit",
    "armed",
    "bridge",
    "select",
    "pin",
    "arrange",
    "panel",
    "load",
    "take",
    "keep",
    "save",
]


class Command(TypedDict):
    """Something that the person wants done.

    What each act uses:

    ========================================== ==========================================================
    ``run pause reset``                        nothing
    ``stop``                                   nothing: `stop_all`, then pause; must not wait for a tick
    ``step step_back``                         `value`: how many ticks (1 if missing)
    ``rate speed``                             `value`: Hz (0 is free), factor (0 is as fast as possible)
    ``hold pause_on_issue armed``              `on`
    ``apply``, ``revert``                      apply the held text; go back to the running program's text
    ``on_active_edit``                         `name`: restart or keep
    ``transition teleport``                    `path` of a state
    ``fire``                                   `path` of a transition
    ``set_variable``                           `path`, `expression`; the error comes in the reply
    ``rename``                                 `kind`, `path`, `name`; all views get the new text
    ``drag_robot drag_solid``                  `index`, `pose` while dragging; ``drop`` lets go
    ``stroke erase``                           `points`, `width` (and `grey`), in metres
    ``reset_pose``                             `index` of the robot
    ``reset_world``                            nothing
    ``world bridge``                           `name`
    ``clear_issues``                           nothing
    ``select``                                 `path` of the machine that this view looks at
    ``pin``                                    `path` of the machine, `name` of the node, `pose` (x, y, 0)
    ``arrange``                                `path` of the machine
    ``panel``                                  `key` of button (`row` of its table), `values` of all fields
    ``load``                                   `name` of a bundled program, becomes the text
    ``take keep``                              the answer to a conflict: the cell's text, the lab's text
    ``save``                                   `name`: the file to write
    ========================================== ==========================================================
    """

    type: Literal["command"]
    view: str
    id: int
    do: Act
    on: NotRequired[bool]
    value: NotRequired[float]
    name: NotRequired[str]
    path: NotRequired[str]
    kind: NotRequired[ElementKind]
    expression: NotRequired[str]
    index: NotRequired[int]
    pose: NotRequired[Pose]
    points: NotRequired[list[Point]]
    width: NotRequired[float]
    grey: NotRequired[int]
    key: NotRequired[str]
    row: NotRequired[str]
    values: NotRequired[dict[str, str]]


FromPage = Hello | Bye | Text | Credit | Request | Command


# ------------------------------------------------------------------ kernel -> page


class Frame(TypedDict):
    """What changed since the last frame sent to this view; a missing field has not changed.

    =============== =====================================================================================
    ``status``      the words of `lrp_jupyter.interpreter.frame.Frame`; ``reason`` explains it
    ``revision``    of the text that runs (the last one applied)
    ``active``      innermost active states, as spawned (``Interpreter.active`` as text)
    ``lit``         every active state by its path in the text, outer ones too: what the page marks
    ``entered``     state path -> entries, so that a visit too short to see leaves an afterglow
    ``fired``       transition -> firings; the one with the newest tick in its machine is marked
    ``variables``   path -> value, None once it is unset; only what changed
    ``events``      path -> value at its last test, None if it failed or was never tested
    ``members``     member of `robot` -> its value now, as text
    ``issues``      new or changed ones; ``gone``: ids of those cleared
    ``hung``        None once the block returned
    ``layouts``     machine path -> layout, those that changed (dragged, arranged)
    ``ink``         new trails and drawings of the world
    =============== =====================================================================================

    If something moved in the world, one buffer comes with it: where everything is now, made by
    `pack_poses`; 36 bytes for one robot.
    """

    type: Literal["frame"]
    view: str
    frame: int
    status: NotRequired[Status]
    reason: NotRequired[str]
    tick: NotRequired[int]
    time: NotRequired[float]
    rate: NotRequired[RateView]
    speed: NotRequired[SpeedView]
    revision: NotRequired[int]
    active: NotRequired[list[str]]
    lit: NotRequired[list[str]]
    entered: NotRequired[dict[str, FiredView]]
    fired: NotRequired[dict[str, FiredView]]
    variables: NotRequired[dict[str, ValueView | None]]
    events: NotRequired[dict[str, bool | None]]
    members: NotRequired[dict[str, str]]
    issues: NotRequired[list[IssueView]]
    gone: NotRequired[list[int]]
    restart: NotRequired[RestartView]
    hung: NotRequired[HungView | None]
    printed: NotRequired[PrintedView]
    bridge: NotRequired[BridgeView]
    panel: NotRequired[PanelView | None]
    settings: NotRequired[SettingsView]
    conflict: NotRequired[ConflictView | None]
    layouts: NotRequired[dict[str, Layout]]
    ink: NotRequired[InkView]


class Answer(TypedDict):
    """The session has read a text, and how it took it.

    `seq` is the receiver's own, or 0 where another view, a rename, a load or a cell brought the text, which
    then comes along. `accepted`: it is a program; `applied`: it runs now; `reason` says why not, or why it
    restarted. `program` and `layouts` are None (or lack machines) where nothing changed; a machine that is
    gone simply is not in `program`. `pending` is what a held text would change.
    """

    type: Literal["answer"]
    view: str
    seq: int
    revision: int
    text: str | None
    findings: list[FindingView]
    accepted: bool
    applied: bool
    reason: str
    program: ProgramView | None
    layouts: dict[str, Layout] | None
    pending: Difference | None


class Snapshot(TypedDict):
    """Everything, for a view that has just come.

    `running` is the text that runs, `text` the editor's. Its frame is paid for like any other.
    """

    type: Literal["snapshot"]
    view: str
    name: str
    text: str
    revision: int
    running: str
    findings: list[FindingView]
    program: ProgramView
    layouts: dict[str, Layout]
    pending: Difference | None
    choices: ChoicesView
    world: WorldView | None
    frame: Frame


class WorldMessage(TypedDict):
    """The world changed other than by movement and ink (or there is none any more)."""

    type: Literal["world"]
    view: str
    world: WorldView | None


class Option(TypedDict):
    """One completion; `detail` stands beside it (a live value), `info` in its card."""

    label: str
    kind: str
    detail: str
    info: str


class HoverView(TypedDict):
    """A card about a name."""

    title: str
    type: str
    value: str
    doc: str


class ReferencesView(TypedDict):
    """An element, the place that defines it, and every place that names it (the definition included)."""

    kind: ElementKind
    path: str
    name: str
    definition: Range | None
    references: list[Range]


class Facet(TypedDict):
    """One line of an inspected object; `step` leads into it."""

    step: str
    label: str
    type: str
    text: str
    deep: bool


class InspectView(TypedDict):
    """An inspected object; `more` counts the facets left out."""

    title: str
    type: str
    text: str
    source: str
    facets: list[Facet]
    more: int


class Reply(TypedDict):
    """The one answer to a command or request with this id."""

    type: Literal["reply"]
    view: str
    id: int
    error: str | None
    options: NotRequired[list[Option]]
    hover: NotRequired[HoverView | None]
    references: NotRequired[ReferencesView | None]
    inspect: NotRequired[InspectView]


FromKernel = Frame | Answer | Snapshot | WorldMessage | Reply

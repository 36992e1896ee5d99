"""The messages from the kernel to a page, their parts, and how the two sides cooperate.

This module and what a page sends (`acts`) are the protocol; every build of the page generates
``js/src/protocol.ts`` from them. All messages are JSON objects, distinguished by ``type``. They are sent as
texts, in custom messages ``{"json": "…"}`` of the widget, because notebooks differ in what they make of
``None``, null and subclasses of `str`. Fields that may be missing are `NotRequired`. What the package has as
a dataclass is sent as it is, field by field (`as_fields` of `packing`).

**Views.** Every view of a lab in a page has a random name of its own, the ``view`` of every message. A
comm's messages reach all views of its widget, so each keeps those with its own name. The
kernel keeps for each view what it has sent and how much credit is left, and forgets it at ``bye``.

**Flow.** A view sends `HelloMessage` and gets one `SnapshotMessage`. From then on it gets `FrameMessage`,
at most 30 a second, each holding what changed in the `ViewState` since the last one *sent to this view*
(and a `WorldMessage`, if it shows a world that changed). Every frame carries a number; whatever the page says
next acknowledges it, and all before it. The kernel sends only while few are in flight: three at first, and
more to a quick page or over a slow link (`Window` in `publisher`). A frame that ``asks`` is acknowledged at
once, by a `CreditMessage`. Few ask, because the kernel reports itself busy and idle for each message that it
gets, and the host draws that. While nothing changes, an empty frame once a second is the heartbeat.
Everything that must not be lost in a frame left out is cumulative: counts of entries, firings, issues,
restarts; what moved is listed by revision.

**Text.** The kernel has the text; an editor may be ahead of it. A view sends `TextMessage`: its changes to
the text of a revision, with a number of its own, ``seq``; one is in flight at a time, and what is typed
meanwhile is sent in the next one. The kernel maps the changes over what others did since that revision, so
that nothing has to be sent twice however slow the link is; each becomes an update with the next revision
(`Document`). What comes from elsewhere, such as a cell that is run again, is an update of the kernel. When
the session has read the text, `AnswerMessage` goes to *all* views, with the updates since the answer
before. A view applies them in the order of the answers' numbers, each once: its own confirm what it has
typed, others' are mapped over what is not confirmed yet. Changes are those of CodeMirror, mapped one by one
on both sides, so all come to one text.

The text of editors has line feeds between its lines, whatever the program has, and its places are UTF-16
units (`changes`). Where the cursor is comes with a text, or alone as `CursorMessage`: what is half typed at
any cursor is not meant yet, and other views show the cursor (``hands`` of `ViewState`).

After a lost connection, ``hello`` names the revision that the view knows, and the snapshot has the updates
since; texts that are on their way then never count, and the view sends what they contained again. If the
kernel does not know the revision any more, the page gives its text back by ``recover``: a conflict.

**Commands and requests** with an ``id`` other than 0 get exactly one `ReplyMessage`, as soon as the session
has applied or refused them; ``error`` is one sentence. The reply to a change of the world comes after the
`WorldMessage` about it: until then the page shows what it has sent. A page that gets other messages, and no
answer, for 300 ms shows "kernel busy"; in silence it knows nothing, and after three seconds shows that.

**Places** are lines and columns from 1, columns in characters, as the language counts them; the end is
after the last character. Only the page converts them to UTF-16 (`range_of` and `offset_of` of `page_places`
convert to and from the character offsets of Python).

**Names.** ``path`` is an element's path in the text, ``follower/looking/lookalgo``; a transition's is
``follower:tlooking``: the machine's path, a colon, its name or ``kind:from->to`` (`Machine.ids`).
`path_of` and `id_of` of `page_places` convert. In a dataclass of the package, a transition's path has slashes
alone, ``follower/tlooking``. A machine may run several times, so an instance and its variables are named by
their paths *as spawned*, ``m/left/follow/side``. What a page sends may be either; a path in the text means
the only instance.
"""

from __future__ import annotations

from typing import Literal, NotRequired, Required, TypedDict

from lrp_jupyter.bridges.panel import Panel
from lrp_jupyter.errors import Severity
from lrp_jupyter.graph.layout_parts import Layout
from lrp_jupyter.language.triggers import TransitionKind
from lrp_jupyter.live.running.breakpoint import BreakpointKind
from lrp_jupyter.live.running.frame import Hung, Status
from lrp_jupyter.sim.world import Point, Pose
from lrp_jupyter.widgets.wire.changes import Sections

OnActiveEdit = Literal["restart", "keep"]
Hints = Literal["sentences", "changes"]
Edits = Literal["live", "hold"]
GraphMode = Literal["live", "static", "hidden"]
CriterionState = Literal["open", "so far", "met", "failed"]
RunVerdict = Literal["waiting", "passed", "failed", "problem"]
OneWay = Literal["never true", "never false", "never tested"]
ElementKind = Literal["machine", "state", "transition", "event", "variable", "robot"]
CountAndTick = tuple[int, int]
"""How often something happened since the session began, and the tick of the last time."""
TextAndNumber = tuple[str, float | None]
"""A value as `Frame.variables` renders it, and as a number if it is a finite one (sparkline)."""


class BreakpointView(TypedDict):
    """A breakpoint: `path` as the page writes that of its element, empty for a condition."""

    kind: BreakpointKind
    path: str
    name: str
    expression: str
    machine: str
    instance: str  # the one that is meant, as spawned; empty for any
    enabled: bool
    hits: int  # counted whether it is enabled or not
    after: int  # the first hit at which it pauses
    dormant: bool  # its element is missing
    problem: str  # why its condition could not be evaluated
    line: int  # of its element, or 0


class HitView(TypedDict):
    """The breakpoint that paused the program: its number, the sentence about it, and its hits."""

    number: int
    text: str
    hits: int


class TextRange(TypedDict):
    """A range of the text: lines and columns from 1, columns in characters, end exclusive."""

    line: int
    column: int
    end_line: int
    end_column: int


class TextEdit(TypedDict):
    """Replace a range by a text."""

    range: TextRange
    text: str


class QuickFix(TypedDict):
    """A certain remedy; its edits are places of the text that was answered."""

    title: str
    edits: list[TextEdit]


class FindingView(TypedDict):
    """A static finding of `check`; `id` identifies it among the others of its text."""

    id: str
    code: str
    severity: Severity
    message: str
    range: TextRange
    fix: QuickFix | None
    creates: QuickFix | None  # only offered, because only the user knows what is meant


class IssueView(TypedDict):
    """A run-time issue. `range` is a place of the running text, None if it has none."""

    id: int
    code: str
    severity: Severity
    kind: str
    element: str
    message: str
    range: TextRange | None
    finding: str  # id of the static finding about the same fault of the text: a page lists the two as one
    traceback: str
    first_tick: int
    last_tick: int
    count: int
    resolved: bool
    instances: list[str]  # in which it occurred, by path as spawned, if its machine can run in several places


class OutdatedView(TypedDict):
    """What a variable was computed from has been assigned by hand since."""

    computed: str  # from which variable and when, a sentence
    initial: str  # the expression that recomputes it; empty if its initialiser is not an expression


class InstanceView(TypedDict):
    """A machine that runs: its path as spawned, and the one in the text."""

    path: str
    machine: str
    settings: str  # what its spawn initialises: `side 2, keep 0.25`


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
    """The running program without its blocks, machines in the order of `Program.walk`; `main` as there."""

    variables: list[str]
    events: list[str]
    machines: list[MachineItem]
    main: str


class Difference(TypedDict):
    """The changes in a held text, each element as text (``str(element)``)."""

    added: list[str]
    removed: list[str]
    changed: list[str]
    moved: list[str]


class MovedElement(TypedDict):
    """An element that an edit or a rename kept under another path."""

    kind: ElementKind
    old: str
    new: str


class RestartView(TypedDict):
    """A restart by an edit. The view state lists the last ones by their number, from 1."""

    tick: int
    reason: str


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
    failsafe: str  # who stops the robot when the program or the computer dies; empty for a simulated one
    members: list[MemberView]


class StrokeView(TypedDict):
    """A line on the floor, in metres; grey from 0 (black) to 255. `ink` (of a pen) only darkens."""

    path: NotRequired[list[Point]]
    circle: NotRequired[Pose]
    arc: NotRequired[list[float]]
    width: NotRequired[float]
    grey: NotRequired[float]
    ink: NotRequired[bool]


class FloorView(TypedDict):
    """The floor, as the light sensor sees it."""

    grey: NotRequired[float]
    strokes: NotRequired[list[StrokeView]]


class SolidView(TypedDict):
    """A solid. `box`: centre and size; `angle` in rad; `push`: a number if pushable."""

    box: NotRequired[list[float]]
    circle: NotRequired[Pose]
    angle: NotRequired[float]
    name: NotRequired[str]
    push: NotRequired[float | None]
    patrol: NotRequired[list[Point]]  # its middle passes through them; the first one again: it goes round


class RobotShape(TypedDict):
    """A robot: pose (x, y, theta), radius, places of light sensors, (angle, reach) of distance sensors."""

    pose: Pose
    name: NotRequired[str]  # where there are several
    radius: NotRequired[float]
    light: NotRequired[list[Point]]
    bumper: NotRequired[bool]
    distance: NotRequired[list[Point]]


class ZoneView(TypedDict):
    """A region that a challenge refers to."""

    circle: NotRequired[Pose]
    box: NotRequired[list[float]]


class WorldView(TypedDict):
    """The world as `World.to_dict` writes it, without default values, which the page fills in."""

    version: int
    name: NotRequired[str]
    open: NotRequired[bool]
    size: Point
    seed: int
    floor: FloorView
    solids: list[SolidView]  # where they are now
    robots: list[RobotShape]
    zones: dict[str, ZoneView]
    edited: NotRequired[bool]  # it is not what was loaded
    undo: NotRequired[bool]  # there is an edit to undo
    redo: NotRequired[bool]


class InkView(TypedDict):
    """Pen trails: keep the first `first` strokes of the ink, then these."""

    first: int
    strokes: list[StrokeView]


class SettingsView(TypedDict):
    """Switches of the session that all its views share; the first four are the `Conditions` of a study."""

    edits: Edits
    graph: GraphMode
    quiet: bool
    lock: bool  # the kernel refuses the acts `hold` and `graph`
    log: str  # the file that records what a person looks at, reported by `looked`; empty: nothing is
    on_active_edit: OnActiveEdit
    pause_on_issue: bool


class CellView(TypedDict):
    """The notebook's cell with the program: what the page knows it by, and writes into a new one."""

    given: int  # how often a cell has given a text
    line: str  # the first line of such a cell
    text: str  # the last one that was given, or that a page has put there
    is_saved: bool  # it, a new cell, or a file of the user's choice has the lab's text


class ConflictView(TypedDict):
    """Another text than the present one, and a question. Ended by ``take`` or ``keep`` with its number."""

    number: int
    text: str
    sentence: str
    use: str  # the label of this answer
    keep: str


class VersionView(TypedDict):
    """An earlier text; `when` in seconds since 1970, `key` names it."""

    key: str
    when: float
    text: str


class UpdateView(TypedDict):
    """Changes to the text that a view made, or the kernel if `view` is empty."""

    view: str
    changes: Sections


class HandView(TypedDict):
    """Where the selection in an editor is, in the text of this revision; None without one."""

    revision: int
    selection: tuple[int, int] | None


class CriterionView(TypedDict):
    """A criterion of a challenge, and what it says of the present run, with the measured figure."""

    sentence: str
    state: CriterionState
    reason: str


class OutlineView(TypedDict):
    """A world of a challenge as a small picture: paths of SVG, in metres, with y downwards."""

    name: str
    width: float
    height: float
    solids: str
    line: str
    zones: str


class AttemptView(TypedDict):
    """A run that a check has made: in which world, how it ended, the robot's path in its outline."""

    world: int
    seed: int
    passed: bool
    failed: str  # what was not met
    reason: str
    share: float
    shows: bool  # whether it can be shown in the timeline
    path: str


class CheckView(TypedDict):
    """A check of the program: how many runs were made of all, and the points; ``attempts`` are the runs."""

    busy: bool
    stale: bool  # the text has changed since
    done: int
    total: int
    passed: bool
    points: float
    error: str  # why the check has ended without a result


class GoalView(TypedDict):
    """The challenge that a program is written for."""

    name: str
    task: str
    points: float
    seconds: float  # the longest time of a run
    over: bool  # whether the present run is decided
    world: int  # the number of the world of the present run
    worlds: list[OutlineView]
    note: str  # a sentence about what is not as in the challenge
    hints: list[str]  # that were asked for
    more_hints: int
    code: str  # of the text, to be written down in an exam; otherwise empty
    hidden: int  # worlds in which only a teacher runs the program
    check: CheckView | None
    begun: int  # how often the robot was put back to its start here
    trail: list[tuple[float, float, float, str]]  # of a run shown then: time, x, y, innermost active state
    keeps: bool  # whether a run of a check can be an example: not if the program is to be edited meanwhile


class KeptRunView(TypedDict):
    """A run that is kept beside the program, run again with the present text."""

    expected: str  # what is expected of it, in one line
    seconds: float  # its length; 0 until it has been run again
    state: RunVerdict
    reason: str  # why it failed, or why there is no verdict; else empty
    differs: tuple[float, str] | None  # the first difference from the recording: seconds, a sentence
    open_loop: str  # a sentence, if recorded readings do not answer to what is commanded any more; else empty
    lane: str  # the machine that the strips are of, as spawned
    recorded: list[tuple[float, str]]  # when (s) it entered which state, by path of definition; "": it ended
    now: list[tuple[float, str]]
    issues: int  # that the program has at the end


class CoverageView(TypedDict):
    """What the kept runs have reached of the program, by path of definition: the numbers of the runs."""

    states: dict[str, list[int]]  # in which each state was entered
    transitions: dict[str, list[int]]  # in which each transition fired
    conditions: dict[str, OneWay]  # of transitions: how those came out that did not come out both ways
    words: str  # all of this in sentences


class RunsView(TypedDict):
    """The runs that are kept beside a program; ``kept_runs`` are the runs."""

    folder: str  # where new ones are kept
    attached: list[str]  # further folders
    names: list[str]  # of the runs, in the order in which they are shown
    expected: str  # what to expect of the present run if it is kept, as a proposal
    keeps: str  # why the present run cannot be kept; empty if it can
    coverage: CoverageView | None  # None until all runs have been run again
    error: str  # why the runs cannot be shown or run again


class FoundChangeView(TypedDict):
    """A small change that makes the program pass more runs."""

    sentence: str
    line: int  # from 1


class SearchView(TypedDict):
    """The search for the smallest change that makes the program pass its challenge and its kept runs."""

    busy: bool
    made: int  # runs
    planned: int  # runs so far
    changes: list[FoundChangeView]  # the best one first
    answer: str  # what is to be said beside the changes, in sentences; empty before the end
    stale: bool  # the text has changed since
    error: str  # why the search has ended without a result


class ChoicesView(TypedDict):
    """Names of the bridges, of worlds (bundled ones and files), of the bundled programs."""

    bridges: list[str]
    worlds: list[str]
    programs: list[str]


# ------------------------------------------------------------------ kernel -> page


class ViewState(TypedDict):
    """Everything that a view may show of a session, apart from its texts and its world."""

    status: Status
    reason: str  # of the status
    tick: int
    time: float
    rate: float  # wanted ticks per second, 0: as many as possible
    achieved_rate: float  # measured
    speed: float  # wanted simulated seconds per second, 0: as many as possible
    achieved_speed: float  # measured
    revision: int  # of the text that runs, the last one applied
    program: ProgramView
    layouts: dict[str, Layout]  # by machine path
    moved: dict[str, list[MovedElement]]  # revision of the run -> what has another path since; the last ones
    active: list[str]  # innermost active states, as spawned: `Interpreter.active` as text
    lit: list[str]  # every active state by its path in the text, outer ones too: what the page marks
    users: dict[str, str]  # by such a path, if its machine runs in several states: the names of these
    entered: dict[str, CountAndTick]  # by state path, so that a visit too short to see leaves an afterglow
    fired: dict[str, CountAndTick]  # by transition; the one with the newest tick in its machine is marked
    instances: list[InstanceView]  # the machines that run, outer before inner
    variables: dict[str, TextAndNumber]  # by path as spawned, of those that exist now
    outdated: dict[str, OutdatedView]  # by path as spawned
    countdowns: dict[str, tuple[float, float]]  # by transition as spawned: since (s), how long (ms)
    events: dict[str, bool]  # by path as spawned: the value at its last test, if that returned one
    members: dict[str, str]  # member of `robot` -> its value now, as text
    issues: dict[str, IssueView]  # by number
    printed: dict[str, str]  # number of the line since the session began -> line; the last ones
    restarts: dict[str, RestartView]
    hung: Hung | None  # None unless a block does not return
    breakpoints: dict[str, BreakpointView]  # by number
    paused_by: HitView | None  # the breakpoint that paused the program, until it runs on
    bridge: BridgeView
    panel: Panel | None
    settings: SettingsView
    conflict: ConflictView | None
    cell: CellView
    looking: LookingView | None  # the earlier moment that everything here shows, or None for now
    unkept: str  # why the text is not kept in its file; empty if it is
    late: str  # why a stop in a page may come late; empty if it comes while a cell runs
    hands: dict[str, HandView]  # by view; empty where only one has an editor
    goal: GoalView | None
    criteria: list[CriterionView]  # what the criteria of the challenge say of the present run
    attempts: dict[str, AttemptView]  # by the number of a run of the check
    runs: RunsView | None  # None where there are none, as in the page of a lesson
    kept_runs: dict[str, KeptRunView]  # by name
    search: SearchView | None  # None where it is not offered: it gives answers away


class FrameMessage(ViewState, total=False):
    """What changed in the view state since the last frame sent to this view.

    A field that is missing has not changed. Of an object only the changed entries are sent, None for one
    that is gone (see `difference` in `view_state`); other fields are sent in full. If something moved in the
    world, one buffer comes with it: where everything is now, made by `pack_poses`; 36 bytes for one robot.
    """

    type: Required[Literal["frame"]]
    view: Required[str]
    frame: Required[int]
    asks: bool  # it is to be acknowledged at once, and not by what the page says next
    ink: InkView  # new trails of pens
    says: list[str]  # what each robot says; empty if none says anything


class AnswerMessage(TypedDict):
    """The answer to a text that the session has read; all views get all of them, numbered from 1."""

    type: Literal["answer"]
    view: str
    number: int
    seq: int  # of the receiver's own text, or 0
    revision: int
    updates: list[UpdateView]  # lead to the text's revision from that of the answer before
    findings: list[FindingView]  # none yet of a text that is half typed, and not a program
    accepted: bool  # it is a program
    applied: bool  # it runs now
    reason: str  # why it does not run, or why it restarted
    half_typed: bool  # something waits, or is not marked, until a word at a cursor is meant or left
    running: str | None  # the running text where that is neither this text nor an earlier one
    pending: Difference | None  # what a held text would change


class SnapshotMessage(TypedDict):
    """Everything, for a view that has just opened, or lost its connection."""

    type: Literal["snapshot"]
    view: str
    name: str
    home: str  # distinguishes programs of the same name
    tab_only: bool  # the kernel keeps no text, so what the page keeps ends with its tab
    debugger: str  # begins the command that debugs an issue in a cell; empty where there are no cells
    by_hand: str  # how the text gets into a notebook that the page cannot write into; empty if there is none
    document: str  # distinguishes texts of other kernels
    number: int  # answers up to this one are contained in it
    seq: int  # texts of the view up to this one are contained in it, apart from those that never arrived
    text: str  # the editor's
    revision: int
    updates: list[UpdateView] | None  # lead to it from the revision that the view knows; None: not known
    running: str  # the running text
    findings: list[FindingView]
    accepted: bool  # the text is a program
    half_typed: bool  # as in an answer
    pending: Difference | None
    choices: ChoicesView
    world: WorldView | None
    frame: FrameMessage  # acknowledged like any other


class WorldMessage(TypedDict):
    """The world has changed other than by movement and ink, or no longer exists."""

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
    definition: TextRange | None
    references: list[TextRange]


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


class WhyLine(TypedDict):
    """A line of the program that an answer mentions."""

    line: int
    text: str


class WhyView(TypedDict):
    """Why something happened, or did not; `present`: whether its lines are those of the running text."""

    code: str
    name: str  # what its sentence calls the transition or state that was asked about
    tick: int
    time: float
    sentence: str
    lines: list[WhyLine]
    present: bool


class ExplanationView(TypedDict):
    """What a code means; its `address` is the one in the documentation."""

    code: str
    title: str
    explanation: str
    example: str
    script: str
    remedy: str
    repaired: str
    address: str


class LookingView(TypedDict):
    """An earlier moment that the lab shows, `ago` seconds ago; `edited`: the program was edited meanwhile."""

    tick: int
    time: float
    ago: float
    edited: bool


class ReplyMessage(TypedDict):
    """The one reply to a command or request with this id; of a request, with what its function returns."""

    type: Literal["reply"]
    view: str
    id: int
    error: str | None


FromKernel = FrameMessage | AnswerMessage | SnapshotMessage | WorldMessage | ReplyMessage

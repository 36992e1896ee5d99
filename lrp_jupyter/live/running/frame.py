"""Frames: frozen snapshots of a run for views, made between two ticks.

A view sees only some of the frames. Events that must not be missed (visits, firings, restarts) are therefore
counted from the beginning: the difference between two frames shows what happened between them, however many
were skipped. The interpreter does the counting, so it does not depend on frames being made.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.by_path import ByPath
from lrp_jupyter.interpreter.countdowns import Countdown
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.interpreter.variables import Outdated
from lrp_jupyter.language.lookup import called, means, missing
from lrp_jupyter.language.program import Path, Program, path_text
from lrp_jupyter.language.successors import Successors
from lrp_jupyter.live.running.breakpoint import Breakpoint

_NONE = Program()

Status = Literal["ready", "running", "paused", "hung", "stopped", "broken", "closed"]


@dataclass(frozen=True, slots=True)
class Hung:
    """A block, or the robot, that does not return.

    `where`: the block (``a.running``), the value of a variable being rendered (``x.__repr__``), ``the
        robot``, ``a command``, ``a listener`` or ``an observer``.
    `seconds`: how long it has been running, in wall time.
    `line`: the line of the program that is running, from 1; 0 if unknown.
    `held`: whether an interruption had no effect: it is inside a call that Python cannot interrupt.
    """

    where: str
    seconds: float
    line: int = 0
    held: bool = False

    def __str__(self) -> str:
        place = f" (line {self.line})" if self.line else ""
        name = _UNNAMED.get(self.where, f"`{self.where}` has run")
        what = f"{name} for {self.seconds:.0f} s{place}."
        if self.held:
            return (
                f"{what} It was interrupted, but Python cannot end the call that it is in, such as a "
                "`sleep` or one long computation. Wait until the call returns, or restart Python."
            )
        if not self.line:
            return what
        return f"{what} A block must end at once: use a state with `ontime` instead of waiting in a block."


@dataclass(frozen=True, slots=True)
class Hit:
    """A breakpoint that paused the program.

    `number`: the number of the breakpoint.
    `what`: what happened: ``"`looking` was entered"``.
    `count`: how often the breakpoint was hit.
    """

    number: int
    what: str
    count: int
    tick: int

    def __str__(self) -> str:
        return f"{self.what} (breakpoint {self.number}, {_ordinal(self.count)} time)."


def _ordinal(number: int) -> str:
    teen = number % 100 in (11, 12, 13)
    return f"{number}{'th' if teen else {1: 'st', 2: 'nd', 3: 'rd'}.get(number % 10, 'th')}"


_UNNAMED = {
    "the robot": "The robot has not answered",
    "a command": "A command has not returned",
    "a listener": "A listener has not returned",
    "an observer": "An observer has not returned",
}


@dataclass(frozen=True, slots=True, repr=False)
class Frame:
    """A snapshot of a run.

    Parameters
    ----------
    status : str
        ``ready`` (not started), ``running``, ``paused``, ``hung`` (a block does not return),
        ``stopped``, ``broken`` (a fault that is not the program's) or ``closed``.
    reason : str
        The reason for the status, a sentence; may be empty.
    tick : int
        Number of completed ticks.
    time : float
        Seconds of the run, without pauses.
    active : tuple of paths
        The innermost active states, as spawned.
    values : mapping of path to object
        The values of the variables: the objects themselves, so that a list shows what it holds *now*. Read
        by path (``"follower/nobump"``, also as a tuple) or by an unambiguous name (``"nobump"``), as are
        `variables` and `numbers`.
    variables : mapping of path to str
        The same values as text, bounded in depth and length. While the program runs, the text of a value
        whose rendering takes long may be older than the frame.
    numbers : mapping of path to float
        The values that are numbers.
    outdated : mapping of path to Outdated
        Those variables that were computed from one that has been assigned by hand since: ``source`` (its
        path), ``computed`` (when, in seconds) and ``initial`` (the initialiser, if it is an expression).
    visits, visited_at : mapping of path to int
        How often each state was entered, and in which tick last. By path of definition: a machine
        that several states spawn is counted once, wherever it ran. States never entered are absent.
    fired, fired_at : mapping of path to int
        How often each transition fired, and in which tick last, by path of definition: that of its
        machine, then its id. Transitions that never fired are absent.
    events : mapping of path to bool or None
        The result of the last test of each event, None if it failed, by path as spawned: an event of a
        machine that does not run is absent. Empty unless events are watched.
    countdowns : mapping of path to Countdown
        The transitions that wait for a time, by path as spawned: that of their machine, then their id. Each
        has ``since`` (when the time began, in seconds) and ``delay`` (how long it is, in milliseconds).
    issues : tuple of Issue
    restarts : int
        How often the program was restarted; `restart_reason` says why the last time.
    revision : int
        How many edits, renames and rewinds have taken effect.
    moved : tuple of (int, Successors)
        The last edits and renames that changed paths: for each the revision that it led to, and the map
        from old elements to new ones.
    patch_reason : str
        A sentence about the last edit, for example why it is not applied yet; may be empty.
    program : Program
        The program that runs.
    readings : mapping of str to object
        What the program read from the robot in this tick, by dotted name; of a simulated robot every reading.
    rate, achieved_rate : float
        Ticks per second, requested (0: as many as possible) and measured.
    speed, achieved_speed : float
        Seconds of the run per second of wall time, requested and measured.
    printed : int
        Lines that the blocks have printed.
    bridge : str
        The status of the bridge, a sentence.
    robot : object
        The bridge's snapshot of its robot, also frozen; None if it has none.
    hung : Hung or None
        The block that does not return, while `status` is ``hung``.
    paused_by : Hit or Issue or None
        The breakpoint or the issue that paused the program, until it runs on.
    breakpoints : tuple of Breakpoint
        All of them, by number.

    Examples
    --------
    >>> from lrp_jupyter import Session
    >>> with Session("(var n := [0]) (machine m (state a (running [n += 1]))) (spawn m a)") as session:
    ...     session.run(1)
    ...     frame = session.frame
    True
    >>> frame
    <Frame: paused, tick 10, 1 s, m/a active>
    >>> frame.values["n"], frame.variables["n"], frame.is_active("a")
    (10, '10', True)
    """

    status: Status = "ready"
    reason: str = ""
    tick: int = 0
    time: float = 0.0
    active: tuple[Path, ...] = ()
    values: ByPath[object] = field(default_factory=ByPath)
    variables: ByPath[str] = field(default_factory=ByPath)
    numbers: ByPath[float] = field(default_factory=ByPath)
    outdated: Mapping[Path, Outdated] = field(default_factory=dict)
    visits: Mapping[Path, int] = field(default_factory=dict)
    visited_at: Mapping[Path, int] = field(default_factory=dict)
    fired: Mapping[Path, int] = field(default_factory=dict)
    fired_at: Mapping[Path, int] = field(default_factory=dict)
    events: Mapping[Path, bool | None] = field(default_factory=dict)
    countdowns: Mapping[Path, Countdown] = field(default_factory=dict)
    issues: tuple[Issue, ...] = ()
    restarts: int = 0
    restart_reason: str = ""
    revision: int = 0
    moved: tuple[tuple[int, Successors], ...] = ()
    patch_reason: str = ""
    program: Program = field(default_factory=Program)
    readings: Mapping[str, object] = field(default_factory=dict)
    rate: float = 0.0
    achieved_rate: float = 0.0
    speed: float = 1.0
    achieved_speed: float = 0.0
    printed: int = 0
    bridge: str = ""
    robot: object = None
    hung: Hung | None = None
    paused_by: Hit | Issue | None = None
    breakpoints: tuple[Breakpoint, ...] = ()

    def __repr__(self) -> str:
        active = ", ".join(map(path_text, self.active)) or "nothing"
        return f"<Frame: {self.status}, tick {self.tick}, {self.time:g} s, {active} active>"

    def is_active(self, state: str | Path) -> bool:
        """Return whether a state is active, at any depth.

        Parameters
        ----------
        state : str or path
            A bare name (``"moving"``), a path as text (``"follower/moving"``) or as a tuple.
        """
        return is_active(state, self.active, self.program)

    def count_of(self, state: str | Path) -> int:
        """Return how often states of this name or path, of definition or as spawned, were entered."""
        return sum(count for path, count in self.visits.items() if means(self.program, state, path))


def is_active(state: str | Path, active: tuple[Path, ...], program: Program = _NONE) -> bool:
    """Return whether a state is among the active ones, or encloses one of them.

    `program`: the program in which they are active; without it, `state` is a path as spawned or a name.
    """
    return any(means(program, state, path[:end]) for path in active for end in range(2, len(path) + 1, 2))


def missing_state(state: str | Path, program: Program) -> UnknownElementError | None:
    """Return an error if a program has no such state; None if it has one or several."""
    return None if called(program, "state", state) else missing([program], ["state"], state)

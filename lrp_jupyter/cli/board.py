"""The live display of a run: a board redrawn in place; printed lines scroll above it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest
from textwrap import wrap

from rich.cells import cell_len
from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.text import Text

from lrp_jupyter.cli.excerpt import excerpt
from lrp_jupyter.cli.map import framed
from lrp_jupyter.language.program import Path, path_text
from lrp_jupyter.live.running.frame import Frame

_STATUS = {"running": ("▶", "bold green"), "paused": ("⏸", "bold yellow"), "hung": ("✋", "bold red")}
_ISSUES = 4  # shown at the same time, at most
_LEFT = 32  # characters of the left column
BESIDE = 76
"""Width in columns from which the map is shown beside the states instead of below them."""
_BEGIN, _END = "\x1b[?2026h", "\x1b[?2026l"  # synchronized output: unknown modes are ignored


@dataclass(frozen=True)
class BoardState:
    """Everything that the board shows at one moment: its view state."""

    frame: Frame
    name: str = ""  # of the program
    where: str = ""  # the robot
    map: Sequence[str] = ()  # rows of the sketch of the world
    readings: Sequence[tuple[str, str]] = ()  # members of the robot that the program reads, and their values
    since: Mapping[Path, float] = field(default_factory=dict)  # when the active states were entered
    last: Sequence[str] = ()  # the last transitions, the newest first
    changed: frozenset[Path] = frozenset()  # variables, since the last redraw
    keys: bool = False  # whether the keyboard is read
    differs: str = ""  # why the file on disk is not what runs, a sentence
    trouble: str = ""  # why the robot does not move: it is lost, or its data are too old


class Board:
    """A live display in the terminal; a context manager that restores the cursor at its end."""

    def __init__(self, console: Console) -> None:
        self.console = console
        self._live = Live(console=console, auto_refresh=False, vertical_overflow="crop")
        self._rows: dict[str, int] = {}  # most lines of each part so far: parts never shrink

    def __enter__(self) -> Board:
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    @property
    def room(self) -> tuple[int, int]:
        """Columns and rows available to the map."""
        width, height = self.console.size
        if width >= BESIDE:
            return min(width - _LEFT - 4, 72), max(4, height - 9)
        return width - 3, max(0, height - 21)

    def print(self, what: RenderableType) -> None:
        """Print something above the board, where it stays."""
        self.console.print(what)

    def show(self, state: BoardState) -> None:
        """Redraw the board."""
        width, height = self.console.size
        rows = board_text(state, width, self._rows)[: height - 1]
        self.console.file.write(_BEGIN)
        self._live.update(Group(*rows), refresh=True)
        self.console.file.write(_END)
        self.console.file.flush()


def board_text(state: BoardState, width: int, rows: dict[str, int] | None = None) -> list[Text]:
    """Return the lines of the board; `rows`, the most lines of each part so far, is updated in place."""
    rows = {} if rows is None else rows
    parts = [
        _padded("states", rows, [*_states(state)]),
        _padded("variables", rows, [*_variables(state)]),
        _padded("readings", rows, [_pair(*reading) for reading in state.readings]),
        _padded("last", rows, [Text(line, "dim" if age else "bold") for age, line in enumerate(state.last)]),
    ]
    left = [line for part in parts if part for line in (*part, Text())][:-1]
    right = framed(state.map) if state.map else []
    if width >= BESIDE:
        body = [_beside(a, b) for a, b in zip_longest(left, right, fillvalue=Text())]
    else:
        body = [*left, *right]
    warning = Text("  ".join(filter(None, (state.differs, state.trouble))), "bold red")
    lines = [Text(), _header(state), warning, *body, *_issues(state.frame, width)]
    if state.keys:
        keys = "space: pause or resume   s: one step   r: restart   q: quit"
        lines += [Text(), Text(f"i: interrupt the block   {keys}" if state.frame.hung else keys, "dim")]
    for line in lines:
        line.no_wrap = True
        line.truncate(width - 1, overflow="ellipsis")
    return lines


def _padded(part: str, rows: dict[str, int], lines: list[Text]) -> list[Text]:
    rows[part] = most = max(rows.get(part, 0), len(lines))
    return lines + [Text() for _ in range(most - len(lines))]


def _beside(left: Text, right: Text) -> Text:
    left.truncate(_LEFT, overflow="ellipsis", pad=True)
    return Text.assemble(left, "  ", right)


def _header(state: BoardState) -> Text:
    frame = state.frame
    sign, style = _STATUS.get(frame.status, ("■", "bold"))
    parts = [f"{frame.time:.1f} s", f"tick {frame.tick}", f"{frame.rate:g} Hz" if frame.rate else "free"]
    if frame.achieved_speed and not 0.9 < frame.achieved_speed < 1.1:
        parts.append(f"{frame.achieved_speed:.3g}x real time")
    if frame.restarts:
        parts.append(f"{frame.restarts} restart" + ("s" if frame.restarts > 1 else ""))
    line = Text.assemble(
        (f"{sign} {state.name}", style),
        "  ",
        "  ".join(parts),
        "  ",
        (state.where, "dim"),
        overflow="ellipsis",
    )
    if frame.status != "running":
        words = f"{frame.status}: {frame.reason}" if frame.reason else frame.status
        line.append(f"  {words}", style)
    return line


def _states(board: BoardState) -> Iterator[Text]:
    """Yield a line for each active machine: its name, its active state, and for how long."""
    frame = board.frame
    shown: set[Path] = set()
    rows: list[tuple[int, str, str, str]] = []
    for path in frame.active:
        for end in range(2, len(path) + 1, 2):
            here = path[:end]
            if here not in shown:
                shown.add(here)
                since = board.since.get(here)
                time = "" if since is None else f"{max(0.0, frame.time - since):.1f} s"
                rows.append((end // 2 - 1, path[end - 2], path[end - 1], time))
    widest = max((2 * depth + cell_len(machine) for depth, machine, _, _ in rows), default=0)
    for depth, machine, state, time in rows:
        head = f"{'  ' * depth}{machine}".ljust(widest)
        room = max(1, _LEFT - cell_len(head) - cell_len(state) - cell_len(time) - 2)
        yield Text.assemble(
            (head, "dim"), "  ", (state, "bold green"), " " * room if time else "", (time, "dim")
        )
    if not rows:
        yield Text("nothing is active", "dim")


def _variables(state: BoardState) -> Iterator[Text]:
    variables = state.frame.variables
    for path, value in variables.items():
        style = "bold" if path in state.changed else ""
        others = [other for other in variables if other != path]
        lengths = (each for each in range(2, len(path)) if all(path[-each:] != it[-each:] for it in others))
        length = next(lengths, 0)  # 0: the whole path
        yield _pair(path_text(path[-length:]), value, style)


def _pair(name: str, value: str, style: str = "") -> Text:
    return Text.assemble((name.ljust(14), "dim"), " ", (value, style))


def _issues(frame: Frame, width: int) -> Iterator[Text]:
    open_ones = sorted(
        (issue for issue in frame.issues if not issue.resolved), key=lambda each: -each.first_tick
    )
    if open_ones:
        yield Text()
    for issue in open_ones[:_ISSUES]:
        yield from (Text(row, "red") for row in wrap(str(issue), width - 2, max_lines=2, placeholder=" …"))
        if issue is open_ones[0]:
            yield from map(Text, excerpt(frame.program.text, issue.line, issue.column))
    if len(open_ones) > _ISSUES:
        yield Text(f"and {len(open_ones) - _ISSUES} more", "red")

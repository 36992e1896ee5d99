"""``lrp run``: run a program, display and trace it, and patch it while it runs.

The interpreter and its robot run on a thread of their own. The main thread composes the display twelve
times a second, reads keys and waits for signals; a third one writes. So Ctrl-C is handled at once, whatever a
block does, and whether or not the terminal takes any output.
"""

from __future__ import annotations

import math
import os
import random
import select
import signal
import sys
from collections import deque
from concurrent.futures import CancelledError, Future
from contextlib import ExitStack, suppress
from functools import partial
from pathlib import Path as FilePath
from queue import Empty, SimpleQueue
from time import perf_counter
from typing import IO, TYPE_CHECKING, Any

import typer
from rich.console import RenderableType
from rich.text import Text

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.guarding.safety import Notice
from lrp_jupyter.cli.board import Board, BoardState
from lrp_jupyter.cli.console import plain_console
from lrp_jupyter.cli.event_printer import EventCollector, EventPrinter
from lrp_jupyter.cli.excerpt import print_findings, ran
from lrp_jupyter.cli.lock import watched_lock
from lrp_jupyter.cli.map import Map, columns_for
from lrp_jupyter.cli.program_source import Source, Watch, read_source
from lrp_jupyter.cli.robot_of_run import open_robot, where
from lrp_jupyter.cli.run_options import RunOptions, check_outputs, with_initials
from lrp_jupyter.cli.terminal import Keys, Writer, recorded_signals
from lrp_jupyter.errors import FileError, LRPError, NoAnswerError, UnknownElementError
from lrp_jupyter.files import write_file
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.lookup import called, find, means
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Finding, Path, Program, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.frame import Frame, missing_state
from lrp_jupyter.live.session import Session
from lrp_jupyter.live.teller import REMEMBERED
from lrp_jupyter.logs import open_log

if TYPE_CHECKING:
    from lrp_jupyter.served.page_server import PageServer

LIMIT = 10.0
"""Wall seconds that a block may take in a run of limited length."""
GONE = 5
"""Exit code of a run whose connection was ended from outside, for good."""
_REFRESH = 1 / 12  # s between two refreshes of the display
_ROUNDING = 1e-6  # s
_LAST = 3  # number of recent transitions on the board
_SUFFIXES = {
    "trace": [".jsonl", ".jsonl.gz", ".json", ""],
    "record": [".lrplog", ".lrplog.gz", ""],
    "animate": [".svg"],
}
"""Those that the name of an output may have."""
_PAUSES = {"state": "entered", "transition": "fires"}
"""The argument of `Session.pause_when` for an element that --break names alone, by its kind."""
_EXAMPLES = {"left": "left moving", "event": "event bump", "when": "when robot.bumper.data"}
_BAD = (ConnectionState.LOST, ConnectionState.STALE)


def run_file(file: str, wanted: RunOptions) -> int:
    """Run a program and return the exit code."""
    source = read_source(file)
    if wanted.watch and source.path is None:
        raise typer.BadParameter(
            "--watch needs a file of your own; `lrp programs --show NAME > my.lrp` makes one."
        )
    if wanted.socket and source.path is None:
        raise typer.BadParameter("--socket is for a file that is open in your editor. Name that file.")
    _check_files(source, wanted)
    complaints = plain_console(stderr=True)
    program, findings = scan(source.text, source.name)
    if program is None:
        print_findings(source.name, source.text, findings)
        if not (wanted.watch or wanted.serve) or wanted.start is not None:
            return 1
        complaints.print("Nothing runs yet. Correct the text" + (" and save it." if wanted.watch else "."))
    running = Program(filename=source.name) if program is None else with_initials(program, wanted.assignments)
    if program is not None and wanted.until is not None and not wanted.watch:
        missing = missing_state(wanted.until, program)
        if missing is not None:
            raise typer.BadParameter(f"--until: {missing}")
    if source.path is not None:
        sys.path.insert(0, str(source.path.parent.absolute()))  # for imports of modules beside the file
    with ExitStack() as outputs:
        trace = _opened(wanted.trace, outputs)
        code, is_written = _run(running, source, wanted, trace, program)
        if not is_written:
            os._exit(code)  # Python would wait until the output is accepted
    return code


def _run(
    running: Program, source: Source, wanted: RunOptions, trace: IO[str] | None, program: Program | None
) -> tuple[int, bool]:
    """Run a program and close its robot; return the exit code, and whether all output was written."""
    with ExitStack() as stack:
        bridge = open_robot(source, wanted)
        stack.callback(bridge.close)
        session = Session(
            running,
            bridge,
            rate=wanted.rate,
            name=FilePath(source.name).stem,
            on_active_edit=wanted.on_active_edit,
            on_issue=wanted.on_issue,
            journal=None if wanted.animate or wanted.serve else REMEMBERED if bridge.tells_why else 0,
            speed=wanted.speed,
            start=wanted.start,
        )
        if wanted.animate is not None and bridge.simulated is None:
            raise typer.BadParameter(f"--animate draws a simulated world, and `{bridge.name}` has none.")
        if wanted.record is not None:
            _record(session, wanted, stack)
        stack.callback(session.close)
        for what in wanted.breakpoints:
            _pause_when(session, what)
        if wanted.socket and source.path is not None:
            from lrp_jupyter.editors.live_offer import LiveOffer

            stack.enter_context(LiveOffer(session, source.path))
        page = None if wanted.serve is None else stack.enter_context(_served(session, source, wanted))
        return _Run(session, source, wanted, trace, page).go(program)


def _served(session: Session, source: Source, wanted: RunOptions) -> PageServer:
    """Return the server of the page of a run."""
    try:
        from lrp_jupyter.served.page_server import PageServer
        from lrp_jupyter.served.served_program import ServedProgram
    except ModuleNotFoundError as error:
        raise typer.BadParameter(
            f'--serve needs `{error.name}`: install it with `pip install "lrp-jupyter[serve]"`.'
        ) from None
    program = ServedProgram(session, source.text, source.path, wanted.watch, wanted.read_only)
    token = os.environ.pop("LRP_TOKEN", "")  # which the program need not see
    return PageServer(program, wanted.serve or "", wanted.certificate or "", wanted.key or "", token)


def _check_files(source: Source, wanted: RunOptions) -> None:
    """Raise an error if an output would overwrite the program, the world or the other output."""
    if wanted.record == "-":
        raise typer.BadParameter("--record writes a file. Give its name, as in `--record run.lrplog`.")
    if wanted.animate == "-":
        raise typer.BadParameter("--animate writes a file. Give its name, as in `--animate run.svg`.")
    world = FilePath(wanted.world or source.world or "")  # a name, or a file
    kept = {"the program": source.path, "the world": world if world.is_file() else None}
    outputs = {"trace": wanted.trace, "record": wanted.record, "animate": wanted.animate}
    for option, name in outputs.items():
        if name is None or name == "-":
            continue
        for what, path in kept.items():
            if path is not None and _is_same_file(path, FilePath(name)):
                raise typer.BadParameter(f"--{option} would overwrite {what} `{path}`. Choose another name.")
        kept["the recording" if option == "record" else f"the {option}"] = FilePath(name)
    for option, name in outputs.items():
        if name is not None and name != "-":
            check_outputs([name], _SUFFIXES[option])


def _is_same_file(one: FilePath, other: FilePath) -> bool:
    """Return whether two paths are those of one file, which need not exist; a device is not a file."""
    try:
        if other.exists():
            return other.is_file() and one.exists() and one.samefile(other)
        return one.resolve() == other.resolve()
    except (OSError, ValueError):  # neither can be opened: that is reported then
        return False


def _pause_when(session: Session, what: str) -> None:
    word, _, rest = what.strip().partition(" ")
    rest = rest.strip()
    try:
        if word == "when" and rest:
            session.pause_when(condition=rest)
        elif word == "left" and rest:
            session.pause_when(left=rest)
        elif word == "event" and rest:
            session.pause_when(event=rest)
        elif word in _EXAMPLES and not any(called(session.program, kind, word) for kind in _PAUSES):
            example = _EXAMPLES[word]
            raise typer.BadParameter(f"--break: Write more after `{word}`, as in `--break '{example}'`.")
        else:
            remedies = {"event": f"Write `--break 'event {what}'`."}
            found = find(session.program, tuple(_PAUSES), what.strip(), remedies)
            session.pause_when(**{_PAUSES[found.kind]: found.path})  # type: ignore[arg-type]
    except UnknownElementError as error:
        raise typer.BadParameter(f"--break: {error}") from None
    except SyntaxError as error:
        raise typer.BadParameter(f"--break: {error.msg}") from None


def _record(session: Session, wanted: RunOptions, stack: ExitStack) -> None:
    """Begin a recording, which ends with the run; Python's random numbers are seeded for it."""
    seed = random.SystemRandom().randrange(2**32)
    random.seed(seed)
    initials = {each.variable: each.expression for each in wanted.assignments}
    stream = stack.enter_context(open_log(str(wanted.record)))
    recorder = session.recorder(stream.write, seed, initials)
    stack.callback(recorder.end)


def _has_no_reader(stream: IO[str]) -> bool:
    """Return whether the other end of a pipe is closed; False where that cannot be known."""
    if not hasattr(select, "poll"):
        return False
    try:
        poll = select.poll()
        poll.register(stream.fileno(), 0)  # errors are always reported
        return any(event & select.POLLERR for _, event in poll.poll(0))
    except (OSError, ValueError):  # it has no file, or is closed
        return False


def _opened(trace: str | None, stack: ExitStack) -> IO[str] | None:
    if trace is None or trace == "-":
        return sys.stdout if trace else None
    return stack.enter_context(open_log(trace))


class _Run:
    """One run, controlled from the main thread."""

    def __init__(
        self,
        session: Session,
        source: Source,
        wanted: RunOptions,
        trace: IO[str] | None,
        page: PageServer | None = None,
    ) -> None:
        self.session = session
        self._page = page
        self.source = source
        self.wanted = wanted
        self._wake: SimpleQueue[None] = SimpleQueue()  # a signal handler may not call an event's `set`
        self._caught: list[int] = []  # signals that end the run, including that of a closed pipe
        self._quit = False  # by the key q
        self._trace = trace
        self._cut = False  # the trace is not read any more
        self._events = EventCollector(self._ends if wanted.until else None, trace is not None)
        console = plain_console(stderr=wanted.trace == "-")
        is_shared = any(text.startswith("__log:=") for text in wanted.ros_arguments)  # by roslaunch's nodes
        drawn = console.is_terminal and not (console.is_dumb_terminal or is_shared or wanted.trace == "-")
        self._board = Board(plain_console(soft_wrap=False)) if drawn else None
        self._printer = EventPrinter(console, quiet=wanted.trace == "-")
        self._output = Writer()
        self._keys: Keys | None = None  # only where there is a keyboard
        self._saved: SimpleQueue[str | FileError] = SimpleQueue()
        self._differs = ""  # why the file on disk is not what runs
        simulation = getattr(session.bridge, "simulation", None)
        self._map = Map(simulation) if simulation is not None and drawn else None
        self._drawing: Future[list[str]] | None = None
        self._rows: list[str] = []
        self._printed = 0
        self._edits: deque[tuple[str, Future[Any]]] = deque()  # saved texts that wait to be applied
        self._was_hung = False
        self._stuck = ""  # a sentence about the block because of which the run was ended
        self._notices: set[str] = set()  # of the robot, printed already
        # where nothing real moves, being connected is nothing to say
        self._connection = None if session.bridge.hardware else ConnectionState.CONNECTED
        self._armed: Notice | None = None  # the last one that says so, or that it is not
        self._last: deque[str] = deque(maxlen=_LAST)
        self._values: dict[Path, str] = {}
        self._fires: deque[tuple[str, Future[Any]]] = deque()  # transitions fired by hand
        for name, seconds in wanted.fires:
            self._fire_at(name, seconds)
        self._where = where(session.bridge, wanted.world or source.world)

    def _fire_at(self, name: str, seconds: float) -> None:
        session = self.session
        try:
            path = find(session.program, "transition", name).path
        except UnknownElementError as error:
            raise typer.BadParameter(f"--fire: {error}") from None

        def after_tick() -> None:
            if session.interpreter.now >= seconds - _ROUNDING:
                end()
                self._fires.append((f"{seconds:8.1f} s  --fire {name}", session.submit(do.Fire(path))))

        end = session.on_tick(after_tick)

    def print(self, what: RenderableType) -> None:
        """Print a line that stays."""
        self._output((self._board or self._printer).print, what)

    def _complain(self, what: RenderableType) -> None:
        self._output(plain_console(stderr=True).print, what)

    def go(self, program: Program | None) -> tuple[int, bool]:
        """Run to the end; return the exit code, and whether all output was written."""
        self.session.observe(self._events)
        with recorded_signals(self._wake) as self._caught:
            try:
                code = self._end(*self._go(program))
            finally:
                is_written = self._output.end(lambda: bool(self._caught) or self._quit)
        failure = self._output.failure
        if failure is not None and not self._caught:
            raise failure
        return (128 + self._caught[0] if self._caught and not is_written else code), is_written

    def _go(self, program: Program | None) -> tuple[Frame, float, bool]:
        """Run; return the last frame, the wall seconds, and whether it is paused for good."""
        session, wanted = self.session, self.wanted
        with ExitStack() as stack:
            if self._board is not None:
                keys = stack.enter_context(Keys())
                self._keys = keys if keys.usable else None
            if wanted.watch and self.source.path is not None:
                stack.callback(Watch(self.source.path, self.source.text, self._saved.put).close)
            if program is None:
                self._differs = "The file on disk does not run: it has errors." if wanted.watch else ""
            else:
                self._print_findings(program.text, session.check(program))
            self._print_link()
            if self._board is not None:
                self._output(self._board.__enter__)
                stack.callback(self._output, self._board.__exit__)
            began = perf_counter()
            alone = False
            if wanted.seconds < math.inf:
                stack.enter_context(watched_lock(LIMIT))
            try:
                session.ask(do.EndAt(wanted.seconds))
                session.on_tick(self._end_if_reached)
                session.start()
                while not (self._must_end() or self._overdue() or alone or self._is_over()):
                    with suppress(Empty):
                        self._wake.get(timeout=self._pause_between_refreshes())
                    self._refresh()
                    for key in self._keys.pressed() if self._keys is not None else "":
                        self._press(key)
                    alone = self._is_paused() and self._is_alone
            finally:
                wall = perf_counter() - began
                session.stop()
            frame = session.frame
            self._draw_last()
            self._keys = None
            self._refresh(is_last=True)
        return frame, wall, alone

    def _print_link(self) -> None:
        if self._page is None:
            return
        show = partial(self._output, plain_console(stderr=self.wanted.trace == "-").print)
        show(f"The page of this run: {self._page.link}")
        looks = self.wanted.read_only
        if self.source.path is None and not looks:
            show("The program is not in a file, so what is typed there ends with the run. Save… writes one.")
        if self._page.is_open:
            then = "see the page, too" if looks else "do whatever you can do on this computer"
            show(
                f"Others on the network can read this link when it is opened, and then {then}."
                " `--certificate FILE` encrypts the page."
            )

    def _must_end(self) -> bool:
        """Return whether a person wants the end, or cannot see anything any more."""
        return bool(self._caught) or self._quit or self._output.failure is not None

    def _ends(self, state: Path) -> bool:
        return means(self.session.interpreter.program, self.wanted.until or "", state)

    def _end_if_reached(self) -> None:
        if self._events.reached.is_set():
            self.session.submit(do.EndAt(0.0))

    def _is_over(self) -> bool:
        """Return whether the time is up, the state entered, the robot gone for good, or the session over."""
        frame = self.session.frame
        is_late = frame.time >= self.wanted.seconds - _ROUNDING
        is_gone = bool(self.session.bridge.gone)  # and will not come back
        return (
            is_late
            or self._events.reached.is_set()
            or frame.status in ("broken", "closed", "stopped")
            or is_gone
        )

    def _is_paused(self) -> bool:
        return self.session.status == "paused" and not self._is_over()

    @property
    def _is_alone(self) -> bool:
        """Whether neither a key, a save nor a page can resume a run."""
        return self._keys is None and not self.wanted.watch and self._page is None

    def _overdue(self) -> bool:
        """Return whether a run that is to end by itself cannot, because a block does not return."""
        is_limited = self.wanted.seconds < math.inf or (self.wanted.speed == math.inf and self._is_alone)
        hung = self.session.frame.hung
        if is_limited and hung is not None and hung.seconds >= LIMIT:
            self._stuck = f"{hung} It ended the run."
        return bool(self._stuck)

    def _pause_between_refreshes(self) -> float:
        left = (self.wanted.seconds - self.session.frame.time) / self.wanted.speed
        return min(_REFRESH, max(left, 0.005))

    # -- one refresh --------------------------------------------------------------------------------

    def _refresh(self, is_last: bool = False) -> None:
        self._write_trace()
        self._apply_saves()
        self._print_edits()
        self._print_refused_fires()
        frame = self.session.frame
        self._print_events(frame)
        self._print_hang(frame)
        if self._board is not None and (is_last or not self._output.is_behind):
            self._output(self._board.show, self._board_state(frame))

    def _write_trace(self) -> None:
        lines, trace = self._events.lines, self._trace
        if trace is None:
            lines.clear()
            return
        if lines:
            self._output(self._append, trace, [lines.popleft() for _ in range(len(lines))])
        if self._cut or _has_no_reader(trace):  # an idle program writes nothing, so no error would show it
            self._caught.append(getattr(signal, "SIGPIPE", 13))
            self._trace = None
            sys.stdout = open(os.devnull, "w")  # noqa: SIM115  (closing the real one would fail again)

    def _append(self, trace: IO[str], lines: list[str]) -> None:
        try:
            trace.writelines(lines)
            trace.flush()
        except BrokenPipeError:
            self._cut = True

    def _print_events(self, frame: Frame) -> None:
        pending, names = self._events.pending, resolve(frame.program)
        while pending:
            event = pending.popleft()
            if event.kind == "fired":
                fired: Any = event.data
                machine = event.path[:-1]
                is_shared = names.is_shared(names.defined(machine))
                place = f"  {path_text(machine)}" if is_shared else ""
                self._last.appendleft(f"{event.now:.1f} s  {fired.source} → {fired.destination}{place}")
            if event.kind == "restarted":
                self._events.since.clear()
            if self._board is None:
                self._output(self._printer.write, event, frame.program.text)
        self._printed, printed = self.session.output.since(self._printed)
        for line in printed:
            self.print(line)
        self._print_robot(frame)

    def _print_robot(self, frame: Frame) -> None:
        """Print what happened to the connection, each time, and to the safety, once."""
        notices = self.session.bridge.safety.notices  # first: what they are about is then in the status
        status = self.session.bridge.status
        is_news = status.state is ConnectionState.WAITING and status.sentence not in self._notices
        if is_news or status.state not in (self._connection, ConnectionState.DISCONNECTED):
            self._connection = status.state
            self._notices.add(status.sentence)  # the notice of a loss is its status
            style = "bold red" if status.state in _BAD else "yellow"
            self.print(Text(f"{frame.time:8.1f} s  robot: {status.sentence}", style))
        name = self.session.bridge.name
        armed = next((each for each in reversed(notices) if each.text.startswith(f"`{name}` is ")), None)
        again = None if armed is self._armed else armed  # perhaps by a page, and not for the first time
        self._armed = armed
        says_it = status.state in (ConnectionState.STALE, ConnectionState.WAITING)
        for notice in notices:
            if notice.text in self._notices and notice is not again:
                continue
            self._notices.add(notice.text)
            if not (notice.kind == "stale" and says_it):
                self.print(Text(f"{notice.now:8.1f} s  robot: {notice.text}", "yellow"))

    def _print_hang(self, frame: Frame) -> None:
        """Print that a block does not return, once."""
        hung, before = frame.hung, self._was_hung
        self._was_hung = hung is not None
        if hung is None or before:
            return
        words = f"{frame.time:8.1f} s  hung: {hung}"
        if self.wanted.watch:
            words += " Save the corrected file: that interrupts the block."
        show = self.print if self._board is not None else self._complain
        show(Text(words, "bold red"))

    def _board_state(self, frame: Frame) -> BoardState:
        values = dict(frame.variables)
        changed = frozenset(path for path, value in values.items() if self._values.get(path, value) != value)
        self._values = values
        readings = [
            (member.name.removesuffix(".data"), member.absence or _short(member.value))
            for member in self.session.bridge.members()
            if member.kind == "variable" and (member.stale or member.value is not None)
        ]
        return BoardState(
            frame=frame,
            name=self.session.name,
            where=self._where,
            map=self._drawn(frame),
            readings=readings,
            since=self._events.since,
            last=tuple(self._last),
            changed=changed,
            keys=self._keys is not None,
            differs=self._differs,
            trouble=self._trouble(),
        )

    def _trouble(self) -> str:
        """Return why the robot does not move, a sentence; empty if it may."""
        bridge = self.session.bridge
        if (status := bridge.status).state in _BAD:
            return status.sentence
        return "The robot is disarmed." if bridge.hardware and not bridge.safety.armed else ""

    def _drawn(self, frame: Frame) -> list[str]:
        """Return the latest map of the world and submit a request for the next, drawn between two ticks."""
        if self._map is None or self._board is None:
            return []
        if self._drawing is not None and self._drawing.done() and self._drawing.exception() is None:
            self._rows = self._drawing.result()
        columns, rows = self._board.room
        if (self._drawing is None or self._drawing.done()) and frame.status != "stopped" and rows > 4:
            draw, wide = self._map.draw, columns_for(self._map.size, columns - 2, rows - 2)
            self._drawing = self.session.submit(do.Call(lambda: draw(wide)))
        return self._rows

    def _draw_last(self) -> None:
        """Draw the final map; nothing moves any more."""
        if self._map is not None and self._rows:
            draw, wide = self._map.draw, len(self._rows[0])
            with suppress(LRPError):  # a block that does not return holds the world
                self._rows = self.session.call(lambda: draw(wide))
            self._drawing = None

    def _press(self, key: str) -> None:
        try:
            if key == " ":
                self.session.ask(do.Resume() if self._is_paused() else do.Pause())
            elif key == "s":
                self.session.ask(do.Pause())
                self.session.ask(do.Step())
            elif key == "r":
                self.session.ask(do.Reset())
            elif key == "i":
                self.session.interrupt()
            elif key in "qQ":
                self._quit = True
        except LRPError as error:
            self.print(Text(str(error), "red"))

    # -- changes ------------------------------------------------------------------------------------

    def _apply_saves(self) -> None:
        saved: str | FileError | None = None
        while True:
            try:
                saved = self._saved.get_nowait()
            except Empty:
                break
        if isinstance(saved, FileError):
            self._differs = "The file on disk is not what runs: it cannot be read."
            head = f"{self.session.frame.time:8.1f} s  "
            self.print(Text(f"{head}{saved} The last program keeps running.", "bold red"))
        elif saved is not None:
            self._apply(saved)

    def _apply(self, text: str) -> None:
        if self._page is not None and not self._page.program.look(text):
            self._differs = ""  # a page has written it
            return
        head = f"{self.session.frame.time:8.1f} s  saved: "
        program, findings = scan(text, self.source.name)
        self._differs = "" if program else "The file on disk is not what runs: it has errors."
        if program is None:
            self.print(Text(f"{head}not a valid program; the last one keeps running", "bold red"))
            print_findings(self.source.name, text, findings, self.print)
            return
        if self._page is not None:
            return  # which is an edit like any other of its own
        try:
            command = do.ReplaceProgram(with_initials(program, self.wanted.assignments))
            self._edits.append((text, self.session.ask(command)))
        except LRPError as error:
            self.print(Text(f"{head}{error}", "bold yellow"))

    def _print_edits(self) -> None:
        while self._edits and self._edits[0][1].done():
            self._print_edit(*self._edits.popleft())

    def _print_refused_fires(self) -> None:
        while self._fires and self._fires[0][1].done():
            head, answer = self._fires.popleft()
            if not answer.cancelled() and (error := answer.exception()) is not None:
                self.print(Text(f"{head}: {error}", "bold yellow"))

    def _print_edit(self, text: str, answer: Future[Any]) -> None:
        head = f"{self.session.frame.time:8.1f} s  saved: "
        try:
            patch = answer.result(0)
        except CancelledError:  # a newer one came before it was applied
            return
        except LRPError as error:
            self.print(Text(f"{head}{error}", "bold yellow"))
            return
        if not patch.applied:
            self.print(Text(f"{head}not applied yet: {patch.reason}", "bold yellow"))
        elif patch.restarted:
            self.print(Text(f"{head}restarted: {patch.reason}", "bold yellow"))
        elif not patch.changes:
            self.print(f"{head}no change in meaning")
        else:
            self.print(Text(f"{head}applied while it runs: {patch.changes}", "green"))
        if self._keys is None and self._is_paused():  # at an issue, and there is no keyboard
            self.session.ask(do.Resume())
        self._print_findings(text, self.session.check(text))

    def _print_findings(self, text: str, findings: tuple[Finding, ...]) -> None:
        print_findings(self.source.name, text, findings, self.print)
        self._printer.told = text, findings

    # -- the end ------------------------------------------------------------------------------------

    def _end(self, frame: Frame, wall: float, alone: bool) -> int:
        if self.session.fault:
            self._complain(
                f"lrp: The interpreter itself failed, not your program. Report this:\n{self.session.fault}"
            )
            return 3
        if self._stuck:
            self._complain(f"lrp: {self._stuck}")
        elif alone:
            by = frame.paused_by
            why = f" at an issue:\n{by.traceback or by}" if isinstance(by, Issue) else f": {frame.reason}"
            self.print(f"Paused{why}")
        self._report_breakpoints()
        words = ran(self.session.name, frame)
        if issues := sum(not issue.resolved for issue in frame.issues):
            words += f"; {issues} issue" + ("s" if issues > 1 else "")
        if self.wanted.speed == math.inf and wall > 0:
            words += f"; {frame.time / wall:,.0f} times real time"
        self.print(words)
        if self.wanted.animate is not None and not self._stuck:
            write_file(FilePath(self.wanted.animate), self.session.animation() + "\n")
        if self._caught:
            return 128 + self._caught[0]
        if gone := self.session.bridge.gone:
            self._complain(f"lrp: {gone}")
            return GONE
        reached = self.wanted.until is not None and self._events.reached.is_set()
        if (unreached := self.session.bridge.unreached) and not reached:
            self._complain(f"lrp: {unreached}")
            return NoAnswerError.exit_code
        missed = self.wanted.until is not None and not (reached or self._quit)
        return int(alone or missed or bool(self._stuck))

    def _report_breakpoints(self) -> None:
        """Print which conditions of breakpoints could not be evaluated, and so never paused the run."""
        with suppress(LRPError):
            for each in self.session.breakpoints:
                if each.problem:
                    self._complain(
                        f"lrp: The condition `{each.name}` of --break could not be evaluated: "
                        f"{each.problem} It can read global variables and `robot`."
                    )


def _short(value: object) -> str:
    return f"{value:.3f}".rstrip("0").rstrip(".") if isinstance(value, float) else str(value)

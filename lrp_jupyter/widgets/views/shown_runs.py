"""The runs that are kept beside a program: run again, in processes of their own, with every new program.

One thread, which mostly waits, has them run: when there is a newer program, the runs of the one before are
ended; when only a run has changed, the others are not run again. What was known of a run stays in view until
it is known with the new program. All else is called by the publisher, or is what a person does, on the
worker's thread.
"""

from __future__ import annotations

import os
import threading
import traceback
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Protocol

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.errors import LRPError, sentence_of
from lrp_jupyter.files import shown
from lrp_jupyter.grading.workers import Halt, HowRun
from lrp_jupyter.language.program import Path as ProgramPath
from lrp_jupyter.language.program import Program, path_text
from lrp_jupyter.live.coverage import coverage_from
from lrp_jupyter.live.past.fork import unkept
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.session import Session
from lrp_jupyter.runs.again import begin_run, record_again, show_run
from lrp_jupyter.runs.decide import decide
from lrp_jupyter.runs.expectation import AS_RECORDED, ExpectedPart, expectation
from lrp_jupyter.runs.kept_runs import KeptRun, expect, kept_runs, remove, rename
from lrp_jupyter.runs.outcome import OPEN_LOOP, RunOutcome, StateEntered
from lrp_jupyter.widgets.views.shown_moment import Looking
from lrp_jupyter.widgets.wire.protocol import CoverageView, KeptRunView, OneWay, RunsView, RunVerdict

_LIMIT = 10.0  # s of computing that a run may take


class ShowsRuns(Protocol):
    """What shows a run: a session with its views."""

    looking: Looking

    @property
    def session(self) -> Session:
        """The session that the views show."""

    def change_bridge(self, bridge: str | Bridge) -> None:
        """Continue with another bridge."""


class ShownRuns:
    """The kept runs of one program; new ones are kept in `folder`."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.attached: dict[Path, str] = {}  # further folders, whose runs are shown, too: as they were named
        self._lock = threading.Condition()  # of everything below
        self._runs: tuple[KeptRun, ...] = ()
        self._by_name: dict[str, KeptRun] = {}  # as they are shown
        self._outcomes: dict[Path, RunOutcome] = {}
        self._decided: set[KeptRun] = set()  # their outcomes are those of the wanted program
        self._views: dict[Path, tuple[object, KeptRunView]] = {}  # and of what each was made
        self._coverage: CoverageView | None = None  # of all runs, once all are decided
        self._wanted: tuple[Session, Program] | None = None
        self._number = 0  # of what is wanted
        self._halt = Halt()
        self._error = ""
        self._thread: threading.Thread | None = None
        self._closed = False
        self._wake: Callable[[], None] = lambda: None

    # -- what is shown: on the publisher's thread -----------------------------------------------------

    def attach(self, wake: Callable[[], None]) -> None:
        """Have `wake` called when there is something to show."""
        self._wake = wake

    def move(self, folder: Path) -> None:
        """Show the runs of another folder: the program has another name."""
        self.folder = folder
        self._changed()

    def close(self) -> None:
        """End the runs, and the thread."""
        with self._lock:
            self._closed = True
            self._halt.set()
            self._lock.notify_all()

    def view(self, session: Session, challenge: str = "") -> RunsView | None:
        """Return what is shown of all runs together; run them again if there is another program."""
        if session.driver == "asyncio":  # where there are no processes
            return None
        if self._wanted is None or self._wanted[1] is not session.program:
            with self._lock:
                self._wanted = session, session.program
                self._decided.clear()
                self._begin()
        with self._lock:
            return {
                "folder": self.folder.name,
                "attached": [*self.attached.values()],
                "names": [*self._by_name],
                "expected": str(ExpectedPart("meets", challenge)) if challenge else AS_RECORDED,
                "keeps": unkept(session._loop),
                "coverage": self._coverage,
                "error": self._error,
            }

    def kept(self) -> dict[str, KeptRunView]:
        """Return what is shown of each run."""
        with self._lock:
            return {name: self._run_view(run) for name, run in self._by_name.items()}

    def _run_view(self, run: KeptRun) -> KeptRunView:
        """Return what is shown of a run: the same object as long as it is the same."""
        made_of = run, self._outcomes.get(run.file), run in self._decided
        known, view = self._views.get(run.file, (None, None))
        if view is None or known != made_of:
            view = _run_view(*made_of)
            self._views[run.file] = made_of, view
        return view

    # -- deciding: on a thread of its own --------------------------------------------------------------

    def _begin(self) -> None:
        """Have those run again that are not decided; the lock is held."""
        self._number += 1
        self._coverage = None
        self._halt.set()
        self._lock.notify_all()
        if self._thread is None:
            self._thread = threading.Thread(target=self._decide_all, name="lrp runs", daemon=True)
            self._thread.start()

    def _decide_all(self) -> None:
        done = 0
        while True:
            with self._lock:
                self._lock.wait_for(lambda: self._closed or self._number != done)  # noqa: B023
                if self._closed or self._wanted is None:
                    return
                (session, program), done = self._wanted, self._number
                self._halt = halt = Halt()
            try:
                self._look()
                self._decide(session, program, done, halt)
                error = ""
            except LRPError as fault:
                error = sentence_of(fault)
            except Exception:
                error = traceback.format_exc()
            with self._lock:
                self._error = error
                if done == self._number and not error and len(self._decided) == len(self._runs) > 0:
                    runs = [self._outcomes[run.file].coverage for run in self._runs]
                    self._coverage = _coverage_view(program, runs)
            self._wake()

    def _look(self) -> None:
        """Look which runs there are now."""
        found = kept_runs([each for each in (self.folder, *self.attached) if each.exists()])
        with self._lock:
            files = {run.file for run in found}
            self._outcomes = {file: each for file, each in self._outcomes.items() if file in files}
            self._views = {file: each for file, each in self._views.items() if file in files}
            self._decided.intersection_update(found)
            self._runs, self._by_name = found, {}
            for run in found:
                name = run.name
                while name in self._by_name:  # in another folder
                    name = f"{name} ({run.file.parent.name})"
                self._by_name[name] = run

    def _decide(self, session: Session, program: Program, number: int, halt: Halt) -> None:

        def told(run: KeptRun, outcome: RunOutcome) -> None:
            with self._lock:
                self._outcomes[run.file] = outcome
                if number == self._number:
                    self._decided.add(run)
            self._wake()

        with self._lock:
            known = self._outcomes
            open_ones = [run for run in self._runs if run not in self._decided]
            open_ones.sort(key=lambda run: run.file in known and known[run.file].passed)
        if program.text and open_ones:
            how = HowRun(limit=_LIMIT, namespace=session.namespace, behind=True)
            decide(program, open_ones, how, told=told, halt=halt)

    # -- what a person does: on the worker's thread --------------------------------------------------------

    def _changed(self, *changed: KeptRun) -> None:
        """Look which runs there are, and run those again that have changed."""
        with self._lock:
            self._decided.difference_update(changed)
            if self._wanted is not None:
                self._begin()
        self._wake()

    def _named(self, name: str) -> KeptRun:
        with self._lock:
            if name not in self._by_name:
                raise LRPError(f"The run `{name}` no longer exists.")
            return self._by_name[name]

    @property
    def all(self) -> tuple[KeptRun, ...]:
        """The runs."""
        with self._lock:
            return self._runs

    def keep(self, session: Session, name: str, expected: str) -> None:
        """Keep the present run."""
        expectation(expected)  # before anything is written
        (new,) = kept_runs(session.keep(name, self.folder))
        self._changed(expect(new, expected))

    def begin(self, session: Session) -> None:
        """Begin a new run, which can be kept."""
        begin_run(session)
        session.start()

    def expect(self, name: str, expected: str) -> None:
        """Write what is expected of a run."""
        self._changed(expect(self._named(name), expected))

    def rename(self, name: str, new_name: str) -> None:
        """Give a run another name."""
        self._changed(rename(self._named(name), new_name))

    def forget(self, name: str) -> None:
        """Remove a run."""
        remove(self._named(name))
        self._changed()

    def attach_folder(self, folder: str | os.PathLike[str]) -> None:
        """Also show the runs of another folder, named from where the program is.

        Raises FileError: there is none, or it cannot be read.
        """
        path = Path(os.path.abspath(self.folder.parent / Path(folder).expanduser()))
        kept_runs(path)  # raises what is wrong
        if path != Path(os.path.abspath(self.folder)):
            self.attached.setdefault(path, shown(folder))
        self._changed()

    def accept(self, session: Session, name: str) -> None:
        """Record a run again with the present program."""
        run = self._named(name)
        record_again(run.file, session.program.text, session.namespace)
        self._changed(run)

    def show(self, opened: ShowsRuns, name: str) -> None:
        """Run a run again in the lab, and look at where it differs or fails, else at its end."""
        run = self._named(name)
        with self._lock:
            outcome = self._outcomes.get(run.file, RunOutcome())
        recording = read_recording(run.file)
        bridge, simulated = opened.session.bridge, recording.start.world is not None
        if bridge.hardware:
            raise LRPError(
                f"The program drives `{bridge.name}` now, which would be disconnected. Choose the bridge "
                "`sim` first, or look at the run in another lab."
            )
        if simulated and bridge.simulated is None:
            opened.change_bridge("sim")
        elif not simulated and bridge.name != "recorded":
            opened.change_bridge(recording.start.make_bridge())
        session = opened.session
        begin = show_run(session, recording)
        failed = [each.time for each in outcome.found if not each.passed and each.time is not None]
        time = min(failed, default=outcome.time if outcome.difference else outcome.seconds)
        opened.looking.look(session, begin + time)


def _run_view(run: KeptRun, outcome: RunOutcome | None, is_decided: bool) -> KeptRunView:
    known = outcome or RunOutcome()
    lane = _lane(known)
    verdict: RunVerdict = "problem" if known.problem else "passed" if known.passed else "failed"
    return {
        "expected": run.expected,
        "seconds": round(known.seconds, 3),
        "state": verdict if is_decided else "waiting",
        "reason": known.reason,
        "differs": (known.time, known.difference) if known.difference else None,
        "open_loop": "" if known.open_loop is None else OPEN_LOOP,
        "lane": lane,
        "recorded": _strip(known.recorded, lane),
        "now": _strip(known.now, lane),
        "issues": known.issues,
    }


def _coverage_view(program: Program, runs: Sequence[Mapping[str, Sequence[str]]]) -> CoverageView:
    """Return in which runs, by their numbers, each part of a program was reached."""
    coverage = coverage_from(program, runs)

    def reached(kind: str, paths: Iterable[ProgramPath]) -> dict[str, list[int]]:
        texts = map(path_text, paths)
        return {text: [number for number, run in enumerate(runs) if text in run[kind]] for text in texts}

    ways: dict[str, OneWay] = {
        path_text(path): "never false" if held else "never true" if failed else "never tested"
        for path, (held, failed) in coverage.conditions.items()
        if not (held and failed)
    }
    return {
        "states": reached("states", coverage.states),
        "transitions": reached("transitions", coverage.transitions),
        "conditions": ways,
        "words": str(coverage).replace("\n", " "),
    }


def _lane(outcome: RunOutcome) -> str:
    """Return the machine whose states are shown: the outermost one in which a run differs, else the first."""
    if outcome.lane:
        return outcome.lane.partition("/")[0]
    return next((each.lane for each in (*outcome.recorded, *outcome.now)), "")


def _strip(entered: Iterable[StateEntered], lane: str) -> list[tuple[float, str]]:
    return [
        (each.time, f"{lane}/{each.state}" if each.state is not None else "")
        for each in entered
        if each.lane == lane
    ]

"""Runs in processes of their own: on all processors, each with a limit of time and of memory.

Each run is made by a *worker* (see :mod:`~lrp_jupyter.grading.worker`), which costs a few milliseconds; it
cannot touch another run, and if it hangs or crashes it costs only itself. Workers that are idle are kept
until this process ends. A Dask cluster makes the same runs in the same way, each on one of its machines. In a
browser, where there are no processes, runs are made in this one.

This protects the grader from mistakes, but not a computer from malice: grade programs of people whom you do
not trust in a sandbox (:mod:`~lrp_jupyter.grading.sandbox`) or a container.
"""

from __future__ import annotations

import atexit
import json
import os
import secrets
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, InvalidStateError, ThreadPoolExecutor, wait
from contextlib import closing, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

from lrp_jupyter.arguments import check_number
from lrp_jupyter.errors import LRPError, ended, printable, sentence_of
from lrp_jupyter.grading.attempt import Ended
from lrp_jupyter.grading.cluster import Cluster
from lrp_jupyter.grading.sandbox import check_sandbox, in_sandbox
from lrp_jupyter.grading.worker import (
    BEHIND,
    FORKS,
    LARGEST,
    LOST,
    NOTHING,
    READY,
    Ending,
    Request,
    framed,
    patience,
    sent,
)
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.language.parser import scan
from lrp_jupyter.live.running.checkpoints import names_of
from lrp_jupyter.process import python_of


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Made(Protocol):
    """What came of a run."""

    @property
    def ended(self) -> str:
        """Why it did not come to its end; empty if it did."""


Result = TypeVar("Result", bound=Made)
Result_co = TypeVar("Result_co", bound=Made, covariant=True)


class RunJob(Protocol[Result_co]):
    """One run that is to be made, here or, pickled, in a worker."""

    @property
    def texts(self) -> tuple[str, ...]:
        """The texts of its program."""

    @property
    def namespace(self) -> Mapping[str, Any]:
        """Names that blocks can read."""

    @property
    def limit(self) -> float:
        """Wall seconds that it may take."""

    @property
    def recording(self) -> str:
        """The file of the recording that it runs again; empty if it runs none."""

    @property
    def key(self) -> object:
        """What identifies its program."""

    def done(self) -> dict[str, Any]:
        """Make it, and return plain data."""

    def made(self, data: Any) -> Result_co:
        """Return what plain data describes. Raises ValueError: it is not what this run can return."""

    def failed(self, ended: Ended, sentence: str, reason: str) -> Result_co:
        """Return what is known of a run that did not come to its end."""


class Halt(Future[None]):
    """Set from another thread, it ends runs."""

    def set(self) -> None:
        """End them; a second call does nothing."""
        with suppress(InvalidStateError):
            self.set_result(None)


class HowRun(NamedTuple):
    """How the runs of a batch are made.

    `limit`: wall seconds of computing that one run may take.
    `memory`: megabytes that one run may need more than at its beginning.
    `processes`: how many runs at a time; default: one for each processor.
    `scheduler`: the address of a Dask scheduler whose workers make the runs, or ``"local"``.
    `namespace`: names that blocks can read.
    `sandbox`: whether they are made in a sandbox, without files and network.
    `behind`: whether they give way to whatever else wants a processor, such as a lab and its robot.
    """

    limit: float = 60
    memory: float = 1000
    processes: int | None = None
    scheduler: str | None = None
    namespace: dict[str, Any] | None = None
    sandbox: bool = False
    behind: bool = False

    def check(self) -> None:
        """Raise a TypeError or ValueError if a number is not one, or too small.

        Raises LRPError: there is no sandbox where the runs are made.
        """
        check_number("limit", self.limit, "a number of seconds", above=0)
        check_number("memory", self.memory, "a number of megabytes", above=0)
        if self.processes is not None:
            check_number("processes", self.processes, "a number of processes", least=1)
        if self.sandbox:
            check_sandbox()
            if self.scheduler is not None:
                raise LRPError(
                    "A sandbox is for runs on this machine. Leave out the sandbox or the scheduler."
                )


def run_jobs(
    jobs: Sequence[RunJob[Result]],
    how: HowRun = HowRun(),  # noqa: B008  (an immutable value)
    *,
    stop_at_end: bool = False,
    halt: Halt | None = None,
) -> Iterator[tuple[int, Result]]:
    """Make runs, several at a time, and yield each with its index as it is done.

    Closing the iterator early ends the runs that have begun.

    `stop_at_end`: whether no other run of a program is begun after one that took too long, crashed or is not
        a valid program. Where there are several programs, the second run of each waits for the first one, so
        that a program that hangs does not hold up the others.
    Raises LRPError: a name of the notebook cannot be sent to another process, or the cluster cannot be
        reached.
    """
    batch = _Batch(jobs, how.memory, stop_at_end, halt or Halt())
    if sys.platform == "emscripten":
        yield from batch.made_here()
        return
    size = how.processes or processors()
    crew = (
        _Processors(size, how.sandbox, how.behind)
        if how.scheduler is None
        else Cluster(how.scheduler, answer, size)
    )
    with closing(crew):
        yield from batch.made_by(crew)


class _Batch(Generic[Result]):
    """Runs, in the order in which they begin.

    One that is lost is made again, alone, as are those of its program that had not begun: another program may
    have ended its process.
    """

    def __init__(self, jobs: Sequence[RunJob[Result]], memory: float, stop_at_end: bool, halt: Halt) -> None:
        self._jobs, self._memory, self._stop_at_end, self._halt = jobs, memory, stop_at_end, halt
        self._waiting = list(range(len(jobs)))
        self._lost: list[int] = []
        self._is_alone = False  # whether those are made again
        programs = {job.key for job in jobs}
        self._proven = set() if stop_at_end and len(programs) > 1 else programs  # any number runs at a time
        self._has_ended = False  # whether any run has

    def made_here(self) -> Iterator[tuple[int, Result]]:
        """Make the runs in this process, one after the other."""
        while self._waiting:
            index = self._waiting.pop(0)
            job = self._jobs[index]
            yield index, self._end(index, job.made(job.done()))

    def made_by(self, crew: _Processors | Cluster) -> Iterator[tuple[int, Result]]:
        """Have a crew make the runs."""
        running: dict[Future[Ending], int] = {}
        while True:
            while (index := self._next(running.values(), crew.size)) is not None:
                running[crew.submit(_packed(self._jobs[index], self._memory))] = index
            if not running:
                return
            everything: list[Future[Any]] = [*running, self._halt]
            done, _ = wait(everything, timeout=crew.patience, return_when=FIRST_COMPLETED)
            if self._halt.done():
                return
            for future in sorted(running.keys() & done, key=running.__getitem__):
                index = running.pop(future)
                if (made := self._made(index, crew, future)) is not None:
                    yield index, self._end(index, made)

    def _next(self, running: Collection[int], size: int) -> int | None:
        """Return the run that is to begin now; None if there is none."""
        if self._lost and not (self._waiting or running):
            self._waiting, self._lost, self._is_alone = self._lost, [], True
            close_workers()  # those that are idle may be stopped, too
        if len(running) >= (1 if self._is_alone else size):
            return None
        busy = {self._jobs[index].key for index in running} - self._proven
        index = next((each for each in self._waiting if self._jobs[each].key not in busy), None)
        if index is not None:
            self._waiting.remove(index)
        return index

    def _made(self, index: int, crew: _Processors | Cluster, future: Future[Ending]) -> Result | None:
        """Return what came of a run; None if it is to be made again."""
        job = self._jobs[index]
        try:
            ending = crew.result(future)
        except LRPError:
            if self._is_alone or not self._has_ended:
                raise
            ending = LOST
        if ending == LOST and not self._is_alone:
            self._lost += [index, *self._withdraw(job)]
            return None
        return _made_of(job, ending)

    def _end(self, index: int, made: Result) -> Result:
        self._has_ended = True
        self._proven.add(self._jobs[index].key)
        if made.ended and self._stop_at_end:
            self._withdraw(self._jobs[index])
        return made

    def _withdraw(self, job: RunJob[Result]) -> list[int]:
        """Take the runs of a job's program from those that wait, and return them."""
        found = [index for index in self._waiting if self._jobs[index].key == job.key]
        self._waiting = [index for index in self._waiting if index not in found]
        return found


class _Processors:
    """The processors of this machine.

    `size`: how many runs at a time.
    `patience`: seconds of one wait for the end of a run: Ctrl-C does not end it if another thread gets the
        signal, nor does what halts the runs.
    """

    patience = 0.1

    def __init__(self, size: int, sandbox: bool = False, behind: bool = False) -> None:
        self.size, self._sandbox, self._is_behind = size, sandbox, behind
        self._pool = ThreadPoolExecutor(size, "lrp grading")
        self._busy: set[_Worker] = set()
        self._lock = threading.Lock()  # of those: no other crew has a worker that this one abandons
        self._is_closed = False

    def submit(self, request: Request) -> Future[Ending]:
        return self._pool.submit(self.ending, request)

    def ending(self, request: Request) -> Ending:
        """Have a worker that is idle, or a new one, make a run.

        Raises LRPError: a worker cannot be started.
        """
        idle = _sandboxed if self._sandbox else _behind if self._is_behind else _idle
        try:
            worker = idle.pop()
        except IndexError:
            worker = _Worker(self._sandbox, self._is_behind)
        with self._lock:
            self._busy.add(worker)
        try:
            return worker.ask(request, lambda: not self._is_closed)
        finally:
            with self._lock:
                self._busy.discard(worker)
            if worker.is_spent:
                worker.close()
            else:
                idle.append(worker)

    def result(self, future: Future[Ending]) -> Ending:
        return future.result()

    def close(self) -> None:
        self._is_closed = True
        with self._lock:
            for worker in self._busy:
                worker.abandon()
        self._pool.shutdown()


def answer(request: Request) -> Ending:
    """Have a worker of this machine make a run; a Dask worker does.

    Raises LRPError: a worker cannot be started.
    """
    return _Processors(1).ending(request)


_idle: list[_Worker] = []
_sandboxed: list[_Worker] = []  # idle, too
_behind: list[_Worker] = []  # idle, and gives way


def close_workers() -> None:
    """End the workers that are idle; the next run starts a new one."""
    for idle in (_idle, _sandboxed, _behind):
        while idle:
            idle.pop().close()


atexit.register(close_workers)


_STARTING = 120.0  # s that a worker may take until it is ready
_ENDING = 5.0  # s that it has to end by itself
_MARK = "LRP_GRADING"  # the variable by which the processes that a worker and its runs have started are found
_LOOKS = 50  # for processes that were left behind: while one forks, there are new ones


class _Worker:
    """The near end of a worker.

    `is_spent`: whether it makes no more runs.
    Raises LRPError: it cannot be started.
    """

    def __init__(self, sandbox: bool = False, behind: bool = False) -> None:
        self._mark = secrets.token_hex(8)
        started = python_of("lrp_jupyter.grading.worker", *([BEHIND] if behind else []))
        started["env"] |= {_MARK: self._mark, "PYTHONHASHSEED": "0"}  # every run orders a set of texts alike
        if sandbox:
            started = in_sandbox(started)
        try:
            self.process = subprocess.Popen(
                **started,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                start_new_session=True,  # Ctrl-C in a terminal is for the command that grades
            )
        except OSError as error:
            raise _unstarted(error.strerror or str(error)) from error
        assert self.process.stdin
        assert self.process.stdout
        assert self.process.stderr
        self._pipes = self.process.stdin, self.process.stdout, self.process.stderr
        self._is_ready = self.is_spent = False
        self._writing = threading.Lock()

    def ask(self, request: Request, is_needed: Callable[[], bool]) -> Ending:
        """Have a run made, unless it is not needed any more when the worker is ready.

        Raises LRPError: the worker does not start.
        """
        requests, endings, _ = self._pipes
        self.is_spent, line = True, b""
        self._begin()
        # an OSError: it has ended; a ValueError: it was closed
        with self._at_most(patience(request.limit)) as is_late, suppress(OSError, ValueError):
            with self._writing:
                if not is_needed():
                    self.is_spent = False
                    return LOST
                requests.write(sent(request))
                requests.flush()
            line = endings.readline(8 * LARGEST)  # of which a character may need six
        if not FORKS:
            return Ending(None if is_late.is_set() else self._code(), line.decode(errors="replace"))
        with suppress(ValueError, TypeError, RecursionError):
            code, answer = json.loads(line)
            if isinstance(answer, str) and isinstance(code, int | None):
                self.is_spent = False
                return Ending(code, answer)
        return LOST

    def _begin(self) -> None:
        _, endings, complaints = self._pipes
        if self._is_ready:
            return
        with self._at_most(_STARTING):
            if endings.readline() != READY:
                words = complaints.read().decode(errors="replace").split("\n")
                raise _unstarted(next(filter(None, map(str.strip, reversed(words))), "it has ended"))
        self._is_ready = True

    @contextmanager
    def _at_most(self, seconds: float) -> Iterator[threading.Event]:
        """End the process, so that no pipe of it blocks, after some time; yield whether this has happened."""
        is_late = threading.Event()

        def give_up() -> None:
            is_late.set()
            self._kill()

        timer = threading.Timer(seconds, give_up)
        timer.daemon = True
        timer.start()
        try:
            yield is_late
        finally:
            timer.cancel()

    def abandon(self) -> None:
        """End the run that it makes, which is not needed any more."""
        if not FORKS:
            self._kill()
            return
        with self._writing, suppress(OSError, ValueError):  # it has ended, or was closed
            self._pipes[0].write(framed(NOTHING))
            self._pipes[0].flush()

    def _code(self) -> int:
        try:
            return self.process.wait(_ENDING)
        except subprocess.TimeoutExpired:  # it has closed its output
            return 0

    def close(self) -> None:
        """End the process, the run that it makes, and what its runs have started."""
        self.is_spent = True
        with suppress(OSError):  # it ends by itself: if it is killed, it cannot end its run
            self._pipes[0].close()
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(_ENDING if FORKS else 0)
        self._kill()
        self.process.wait()
        for pipe in self._pipes:
            with suppress(OSError):
                pipe.close()

    def _kill(self) -> None:
        """End the process, and what it and its runs have started; only Linux says what that is."""
        self.process.kill()
        for _ in range(_LOOKS):
            found = [each for each in Path("/proc").glob("[0-9]*") if self._has_started(each)]
            for process in found:
                with suppress(OSError):
                    os.kill(int(process.name), signal.SIGKILL)
            if not found:
                return

    def _has_started(self, process: Path) -> bool:
        with suppress(OSError):
            return self._mark.encode() in (process / "environ").read_bytes()
        return False


def _unstarted(reason: str) -> LRPError:
    return LRPError(
        f"No program can be run, because the process for it does not start: {ended(printable(reason))}"
    )


def _made_of(job: RunJob[Result], ending: Ending) -> Result:
    """Return what a worker's answer describes.

    The program may have written it: anything but the answer for this run counts as no answer.
    """
    with suppress(ValueError, RecursionError):
        match json.loads(ending.answer):
            case {"fault": str(fault)}:
                return job.failed("fault", "can be judged", fault)
            case {"interrupted": True}:
                return job.failed("crash", "runs to its end", "It was interrupted.")
            case answer:
                return job.made(answer)
    if ending.code is None:
        reason = (
            "One call in a block did not return, such as `sum` of something endless. Let a block do a "
            "little in each tick, and wait with `ontime`."
        )
        return job.failed("time", f"is computed within {job.limit:g} s", reason)
    return job.failed("crash", "runs to its end", _reason(ending))


def _reason(ending: Ending) -> str:
    """Return why the process of a run has ended without its answer."""
    code = ending.code or 0
    if ending.answer:
        return (
            "The run ended with something that is not an answer. The program may write only to its own files."
        )
    if ending == LOST:
        return (
            "Its process was killed, and killed again when the run was repeated on its own. Remove what ends "
            "processes; or it needs more memory than this computer has."
        )
    if not code:
        return (
            "The run ended without an answer. The program must not end or stop a process, nor close files"
            " that it has not opened."
        )
    if code > 0:
        return (
            f"The program ended its own process, with the exit code {code}. Remove the call that does that."
        )
    name = f"signal {-code}"
    with suppress(ValueError):
        name = signal.Signals(-code).name
    return (
        f"The program crashed the process that ran it ({name}). Python alone does not: remove calls of `os`, "
        "`signal` or `ctypes`, or of a package that is not Python's own."
    )


def _packed(job: RunJob[Result], memory: float) -> Request:
    """Pickle a job with those names of its namespace that its blocks use, and what they need in turn.

    Raises LRPError: a name cannot be sent.
    """
    import cloudpickle

    used: set[str] = set()
    for text in job.texts if job.namespace else ():  # a text may take long to be read
        program, _ = scan(text)
        if program is not None:
            used |= names_of(link(program))
    names = {}
    for name in sorted(used & job.namespace.keys()):
        try:
            names[name] = job.namespace[name]
            cloudpickle.dumps(names[name])
        except Exception as error:  # whatever an object's own pickling raises
            raise LRPError(
                f"The program uses `{name}`, which cannot be sent to the process that grades it "
                f"({sentence_of(error)}). Let it use functions and plain values only."
            ) from error
    sendable: Any = job  # every kind of run is a dataclass
    sendable = replace(sendable, namespace=names)
    module = type(job).__module__
    text = job.texts[0] if job.recording else ""  # of a run of this user's own program
    return Request(cloudpickle.dumps((sendable, memory)), job.limit, module, job.recording, text)

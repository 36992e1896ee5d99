"""Runs in processes of their own: on all processors, each with a limit of time and of memory.

Each run is made by a *worker* (see :mod:`~lrp_jupyter.grading.worker`), which costs a few milliseconds; it
cannot touch another run, and if it hangs or crashes it costs only itself. Workers that are idle are kept
until this process ends. A Dask cluster makes the same runs in the same way, each on one of its machines. In a
browser, where there are no processes, runs are made in this one.

This protects the grader from mistakes, but not a computer from malice: grade programs of people whom you do
not trust in a container.
"""

from __future__ import annotations

import atexit
import json
import os
import pickle
import secrets
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import closing, contextmanager, suppress
from dataclasses import replace
from typing import IO, Protocol

from lrp_jupyter.errors import LRPError, ended, printable, sentence_of
from lrp_jupyter.grading.attempt import Attempt, Job, attempt, failed
from lrp_jupyter.grading.cluster import Cluster
from lrp_jupyter.grading.worker import (
    ENDS,
    FORKS,
    LATE,
    LOST,
    MARK,
    NONE,
    Request,
    end_started,
    receive,
    send,
)
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.language.parser import scan
from lrp_jupyter.live.checkpoints import names_of
from lrp_jupyter.process import python_of


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run_jobs(
    jobs: Sequence[Job],
    memory: float,
    *,
    stop_at_end: bool = False,
    keep_going: bool = False,
    processes: int | None = None,
    scheduler: str | None = None,
    halt: threading.Event | None = None,
) -> Iterator[tuple[int, Attempt]]:
    """Make runs, several at a time, and yield each with its index as it is done.

    To close the iterator early ends the runs that have begun.

    `memory`: megabytes for each.
    `stop_at_end`: whether no other run of a program is begun after one that took too long, crashed or is not
        a valid program. Where there are several programs, the second run of each waits for the first one, so
        that a program that hangs does not hold up the others.
    `keep_going`: whether the other runs are made after a fault of the interpreter, which is then an attempt.
    `processes`: how many at a time; default: one for each processor.
    `scheduler`: the address of a Dask scheduler, or ``"local"`` for a Dask cluster on this machine; its
        workers make the runs.
    `halt`: with it :func:`halt_runs` ends the runs from another thread.
    Raises LRPError: the interpreter itself failed, a name of the notebook cannot be sent to another process,
        or the cluster cannot be reached.
    """
    queue = _Queue(jobs, stop_at_end)
    if sys.platform == "emscripten":
        while (index := queue.next()) is not None:
            made = attempt(jobs[index])
            queue.end(index, made)
            yield index, made
        return
    halt = threading.Event() if halt is None else halt
    crew: _Crew
    if scheduler is not None:
        crew = Cluster(scheduler, answer, processes or processors())
    else:
        crew = _Processors(processes or processors(), halt)
    running: dict[Future[bytes], int] = {}
    with closing(crew):
        while True:
            while len(running) < crew.size and (index := queue.next()) is not None:
                running[crew.submit(_packed(jobs[index], memory))] = index
            if not running:
                return
            done, _ = wait(running, timeout=crew.patience, return_when=FIRST_COMPLETED)
            if halt.is_set():
                return
            for future in sorted(done, key=running.__getitem__):
                index = running.pop(future)
                try:
                    answered = crew.result(future)
                except LRPError:
                    if not (queue.has_ended and queue.again(index)):
                        raise
                    continue
                if answered == LOST and queue.again(index):
                    continue
                try:
                    made = _made(jobs[index], answered)
                except LRPError as error:
                    if not keep_going:
                        raise
                    made = failed(jobs[index], "fault", "can be judged", str(error))
                queue.end(index, made)
                yield index, made


class _Queue:
    """The runs that are still to be made, in the order in which they begin."""

    def __init__(self, jobs: Sequence[Job], stop_at_end: bool) -> None:
        self._jobs, self._stop_at_end = jobs, stop_at_end
        self._waiting = dict.fromkeys(range(len(jobs)))
        self._alone = len({job.texts for job in jobs}) == 1
        self._busy: list[tuple[str, ...]] = []  # the programs that run
        self._proven: set[tuple[str, ...]] = set()  # those of which a run came to its end
        self._lost: dict[int, bool] = {}  # those that are made again, and whether they still wait

    def next(self) -> int | None:
        """Return the index of the run that is to begin now; None if there is none."""
        found = next(filter(self._may_begin, self._waiting), None)
        if found is None and not self._busy:
            found = next((index for index, waits in self._lost.items() if waits), None)
        if found is not None:
            self._waiting.pop(found, None)
            if found in self._lost:
                self._lost[found] = False
            self._busy.append(self._jobs[found].texts)
        return found

    def _may_begin(self, index: int) -> bool:
        texts = self._jobs[index].texts
        if any(waits and self._jobs[lost].texts == texts for lost, waits in self._lost.items()):
            return False
        return not self._stop_at_end or self._alone or texts in self._proven or texts not in self._busy

    @property
    def has_ended(self) -> bool:
        """Whether any run has come to its end."""
        return bool(self._proven)

    def again(self, index: int) -> bool:
        """Note that a run was lost, and that it is to be made again, alone; return False if that was done.

        Another program may have ended its process.
        """
        if index in self._lost:
            return False
        self._lost[index] = True
        self._busy.remove(self._jobs[index].texts)
        return True

    def end(self, index: int, made: Attempt) -> None:
        """Note that a run has ended."""
        texts = self._jobs[index].texts
        self._busy.remove(texts)
        self._proven.add(texts)
        if made.ended and self._stop_at_end:
            self._waiting = {each: None for each in self._waiting if self._jobs[each].texts != texts}


class _Crew(Protocol):
    """Who makes runs: processors or a cluster.

    `size`: how many runs at a time; it may change.
    `patience`: seconds of one wait for the end of a run: Ctrl-C does not end it if another thread gets the
        signal.
    """

    @property
    def size(self) -> int: ...

    @property
    def patience(self) -> float: ...

    def submit(self, request: Request) -> Future[bytes]:
        """Have a run made."""

    def result(self, future: Future[bytes]) -> bytes:
        """Return the answer of a run that is done; empty if its process ended."""

    def close(self) -> None:
        """End the runs that have begun."""


class _Processors:
    """The processors of this machine."""

    patience = 1.0

    def __init__(self, size: int, halt: threading.Event) -> None:
        self.size, self._halt = size, halt
        self._pool = ThreadPoolExecutor(size, "lrp grading")

    def submit(self, request: Request) -> Future[bytes]:
        return self._pool.submit(answer, request, self._halt)

    def result(self, future: Future[bytes]) -> bytes:
        return future.result()

    def close(self) -> None:
        halt_runs(self._halt)
        self._pool.shutdown()


_STARTING = 120.0  # s that a worker may take until it is ready
_ENDING = 5.0  # s that it has to end by itself
_LONGEST = 10_000  # characters of a fault


class _Worker:
    """The near end of a worker.

    `serves`: the event that stops the run that it makes; None while it is idle.
    `lasts`: whether it makes more than one run.
    Raises LRPError: it cannot be started.
    """

    def __init__(self) -> None:
        self._mark = secrets.token_hex(8)
        started = python_of("lrp_jupyter.grading.worker")
        started["env"] |= {MARK: self._mark, "PYTHONHASHSEED": "0"}  # every run orders a set of texts alike
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
        self.serves: threading.Event | None = None
        self._is_ready = self.lasts = False

    def ask(self, request: Request) -> bytes:
        """Send a request and return the answer; empty if the worker has ended.

        Raises LRPError: the worker could not begin.
        """
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        if not self._is_ready:
            self._begin(self.process.stdout)
        with self._at_most(request.patience) as is_late, suppress(OSError, ValueError):
            send(self.process.stdin, pickle.dumps(tuple(request)))
            if answer := receive(self.process.stdout):
                return answer
        if self.lasts:
            return LOST
        return LATE if is_late.is_set() else NONE

    def _begin(self, answers: IO[bytes]) -> None:
        assert self.process.stderr is not None
        with self._at_most(_STARTING), self.process.stderr as complaints:
            ready = receive(answers)
            if ready not in (FORKS, ENDS):
                words = complaints.read().decode(errors="replace").split("\n")
                raise _unstarted(next(filter(None, map(str.strip, reversed(words))), "it has ended"))
        self._is_ready, self.lasts = True, ready == FORKS

    @contextmanager
    def _at_most(self, seconds: float) -> Iterator[threading.Event]:
        """End the process, so that no pipe of it blocks, after some time; yield whether this has happened."""
        is_late = threading.Event()

        def give_up() -> None:
            is_late.set()
            self.kill()

        timer = threading.Timer(seconds, give_up)
        timer.daemon = True
        timer.start()
        try:
            yield is_late
        finally:
            timer.cancel()

    def kill(self) -> None:
        """End the process, and what it and its runs have started."""
        self.process.kill()
        end_started(self._mark)

    def stop(self) -> None:
        """Let the process end soon, and the run that it makes."""
        threading.Thread(target=self._end_at_last, daemon=True).start()
        self._let_end()

    def end(self) -> None:
        """Wait for the end of the process and of the run that it makes."""
        self._let_end()
        self._end_at_last()
        for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
            assert pipe is not None
            with suppress(OSError):
                pipe.close()

    def _let_end(self) -> None:
        """Ask the process to end; one that is killed could not end the process that it has forked."""
        assert self.process.stdin is not None
        if self.lasts:
            with suppress(OSError):
                self.process.stdin.close()
        else:
            self.process.kill()

    def _end_at_last(self) -> None:
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(_ENDING)
        self.kill()
        self.process.wait()


def _unstarted(reason: str) -> LRPError:
    return LRPError(
        f"No program can be run, because the process for it does not start: {ended(printable(reason))}"
    )


_lock = threading.Lock()
_workers: list[_Worker] = []


def answer(request: Request, halt: threading.Event | None = None) -> bytes:
    """Have a worker of this machine make a run, and return its answer; empty if its process ended.

    Raises LRPError: a worker cannot be started.
    """
    halt = threading.Event() if halt is None else halt
    with _lock:
        worker = next((each for each in _workers if each.serves is None), None)
        if worker is None:
            worker = _Worker()
            _workers.append(worker)
        worker.serves = halt
    answer = LOST
    try:
        if not halt.is_set():
            answer = worker.ask(request)
    finally:
        with _lock:
            worker.serves = None
            is_spent = answer == LOST or not worker.lasts or halt.is_set()
            if is_spent and worker in _workers:
                _workers.remove(worker)
        if is_spent:
            worker.end()
    return answer


def _made(job: Job, answer: bytes) -> Attempt:
    """Return the attempt that a worker's answer describes.

    The program could write it: what is not the answer for this run is none.
    Raises LRPError: the interpreter itself failed.
    """
    if answer == LATE:
        reason = (
            "A call into compiled code did not return. Let the blocks wait for nothing, and stop no process."
        )
        return failed(job, "time", f"is computed within {job.limit:g} s", reason)
    fault = None
    with suppress(ValueError, RecursionError):
        made = json.loads(answer)
        if not (isinstance(made, dict) and isinstance(fault := made.get("fault"), str)):
            return Attempt.from_dict(made).of(job)
    if isinstance(fault, str):
        raise LRPError(printable(fault[:_LONGEST], "\n"))
    reason = "The run ended without an answer. Let the program end or stop no process, and close no files."
    if answer == LOST:
        reason = "Its process was killed, and once more when it was run again, alone."
    elif answer != NONE:
        reason = "The run ended with an answer that is none. Let the program write to its own files only."
    return failed(job, "crash", "runs to its end", reason)


def halt_runs(halt: threading.Event) -> None:
    """End the runs that were begun with an event, and begin no more of them."""
    halt.set()
    with _lock:
        stopped = [worker for worker in _workers if worker.serves is halt]
        _workers[:] = [worker for worker in _workers if worker.serves is not halt]
    for worker in stopped:
        worker.stop()


def close_workers() -> None:
    """End all workers; the next run starts new ones."""
    with _lock:
        ended, _workers[:] = _workers[:], []
    for worker in ended:
        worker.end()


atexit.register(close_workers)


def _packed(job: Job, memory: float) -> Request:
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
    return Request(cloudpickle.dumps((replace(job, namespace=names), memory)), job.limit)

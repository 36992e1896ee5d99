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
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import closing, suppress
from dataclasses import replace
from typing import Protocol

from lrp_jupyter.errors import LRPError, sentence_of
from lrp_jupyter.grading.attempt import Attempt, Job, attempt, failed
from lrp_jupyter.grading.cluster import Cluster
from lrp_jupyter.grading.worker import receive, send
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
                    made = _made(jobs[index], crew.result(future))
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

    def next(self) -> int | None:
        """Return the index of the run that is to begin now; None if there is none."""
        found = next(filter(self._may_begin, self._waiting), None)
        if found is not None:
            del self._waiting[found]
            self._busy.append(self._jobs[found].texts)
        return found

    def _may_begin(self, index: int) -> bool:
        texts = self._jobs[index].texts
        return not self._stop_at_end or self._alone or texts in self._proven or texts not in self._busy

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

    def submit(self, request: bytes) -> Future[bytes]:
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

    def submit(self, request: bytes) -> Future[bytes]:
        return self._pool.submit(answer, request, self._halt)

    def result(self, future: Future[bytes]) -> bytes:
        return future.result()

    def close(self) -> None:
        halt_runs(self._halt)
        self._pool.shutdown()


_ENDING = 5.0  # s that a worker has to end by itself


class _Worker:
    """The near end of a worker.

    `serves`: the event that stops the run that it makes; None while it is idle.
    """

    def __init__(self) -> None:
        self.process = subprocess.Popen(
            **python_of("lrp_jupyter.grading.worker"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C in a terminal is for the command that grades
        )
        self.serves: threading.Event | None = None

    def ask(self, request: bytes) -> bytes:
        """Send a request and return the answer; empty if the worker has ended."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            send(self.process.stdin, request)
            return receive(self.process.stdout)
        except (OSError, ValueError):  # a ValueError: the pipe was closed by `stop`
            return b""

    def stop(self) -> None:
        """Let the process end soon, and the run that it makes.

        A worker that is killed could not end the process that it has forked for a run.
        """
        assert self.process.stdin is not None
        if hasattr(os, "fork"):
            with suppress(OSError):
                self.process.stdin.close()
        else:
            self.process.kill()

    def end(self) -> None:
        """Wait for the end of the process and of the run that it makes."""
        assert self.process.stdout is not None
        self.stop()
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(_ENDING)
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()


_lock = threading.Lock()
_workers: list[_Worker] = []


def answer(request: bytes, halt: threading.Event | None = None) -> bytes:
    """Have a worker of this machine make a run, and return its answer; empty if its process ended."""
    halt = threading.Event() if halt is None else halt
    with _lock:
        worker = next((each for each in _workers if each.serves is None), None)
        if worker is None:
            worker = _Worker()
            _workers.append(worker)
        worker.serves = halt
    answer = b"" if halt.is_set() else worker.ask(request)
    is_lost = not answer or halt.is_set()
    with _lock:
        worker.serves = None
        if is_lost and worker in _workers:
            _workers.remove(worker)
    if is_lost:
        worker.end()
        return b""
    return answer


def isolated(job: Job, memory: float) -> Attempt:
    """Make one run in a process of its own.

    Raises LRPError: the interpreter itself failed, or a name of the notebook cannot be sent to another
        process.
    """
    return _made(job, answer(_packed(job, memory)))


def _made(job: Job, answer: bytes) -> Attempt:
    """Return the attempt that a worker's answer describes."""
    if not answer:
        return failed(job, "crash", "runs to its end", "Its process ended.")
    made = json.loads(answer)
    if "fault" in made:
        raise LRPError(made["fault"])
    return Attempt.from_dict(made)


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


def _packed(job: Job, memory: float) -> bytes:
    """Pickle a job with those names of its namespace that its blocks use, and what they need in turn.

    Raises LRPError: a name cannot be sent.
    """
    import cloudpickle

    used: set[str] = set()
    for text in job.texts:
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
    packed: bytes = cloudpickle.dumps((replace(job, namespace=names), memory))
    return packed

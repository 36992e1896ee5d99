"""Runs in processes of their own: on all processors, each with a limit of time and of memory.

Each run is made by a *worker* (see :mod:`~lrp_jupyter.grading.worker`), which costs a few milliseconds; it
cannot touch another run, and if it hangs or crashes it costs only itself. Workers that are idle are kept
until this process ends. In a browser, where there are no processes, runs are made in this one.

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
from contextlib import suppress
from dataclasses import replace

from lrp_jupyter.errors import LRPError, sentence_of
from lrp_jupyter.grading.attempt import Attempt, Job, attempt, failed
from lrp_jupyter.grading.worker import receive, send
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.language.parser import scan
from lrp_jupyter.live.checkpoints import names_of

__all__ = ["close_workers", "halt_runs", "isolated", "processors", "run_jobs"]


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run_jobs(
    jobs: Sequence[Job],
    memory: float,
    *,
    stop_at_end: bool = False,
    processes: int | None = None,
    halt: threading.Event | None = None,
) -> Iterator[tuple[int, Attempt]]:
    """Make runs, several at a time, and yield each with its index as it is done.

    To close the iterator early ends the runs that have begun.

    Parameters
    ----------
    jobs : sequence of Job
    memory : float
        Megabytes for each.
    stop_at_end : bool
        Whether no other run is begun after one that took too long, crashed or is not a valid program.
    processes : int, optional
        How many at a time; default: one for each processor.
    halt : Event, optional
        With it :func:`halt_runs` ends the runs from another thread.

    Raises
    ------
    LRPError
        The interpreter itself failed, or a name of the notebook cannot be sent to another process.
    """
    if sys.platform == "emscripten":
        for index, job in enumerate(jobs):
            made = attempt(job)
            yield index, made
            if stop_at_end and made.ended:
                return
        return
    count = min(len(jobs), processes or processors())
    waiting = iter(list(enumerate(jobs)))
    running: dict[Future[Attempt], int] = {}
    halt = threading.Event() if halt is None else halt
    with ThreadPoolExecutor(max(1, count), "lrp grading") as pool:
        try:
            while True:
                while len(running) < count and (entry := next(waiting, None)):
                    running[pool.submit(isolated, entry[1], memory, halt)] = entry[0]
                if not running:
                    return
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                if halt.is_set():
                    return
                for future in sorted(done, key=running.__getitem__):
                    index, made = running.pop(future), future.result()
                    if stop_at_end and made.ended:
                        waiting = iter([])
                    yield index, made
        finally:
            halt_runs(halt)


class _Worker:
    """The near end of a worker.

    Attributes
    ----------
    serves : Event or None
        The event that stops the run that it makes; None while it is idle.
    """

    def __init__(self) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "lrp_jupyter.grading.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C in a terminal is for the command that grades
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        )
        self.serves: threading.Event | None = None

    def ask(self, request: bytes) -> bytes:
        """Send a request and return the answer; empty if the worker has ended."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            send(self.process.stdin, request)
            return receive(self.process.stdout)
        except OSError:
            return b""

    def end(self) -> None:
        """End the process, and the run that it makes."""
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                with suppress(OSError):
                    pipe.close()
        self.process.kill()
        self.process.wait()


_lock = threading.Lock()
_workers: list[_Worker] = []


def isolated(job: Job, memory: float, halt: threading.Event | None = None) -> Attempt:
    """Make one run in a process of its own.

    Raises
    ------
    LRPError
        The interpreter itself failed, or a name of the notebook cannot be sent to another process.
    """
    halt = threading.Event() if halt is None else halt
    request = _packed(job, memory)
    with _lock:
        worker = next((each for each in _workers if each.serves is None), None)
        if worker is None:
            worker = _Worker()
            _workers.append(worker)
        worker.serves = halt
    answer = b"" if halt.is_set() else worker.ask(request)
    with _lock:
        worker.serves = None
        if not answer and worker in _workers:
            _workers.remove(worker)
    if not answer:
        worker.end()
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
        worker.process.kill()


def close_workers() -> None:
    """End all workers; the next run starts new ones."""
    with _lock:
        ended, _workers[:] = _workers[:], []
    for worker in ended:
        worker.end()


atexit.register(close_workers)


def _packed(job: Job, memory: float) -> bytes:
    """Pickle a job with those names of its namespace that its blocks use, and what they need in turn.

    Raises
    ------
    LRPError
        A name cannot be sent.
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

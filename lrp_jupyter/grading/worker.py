"""A worker: a process that makes one graded run after the other, each in a process forked from it.

It says on its standard output that it is ready, reads requests from its standard input, and writes what came
of them to its standard output, each message preceded by its length. A request is pickled; an answer is JSON,
because a program that is graded may have written it. What programs print goes nowhere. Where processes cannot
be forked, it makes one run and ends.
"""

from __future__ import annotations

import ctypes
import faulthandler
import json
import os
import pickle
import selectors
import signal
import struct
import sys
import traceback
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from time import monotonic
from typing import IO, Any, NamedTuple

from lrp_jupyter.errors import sentence_of
from lrp_jupyter.grading.attempt import attempt, failed

FORKS, ENDS = b"It forks a process for each run.", b"It makes one run."
"""What a worker says when it is ready."""
LOST, LATE, NONE = b"lost", b"late", b"none"
"""Instead of an answer: the run was killed from outside, did not end, or ended without one."""
MARK = "LRP_GRADING"
"""The variable by which the processes that a worker and its runs have started are found."""

_SET_PDEATHSIG, _SET_CHILD_SUBREAPER = 1, 36  # of Linux's `prctl`
_SIZE = struct.Struct(">Q")
_LOADING = 5.0  # s beyond its own limit that a run may take, for what is not the program's
_LATER = 10.0  # s that a worker may take longer, and its run again as long, if nothing ends them
_LARGEST = 4_000_000  # bytes of an answer
_LOOKS = 50  # for processes that were left behind: while one forks, there are new ones


class Request(NamedTuple):
    """A run that is to be made.

    `job`: the job and the megabytes that it may need, pickled; to unpickle it may fail, or run anything.
    `limit`: wall seconds of computing.
    """

    job: bytes
    limit: float

    @property
    def longest(self) -> float:
        """After how many seconds the run is ended."""
        return self.limit * 7 / 6 + _LOADING

    @property
    def patience(self) -> float:
        """After how many seconds the worker must have answered."""
        return self.longest + _LATER


def send(pipe: IO[bytes], message: bytes) -> None:
    """Write a message."""
    pipe.write(_SIZE.pack(len(message)) + message)
    pipe.flush()


def receive(pipe: IO[bytes], most: int = _LARGEST) -> bytes:
    """Read a message; empty if there is none any more, or none of that size."""
    head = pipe.read(_SIZE.size)
    size = _SIZE.unpack(head)[0] if len(head) == _SIZE.size else 0
    message = pipe.read(size) if size <= most else b""
    return message if len(message) == size else b""


def end_started(mark: str) -> None:
    """End all processes with a mark in their environment but this one; only Linux tells it."""
    for _ in range(_LOOKS):
        found = [each for each in Path("/proc").glob("[0-9]*") if _has(each, mark)]
        for process in found:
            with suppress(OSError):
                os.kill(int(process.name), signal.SIGKILL)
        if not found:
            return


def _has(process: Path, mark: str) -> bool:
    with suppress(OSError):
        return process.name != str(os.getpid()) and mark.encode() in (process / "environ").read_bytes()
    return False


def main() -> None:
    """Make runs until the standard input is closed."""
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nothing, stream)
    can_fork = hasattr(os, "fork")
    _prctl(_SET_CHILD_SUBREAPER, 1)  # what a run leaves behind is found
    send(answers, FORKS if can_fork else ENDS)
    while message := receive(requests, 1 << 62):
        request = Request(*pickle.loads(message))
        if not can_fork:
            send(answers, _made(request))
            return
        send(answers, _forked(request, requests, answers))


def _prctl(option: int, value: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


def _made(request: Request) -> bytes:
    """Make a run and return what came of it."""
    # a thread of C, which also ends a call of C that does not return, and a run whose worker is gone
    faulthandler.dump_traceback_later(request.patience + _LATER, exit=True)
    try:
        job, memory = pickle.loads(request.job)
        _limit(memory, request.patience)
        answer: dict[str, Any] = attempt(job).to_dict()
    except KeyboardInterrupt:  # only a program interrupts this process
        answer = failed(job, "crash", "runs to its end", "It was interrupted.").to_dict()
    except BaseException as error:
        answer = {"fault": f"{sentence_of(error)}\n{traceback.format_exc()}"}
    return json.dumps(answer).encode()


def _limit(memory: float, seconds: float) -> None:
    """Limit the memory of this process to what it has, and some megabytes; and what it may compute."""
    try:
        import resource
    except ImportError:  # Windows
        return
    with suppress(OSError, ValueError):
        with open("/proc/self/statm") as file:
            pages = int(file.read().split()[0])
        computing = (os.cpu_count() or 1) * int(seconds + 1)
        resource.setrlimit(resource.RLIMIT_CPU, (computing, computing))
        most = pages * os.sysconf("SC_PAGE_SIZE") + int(memory * 1e6)
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


def _forked(request: Request, *pipes: IO[bytes]) -> bytes:
    """Make a run in a process of its own, which ends when it takes too long; return what came of it."""
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        _prctl(_SET_PDEATHSIG, signal.SIGKILL)  # it ends with its worker, also in a call of C
        os.setsid()
        os.close(reading)
        for pipe in pipes:
            os.close(pipe.fileno())
        with os.fdopen(writing, "wb") as pipe:
            send(pipe, _made(request))
        os._exit(0)
    os.close(writing)
    answer = _read(reading, pipes[0].fileno(), monotonic() + request.longest)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)  # and whatever it has started
    os.kill(child, signal.SIGKILL)  # which is not waited for yet, so its id is still its own
    _, status = os.waitpid(child, 0)
    end_started(os.environ[MARK])
    _end_children()
    code = os.waitstatus_to_exitcode(status)
    if answer or code == 0:
        return answer or NONE
    if answer is None:
        return LATE
    if code == -signal.SIGKILL:
        return LOST
    job, _ = pickle.loads(request.job)
    return json.dumps(failed(job, "crash", "runs to its end", _reason(code)).to_dict()).encode()


def _end_children() -> None:
    """End what runs have left behind, which is this process's own when its parent has ended."""
    with suppress(OSError):
        while children := Path(f"/proc/self/task/{os.getpid()}/children").read_text().split():
            for child in children:
                os.kill(int(child), signal.SIGKILL)
            os.waitpid(-1, 0)


def _read(pipe: int, requests: int, end: float) -> bytes | None:
    """Return a message; empty if there is none, None if it takes too long or is not needed any more.

    No request comes before the answer to the last one, so if there is anything to read from that pipe, it
    is its end: the process that wanted the run is gone.
    """
    data = bytearray()
    with selectors.DefaultSelector() as selector, os.fdopen(pipe, "rb", 0) as reading:
        selector.register(reading, selectors.EVENT_READ)
        selector.register(requests, selectors.EVENT_READ)
        while ready := selector.select(max(0.0, end - monotonic())):
            if any(key.fd == requests for key, _ in ready):
                return None
            part = reading.read(1 << 16)
            data += part
            body = len(data) - _SIZE.size
            is_whole = body >= 0 and body >= _SIZE.unpack_from(data)[0]
            if not part or is_whole or len(data) > _LARGEST:
                return receive(BytesIO(data))
    return None


def _reason(code: int) -> str:
    if code >= 0:
        return f"The program ended its own process, with the exit code {code}."
    with suppress(ValueError):
        return f"The process of the program crashed ({signal.Signals(-code).name})."
    return f"The process of the program crashed (signal {-code})."


if __name__ == "__main__":
    main()

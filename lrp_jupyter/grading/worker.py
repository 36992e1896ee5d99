"""A worker: a process that makes runs, each in a process forked from it.

It prints a line when it is ready, and one for each run. A request is pickled: a job, which has a method
`done` that makes the run and returns plain data. An ending is JSON, because a program that is run may have
written it. What programs print goes nowhere. Where processes cannot be forked, it makes one run, prints its
answer, and ends.
"""

from __future__ import annotations

import ctypes
import faulthandler
import gc
import importlib
import json
import os
import pickle
import select
import signal
import struct
import sys
import traceback
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from time import monotonic, sleep
from typing import IO, NamedTuple

from lrp_jupyter.errors import LRPError, sentence_of
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.language.parser import scan
from lrp_jupyter.live.recording import recording_of

FORKS = hasattr(os, "fork")
READY = b"ready\n"
BEHIND = "--behind"
"""The argument of a worker that gives way to others."""
LARGEST = 4_000_000  # bytes of an answer

_SET_PDEATHSIG, _SET_CHILD_SUBREAPER = 1, 36  # of Linux's `prctl`
_LOADING = 5.0  # s beyond its own limit that a run may take, for what is not the program's
_SIZE = ">Q"
_NICE = 10  # a tenth of a processor that others want: a run still ends within its limit
_BETWEEN = 0.1  # s: how often Linux lets anyone change the priority of a session
_LATER = 10.0  # s that a worker may take longer, and its run again as long, if nothing ends them


class Request(NamedTuple):
    """A run that is to be made: the job and the megabytes that it may need, pickled; seconds of computing.

    `module`: that of the job, of this package: it is imported once for all runs.
    `recording`: the file of the recording that it runs again, which is read once; empty if there is none.
    `text`: with a recording, the program: it is parsed once for all recordings.
    """

    job: bytes
    limit: float
    module: str
    recording: str = ""
    text: str = ""


class Ending(NamedTuple):
    """How the process of a run ended.

    `code`: its exit code; None if it was ended because it took too long.
    `answer`: a line of JSON, unless the program wrote it.
    """

    code: int | None
    answer: str


NOTHING = b""
"""A request that only ends the run that is being made, if there is one."""

LOST = Ending(-9, "")
"""The process was killed from outside."""


def patience(limit: float) -> float:
    """Return the seconds in which a worker must answer if its run has `limit` seconds of computing."""
    return _longest(limit) + _LATER


def _longest(limit: float) -> float:
    return limit * 7 / 6 + _LOADING


def main() -> None:
    """Make runs until the standard input is closed."""
    requests = os.fdopen(os.dup(0), "rb", 0)  # without a buffer, in which the end of a run could hide
    endings = os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nothing, stream)
    _prctl(_SET_CHILD_SUBREAPER, 1)  # what a run leaves behind becomes a child of this process
    if BEHIND in sys.argv:
        _give_way()
    endings.write(READY)
    endings.flush()
    while (request := _next(requests)) is not None:
        if request == NOTHING:  # the run that was not needed any more had already ended
            continue
        job, limit, module, recording, text = pickle.loads(request)
        _prepare(module, recording)
        _parse(text)
        if not FORKS:
            endings.write(_answer(job, limit))
            return
        code, answer = _forked(job, limit, requests.fileno(), endings.fileno())
        endings.write(b"%b\n" % json.dumps([code, answer.decode(errors="replace")]).encode())
        endings.flush()


def sent(request: Request) -> bytes:
    """Return the bytes by which a worker gets a request."""
    return framed(pickle.dumps(tuple(request)))


def framed(data: bytes) -> bytes:
    """Return data with its length before it."""
    return struct.pack(_SIZE, len(data)) + data


def _next(requests: IO[bytes]) -> bytes | None:
    """Return the next request, and nothing of what follows it; None if there is none."""
    parts: list[bytes] = []
    for wanted in (lambda: struct.calcsize(_SIZE), lambda: struct.unpack(_SIZE, parts[0])[0]):
        part, size = b"", wanted()
        while len(part) < size:
            read = requests.read(size - len(part))
            if not read:
                return None
            part += read
        parts.append(part)
    return parts[1]


def _give_way() -> None:
    """Let what a person waits for, such as a lab and its robot, go before the runs."""
    with suppress(OSError, AttributeError):
        os.nice(_NICE)
    with suppress(OSError):  # of Linux: of processes in different sessions, only this counts
        while not _lowered():
            sleep(_BETWEEN)


def _lowered() -> bool:
    """Lower the priority of this session; return whether it is not too soon after another one's."""
    try:
        Path("/proc/self/autogroup").write_text(str(_NICE))
    except BlockingIOError:
        return False
    return True


@lru_cache
def _prepare(module: str, recording: str) -> None:
    """Have what the processes of several runs need: a module, and a recording, of which nothing is run."""
    importlib.import_module(module)
    with suppress(LRPError, OSError, MemoryError):  # the run itself fails in the same way, and says so
        if recording:
            recording_of(recording).start.make_bridge()  # it is not opened, and what it needs is imported
    gc.collect()
    gc.freeze()  # the memory of what does not change is shared with the processes of the runs


@lru_cache(maxsize=2)
def _parse(text: str) -> None:
    """Have a program parsed and its blocks compiled, of which nothing is run."""
    if text:
        program, _ = scan(text)
        if program is not None:
            link(program)
        gc.freeze()


def _prctl(option: int, value: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


def _answer(packed: bytes, limit: float) -> bytes:
    """Make a run and return its answer as a line; unpickling a job may fail, or run any code."""
    # a thread of C, which also ends a call of C that does not return, and a run whose worker is gone
    faulthandler.dump_traceback_later(patience(limit) + _LATER, exit=True)
    try:
        gc.set_threshold(50_000, 20, 100)  # it ends soon, and what it has from its worker is frozen
        job, memory = pickle.loads(packed)
        _limit(memory, patience(limit))
        answer = job.done()
    except KeyboardInterrupt:  # only a program interrupts this process
        answer = {"interrupted": True}
    except BaseException as error:
        answer = {"fault": f"{sentence_of(error)}\n{traceback.format_exc()}"}
    return b"%b\n" % json.dumps(answer).encode()


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


def _forked(job: bytes, limit: float, requests: int, endings: int) -> tuple[int | None, bytes]:
    """Make a run in a process of its own; return its exit code, None if it took too long, and its answer."""
    reading, writing = os.pipe()
    worker, child = os.getpid(), os.fork()
    if not child:
        _prctl(_SET_PDEATHSIG, signal.SIGKILL)  # it ends with its worker, also in a call of C …
        if os.getppid() != worker:  # … which may have ended before that
            os._exit(1)
        os.setpgid(0, 0)  # not a session of its own, which would not give way
        for pipe in (reading, requests, endings):
            os.close(pipe)
        with os.fdopen(writing, "wb") as file:
            file.write(_answer(job, limit))
        os._exit(0)
    os.close(writing)
    is_late, answer = _read(reading, requests, monotonic() + _longest(limit))
    os.close(reading)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)  # and whatever it has started
    os.kill(child, signal.SIGKILL)  # which is not waited for yet, so its id is still its own
    _, status = os.waitpid(child, 0)
    _end_children()
    return None if is_late else os.waitstatus_to_exitcode(status), answer


def _read(answers: int, requests: int, end: float) -> tuple[bool, bytes]:
    """Return whether a run took too long, or is not needed any more, and what it wrote.

    No request comes before the ending of the last one: whatever comes, or the end of the pipe, says that the
    run is not needed any more.
    """
    data = b""
    while not data.endswith(b"\n") and len(data) <= LARGEST:
        ready, _, _ = select.select([answers, requests], [], [], max(0.0, end - monotonic()))
        if not ready or requests in ready:
            return True, data
        part = os.read(answers, 1 << 16)
        if not part:
            break
        data += part
    return False, data


def _end_children() -> None:
    """End what runs have left behind, which is this process's own when its parent has ended."""
    with suppress(OSError):
        while children := Path(f"/proc/self/task/{os.getpid()}/children").read_text().split():
            for child in children:
                os.kill(int(child), signal.SIGKILL)
            os.waitpid(-1, 0)


if __name__ == "__main__":
    main()

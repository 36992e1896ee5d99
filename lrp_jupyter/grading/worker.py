"""A worker: a process that makes one graded run after the other, each in a process forked from it.

It reads jobs from its standard input and writes what came of them to its standard output, each preceded by
its length: a job is pickled, an answer is JSON, because a program that is graded may have written it. What
programs print goes nowhere. Where processes cannot be forked, it makes one run and ends.
"""

from __future__ import annotations

import json
import os
import pickle
import selectors
import signal
import struct
import traceback
from contextlib import suppress
from time import monotonic
from typing import IO, Any

from lrp_jupyter.grading.attempt import attempt, failed

_SIZE = struct.Struct(">Q")
_LOADING = 5.0  # s beyond its own limit that a run may take, for what is not the program's


def send(pipe: IO[bytes], message: bytes) -> None:
    """Write a message."""
    pipe.write(_SIZE.pack(len(message)) + message)
    pipe.flush()


def receive(pipe: IO[bytes]) -> bytes:
    """Read a message; empty if there is none any more."""
    head = pipe.read(_SIZE.size)
    size = _SIZE.unpack(head)[0] if len(head) == _SIZE.size else 0
    message = pipe.read(size)
    return message if len(message) == size else b""


def main() -> None:
    """Make runs until the standard input is closed."""
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nothing, stream)
    while request := receive(requests):
        if not hasattr(os, "fork"):
            send(answers, _made(request))
            return
        send(answers, _forked(request, requests, answers))


def _made(request: bytes) -> bytes:
    """Make a run and return what came of it."""
    try:
        job, memory = pickle.loads(request)
        _limit(memory)
        answer: dict[str, Any] = attempt(job).to_dict()
    except BaseException:
        answer = {"fault": traceback.format_exc()}
    return json.dumps(answer).encode()


def _limit(memory: float) -> None:
    """Limit the memory of this process to what it has, and some megabytes."""
    try:
        import resource
    except ImportError:  # Windows
        return
    with suppress(OSError, ValueError):
        with open("/proc/self/statm") as file:
            pages = int(file.read().split()[0])
        most = pages * os.sysconf("SC_PAGE_SIZE") + int(memory * 1e6)
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


def _forked(request: bytes, *pipes: IO[bytes]) -> bytes:
    """Make a run in a process of its own, which ends when it takes too long; return what came of it."""
    job, _ = pickle.loads(request)
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        os.setsid()
        os.close(reading)
        for pipe in pipes:
            os.close(pipe.fileno())
        made = _made(request)
        while made:
            made = made[os.write(writing, made) :]
        os._exit(0)
    os.close(writing)
    answer: bytes | None = _read(reading, pipes[0].fileno(), monotonic() + job.limit * 7 / 6 + _LOADING)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)  # and whatever it has started
    os.kill(child, signal.SIGKILL)  # which is not waited for yet, so its id is still its own
    _, status = os.waitpid(child, 0)
    if answer is not None and _is_json(answer):
        return answer
    if answer is None:
        reason = "A call into compiled code did not return. Let the blocks wait for nothing."
        ended = failed(job, "time", f"is computed within {job.limit:g} s", reason)
    else:
        ended = failed(job, "crash", "runs to its end", _reason(status))
    return json.dumps(ended.to_dict()).encode()


def _is_json(answer: bytes) -> bool:
    try:
        json.loads(answer)
    except ValueError:
        return False
    return True


def _read(pipe: int, requests: int, end: float) -> bytes | None:
    """Read until the other end is closed; None if that takes too long, or the answer is not needed any more.

    No request comes before the answer to the last one, so if there is anything to read from that pipe, it
    is its end: the process that wanted the run is gone.
    """
    parts: list[bytes] = []
    with selectors.DefaultSelector() as selector:
        selector.register(pipe, selectors.EVENT_READ)
        selector.register(requests, selectors.EVENT_READ)
        while ready := selector.select(max(0.0, end - monotonic())):
            if any(key.fd == requests for key, _ in ready):
                break
            part = os.read(pipe, 1 << 16)
            if not part:
                os.close(pipe)
                return b"".join(parts)
            parts.append(part)
    os.close(pipe)
    return None


def _reason(status: int) -> str:
    code = os.waitstatus_to_exitcode(status)
    if code >= 0:
        return f"The program ended its own process, with the exit code {code}."
    with suppress(ValueError):
        return f"The process of the program crashed ({signal.Signals(-code).name})."
    return f"The process of the program crashed (signal {-code})."


if __name__ == "__main__":
    main()

"""Which functions of the package run, in which thread and in which order, while something is done."""

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import CodeType, FrameType
from typing import NamedTuple

import lrp_jupyter

_PACKAGE = str(Path(lrp_jupyter.__file__).parent)


class Call(NamedTuple):
    """A call of a function of the package; `path`: of its module, relative to the package."""

    thread: int
    path: str
    function: str

    @classmethod
    def of(cls, code: CodeType) -> "Call | None":
        """The call of a code that belongs to the package, in this thread."""
        if not code.co_filename.startswith(_PACKAGE):
            return None
        path = code.co_filename[len(_PACKAGE) + 1 :].replace("\\", "/")
        return cls(threading.get_ident(), path, code.co_qualname)


@contextmanager
def traced() -> Iterator[list[Call]]:
    """Collect the calls in this thread, and in those that start meanwhile."""
    calls: list[Call] = []

    def listen(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and (call := Call.of(frame.f_code)):
            calls.append(call)

    threading.setprofile(listen)
    sys.setprofile(listen)
    try:
        yield calls
    finally:
        sys.setprofile(None)
        threading.setprofile(None)  # type: ignore[arg-type]  # as its documentation says


def functions(act: Callable[[], object]) -> set[tuple[str, str]]:
    """Path and name of every function that runs while something is done in this thread."""
    with traced() as calls:
        act()
    return {(call.path, call.function) for call in calls}

"""Calls into the code of a bridge that may never return."""

from __future__ import annotations

import threading
from collections.abc import Callable

from lrp_jupyter.errors import sentence_of


def failure_of(call: Callable[[], object], timeout: float | None, name: str) -> str:
    """Call a function; return a sentence about why it failed, or an empty one. Never raises.

    `timeout`: seconds that it may take, on a thread of its own; None: it does not block, and is called here.
    """
    failures: list[str] = []

    def run() -> None:
        try:
            call()
        except BaseException as error:
            if issubclass(type(error), KeyboardInterrupt) and timeout is None:
                raise  # on the caller's thread it may be Ctrl-C
            failures.append(sentence_of(error))

    if timeout is None:
        run()
    else:
        thread = threading.Thread(target=run, name=name, daemon=True)
        try:
            thread.start()
        except RuntimeError:  # Python 3.12 starts no thread any more while it ends
            run()
        else:
            thread.join(timeout)
            if thread.is_alive():
                failures.append(f"no answer for {timeout:g} s.")
    return failures[0] if failures else ""

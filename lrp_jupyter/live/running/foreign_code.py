"""Foreign code that a loop calls outside the blocks of its program: observers, listeners, hooks, ``repr``.

An exception in it must not end the loop, and the monitor must notice if it does not return.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from traceback import format_exception
from typing import ParamSpec

Arguments = ParamSpec("Arguments")


class Foreign:
    """A single call of foreign code, by its name in messages; empty if a block of the program may call it."""

    __slots__ = ("name",)

    def __init__(self, name: str = "") -> None:
        self.name = name


def surviving(call: Callable[Arguments, object], drop: Callable[[], object]) -> Callable[Arguments, None]:
    """Wrap a subscriber: if it raises, `drop` ends its subscription and the exception is printed on stderr.

    On the main thread a KeyboardInterrupt, which means Ctrl-C, is raised. The subscriber is not notified of
    its own changes, such as an edit, to prevent endless recursion.
    """
    subscribed = True
    thread = 0  # the one that runs it

    def guarded(*arguments: Arguments.args, **named: Arguments.kwargs) -> None:
        nonlocal subscribed, thread
        if not subscribed or thread == threading.get_ident():
            return
        before, thread = thread, threading.get_ident()
        try:
            call(*arguments, **named)
        except BaseException as error:
            if issubclass(type(error), KeyboardInterrupt) and on_main_thread():
                raise
            subscribed = False
            drop()
            _print(error)
        finally:
            thread = before

    return guarded


def _print(error: BaseException) -> None:
    with suppress(BaseException):  # stderr may be closed, and an exception may have any attributes
        text = "".join(format_exception(error))
        sys.stderr.write(f"A subscriber of a session raised an exception and is not called again:\n{text}")


def on_main_thread() -> bool:
    """Return whether a KeyboardInterrupt can come from the keyboard, and not only from foreign code."""
    return threading.current_thread() is threading.main_thread()

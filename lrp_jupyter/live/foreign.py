"""Foreign code that a loop calls outside the blocks of its program: observers, listeners, hooks, ``repr``.

Whatever it raises must not end the loop, and the monitor must see when it does not return.
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
    """One call of foreign code; another call is another object.

    `name`: its name in messages, such as ``x.__repr__``; empty where a block of the program may be the
        caller.
    """

    __slots__ = ("name",)

    def __init__(self, name: str = "") -> None:
        self.name = name


def surviving(call: Callable[Arguments, object], drop: Callable[[], object]) -> Callable[Arguments, None]:
    """Wrap a subscriber: if it raises, `drop` ends its subscription and the exception is printed on stderr.

    There is no caller to raise it in. On the main thread a KeyboardInterrupt is raised: it is Ctrl-C. What
    the subscriber itself causes, by an edit for example, does not call it again, which would never end.
    """
    subscribed = True
    thread = 0  # that runs it

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
    """Return whether a KeyboardInterrupt can come from the keyboard; elsewhere foreign code has raised it."""
    return threading.current_thread() is threading.main_thread()

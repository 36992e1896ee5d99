"""Foreign code that a loop calls outside the blocks of its program: observers, listeners, hooks, ``repr``.

Whatever it raises must not end the loop, and the monitor must see when it does not return.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import ParamSpec

__all__ = ["Foreign", "surviving"]

Arguments = ParamSpec("Arguments")


class Foreign:
    """One call of foreign code; another call is another object.

    Parameters
    ----------
    name : str
        Its name in messages, such as ``x.__repr__``; empty where a block of the program may be the caller.
    """

    __slots__ = ("name",)

    def __init__(self, name: str = "") -> None:
        self.name = name


def surviving(call: Callable[Arguments, object], drop: Callable[[], object]) -> Callable[Arguments, None]:
    """Wrap a subscriber: if it raises, `drop` ends its subscription and the exception is reported.

    It is reported as Python does for a ``__del__``, because there is no caller to raise it in.
    """
    subscribed = True

    def guarded(*arguments: Arguments.args, **named: Arguments.kwargs) -> None:
        nonlocal subscribed
        if not subscribed:
            return
        try:
            call(*arguments, **named)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            subscribed = False
            drop()
            sys.unraisablehook(
                SimpleNamespace(
                    exc_type=type(error),
                    exc_value=error,
                    exc_traceback=error.__traceback__,
                    err_msg="A subscriber of a session raised an exception and is not called again",
                    object=None,
                )
            )

    return guarded

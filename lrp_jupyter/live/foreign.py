"""Foreign code that a loop calls outside the blocks of its program: observers, listeners, hooks, ``repr``.

Whatever it raises must not end the loop, and the monitor must see when it does not return.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import ParamSpec

__all__ = ["Foreign", "surviving"]

Arguments = ParamSpec("Arguments")

_LOGGER = logging.getLogger("lrp_jupyter")


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
    """Wrap a subscriber: if it raises, `drop` ends its subscription and the exception is logged.

    There is no caller to raise it in. Without any handler, Python writes the log to stderr.
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
            message = "A subscriber of a session raised an exception and is not called again."
            _LOGGER.error(message, exc_info=error)

    return guarded

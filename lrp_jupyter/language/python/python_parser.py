"""Python's parser, safe for several threads at once.

Before 3.11.8 and 3.12.2, CPython keeps one counter, shared by all threads, of the depth of the tree that it
builds. If a garbage collection lets another thread parse meanwhile, the counter is wrong and CPython raises
SystemError (its issue 106905). Nothing is damaged, so the call is repeated without garbage collection.
"""

from __future__ import annotations

import ast
import gc
from collections.abc import Callable
from typing import Any

_TIMES = 50


def parse_python(source: str, filename: str = "<unknown>", mode: str = "exec") -> Any:
    """Return what :func:`ast.parse` does; RecursionError or MemoryError: the text is nested too deeply."""
    return asked_again(ast.parse, source, filename, mode)


def asked_again(function: Callable[..., Any], *arguments: Any, **keywords: Any) -> Any:
    """Call Python's parser or compiler, again if another thread disturbed it."""
    for _ in range(_TIMES):
        try:
            return function(*arguments, **keywords)
        except SystemError:
            if not gc.isenabled():
                continue
        gc.disable()
        try:
            return function(*arguments, **keywords)
        except SystemError:
            continue
        finally:
            gc.enable()
    return function(*arguments, **keywords)

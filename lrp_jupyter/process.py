"""Python processes that this package starts: they import what this one does, and nothing of a stranger's.

The current folder may be that of the programs to be graded, or of a student: a ``random.py`` there, or a
``sitecustomize.py``, must not run in a process that only wants Python's own. So the current folder is not
searched while Python starts, and last afterwards; the standard library is first.
"""

from __future__ import annotations

import json
import os
import runpy
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

PYTHON = sys.executable
"""The path of this Python, to be told."""

_KEPT = frozenset(
    f"PYTHON{name}"
    for name in ("HOME", "PLATLIBDIR", "USERBASE", "UTF8", "IOENCODING", "DONTWRITEBYTECODE", "PYCACHEPREFIX")
)
"""The variables of Python's own that a started process has: where Python is, and how it reads and writes."""


def python_of(module: str, *arguments: str) -> dict[str, Any]:
    """Return `args` and `env` for :class:`subprocess.Popen`, with which it runs a module as a program."""
    command = [sys.executable, "-P", __file__, json.dumps(_folders(list(sys.path))), module, *arguments]
    kept = {key: value for key, value in os.environ.items() if key in _KEPT or key[:6] != "PYTHON"}
    return {"args": command, "env": kept}


@contextmanager
def safe_path() -> Iterator[None]:
    """Have processes that others start, as `multiprocessing` does, not search the current folder either."""
    before = os.environ.get("PYTHONSAFEPATH")
    os.environ["PYTHONSAFEPATH"] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ["PYTHONSAFEPATH"]
        else:
            os.environ["PYTHONSAFEPATH"] = before


def _folders(path: list[str]) -> list[str]:
    """Return where modules are looked for: Python's own first, and the current folder last."""
    library = os.path.dirname(os.__file__)
    own = (library, os.path.join(library, "lib-dynload"))
    here, folders = None, dict[str, None]()
    with suppress(OSError):  # the current folder was deleted
        here = os.path.realpath(os.getcwd())
        folders = dict.fromkeys(map(os.path.abspath, path))
    folders = folders or dict.fromkeys(filter(os.path.isabs, path))
    return sorted(folders, key=lambda each: (each not in own) + (os.path.realpath(each) == here))


if __name__ == "__main__":
    sys.path[:] = json.loads(sys.argv[1])
    sys.argv[:] = sys.argv[2:]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)

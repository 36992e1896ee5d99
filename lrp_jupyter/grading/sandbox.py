"""A sandbox for the processes that run programs: bubblewrap, on Linux.

In it there are Python, this package and the system's libraries, and all of that can only be read. There is no
other file, no place to write, no network, no other process, and of the environment only what Python needs. A
program still runs beside what judges it: what it answers is judged as any other answer.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

from lrp_jupyter.errors import LRPError

_SYSTEM = (
    "/usr",
    "/bin",
    "/sbin",
    "/lib",
    "/lib32",
    "/lib64",
    "/nix/store",
    "/etc/ld.so.cache",
    "/etc/localtime",
)
_DEVICES = ("/dev/null", "/dev/zero", "/dev/urandom")
_KEPT = ("PATH", "LANG", "TZ", "LD_LIBRARY_PATH")
_PREFIXES = ("PYTHON", "LC_", "LRP_")


def check_sandbox() -> None:
    """Raise an LRPError if there is no sandbox on this machine; it says how to get one."""
    if sys.platform != "linux":
        raise LRPError("A sandbox needs Linux. Leave it out, and grade in a container or a virtual machine.")
    if shutil.which("bwrap") is None:
        raise LRPError(
            "A sandbox needs the command `bwrap`, which is not installed. Install the package `bubblewrap` "
            "(`sudo apt install bubblewrap`), or leave the sandbox out and grade in a container."
        )


def in_sandbox(started: dict[str, Any]) -> dict[str, Any]:
    """Return `args` and `env` for :class:`subprocess.Popen` that start the same process in a sandbox."""
    environment = {
        key: value for key, value in started["env"].items() if key in _KEPT or key.startswith(_PREFIXES)
    }
    return {"args": [*_command(), *started["args"]], "env": environment}


def _command() -> list[str]:
    command = ["bwrap", "--unshare-all", "--unshare-user", "--die-with-parent", "--cap-drop", "ALL"]
    for path in dict.fromkeys([*_SYSTEM, *_python()]):
        command += ["--ro-bind-try", path, path]
    for path in _DEVICES:
        command += ["--dev-bind", path, path]
    return [*command, "--proc", "/proc", "--remount-ro", "/", "--chdir", "/", "--"]


def _python() -> list[str]:
    """Return where Python and the packages are: no folder that may hold something else."""
    installed = [path for path in sys.path if Path(path).name in ("site-packages", "dist-packages")]
    package = str(Path(__file__).parents[1])
    return [sys.base_prefix, sys.prefix, *map(str, map(Path.absolute, map(Path, installed))), package]

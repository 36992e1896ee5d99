"""The Python that runs in a browser: one version of Pyodide, from a folder or from where it is published."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

from lrp_jupyter.errors import LRPError

VERSION = "314.0.7"  # the version of Pyodide; its Python is 3.14
RUNTIME = ("pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip")  # its files
LOCK = "pyodide-lock.json"  # the list of its packages, with their versions and hashes

_TIMEOUT = 60.0  # s without an answer


class Pyodide:
    """A distribution of Pyodide.

    `folder`: a folder that contains files of it; what it lacks is downloaded.
    """

    url = f"https://cdn.jsdelivr.net/pyodide/v{VERSION}/full/"  # where it is published

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder

    def read(self, name: str, sha256: str = "") -> bytes:
        """Return the content of a file; what is downloaded must have the hash, if one is given.

        Raises LRPError: the file is neither in the folder nor can it be downloaded.
        """
        if self._folder is not None and (self._folder / name).is_file():
            return (self._folder / name).read_bytes()
        try:
            with urlopen(self.url + name, timeout=_TIMEOUT) as answer:
                content: bytes = answer.read()
        except (URLError, TimeoutError) as error:
            where = f"It is not in `{self._folder}` either. " if self._folder is not None else ""
            raise LRPError(
                f"`{name}` of Pyodide {VERSION} cannot be downloaded: {getattr(error, 'reason', error)}. "
                f"{where}Pass a folder that contains it with `--pyodide`."
            ) from error
        if sha256 and hashlib.sha256(content).hexdigest() != sha256:
            raise LRPError(
                f"What was downloaded as `{name}` of Pyodide {VERSION} is not that file. Try again."
            )
        return content

    def copy(self, names: Iterable[str], target: Path) -> None:
        """Copy files to a folder; see :meth:`read`."""
        for name in names:
            (target / name).write_bytes(self.read(name))

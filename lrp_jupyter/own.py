"""What is this user's own: a text counts as that only if its hash is noted in this user's state folder.

Files are passed on with the folder that they are in; the state folder is not. A text that comes from
elsewhere is shown, and never run unasked. In a browser all files are in its own storage, which no folder
brings.
"""

from __future__ import annotations

import hashlib
import os
import sys
from contextlib import suppress
from pathlib import Path

from lrp_jupyter.files import append_line, read_file, write_file

_NOTED = 65 * 500  # characters: hashes of the last texts, one in a line


def digest(text: str) -> str:
    """Return the hash of a text."""
    return hashlib.sha256(text.encode(errors="surrogatepass")).hexdigest()


def is_own(place: str, text_digest: str) -> bool:
    """Return whether this user's hash of a text is noted for a place."""
    if sys.platform == "emscripten":  # Python's home is always new there
        return True
    mark = _mark(place)
    return mark is not None and text_digest in (read_file(mark) or "").split()


def note_own(place: str, text_digest: str) -> None:
    """Note a hash for a place; where that is impossible, the user is asked about the text next time.

    It is appended, because replacing another file with every key would take as long as keeping the text.
    """
    mark = _mark(place)
    if mark is None:
        return
    with suppress(OSError):
        mark.parent.mkdir(parents=True, exist_ok=True)
        if mark.exists() and mark.stat().st_size > 2 * _NOTED:
            write_file(mark, (read_file(mark) or "")[-_NOTED:])
        append_line(mark, text_digest)


def state_folder() -> Path | None:
    """Return the folder for this user's state, which no notebook's folder contains."""
    try:
        if sys.platform == "win32":
            base = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local"
        elif sys.platform == "darwin":
            base = Path.home() / "Library" / "Application Support"
        else:
            base = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    except RuntimeError:  # a user without a home
        return None
    return Path(base) / "lrp-jupyter"


def _mark(place: str) -> Path | None:
    state = state_folder()
    return None if state is None else state / "kept" / digest(place)[:32]

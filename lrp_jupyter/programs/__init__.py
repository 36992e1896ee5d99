"""The bundled programs, and the header comments that describe a program.

Each is a file ``NAME.lrp`` in this directory. The first line of its header says what the program does; then
follow the world it is made for (``; world: line``, or ``none`` if it needs no robot), the challenge that it
masters, if there is one (``; challenge: there and back``), and what to watch. A heading names nothing that is
run.
"""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path, PureWindowsPath
from typing import NamedTuple

from lrp_jupyter.errors import LRPError, did_you_mean

__all__ = ["Heading", "heading", "line_of", "load", "names", "world_of"]

_COMMENT = re.compile(r"\s*[;#]+ ?(.*)")
_WORLD = re.compile(r"world: *(\S+)\s*$", re.IGNORECASE)
_CHALLENGE = re.compile(r"challenge: *(\S.*?)\s*$", re.IGNORECASE)


class Heading(NamedTuple):
    """The header comments of a program: its description, its world, and the challenge that it is about.

    Parameters
    ----------
    description : str
        The first line; empty if the text begins with a form.
    world : str or None
        Name or file of the world; ``"none"`` if the program needs no robot; None if no world is named.
    challenge : str or None
        Name of the challenge; None if none is named.
    """

    description: str = ""
    world: str | None = None
    challenge: str | None = None


def names() -> tuple[str, ...]:
    """Return the names of the bundled programs, in alphabetical order."""
    found = (entry.name for entry in files(__name__).iterdir())
    return tuple(sorted(name.removesuffix(".lrp") for name in found if name.endswith(".lrp")))


def load(name: str) -> str:
    """Return the text of a bundled program.

    Raises
    ------
    LRPError
        No bundled program has that name; the message suggests the closest one.
    """
    known = names()
    if name not in known:
        hint = did_you_mean(name, known)
        raise LRPError(f"There is no bundled program `{name}`.{hint} Choose one of: {', '.join(known)}.")
    return files(__name__).joinpath(f"{name}.lrp").read_text(encoding="utf-8")


def heading(text: str) -> Heading:
    """Return the description, the world and the challenge that the header comments of a program name."""
    comments = []
    for line in text.lstrip("\ufeff").splitlines():
        comment = _COMMENT.match(line)
        if comment is None and line.strip():
            break
        if comment is not None:
            comments.append(comment[1].strip())
    worlds = (found[1] for line in comments if (found := _WORLD.match(line)))
    challenges = (found[1] for line in comments if (found := _CHALLENGE.match(line)))
    described = (line for line in comments if line and not (_WORLD.match(line) or _CHALLENGE.match(line)))
    return Heading(next(described, ""), next(worlds, None), next(challenges, None))


def world_of(text: str, folder: Path | None) -> str | None:
    """Return the world that a text names: by its name, or as a file of the folder of the text's file.

    Whoever wrote the text decides only what the program needs: no other file of the reader is opened, and
    none of another computer.

    Raises
    ------
    LRPError
        It names another file.
    """
    world = heading(text).world
    if world is None:
        return None
    path = PureWindowsPath(world)  # which knows every way to write one
    is_file = path.suffix == ".json"
    if path.anchor or ".." in path.parts or (len(path.parts) > 1 and not is_file):
        raise LRPError(
            f"Line {line_of(text, world)} names the world `{world}`. A heading names a bundled world, or a "
            "file of the program's folder that ends with `.json`; only `--world` chooses another file."
        )
    return str(folder / world) if folder is not None and is_file else world


def line_of(text: str, word: str) -> int:
    """Return the number of the first line that has a word."""
    return text.count("\n", 0, text.find(word)) + 1

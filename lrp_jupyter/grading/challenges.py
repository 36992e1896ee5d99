"""The challenges by name, from easy to hard: the bundled ones, and those that teachers add."""

from __future__ import annotations

import os
from pathlib import Path

from lrp_jupyter.errors import LRPError, did_you_mean
from lrp_jupyter.files import run_python
from lrp_jupyter.grading.bundled import BUNDLED
from lrp_jupyter.grading.bundled.exercises import EXERCISES
from lrp_jupyter.grading.challenge import Challenge, Hint, folder

__all__ = [
    "BUNDLED",
    "EXERCISES",
    "Challenge",
    "Hint",
    "challenge",
    "challenges",
    "challenges_by_series",
    "load",
    "register",
]

_challenges: dict[str, Challenge] = {each.name: each for each in (*BUNDLED, *EXERCISES)}


def register(new: Challenge) -> Challenge:
    """Register a challenge under its name, replacing one of the same name.

    Raises
    ------
    LRPError
        A criterion names something that a world does not have.
    """
    new.check()
    _challenges.pop(new.name, None)
    _challenges[new.name] = new
    return new


def challenges() -> tuple[Challenge, ...]:
    """Return the challenges, from easy to hard."""
    return tuple(_challenges.values())


def challenges_by_series() -> dict[str, list[Challenge]]:
    """Return the challenges by the series that they belong to; first, under ``""``, those of none."""
    found: dict[str, list[Challenge]] = {"": []}
    for each in challenges():
        found.setdefault(each.series, []).append(each)
    return found


def challenge(name: str, otherwise: str = "; or a file whose name ends with `.py`") -> Challenge:
    """Return the challenge of a name, in any case, with spaces, hyphens or underscores.

    `otherwise`: what else the message offers.
    Raises LRPError: there is no challenge of that name; the message suggests the closest one.
    """
    known = {_plain(each.name): each for each in challenges()}
    wanted = _plain(name)
    if wanted in known:
        return known[wanted]
    hint = did_you_mean(wanted, known)
    single, *series = challenges_by_series().values()
    names = ", ".join([*(each.name for each in single), *(f"{a[0].name} to {a[-1].name}" for a in series)])
    raise LRPError(f"There is no challenge `{name}`.{hint} Choose one of: {names}{otherwise}.")


def load(what: str | os.PathLike[str]) -> Challenge:
    """Return the challenge of a name, or the one that a Python file registers last.

    The file is executed. It finds the files of its worlds in its own folder.

    Raises
    ------
    LRPError
        There is no such challenge or file; or the file fails or registers none.
    """
    if isinstance(what, str) and not what.endswith(".py"):
        return challenge(what)
    path = Path(what)
    before = challenges()[-1]
    names = {"__name__": f"challenge in {path.name}", "__file__": str(path)}
    token = folder.set(path.parent)
    try:
        run_python(path, names)
    finally:
        folder.reset(token)
    latest = challenges()[-1]
    if latest is before:
        raise LRPError(f"{path} registers no challenge. Let it call `register(Challenge(…))`.")
    return latest


def _plain(name: str) -> str:
    return name.replace("-", " ").replace("_", " ").casefold().strip()

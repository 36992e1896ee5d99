"""What the exercises of the lessons have in common: names, starters, robots that are not exact."""

from __future__ import annotations

from collections.abc import Callable
from importlib.resources import files
from typing import Any

from lrp_jupyter.grading.bundled.common_hints import ignores
from lrp_jupyter.grading.challenge import Challenge, Hint
from lrp_jupyter.grading.criteria import Criterion
from lrp_jupyter.grading.run_record import RunRecord

_STARTERS = files("lrp_jupyter.grading.bundled.exercises") / "starters"


def exercise(number: str, task: str, worlds: Any, *criteria: Criterion, **more: Any) -> Challenge:
    """Return an exercise of a lesson, such as number 3.2; the fourth of each lesson is open, so none here."""
    return _in_series("exercises of the lessons", f"exercise {number}", task, worlds, criteria, more)


def bug(number: int, task: str, worlds: Any, *criteria: Criterion, **more: Any) -> Challenge:
    """Return a challenge whose starter has one mistake, which is to be found."""
    return _in_series("find the bug", f"bug {number}", task, worlds, criteria, more)


def says(text: str, when: Callable[[RunRecord], object] = lambda run: True) -> Hint:
    """Return a hint for the failed runs of which a condition holds; default: for all."""
    return lambda run: text if when(run) else None


def without_reading(sensor: str, advice: str) -> Hint:
    """Return a hint for programs that do not read a sensor, such as ``"light"``."""
    return lambda run: ignores(run, sensor, advice)


def _in_series(
    series: str, name: str, task: str, worlds: Any, criteria: tuple[Criterion, ...], more: dict[str, Any]
) -> Challenge:
    text = (_STARTERS / f"{name.replace(' ', '-')}.lrp").read_text(encoding="utf-8")
    usual = {"noise": {"motor": 0.02}, "seeds": 2}
    return Challenge(name, task, worlds, criteria, **{**usual, **more}, starter=text, series=series)

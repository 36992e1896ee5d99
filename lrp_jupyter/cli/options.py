"""What was asked of ``lrp run``, read and checked before anything moves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import typer

from lrp_jupyter.cli.initials import Assignment
from lrp_jupyter.language.blocks import facts_of

__all__ = ["RunOptions", "parse_options"]


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Options of a run.

    Parameters
    ----------
    bridge, world : str or None
        None: what the text says, else the simulator and its line.
    rate : float
        Ticks per second; 0 for as many as possible.
    seconds : float
        After which the run ends; infinite: never.
    until : str or None
        A state that ends the run when it is entered.
    speed : float
        Times real time; infinite: never wait.
    noise : dict
        Imperfections of the simulated robot.
    assignments : tuple of Assignment
        Other initial values.
    trace : str or None
        A file, or ``-``.
    answers : dict
        Options of the bridge, and answers to its questions.
    """

    bridge: str | None
    world: str | None
    rate: float
    seconds: float
    until: str | None
    speed: float
    seed: int | None
    noise: dict[str, float]
    assignments: tuple[Assignment, ...]
    trace: str | None
    watch: bool
    on_issue: Literal["record", "pause"]
    answers: dict[str, str]


def parse_options(
    *,
    seconds: float | None,
    speed: str,
    noise: Sequence[str],
    assignments: Sequence[str],
    answers: Sequence[str],
    **others: Any,
) -> RunOptions:
    """Read those options that are more than a text or a number.

    Raises
    ------
    typer.BadParameter
        With a sentence.
    """
    return RunOptions(
        seconds=math.inf if seconds is None else seconds,
        speed=_speed(speed),
        noise={name: _number(text, f"--noise {name}") for name, text in _pairs(noise, "--noise")},
        assignments=tuple(_assignment(name, text) for name, text in _pairs(assignments, "--set")),
        answers=dict(_pairs(answers, "--option")),
        **others,
    )


def _pairs(texts: Sequence[str], option: str) -> list[tuple[str, str]]:
    pairs = []
    for text in texts:
        name, equals, value = text.partition("=")
        if not (equals and name.strip()):
            raise typer.BadParameter(f"{option} takes NAME=VALUE, not `{text}`.")
        pairs.append((name.strip(), value.strip()))
    return pairs


def _speed(text: str) -> float:
    if text == "max":
        return math.inf
    speed = _number(text.removesuffix("x"), "--speed", "a factor such as 2 or 0.5, or `max`")
    if not 0 < speed < math.inf:
        raise typer.BadParameter(f"--speed takes a factor above 0, or `max`, not `{text}`.")
    return speed


def _number(text: str, option: str, what: str = "a number") -> float:
    try:
        return float(text)
    except ValueError:
        raise typer.BadParameter(f"{option} takes {what}, not `{text}`.") from None


def _assignment(name: str, text: str) -> Assignment:
    facts = facts_of(text)
    if facts.empty or facts.fault is not None:
        why = facts.fault.message if facts.fault is not None else "it is empty"
        raise typer.BadParameter(f"--set {name}: `{text}` is not Python: {why}")
    return Assignment(tuple(name.strip("/").split("/")), text)

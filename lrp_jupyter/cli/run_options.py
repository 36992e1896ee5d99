"""Options of ``lrp run``, parsed and checked before anything moves."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any, Literal, NamedTuple

import typer

from lrp_jupyter.errors import FileError, LRPError, UnknownElementError
from lrp_jupyter.files import shown
from lrp_jupyter.language.blocks.block import facts_of, faults_of
from lrp_jupyter.language.edits.initials import with_initialiser
from lrp_jupyter.language.program import Program
from lrp_jupyter.live.running.timing import FASTEST, SLOWEST


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Options of a run."""

    bridge: str | None  # None: what the text names, or the simulator
    world: str | None  # None: what the text names, or `line`
    rate: float  # Hz; 0: as many as possible
    seconds: float  # may be infinite
    until: str | None
    start: str | None  # a machine or a state; None: what the program spawns
    speed: float  # factor of real time; infinite: never wait
    seed: int | None
    noise: dict[str, float]
    assignments: tuple[Assignment, ...]
    trace: str | None  # a file, or `-` for stdout
    record: str | None
    animate: str | None
    breakpoints: tuple[str, ...]  # `STATE`, `TRANSITION`, `left STATE`, `event NAME` or `when EXPRESSION`
    fires: tuple[tuple[str, float], ...]  # transitions fired by hand, each with its time in seconds
    watch: bool
    socket: bool  # whether editors are told what runs
    serve: str | None  # where its page is served: `[HOST:]PORT`
    certificate: str | None
    key: str | None
    read_only: bool
    on_active_edit: Literal["restart", "keep"]
    on_issue: Literal["record", "pause"]
    answers: dict[str, str]  # options of the bridge, and answers to its questions
    ros_arguments: tuple[str, ...] = ()  # for a node of ROS


def parse_options(
    *,
    rate: float,
    seconds: float | None,
    speed: str,
    noise: Sequence[str],
    assignments: Sequence[str],
    fires: Sequence[str],
    answers: Sequence[str],
    **others: Any,
) -> RunOptions:
    """Return the options of a run, with those parsed that are more than a text or a number."""
    if others["serve"] is None and (others["certificate"] or others["key"] or others["read_only"]):
        raise typer.BadParameter("--certificate, --key and --read-only are for a page: add `--serve PORT`.")
    if others["key"] and not others["certificate"]:
        raise typer.BadParameter("--key is that of a certificate: add `--certificate FILE`.")
    if others["serve"] is not None and assignments:
        raise typer.BadParameter(
            "--set runs another program than the text that a page would show. Leave it out, and change the"
            " text."
        )
    if not (rate == 0 or SLOWEST <= rate <= FASTEST):
        raise typer.BadParameter(
            f"--rate takes {SLOWEST:g} to {FASTEST:,.0f} ticks per second, or 0 for as many as possible, "
            f"not `{rate:g}`."
        )
    return RunOptions(
        rate=rate,
        seconds=math.inf if seconds is None else seconds,
        speed=_speed(speed),
        noise={name: _number(text, f"--noise {name}") for name, text in pairs_of(noise, "--noise")},
        assignments=tuple(_assignment(name, text) for name, text in pairs_of(assignments, "--set")),
        fires=tuple(map(_fire, fires)),
        answers=dict(pairs_of(answers, "--option")),
        **others,
    )


def pairs_of(texts: Sequence[str], option: str) -> list[tuple[str, str]]:
    """Return the names and values of the texts ``NAME=VALUE`` of an option."""
    pairs = []
    for text in texts:
        name, equals, value = text.partition("=")
        if not (equals and name.strip()):
            raise typer.BadParameter(f"{option} takes NAME=VALUE, not `{text}`.")
        pairs.append((name.strip(), value.strip()))
    return pairs


def check_outputs(out: Iterable[str | FilePath], suffixes: Sequence[str]) -> None:
    """Raise an error if a file cannot be written, or has none of the suffixes, of which one may be empty."""
    *others, last = [f"`{suffix}`" for suffix in suffixes if suffix]
    known = f"{', '.join(others)} or {last}" if others else last
    for path in map(FilePath, out):
        if not any(path.name.lower().endswith(suffix) if suffix else not path.suffix for suffix in suffixes):
            raise LRPError(f"`{shown(path)}` cannot be written: the name must end with {known}.")
        if not path.absolute().parent.is_dir():
            raise FileError(f"`{shown(path)}` cannot be written: there is no such folder. Create it first.")


def _fire(text: str) -> tuple[str, float]:
    name, _, seconds = text.rpartition("@")
    if not name.strip():
        raise typer.BadParameter(f"--fire takes TRANSITION@SECONDS, such as `tlooking@2.5`, not `{text}`.")
    return name.strip(), _number(seconds, f"--fire {name}@", "a number of seconds", least=0)


def _speed(text: str) -> float:
    if text == "max":
        return math.inf
    return _number(
        text.removesuffix("x"), "--speed", "a factor of 0.001 or more, such as 2, or `max`", least=0.001
    )


def _number(text: str, option: str, what: str = "a number", least: float = -math.inf) -> float:
    with suppress(ValueError):
        if math.isfinite(number := float(text)) and number >= least:
            return number
    raise typer.BadParameter(f"{option} takes {what}, not `{text}`.")


def _assignment(name: str, text: str) -> Assignment:
    facts = facts_of(text)
    if facts.empty or not facts.valid:
        why = "It is empty." if facts.valid else faults_of(text)[0].message
        raise typer.BadParameter(f"--set {name}: `{text}` is not a valid Python expression: {why}")
    return Assignment(name, text)


class Assignment(NamedTuple):
    """A variable, by name or path, and a Python expression."""

    variable: str
    expression: str


def with_initials(program: Program, assignments: Sequence[Assignment]) -> Program:
    """Return the program with its initialisers replaced by the assigned expressions; its text stays."""
    for variable, expression in assignments:
        try:
            program = with_initialiser(program, variable, expression)
        except UnknownElementError as error:
            raise UnknownElementError(f"--set {variable}: {error}", error.candidates) from None
    return program

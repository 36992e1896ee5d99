"""``lrp replay | why | looks``: run a recording again, ask it why, list what its user looked at."""

from __future__ import annotations

import pydoc
import sys
from collections.abc import Iterator
from pathlib import Path

import typer
from rich.text import Text

from lrp_jupyter.cli.console import plain_console
from lrp_jupyter.cli.event_printer import SHOWN, EventPrinter
from lrp_jupyter.cli.excerpt import excerpt, print_findings, ran
from lrp_jupyter.cli.program_source import read_source
from lrp_jupyter.cli.run_options import check_outputs
from lrp_jupyter.errors import LRPError, UnknownElementError, printable
from lrp_jupyter.files import write_file
from lrp_jupyter.interpreter.trace_events import Observer, TraceEvent
from lrp_jupyter.language.parser import scan
from lrp_jupyter.live.recording import Recording, read_recording
from lrp_jupyter.live.reproduction import Reproduction, reproduce
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.inputs import Input
from lrp_jupyter.live.stored.looked_at import Look
from lrp_jupyter.spreadsheets import csv_text

_ROUNDING = 1e-6  # s
_SETS = (
    "If it walks over a set of texts: Python puts these into another order in every process. Set the "
    "variable `PYTHONHASHSEED` to one number for the run and for its replay."
)


def replay_file(file: str, program: str | None, begin: float, end: float | None, trusted: bool) -> int:
    """Run a recording again, print its events and the first difference; return the exit code."""
    if end is not None and begin > end:
        raise typer.BadParameter(
            f"--from {begin:g} is after --until {end:g}, so nothing would be printed. Choose an earlier one."
        )
    recording = _read(file, trusted)
    console, complaints = plain_console(), plain_console(stderr=True)
    text = _other_program(program)
    printer = EventPrinter(console, quiet=False)
    if when := _recorded(recording):
        console.print(when)

    def show(event: TraceEvent) -> None:
        if event.kind in SHOWN and event.now >= begin - _ROUNDING:
            printer.write(event, text or recording.start.text)

    again = _run_again(recording, end, text, show)
    with again.session:
        console.print(ran(recording.name, again.session.frame))
        if recording.cut:
            complaints.print("The recording is cut off; it was replayed up to its last complete tick.")
        if again.difference is None:
            console.print("The run matches the recording.")
            return 0
        console.print(Text(str(again.difference), "bold yellow"))
        if text is not None:
            return 0
        console.print(_SETS)
        return 1


def why_file(file: str, name: str, at: float | None, program: str | None, trusted: bool) -> int:
    """Run a recording again up to a time, and print why something happened there or did not."""
    recording = _read(file, trusted)
    if at is not None and at > recording.seconds + _ROUNDING:
        raise typer.BadParameter(
            f"`{recording.name}` ends at {recording.seconds:.1f} s. Ask about an earlier time."
        )
    text = _other_program(program)
    again = _run_again(recording, at, text)
    with again.session as session:
        if again.difference is not None and text is None:
            plain_console(stderr=True).print(
                Text(f"The run differs from the recording. {again.difference} {_SETS}", "yellow")
            )
        try:
            reason = session.explain(name)
        except (UnknownElementError, ValueError) as error:
            raise typer.BadParameter(str(error)) from None
        console = plain_console()
        if when := _recorded(recording):
            console.print(when)
        console.print(Text(str(reason)))
        source = session.program.text
        for line in reason.facts["lines"]:
            for row in excerpt(source, line, 1)[:1]:
                console.print(Text(row))
        return 0


def looks_file(file: str, out: Path | None) -> int:
    """Print, or write, what a person looked at and did; return the exit code."""
    if out is not None:
        check_outputs([out], (".csv",))
    recording = read_recording(file)
    looks = sorted(recording.looks, key=lambda each: each.wall)
    if out is not None:
        write_file(out, csv_text(Look._fields, looks))
        return 0
    console = plain_console()
    for tick, time, wall, what, about, on in looks:
        row = f"{wall:9.2f} s  {time:8.2f} s  tick {tick:<6} {what:8} {printable(about)}"
        console.print(Text(row if on else f"{row}, ended"))
    if not looks:
        name = recording.name
        console.print(f"`{name}` does not say what its user looked at. `%%lrp NAME --log FILE` records it.")
    return 0


def _recorded(recording: Recording) -> str:
    """Return when a recording was made and, of a robot with a clock, what that showed then; maybe nothing."""
    when = recording.start.recorded
    words = f"Recorded {printable(when)}." if when else ""
    if recording.clock:
        time, shown = recording.clock[0]
        words += f" The robot's clock was at {shown - time:.3f} s at 0 s."
    return words.strip()


def _read(file: str, trusted: bool) -> Recording:
    recording = read_recording(file)
    if trusted or recording.is_own:
        return recording
    question = (
        f"`{recording.name}` contains a program that you have not recorded here, and its blocks can do "
        "whatever you can do. Read it before you run it."
    )
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        raise LRPError(f"{question} It runs with `--trust`.")
    typer.echo(question, err=True)
    while (answer := typer.prompt("Run it? [y/N, r to read it]", "n", show_default=False, err=True)) == "r":
        pydoc.pager("".join(printable(f"{text}\n", "\n\t") for text in _code(recording)))
    if answer.lower() not in ("y", "yes"):
        raise typer.Exit(2)
    return recording


def _code(recording: Recording) -> Iterator[str]:
    """Yield the texts that are run with a recording."""
    yield recording.start.text
    yield from recording.start.initials.values()
    for entry in recording.entries:
        match entry:
            case Input(what=do.ReplaceProgram(program, unmeant)):
                yield from [program.text, *([] if unmeant is None else [unmeant.instead.text])]
            case Input(what=do.Renew(program)):
                yield program.text
            case Input(what=do.SetVariable(_, expression)):
                yield expression


def _other_program(program: str | None) -> str | None:
    if program is None:
        return None
    source = read_source(program)
    parsed, findings = scan(source.text, source.name)
    if parsed is None:
        print_findings(source.name, source.text, findings)
        raise typer.Exit(1)
    return source.text


def _run_again(
    recording: Recording, until: float | None, text: str | None, show: Observer | None = None
) -> Reproduction:
    if recording.start.names:
        listed = ", ".join(f"`{name}`" for name in recording.start.names)
        raise typer.BadParameter(
            f"`{recording.name}` was recorded in a notebook, and its blocks use names defined there "
            f"({listed}). "
            "Replay it in that notebook: `from lrp_jupyter.live.recording import read_recording`, "
            "`from lrp_jupyter.live.reproduction import reproduce`, "
            "`reproduce(read_recording(…), namespace=globals())`."
        )
    return reproduce(recording, until, text, show)

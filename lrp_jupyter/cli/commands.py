"""The commands, their options and their help; what they do stands in modules of their own."""

from __future__ import annotations

from enum import StrEnum
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from lrp_jupyter.errors import LRPError

__all__ = ["app"]


class _Commands(TyperGroup):
    """Errors that a person can mend are one sentence."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except (LRPError, OSError) as error:
            if isinstance(error, OSError) and not isinstance(error, LRPError):
                name = f"`{error.filename}`: " if error.filename else ""
                error = LRPError(f"{name}{(error.strerror or str(error)).lower()}")
            typer.echo(f"lrp: {error}", err=True)
            raise typer.Exit(2) from None


app = typer.Typer(
    cls=_Commands,
    no_args_is_help=True,
    add_completion=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


class Findings(StrEnum):
    """How ``lrp check`` writes."""

    text = "text"
    json = "json"


class Drawing(StrEnum):
    """How ``lrp graph`` writes."""

    svg = "svg"
    dot = "dot"
    mermaid = "mermaid"
    json = "json"


class OnIssue(StrEnum):
    """What a fault of the running program does."""

    record = "record"
    pause = "pause"


File = Annotated[str, typer.Argument(metavar="FILE", help="A file, a bundled program's name, or `-`.")]


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"lrp {version('lrp-jupyter')}")
        raise typer.Exit


@app.callback()
def lrp(
    _: Annotated[
        bool, typer.Option("--version", help="Say which version this is.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """Live programming of robot behaviour: nested state machines that change while they run.

    Begin with `lrp run follower`.
    """


RUN_EPILOG = """
**Exit code**: 0 when the run came to its end, 1 when the text is not a program (or `--until` was not
reached, or the run paused at an issue with no keyboard at hand), 2 when something cannot be read or opened or
an option is wrong, 3 when the interpreter itself failed. Ctrl-C stops the robot and ends the run: 130.

**Live programming**: with `--watch` every save of the file changes the running program. A text that is not
a program changes nothing: its errors are shown, the last program runs on.

**Traces**: `--trace` writes JSON Lines, an object per event, with `tick` (the first is 1), `time` (seconds)
and `event`: `started`, `paused`, `resumed`; `entered`, `left` (`state`); `fired` (`machine`, `transition`,
`source`, `destination`); `spawned`, `discarded` (`machine`); `changed` (`variable`, `value`); `issue`
(`code`, `element`, `line`, `message`); `patched` (`applied`, `restarted`, `reason`); `restarted` (`reason`);
`forced` (`state`, `how`). The same program, world and seed give the same trace.
"""


@app.command(epilog=RUN_EPILOG)
def run(
    file: File,
    bridge: Annotated[
        str | None,
        typer.Option(help="The robot: see `lrp bridges`. Naming hardware arms it. By default the simulator."),
    ] = None,
    world: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|FILE", help="Where to drive: see `lrp worlds`. By default what the text says."
        ),
    ] = None,
    rate: Annotated[
        float, typer.Option(metavar="HZ", min=0, help="Ticks per second; 0: as many as possible.")
    ] = 10,
    seconds: Annotated[
        float | None,
        typer.Option("--for", metavar="SECONDS", min=0, help="End after so much time of the run."),
    ] = None,
    until: Annotated[
        str | None, typer.Option(metavar="STATE", help="End when this state is entered.")
    ] = None,
    speed: Annotated[
        str, typer.Option(metavar="X|max", help="Times real time; `max`: never wait (simulator only).")
    ] = "1",
    seed: Annotated[int | None, typer.Option(help="Of the simulator's noise.")] = None,
    noise: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=NUMBER", help="Imperfections: `motor=0.1`, `light=10`; see `lrp worlds`."),
    ] = None,
    assignments: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=EXPR", help="Let a variable begin with another value; may be repeated."
        ),
    ] = None,
    trace: Annotated[
        str | None, typer.Option(metavar="FILE|-", help="Write what happens as JSON Lines; `-`: on stdout.")
    ] = None,
    watch: Annotated[
        bool, typer.Option("--watch", help="Every save of the file changes the running program.")
    ] = False,
    on_issue: Annotated[OnIssue, typer.Option(help="What a fault of the program does.")] = OnIssue.record,
    host: Annotated[
        str | None, typer.Option(help="Address of the robot: short for `--option host=…`.")
    ] = None,
    options: Annotated[
        list[str] | None,
        typer.Option(
            "--option", "-o", metavar="KEY=VALUE", help="An option of the bridge, or an answer to it."
        ),
    ] = None,
) -> None:
    """Run a program and show what it does, while it can be changed."""
    from lrp_jupyter.cli.options import parse_options
    from lrp_jupyter.cli.run import run_file

    wanted = parse_options(
        bridge=bridge,
        world=world,
        rate=rate,
        seconds=seconds,
        until=until,
        speed=speed,
        seed=seed,
        noise=noise or [],
        assignments=assignments or [],
        trace=trace,
        watch=watch,
        on_issue=on_issue.value,
        answers=[*([f"host={host}"] if host else []), *(options or [])],
    )
    raise typer.Exit(run_file(file, wanted))


@app.command()
def check(
    files: Annotated[
        list[str], typer.Argument(metavar="FILE…", help="Files, bundled programs' names, or `-`.")
    ],
    form: Annotated[
        Findings, typer.Option("--format", help="For people, or for other programs.")
    ] = Findings.text,
) -> None:
    """Find what is wrong with programs, without running them.

    **Exit code**: 0 when there are no errors (there may be warnings and hints), 1 when there are, 2 when a
    file cannot be read.
    """
    from lrp_jupyter.cli.check import check_files

    raise typer.Exit(check_files(files, form is Findings.json))


@app.command()
def graph(
    file: File,
    machine: Annotated[
        str | None, typer.Option(metavar="PATH", help="One machine only: `follower/looking/lookalgo`.")
    ] = None,
    form: Annotated[
        Drawing | None, typer.Option("--format", help="By default as the output file is called, else `svg`.")
    ] = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", metavar="FILE")] = None,
) -> None:
    """Draw the state machines of a program.

    **Exit code**: 0, or 1 when the text is not a program, 2 when something cannot be read or written.
    """
    from lrp_jupyter.cli.graph import draw_graph

    raise typer.Exit(draw_graph(file, machine, form.value if form else None, output))


@app.command()
def grade(
    file: Annotated[
        str | None, typer.Argument(metavar="FILE", help="A file, a bundled program, or `-`.")
    ] = None,
    challenge: Annotated[str | None, typer.Option(metavar="NAME", help="What it has to master.")] = None,
    seeds: Annotated[
        int, typer.Option(metavar="N", min=1, help="Runs in each world, each with other noise.")
    ] = 1,
) -> None:
    """Judge a program by a challenge; without arguments: list the challenges.

    **Exit code**: 0 when every run met every criterion, 1 when not, 2 when there is no such file or
    challenge.
    """
    if file is None or challenge is None:
        from lrp_jupyter.cli.lists import list_challenges

        if file is not None:
            typer.echo("lrp: grade by what? Choose a challenge: `--challenge NAME`.\n", err=True)
        list_challenges()
        raise typer.Exit(2 if file is not None or challenge is not None else 0)
    from lrp_jupyter.cli.check import grade_file

    raise typer.Exit(grade_file(file, challenge, seeds))


@app.command()
def programs(
    show: Annotated[str | None, typer.Option(metavar="NAME", help="Print the text of one.")] = None,
) -> None:
    """List the bundled programs."""
    from lrp_jupyter.cli.lists import list_programs

    list_programs(show)


@app.command()
def worlds(
    show: Annotated[str | None, typer.Option(metavar="NAME|FILE", help="Draw the map of one.")] = None,
    as_json: Annotated[
        str | None,
        typer.Option("--json", metavar="NAME|FILE", help="Print one as JSON, to make one's own from."),
    ] = None,
) -> None:
    """List the bundled worlds of the simulator."""
    from lrp_jupyter.cli.lists import list_worlds

    list_worlds(show or as_json, as_json is not None)


@app.command()
def bridges() -> None:
    """List the robots that can be chosen."""
    from lrp_jupyter.cli.lists import list_bridges

    list_bridges()


@app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def lab(
    ctx: typer.Context,
    folder: Annotated[
        Path, typer.Option("--dir", metavar="FOLDER", help="Where the notebooks are copied to.")
    ] = Path("lrp-notebooks"),
    browser: Annotated[bool, typer.Option(help="Open a browser.")] = True,
) -> None:
    """Open JupyterLab on a copy of the notebooks, beginning with the first.

    What you changed in the copies is left alone when you come again. Further options go to JupyterLab.
    """
    from lrp_jupyter.cli.lab import open_lab

    open_lab(folder.resolve(), browser, ctx.args)

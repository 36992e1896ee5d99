"""The commands about recorded runs: ``replay``, ``test``, ``why`` and ``looks``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from lrp_jupyter.cli import complete
from lrp_jupyter.cli.subcommands.application import command, time_option

Log = Annotated[
    str, Argument(metavar="RECORDING", help="A file that `lrp run --record` or `Session.record` wrote.")
]
Another = Annotated[
    str | None,
    Option(
        metavar="FILE",
        autocompletion=complete.sources,
        help="Run this program instead of the recorded one, with the recorded inputs, but without its edits.",
    ),
]


Trusted = Annotated[
    bool, Option("--trust", help="Run the program of a recording that you have not made, without a question.")
]
RECORDING_EPILOG = """
**What runs**: the recorded program. Its blocks are Python, which can do whatever you can do: of a recording
that another person made, or changed, it is asked first. Without a keyboard `--trust` is the answer. Commands
of `robot` reach no robot: they are recorded, and inert. What a block does by itself cannot be held back, and
happens again: one that uses `rospy` or another client library, a socket or a serial port acts on the live
robot. `lrp check` names such blocks (LRP550, LRP551).
"""


@command(epilog=RECORDING_EPILOG)
def replay(
    file: Log,
    program: Another = None,
    begin: Annotated[float, time_option("--from", help="Print only what comes after this time.")] = 0,
    end: Annotated[float | None, time_option("--until", help="End at this time of the run.")] = None,
    trust: Trusted = False,
) -> None:
    """Run a recording again, as fast as possible, and report the first difference.

    A simulated run is reproduced bit for bit; that of a program that walks over a set of texts, if
    `PYTHONHASHSEED` is the same number as in the run. The readings of a real robot are fed to the program
    again, and no command of `robot` is sent to it.

    **Exit code**: 0 when the run matches the recording (or with `--program`, when it ran), 1 when it differs,
    2 when the file cannot be read or its program may not run.
    """
    from lrp_jupyter.cli.recording_commands import replay_file

    raise typer.Exit(replay_file(file, program, begin, end, trust))


@command("test")
def examples(
    program: Annotated[str, Argument(metavar="PROGRAM", help="A file, or the name of a bundled program.")],
    runs: Annotated[
        list[str] | None,
        Argument(metavar="RUNS…", help="Recordings, or folders of them. Default: the folder `NAME.runs`."),
    ] = None,
    coverage: Annotated[bool, Option("--coverage", help="Print what of the program no run reaches.")] = False,
    junit: Annotated[Path | None, Option(metavar="FILE.xml", help="Write results for a CI service.")] = None,
    limit: Annotated[float, Option(metavar="SECONDS", min=0.1, max=1e5, help="Of computing for each.")] = 60,
    trust: Annotated[
        bool, Option("--trust", help="Evaluate the expressions in recordings that you have not made.")
    ] = False,
) -> None:
    """Run the kept runs of a program again, and judge each by what is expected of it.

    What is expected is one line for each run in `expected.toml` beside the recordings: `as recorded` (the
    same states at the same times), `reaches STATE within 30 s`, `never enters STATE`, `never touches`,
    `meets CHALLENGE`, or several with commas between them.

    **Exit code**: 0 when all runs passed, 1 when one did not or the program is not valid, 2 when a file
    cannot be read.
    """
    from lrp_jupyter.cli.runs_command import decide_runs
    from lrp_jupyter.grading.workers import HowRun

    raise typer.Exit(decide_runs(program, runs or [], HowRun(limit=limit), coverage, junit, trust))


@command(epilog=RECORDING_EPILOG)
def why(
    file: Log,
    name: Annotated[
        str,
        Argument(
            metavar="NAME", help="A transition, a state, or a command of the robot such as `robot.move`."
        ),
    ],
    at: Annotated[float | None, time_option(help="The time of the run. Default: its end.")] = None,
    program: Another = None,
    trust: Trusted = False,
) -> None:
    """Say why a transition did not fire in a recorded run, why a state was entered, or why the robot moves.

    The recording is run again up to that time, as `lrp replay` does.

    **Exit code**: 0, or 2 when the file cannot be read, its program may not run, or it has no such name.
    """
    from lrp_jupyter.cli.recording_commands import why_file

    raise typer.Exit(why_file(file, name, at, program, trust))


@command()
def looks(
    file: Log,
    out: Annotated[
        Path | None, Option(metavar="FILE", help="Write the table as `.csv` instead of printing it.")
    ] = None,
) -> None:
    """List what a person looked at and did, if that was recorded: `%%lrp NAME --log FILE`.

    Each row has the seconds since the recording began (`wall`), the time and the tick of the run, what it was
    (`why`, `hover`, `playhead`, `panel`, `command`, `input` …) and about what, and whether it began or ended.
    Inputs are what changed the run: edits and the like. Nothing of the recording runs.

    **Exit code**: 0, or 2 when a file cannot be read or written.
    """
    from lrp_jupyter.cli.recording_commands import looks_file

    raise typer.Exit(looks_file(file, out))

"""The commands with their options and help texts; other modules implement them."""

from __future__ import annotations

from enum import StrEnum
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any

import typer
from typer import Argument, Option
from typer.core import TyperCommand, TyperGroup

from lrp_jupyter.cli import complete
from lrp_jupyter.errors import LRPError, lacks_simulator


class _Commands(TyperGroup):
    """A command group that prints an error of the user's as one sentence and exits with code 2."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except (LRPError, OSError, ModuleNotFoundError) as error:
            if isinstance(error, ModuleNotFoundError):
                if not (lacking := lacks_simulator(error)):
                    raise
                error = LRPError(lacking)
            elif isinstance(error, OSError) and not isinstance(error, LRPError):
                name = f"`{error.filename}` cannot be used: " if error.filename else ""
                error = LRPError(f"{name}{error.strerror or str(error)}.")
            typer.echo(f"lrp: {error}", err=True)
            raise typer.Exit(error.exit_code) from None


class _Command(TyperCommand):
    """A command that takes no empty text, which would be the current folder, or nothing at all."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        known = {name for parameter in self.params for name in parameter.opts}
        for before, text in zip(["", *args], args, strict=False):
            name, equals, value = text.partition("=")
            is_option = bool(equals) and name in known
            if not (value if is_option else text).strip():
                named = name if is_option else before if before in known else "An argument"
                raise typer.BadParameter(f"{named} is empty. Write what is meant, or leave it out.")
        return super().parse_args(ctx, args)


class _NodeCommand(_Command):
    """A command that takes the arguments of a node of ROS, wherever they stand."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        if not any(":=" in text or text == "--ros-args" for text in args):
            return super().parse_args(ctx, args)
        from lrp_jupyter.bridges.ros.arguments import split_arguments

        own, ros = split_arguments(args)
        return super().parse_args(ctx, [*own, *([] if "--" in own else ["--"]), *ros] if ros else own)


app = typer.Typer(
    cls=_Commands,
    no_args_is_help=True,
    add_completion=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
command = partial(app.command, cls=_Command)


_time_option = partial(Option, metavar="SECONDS", min=0, max=1e7)  # of a run
_seeds_option = partial(Option, metavar="N", min=1, max=100_000)


class Findings(StrEnum):
    """Output formats of ``lrp check``."""

    text = "text"
    json = "json"


class Drawing(StrEnum):
    """Output formats of ``lrp graph``."""

    svg = "svg"
    dot = "dot"
    mermaid = "mermaid"
    json = "json"


class EditPolicy(StrEnum):
    """What an edit does that changes an active state."""

    restart = "restart"
    keep = "keep"


class OnIssue(StrEnum):
    """What happens at a fault of the running program."""

    record = "record"
    pause = "pause"


File = Annotated[
    str,
    Argument(
        metavar="FILE",
        help="A file, the name of a bundled program, or `-` for stdin.",
        autocompletion=complete.sources,
    ),
]


BridgeOptions = Annotated[
    list[str] | None,
    Option("--option", "-o", metavar="KEY=VALUE", help="An option of the bridge, or an answer to it."),
]


RosArguments = Annotated[
    list[str] | None,
    Argument(
        metavar="ROS_ARGUMENTS",
        help="For a node of ROS: what roslaunch and `ros2 launch` append, such as `__name:=behaviour`.",
    ),
]


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"lrp {version('lrp-jupyter')}")
        raise typer.Exit


@app.callback()
def lrp(
    _: Annotated[
        bool, Option("--version", help="Print the version.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """Live programming of robot behaviour: nested state machines that change while they run.

    Start with `lrp run follower`.

    **Exit codes**: 0 when all went well; 1 when a text has errors, or what was demanded of a program did not
    happen; 2 when an argument is wrong, or a file or robot cannot be used; 3 for a fault of this package; 4
    when no robot answers; 5 when ROS 1 has ended the node; 130 after Ctrl-C; 154 when a call of C that
    cannot be interrupted has exceeded a limit. The help of `run`, `check`, `format`, `graph`, `grade` and
    `sweep` has the details.
    """


RUN_EPILOG = """
**Exit code**: 0 when the run ended normally, 1 when the text is not a valid program (or `--until` was not
reached, or the run paused, at an issue or a breakpoint, and nothing can resume it, or a block did not return
for 10 s in a run with `--for`), 2 when a file cannot be read, a robot cannot be opened or an option is wrong,
3 when the interpreter itself failed, 4 when the robot did not answer, nothing of it ever worked, or it was
lost at the end, 5 when ROS 1 has ended the node (another one took its name, or `rosnode kill`), 130 when
Ctrl-C stopped the robot and ended the run, 143 after SIGTERM, 154 when a run with `--for` was ended because
one call of C did not return: the stacks that are printed then show its line.

**Live programming**: with `--watch` every save of the file patches the running program. A text that is not a
valid program changes nothing: its errors are shown and the last valid program keeps running. A block that
does not return is interrupted by the next save, or by the key `i`.

**Breakpoints**: `--break looking` completes the tick in which the state `looking` is entered, then pauses;
space resumes, `s` steps. `--break tlooking` waits for a transition, `--break 'left moving'` for the end of a
state, `--break 'event outofline'` for an event, `--break 'when robot.light.data < 50'` for a condition over
the global variables and the robot to become True. Without a keyboard or `--watch` the run ends there, with
exit code 1.

**By hand**: `--fire tlooking@2.5` fires the transition `tlooking` after the tick at 2.5 s, whatever its
condition, if a state that it leaves is active. Recordings, `lrp replay` and `lrp why` know it.

**Traces**: `--trace` writes JSON Lines, one object per event, with `tick` (the first is 1), `time` (seconds)
and `event`: `started`, `paused`, `resumed`, `ended` (`onend` has run); `entered`, `left` (`state`); `fired`
(`machine`, `transition`, `source`, `destination`); `spawned`, `discarded` (`machine`); `changed` (`variable`,
`value`); `issue` (`code`, `element`, `line`, `message`); `patched` (`applied`, `restarted`, `reason`);
`restarted` (`reason`); `forced` (`state`, `how`); `commanded` (`command`, `arguments`, `sent`, and `block`
and `line` of its origin); `printed` (`text`). `changed` is also written where a list, dict or set was changed
in place, but not where an attribute of an object was. The same program, world and seed produce the same
trace, unless the program walks over a set of texts, which Python orders otherwise in every process:
`PYTHONHASHSEED=0 lrp run …` fixes that.

**Recordings**: `--record run.lrplog` writes the trace and the inputs of the run: program and world, every
save of the file, every key. `lrp replay run.lrplog` reproduces a simulated run bit for bit (of a program that
walks over a set of texts, if `PYTHONHASHSEED` is the same number for both), and `lrp why
run.lrplog NAME --at 12.3` says why a transition did not fire there. A name that ends with `.gz` compresses
the file.

**Animations**: `--animate run.svg` draws how the simulated world moved, at its end, as an SVG that browsers
play; of a longer run the last ten minutes, or 10,000 ticks if they are more.
"""


@app.command(cls=_NodeCommand, epilog=RUN_EPILOG)
def run(
    file: File,
    ros_arguments: RosArguments = None,
    bridge: Annotated[
        str | None,
        Option(
            autocompletion=complete.bridges,
            metavar="NAME|FILE",
            help="The robot: see `lrp bridges`, or a Python file with a bridge. Naming hardware arms it."
            " Default: the simulator.",
        ),
    ] = None,
    world: Annotated[
        str | None,
        Option(
            metavar="NAME|FILE",
            autocompletion=complete.worlds,
            help="The simulated world: see `lrp worlds`. Default: the one named in the text.",
        ),
    ] = None,
    rate: Annotated[float, Option(metavar="HZ", help="Ticks per second; 0 for as many as possible.")] = 10,
    seconds: Annotated[
        float | None, _time_option("--for", help="End the run after this time of its own clock.")
    ] = None,
    until: Annotated[
        str | None,
        Option(
            metavar="STATE", autocompletion=complete.states, help="End the run when this state is entered."
        ),
    ] = None,
    start: Annotated[
        str | None,
        Option(
            metavar="PATH",
            autocompletion=complete.states,
            help="Start only this machine, such as `follower/looking/lookalgo`, or one of its states."
            " The machines around it do not run.",
        ),
    ] = None,
    speed: Annotated[
        str,
        Option(
            metavar="X|max",
            autocompletion=complete.speeds,
            help="Factor of real time; `max` never waits (simulator only).",
        ),
    ] = "1",
    seed: Annotated[int | None, Option(help="Seed of the simulator's noise.")] = None,
    noise: Annotated[
        list[str] | None,
        Option(
            metavar="NAME=NUMBER",
            autocompletion=complete.noises,
            help="Imperfections: `motor=0.1`, `light=10`, `distance`, `gyro`, `odom`; may be repeated.",
        ),
    ] = None,
    assignments: Annotated[
        list[str] | None,
        Option(
            "--set",
            metavar="NAME=EXPR",
            autocompletion=complete.variables,
            help="Start with another value of a variable; may be repeated.",
        ),
    ] = None,
    trace: Annotated[
        str | None, Option(metavar="FILE|-", help="Write what happens as JSON Lines; `-` writes to stdout.")
    ] = None,
    breakpoints: Annotated[
        list[str] | None,
        Option(
            "--break",
            metavar="WHAT",
            autocompletion=complete.states,
            help="Pause when a STATE is entered or a TRANSITION fires; or `left STATE`, `event NAME`, "
            "`when EXPRESSION`; may be repeated.",
        ),
    ] = None,
    fires: Annotated[
        list[str] | None,
        Option(
            "--fire",
            metavar="TRANSITION@SECONDS",
            autocompletion=complete.transitions,
            help="Fire a transition by hand at a time of the run's own clock; may be repeated.",
        ),
    ] = None,
    record: Annotated[
        str | None, Option(metavar="FILE", help="Write a recording, for `lrp replay` and `lrp why`.")
    ] = None,
    animate: Annotated[
        str | None, Option(metavar="FILE", help="Draw the simulated run as a moving picture (SVG).")
    ] = None,
    watch: Annotated[
        bool, Option("--watch", help="Patch the running program at every save of the file.")
    ] = False,
    on_active_edit: Annotated[
        EditPolicy,
        Option(
            help="What a save does that changes an active state: `restart` the program, or `keep` it"
            " in that state, with the new actions."
        ),
    ] = EditPolicy.restart,
    on_issue: Annotated[
        OnIssue, Option(help="What to do whenever a fault of the program occurs.")
    ] = OnIssue.record,
    host: Annotated[str | None, Option(help="Address of the robot; short for `--option host=…`.")] = None,
    options: BridgeOptions = None,
) -> None:
    """Run a program and show what it does; with `--watch`, it can be changed meanwhile."""
    from lrp_jupyter.cli.run_command import run_file
    from lrp_jupyter.cli.run_options import parse_options

    wanted = parse_options(
        bridge=bridge,
        world=world,
        rate=rate,
        seconds=seconds,
        until=until,
        start=start,
        speed=speed,
        seed=seed,
        noise=noise or [],
        assignments=assignments or [],
        trace=trace,
        record=record,
        animate=animate,
        breakpoints=tuple(breakpoints or ()),
        fires=fires or [],
        watch=watch,
        on_active_edit=on_active_edit.value,
        on_issue=on_issue.value,
        answers=[*([f"host={host}"] if host else []), *(options or [])],
        ros_arguments=tuple(ros_arguments or ()),
    )
    raise typer.Exit(run_file(file, wanted))


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
    begin: Annotated[float, _time_option("--from", help="Print only what comes after this time.")] = 0,
    end: Annotated[float | None, _time_option("--until", help="End at this time of the run.")] = None,
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
    at: Annotated[float | None, _time_option(help="The time of the run. Default: its end.")] = None,
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


@command()
def check(
    files: Annotated[
        list[str],
        Argument(
            metavar="FILE…",
            help="Files, names of bundled programs, or `-` for stdin.",
            autocompletion=complete.sources,
        ),
    ],
    form: Annotated[
        Findings, Option("--format", help="Text for people or JSON for other programs.")
    ] = Findings.text,
    fix: Annotated[
        bool, Option("--fix", help="Apply every certain fix, write the files, and check again.")
    ] = False,
    bridge: Annotated[
        str | None,
        Option(
            metavar="NAME",
            autocompletion=complete.bridges,
            help="Check for this robot: see `lrp bridges`. Default: the simulated one.",
        ),
    ] = None,
    options: BridgeOptions = None,
) -> None:
    """Check programs without running them.

    No robot is connected: `--bridge ros -o setup=robot.json` checks against what the set-up names.

    **Exit code**: 0 when there are no errors (there may be warnings and hints), 1 when there are, 2 when a
    file cannot be read or written.
    """
    from lrp_jupyter.cli.offline import check_files

    raise typer.Exit(check_files(files, form is Findings.json, fix, bridge, options or ()))


@command("format")
def format_(
    files: Annotated[
        list[str],
        Argument(
            metavar="FILE…",
            help="Files, or `-` to format stdin and print the result.",
            autocompletion=complete.sources,
        ),
    ],
    check: Annotated[
        bool, Option("--check", help="Write nothing; only list the files that would change.")
    ] = False,
) -> None:
    """Format the texts of programs: only white space changes.

    **Exit code**: 0, 1 when a text is not a valid program or, with `--check`, would change, 2 when a file
    cannot be read or written.
    """
    from lrp_jupyter.cli.offline import format_files

    raise typer.Exit(format_files(files, check))


@command()
def graph(
    file: File,
    machine: Annotated[
        str | None,
        Option(
            metavar="PATH",
            autocompletion=complete.machines,
            help="Draw one machine only: `follower/looking/lookalgo`.",
        ),
    ] = None,
    form: Annotated[
        Drawing | None, Option("--format", help="Default: by the output file's suffix, else `svg`.")
    ] = None,
    output: Annotated[
        Path | None, Option("--output", "-o", metavar="FILE", help="File to write. Default: stdout.")
    ] = None,
) -> None:
    """Draw the state machines of a program.

    **Exit code**: 0, 1 when the text is not a valid program, 2 when a file cannot be read or written.
    """
    from lrp_jupyter.cli.offline import draw_graph

    raise typer.Exit(draw_graph(file, machine, form.value if form else None, output))


Challenge = Annotated[
    str | None,
    Option(
        metavar="NAME",
        autocompletion=complete.challenges,
        help="A challenge, or a Python file that registers one; default: that of the program's heading.",
    ),
]
Limit = Annotated[
    float, Option(metavar="SECONDS", min=0.1, max=1e6, help="Wall-clock seconds that one run may take.")
]
Memory = Annotated[
    float, Option(metavar="MEGABYTES", min=1, max=1e7, help="Memory that one run may need (on Linux).")
]
Processes = Annotated[
    int | None,
    Option("--jobs", metavar="N", min=1, max=1000, help="Runs at the same time; default: one per processor."),
]
Scheduler = Annotated[
    str | None,
    Option(
        metavar="ADDRESS",
        help="Make the runs on a Dask cluster, such as `tcp://10.0.0.5:8786`; `local`: one on this machine.",
    ),
]

GRADE_EPILOG = """
**A class**: `lrp grade FOLDER --challenge square --seeds 20 --out marks.csv` grades every entry of a folder
or `.zip` file: files `.lrp`, `.ipynb` and `.txt`, and a folder or `.zip` for each student (as Moodle,
Canvas and nbgrader lay them out). What cannot be read has a row that says why. Of a notebook, the last
`%%lrp` cell with `--challenge square` counts, or the only `%%lrp` cell. A program that hangs, crashes or
cannot be read costs only its own mark, and is not run again. The worlds that a challenge hides from students
count here. The column `code` is the hand-in code that the lab of an exam shows. The marks are the same in
every grading: a set of texts has the order of `PYTHONHASHSEED=0`.

**Links**: a text file with a link of the site in each line, each after the name of its student, is a class,
too. The program is in the link: nothing is loaded from it.

**Several challenges**: without `--challenge`, each program is graded in the one that its cell or its
heading names (`; challenge: square`), and the table has a column for each.

**Files**: `--out marks.csv` is for a spreadsheet and has a row for each submission; `.json` has every run
with its criteria, hints and path; `.xml` is JUnit's format, with a test for each run; `.html` is a page for
you, with what fails, who is stuck, and whose programs are alike. `--out` can be repeated. `--table` has a
row for each student and a column for each challenge. `--feedback` makes a page for each student.
`--gradebook` fills in a copy of Moodle's grading worksheet or of Canvas's gradebook.

**Changes**: with `--repair`, the notes say of each program that does not pass which small change of it would,
as `lrp repair` finds it, within half a minute of computing for each. The pages for students do not show it.

**Exit code**: 0 when every run of the one file met every criterion, or when all submissions of a class were
graded, whatever their marks are; 1 when the one file does not pass; 2 when a file or challenge does not exist
or a file cannot be written; 3 for a fault of this package; 130 after Ctrl-C.
"""


@command(epilog=GRADE_EPILOG)
def grade(
    files: Annotated[
        list[str] | None,
        Argument(
            metavar="FILE|FOLDER...",
            help="A file, the name of a bundled program, or `-` for stdin; several, or a folder of a class.",
            autocompletion=complete.sources,
        ),
    ] = None,
    challenge: Challenge = None,
    seeds: Annotated[
        int | None,
        _seeds_option(
            help="Number of runs in each world, each with different noise; default: the challenge's."
        ),
    ] = None,
    out: Annotated[
        list[Path] | None,
        Option(metavar="FILE", help="Write the marks as `.csv`, `.json`, `.xml` or `.html`."),
    ] = None,
    table: Annotated[
        Path | None,
        Option(
            metavar="FILE", help="Write a `.csv` with a row for each student, a column for each challenge."
        ),
    ] = None,
    feedback: Annotated[
        Path | None, Option(metavar="FOLDER", help="Write a page for each student into a folder.")
    ] = None,
    gradebook: Annotated[
        Path | None,
        Option(
            metavar="FILE",
            help="Moodle's grading worksheet or Canvas's gradebook; a copy, `…-marked.csv`, is filled in.",
        ),
    ] = None,
    column: Annotated[
        str | None, Option(metavar="NAME", help="The column of the gradebook for the points.")
    ] = None,
    separator: Annotated[
        str,
        Option(
            metavar="CHARACTER",
            help="Between the cells of `.csv`; with `;`, numbers have a decimal comma.",
        ),
    ] = ",",
    given: Annotated[
        Path | None,
        Option(
            metavar="FILE",
            help="What was given out: marks say who has changed nothing; default: the challenge's beginning.",
        ),
    ] = None,
    sandbox: Annotated[
        bool,
        Option(
            "--sandbox", help="Run programs without files and network (Linux, with bubblewrap installed)."
        ),
    ] = False,
    repair: Annotated[
        bool,
        Option("--repair", help="Note how far off each program is: the smallest change that would pass."),
    ] = False,
    limit: Limit = 60,
    memory: Memory = 1000,
    jobs: Processes = None,
    scheduler: Scheduler = None,
) -> None:
    """Grade programs in a challenge, or in those that they name; without arguments, list the challenges."""
    from lrp_jupyter.cli.program_source import challenge_in, may_hold_several

    if challenge is None and files and len(files) == 1:
        challenge = challenge_in(files[0])
    if not files or (challenge is None and len(files) == 1 and not may_hold_several(files[0])):
        from lrp_jupyter.cli.lists import list_challenges

        if files:
            typer.echo("lrp: No challenge was named. Choose one with `--challenge NAME`.\n", err=True)
        elif challenge is not None:
            typer.echo("lrp: No file was named. Write `lrp grade FILE --challenge NAME`.\n", err=True)
        list_challenges()
        raise typer.Exit(2 if files or challenge is not None else 0)
    if len(separator) != 1 or separator not in ",;\t|":
        raise typer.BadParameter("--separator takes one character: `,` or `;`, or a tab.")
    from lrp_jupyter.cli.batches import MarksFiles, grade_files
    from lrp_jupyter.grading.workers import HowRun

    how = HowRun(limit, memory, jobs, scheduler, sandbox=sandbox)
    where = MarksFiles(out or [], table, feedback, gradebook, column, separator)
    raise typer.Exit(grade_files(files, challenge, seeds, where, how, given, repair))


SWEEP_EPILOG = """
**Values**: `--set search=0.4:1.2:9` sets the variable `search` to nine values from 0.4 to 1.2, and `--set
forward=0.1,0.2,0.3` to these three. Several `--set` give all combinations. A variable of a machine is named
by its path, as in `follower/looking/lookalgo/time`, unless no other one has its name.

**Result**: for each combination how many of all runs passed, the points, and the median and the longest time
until a run was done. *Fastest* is the shortest median among the values with which the most runs pass; *most
robust* is the middle of the longest row of neighbours with which the most runs pass.

**Files**: `--out` writes the table as `.csv` or, with all runs, as `.json`. `--map` draws one variable as
values by runs, coloured by time, and two as the share of the runs that passed.

**Exit code**: 0 when the sweep is complete, 1 when the text is not a valid program, 2 when an argument is
wrong or a file cannot be read or written, 3 for a fault of this package, 130 after Ctrl-C.
"""


@command(epilog=SWEEP_EPILOG)
def sweep(
    file: File,
    assignments: Annotated[
        list[str],
        Option(
            "--set",
            metavar="NAME=VALUES",
            autocompletion=complete.variables,
            help="Initial values of a variable: `FROM:TO:COUNT` or `A,B,…`; can be repeated.",
        ),
    ],
    challenge: Challenge = None,
    seeds: Annotated[
        int, _seeds_option(help="Number of runs in each world, each with different noise.")
    ] = 30,
    out: Annotated[
        list[Path] | None, Option(metavar="FILE", help="Write the result as `.csv` or `.json`.")
    ] = None,
    map_: Annotated[Path | None, Option("--map", metavar="FILE", help="Draw a heat map as `.svg`.")] = None,
    limit: Limit = 60,
    memory: Memory = 1000,
    jobs: Processes = None,
    scheduler: Scheduler = None,
) -> None:
    """Grade a program with other initial values of its variables, to find fast and robust ones."""
    from lrp_jupyter.cli.program_source import challenge_in

    challenge = challenge or challenge_in(file)
    if challenge is None:
        raise LRPError("No challenge was named. Choose one with `--challenge NAME`; `lrp grade` lists them.")
    from lrp_jupyter.cli.batches import sweep_file
    from lrp_jupyter.grading.workers import HowRun

    how = HowRun(limit, memory, jobs, scheduler)
    raise typer.Exit(sweep_file(file, challenge, assignments, seeds, out or [], map_, how))


REPAIR_EPILOG = """
**What is tried**: other numbers, by factors and on either side of what they were compared with in a run that
failed; another order of two transitions; other sources of a transition; an action in `running`, `onentry` or
`onexit`; the other comparison; a part of a condition or a transition left out; and what `lrp check` proposes.
One place is changed at a time. What passes the failed run is tried in all runs; the change with which most of
them pass comes first, and of several the smallest.

**Exit code**: 0 when a change was found, or none is needed; 1 when none was found, or the text is not a valid
program; 2 when an argument is wrong or a file cannot be read or written; 3 for a fault of this package; 130
after Ctrl-C.
"""


@command(epilog=REPAIR_EPILOG)
def repair(
    file: File,
    challenge: Challenge = None,
    runs: Annotated[
        list[str] | None,
        Option(metavar="RUNS", help="A recording, or a folder of them, that the program has to pass, too."),
    ] = None,
    seeds: Annotated[
        int, _seeds_option(help="Number of runs in each world, in which a change has to prove itself.")
    ] = 10,
    budget: Annotated[
        float, Option(metavar="SECONDS", min=1, max=1e6, help="Seconds of computing for the search.")
    ] = 60,
    write: Annotated[
        Path | None, Option(metavar="FILE", help="Write the program with the first change, as `.lrp`.")
    ] = None,
    limit: Limit = 20,
    memory: Memory = 1000,
    jobs: Processes = None,
    scheduler: Scheduler = None,
) -> None:
    """Find the smallest change with which a program passes a challenge, or its kept runs, or both.

    Without a challenge, and without `--runs`, the folder `NAME.runs` beside the program has the runs, as for
    `lrp test`. The file stays as it is.
    """
    from lrp_jupyter.cli.program_source import challenge_in

    challenge = challenge or challenge_in(file)
    from lrp_jupyter.cli.repair_command import repair_file
    from lrp_jupyter.grading.workers import HowRun

    how = HowRun(limit, memory, jobs, scheduler)
    raise typer.Exit(repair_file(file, challenge, runs or [], seeds, budget, write, how))


@command()
def programs(
    show: Annotated[
        str | None,
        Option(metavar="NAME", autocompletion=complete.bundled, help="Print the text of a program."),
    ] = None,
) -> None:
    """List the bundled programs."""
    from lrp_jupyter.cli.lists import list_programs

    list_programs(show)


@command()
def worlds(
    show: Annotated[
        str | None,
        Option(metavar="NAME|FILE", autocompletion=complete.worlds, help="Draw the map of a world."),
    ] = None,
    as_json: Annotated[
        str | None,
        Option(
            "--json",
            metavar="NAME|FILE",
            autocompletion=complete.worlds,
            help="Print a world as JSON, as a start for your own.",
        ),
    ] = None,
) -> None:
    """List the bundled worlds of the simulator."""
    from lrp_jupyter.cli.lists import list_worlds

    list_worlds(show or as_json, as_json is not None)


@command()
def bridges(
    name: Annotated[
        str | None,
        Argument(
            metavar="NAME|FILE.py", autocompletion=complete.bridges, help="List the options of this one."
        ),
    ] = None,
) -> None:
    """List the available robots, or the options of one."""
    from lrp_jupyter.cli.lists import list_bridges, list_options

    if name is None:
        list_bridges()
    else:
        list_options(name)


GUARD_EPILOG = """
Run it on the robot, or beside it: it works when the computer with the program sleeps or dies, and when the
network between the two is cut. It says on stdout when it stops the robot, and goes on.

**ROS**: `lrp guard --topic /cmd_vel` subscribes to the topic, and publishes a velocity of zero on it. A robot
whose driver stops by itself when commands cease needs none.

**Goals** go on without commands. `lrp guard --action /move_base --alive /lrp/alive` cancels them when the
program has published on that topic, and does no more. Its set-up has it do so in every tick:
`"publishers": {"alive": {"topic": "/lrp/alive", "type": "std_msgs/Empty"}}, "tick": {"alive": {}}`.

**MQTT**: `lrp guard --backend mqtt --topic robot/cmd_vel`. Commands are JSON, such as `{"linear": 0.2}`; the
zero has the form of the last one.

**Exit code**: 130 after Ctrl-C; 2 when an argument is wrong, or the robot or the broker cannot be reached at
the beginning. Later it waits for them.
"""


@app.command(cls=_NodeCommand, epilog=GUARD_EPILOG)
def guard(
    backend: Annotated[
        str,
        Option(
            autocompletion=complete.backends,
            help="A back end of ROS, such as `rosbridge`, or `mqtt`. Default: that of ROS which is set up "
            "or answers.",
        ),
    ] = "auto",
    host: Annotated[
        str | None,
        Option(
            metavar="HOST[:PORT]",
            help="Of the rosbridge server, the ROS master or the broker. Default: this machine.",
        ),
    ] = None,
    topic: Annotated[
        str | None, Option(help="Of the velocities. Default: `cmd_vel`, or `robot/cmd_vel` for MQTT.")
    ] = None,
    type_: Annotated[
        str, Option("--type", metavar="TYPE", help="Of its messages. Default: that of the live topic.")
    ] = "",
    after: Annotated[
        float,
        Option(
            metavar="SECONDS",
            min=0.1,
            max=3600,
            help="How long the last command holds: more than a tick of the program.",
        ),
    ] = 0.5,
    action: Annotated[
        list[str] | None, Option(metavar="NAME", help="Cancel the goals of this action; may be repeated.")
    ] = None,
    alive: Annotated[
        str,
        Option(
            metavar="TOPIC", help="With --action: where the program publishes in every tick that it is there."
        ),
    ] = "",
    ros_arguments: RosArguments = None,
) -> None:
    """Stop a robot, on its own side, when its program sends no more commands."""
    from lrp_jupyter.cli.guard_command import guard_robot

    raise typer.Exit(
        guard_robot(backend, host, topic, type_, after, alive, action or (), ros_arguments or ())
    )


@command()
def explain(
    code: Annotated[
        str | None, Argument(metavar="CODE", help="`LRP301`, or another code.", autocompletion=complete.codes)
    ] = None,
) -> None:
    """Explain the code of a finding, an issue, a reason, a notice or an exit; without CODE, list them.

    **Exit code**: 0, or 2 when there is no such code.
    """
    from lrp_jupyter.cli.lists import explain_code

    explain_code(code)


@command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def lab(
    ctx: typer.Context,
    folder: Annotated[
        Path, Option("--dir", metavar="FOLDER", help="Folder to copy the notebooks to.")
    ] = Path("lrp-notebooks"),
    browser: Annotated[bool, Option(help="Open a browser.")] = True,
) -> None:
    """Open JupyterLab on a copy of the notebooks, at the first one.

    Existing copies are never overwritten. Further options are passed to JupyterLab.
    """
    from lrp_jupyter.cli.lab_command import open_lab

    open_lab(folder.resolve(), browser, ctx.args)


@command()
def sheets(
    folder: Annotated[Path, Argument(metavar="DIR", help="Folder of the sheets; it is created.")],
    notebooks: Annotated[
        Path | None, Option(metavar="DIR", help="Notebooks of your own instead of those of the package.")
    ] = None,
    pdf: Annotated[
        bool, Option("--pdf", help="Print them to PDF, too, with Chromium or Chrome if one is installed.")
    ] = False,
) -> None:
    """Write a worksheet for each lesson, and cards for a lesson without computers, as pages to be printed.

    Each page needs no other file and no network: open it in a browser, and print it.
    """
    from lrp_jupyter.cli.lab_command import shipped_notebooks
    from lrp_jupyter.site.sheets import write_sheets

    written = write_sheets(notebooks or shipped_notebooks(), folder, pdf)
    typer.echo(f"{len(written)} sheets are in {folder}: {written[0].name} … {written[-1].name}")


@command()
def site(
    folder: Annotated[Path, Argument(metavar="DIR", help="Folder of the site; it is created.")],
    notebooks: Annotated[
        Path | None, Option(metavar="DIR", help="Notebooks of your own instead of those of the package.")
    ] = None,
    offline: Annotated[
        bool, Option("--offline", help="Include Python itself, so that no other address is needed.")
    ] = False,
    pyodide: Annotated[
        Path | None, Option(metavar="DIR", help="A folder with Pyodide, so that it need not be downloaded.")
    ] = None,
) -> None:
    """Build a web site of the lab and the notebooks that runs in the browser, without a server of its own.

    Any host of static pages can publish it; `python -m http.server --directory DIR` shows it here.
    """
    from tempfile import TemporaryDirectory

    from lrp_jupyter.cli.lab_command import copy_notebooks
    from lrp_jupyter.site.build import build_site

    with TemporaryDirectory(prefix="lrp-notebooks-") as own:
        if notebooks is None:
            copy_notebooks(Path(own))
        build_site(folder, notebooks or Path(own), offline=offline, pyodide=pyodide, say=typer.echo)
    typer.echo(
        f"The site is in {folder}. Try it: python -m http.server --bind 127.0.0.1 --directory {folder}"
    )

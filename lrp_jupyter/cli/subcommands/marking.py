"""The commands about challenges: ``grade``, ``sweep`` and ``repair``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from lrp_jupyter.cli import complete
from lrp_jupyter.cli.subcommands.application import File, command, seeds_option
from lrp_jupyter.errors import LRPError

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
        seeds_option(
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
    seeds: Annotated[int, seeds_option(help="Number of runs in each world, each with different noise.")] = 30,
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
        int, seeds_option(help="Number of runs in each world, in which a change has to prove itself.")
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
    """Find the smallest change that makes a program pass a challenge, its kept runs, or both.

    Without a challenge, and without `--runs`, the folder `NAME.runs` beside the program has the runs, as for
    `lrp test`. The file stays as it is.
    """
    from lrp_jupyter.cli.program_source import challenge_in
    from lrp_jupyter.cli.repair_command import repair_file
    from lrp_jupyter.grading.workers import HowRun

    how, name = HowRun(limit, memory, jobs, scheduler), challenge or challenge_in(file)
    raise typer.Exit(repair_file(file, name, runs or [], seeds, budget, write, how))

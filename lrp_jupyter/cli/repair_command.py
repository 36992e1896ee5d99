"""``lrp repair``: the smallest change that makes a program pass a challenge."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from lrp_jupyter.cli.console import plain_console
from lrp_jupyter.cli.excerpt import print_findings
from lrp_jupyter.cli.program_source import read_source
from lrp_jupyter.cli.run_options import check_outputs
from lrp_jupyter.errors import LRPSyntaxError
from lrp_jupyter.files import write_file
from lrp_jupyter.grading.challenges import load
from lrp_jupyter.grading.progress import shown_progress
from lrp_jupyter.grading.workers import Halt, HowRun
from lrp_jupyter.live.stored.run_files import runs_folder
from lrp_jupyter.repairs.repair import repaired
from lrp_jupyter.runs.kept_runs import kept_runs


def repair_file(
    file: str,
    name: str | None,
    runs: Sequence[str],
    seeds: int,
    budget: float,
    write: Path | None,
    how: HowRun,
) -> int:
    """Search, and print the answer; return 0 if a change was found, 1 if none.

    Without a challenge and named runs, those beside the program judge.
    """
    beside = runs_folder(file)
    kept = kept_runs([beside] if beside.is_dir() and name is None and not runs else runs)
    task = None if name is None else load(name).whole()
    check_outputs([write] if write else [], (".lrp", ".txt"))
    source = read_source(file)
    halt = Halt()
    try:
        with shown_progress("trying", lines=True) as progress:
            found = repaired(source.text, task, seeds, how, budget, progress, halt, kept)
    except LRPSyntaxError as error:
        print_findings(source.name, source.text, error.findings)
        return 1
    plain_console().print(str(found))
    if write is not None and found:
        write_file(write, found.repairs[0].text)
        plain_console().print(f"written: {write}")
    return 0 if found or found.passed == found.runs else 1

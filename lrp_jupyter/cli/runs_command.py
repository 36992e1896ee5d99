"""``lrp test``: run the kept runs of a program again, and print what came of each."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from rich.text import Text

from lrp_jupyter.cli.console import plain_console
from lrp_jupyter.cli.excerpt import print_findings
from lrp_jupyter.cli.program_source import read_source
from lrp_jupyter.cli.run_options import check_outputs
from lrp_jupyter.errors import FileError, printable
from lrp_jupyter.files import shown, write_file
from lrp_jupyter.grading.workers import HowRun
from lrp_jupyter.language.parser import scan
from lrp_jupyter.live.stored.run_files import runs_folder
from lrp_jupyter.runs.decide import Decisions, decide, line_of
from lrp_jupyter.runs.kept_runs import KeptRun, kept_runs
from lrp_jupyter.runs.outcome import RunOutcome


def decide_runs(
    name: str, runs: Sequence[str], how: HowRun, coverage: bool, junit: Path | None, trusted: bool
) -> int:
    """Run the runs of a program again, and print what came of each; return the exit code."""
    if junit is not None:
        check_outputs([junit], (".xml",))
    source = read_source(name)
    program, findings = scan(source.text, source.name)
    if program is None:
        print_findings(source.name, source.text, findings)
        return 1
    places: Sequence[str | Path] = runs or [_beside(name)]
    wanted = kept_runs(places)
    if not wanted:
        raise FileError(f"There is no recording in {', '.join(f'`{shown(each)}`' for each in places)}.")
    console, made, waiting = plain_console(), dict[KeptRun, RunOutcome](), deque(wanted)

    def told(run: KeptRun, outcome: RunOutcome) -> None:
        made[run] = outcome
        while waiting and waiting[0] in made:
            first = waiting.popleft()
            console.print(Text(line_of(first, made[first])))

    decisions = decide(program, wanted, how, trusted=trusted, told=told)
    good = sum(outcome.passed for outcome in decisions.outcomes.values())
    console.print(f"{good} of {len(wanted)} {'run' if len(wanted) == 1 else 'runs'} passed.")
    if coverage:
        console.print(Text(str(decisions.coverage)))
    if junit is not None:
        write_file(junit, _junit(source.name, decisions))
    return 0 if decisions else 1


def _beside(name: str) -> Path:
    if name == "-":
        raise FileError("No runs are kept beside the standard input. Name a folder of runs, or recordings.")
    folder = runs_folder(name)
    if not folder.is_dir():
        raise FileError(
            f"No runs are kept beside the program: there is no folder `{shown(folder)}`. Keep some in the lab"
            f", record one with `lrp run {name} --record {folder.name}/NAME.lrplog`, or name a folder."
        )
    return folder


def _junit(name: str, decisions: Decisions) -> str:
    """Return what CI services read: a suite of tests, in XML, which holds no control characters."""
    made = decisions.outcomes
    failed = sum(not outcome.passed for outcome in made.values())
    suite = ElementTree.Element("testsuite", name=name, tests=str(len(made)), failures=str(failed))
    for run, outcome in made.items():
        about = {"name": printable(run.name), "classname": name, "time": f"{outcome.seconds:g}"}
        case = ElementTree.SubElement(suite, "testcase", about)
        if not outcome.passed:
            failure = ElementTree.SubElement(case, "failure", message=printable(outcome.reason, "\n"))
            found = "\n".join(f"{each.part}: {each.reason}" for each in outcome.found)
            failure.text = printable(found, "\n")
    ElementTree.indent(suite)
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"

"""Static checks: errors and suspicious places of a program, found without running it.

Paper: §9 ("We plan to statically detect more kinds of errors").
"""

from __future__ import annotations

from collections.abc import Collection
from operator import attrgetter

from lrp_jupyter.arguments import check_type
from lrp_jupyter.codes import FINDINGS as CODES
from lrp_jupyter.codes import Code
from lrp_jupyter.errors import MOST_FINDINGS, listed
from lrp_jupyter.language.checks.acting import check_acting
from lrp_jupyter.language.checks.clocks import check_clocks
from lrp_jupyter.language.checks.computed_uses import check_computed
from lrp_jupyter.language.checks.defined_names import check_names
from lrp_jupyter.language.checks.delays import TICK, check_delays
from lrp_jupyter.language.checks.number_uses import check_number_uses
from lrp_jupyter.language.checks.outcomes import check_tasks
from lrp_jupyter.language.checks.python_in_blocks import check_python
from lrp_jupyter.language.checks.quantities import check_quantities
from lrp_jupyter.language.checks.reachability import check_reachability
from lrp_jupyter.language.checks.references import check_references
from lrp_jupyter.language.checks.replaced_commands import check_commands
from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.checks.restarts import check_restarts
from lrp_jupyter.language.checks.unseen import check_unseen
from lrp_jupyter.language.checks.waiting import check_waiting
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Finding, Program
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.robot_members import RobotMembers

__all__ = ["CODES", "Code", "check"]


def check(
    text_or_program: str | Program,
    names: Collection[str] = (),
    robot: RobotMembers | None = None,
    tick: float = TICK,
) -> tuple[Finding, ...]:
    """Return the findings about a program, without running it.

    `text_or_program`: a text that is not a valid program has only the parser's findings.
    `names`: names in the session's namespace, such as a notebook's functions and imports.
    `robot`: the members of the robot that the program is for, if they are known.
    `tick`: the milliseconds of a tick, of which a delay should not be shorter.
    In order of position, the first 200 and the number of the others; :data:`CODES` explains their codes. An
        error certainly cannot work; a correct program has no findings.
    """
    check_type("text_or_program", text_or_program, (str, Program), "a text or a Program")
    if isinstance(text_or_program, Program):
        program = text_or_program
    else:
        scanned, found = scan(text_or_program)
        if scanned is None:
            return found
        program = scanned
    report = Reporter(program, names)
    resolution = resolve(program)
    check_names(report, resolution)
    check_reachability(report, resolution, check_references(report, resolution))
    check_python(report, resolution, robot)
    check_quantities(report, resolution, robot)
    check_number_uses(report, resolution, robot)
    check_delays(report, resolution, tick)
    check_computed(report, resolution)
    check_waiting(report, resolution)
    check_clocks(report, resolution)
    check_acting(report, resolution)
    check_commands(report, resolution, robot)
    check_restarts(report, resolution)
    check_tasks(report, resolution, robot)
    check_unseen(report, resolution)
    first = sorted(report.findings, key=lambda finding: finding.severity != "error")[:MOST_FINDINGS]
    place = attrgetter("line", "column", "end_line", "end_column", "code")
    return listed(sorted(first, key=place), len(report.findings))

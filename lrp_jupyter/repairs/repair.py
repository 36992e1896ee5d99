"""Repair a program: find the smallest changes that make it pass a challenge, each proved in real runs.

``repair(program, "there and back")`` tries numbers, orders, sources, moments and comparisons, and returns
those that help. It never changes the program.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from types import NoneType
from typing import Any

from lrp_jupyter.arguments import check_number, check_type
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import Finding, LRPError
from lrp_jupyter.grading.attempt import Job
from lrp_jupyter.grading.challenges import Challenge, challenge
from lrp_jupyter.grading.grade import jobs_of, namespace_of, text_of
from lrp_jupyter.grading.progress import shown_progress
from lrp_jupyter.grading.workers import Halt, HowRun
from lrp_jupyter.live.running.checking import check
from lrp_jupyter.repairs.answer import Repairs
from lrp_jupyter.repairs.judging import Judge
from lrp_jupyter.repairs.search import Progress, Search
from lrp_jupyter.runs.decide import rerun_of
from lrp_jupyter.runs.kept_runs import KeptRun, Where, kept_runs
from lrp_jupyter.runs.rerun import Rerun


def repair(
    program: Any,
    what: str | Challenge | None = None,
    seeds: int = 10,
    *,
    runs: Where = (),
    limit: float = 60,
    namespace: dict[str, Any] | None = None,
    progress: Callable[[int, int], object] | None = None,
    halt: Halt | None = None,
) -> Repairs:
    """Find the smallest changes that make a program pass a challenge, or its kept runs, or both.

    The program stays as it is.

    Parameters
    ----------
    program : str, Program, Session or Lab
    what : str or Challenge, optional
        A challenge or its name.
    seeds : int
        Number of runs in each world, in which a change has to prove itself.
    runs : path, or iterable of paths or KeptRun
        A folder of recordings, or several folders, files or runs.
    limit : float
        Seconds of computing; then the answer is what was found until then.
    namespace : dict, optional
        Names available to the blocks; default: those of the session or lab, if one is given.
    progress : callable, optional
        Called with the number of runs that were made, and of those that are planned so far; by default a bar
        on a terminal or in a notebook.
    halt : Halt, optional
        Set from another thread, it ends the search.

    Returns
    -------
    Repairs

    Raises
    ------
    LRPSyntaxError
        The text is not a valid program.
    FileError
        There is no such folder or file.
    LRPError
        There is no such challenge; or neither a challenge nor a run is given.

    Examples
    --------
    >>> text = "(machine m (state a (onentry [robot.move(linear=0.2)]))) (spawn m a)"
    >>> print(repair(text, "robot 5", seeds=1).repairs[0].phrase)
    `[robot.move(linear=0.2)]` in `running` instead of `onentry` of `a` (line 1)
    """
    check_type("what", what, (str, Challenge, NoneType), "the name of a challenge or a Challenge")
    check_number("limit", limit, "a number of seconds", above=0)
    task = challenge(what) if isinstance(what, str) else what
    names = namespace_of(program) if namespace is None else namespace
    how = HowRun(min(20.0, limit), namespace=names)
    kept, text = kept_runs(runs), text_of(program)
    with shown_progress("repair") if progress is None else nullcontext(progress) as told:
        return repaired(text, task, seeds, how, limit, told, halt, kept)


def repaired(
    text: str,
    task: Challenge | None,
    seeds: int,
    how: HowRun,
    limit: float,
    progress: Progress = lambda done, of: None,
    halt: Halt | None = None,
    kept: Sequence[KeptRun] = (),
) -> Repairs:
    """Find the smallest changes of a text; see :func:`repair`."""
    halt, names = halt or Halt(), how.namespace or {}
    findings: Sequence[Finding] = ()
    jobs: list[Job | Rerun] = []
    if task is not None:
        seeded, of_challenge = jobs_of(text, task, seeds, how)
        findings = check(text, names, SimBridge(seeded.runs[0][0]))
        jobs += of_challenge
    jobs += [rerun_of(text, run, how, names) for run in kept]
    if not jobs:
        raise LRPError("There is nothing to judge the program by. Name a challenge or kept runs.")
    return Search(text, Judge(jobs, how, halt), findings, limit, progress, halt).run()

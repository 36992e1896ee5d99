"""What a page can do with the challenge: check, show a run, give a hint, start over."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from lrp_jupyter.errors import LRPError
from lrp_jupyter.widgets.acts.messages import OpenProgram, act
from lrp_jupyter.widgets.acts.program_acts import Applied
from lrp_jupyter.widgets.views.goal import Goal
from lrp_jupyter.widgets.wire.codec import Between


def _goal(opened: OpenProgram) -> Goal:
    if opened.goal is None:
        raise LRPError("This program is not written for a challenge.")
    return opened.goal


@act()
def check(opened: OpenProgram) -> None:
    """Run the text in every world of the challenge, with every seed, alongside the running program."""
    opened.saver.save(at_once=True)  # where there are no processes, a check may not return
    _goal(opened).check(opened.session, opened.texts.text)


@act()
def hint(opened: OpenProgram) -> None:
    """Show one more hint about the result of the check."""
    _goal(opened).hint()


@act(30.0)
def show_attempt(opened: OpenProgram, index: Annotated[int, Between(0, 100_000)]) -> Applied:
    """Repeat a run of the check in the lab, and look at the moment at which it failed."""
    return opened.work(partial(_goal(opened).show, opened.session, opened.looking, index))


@act(30.0, is_present=True)
def keep_attempt(opened: OpenProgram, index: Annotated[int, Between(0, 100_000)]) -> Applied:
    """Repeat a run of the check in the lab, and keep it as an example, which has to meet the challenge."""
    return opened.work(partial(_goal(opened).keep, opened.session, opened.runs, index))


@act(is_present=True)
def start_over(opened: OpenProgram, world: Annotated[int, Between(-1, 1_000)] = -1) -> Applied:
    """Put the robot back to the start of a world of the challenge (-1: the present one), and run."""
    return opened.work(partial(_goal(opened).start_over, opened.session, None if world < 0 else world))

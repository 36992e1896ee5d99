"""The commands of a page about the challenge: check, show a run, give a hint, start over."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated, ClassVar

from lrp_jupyter.errors import LRPError
from lrp_jupyter.widgets.commands import Applied
from lrp_jupyter.widgets.goal import Goal
from lrp_jupyter.widgets.messages import Between, OpenProgram, PageCommand


def _goal(opened: OpenProgram) -> Goal:
    if opened.goal is None:
        raise LRPError("This program is not written for a challenge.")
    return opened.goal


@dataclass(frozen=True)
class CheckCommand(PageCommand, do="check"):
    """Run the text in every world of the challenge, with every seed, beside the program that runs."""

    def apply(self, opened: OpenProgram) -> Applied:
        """See the base class."""
        opened.saver.save(at_once=True)  # where there are no processes, a check may not return
        _goal(opened).check(opened.session, opened.texts.text)
        return None


@dataclass(frozen=True)
class HintCommand(PageCommand, do="hint"):
    """Show one more hint about what the check has found."""

    def apply(self, opened: OpenProgram) -> Applied:
        """See the base class."""
        _goal(opened).hint()
        return None


@dataclass(frozen=True)
class ShowAttemptCommand(PageCommand, do="show_attempt"):
    """Repeat a run of the check in the lab, and look at the moment at which it failed."""

    index: Annotated[int, Between(0, 100_000)]
    patience: ClassVar[float] = 30.0

    def apply(self, opened: OpenProgram) -> Applied:
        """See the base class."""
        goal = _goal(opened)
        return opened.work(partial(goal.show, opened.session, opened.looking, self.index))


@dataclass(frozen=True)
class StartOverCommand(PageCommand, do="start_over"):
    """Put the robot back to the start of a world of the challenge (-1: the present one), and run."""

    world: Annotated[int, Between(-1, 1_000)] = -1
    is_present: ClassVar[bool] = True

    def apply(self, opened: OpenProgram) -> Applied:
        """See the base class."""
        return opened.work(
            partial(_goal(opened).start_over, opened.session, None if self.world < 0 else self.world)
        )

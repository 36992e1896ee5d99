"""Answers to questions about a session: *why* and *why not*."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.lookup import find_first, places_called
from lrp_jupyter.language.program import Element, Path, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.reason import Reason
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.robot_commands import command_reason, commands_of
from lrp_jupyter.live.why.states import state_reason
from lrp_jupyter.live.why.transitions import transition_reason
from lrp_jupyter.live.why.wording import time_text

Question = Literal["why", "why_not", "explain"]

_ROBOT = "robot."
_KINDS: dict[Question, tuple[str, ...]] = {
    "why": ("state", "command"),
    "why_not": ("transition",),
    "explain": ("transition", "state", "command"),
}
"""What a question can be about; the first kind that has an element of the name is meant."""
_INSTEAD = {
    "transition": "Ask `why_not` about it.",
    "state": "Ask `why` about it.",
    "event": "Ask about a transition that waits for it.",
}
"""What to do if a name belongs to another kind of element."""


def element_reason(run: RecordedRun, question: Question, wanted: str | Path, at: int | None) -> Reason:
    """Return the answer to a question about an element, or a command of the robot, in a tick; None: the last.

    Raises UnknownElementError: there is no such element, or there are several.
    Raises ValueError: the tick is not recorded.
    """
    kinds, text, interpreter = _KINDS[question], path_text(as_path(wanted)), run.loop.interpreter
    commands = [_ROBOT + name for name in commands_of(run.loop.bridge)]
    if question == "why_not" and text in commands:
        raise UnknownElementError(f"`{text}` is a command, not a transition. Ask `why` about it.")
    tick = run.tick(at)
    if "state" in kinds and text.startswith(_ROBOT):
        return command_reason(run, text.removeprefix(_ROBOT), tick, now=at is None)
    programs = run.program(tick), interpreter.program
    element, program = find_first(programs, kinds, wanted, _INSTEAD, commands if "state" in kinds else ())
    then = element
    if program is not run.program(tick):
        then = Element(element.kind, run.names(tick).of(element.kind, element.path, math.inf))
    run.instance = _instance(run, then, as_path(wanted), tick)
    if element.kind == "state":
        return state_reason(run, then.path, element.path[-1], tick)
    if resolve(run.program(tick)).arrow(then) is not None:
        element, program = then, run.program(tick)
    reason = transition_reason(run, element, program, tick)
    if at is not None or not interpreter.paused:
        return reason
    time = run.loop.timing.now
    paused = f"The session has been paused since {time_text(time)}, so nothing is tested."
    sentence = f"{paused} In the last tick: {reason}"
    facts = {**reason.facts, "otherwise": reason.code}
    return replace(reason, code="paused", time=time, sentence=sentence, facts=facts)


def _instance(run: RecordedRun, element: Element, wanted: Path, tick: int) -> tuple[Path, float] | None:
    """Return the instance of the machine of an element that is meant in a tick; None if it ran at most once.

    Raises UnknownElementError: it ran several times.
    """
    home, name, machine = element.path[:-1], element.path[-1], wanted[:-1]
    known = [each.path for each in run.state(tick).walk() if each.state[:-1] == home]
    found = places_called(run.program(tick), home, machine, known)
    if len(found) == 1 and (len(known) > 1 or machine not in ((), home)):
        return found[0], tick
    if len(known) > 1:
        texts = [path_text((*path, name)) for path in known]
        raise UnknownElementError.ambiguous(f"{element.kind}s", path_text(wanted), texts)
    return None

"""Answers to questions about a session: *why* and *why not*."""

from __future__ import annotations

import math
from dataclasses import replace

from lrp_jupyter.errors import UnknownElementError, did_you_mean
from lrp_jupyter.interpreter.reasons import transition_of
from lrp_jupyter.language.names import as_path
from lrp_jupyter.language.program import Element, Path, Program, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.reason import Reason
from lrp_jupyter.live.why.evaluation import Again, PastTests
from lrp_jupyter.live.why.finding import find_state, find_transition
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.robot_commands import command_reason
from lrp_jupyter.live.why.states import state_reason
from lrp_jupyter.live.why.transitions import transition_reason
from lrp_jupyter.live.why.wording import time_text

__all__ = ["Answers"]

_ROBOT = "robot."
_INSTEAD = {  # what a name may be that is none of what is asked about
    "transition": "a transition. Ask `why_not`.",
    "state": "a state. Ask `why`.",
    "machine": "a machine. Ask about its states and transitions.",
    "event": "an event. Ask about a transition that waits for it.",
    "variable": "a variable.",
}


class Answers:
    """Answers a question about a session. Used on the thread that ticks, between two ticks.

    Parameters
    ----------
    loop : Loop
    again : callable
        See :data:`Again`.
    """

    def __init__(self, loop: Loop, again: Again) -> None:
        self._loop = loop
        self._run = RecordedRun(loop.interpreter)
        self._tests = PastTests(loop, again)

    def why_not(self, transition: str | Path, at: int | None = None) -> Reason:
        """Return why a transition did not fire in a tick, or that it did.

        Raises
        ------
        UnknownElementError
            There is no such transition, or there are several.
        ValueError
            The tick is not recorded.
        """
        reason = self._of_transition(transition, at)
        if reason is None:
            raise self._unknown("transition", transition, at)
        return reason

    def why(self, what: str | Path, at: int | None = None) -> Reason:
        """Return why a state was entered last, or why the robot got its last command (`robot.move`).

        Raises
        ------
        UnknownElementError
            There is no such state or command, or there are several.
        ValueError
            The tick is not recorded.
        """
        reason = self._of_state_or_command(what, at)
        if reason is None:
            raise self._unknown("state", what, at)
        return reason

    def explain(self, name: str | Path, at: int | None = None) -> Reason:
        """Return why a transition did not fire or, if there is no such transition, what `why` returns.

        Raises
        ------
        UnknownElementError
            There is no such transition, state or command, or there are several.
        ValueError
            The tick is not recorded.
        """
        reason = self._of_transition(name, at) or self._of_state_or_command(name, at)
        if reason is None:
            raise self._unknown("transition, state or command", name, at)
        return reason

    def _of_transition(self, wanted: str | Path, at: int | None) -> Reason | None:
        """Return the answer about a transition; None if there is no such transition."""
        tick = self._run.tick(at)
        found = find_transition(wanted, self._programs(at))
        if found is None:
            return None
        element, program = found
        then = self._then(element, program, tick)
        if transition_of(self._run.program(tick), then) is not None:
            element, program = then, self._run.program(tick)
        reason = transition_reason(self._run, self._tests, element, program, tick)
        if at is not None or not self._loop.interpreter.paused:
            return reason
        time = self._loop.now
        paused = f"The session has been paused since {time_text(time)}, so nothing is tested."
        sentence = f"{paused} In the last tick: {reason}"
        facts = {**reason.facts, "otherwise": reason.code}
        return replace(reason, code="paused", time=time, sentence=sentence, facts=facts)

    def _of_state_or_command(self, wanted: str | Path, at: int | None) -> Reason | None:
        """Return the answer about a state or a command of the robot; None if there is no such state."""
        text = path_text(as_path(wanted))
        tick = self._run.tick(at)
        if text.startswith(_ROBOT):
            name = text.removeprefix(_ROBOT)
            return command_reason(self._run, self._loop, name, tick, now=at is None)
        found = find_state(wanted, self._programs(at))
        if found is None:
            return None
        path, program = found
        then = self._then(Element("state", path), program, tick)
        return state_reason(self._run, self._tests, then.path, path[-1], tick)

    def _then(self, element: Element, program: Program, tick: int) -> Element:
        """Return an element of a program by the path that it had in a tick."""
        if program is self._run.program(tick):
            return element
        return Element(element.kind, self._run.names(tick).of(element.kind, element.path, math.inf))

    def _programs(self, at: int | None) -> tuple[Program, Program]:
        """Return the programs in which a name is looked up: that of the tick, then the present one."""
        return self._run.program(self._run.tick(at)), self._run.present_program

    def _unknown(self, kind: str, wanted: str | Path, at: int | None) -> UnknownElementError:
        """Return the error for a name that is none of a kind: what it is instead, or what is like it."""
        path = as_path(wanted)
        text = path_text(path)
        there_is_none = f"There is no {kind} `{text}`"
        known: list[str] = []
        for program in self._programs(at):
            for each in resolve(program).elements():
                if each.kind in _INSTEAD and (path in (each.path, each.path[-1:]) or text == each.shown[-1]):
                    return UnknownElementError(f"{there_is_none}: it is {_INSTEAD[each.kind]}")
                if each.kind in kind:
                    known.append(each.shown[-1])
        if text.startswith(_ROBOT):
            return UnknownElementError(f"{there_is_none}. Ask `why` about a command of the robot.")
        return UnknownElementError(f"{there_is_none}.{did_you_mean(text, known)}")
